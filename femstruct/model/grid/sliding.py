"""Joints that slide along the line on which two parts touch: screws, nails, soft glue.

A rib under a board and the board share the bending according to the slip between them: partial composite action. Across
the line, and in rotation, the joint is rigid; along it a spring of a stiffness per length resists, the slip modulus of
the fasteners over their spacing. Where a line turns a corner, both its directions slide.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array

from femstruct.arrays import Floats, Integers
from femstruct.conventions import N_COMPONENTS
from femstruct.errors import InputError
from femstruct.model.fastened import Elastic, Tie
from femstruct.model.grid.bars_on_plates import pieces_of
from femstruct.model.meshed import Meshed
from femstruct.model.model import Model
from femstruct.model.rows import node_rows
from femstruct.model.structure import Joint

_TURNED = 1e-3  # square of the sine of an angle: a line that turns by less is straight


def sliding(
    item: Joint, parts: tuple[Meshed, Meshed], pairs: Integers, at: Floats, model: Model
) -> tuple[Tie, Elastic]:
    """Shifts across the line of a joint, which are held, and those along it, which are sprung.

    pairs [p, 2] : nodes of both parts that are joined; at [p, 3] : where they touch [m].

    Raises InputError where the parts do not touch along a line.
    """
    axes = next((part.own_axes for part in parts if part.own_axes is not None), np.eye(3))
    which, along, lengths = _lines(pairs, parts, model.mesh.points)
    if not len(which):
        raise InputError(
            f"joints.{item.name}.kind",
            got=f"sliding, and {item.a} and {item.b} that touch at single places",
            expected="parts that touch along a line",
        )
    held, across = across_lines(len(pairs), which, along, axes)
    tie = Tie(item.name, _relative(pairs[held], at[held], across, model), across, grounded=False)
    rows = _relative(pairs[which], at[which], along, model)
    nothing = np.zeros(len(lengths))
    return tie, Elastic(item.name, rows, item.slip * lengths, nothing, along, grounded=False)


def _lines(pairs: Integers, parts: tuple[Meshed, Meshed], points: Floats) -> tuple[Integers, Floats, Floats]:
    """Numbers of pairs [m] on lines, directions of these [m, 3], and the lengths that belong to them [m] [m]."""
    for side, part in enumerate(parts):
        if len(part.lines):
            found, along, lengths = pieces_of(part, pairs if side == 0 else pairs[:, ::-1])
            order = np.argsort(pairs[:, side])
            return order[np.searchsorted(pairs[order, side], found[:, 0])], along, lengths
    places = points[pairs[:, 0]]
    spread = np.linalg.svd(places - places.mean(axis=0), full_matrices=False)
    if len(pairs) < 2 or spread[1][1] > np.sqrt(_TURNED) * spread[1][0]:
        return np.zeros(0, np.int64), np.zeros((0, 3)), np.zeros(0)
    order = np.argsort(places @ spread[2][0])
    steps = np.linalg.norm(np.diff(places[order], axis=0), axis=1)
    lengths = (np.append(steps, 0.0) + np.append(0.0, steps)) / 2.0
    return order, np.tile(spread[2][0], (len(order), 1)), lengths


def lengths_of(item: Joint, pairs: Integers, parts: tuple[Meshed, Meshed], points: Floats) -> tuple[Integers, Floats]:
    """Which pairs [m] of a joint are on lines on which both parts run, and the lengths that belong to them [m] [m].

    Raises InputError where the parts touch at single places, or over an area.
    """
    numbers, lengths = np.zeros(0, np.int64), np.zeros(0)
    for side, part in sorted(enumerate(parts), key=lambda one: not len(one[1].lines)):
        cells, nodes = part.quads, pairs[:, side]
        if len(part.lines):
            ends = part.lines
        else:
            refuse_lengths(item, bool(np.isin(cells, nodes).all(axis=1).any()))
            ends = np.concatenate([cells[:, [i, (i + 1) % 4]] for i in range(4)]).reshape(-1, 2)
        ends = np.unique(np.sort(ends[np.isin(ends, nodes).all(axis=1)], axis=1), axis=0)
        halves = np.linalg.norm(points[ends[:, 1]] - points[ends[:, 0]], axis=1) / 2.0
        if halves.sum() > lengths.sum() and not len(numbers):
            order = np.argsort(nodes)
            found, which = np.unique(ends, return_inverse=True)
            lengths = np.bincount(which.ravel(), np.repeat(halves, 2)).astype(np.float64)
            numbers = order[np.searchsorted(nodes[order], found)]
    refuse_lengths(item, not len(numbers))
    return numbers, lengths


def refuse_lengths(item: Joint, wrong: bool) -> None:
    """Raise InputError for springs per length of a joint that has no line."""
    if wrong:
        raise InputError(
            f"joints.{item.name}.stiffness",
            got=f"springs per length, and {item.a} and {item.b} that do not touch along lines",
            expected="a stiffness of the springs at each pair of nodes",
            do="write N/m, and N*m/rad for rotations",
        )


def across_lines(count: int, which: Integers, along: Floats, axes: Floats) -> tuple[Integers, Floats]:
    """What is held of `count` pairs: numbers of pairs [r] and directions [r, 3], across those that slide.

    Along the axes of a plate, as far as they are across: equations along them couple fewest unknowns.
    """
    slides = np.zeros((count, 3, 3))
    np.add.at(slides, which, along[:, :, None] * along[:, None, :])
    values, vectors = np.linalg.eigh(slides)
    straight = values < _TURNED
    onto = np.einsum("pik,pk,pjk->pij", vectors, straight.astype(np.float64), vectors)
    across = np.einsum("pij,kj->pki", onto, axes)
    rank = np.argsort(np.argsort(-np.linalg.norm(across, axis=2), axis=1), axis=1)
    pair, axis = np.nonzero(rank < straight.sum(axis=1)[:, None])
    found: Floats = across[pair, axis]
    return pair, found / np.linalg.norm(found, axis=1)[:, None]


def _relative(pairs: Integers, at: Floats, along: Floats, model: Model) -> csr_array:
    """Shift of the first node of each pair less that of the second along a direction [p, 3], at places that move with
    both [p, 3] [m]: [p, n_nodes * 7]."""
    sides = []
    for nodes in pairs.T:
        rows = np.zeros((len(pairs), N_COMPONENTS))
        rows[:, :3], rows[:, 3:6] = along, np.cross(at - model.mesh.points[nodes], along)
        sides.append(node_rows(nodes, rows, model.mesh.n_nodes))
    return csr_array(sides[0] - sides[1])
