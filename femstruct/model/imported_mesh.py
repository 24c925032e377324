"""A mesh as its file has it: nodes, cells by kind, named sets, and what else the file states."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from pathlib import Path
from typing import Final, Literal, NamedTuple, TypeVar

import numpy as np

from femstruct.arrays import Floats, Integers, freeze, frozen, frozen_integers
from femstruct.errors import FemstructError, InputError, list_some
from femstruct.model.regions import Facing
from femstruct.tags import stored_as

# ----------------------------------------------------------------------------------------------------------------------
# Kinds of cells of imported meshes, and the order of their nodes, which is that of VTK.
# ----------------------------------------------------------------------------------------------------------------------

Edge = tuple[int, int]

_TRIANGLE: Final = ((0, 1), (1, 2), (2, 0))
_QUAD: Final = ((0, 1), (1, 2), (2, 3), (3, 0))
_TETRAHEDRON: Final = (*_TRIANGLE, (0, 3), (1, 3), (2, 3))
_HEXAHEDRON: Final = (*_QUAD, (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))
_TETRAHEDRON_FACES: Final = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2))
_HEXAHEDRON_FACES: Final = ((0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7))


class CellKind(NamedTuple):
    """A kind of cell. dimension : 1 of lines, 2 of faces, 3 of solids. corners, nodes : how many.

    edges : pairs of corners; the node in the middle of the i-th edge of a quadratic cell is its (corners + i)-th.
    faces : corners of its faces, seen from outside counterclockwise; of solids only. Nodes in the middles of faces, if
    it has any, follow those of its edges in the order of its faces, and the one in the middle of the cell comes last.
    """

    dimension: int
    corners: int
    nodes: int
    edges: tuple[Edge, ...]
    faces: tuple[tuple[int, ...], ...] = ()

    @property
    def quadratic(self) -> bool:
        """Whether its edges have nodes in the middle."""
        return self.nodes > self.corners


KINDS: Final = {
    "line2": CellKind(1, 2, 2, ((0, 1),)),
    "line3": CellKind(1, 2, 3, ((0, 1),)),
    "tri3": CellKind(2, 3, 3, _TRIANGLE),
    "tri6": CellKind(2, 3, 6, _TRIANGLE),
    "quad4": CellKind(2, 4, 4, _QUAD),
    "quad8": CellKind(2, 4, 8, _QUAD),
    "quad9": CellKind(2, 4, 9, _QUAD),
    "tet4": CellKind(3, 4, 4, _TETRAHEDRON, _TETRAHEDRON_FACES),
    "tet10": CellKind(3, 4, 10, _TETRAHEDRON, _TETRAHEDRON_FACES),
    "hex8": CellKind(3, 8, 8, _HEXAHEDRON, _HEXAHEDRON_FACES),
    "hex20": CellKind(3, 8, 20, _HEXAHEDRON, _HEXAHEDRON_FACES),
    "hex27": CellKind(3, 8, 27, _HEXAHEDRON, _HEXAHEDRON_FACES),
}
"""By name. Faces of hexahedra come in the order of VTK's nodes in their middles: -x, +x, -y, +y, -z, +z."""


# ----------------------------------------------------------------------------------------------------------------------
# What a mesh file states and no reader makes: what it is, how often, and what it would change.
#
# Whatever a file states is of one of four classes: used; of no effect on a linear model of vibration, with the reason
# (`Makes.NOTHING`); not made, with what it would change; or malformed, which is refused with its line.
# ----------------------------------------------------------------------------------------------------------------------


@stored_as("what an unread entry makes/1")
class Makes(Enum):
    """What something of a file would make in a model; the most harmful first."""

    UNKNOWN = "unknown: stiffness, mass or supports, or a misspelt word"
    PRELOAD = "stiffness by the forces of a state before"
    ELEMENTS = "elements with stiffness and mass"
    SECTION = "stiffness or mass of cells"
    SPREAD = "mass of cells that does not stiffen"
    MATERIAL = "materials of cells"
    LAY_UP = "layers of cells"
    THICKNESS = "thickness of cells"
    OFFSET = "place of the middle of the thickness"
    ORIENTATION = "direction of the material of cells"
    BARS = "bars with stiffness and mass"
    SPRINGS = "springs and dashpots"
    MASSES = "masses"
    LINKS = "links between nodes"
    SUPPORTS = "held nodes"
    SLIGHT = "little"
    NOTHING = "nothing in a linear model of vibration"


HARMLESS: Final = (Makes.SLIGHT, Makes.NOTHING)
_ORDER: Final = list(Makes)


@stored_as("unread entry of a mesh file/1")
@dataclass(frozen=True, eq=False)
class LeftOut:
    """Something that a file states and no reader makes.

    what : as the file calls it. count : how often. line : of the first; 0 of a file without lines. makes : what it
    would make. changes : in words, what it would change, or why that is nothing. cells [n] : numbers of the elements
    that it is of; None for what is of the whole file.
    """

    what: str
    count: int
    line: int
    makes: Makes
    changes: str
    cells: Integers | None = None

    @property
    def named(self) -> str:
        """Its count, name and line: "3 CROD (line 7)"."""
        return f"{self.count} {self.what}{f' (line {self.line})' if self.line else ''}"

    @property
    def with_effect(self) -> str:
        """As `named`, with what it would change."""
        return f"{self.named}: {self.changes}"


@dataclass
class Tally:
    """What a reader has left out so far, by its name.

    >>> tally = Tally()
    >>> for line in (7, 9):
    ...     tally.add("CROD", Makes.BARS, "rods: stiffness and mass", line)
    >>> [one.with_effect for one in tally.found]
    ['2 CROD (line 7): rods: stiffness and mass']
    """

    _counts: dict[str, int] = field(default_factory=dict)
    _firsts: dict[str, tuple[int, Makes, str]] = field(default_factory=dict)
    _cells: dict[str, list[Integers]] = field(default_factory=dict)

    def add(
        self, what: str, makes: Makes, changes: str, line: int, cells: Iterable[int] | None = None, count: int = 1
    ) -> None:
        """Count it once more."""
        self._counts[what] = self._counts.get(what, 0) + count
        self._firsts.setdefault(what, (line, makes, changes))
        if cells is not None:
            self._cells.setdefault(what, []).append(np.fromiter(cells, np.int64))

    @property
    def found(self) -> tuple[LeftOut, ...]:
        """All of it, the most harmful first."""
        every = [
            LeftOut(
                what,
                count,
                *self._firsts[what],
                np.unique(np.concatenate(self._cells[what])) if what in self._cells else None,
            )
            for what, count in self._counts.items()
        ]
        return tuple(sorted(every, key=lambda one: (_ORDER.index(one.makes), one.line)))


# ----------------------------------------------------------------------------------------------------------------------
# A mesh as its file has it.
# ----------------------------------------------------------------------------------------------------------------------

T = TypeVar("T")
CONSISTENT: Final[Mapping[float, float]] = {1.0: 1.0, 1e-3: 1e3}  # kg in the unit of mass of files in metres and in mm


@stored_as("stated layer/1")
@dataclass(frozen=True)
class StatedLayer:
    """A layer of a lay-up that a file states, from the lowest up. thickness [m]. angle : in degrees, or the name of a
    coordinate system."""

    material: str
    thickness: float
    angle: float | str


@stored_as("stated property/1")
@dataclass(frozen=True)
class StatedProperty:
    """A property that a file gives a set of cells. thickness [m] : of shells, None where it states none. material : its
    name in the file, "" where it states none. layers : of a lay-up."""

    cells: str
    thickness: float | None
    material: str
    layers: tuple[StatedLayer, ...] = ()


@stored_as("stated material/1")
@dataclass(frozen=True)
class StatedMaterial:
    """A material of a file: constants by their names there, in the units of the file."""

    name: str
    constants: Mapping[str, float]


@stored_as("stated mass/1")
@dataclass(frozen=True, eq=False)
class StatedMass:
    """A mass at a node. node : row of the points. mass : in the units of the file. offset [3] : to its centre [m].
    inertia [6] : Ixx, Iyy, Izz, Ixy, Iyz, Izx about its centre, in the units of the file but for metres."""

    node: int
    mass: float
    offset: tuple[float, float, float]
    inertia: tuple[float, ...]


@stored_as("stated link/1")
@dataclass(frozen=True, eq=False)
class StatedLink:
    """Nodes that follow another as a rigid body does, or one that follows the mean motion of others.

    node : row of the points, the one; nodes [n] : rows of the others. weights [n] : of the others, where the one
    follows them; None where they follow it. follows : in which directions out of 0 to 5.
    """

    node: int
    nodes: Integers
    follows: tuple[int, ...]
    weights: tuple[float, ...] | None = None


@stored_as("stated hold/1")
@dataclass(frozen=True, eq=False)
class StatedHold:
    """Nodes that are held. name : of the set of supports that it is of. nodes [n] : rows of the points; held :
    directions out of 0 to 5."""

    name: str
    nodes: Integers
    held: tuple[int, ...]


@stored_as("stated spread/1")
@dataclass(frozen=True, eq=False)
class StatedSpread:
    """Mass on cells of a shell that does not stiffen them: per "area" or "volume" of them or in "total". what : as the
    file calls it. cells [n] : numbers of the elements. amount : in the unit of mass of the file, and metres."""

    what: str
    cells: Integers
    amount: float
    per: Literal["area", "volume", "total"]


@stored_as("stated by a mesh file/1")
@dataclass(frozen=True, eq=False)
class Stated:
    """What a file states beside its mesh. left_out : what of it is not made, the most harmful first.
    elements : numbers of those that have stiffness or mass wherever they are, by their type in the file; other
    cells may be marks of edges and faces. active : names of the sets of supports that the file puts to use, where it
    says so; others are for other load cases. open_end : of a file without the word that ends it, which may be cut, that
    word and what is last."""

    properties: tuple[StatedProperty, ...] = ()
    materials: tuple[StatedMaterial, ...] = ()
    masses: tuple[StatedMass, ...] = ()
    links: tuple[StatedLink, ...] = ()
    holds: tuple[StatedHold, ...] = ()
    left_out: tuple[LeftOut, ...] = ()
    elements: Mapping[str, Integers] = field(default_factory=dict)
    active: tuple[str, ...] = ()
    open_end: str = ""
    spread: tuple[StatedSpread, ...] = ()


@stored_as("imported mesh/1")
@dataclass(frozen=True, eq=False)
class ImportedMesh:
    """A mesh from a file, in metres.

    source : the file's name. points [n, 3] : nodes [m]; numbers [n] : what the file calls them.
    cells : rows of points [m, k] by kind of cell; cell_numbers : by kind, what the file
    calls them [m]. node_sets : rows of points by name. cell_sets : by name, rows of the cells of each kind.
    merged : cells that the file has several times, of which one is kept each.
    scale : metres in the unit of length of the file.

    Raises FemstructError for arrays that do not fit each other.

    Two cells of one set and one node of another:

    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0]])
    >>> cells, numbers = {"quad4": [[0, 1, 2, 3]], "tri3": [[1, 4, 2]]}, {"quad4": [7], "tri3": [9]}
    >>> sets = {"floor": {"quad4": [0], "tri3": [0]}}
    >>> mesh = ImportedMesh("floor.msh", square, np.arange(1, 6), cells, numbers, {"foot": [4]}, sets)
    >>> mesh.nodes_of("foot").tolist(), mesh.nodes_of("floor").tolist(), mesh.count(2)
    ([4], [0, 1, 2, 3, 4], 2)
    """

    source: str
    points: Floats
    numbers: Integers
    cells: Mapping[str, Integers]
    cell_numbers: Mapping[str, Integers]
    node_sets: Mapping[str, Integers] = field(default_factory=dict)
    cell_sets: Mapping[str, Mapping[str, Integers]] = field(default_factory=dict)
    stated: Stated = Stated()
    merged: int = 0
    scale: float = 1.0

    def __post_init__(self) -> None:
        where, points = f"mesh {self.source}", frozen(f"mesh {self.source} points", self.points, (None, 3))
        if unknown := [kind for kind in self.cells if kind not in KINDS]:
            raise FemstructError(where, got=f"cells '{unknown[0]}'", expected=list_some(KINDS, len(KINDS)))
        cells = {k: frozen_integers(f"{where} {k}", one, (None, KINDS[k].nodes)) for k, one in self.cells.items()}
        for kind, one in cells.items():
            _refuse_beyond(f"{where} {kind}", one, len(points))
        sets = {
            name: {kind: frozen_integers(f"{where} {name}", rows, (None,)) for kind, rows in of.items()}
            for name, of in self.cell_sets.items()
        }
        for name, of in sets.items():
            for kind, rows in of.items():
                _refuse_beyond(f"{where} {name}", rows, len(cells.get(kind, ())))
        nodes = {name: frozen_integers(f"{where} {name}", rows, (None,)) for name, rows in self.node_sets.items()}
        for name, rows in nodes.items():
            _refuse_beyond(f"{where} {name}", rows, len(points))
        freeze(
            self,
            points=points,
            numbers=frozen_integers(f"{where} numbers", self.numbers, (len(points),)),
            cells=cells,
            cell_numbers={
                kind: frozen_integers(f"{where} numbers", self.cell_numbers[kind], (len(one),))
                for kind, one in cells.items()
            },
            node_sets=nodes,
            cell_sets=sets,
        )

    @property
    def unit_of_mass(self) -> float:
        """That of the file [kg], which its unit of length has beside it; 0 where it is not known."""
        return CONSISTENT.get(self.scale, 0.0)

    def count(self, dimension: int) -> int:
        """How many cells of a dimension it has: 1 of lines, 2 of faces, 3 of solids."""
        return sum(len(one) for kind, one in self.cells.items() if KINDS[kind].dimension == dimension)

    def cells_of(self, name: str | None, dimension: int) -> dict[str, Integers]:
        """Rows of the cells of a dimension in a set, by kind; of all of them without a name.

        Raises InputError for a set that is not there, and for one without such cells.
        """
        words = {1: "lines", 2: "triangles or quadrilaterals", 3: "tetrahedra or hexahedra"}[dimension]
        kinds = [kind for kind in self.cells if KINDS[kind].dimension == dimension]
        rows = {kind: np.arange(len(self.cells[kind])) for kind in kinds}
        if name is not None:
            self._known(name)
            of = self.cell_sets.get(name, {})
            rows = {kind: of[kind] for kind in kinds if kind in of}
        found = {kind: some for kind, some in rows.items() if len(some)}
        if not found:
            having = [one for one, of in self.cell_sets.items() if any(len(of.get(kind, ())) for kind in kinds)]
            got = f"no {words} in {self.source}" if name is None else f"'{name}', a set without {words}"
            raise InputError("", got=got, expected=words, do=f"sets with them: {list_some(having)}" if having else "")
        return found

    def middles_of(self, name: str | None, dimension: int) -> Floats:
        """Middles [n, 3] of the cells of a dimension in a set, or of all of them [m]."""
        cells = self.cells_of(name, dimension)
        corners = [self.cells[kind][rows][:, : KINDS[kind].corners] for kind, rows in cells.items()]
        return np.concatenate([self.points[nodes].mean(axis=1) for nodes in corners])

    def nodes_of(self, name: str) -> Integers:
        """Rows of the nodes of a set: of its nodes, or of its cells. Raises InputError for a set that is not there."""
        self._known(name)
        groups = [self.node_sets[name]] if name in self.node_sets else []
        groups += [self.cells[kind][rows].ravel() for kind, rows in self.cell_sets.get(name, {}).items()]
        return np.unique(np.concatenate(groups))

    @property
    def set_names(self) -> tuple[str, ...]:
        """Names of all its sets."""
        return tuple(dict.fromkeys((*self.cell_sets, *self.node_sets)))

    def _known(self, name: str) -> None:
        if name not in self.node_sets and name not in self.cell_sets:
            if not self.cells:
                got = f"'{name}', no set of {self.source}, which has no elements"
                raise InputError("", got=got, expected="a mesh of elements", do="is the file cut?")
            known = list_some(self.set_names) if self.set_names else "a mesh with named sets"
            raise InputError("", got=f"'{name}', no set of {self.source}", expected=known)


def with_where(where: str, compute: Callable[[], T]) -> T:
    """What is asked of a mesh, its refusal put where it was asked for."""
    try:
        return compute()
    except InputError as error:
        raise InputError(where, got=error.got, expected=error.expected, do=error.do) from None


def _refuse_beyond(where: str, rows: Integers, count: int) -> None:
    if rows.size and not (rows.min() >= 0 and rows.max() < count):
        raise FemstructError(where, got="a row that is not there", expected=f"0..{count - 1}")


# ----------------------------------------------------------------------------------------------------------------------
# From the numbers of a file to rows: nodes and cells as a file names them become one mesh.
# ----------------------------------------------------------------------------------------------------------------------


class CellBlock(NamedTuple):
    """Cells of one kind as a file has them: numbers [m], and the numbers of their nodes [m, k]."""

    kind: str
    numbers: Integers
    nodes: Integers


class Gathered(NamedTuple):
    """What a reader finds in a file, everything by the numbers that the file gives.

    nodes [n], points [n, 3]; blocks of cells, whose numbers differ; node_sets, cell_sets : numbers by name.
    stated : with numbers in place of rows. repeats : cells of the same nodes are one, as where a file names an element
    once for each of its groups. included : other files that it names, whose text is part of it.
    """

    nodes: Integers
    points: Floats
    blocks: Sequence[CellBlock]
    node_sets: Mapping[str, Integers]
    cell_sets: Mapping[str, Integers]
    stated: Stated = Stated()
    repeats: bool = False
    included: tuple[Path, ...] = ()


def import_mesh(source: str, found: Gathered, scale: float) -> ImportedMesh:
    """The mesh of what a reader found.

    Parameters
    ----------
    scale : float
        Metres in the file's unit of length.

    Raises
    ------
    InputError
        For numbers that occur twice or that nothing has.
    """
    nodes, rows = _ordered(found.nodes, "node")
    blocks = _by_kind(found.blocks)
    cells = {kind: _rows(nodes, rows, block.nodes, "node") for kind, block in blocks.items()}
    kept = {kind: _first_of_equals(one) if found.repeats else np.arange(len(one)) for kind, one in cells.items()}
    lone = {kind: np.unique(first) for kind, first in kept.items()}
    place = {kind: np.searchsorted(lone[kind], first) for kind, first in kept.items()}  # of each cell among those kept
    owners = np.concatenate([np.full(len(one), k) for k, one in enumerate(cells.values())] or [np.zeros(0, np.int64)])
    places = np.concatenate([*place.values(), np.zeros(0, np.int64)]).astype(np.int64)
    all_cells, order = _ordered(
        np.concatenate([*(b.numbers for b in blocks.values()), np.zeros(0, np.int64)]), "element"
    )
    sets: dict[str, dict[str, Integers]] = {}
    for name, numbers in found.cell_sets.items():
        at = _rows(all_cells, order, numbers, "element")
        of = {kind: np.unique(places[at[owners[at] == k]]) for k, kind in enumerate(cells)}
        sets[name] = {kind: some for kind, some in of.items() if len(some)}
    return ImportedMesh(
        source,
        found.points * scale,
        numbers=found.nodes,
        cells={kind: one[lone[kind]] for kind, one in cells.items()},
        cell_numbers={kind: block.numbers[lone[kind]] for kind, block in blocks.items()},
        node_sets={name: np.unique(_rows(nodes, rows, some, "node")) for name, some in found.node_sets.items()},
        cell_sets=sets,
        stated=_in_rows(found.stated, nodes, rows, scale),
        merged=sum(len(cells[kind]) - len(one) for kind, one in lone.items()),
        scale=scale,
    )


_LENGTHS: Final = {"area": 2, "volume": 3, "total": 0}  # in the unit of an amount of mass


def _by_kind(blocks: Sequence[CellBlock]) -> dict[str, CellBlock]:
    together: dict[str, list[CellBlock]] = {}
    for block in blocks:
        together.setdefault(block.kind, []).append(block)
    return {
        kind: CellBlock(kind, np.concatenate([b.numbers for b in some]), np.concatenate([b.nodes for b in some]))
        for kind, some in together.items()
        if sum(len(b.numbers) for b in some)
    }


def _ordered(numbers: Integers, what: str) -> tuple[Integers, Integers]:
    """The numbers in ascending order, and the row of each."""
    order = np.argsort(numbers, kind="stable")
    ascending = numbers[order]
    twice = ascending[1:][np.diff(ascending) == 0]
    if len(twice):
        raise InputError("", got=f"{what} {twice[0]} twice", expected=f"numbers of {what}s that differ")
    return ascending, order


def _rows(ascending: Integers, order: Integers, numbers: Integers, what: str) -> Integers:
    """Rows of the wanted numbers."""
    at = np.minimum(np.searchsorted(ascending, numbers), max(len(ascending) - 1, 0))
    missing = numbers[ascending[at] != numbers] if len(ascending) else numbers.ravel()
    if missing.size:
        raise InputError(
            "", got=f"{what} {list_some(np.unique(missing), 3)}, which it does not have", expected=f"{what}s of its own"
        )
    return order[at].astype(np.int64)


def _first_of_equals(cells: Integers) -> Integers:
    """For each cell [m, k] the first one with the same nodes, in whatever order [m]."""
    _, first, group = np.unique(np.sort(cells, axis=1), axis=0, return_index=True, return_inverse=True)
    return first[group.ravel()].astype(np.int64)


def _in_rows(stated: Stated, nodes: Integers, rows: Integers, scale: float) -> Stated:
    """The same with rows of nodes for their numbers, and lengths in metres."""

    def of(numbers: Integers | int) -> Integers:
        return _rows(nodes, rows, np.atleast_1d(np.asarray(numbers, dtype=np.int64)), "node")

    return replace(
        stated,
        properties=tuple(
            replace(
                one,
                thickness=None if one.thickness is None else one.thickness * scale,
                layers=tuple(replace(layer, thickness=scale * layer.thickness) for layer in one.layers),
            )
            for one in stated.properties
        ),
        masses=tuple(
            replace(
                one,
                node=int(of(one.node)[0]),
                offset=(scale * one.offset[0], scale * one.offset[1], scale * one.offset[2]),
                inertia=tuple(scale**2 * x for x in one.inertia),
            )
            for one in stated.masses
        ),
        links=tuple(replace(one, node=int(of(one.node)[0]), nodes=of(one.nodes)) for one in stated.links),
        holds=tuple(replace(one, nodes=of(one.nodes)) for one in stated.holds),
        spread=tuple(replace(one, amount=one.amount / scale ** _LENGTHS[one.per]) for one in stated.spread),
    )


# ----------------------------------------------------------------------------------------------------------------------
# Which way surfaces of imported meshes face, and the rectangle round them.
# ----------------------------------------------------------------------------------------------------------------------

STEEP: Final = float(np.cos(np.radians(45.0)))  # from there on neither side is above or below
LEVEL: Final = 1e-9  # sine of the angle to the horizontal
STRAIGHT: Final = 1e-9  # sine of the angle between two edges of one straight line


def outwards(normal: Floats, side: Facing) -> Floats:
    """Unit normal out of the named side: above is up along global z; where neither side is up, that of the cells' own
    normals; x, -x, y and -y is the side that faces that way."""
    length = float(np.linalg.norm(normal))
    unit = normal / length if length > 0 else np.array([0.0, 0.0, 1.0])
    if side not in ("above", "below"):
        return np.asarray(unit * np.sign(unit @ towards(side)))
    up = 1.0 if unit[2] > 0 or abs(unit[2]) < STEEP - 1e-12 else -1.0
    return np.asarray(unit * (up if side == "above" else -up))


def towards(side: Facing) -> Floats:
    """The global direction [3] of a side that is named by one.

    >>> towards("-y").tolist()
    [0.0, -1.0, 0.0]
    """
    direction = np.zeros(3)
    direction["xyz".index(side[-1])] = -1.0 if side.startswith("-") else 1.0
    return direction


def faces_towards(normal: Floats, side: Facing) -> bool:
    """Whether a side of something with that normal is within 45 degrees of the direction that names it; always, of
    above and below."""
    length = float(np.linalg.norm(normal))
    return side in ("above", "below") or abs(float(normal @ towards(side))) >= STEEP * length - 1e-12


def frame_across(normal: Floats, places: Floats) -> tuple[Floats, Floats]:
    """Two directions [2, 3] across a normal, and the corners [4, 3] of the rectangle along them round places."""
    x = np.eye(3)[0] if abs(normal[0]) < STEEP else np.eye(3)[1]
    x = x - (x @ normal) * normal
    x /= np.linalg.norm(x)
    along = np.stack([x, np.cross(normal, x)])
    return along, rectangle_round(along, places)


def upwards(normal: Floats) -> Floats:
    """The normal, or its opposite, so that it does not point down: x and y under a surface are those above it."""
    return normal if normal[2] >= -LEVEL * float(np.linalg.norm(normal)) else -normal


def rectangle_round(along: Floats, places: Floats) -> Floats:
    """Corners [4, 3] of the rectangle along two directions [2, 3] round places [n, 3] [m]."""
    flat = (places - places.mean(axis=0)) @ along.T
    low, high = flat.min(axis=0), flat.max(axis=0)
    corners = np.array([[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]])
    return np.asarray(places.mean(axis=0) + corners @ along)


def outer_line(points: Floats, cells: Integers) -> Floats | None:
    """Corners [n, 3] in turn of the longest closed line round cells [m, 4] [m]; None where there is none, as round a
    closed surface, or where lines touch.

    Parameters
    ----------
    points : Floats [.., 3]
        Of the nodes. Triangles have their last corner twice.

    Examples
    --------
    >>> grid = np.array([[x, y, 0.0] for x in (0, 1, 2) for y in (0, 1, 2)])
    >>> cells = np.array([[0, 3, 4, 1], [3, 6, 7, 4], [1, 4, 5, 2]])  # an L
    >>> outer_line(grid, cells)[:, :2].tolist()
    [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]
    """
    edges = np.stack([cells, np.roll(cells, -1, axis=1)], axis=-1).reshape(-1, 2)
    edges = edges[edges[:, 0] != edges[:, 1]]
    _, place, times = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True, return_counts=True)
    open_edges = edges[times[place.ravel()] == 1]
    ahead = dict(open_edges.tolist())
    if not len(ahead) or len(ahead) < len(open_edges) or set(ahead) != set(ahead.values()):
        return None
    loops, left = [], dict(ahead)
    while left:
        start, node = next(iter(left.items()))
        loop = [start]
        del left[start]
        while node != start:
            loop.append(node)
            node = left.pop(node)
        loops.append(points[loop])
    line = max(loops, key=lambda loop: float(np.linalg.norm(np.roll(loop, -1, axis=0) - loop, axis=1).sum()))
    steps = np.roll(line, -1, axis=0) - line
    turn = np.linalg.norm(np.cross(np.roll(steps, 1, axis=0), steps), axis=1)
    sizes = np.linalg.norm(steps, axis=1)
    return np.asarray(line[turn > STRAIGHT * sizes * np.roll(sizes, 1)])
