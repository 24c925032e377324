"""What a structure takes of what a mesh file states beside its cells, and on which nodes: supports, links, masses.

A node of the file is one node, however many parts of ours have it: what is attached to it is attached to all of
them. A node that leads a link and is of no cell, as the middle of a spider, gets a node of its own.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from scipy.sparse import csr_array, vstack

from femstruct.arrays import Floats, Integers, freeze, frozen_integers
from femstruct.conventions import DIRECTIONS, N_COMPONENTS
from femstruct.errors import InputError, list_some
from femstruct.model.constraints import UNDETERMINED, fitted_motion
from femstruct.model.imported_mesh import KINDS, ImportedMesh, Makes, StatedHold, StatedLink, StatedMass
from femstruct.model.part import Meshed
from femstruct.model.regions import carry_along_arms, node_rows, sparse_rows

Users = Sequence[tuple[ImportedMesh, Mapping[str, Integers]]]
"""Meshes of files with the rows of the cells that parts take of them, by kind."""
TAKEN: Final = ("supports", "links", "masses")
SETS_SHOWN: Final = 6


@dataclass(frozen=True, eq=False)
class Attached:
    """What is taken of a file, by rows of its points, on nodes that parts have.

    take : out of `TAKEN`. alone [n] : rows that get a node of their own. left : what could not be taken, in words.
    """

    mesh: ImportedMesh
    take: tuple[str, ...]
    holds: tuple[StatedHold, ...]
    links: tuple[StatedLink, ...]
    masses: tuple[StatedMass, ...]
    alone: Integers
    left: tuple[str, ...]

    def __post_init__(self) -> None:
        freeze(self, alone=frozen_integers(f"mesh {self.mesh.source} alone", self.alone, (None,)))


def same_file(one: ImportedMesh, other: ImportedMesh) -> bool:
    """Whether two meshes are of one file, read with one unit of length."""
    return one is other or (one.source == other.source and np.array_equal(one.points, other.points))


def refuse_missing(where: str, mesh: ImportedMesh, take: Sequence[str]) -> None:
    """Raise InputError for what is to be taken and the file does not state."""
    stated = dict(zip(TAKEN, (mesh.stated.holds, mesh.stated.links, mesh.stated.masses), strict=True))
    having = [word for word, some in stated.items() if some]
    wrong = [word for word in take if word not in having]
    if wrong or not take:
        unmade = {"supports": Makes.SUPPORTS, "links": Makes.LINKS, "masses": Makes.MASSES}
        left = [one.named for one in mesh.stated.left_out if wrong and one.makes is unmade[wrong[0]]]
        some = (
            f"{wrong[0]}, which {mesh.source} states only as {list_some(left, 3)}, which are not read" if left else ""
        )
        raise InputError(
            where,
            got=some or (f"{wrong[0]}, which {mesh.source} does not state" if wrong else "nothing"),
            expected=list_some(having) or f"supports, links or masses, of which {mesh.source} states none that is read",
            do=f"write {wrong[0] if wrong[0] != 'links' else 'joints or constraints'} in the model" if left else "",
        )


def supports_of(where: str, mesh: ImportedMesh, named: Sequence[str]) -> tuple[StatedHold, ...]:
    """Held nodes of the named sets of supports; without names of those that the file puts to use, or of its only one.

    Raises InputError for a set that is not there, and where nothing says which of several is meant.
    """
    known = list(dict.fromkeys(one.name for one in mesh.stated.holds))
    unknown = [name for name in named if name not in known]
    if unknown:
        raise InputError(where, got=f"'{unknown[0]}'", expected=f"sets of supports: {list_some(known, SETS_SHOWN)}")
    names = named or [name for name in known if name in mesh.stated.active] or known
    if not named and len(names) == len(known) > 1 and not mesh.stated.active:
        raise InputError(
            where,
            got=f"supports of {mesh.source}, which has {len(known)} sets of them",
            expected=f"'supports' beside, those that hold: {list_some(known, SETS_SHOWN)}",
            do=f"write supports: [{known[0]}], or all of them",
        )
    return tuple(one for one in mesh.stated.holds if one.name in names)


def attach_stated(mesh: ImportedMesh, take: Sequence[str], holds: Sequence[StatedHold], users: Users) -> Attached:
    """What is taken of a file where parts have its nodes.

    Parameters
    ----------
    holds : Sequence[StatedHold]
        Those of its supports that are meant.
    """
    there, turning = _nodes_of(mesh, users)
    held = tuple(holds) if "supports" in take else ()
    masses = mesh.stated.masses if "masses" in take else ()
    every = mesh.stated.links if "links" in take else ()
    matter = np.zeros(len(there), dtype=bool)  # what nodes without a cell are needed for
    matter[np.array([*(one.node for one in masses), *(one.node for one in every)], np.int64)] = True
    matter[_together(one.nodes for one in held)] = True
    placed, links = _reached(there, matter, every)
    leading = np.zeros(len(there), dtype=bool)
    leading[np.array([one.node for one in links if one.weights is None], np.int64)] = True
    kept_holds = tuple(replace(one, nodes=one.nodes[placed[one.nodes]]) for one in held)
    kept_masses = tuple(one for one in masses if placed[one.node])
    counted = (
        (len(np.unique(_together(one.nodes[~placed[one.nodes]] for one in held))), "held nodes that no part has"),
        (len(every) - len(links), "links between nodes that no part has"),
        (sum(int((~placed[one.nodes]).sum()) for one in links), "nodes of links that no part has"),
        (len(masses) - len(kept_masses), "masses at nodes that no part has"),
    )
    return Attached(
        mesh,
        tuple(take),
        tuple(one for one in kept_holds if len(one.nodes)),
        tuple(replace(one, nodes=one.nodes[placed[one.nodes]]) for one in links),
        kept_masses,
        np.flatnonzero((placed & ~there) | (leading & ~turning)),
        tuple(f"{count} {words}" for count, words in counted if count),
    )


def _nodes_of(mesh: ImportedMesh, users: Users) -> tuple[np.ndarray, np.ndarray]:
    """Which nodes of a file are of cells that parts take, and which of those turn, as nodes of shells do."""
    there, turning = np.zeros((2, len(mesh.points)), dtype=bool)
    for other, cells in users:
        if same_file(mesh, other):
            for kind, rows in cells.items():
                nodes = mesh.cells[kind][rows]
                there[nodes] = True
                turning[nodes] |= KINDS[kind].dimension < 3
    return there, turning


def _reached(
    there: np.ndarray, matter: np.ndarray, links: Sequence[StatedLink]
) -> tuple[np.ndarray, tuple[StatedLink, ...]]:
    """Which nodes are of parts or led to by links from them, and the links that join some of them."""
    placed = there.copy()
    while True:
        live = [one for one in links if placed[one.node] or placed[one.nodes].any()]
        grown = placed.copy()
        for one in live:
            grown[one.node] = True
            grown[one.nodes] |= matter[one.nodes]
        if np.array_equal(grown, placed):
            of_all = {True: np.all, False: np.any}  # the mean of some of the nodes would be another one
            return placed, tuple(one for one in live if of_all[one.weights is not None](placed[one.nodes]))
        placed = grown


def _together(some: Iterable[Integers]) -> Integers:
    return np.concatenate([np.zeros(0, np.int64), *some])


# ----------------------------------------------------------------------------------------------------------------------
# Rows of what is taken of a mesh file: held nodes, rigid links and masses, on all nodes that parts have of it.
# ----------------------------------------------------------------------------------------------------------------------

_SIX: Final = len(DIRECTIONS)
_FORCES: Final = np.concatenate([np.eye(3), np.zeros((3, 3))])
_NEGATIVE: Final = 1e-6  # of the largest moment: moments are written with a few digits


class Nodes:
    """The nodes that parts have of a file. points [n, 3] : of all nodes of the structure [m]."""

    def __init__(self, mesh: ImportedMesh, parts: Mapping[str, Meshed], points: Floats) -> None:
        found = [(part, *of) for part in parts.values() if (of := part.of_file) is not None]
        own = [(part, rows) for part, other, rows in found if same_file(mesh, other)]
        rows = np.concatenate([np.zeros(0, np.int64), *(rows for _, rows in own)])
        nodes = np.concatenate([np.zeros(0, np.int64), *(part.nodes for part, _ in own)])
        turns = np.concatenate([np.zeros(0, dtype=bool), *(np.full(len(r), p.has_rotations) for p, r in own)])
        cells = np.concatenate([np.zeros(0, dtype=bool), *(np.full(len(r), len(p.quads) > 0) for p, r in own)])
        order = np.lexsort((cells, ~turns, rows))  # of one place: those that turn first, of them those without cells
        self.mesh, self.points, self.rows = mesh, points, rows[order]
        self.numbers, self.turn = nodes[order], turns[order]

    def of(self, rows: Integers) -> tuple[Integers, np.ndarray]:
        """All nodes at rows of the file [n], and whether they turn."""
        starts, ends = (np.searchsorted(self.rows, rows, side) for side in ("left", "right"))
        at = np.concatenate([np.zeros(0, np.int64), *(np.arange(a, b) for a, b in zip(starts, ends, strict=True))])
        return self.numbers[at], self.turn[at]

    def first_of(self, row: int) -> tuple[int, bool]:
        """The node at a row of the file that turns, if one does, and whether."""
        numbers, turn = self.of(np.array([row]))
        return int(numbers[0]), bool(turn[0])


def held_rows(holds: Sequence[StatedHold], nodes: Nodes) -> tuple[csr_array, Floats]:
    """Held components [m, n_nodes * 7], each once, and the directions of their forces [m, 3]."""
    columns = [np.zeros(0, np.int64)]
    for one in holds:
        numbers, turn = nodes.of(one.nodes)
        columns += [numbers[turn | (one_of < 3)] * N_COMPONENTS + one_of for one_of in one.held]
    held = np.unique(np.concatenate(columns))
    count = len(nodes.points) * N_COMPONENTS
    rows = csr_array((np.ones(len(held)), (np.arange(len(held)), held)), shape=(len(held), count))
    return rows, _FORCES[held % N_COMPONENTS]


def link_rows(link: StatedLink, nodes: Nodes) -> tuple[csr_array, Floats]:
    """What follows a node less the rigid motion of it [m, n_nodes * 7], and the directions of its forces [m, 3].

    Other nodes at the place of the one that leads are that node: they follow it in all they have.
    """
    lead, _ = nodes.first_of(link.node)
    numbers, turn = nodes.of(link.nodes[link.nodes != link.node])
    twins, twins_turn = nodes.of(np.array([link.node]))
    kinds = [(numbers, turn, link.follows), (twins[1:], twins_turn[1:], tuple(range(_SIX)))]
    n_nodes, rows, directions = len(nodes.points), [], [np.zeros((0, 3))]
    for some, turns, follows in kinds:
        for turning in (True, False):
            own = some[turns == turning]
            held = [one for one in follows if turning or one < 3]
            if not len(own) or not held:
                continue
            motion = np.zeros((len(own), _SIX, 1, N_COMPONENTS))
            motion[:, :, 0, :_SIX] = np.eye(_SIX)
            moved = carry_along_arms(motion, nodes.points[own] - nodes.points[lead])[:, held]
            follow = node_rows(np.repeat(own, len(held)), np.tile(np.eye(N_COMPONENTS)[held], (len(own), 1)), n_nodes)
            rows.append(csr_array(sparse_rows(np.full((len(own), 1), lead), moved, n_nodes) - follow))
            directions.append(np.tile(_FORCES[held], (len(own), 1)))
    empty = csr_array((0, n_nodes * N_COMPONENTS))
    return csr_array(vstack([empty, *rows])), np.concatenate(directions)


def average_rows(where: str, link: StatedLink, nodes: Nodes) -> tuple[csr_array, Floats]:
    """A node less the rigid motion that fits the shifts of others best [m, n_nodes * 7], and the directions of its
    forces [m, 3]. Raises InputError where they do not determine it."""
    lead, turns = nodes.first_of(link.node)
    others = np.array([nodes.first_of(row)[0] for row in link.nodes.tolist()])
    held = [one for one in link.follows if turns or one < 3]
    weights = np.array(link.weights, dtype=np.float64)
    fit = fitted_motion(nodes.points[others] - nodes.points[lead], weights / weights.sum())
    if fit is None or np.abs(fit.lost[held]).max(initial=0.0) > UNDETERMINED:
        number = nodes.mesh.numbers[link.node]
        got = f"the mean motion of {len(others)} nodes at node {number}, which do not determine it"
        raise InputError(where, got=got, expected="three nodes that are not on one line", do="leave out 'links'")
    n_nodes = len(nodes.points)
    shifts = node_rows(np.repeat(others, 3), np.tile(np.eye(3, N_COMPONENTS), (len(others), 1)), n_nodes)
    own = node_rows(np.full(len(held), lead), np.eye(N_COMPONENTS)[held], n_nodes)
    return csr_array(own - csr_array(fit.motion[held]) @ shifts), _FORCES[held]


def inert_rows(where: str, masses: Sequence[StatedMass], nodes: Nodes, unit: float) -> tuple[csr_array, Floats, int]:
    """Rows, masses and count of an `Inert`.

    Parameters
    ----------
    unit : float
        Of mass of the file [kg].

    Raises
    ------
    InputError
        For a mass or a principal moment below zero, and for a body whose moments or offset ask for the rotation of a
        node that has none.
    """
    shifts, turns, weights, moments = [], [], [], []
    for one in masses:
        called = f"the mass at node {nodes.mesh.numbers[one.node]}"
        node, turn = nodes.first_of(one.node)
        own, axes = principal(one.inertia)
        if one.mass < 0 or own[0] < -_NEGATIVE * abs(own).max():
            least = f"{one.mass:g}" if one.mass < 0 else f"a principal moment of {own[0]:.4g}"
            raise InputError(where, got=f"{called} with {least}", expected="none below zero", do="mend the file")
        if not turn and (own.any() or any(one.offset)):
            raise InputError(
                where,
                got=f"{called}, with moments of inertia or an offset, at a node of a solid, which has no rotation",
                expected="a mass alone, or a node that leads a rigid link",
                do="write it as a part of type inertia at a point of the solid, and leave it out of the file",
            )
        motion = np.zeros((1, _SIX, 1, N_COMPONENTS))
        motion[0, :, 0, :_SIX] = np.eye(_SIX)
        at = np.array([[node]])
        shifts.append(sparse_rows(at, carry_along_arms(motion, np.asarray(one.offset))[:, :3], len(nodes.points)))
        weights += 3 * [unit * one.mass]
        if own.any():
            turns.append(sparse_rows(at, np.einsum("ij,pjkc->pikc", axes, motion[:, 3:]), len(nodes.points)))
            moments += (unit * own.clip(min=0.0)).tolist()
    return csr_array(vstack([*shifts, *turns])), np.array([*weights, *moments]), len(masses)


def idle_rows(alone: Integers, used: Sequence[csr_array], n_nodes: int) -> csr_array:
    """Components of nodes of their own that nothing of the file uses [m, n_nodes * 7], such as the rotation of a node
    that follows the mean shift of others: without mass and stiffness, they are held."""
    columns = (alone[:, None] * N_COMPONENTS + np.arange(_SIX)).ravel()
    felt = np.zeros(n_nodes * N_COMPONENTS)
    for rows in used:
        felt += np.asarray(abs(rows).sum(axis=0)).ravel()
    idle = columns[felt[columns] == 0.0]
    return csr_array((np.ones(len(idle)), (np.arange(len(idle)), idle)), shape=(len(idle), n_nodes * N_COMPONENTS))


def principal(inertia: Sequence[float]) -> tuple[Floats, Floats]:
    """Principal moments [3], ascending, and their axes as rows [3, 3], of Ixx, Iyy, Izz, Ixy, Iyz, Izx; products stand
    with a minus in the tensor.

    >>> principal([1.0, 1.0, 2.0, 0.0, 0.0, 0.0])[0].tolist()
    [1.0, 1.0, 2.0]
    """
    xx, yy, zz, xy, yz, zx = inertia
    values, axes = np.linalg.eigh(np.array([[xx, -xy, -zx], [-xy, yy, -yz], [-zx, -yz, zz]]))
    return values, axes.T
