"""Solids: tetrahedra and hexahedra of a mesh from a file, linear or quadratic."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.declared import checked
from femstruct.elements import elasticity
from femstruct.errors import Finding, InputError
from femstruct.model.grid.layout import Grids, Layout
from femstruct.model.imported.doubts import solid_doubts
from femstruct.model.imported.imported_mesh import ImportedMesh
from femstruct.model.imported.solid_cells import refuse_inverted, solid_cells
from femstruct.model.imported.unit_slips import solid_slips
from femstruct.model.material import Material
from femstruct.model.materials.orthotropic import AnyMaterial
from femstruct.model.region import Vector
from femstruct.parts.of_meshes.mesh_part import MeshPart
from femstruct.parts.of_meshes.solid_mesh import SolidMesh
from femstruct.tags import stored_as

STIFF: Final = "tet4"  # many times too stiff in bending, whatever the shape of the cells


@stored_as("solid/1")
@dataclass(frozen=True)
@checked("parts")
class Solid(MeshPart):
    """A solid on the tetrahedra and hexahedra of a mesh, or of a set of it.

    mesh : as `read_mesh_file` gives it. named : the set; None for all of them. orientation, normal : directions of the
    x and, as nearly as it can, of the z of an orthotropic material.

    Cells of 10, 20 and 27 nodes are the better ones. Cells of 8 nodes have incompatible modes, which let them bend;
    tetrahedra of 4 nodes are far too stiff in bending, and a finding says so.

    A block of steel of one cell, 1 m x 1 m x 1 m:

    >>> steel = Material("steel", E=210e9, nu=0.3, rho=7850.0)
    >>> from femstruct.elements.solid_shapes import reference_nodes
    >>> corners = reference_nodes("hex8")
    >>> mesh = ImportedMesh("block", corners, range(8), {"hex8": [range(8)]}, {"hex8": [1]})
    >>> from femstruct import Structure, mesh_structure
    >>> round(mesh_structure(Structure("a block", (Solid("block", mesh, steel),))).parts["block"].mass, 6)
    7850.0
    """

    name: str
    mesh: ImportedMesh
    material: AnyMaterial
    named: str | None = None
    orientation: Vector | None = None
    normal: Vector = (0.0, 0.0, 1.0)
    dimension: ClassVar[int] = 3

    def __post_init__(self) -> None:
        """Raises InputError for a set that is not there or has no such cells, and for directions that are missing."""
        super().__post_init__()
        if isinstance(self.material, Material):
            return
        if self.orientation is None or not np.linalg.norm(np.cross(self.orientation, self.normal)) > 0:
            raise InputError(
                f"parts.{self.name}.orientation",
                got="none" if self.orientation is None else f"{self.orientation}, and normal {self.normal}",
                expected="'orientation', the direction of the material's x, across its normal",
            )

    def implausible(self, lies: bool) -> tuple[Finding, ...]:
        """Linear tetrahedra, and what is doubtful about the mesh."""
        mass = SolidMesh(self, 0, solid_cells(self.mesh, self.named)).mass
        unit = solid_slips(self.name, self.mesh, self.corners(), mass)
        doubts = solid_doubts(self.name, self.mesh, self.named, unit)
        cells = self.own_cells
        count, every = len(cells.get(STIFF, ())), sum(len(one) for one in cells.values())
        if not count:
            return doubts
        return (
            *doubts,
            Finding(
                "stiff-cells",
                f"{self.name}: {count} of {every} cells are tetrahedra of 4 nodes, which are far too stiff in bending: "
                "frequencies are too high, with one cell over a thickness by a factor of two and more. Mesh with "
                "tetrahedra of 10 nodes (second order)",
                {"cells": count, "of": every},
            ),
        )

    def meshed(self, layout: Layout, grids: Grids, first: int) -> SolidMesh:
        refuse_inverted(f"parts.{self.name}.mesh", self.mesh, self.named)
        return SolidMesh(self, first, solid_cells(self.mesh, self.named))

    @property
    def elasticity(self) -> Floats:
        """Elasticity [6, 6] along global axes [Pa]."""
        material = self.material
        if isinstance(material, Material):
            return elasticity.isotropic(material.E, material.nu)
        x = np.asarray(self.orientation, dtype=np.float64)
        x /= np.linalg.norm(x)
        z = np.asarray(self.normal, dtype=np.float64)
        z = z - (z @ x) * x
        z /= np.linalg.norm(z)
        return elasticity.turned(material.elasticity, np.stack([x, np.cross(z, x), z]))
