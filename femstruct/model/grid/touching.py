"""What touches a box: the stretch of a line inside it, the grid lines that bound what it covers."""

from __future__ import annotations

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import InputError
from femstruct.model.grid.geometry import PARALLEL, Rectangle, to_rectangle
from femstruct.model.grid.layout import Box


def stretch_inside(places: Floats, across: Floats, low: Floats, high: Floats) -> tuple[Floats, Floats]:
    """Where the lines from place - across (-1) to place + across (1) enter and leave a box, for places [p, 3].

    low, high [3] : corners of the box. A line that misses it enters after it leaves.

    >>> places = np.array([[0.5, 0.5, 1.2], [0.5, 0.5, 1.8]])
    >>> first, last = stretch_inside(places, np.array([0.0, 0.0, 0.4]), np.zeros(3), np.ones(3))
    >>> first <= last, last.round(6)[0]
    (array([ True, False]), np.float64(-0.5))
    """
    first, last = np.full(len(places), -1.0), np.full(len(places), 1.0)
    for axis in range(3):
        ends = np.stack([low[axis] - places[:, axis], high[axis] - places[:, axis]])
        if across[axis] == 0.0:
            outside = (ends[0] > 0.0) | (ends[1] < 0.0)
            last = np.where(outside, -np.inf, last)
            continue
        shares = np.sort(ends / across[axis], axis=0)
        first, last = np.maximum(first, shares[0]), np.minimum(last, shares[1])
    return first, last


def lines_under(block: Box, plate: Rectangle, axes: Floats) -> Floats:
    """Two places [2, 2] of a plate, in its coordinates, whose grid lines bound what a block covers of it.

    Raises InputError for a plate whose sides are not parallel to the block's.
    """
    if np.abs(np.abs(axes) - np.round(np.abs(axes))).max() > PARALLEL:
        raise InputError(
            f"parts.{plate.name}",
            got=f"a plate at an angle to {block.name}, which it is joined to",
            expected="sides parallel to those of the block",
            do="turn the plate, or join it with springs",
        )
    ends = to_rectangle(plate, axes, np.stack([block.origin, np.add(block.origin, block.size)]))
    found: Floats = np.clip(ends[:, :2], 0.0, plate.size)
    return found
