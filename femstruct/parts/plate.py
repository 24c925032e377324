"""Plates: flat, rectangular, bending by Kirchhoff's theory, and stretching in their own plane or rigid there."""

from __future__ import annotations

from dataclasses import dataclass
from math import isclose
from typing import Literal, get_args

import numpy as np

from femstruct.arrays import Floats
from femstruct.declared import checked
from femstruct.elements import plate
from femstruct.errors import Finding, InputError
from femstruct.model.given import Given, given
from femstruct.model.grid.cell_sides import cell_sides
from femstruct.model.grid.geometry import from_rectangle, rectangle_axes
from femstruct.model.grid.layout import Grids, Layout
from femstruct.model.material import Material
from femstruct.model.materials.lay_up import LayUp, materials_of, section_of
from femstruct.model.materials.orthotropic import AnyMaterial
from femstruct.model.materials.plate_section import PlateSection
from femstruct.model.part import Body, Part
from femstruct.model.region import Pair, Vector
from femstruct.parts.of_plates.plate_mesh import PlateMesh
from femstruct.parts.plausibility import refuse_thicker, thickness_findings
from femstruct.tags import stored_as

InPlane = Literal["elastic", "rigid"]


@stored_as("plate/1")
@dataclass(frozen=True)
@checked("parts", mesh="an element side in m, or a tuple of 2 divisions (nx, ny)")
class Plate(Part):
    """A flat rectangular plate; `origin` is a corner of its mid-surface, `size` runs along x_direction and normal x it.

    material : one material, or a lay-up, whose thickness `thickness` then is. Its x is along the plate's, its layers
    are counted along the normal.
    mesh : largest element side [m], or the least number of divisions (nx, ny).
    in_plane : elastic, it stretches and shears in its plane, with a drilling rotation at every node; rigid, it does
    not, and ribs and folds are too stiff. Where nothing is said, it is elastic if anything is joined to it that could
    stretch it: whatever does not lie in its plane. hermite12, the element of the source, is always rigid there.

    >>> steel = Material("steel", E=210e9, nu=0.3, rho=7850.0)
    >>> Plate("floor", steel, thickness=5e-3, origin=(0.0, 0.0, 0.0), size=(0.4, 0.3), mesh=0.05).element
    'bfs16'
    """

    name: str
    material: AnyMaterial | LayUp
    thickness: float
    origin: Vector
    size: Pair
    mesh: float | tuple[int, int]
    element: plate.PlateElement = "bfs16"
    normal: Vector = (0.0, 0.0, 1.0)
    x_direction: Vector | None = None
    in_plane: InPlane | None = None

    def __post_init__(self) -> None:
        if isinstance(self.material, LayUp) and not isclose(self.thickness, self.material.thickness, rel_tol=1e-9):
            raise InputError(
                f"parts.{self.name}.thickness",
                got=f"{self.thickness:g} m",
                expected=f"{self.material.thickness:g} m, that of its layers",
            )
        if self.element == "hermite12" and not isinstance(self.material, Material):
            raise InputError(
                f"parts.{self.name}.element",
                got="hermite12 with an orthotropic material or layers",
                expected="bfs16 or acm12",
                do="leave 'element' out",
            )
        self._check_in_plane()
        refuse_thicker(self.name, "plate", self.material, self.thickness, min(self.size))

    def _check_in_plane(self) -> None:
        where = f"parts.{self.name}.in_plane"
        if self.in_plane not in (None, *get_args(InPlane)):
            raise InputError(where, got=f"{self.in_plane!r}", expected=" or ".join(get_args(InPlane)))
        if self.in_plane == "elastic" and self.element == "hermite12":
            raise InputError(
                where,
                got="elastic with the element hermite12, which is that of the source and rigid in its plane",
                expected="rigid",
                do="use the element bfs16",
            )

    def described(self) -> tuple[Given, ...]:
        return given(
            self,
            {
                "thickness": "m",
                "size": "m",
                "origin": "m",
                "mesh": "divisions" if isinstance(self.mesh, tuple) else "m",
            },
        )

    def corners(self) -> Floats:
        for key, value in (("thickness", self.thickness), ("size", min(self.size))):
            if not value > 0:
                raise InputError(f"parts.{self.name}.{key}", got=f"{value:g} m", expected="a positive length")
        local = np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]]) * self.size
        return from_rectangle(self, rectangle_axes(self), local)

    def body(self) -> Body:
        axes = rectangle_axes(self)
        corner = np.asarray(self.origin, dtype=np.float64) - self.thickness / 2.0 * axes[2]
        return Body(corner, axes, np.array([*self.size, self.thickness]), across=2)

    @property
    def section(self) -> PlateSection:
        """Rigidities and masses per area about its mid-surface."""
        return section_of(self.material, self.thickness)

    def materials(self) -> tuple[AnyMaterial, ...]:
        return materials_of(self.material)

    def implausible(self, lies: bool) -> tuple[Finding, ...]:
        flat = abs(float(rectangle_axes(self)[2, 2])) > np.sqrt(0.5)
        return thickness_findings(self.name, self.section, self.materials(), min(self.size), flat and not lies)

    def lay_out(self, layout: Layout) -> None:
        layout.add_rectangle(self, cell_sides(f"parts.{self.name}.mesh", self.size, self.mesh))
        layout.bodies[self.name] = self.body()

    def meshed(self, layout: Layout, grids: Grids, first: int) -> PlateMesh:
        stretches = self.in_plane == "elastic" or (
            self.in_plane is None and self.element != "hermite12" and self.name in layout.stretched
        )
        grid = grids[self.name, 0], grids[self.name, 1]
        return PlateMesh(self, first, layout.axes_of[self.name], *grid, stretches)
