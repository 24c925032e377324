"""Model: a structure with its mesh, its parts, and everything fastened to their nodes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from femstruct.conventions import N_COMPONENTS
from femstruct.errors import FemstructError
from femstruct.model.fastened import Elastic, Inert, Tie
from femstruct.model.mesh import Mesh
from femstruct.model.meshed import Meshed
from femstruct.model.probe import Point, Surface
from femstruct.model.structure import Structure
from femstruct.tags import stored_as


@stored_as("meshed model/1")
@dataclass(frozen=True, eq=False)
class Model:
    """A structure ready to be assembled.

    parts : those with nodes of their own, by name. points, surfaces : by name; several places of a point are NAME.1,
    NAME.2. elastics : springs, foundations and joints with stiffness. inerts : masses. ties : supports and joints.

    Raises FemstructError: rows that do not fit the mesh.

    A plate with a point on it: where the point is, and how many nodes carry the plate:

    >>> from femstruct import Material, PlaceOn, Plate, Structure, mesh_structure
    >>> steel = Material("steel", E=210e9, nu=0.3, rho=7850.0)
    >>> plate = Plate("plate", steel, 0.003, origin=(0.0, 0.0, 0.0), size=(0.5, 0.4), mesh=(4, 3))
    >>> model = mesh_structure(Structure("a plate", (plate,), points=(PlaceOn("middle", "plate", at=((0.25, 0.2),)),)))
    >>> model.points["middle"].position.tolist(), model.mesh.n_nodes, model.parts["plate"].quads.shape
    ([0.25, 0.2, 0.0], 20, (12, 4))
    """

    structure: Structure
    mesh: Mesh
    parts: Mapping[str, Meshed]
    elastics: tuple[Elastic, ...]
    inerts: tuple[Inert, ...]
    ties: tuple[Tie, ...]
    points: Mapping[str, Point]
    surfaces: Mapping[str, Surface]

    def __post_init__(self) -> None:
        fastened: tuple[Elastic | Inert | Tie, ...] = (*self.elastics, *self.inerts, *self.ties)
        for item in fastened:
            if item.rows.shape[1] != self.mesh.n_nodes * N_COMPONENTS:
                raise FemstructError(
                    item.name,
                    got=f"{item.rows.shape[1]} columns",
                    expected=f"{self.mesh.n_nodes} nodes x {N_COMPONENTS}",
                )

    def places(self, name: str) -> tuple[Point, ...]:
        """All places of a point: one, or NAME.1, NAME.2 and so on."""
        if name in self.points:
            return (self.points[name],)
        several: list[Point] = []
        while (key := f"{name}.{len(several) + 1}") in self.points:
            several.append(self.points[key])
        if not several:
            raise FemstructError("points", got=f"'{name}'", expected=" or ".join(sorted(self.points)) or "a point")
        return tuple(several)
