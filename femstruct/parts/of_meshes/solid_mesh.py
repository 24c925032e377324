"""Solids on their cells: what they have at their nodes, their matrices, and what points and surfaces read of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Final

import numpy as np
from scipy.sparse import csr_array, vstack

from femstruct.arrays import Floats, Integers
from femstruct.conventions import N_COMPONENTS
from femstruct.elements import solid, solid_shapes
from femstruct.elements.stresses import STRESSES
from femstruct.errors import InputError
from femstruct.model.imported.facing import frame_across, outwards, upwards
from femstruct.model.imported.flat_cells import FlatCells
from femstruct.model.imported.shell_cells import cell_points
from femstruct.model.imported.solid_cells import SolidCells, facet_rows, matrices
from femstruct.model.imported.surface_turns import around, best_turns, turns_around
from femstruct.model.materials.loss_by_frequency import Loss, refuse_laboratory
from femstruct.model.meshed import OwnDofs, nodal_dofs
from femstruct.model.probe import Point, StressPlaces, Surface
from femstruct.model.region import Region, Side
from femstruct.model.rows import flat_rows, mean_of_cells, sparse_rows
from femstruct.model.structure import SurfaceOn
from femstruct.parts.of_meshes.cell_surfaces import surface_at
from femstruct.parts.of_meshes.cells_mesh import CLOSED, ORDER, CellsMesh, Words
from femstruct.tags import stored_as

if TYPE_CHECKING:
    from femstruct.parts.solid import Solid

OFF: Final = 1e-3  # of the largest side of the box round it: a place may be so far off a facet that is curved


@stored_as("solid mesh/1")
@dataclass(frozen=True, eq=False)
class SolidMesh(CellsMesh):
    """A solid on its cells. first : number of its first node. cells : with nodes counted from 0 on."""

    part: Solid
    first: int
    cells: SolidCells
    has_surface: ClassVar[bool] = True
    words: ClassVar[Words] = Words("solid", "face", "the faces of ", "one of them")

    @property
    def has_rotations(self) -> bool:
        return False

    @property
    def mass(self) -> float:
        return self.part.material.rho * float(sum(one.sum() for one in self.cells.volumes.values()))

    @property
    def lumps(self) -> Floats:
        lumps = np.zeros(len(self.places))
        for kind, volumes in self.cells.volumes.items():
            nodes = self.cells.cells[kind]
            np.add.at(lumps, nodes, (self.part.material.rho * volumes / nodes.shape[1])[:, None])
        return lumps

    @property
    def loss_factor(self) -> Loss:
        return refuse_laboratory(f"parts.{self.name}.material", self.part.material.loss_factor)

    def dofs(self) -> OwnDofs:
        return nodal_dofs(len(self.places), 3)

    def stiffness_and_mass(self) -> tuple[csr_array, csr_array]:
        return matrices(self.cells, self.part.elasticity, self.part.material.rho)

    def turned(self, nodes: Integers, n_nodes: int) -> csr_array:
        """That of the rigid motion that fits best the nodes of all facets that meet at each node."""
        near = around(self.cells.corners, nodes - self.first, len(self.places))
        if not np.diff(near.indptr).all():
            raise InputError(f"parts.{self.name}", got="a joint with a node inside it", expected="one on its faces")
        corners, rows = turns_around(self.places, near)
        return sparse_rows(self.first + corners, rows, n_nodes)

    @property
    def facets(self) -> FlatCells:
        return self.cells.facets

    def facet_motion(self, which: Integers, xi: Floats, eta: Floats) -> tuple[Integers, Floats]:
        nodes, rows = facet_rows(self.cells, which, xi, eta)
        return self.first + nodes, rows

    def facet_reach(self, facet: int, tolerance: float) -> float:
        return max(tolerance, OFF * float(np.ptp(self.places, axis=0).max()))

    def facet_normal(self, facet: int, side: Side) -> Floats:
        """Out of the solid, whatever the side."""
        return np.asarray(self.facets.normals[facet])

    def facets_within(self, region: Region, tolerance: float) -> Integers:
        return self.cells.facets_within(region, tolerance)

    def faces_at(self, where: str, region: Region, tolerance: float) -> dict[str, Integers]:
        found = self.cells.whole_faces(self.chosen(where, region, tolerance))
        return {kind: self.first + nodes for kind, nodes in found.items()}

    def mean_of(self, name: str, nodes: Integers, side: Side) -> Point:
        """With the rotation of the rigid motion that fits them best."""
        places = self.places[nodes - self.first]
        rows = np.zeros((1, 6, len(nodes), N_COMPONENTS))
        rows[0, :3, :, :3] = np.eye(3)[:, None] / len(nodes)
        rows[0, 3:, :, :3] = best_turns(places[None], np.ones((1, len(nodes))))[0]
        touching = np.isin(self.cells.corners, nodes - self.first).all(axis=1)
        whole = (self.facets.normals * self.facets.areas[:, None])[touching].sum(axis=0)
        normal = outwards(whole, side) if not touching.any() else whole / max(float(np.linalg.norm(whole)), 1e-300)
        return Point(name, places.mean(axis=0), *flat_rows(nodes[None], rows, np.ones(1)), normal=normal)

    def surface(self, item: SurfaceOn, n_nodes: int, tolerance: float) -> Surface:
        """Faces of a set or in a box, their normals outwards. Raises InputError for faces all round it."""
        where, facets = f"surfaces.{item.name}.region", self.facets
        chosen = self.chosen(where, item.region, tolerance)
        whole = (facets.normals * facets.areas[:, None])[chosen].sum(axis=0)
        if np.linalg.norm(whole) < CLOSED * facets.areas[chosen].sum():
            raise InputError(
                where, got=f"faces all round {self.name}", expected="a side of it", do="name a set of faces, or a box"
            )
        points = cell_points(facets, chosen, ORDER)
        corners = self.places[np.unique(self.cells.corners[chosen])]
        lies = frame_across(upwards(whole / np.linalg.norm(whole)), corners)
        return surface_at(item.name, points, facets.normals[points.cells], lies, self.facet_motion, n_nodes)

    def stresses(self, n_nodes: int) -> StressPlaces:
        """At every node, along global axes: the mean of the cells that meet there."""
        rows, meets = [], []
        for kind, cells in self.cells.cells.items():
            k = cells.shape[1]
            at = np.tile(solid_shapes.reference_nodes(kind), (len(cells), 1))
            every = np.repeat(cells, k, axis=0)
            found = solid.stresses(kind, self.places[every], at, self.part.elasticity)
            padded = np.zeros((len(every), 6, k, N_COMPONENTS))
            padded[..., :3] = found.reshape(len(every), 6, k, 3)
            rows.append(sparse_rows(self.first + every, padded, n_nodes))
            meets.append(cells.ravel())
        every_cell, owner = csr_array(vstack(rows)), np.concatenate(meets)
        mean = mean_of_cells(owner, 6)
        return StressPlaces(self.places, STRESSES, csr_array(mean @ every_cell), ("",), every_cell, owner)
