"""A mesh as its file has it: nodes, cells by kind, named sets, and what else the file states."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Final, Literal, TypeVar

import numpy as np

from femstruct.arrays import Floats, Integers, freeze, frozen, frozen_integers
from femstruct.errors import FemstructError, InputError, some_of
from femstruct.model.imported.cell_kinds import KINDS
from femstruct.model.imported.stated.left_out import LeftOut
from femstruct.tags import stored_as

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
    cells : rows of points [m, k] by kind (`femstruct.model.imported.cell_kinds`); cell_numbers : by kind, what the file
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
            raise FemstructError(where, got=f"cells '{unknown[0]}'", expected=some_of(KINDS, len(KINDS)))
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
            raise InputError("", got=got, expected=words, do=f"sets with them: {some_of(having)}" if having else "")
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
            known = some_of(self.set_names) if self.set_names else "a mesh with named sets"
            raise InputError("", got=f"'{name}', no set of {self.source}", expected=known)


def put_where(where: str, asked: Callable[[], T]) -> T:
    """What is asked of a mesh, its refusal put where it was asked for."""
    try:
        return asked()
    except InputError as error:
        raise InputError(where, got=error.got, expected=error.expected, do=error.do) from None


def _refuse_beyond(where: str, rows: Integers, count: int) -> None:
    if rows.size and not (rows.min() >= 0 and rows.max() < count):
        raise FemstructError(where, got="a row that is not there", expected=f"0..{count - 1}")
