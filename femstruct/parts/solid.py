"""Solids: tetrahedra and hexahedra of a mesh from a file, linear or quadratic."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Final

import numpy as np
from scipy.sparse import csr_array, vstack

from femstruct.arrays import Floats, Integers
from femstruct.conventions import N_COMPONENTS
from femstruct.declared import checked
from femstruct.elements import solid
from femstruct.elements import solid as solid_shapes
from femstruct.elements.stresses import STRESSES
from femstruct.errors import Finding, InputError
from femstruct.model.flat_cells import FlatCells, around, best_turns, solid_doubts, solid_slips, turns_around
from femstruct.model.imported_mesh import ImportedMesh, frame_across, outwards, upwards
from femstruct.model.layout import Grids, Layout
from femstruct.model.materials import AnyMaterial, Loss, Material, refuse_laboratory
from femstruct.model.part import OwnDofs, nodal_dofs
from femstruct.model.probe import Point, StressPlaces, Surface
from femstruct.model.regions import Region, Side, Vector, flat_rows, mean_of_cells, sparse_rows
from femstruct.model.shell_cells import cell_points
from femstruct.model.solid_cells import SolidCells, facet_rows, matrices, refuse_inverted, solid_cells
from femstruct.model.structure import SurfaceOn
from femstruct.parts.cells import CLOSED, ORDER, CellsMesh, MeshPart, Words, surface_at
from femstruct.tags import stored_as

# ----------------------------------------------------------------------------------------------------------------------
# Solids on their cells: what they have at their nodes, their matrices, and what points and surfaces read of them.
# ----------------------------------------------------------------------------------------------------------------------

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


# ----------------------------------------------------------------------------------------------------------------------
# Solids.
# ----------------------------------------------------------------------------------------------------------------------

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
    >>> from femstruct.elements.solid import reference_nodes
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
            return solid.isotropic(material.E, material.nu)
        x = np.asarray(self.orientation, dtype=np.float64)
        x /= np.linalg.norm(x)
        z = np.asarray(self.normal, dtype=np.float64)
        z = z - (z @ x) * x
        z /= np.linalg.norm(z)
        return solid.rotate_elasticity(material.elasticity, np.stack([x, np.cross(z, x), z]))
