"""Parts of mesh files with their nodes: places on their cells, regions, surfaces, what is drawn of them."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import ClassVar, Final, NamedTuple

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.conventions import DIRECTIONS, N_COMPONENTS
from femstruct.errors import InputError
from femstruct.model.flat_cells import FlatCells, in_millimetres
from femstruct.model.imported_mesh import (
    ImportedMesh,
    Makes,
    faces_towards,
    frame_across,
    outer_line,
    outwards,
    rectangle_round,
    upwards,
    with_where,
)
from femstruct.model.lay_ups import LayUp, materials_of
from femstruct.model.layout import Layout
from femstruct.model.materials import AnyMaterial, Given, Material, given_fields
from femstruct.model.part import Drawn, Meshed, Part, RegionSpread, refuse_not_global, refuse_patch
from femstruct.model.probe import Point, Surface
from femstruct.model.regions import Facing, Region, Side, Vector, carry_along_arms, flat_rows, sparse_rows
from femstruct.model.shell_cells import CellPlaces, cell_points, nearest_places
from femstruct.model.solid_cells import SolidCells
from femstruct.model.structure import PlaceOn, SurfaceOn

# ----------------------------------------------------------------------------------------------------------------------
# Parts whose nodes are given, by a mesh or with matrices: no grid is laid out for them.
# ----------------------------------------------------------------------------------------------------------------------


class GivenNodes(Part):
    """A part whose nodes are where they are given; the base of such kinds."""

    def lay_out(self, layout: Layout) -> None:
        layout.given.add(self.name)


def drawn_nodes(places: Floats, nodes: Integers, quads: Integers, lines: Integers, n_nodes: int) -> Drawn:
    """Cells and lines between nodes [n] at places [n, 3] [m], straight as they are, for pictures.

    Parameters
    ----------
    quads, lines : Integers [q, 4], Integers [l, 2]
        Rows of the nodes.
    """
    rows = np.zeros((len(nodes), 3, 1, N_COMPONENTS))
    rows[:, :, 0, :3] = np.eye(3)
    return Drawn(places, sparse_rows(nodes[:, None], rows, n_nodes), quads, lines)


def node_point(name: str, place: PlaceOn, at: Floats, part: Meshed, expected: str, tolerance: float) -> Point:
    """A point at a node of a part whose motion is known at its nodes alone.

    Parameters
    ----------
    expected : str
        What such a node is, for the message.

    Raises
    ------
    InputError
        For a set, a patch, and a place that is farther from every node than the tolerance.
    """
    where = f"points.{name}"
    refuse_patch(name, place)
    if place.named is not None:
        raise InputError(f"{where}.set", got=f"a set of {part.name}", expected="at: [x, y, z]")
    refuse_not_global(name, at)
    off = np.linalg.norm(part.places - at, axis=1)
    node = int(off.argmin())
    if off[node] > tolerance:
        x, y, z = part.places[node]
        raise InputError(
            f"{where}.at",
            got=f"({at[0]:g}, {at[1]:g}, {at[2]:g}) m, {off[node]:.4g} m from the nearest node of {part.name}",
            expected=f"{expected}; the nearest is at ({x:.6g}, {y:.6g}, {z:.6g}) m",
        )
    up = np.array([0.0, 0.0, 1.0 if place.side == "above" else -1.0])
    six = len(DIRECTIONS)
    return Point(name, at, np.full(six, part.first + node), np.arange(six), np.eye(six), normal=up)


# ----------------------------------------------------------------------------------------------------------------------
# Parts whose shape is the mesh of a file, before they have nodes.
# ----------------------------------------------------------------------------------------------------------------------


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
        with_where(f"parts.{self.name}.{key}", lambda: self.own_cells)
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
        kept = tuple(one for one in given_fields(self, self.units) if one.what != "mesh")
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


# ----------------------------------------------------------------------------------------------------------------------
# Parts of mesh files with their nodes.
# ----------------------------------------------------------------------------------------------------------------------

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
        return nodes, carry_along_arms(rows, places - found.positions)

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
        found = with_where(where, lambda: self.cells.nodes_within(self.part.mesh, region, tolerance))
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
            rows = carry_along_arms(rows, at - found.positions[0])
        return Point(name, at, *flat_rows(nodes, rows, np.ones(1)), normal=self.facet_normal(cell, place.side))

    def chosen(self, where: str, region: Region, tolerance: float) -> Integers:
        """Numbers of the facets of a region. Raises InputError for one that a mesh does not have, or without any."""
        if region.kind not in ("whole", "box", "set"):
            got = f"a {region.kind} of a {self.words.kind}"
            raise InputError(where, got=got, expected="whole, a set or a box")
        found = with_where(where, lambda: self.facets_within(region, tolerance))
        if not len(found):
            got = f"a {region} without a {self.words.facet} of {self.name}"
            raise InputError(where, got=got, expected=f"one with {self.words.facet}s")
        return found

    def spread(self, where: str, region: Region, tolerance: float, order: int) -> RegionSpread:
        points = cell_points(self.facets, self.chosen(where, region, tolerance), order)
        nodes, rows = self.facet_motion(points.cells, points.xi, points.eta)
        return RegionSpread(nodes, rows, points.weights, "area", region.kind)

    def drawn(self, divisions: int, along: int, n_nodes: int) -> Drawn:
        """Its facets as they are: they are as fine as its motion."""
        used, corners = np.unique(self.cells.corners, return_inverse=True)
        quads, no_lines = corners.reshape(-1, 4), np.empty((0, 2), np.int64)
        return drawn_nodes(self.places[used], self.first + used, quads, no_lines, n_nodes)


# ----------------------------------------------------------------------------------------------------------------------
# Sides of a shell: which way its surfaces face.
# ----------------------------------------------------------------------------------------------------------------------


def signs_of_side(where: str, name: str, cells: FlatCells, chosen: Integers, side: Facing) -> Floats:
    """1 or -1 for each cell [q + t], its normal out of the named side or into it; 0 for those that are not chosen.

    Patch by patch, since where three cells meet at an edge no patch says how the next one is turned. Above and below
    are told as for a plate; where neither side is up, above is that of the cells' own normals.

    Parameters
    ----------
    where, name : str
        For messages.

    Raises
    ------
    InputError
        For a closed patch, whose normals add to nothing, and for one sided as a Moebius strip.
    """
    vectors, areas = cells.normals * cells.areas[:, None], cells.areas
    signs = np.zeros(len(areas))
    for patch in np.unique(cells.patches[chosen]):
        own = chosen[cells.patches[chosen] == patch]
        whole = vectors[own].sum(axis=0)
        if np.linalg.norm(whole) < CLOSED * areas[own].sum():
            got = f"all of {name}, which is closed"
            raise InputError(where, got=got, expected="a side of it", do="name a set, or a box")
        if not faces_towards(whole, side):
            got, expected = f"the side of {name} towards {side}, to which it is not turned", "within 45 degrees of it"
            raise InputError(where.replace(".region", ".side"), got=got, expected=expected)
        signs[own] = np.sign(outwards(whole, side) @ whole)
    if not cells.two_sided:
        raise InputError(where, got=f"a side of {name}, which has only one, as a Moebius strip", expected="two")
    return signs


def mean_normal(cells: FlatCells, nodes: Integers, side: Side) -> Floats:
    """Unit normal [3] out of the named side of the cells around nodes, counted in the part, by their areas."""
    touching = np.isin(cells.corners, nodes).any(axis=1)
    return outwards((cells.normals * cells.areas[:, None])[touching].sum(axis=0), side)


# ----------------------------------------------------------------------------------------------------------------------
# Surfaces over cells: where they lie, which way they face, and how they move along their normals.
# ----------------------------------------------------------------------------------------------------------------------

Motion = Callable[[Integers, Floats, Floats], tuple[Integers, Floats]]
"""From cells [p] and places xi, eta [p] in them to nodes [p, 4] of the structure and rows [p, 6, 4, 7], global axes."""


def side_surface(
    item: SurfaceOn,
    name: str,
    cells: FlatCells,
    chosen: Integers,
    motion: Motion,
    n_nodes: int,
    lies: tuple[Floats | float, float],
) -> Surface:
    """A side of some cells of a part.

    Above and below are told as for a plate; where neither side is up, above is that of the cells' own normals.

    Parameters
    ----------
    lies : tuple[Floats | float, float]
        Half the thickness, of each cell or all, and how far the middle of it is from the cells along their normals [m].

    Raises
    ------
    InputError
        For a closed surface, whose normals add to nothing.
    """
    points = cell_points(cells, chosen, ORDER)
    signs = signs_of_side(f"surfaces.{item.name}.region", name, cells, chosen, item.side)
    normals = signs[points.cells, None] * cells.normals[points.cells]
    whole = points.weights @ normals
    along = frame_across(upwards(whole / float(np.linalg.norm(whole))), cells.points)[0]
    outline = outer_line(cells.points, cells.corners[chosen])
    if outline is None:
        outline = rectangle_round(along, cells.points[np.unique(cells.corners[chosen])])
    reached = np.broadcast_to(lies[0], len(signs))[points.cells] + signs[points.cells] * lies[1]
    out = float(points.weights @ reached / points.weights.sum())
    return replace(surface_at(item.name, points, normals, (along, outline), motion, n_nodes), out=out)


def surface_at(
    name: str, points: CellPlaces, normals: Floats, lies: tuple[Floats, Floats], motion: Motion, n_nodes: int
) -> Surface:
    """The surface at points of cells with normals [p, 3] outwards.

    Parameters
    ----------
    lies : tuple[Floats, Floats]
        Directions [2, 3] along it, and its outline [.., 3] [m].
    """
    nodes, rows = motion(points.cells, points.xi, points.eta)
    along_normal = np.einsum("pj,pjkc->pkc", normals, rows[:, :3])[:, None]
    return Surface(
        name,
        points=points.places,
        weights=points.weights,
        normals=normals,
        along=lies[0],
        outline=lies[1],
        rows=sparse_rows(nodes, along_normal, n_nodes),
    )
