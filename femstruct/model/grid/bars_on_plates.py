"""How bars are joined to a plate that stretches: ribs that run along it, posts that stand on it.

A rib is tied to the plate where both touch, on its face: the three displacements there, and the rotation about its own
axis. Its other two rotations are its own.

- About the plate's normal: as the plate twists along the rib, the rib's section turns about that normal. Tied to the
  plate, whose drilling rotation follows it only as far as the mesh is coarse, the rib would shear sideways: a false
  torsional stiffness, up to k G A e^2, thirty times the true one.
- About the axis across the rib: a thin plate has no shear deformation, so that a rib with its rotation could not shear,
  either.

The end of a bar that stands on the plate is tied in all three rotations. That about the normal is the rotation of a
patch as wide as the bar's section: the rotation of a plate at a point under a torque grows without limit as the mesh is
refined, and free, the bar could spin about its axis.

A rib touches the plate along a line here. In three-dimensional solids a weld 10 mm wide on a plate of 0.8 m makes
frequencies up to 0.6 % higher, and the edges of boards swing about the flanks of a joist: modes of edges 0.3 m from the
middle of joists of 45 mm are 5 to 6 % higher. (A board kept flat over that width was as much too stiff.)
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array

from femstruct.arrays import Floats, Integers
from femstruct.conventions import N_COMPONENTS
from femstruct.errors import InputError
from femstruct.model.meshed import Meshed
from femstruct.model.rows import node_rows

_SLIGHT = 1e-6  # sine of an angle: less is rounding
_TURN = slice(3, 6)


def contact(pairs: Integers, bars: Meshed, plate: Meshed, points: Floats) -> Floats:
    """Where bars touch a plate [p, 3] [m]: ribs beside it on its face, bars in it and posts in the mid-surface.

    pairs [p, 2] : nodes of the bars and of the plate. points : of all nodes [m].
    """
    return touching_face(pairs[:, 0], points[pairs[:, 1]], bars, plate)


def touching_face(nodes: Integers, foot: Floats, bars: Meshed, plate: Meshed) -> Floats:
    """Where bars touch a plate [p, 3] [m], of nodes of theirs [p] at places in its mid-surface [p, 3] [m]."""
    depth = float(np.linalg.norm(plate.across))
    normal = plate.across / depth
    heights = np.clip((bars.places[nodes - bars.first] + bars.beside(nodes) - foot) @ normal, -depth, depth)
    along = np.isin(nodes, _within(bars, nodes))
    found: Floats = foot + np.outer(np.where(along, heights, 0.0), normal)
    return found


def turning_rows(pairs: Integers, bars: Meshed, plate: Meshed, springy: list[int], n_nodes: int) -> list[csr_array]:
    """Rotations of bars less those of a plate that a rigid joint holds at zero, each [m, n_nodes * 7].

    pairs [p, 2] : nodes of the bars and of the plate. springy : numbers of the directions that are springs, and so not
    held.

    Raises InputError for bars of a file that does not say how thick they are.
    """
    if not bars.girth:
        raise InputError(
            f"parts.{bars.name}.file",
            got=f"bars on {plate.name}, and a file that has neither their section nor their axis",
            expected="a file that has both",
            do="write it again with 'femstruct reduce'",
        )
    normal, axes = plate.drilling, plate.own_axes
    assert normal is not None
    assert axes is not None
    free = np.eye(3)[[number - 3 for number in springy if number >= 3]]
    along, directions, _ = pieces_of(bars, pairs)
    standing = pairs[~np.isin(pairs[:, 0], along[:, 0])]
    found = [
        _relative(along, directions, free, n_nodes),
        *(_relative(standing, np.tile(axis, (len(standing), 1)), free, n_nodes) for axis in axes[:2]),
    ]
    if not (np.abs(free @ normal) > _SLIGHT).any():
        turn = np.zeros((len(standing), N_COMPONENTS))
        turn[:, _TURN] = normal
        patches = plate.turning(standing[:, 1], bars.girth, n_nodes)
        found.append(csr_array(node_rows(standing[:, 0], turn, n_nodes) - patches))
    return found


def pieces_of(bars: Meshed, pairs: Integers) -> tuple[Integers, Floats, Floats]:
    """Where bars run along what they are joined to.

    pairs [p, 2] : nodes of the bars and of the other part.

    Returns the pairs [m, 2] at ends of bars both of whose ends are joined, the directions of the bars there [m, 3] and
    the lengths that belong to them [m] [m]; a straight line is there once, a corner with both its directions.
    """
    ends = _within(bars, pairs[:, 0])
    steps = bars.places[ends[:, 1] - bars.first] - bars.places[ends[:, 0] - bars.first]
    lengths = np.linalg.norm(steps, axis=1)
    far = lengths > 0.0  # bars between offsets of one node run along nothing
    ends, steps, lengths = ends[far], steps[far], lengths[far]
    along = steps / lengths[:, None]
    largest = along[np.arange(len(along)), np.abs(along).argmax(axis=1)]
    along = np.repeat(along * np.sign(largest)[:, None], 2, axis=0)
    keys = np.column_stack([ends.ravel(), np.round(along / _SLIGHT).astype(np.int64)])
    _, first, which = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(pairs[:, 0])
    nodes = ends.ravel()[first]
    partner = pairs[order[np.searchsorted(pairs[order, 0], nodes)], 1]
    shares: Floats = np.bincount(which.ravel(), np.repeat(lengths / 2.0, 2)).astype(np.float64)
    return np.column_stack([nodes, partner]), along[first], shares


def _within(bars: Meshed, nodes: Integers) -> Integers:
    """End nodes of the bars [b, 2] both of which are among the nodes."""
    return bars.lines[np.isin(bars.lines, nodes).all(axis=1)]


def _relative(pairs: Integers, axes: Floats, free: Floats, n_nodes: int) -> csr_array:
    """Relative rotation of pairs of nodes [m, 2] about axes [m, 3] less their share of free directions [f, 3]."""
    turn = np.zeros((len(pairs), N_COMPONENTS))
    turn[:, _TURN] = axes - axes @ free.T @ free
    held = np.flatnonzero(np.linalg.norm(turn, axis=1) > _SLIGHT)
    first, second = (node_rows(pairs[held, side], turn[held], n_nodes) for side in (0, 1))
    return csr_array(first - second)
