"""Parts whose shape is the mesh of a file, before they have nodes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.errors import InputError
from femstruct.model.given import Given, given
from femstruct.model.imported.imported_mesh import ImportedMesh, put_where
from femstruct.model.imported.stated.left_out import Makes
from femstruct.model.material import Material
from femstruct.model.materials.lay_up import LayUp, materials_of
from femstruct.model.materials.orthotropic import AnyMaterial
from femstruct.model.region import Vector
from femstruct.parts.of_meshes.given_nodes import GivenNodes


class MeshPart(GivenNodes):
    """A part on cells of a mesh, or of a set of it; the base of shells and solids.

    dimension : of its cells. units : of its fields that have one.
    """

    mesh: ImportedMesh
    material: AnyMaterial | LayUp
    named: str | None
    orientation: Vector | None
    dimension: ClassVar[int]
    units: ClassVar[Mapping[str, str]] = {}

    def __post_init__(self) -> None:
        """Raises InputError for a set that is not there or has no such cells, and for a direction of a material that
        has none."""
        key = "mesh" if self.named is None else "set"
        put_where(f"parts.{self.name}.{key}", lambda: self.own_cells)
        if isinstance(self.material, Material) and self.orientation is not None:
            raise InputError(
                f"parts.{self.name}.orientation",
                got=f"a direction for '{self.material.name}', which is isotropic: it has no direction",
                expected="no orientation",
                do="leave 'orientation' out",
            )

    @property
    def own_cells(self) -> dict[str, Integers]:
        """Rows of its cells in the mesh, by kind."""
        return self.mesh.cells_of(self.named, self.dimension)

    def described(self) -> tuple[Given, ...]:
        kept = tuple(one for one in given(self, self.units) if one.what != "mesh")
        cells = ", ".join(f"{len(some)} {kind}" for kind, some in self.mesh.cells.items())
        return (Given("mesh", f"{self.mesh.source} ({cells}, {len(self.mesh.points)} nodes)"), *kept)

    def corners(self) -> Floats:
        nodes = [self.mesh.cells[kind][rows].ravel() for kind, rows in self.own_cells.items()]
        return np.asarray(self.mesh.points[np.unique(np.concatenate(nodes))])

    def materials(self) -> tuple[AnyMaterial, ...]:
        return materials_of(self.material)

    def middles(self) -> Floats:
        return self.mesh.middles_of(self.named, self.dimension)

    def taken(self) -> tuple[tuple[ImportedMesh, Mapping[str, Integers]], ...]:
        return ((self.mesh, self.own_cells),)

    def stands_for(self) -> frozenset[Makes]:
        """What of its cells the model states, so that the file's is not asked for. An isotropic material has no
        direction."""
        own = set()
        if self.orientation is not None or isinstance(self.material, Material):
            own.add(Makes.ORIENTATION)
        if isinstance(self.material, LayUp):
            own |= {Makes.LAY_UP, Makes.THICKNESS}
        return frozenset(own)
