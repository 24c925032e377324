"""Parts of mesh files with their nodes: places on their cells, regions, surfaces, what is drawn of them."""

from __future__ import annotations

from abc import abstractmethod
from typing import ClassVar, Final, NamedTuple

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.errors import InputError
from femstruct.model.imported.flat_cells import FlatCells
from femstruct.model.imported.imported_mesh import ImportedMesh, put_where
from femstruct.model.imported.nearest import nearest_places
from femstruct.model.imported.shell_cells import cell_points
from femstruct.model.imported.solid_cells import SolidCells
from femstruct.model.imported.unit_slips import in_millimetres
from femstruct.model.meshed import Drawn, Meshed, Spread, refuse_not_global, refuse_patch
from femstruct.model.probe import Point
from femstruct.model.region import Region, Side
from femstruct.model.rows import carried, flat_rows
from femstruct.model.structure import PlaceOn
from femstruct.parts.of_meshes.given_nodes import drawn_nodes
from femstruct.parts.of_meshes.mesh_part import MeshPart

ORDER: Final = 2  # Gauss points a direction in each facet of a surface: its deflection is bilinear
CLOSED: Final = 1e-3  # of its area: a surface whose normals add to less has no side


class Words(NamedTuple):
    """What messages call it: the kind, one of its facets, what a place is off, and what it should be on."""

    kind: str
    facet: str
    off: str
    on: str


class CellsMesh(Meshed):
    """A part on cells of a mesh; the base of meshed shells and solids.

    cells : with nodes counted from 0 on. Facets are what places and surfaces of it are on: the cells of a shell, the
    faces of a solid.
    """

    part: MeshPart
    cells: FlatCells | SolidCells
    words: ClassVar[Words]

    @property
    def name(self) -> str:
        return self.part.name

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
    def held_together(self) -> list[Integers]:
        label = self.cells.held_together()
        order = np.argsort(label, kind="stable")
        return list(np.split(self.first + order, np.flatnonzero(np.diff(label[order])) + 1))

    @property
    @abstractmethod
    def facets(self) -> FlatCells:
        """Its facets, with nodes of their own."""

    @abstractmethod
    def facet_motion(self, which: Integers, xi: Floats, eta: Floats) -> tuple[Integers, Floats]:
        """Motion at places in facets [p]: nodes [p, 4] of the whole structure, rows [p, 6, 4, 7], global axes."""

    @property
    def has_cells(self) -> bool:
        return True

    def off_cells(self, places: Floats) -> Floats:
        found: Floats = np.linalg.norm(nearest_places(self.facets, places).positions - places, axis=1)
        return found

    def motion_on_cells(self, places: Floats) -> tuple[Integers, Floats]:
        found = nearest_places(self.facets, places)
        nodes, rows = self.facet_motion(found.cells, found.xi, found.eta)
        return nodes, carried(rows, places - found.positions)

    @abstractmethod
    def facet_reach(self, facet: int, tolerance: float) -> float:
        """How far off a facet a place of it may be [m]."""

    @abstractmethod
    def facet_normal(self, facet: int, side: Side) -> Floats:
        """Unit normal [3] at a place of a facet out of the named side."""

    @abstractmethod
    def facets_within(self, region: Region, tolerance: float) -> Integers:
        """Numbers of the facets of a set, in a box, or of all of them."""

    @abstractmethod
    def mean_of(self, name: str, nodes: Integers, side: Side) -> Point:
        """A point that moves as some of its nodes do in the mean."""

    def within(self, where: str, region: Region, tolerance: float) -> Integers:
        found = put_where(where, lambda: self.cells.nodes_within(self.part.mesh, region, tolerance))
        if not len(found):
            raise InputError(where, got=f"a {region} without a node of {self.name}", expected="one with nodes")
        return self.first + found

    def point(self, name: str, place: PlaceOn, at: Floats, tolerance: float) -> Point:
        """The nearest place of its facets, on a rigid arm where it is off them; or the mean of a set of its nodes."""
        refuse_patch(name, place)
        if place.named is not None:
            nodes = self.within(f"points.{name}.set", Region("set", named=place.named), tolerance)
            return self.mean_of(name, nodes, place.side)
        refuse_not_global(name, at)
        found = nearest_places(self.facets, at[None])
        cell, (x, y, z) = int(found.cells[0]), found.positions[0]
        off = float(np.linalg.norm(at - found.positions[0]))
        if off > self.facet_reach(cell, tolerance):
            raise InputError(
                f"points.{name}.at",
                got=f"({at[0]:g}, {at[1]:g}, {at[2]:g}) m, {off:.4g} m off {self.words.off}{self.name}",
                expected=f"a place on {self.words.on}; the nearest is ({x:.6g}, {y:.6g}, {z:.6g}) m",
                do=in_millimetres(self.part.mesh, self.places),
            )
        nodes, rows = self.facet_motion(found.cells, found.xi, found.eta)
        if off > tolerance:
            rows = carried(rows, at - found.positions[0])
        return Point(name, at, *flat_rows(nodes, rows, np.ones(1)), normal=self.facet_normal(cell, place.side))

    def chosen(self, where: str, region: Region, tolerance: float) -> Integers:
        """Numbers of the facets of a region. Raises InputError for one that a mesh does not have, or without any."""
        if region.kind not in ("whole", "box", "set"):
            got = f"a {region.kind} of a {self.words.kind}"
            raise InputError(where, got=got, expected="whole, a set or a box")
        found = put_where(where, lambda: self.facets_within(region, tolerance))
        if not len(found):
            got = f"a {region} without a {self.words.facet} of {self.name}"
            raise InputError(where, got=got, expected=f"one with {self.words.facet}s")
        return found

    def spread(self, where: str, region: Region, tolerance: float, order: int) -> Spread:
        points = cell_points(self.facets, self.chosen(where, region, tolerance), order)
        nodes, rows = self.facet_motion(points.cells, points.xi, points.eta)
        return Spread(nodes, rows, points.weights, "area", region.kind)

    def drawn(self, divisions: int, along: int, n_nodes: int) -> Drawn:
        """Its facets as they are: they are as fine as its motion."""
        used, corners = np.unique(self.cells.corners, return_inverse=True)
        quads, no_lines = corners.reshape(-1, 4), np.empty((0, 2), np.int64)
        return drawn_nodes(self.places[used], self.first + used, quads, no_lines, n_nodes)
