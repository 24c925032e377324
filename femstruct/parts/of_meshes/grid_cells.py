"""Which cell of a flat grid a place is in, where some cells of the grid are missing."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from femstruct.arrays import Floats, Integers


@dataclass(frozen=True, eq=False)
class GridCells:
    """Rectangular cells between the lines of a grid.

    x [nx + 1], y [ny + 1] : lines, ascending [m]. which [nx, ny] : numbers of the cells, -1 where there is none.

    Two cells of three that make an L:

    >>> corners = np.array([[[0, 0], [1, 0], [1, 1], [0, 1]], [[1, 0], [2, 0], [2, 1], [1, 1]],
    ...                     [[0, 1], [1, 1], [1, 3], [0, 3]]], dtype=float)
    >>> cells = GridCells.of(corners)
    >>> cells.at(np.array([[0.5, 2.0], [1.5, 0.5], [1.5, 2.0], [1.0, 2.0]]), 1e-9).tolist()
    [2, 1, -1, 2]
    """

    x: Floats
    y: Floats
    which: Integers

    @classmethod
    def of(cls, corners: Floats) -> GridCells:
        """The grid of cells with these corners [m, 4, 2], along its axes."""
        low, high = corners.min(axis=1), corners.max(axis=1)
        small = 1e-6 * float((high - low).min())
        x, y = (_apart(corners[..., axis].ravel(), small) for axis in (0, 1))
        middles = (low + high) / 2.0
        which = np.full((len(x) - 1, len(y) - 1), -1)
        which[np.searchsorted(x, middles[:, 0]) - 1, np.searchsorted(y, middles[:, 1]) - 1] = np.arange(len(corners))
        return cls(x, y, which)

    def at(self, places: Floats, tolerance: float) -> Integers:
        """Numbers of the cells that places [p, 2] are in or on, within a tolerance [m]; -1 where there is none."""
        found = np.full(len(places), -1)
        for shift in product((-tolerance, tolerance), repeat=2):  # on a line it may be in any of four
            column, row = (
                np.searchsorted(lines, places[:, axis] + shift[axis], side="right") - 1
                for axis, lines in enumerate((self.x, self.y))
            )
            inside = (column >= 0) & (column < len(self.x) - 1) & (row >= 0) & (row < len(self.y) - 1)
            seen = np.where(inside, self.which[column * inside, row * inside], -1)
            found = np.where(found < 0, seen, found)
        return found


def _apart(values: Floats, small: float) -> Floats:
    """The values in ascending order, those that are one but for rounding once."""
    ordered = np.sort(values)
    kept: Floats = ordered[np.r_[True, np.diff(ordered) > small]]
    return kept
