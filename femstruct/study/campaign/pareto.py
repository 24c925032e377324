"""Designs of which none is better than another in all goals: which they are, how much they gain, where they bend."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.study.campaign.swept import Flags

BEYOND: Final = 0.1  # of the front's extent, from its worst values to the reference point of the hypervolume
BULGE: Final = 0.02  # of the extents: a knee stands out by more than this in front of the straight line


def nondominated(small: Floats) -> Flags:
    """Which designs no other one beats: none is as small in all goals and smaller in one [n]. small [n, g].

    Of designs that are equal in all goals, the first.

    >>> nondominated(np.array([[1.0, 3.0], [2.0, 2.0], [2.0, 3.0], [2.0, 2.0]])).tolist()
    [True, True, False, False]
    """
    found, front = np.zeros(len(small), dtype=bool), np.empty((0, small.shape[1]))
    for k in np.lexsort(small.T[::-1]):  # what beats a design, and the first of its equals, comes before it
        if not (front <= small[k]).all(axis=1).any():
            front, found[k] = np.vstack([front, small[k]]), True
    return found


def hypervolume(small: Floats, reference: Floats) -> float:
    """The volume of all that designs beat, up to a reference point. small [n, g], reference [g], two or three goals.

    Exact: strips of two goals; slices of such along a third (Zitzler and Thiele 1998).

    Two designs, whose rectangles overlap:

    >>> hypervolume(np.array([[0.0, 2.0], [1.0, 0.0]]), np.array([3.0, 3.0]))  # 3 x 1 + 2 x 3 - 2 x 1
    7.0
    """
    inside = small[(small < reference).all(axis=1)]
    if not len(inside):
        return 0.0
    if len(reference) == 2:
        x, y = inside[np.lexsort((inside[:, 1], inside[:, 0]))].T
        lowest = np.minimum.accumulate(y)
        return float(np.sum(np.diff(x, append=reference[0]) * (reference[1] - lowest)))
    order = inside[np.argsort(inside[:, 2], kind="stable")]
    heights = np.diff(order[:, 2], append=reference[2])
    return sum(
        float(high) * hypervolume(order[: k + 1, :2], reference[:2]) for k, high in enumerate(heights) if high > 0.0
    )


def scaled(small: Floats, front: Floats) -> Floats:
    """Goals [n, g] in terms of a front [m, g]: 0 at its best value of each goal, 1 at its worst."""
    low, extent = front.min(axis=0), np.ptp(front, axis=0)
    return np.asarray((small - low) / np.where(extent > 0.0, extent, np.maximum(np.abs(low), 1e-300)))


def share(small: Floats, front: Floats) -> float:
    """The hypervolume of designs [n, g] as a share of the box between the best values of a front [m, g] and a point a
    tenth of its extent beyond its worst ones."""
    g = front.shape[1]
    reference = np.full(g, 1.0 + BEYOND)
    return hypervolume(np.maximum(scaled(small, front), 0.0), reference) / float(np.prod(reference))


def knee(front: Floats) -> int | None:
    """The design of a front [m, g] that lies farthest in front of the straight line (or plane) through its ends, with
    every goal in terms of its extent (Das 1999); None where the front is straight or bends the other way, and where
    the ends make no such plane.

    Beyond a knee a little more of one goal costs much of another.

    >>> knee(np.array([[0.0, 10.0], [0.2, 1.0], [1.0, 0.0]])), knee(np.array([[0.0, 1.0], [0.5, 0.5], [1.0, 0.0]]))
    (1, None)
    """
    if len(front) < 3 or not (np.ptp(front, axis=0) > 0.0).all():
        return None
    points = scaled(front, front)
    ends = points[points.argmin(axis=0)]
    if np.linalg.matrix_rank(ends) < len(ends):
        return None
    across = np.linalg.solve(ends, np.ones(len(ends)))  # the plane is where points @ across = 1
    along = points @ across
    return int(np.argmin(along)) if (across > 0.0).all() and along.min() < 1.0 - BULGE else None


def picked(front: Floats, first: Sequence[int], most: int) -> list[int]:
    """Some designs of a front [n, g] that show all of it: the first ones, then always the one farthest from all that
    are picked, with every goal in terms of its extent; in the order of the front.

    >>> picked(np.array([[0.0, 4.0], [0.1, 3.9], [2.0, 2.0], [4.0, 0.0]]), first=(0, 3), most=3)
    [0, 2, 3]
    """
    points, found = scaled(front, front), list(dict.fromkeys(first))
    while len(found) < min(most, len(front)):
        apart = np.linalg.norm(points[:, None] - points[found], axis=-1).min(axis=1, initial=np.inf)
        apart[found] = -1.0
        found.append(int(np.argmax(apart)))
    return sorted(found)
