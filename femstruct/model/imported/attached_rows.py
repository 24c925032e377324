"""Rows of what is taken of a mesh file: held nodes, rigid links and masses, on all nodes that parts have of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
from scipy.sparse import csr_array, vstack

from femstruct.arrays import Floats, Integers
from femstruct.conventions import DIRECTIONS, N_COMPONENTS
from femstruct.errors import InputError
from femstruct.model.equations.average import UNDETERMINED, fitted_motion
from femstruct.model.imported.attached import same_file
from femstruct.model.imported.imported_mesh import ImportedMesh, StatedHold, StatedLink, StatedMass
from femstruct.model.meshed import Meshed
from femstruct.model.rows import carried, node_rows, sparse_rows

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
            moved = carried(motion, nodes.points[own] - nodes.points[lead])[:, held]
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
    """Rows, masses and count of an `Inert`; unit : of mass of the file [kg].

    Raises InputError for a mass or a principal moment below zero, and for a body whose moments or offset ask for the
    rotation of a node that has none.
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
        shifts.append(sparse_rows(at, carried(motion, np.asarray(one.offset))[:, :3], len(nodes.points)))
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
