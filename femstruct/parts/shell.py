"""Shells: triangles and quadrilaterals of a mesh from a file, flat or curved by facets, thin to thick."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from femstruct.arrays import Floats
from femstruct.declared import checked
from femstruct.errors import Finding, InputError
from femstruct.model.grid.layout import Grids, Layout
from femstruct.model.imported.doubts import refuse_degenerate, shell_doubts
from femstruct.model.imported.flat_cells import flat_cells
from femstruct.model.imported.imported_mesh import ImportedMesh
from femstruct.model.imported.stated.left_out import Makes
from femstruct.model.imported.unit_slips import shell_slips
from femstruct.model.material import Material
from femstruct.model.materials.lay_up import LayUp
from femstruct.model.materials.orthotropic import AnyMaterial
from femstruct.model.region import Vector
from femstruct.parts.of_meshes.mesh_part import MeshPart
from femstruct.parts.of_meshes.shell_mesh import ShellMesh
from femstruct.parts.of_meshes.shell_properties import cell_thickness
from femstruct.tags import stored_as


@stored_as("shell/1")
@dataclass(frozen=True)
@checked("parts")
class Shell(MeshPart):
    """A shell on the triangles and quadrilaterals of a mesh, or of a set of it.

    mesh : as `read_mesh_file` gives it. named : the set; None for all of them. thickness : of all, or by names of sets
    of cells [m]; None for that of a lay-up, or for what the file states. offset : from the mesh to the middle of the
    thickness, along the normal of each cell [m]; None is 0 where the file states none. orientation : direction of the
    x of an orthotropic material or a lay-up, laid into each cell. nonstructural : mass per area on it that does not
    stiffen it, NSM [kg/m^2]; None is what the file states, if its unit of mass is known: kg beside metres, t beside mm.

    Quadrilaterals are the better elements; quadratic cells are cut into four linear ones. Normals are made consistent
    over each patch of cells.

    A tray of steel, 2 mm thick, of four cells:

    >>> steel = Material("steel", E=210e9, nu=0.3, rho=7850.0)
    >>> corners = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0], [0, 0, 1], [1, 0, 1], [2, 0, 1]]
    >>> cells = [[0, 1, 4, 3], [1, 2, 5, 4], [0, 1, 7, 6], [1, 2, 8, 7]]
    >>> mesh = ImportedMesh("tray", corners, range(1, 10), {"quad4": cells}, {"quad4": [1, 2, 3, 4]})
    >>> tray = Shell("tray", mesh, steel, thickness=2e-3)
    >>> from femstruct import Structure, mesh_structure
    >>> round(mesh_structure(Structure("a tray", (tray,))).parts["tray"].mass, 6)
    62.8
    """

    name: str
    mesh: ImportedMesh
    material: AnyMaterial | LayUp
    thickness: float | Mapping[str, float] | None = None
    named: str | None = None
    offset: float | None = None
    orientation: Vector | None = None
    nonstructural: float | None = None
    dimension: ClassVar[int] = 2
    units: ClassVar[Mapping[str, str]] = {"thickness": "m", "offset": "m", "nonstructural": "kg/m^2"}

    def __post_init__(self) -> None:
        """Raises InputError for a set that is not there or has no such cells, and for directions that are missing."""
        super().__post_init__()
        if self.nonstructural is not None and not self.nonstructural >= 0.0:
            where, got = f"parts.{self.name}.nonstructural", f"{self.nonstructural:g} kg/m^2"
            raise InputError(where, got=got, expected="a mass per area, or 0")
        if isinstance(self.material, Material):
            return
        if self.orientation is None or not np.linalg.norm(self.orientation) > 0:
            raise InputError(
                f"parts.{self.name}.orientation",
                got="none" if self.orientation is None else f"{self.orientation}",
                expected="'orientation', the direction of the material's x",
                do="write orientation: [1, 0, 0]",
            )

    @property
    def shift(self) -> float:
        """From the mesh to the middle of the thickness [m]."""
        return self.offset or 0.0

    def stands_for(self) -> frozenset[Makes]:
        """Offset, thickness and mass on it too, where they are written: `offset: 0 mm` says that there is none."""
        written = {Makes.OFFSET: self.offset, Makes.THICKNESS: self.thickness, Makes.SPREAD: self.nonstructural}
        return super().stands_for() | {makes for makes, value in written.items() if value is not None}

    def takes(self) -> frozenset[Makes]:
        taken = self.nonstructural is None and self.mesh.unit_of_mass > 0.0
        return frozenset({Makes.SPREAD}) if taken else frozenset()

    def written_thickness(self) -> tuple[float, ...]:
        if isinstance(self.material, LayUp):
            return (self.material.thickness,)
        return (
            tuple(self.thickness.values())
            if isinstance(self.thickness, Mapping)
            else ()
            if self.thickness is None
            else (self.thickness,)
        )

    @property
    def x_direction(self) -> Floats | None:
        """Direction [3] of the material's x; None where it has none."""
        return None if self.orientation is None else np.asarray(self.orientation, dtype=np.float64)

    def meshed(self, layout: Layout, grids: Grids, first: int) -> ShellMesh:
        cells = flat_cells(self.mesh, self.named)
        refuse_degenerate(f"parts.{self.name}.mesh", self.mesh, cells)
        return ShellMesh(self, first, cells, cell_thickness(self, cells))

    def implausible(self, lies: bool) -> tuple[Finding, ...]:
        cells = flat_cells(self.mesh, self.named)
        thickness = cell_thickness(self, cells)
        mass = ShellMesh(self, 0, cells, thickness).mass
        stated = self.thickness is None and not isinstance(self.material, LayUp)
        unit = shell_slips(self.name, self.mesh, cells, thickness, mass, stated)
        return shell_doubts(self.name, self.mesh, self.named, cells, unit)
