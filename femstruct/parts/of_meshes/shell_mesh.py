"""Shells on their cells: what they have at their nodes, their matrices, and what points and surfaces read of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Final

import numpy as np
from scipy.sparse import csr_array

from femstruct.arrays import Floats, Integers, freeze, frozen
from femstruct.conventions import N_COMPONENTS
from femstruct.errors import InputError
from femstruct.model.imported.facing import frame_across, outwards
from femstruct.model.imported.flat_cells import FlatCells
from femstruct.model.imported.imported_mesh import put_where
from femstruct.model.imported.nearest import cross_turning
from femstruct.model.imported.shell_cells import (
    Sections,
    cell_matrices,
    cell_sections,
    cell_shares,
    edge_gauss,
    rows_at,
    share_matrices,
)
from femstruct.model.materials.lay_up import section_of
from femstruct.model.materials.loss_by_frequency import Loss
from femstruct.model.materials.plate_section import PlateSection
from femstruct.model.meshed import EdgePoints, LossShare, Meshed, OwnDofs, nodal_dofs
from femstruct.model.probe import Point, StressPlaces, Surface
from femstruct.model.region import Region, Side
from femstruct.model.rows import flat_rows, sparse_rows
from femstruct.model.structure import Support, SurfaceOn
from femstruct.parts.of_meshes.cell_surfaces import side_surface
from femstruct.parts.of_meshes.cells_mesh import CellsMesh, Words
from femstruct.parts.of_meshes.shell_properties import spread_mass
from femstruct.parts.of_meshes.shell_sides import mean_normal
from femstruct.parts.of_meshes.stresses_on_faces import stresses_on_faces
from femstruct.tags import stored_as

if TYPE_CHECKING:
    from femstruct.parts.shell import Shell

BENT: Final = 0.7  # cosine of 45 degrees, about: edges that meet at less are one line
FLAT: Final = 1e-9  # largest difference of the normals of the cells of a flat shell


@stored_as("shell mesh/1")
@dataclass(frozen=True, eq=False)
class ShellMesh(CellsMesh):
    """A shell on its cells.

    first : number of its first node. cells : with nodes counted from 0 on. thickness [q + t] : of the cells [m].
    """

    part: Shell
    first: int
    cells: FlatCells
    thickness: Floats
    words: ClassVar[Words] = Words("shell", "cell", "", "it")

    def __post_init__(self) -> None:
        freeze(self, thickness=frozen(f"parts.{self.part.name} thickness", self.thickness, (len(self.cells.cells),)))

    @property
    def sections(self) -> Sections:
        """Rigidities and masses per area of its cells, about the middle of their thickness."""
        found = cell_sections(self.cells, *self._made(), self.part.x_direction)
        return found._replace(m0=found.m0 + spread_mass(self.part, self.cells, self.thickness))

    def _made(self) -> tuple[list[PlateSection], Integers]:
        """Different sections, and the number of that of each cell [q + t]."""
        different, which = np.unique(self.thickness, return_inverse=True)
        return [section_of(self.part.material, float(t)) for t in different], which.ravel()

    @property
    def per_area(self) -> Floats:
        """Mass per area of the cells [q + t] [kg/m^2]."""
        return self.sections.m0

    @property
    def mass(self) -> float:
        return float(self.per_area @ self.cells.areas)

    @property
    def lumps(self) -> Floats:
        lumps = np.zeros(len(self.places))
        masses = self.per_area * self.cells.areas
        quads, triangles = self.cells.quads, self.cells.triangles
        np.add.at(lumps, quads, masses[: len(quads), None] / 4.0)
        np.add.at(lumps, triangles, masses[len(quads) :, None] / 3.0)
        return lumps

    @property
    def loss_factor(self) -> Loss:
        mean = self.thickness @ self.cells.areas / self.cells.areas.sum()
        return section_of(self.part.material, float(mean)).loss_factor

    @property
    def own_axes(self) -> Floats | None:
        """Two directions in it and its normal where it is flat."""
        normals = self.cells.normals
        return None if np.abs(normals - normals[0]).max() > FLAT else self._axes_along(normals[0])

    def _axes_along(self, normal: Floats) -> Floats:
        return np.concatenate([frame_across(normal, self.places)[0], normal[None]])

    def around(self, nodes: Integers) -> Meshed:
        """Flat, with axes, where all cells that meet at the nodes are in parallel planes."""
        touching = np.isin(self.cells.corners, nodes - self.first).any(axis=1)
        normals = self.cells.normals[touching]
        if self.own_axes is not None or np.abs(normals - normals[0]).max() > FLAT:
            return self
        return FlatMesh(self.part, self.first, self.cells, self.thickness, self._axes_along(normals[0]))

    @property
    def depth(self) -> float:
        return float(self.thickness.max()) / 2.0

    @property
    def across(self) -> Floats:
        """Half its thickness along its normal, of a flat one."""
        axes = self.own_axes
        return np.zeros(3) if axes is None else axes[2] * self.depth

    @property
    def drilling(self) -> Floats | None:
        axes = self.own_axes
        return None if axes is None else axes[2]

    def turning(self, nodes: Integers, reach: float, n_nodes: int) -> csr_array:
        """As of a plate: the rigid turn of the ends of a cross around each node, as far as they lie on it."""
        return self.turning_at(self.places[nodes - self.first], reach, n_nodes)

    def turning_at(self, places: Floats, reach: float, n_nodes: int) -> csr_array:
        axes = self.own_axes
        if axes is None:
            return super().turning_at(places, reach, n_nodes)
        corners, rows = cross_turning(self.cells, places, reach, axes)
        return sparse_rows(self.first + corners, rows, n_nodes)

    def dofs(self) -> OwnDofs:
        return nodal_dofs(len(self.places), 6)

    def stiffness_and_mass(self) -> tuple[csr_array, csr_array]:
        return put_where(f"parts.{self.name}", lambda: cell_matrices(self.cells, self.sections, self.part.shift))

    def shares(self) -> list[LossShare]:
        made, which = self._made()
        if not made[0].shares:
            return []
        each = cell_shares(self.cells, made, which, self.part.x_direction)
        matrices = share_matrices(self.cells, self.sections, each, self.part.shift)
        return [LossShare(one.name, one.loss_factor, K) for one, K in zip(made[0].shares, matrices, strict=True)]

    @property
    def facets(self) -> FlatCells:
        return self.cells

    def facet_motion(self, which: Integers, xi: Floats, eta: Floats) -> tuple[Integers, Floats]:
        nodes, rows = rows_at(self.cells, which, xi, eta)
        return self.first + nodes, rows

    @property
    def edges_of_cells(self) -> Integers:
        sides = np.stack([self.quads, np.roll(self.quads, -1, axis=1)], axis=2).reshape(-1, 2)
        return np.unique(np.sort(sides[sides[:, 0] != sides[:, 1]], axis=1), axis=0)

    def facet_reach(self, facet: int, tolerance: float) -> float:
        """Half its thickness, on whose face a place is."""
        return float(self.thickness[facet]) / 2.0 + abs(self.part.shift) + tolerance

    def facet_normal(self, facet: int, side: Side) -> Floats:
        return outwards(self.cells.normals[facet], side)

    def facets_within(self, region: Region, tolerance: float) -> Integers:
        return self.cells.cells_within(self.part.mesh, region, tolerance)

    def mean_of(self, name: str, nodes: Integers, side: Side) -> Point:
        rows = np.zeros((len(nodes), 6, 1, N_COMPONENTS))
        rows[:, :, 0, :6] = np.eye(6)
        own = nodes - self.first
        spots = flat_rows(nodes[:, None], rows, np.full(len(nodes), 1.0 / len(nodes)))
        return Point(name, self.places[own].mean(axis=0), *spots, normal=mean_normal(self.cells, own, side))

    def surface(self, item: SurfaceOn, n_nodes: int, tolerance: float) -> Surface:
        chosen = self.chosen(f"surfaces.{item.name}.region", item.region, tolerance)
        lies = self.thickness / 2.0, self.part.shift
        return side_surface(item, self.name, self.cells, chosen, self.facet_motion, n_nodes, lies)

    def edge_points(self, item: Support, tolerance: float) -> EdgePoints:
        """Of its free edges between nodes of the named set or in the box."""
        which, xi, eta, weights, along = edge_gauss(self.cells, *self._free_edges(item, tolerance))
        return EdgePoints(*self.facet_motion(which, xi, eta), weights, self.cells.normals[which], along)

    def _free_edges(self, item: Support, tolerance: float) -> tuple[Integers, Integers]:
        if item.region is None:
            got = f"an edge or line of '{self.name}', a part that is a mesh"
            raise InputError(f"supports.{item.name}", got=got, expected="a set or a box of it")
        where = f"supports.{item.name}.{item.region.kind}"
        cells, corner = self.cells.free_edges(self.within(where, item.region, tolerance) - self.first)
        if not len(cells):
            raise InputError(where, got=f"a {item.region} without a free edge of {self.name}", expected="an edge of it")
        return cells, corner

    def hard_edges(self, item: Support, tolerance: float) -> tuple[Integers, Floats]:
        """Where edges of a node bend by less than `BENT`, as of a polygon for a curve, it has their mean direction:
        held about both it would be clamped. At a corner it is."""
        cells, corner = self._free_edges(item, tolerance)
        nodes = self.cells.corners[cells]
        count = np.where(cells < len(self.cells.quads), 4, 3)
        ends = np.stack([nodes[np.arange(len(cells)), at] for at in (corner, (corner + 1) % count)], axis=1)
        along = self.cells.points[ends[:, 1]] - self.cells.points[ends[:, 0]]
        across = np.cross(along, self.cells.normals[cells])
        across /= np.linalg.norm(across, axis=1)[:, None]
        node, about = ends.ravel(), np.repeat(across, 2, axis=0)
        order = np.argsort(node, kind="stable")
        node, about = node[order], about[order]
        double = np.flatnonzero(node[1:] == node[:-1])  # a free edge of cells has two edges at a node inside of it
        cosine = (about[double] * about[double + 1]).sum(axis=1)
        straight = double[np.abs(cosine) > BENT]
        about[straight] += np.sign(cosine[np.abs(cosine) > BENT])[:, None] * about[straight + 1]
        about[straight] /= np.linalg.norm(about[straight], axis=1)[:, None]
        kept = np.ones(len(node), dtype=bool)
        kept[straight + 1] = False
        components = np.zeros((int(kept.sum()), N_COMPONENTS))
        components[:, 3:6] = about[kept]
        return self.first + node[kept], components

    def stresses(self, n_nodes: int) -> StressPlaces:
        """As `stresses_on_faces`. Raises InputError for smeared ribs, whose stresses are unknown."""
        return stresses_on_faces(self.part, self.cells, self.thickness, self.sections, (self.first, n_nodes))


@stored_as("flat mesh/1")
@dataclass(frozen=True, eq=False)
class FlatMesh(ShellMesh):
    """A shell that is flat, at least where something is joined to it. axes [3, 3] : rows are its x, y and normal."""

    axes: Floats

    @property
    def own_axes(self) -> Floats:
        return self.axes
