"""Solids: tetrahedra and hexahedra of a mesh from a file, linear or quadratic."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Final

import numpy as np
from scipy.sparse import csr_array, vstack

from femstruct.arrays import Floats, Integers
from femstruct.conventions import N_COMPONENTS
from femstruct.declared import checked
from femstruct.elements import solid
from femstruct.elements.stresses import STRESSES
from femstruct.errors import Finding, InputError
from femstruct.model.given import Given, given
from femstruct.model.grid.layout import Grids, Layout
from femstruct.model.imported.doubts import solid_doubts
from femstruct.model.imported.facing import frame_across, outwards, upwards
from femstruct.model.imported.imported_mesh import ImportedMesh, put_where
from femstruct.model.imported.shell_cells import cell_points, nearest_place
from femstruct.model.imported.solid_cells import (
    SolidCells,
    best_turns,
    facet_rows,
    matrices,
    refuse_inverted,
    solid_cells,
)
from femstruct.model.imported.unit_slips import in_millimetres, solid_slips
from femstruct.model.material import Material
from femstruct.model.materials.loss_by_frequency import Loss
from femstruct.model.materials.orthotropic import AnyMaterial
from femstruct.model.part import Drawn, Meshed, OwnDofs, Part, Spread, nodal_dofs, refuse_patch
from femstruct.model.probe import Point, StressPlaces, Surface
from femstruct.model.region import Region, Side, Vector
from femstruct.model.rows import carried, flat_rows, mean_of_cells, sparse_rows
from femstruct.model.structure import PlaceOn, SurfaceOn

STIFF: Final = "tet4"  # many times too stiff in bending, whatever the shape of the cells
CLOSED: Final = 1e-3  # of its area: faces whose normals add to less have no side
ORDER: Final = 2  # Gauss points a direction in each facet of a surface: its deflection is bilinear
OFF: Final = 1e-3  # of the largest side of the box round it: a place may be so far off a facet that is curved


@dataclass(frozen=True)
@checked("parts")
class Solid(Part):
    """A solid on the tetrahedra and hexahedra of a mesh, or of a set of it.

    mesh : as `read_mesh_file` gives it. named : the set; None for all of them. orientation, normal : directions of the
    x and, as nearly as it can, of the z of an orthotropic material.

    Cells of 10, 20 and 27 nodes are the better ones. Cells of 8 nodes have incompatible modes, which let them bend;
    tetrahedra of 4 nodes are far too stiff in bending, and a finding says so.

    A block of steel of one cell, 1 m x 1 m x 1 m:

    >>> steel = Material("steel", E=210e9, nu=0.3, rho=7850.0)
    >>> corners = solid.reference_nodes("hex8")
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

    def __post_init__(self) -> None:
        """Raises InputError for a set that is not there or has no such cells, and for directions that are missing."""
        key = "mesh" if self.named is None else "set"
        put_where(f"parts.{self.name}.{key}", lambda: self.mesh.cells_of(self.named, 3))
        where, plain = f"parts.{self.name}.orientation", isinstance(self.material, Material)
        if plain and self.orientation is not None:
            raise InputError(where, got="one of an isotropic material", expected="none")
        if not plain and (self.orientation is None or not np.linalg.norm(np.cross(self.orientation, self.normal)) > 0):
            got = "none" if self.orientation is None else f"{self.orientation}, and normal {self.normal}"
            raise InputError(
                where, got=got, expected="'orientation', the direction of the material's x, across its normal"
            )

    def described(self) -> tuple[Given, ...]:
        kept = tuple(one for one in given(self, {}) if one.what != "mesh")
        cells = ", ".join(f"{len(some)} {kind}" for kind, some in self.mesh.cells.items())
        return (Given("mesh", f"{self.mesh.source} ({cells}, {len(self.mesh.points)} nodes)"), *kept)

    def corners(self) -> Floats:
        cells = self.mesh.cells_of(self.named, 3)
        used = np.unique(np.concatenate([self.mesh.cells[kind][rows].ravel() for kind, rows in cells.items()]))
        return np.asarray(self.mesh.points[used])

    def materials(self) -> tuple[AnyMaterial, ...]:
        return (self.material,)

    def implausible(self, lies: bool) -> tuple[Finding, ...]:
        """Linear tetrahedra, and what is doubtful about the mesh."""
        mass = SolidMesh(self, 0, solid_cells(self.mesh, self.named)).mass
        unit = solid_slips(self.name, self.mesh, self.corners(), mass)
        doubts = solid_doubts(self.name, self.mesh, self.named, unit)
        cells = self.mesh.cells_of(self.named, 3)
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

    def middles(self) -> Floats:
        return self.mesh.middles_of(self.named, 3)

    def taken(self) -> tuple[tuple[ImportedMesh, Mapping[str, Integers]], ...]:
        return ((self.mesh, self.mesh.cells_of(self.named, 3)),)

    def lay_out(self, layout: Layout) -> None:
        layout.given.add(self.name)

    def meshed(self, layout: Layout, grids: Grids, first: int) -> SolidMesh:
        refuse_inverted(f"parts.{self.name}.mesh", self.mesh, self.named)
        return SolidMesh(self, first, solid_cells(self.mesh, self.named))

    @property
    def elasticity(self) -> Floats:
        """Elasticity [6, 6] along global axes [Pa]."""
        material = self.material
        if isinstance(material, Material):
            return solid.elasticity(material.E, material.nu)
        x = np.asarray(self.orientation, dtype=np.float64)
        x /= np.linalg.norm(x)
        z = np.asarray(self.normal, dtype=np.float64)
        z = z - (z @ x) * x
        z /= np.linalg.norm(z)
        return solid.turned_elasticity(material.elasticity, np.stack([x, np.cross(z, x), z]))


@dataclass(frozen=True, eq=False)
class SolidMesh(Meshed):
    """A solid on its cells. first : number of its first node. cells : with nodes counted from 0 on."""

    part: Solid
    first: int
    cells: SolidCells
    has_surface: ClassVar[bool] = True

    @property
    def name(self) -> str:
        return self.part.name

    @property
    def has_rotations(self) -> bool:
        return False

    @property
    def places(self) -> Floats:
        return self.cells.points

    @property
    def of_file(self) -> tuple[ImportedMesh, Integers]:
        return self.part.mesh, self.cells.rows

    @property
    def quads(self) -> Integers:
        return self.first + self.cells.corners

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
        return self.part.material.loss_factor

    @property
    def held_together(self) -> list[Integers]:
        label = self.cells.held_together()
        order = np.argsort(label, kind="stable")
        return list(np.split(self.first + order, np.flatnonzero(np.diff(label[order])) + 1))

    def dofs(self) -> OwnDofs:
        return nodal_dofs(len(self.places), 3)

    def stiffness_and_mass(self) -> tuple[csr_array, csr_array]:
        return matrices(self.cells, self.part.elasticity, self.part.material.rho)

    def turned(self, nodes: Integers, n_nodes: int) -> csr_array:
        """That of the rigid motion that fits best the nodes of all facets that meet at each node."""
        corners, own = self.cells.corners, nodes - self.first
        rows = []
        for node in own:
            around = np.unique(corners[(corners == node).any(axis=1)])
            if not len(around):
                raise InputError(f"parts.{self.name}", got="a joint with a node inside it", expected="one on its faces")
            turns = best_turns(self.places[around][None], np.ones((1, len(around))))
            padded = np.zeros((1, 3, len(around), N_COMPONENTS))
            padded[..., :3] = turns
            rows.append(sparse_rows(self.first + around[None], padded, n_nodes))
        return csr_array(vstack(rows))

    def within(self, where: str, region: Region, tolerance: float) -> Integers:
        found = put_where(where, lambda: self.cells.nodes_within(self.part.mesh, region, tolerance))
        if not len(found):
            raise InputError(where, got=f"a {region} without a node of {self.name}", expected="one with nodes")
        return self.first + found

    def point(self, name: str, place: PlaceOn, at: Floats, tolerance: float) -> Point:
        """The nearest place of its faces; or the rigid motion that fits a set of its nodes best."""
        where = f"points.{name}"
        refuse_patch(name, place)
        if place.named is not None:
            return self._of_set(name, f"{where}.set", place.named, place.side, tolerance)
        if len(at) != 3:
            raise InputError(f"{where}.at", got=f"{len(at)} numbers", expected="[x, y, z], global")
        facets = self.cells.facets
        found = nearest_place(facets, at)
        off = float(np.linalg.norm(at - found.position))
        if off > max(tolerance, OFF * float(np.ptp(self.places, axis=0).max())):
            x, y, z = found.position
            raise InputError(
                f"{where}.at",
                got=f"({at[0]:g}, {at[1]:g}, {at[2]:g}) m, {off:.4g} m off the faces of {self.name}",
                expected=f"a place on one of them; the nearest is ({x:.6g}, {y:.6g}, {z:.6g}) m",
                do=in_millimetres(self.part.mesh, self.places),
            )
        nodes, rows = facet_rows(self.cells, np.array([found.cell]), found.xi, found.eta)
        if off > tolerance:
            rows = carried(rows, at - found.position)
        spots = flat_rows(self.first + nodes, rows, np.ones(1))
        return Point(name, at, *spots, normal=facets.normals[found.cell])

    def _of_set(self, name: str, where: str, named: str, side: Side, tolerance: float) -> Point:
        nodes = self.within(where, Region("set", named=named), tolerance)
        places = self.places[nodes - self.first]
        rows = np.zeros((1, 6, len(nodes), N_COMPONENTS))
        rows[0, :3, :, :3] = np.eye(3)[:, None] / len(nodes)
        rows[0, 3:, :, :3] = best_turns(places[None], np.ones((1, len(nodes))))[0]
        touching = np.isin(self.cells.corners, nodes - self.first).all(axis=1)
        whole = (self.cells.facets.normals * self.cells.facets.areas[:, None])[touching].sum(axis=0)
        normal = outwards(whole, side) if not touching.any() else whole / max(float(np.linalg.norm(whole)), 1e-300)
        return Point(name, places.mean(axis=0), *flat_rows(nodes[None], rows, np.ones(1)), normal=normal)

    def surface(self, item: SurfaceOn, n_nodes: int, tolerance: float) -> Surface:
        """Faces of a set or in a box, their normals outwards. Raises InputError for faces all round it."""
        where = f"surfaces.{item.name}.region"
        chosen = self._facets_of(where, item.region, tolerance)
        facets = self.cells.facets
        whole = (facets.normals * facets.areas[:, None])[chosen].sum(axis=0)
        if np.linalg.norm(whole) < CLOSED * facets.areas[chosen].sum():
            raise InputError(
                where, got=f"faces all round {self.name}", expected="a side of it", do="name a set of faces, or a box"
            )
        points = cell_points(facets, chosen, ORDER)
        nodes, rows = facet_rows(self.cells, points.cells, points.xi, points.eta)
        normals = facets.normals[points.cells]
        along_normal = np.einsum("pj,pjkc->pkc", normals, rows[:, :3])[:, None]
        along, outline = frame_across(
            upwards(whole / np.linalg.norm(whole)), self.places[np.unique(self.cells.corners[chosen])]
        )
        return Surface(
            item.name,
            points=points.places,
            weights=points.weights,
            normals=normals,
            along=along,
            outline=outline,
            rows=sparse_rows(self.first + nodes, along_normal, n_nodes),
        )

    def _facets_of(self, where: str, region: Region, tolerance: float) -> Integers:
        if region.kind not in ("whole", "box", "set"):
            raise InputError(where, got=f"a {region.kind} of a solid", expected="whole, a set or a box")
        found = put_where(where, lambda: self.cells.facets_within(region, tolerance))
        if not len(found):
            raise InputError(where, got=f"a {region} without a face of {self.name}", expected="one with faces")
        return found

    def spread(self, where: str, region: Region, tolerance: float, order: int) -> Spread:
        points = cell_points(self.cells.facets, self._facets_of(where, region, tolerance), order)
        nodes, rows = facet_rows(self.cells, points.cells, points.xi, points.eta)
        return Spread(self.first + nodes, rows, points.weights, "area", region.kind)

    def stresses(self, n_nodes: int) -> StressPlaces:
        """At every node, along global axes: the mean of the cells that meet there."""
        rows, meets = [], []
        for kind, cells in self.cells.cells.items():
            k = cells.shape[1]
            at = np.tile(solid.reference_nodes(kind), (len(cells), 1))
            every = np.repeat(cells, k, axis=0)
            found = solid.stresses(kind, self.places[every], at, self.part.elasticity)
            padded = np.zeros((len(every), 6, k, N_COMPONENTS))
            padded[..., :3] = found.reshape(len(every), 6, k, 3)
            rows.append(sparse_rows(self.first + every, padded, n_nodes))
            meets.append(cells.ravel())
        every_cell, owner = csr_array(vstack(rows)), np.concatenate(meets)
        mean = mean_of_cells(owner, 6)
        return StressPlaces(self.places, STRESSES, csr_array(mean @ every_cell), ("",), every_cell, owner)

    def drawn(self, divisions: int, along: int, n_nodes: int) -> Drawn:
        """Its faces as they are: they are as fine as its motion."""
        used, corners = np.unique(self.cells.corners, return_inverse=True)
        rows = np.zeros((len(used), 3, 1, N_COMPONENTS))
        rows[:, :, 0, :3] = np.eye(3)
        nodes = (self.first + used)[:, None]
        quads = corners.reshape(-1, 4)
        return Drawn(self.places[used], sparse_rows(nodes, rows, n_nodes), quads, np.empty((0, 2), np.int64))
