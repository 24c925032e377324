"""Places among the lines of a grid along one direction."""

from __future__ import annotations

import numpy as np

from femstruct.arrays import Floats, Integers


def interval_of(grid: Floats, places: Floats) -> tuple[Integers, Floats, Floats]:
    """Interval of each place, where it lies in it from 0 to 1, and the length of the interval.

    >>> interval, share, length = interval_of(np.array([0.0, 1.0, 3.0]), np.array([0.5, 2.0, 3.0]))
    >>> interval.tolist(), share.tolist(), length.tolist()
    ([0, 1, 1], [0.5, 0.5, 1.0], [1.0, 2.0, 2.0])
    """
    index = np.clip(np.searchsorted(grid, places, side="right") - 1, 0, len(grid) - 2)
    size = grid[index + 1] - grid[index]
    return index, np.clip((places - grid[index]) / size, 0.0, 1.0), size


def snapped(places: Floats, grid: Floats, tolerance: float) -> Floats:
    """The places, those within the tolerance of a grid line on it.

    >>> snapped(np.array([0.999, 1.4]), np.array([0.0, 1.0, 2.0]), 0.01).tolist()
    [1.0, 1.4]
    """
    index = np.clip(np.searchsorted(grid, places), 1, len(grid) - 1)
    left, right = grid[index - 1], grid[index]
    near = np.where(places - left < right - places, left, right)
    return np.where(np.abs(near - places) <= tolerance, near, places)


def divided(grid: Floats, divisions: int) -> Floats:
    """The grid with every interval in equal pieces.

    >>> divided(np.array([0.0, 1.0, 3.0]), 2).tolist()
    [0.0, 0.5, 1.0, 2.0, 3.0]
    """
    steps = np.arange(divisions) / divisions
    between = grid[:-1, None] + np.diff(grid)[:, None] * steps
    return np.append(between.ravel(), grid[-1])
