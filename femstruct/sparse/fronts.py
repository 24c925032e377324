"""Factors of real sparse symmetric matrices by dense fronts: kept to solve with, or only their negative pivots counted.

Source: I. S. Duff, J. K. Reid, The multifrontal solution of indefinite sparse symmetric linear equations, ACM Trans.
Math. Softw. 9 (1983) 302-325.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, lapack
from scipy.linalg.blas import dsyrk, dtrsm

from femstruct.arrays import Floats, Integers
from femstruct.sparse.dissection import dissect
from femstruct.sparse.patterns import Pattern

# A pivot that cancelled to fewer than about five digits may have either sign.
_LOST = 1e-11


@dataclass(frozen=True, eq=False)
class _Front:
    """Unknowns `mine`, places in the order of elimination, and the places `later` of what they touch.

    entries : of the pattern that belong here. at : of each in the flat matrix of all of them.
    into : by child, places of what it left in that matrix.
    """

    mine: slice
    later: Integers
    entries: Integers
    at: Integers
    into: tuple[tuple[int, Integers], ...]


@dataclass(frozen=True, eq=False)
class _Cholesky:
    """Pivots of a positive definite head L L^T: root L, across = (what lies below the head) L^-T."""

    root: Floats
    across: Floats

    def negative(self, scale: Floats) -> int | None:
        """Number of negative pivots, 0; None where one is rounding of terms of size `scale`."""
        return None if (np.diag(self.root) ** 2 < _LOST * scale).any() else 0

    def forward(self, mine: Floats) -> Floats:
        """Solve for the unknowns of the head in place; returns what their neighbours lose."""
        dtrsm(1.0, self.root, mine.T, side=1, lower=1, trans_a=1, overwrite_b=1)
        lost: Floats = self.across @ mine
        return lost

    def backward(self, mine: Floats, later: Floats) -> None:
        """The same on the way back, with the answers of the neighbours."""
        mine -= self.across.T @ later
        dtrsm(1.0, self.root, mine.T, side=1, lower=1, overwrite_b=1)


@dataclass(frozen=True, eq=False)
class _BunchKaufman:
    """Pivots of an indefinite head, and what lies below it."""

    head: Floats
    swaps: NDArray[np.int32]
    below: Floats

    def negative(self, scale: Floats) -> int | None:
        """Number of negative pivots; None where one is rounding. A pair of rows has one of each sign."""
        scale, negative, row = scale.copy(), 0, 0
        while row < len(self.swaps):
            paired = self.swaps[row] < 0
            moved, partner = row + paired, abs(self.swaps[row]) - 1
            scale[[moved, partner]] = scale[[partner, moved]]
            pivot = self.head[moved, row]
            if abs(pivot) < _LOST * np.sqrt(scale[row] * scale[moved]):
                return None
            negative += int(paired or pivot < 0)
            row += 1 + int(paired)
        return negative

    def forward(self, mine: Floats) -> Floats:
        """Solve for the unknowns of the head in place; returns what their neighbours lose."""
        mine[:] = self.inverse(mine)
        lost: Floats = self.below @ mine
        return lost

    def backward(self, mine: Floats, later: Floats) -> None:
        """The same on the way back, with the answers of the neighbours."""
        mine -= self.inverse(self.below.T @ later)

    def inverse(self, load: Floats) -> Floats:
        """The inverse of the head times a load [n, m]."""
        answer: Floats = lapack.dsytrs(self.head, self.swaps, load, lower=1)[0]
        return answer


_Pivots = _Cholesky | _BunchKaufman


@dataclass(frozen=True, eq=False)
class FrontFactor:
    """A factor that is kept: the pivots of each front, and the order [n] in which the unknowns are eliminated."""

    order: Integers
    steps: tuple[tuple[_Front, _Pivots], ...]

    def solve(self, load: Floats) -> Floats:
        """A^-1 load, of [n] or [n, m]."""
        x = np.array(load.reshape((len(self.order), -1))[self.order], dtype=np.float64, order="C")
        for front, pivots in self.steps:
            x[front.later] -= pivots.forward(x[front.mine])
        for front, pivots in reversed(self.steps):
            pivots.backward(x[front.mine], x[front.later])
        answer = np.empty_like(x)
        answer[self.order] = x
        return answer.reshape(load.shape)


class Fronts:
    """The analysis of a pattern for factors of many matrices on it."""

    def __init__(self, pattern: Pattern) -> None:
        tree = dissect(pattern)
        self._order = np.concatenate([part.unknowns for part in tree])
        rank = np.empty(pattern.size, dtype=np.int64)
        rank[self._order] = np.arange(pattern.size)
        rows, columns = rank[pattern.indices], rank[pattern.owner]
        # Entries by the front that eliminates their column, the lower triangle in the order of elimination.
        lower = np.flatnonzero(rows >= columns)
        lower = lower[np.argsort(columns[lower], kind="stable")]
        rows, columns = rows[lower], columns[lower]
        start = np.concatenate([[0], np.cumsum([len(part.unknowns) for part in tree])])
        edge = np.searchsorted(columns, start)
        self._fronts: list[_Front] = []
        for i, part in enumerate(tree):
            first, end, own = int(start[i]), int(start[i + 1]), slice(edge[i], edge[i + 1])
            touched = np.concatenate([rows[own], *(self._fronts[child].later for child in part.children)])
            later = np.unique(touched[touched >= end])
            all_rows = np.concatenate([np.arange(first, end), later])
            at = np.searchsorted(all_rows, rows[own]) + np.searchsorted(all_rows, columns[own]) * len(all_rows)
            into = tuple((child, np.searchsorted(all_rows, self._fronts[child].later)) for child in part.children)
            self._fronts.append(_Front(slice(first, end), later, lower[own], at, into))

    def factor(self, values: Floats) -> FrontFactor:
        """Factor of the matrix of these values; raises LinAlgError where a front is singular."""
        return FrontFactor(self._order, tuple(self._eliminated(values)))

    def negative(self, values: Floats, scale: Floats) -> int | None:
        """Number of negative eigenvalues of the matrix of these values.

        scale [n] : size of the terms each diagonal entry is summed from. None when a pivot has lost all its digits.
        """
        total, scale = 0, scale[self._order]
        try:
            for front, pivots in self._eliminated(values):
                negative = pivots.negative(scale[front.mine])
                if negative is None:
                    return None
                total += negative
        except LinAlgError:
            return None
        return total

    def _eliminated(self, values: Floats) -> Iterator[tuple[_Front, _Pivots]]:
        """The pivots of one front after the other; of what they leave, only what is still needed is held."""
        rests: dict[int, Floats] = {}
        for i, front in enumerate(self._fronts):
            count = front.mine.stop - front.mine.start
            size = count + len(front.later)
            full = np.zeros(size * size)
            full[front.at] = values[front.entries]
            matrix = full.reshape((size, size), order="F")
            for child, at in front.into:
                matrix[np.ix_(at, at)] += rests.pop(child)
            if not count:
                rests[i] = matrix
                continue
            pivots, rests[i] = _eliminated(matrix, count)
            yield front, pivots


def _eliminated(matrix: Floats, count: int) -> tuple[_Pivots, Floats]:
    """(pivots, what is left [m, m]) of the first unknowns of a matrix given by its lower triangle."""
    head, below, rest = matrix[:count, :count], matrix[count:, :count], matrix[count:, count:]
    root, failed = lapack.dpotrf(head, lower=1, clean=0)
    if not failed:
        across = dtrsm(1.0, root, below, side=1, lower=1, trans_a=1) if below.size else np.asfortranarray(below)
        left = dsyrk(-1.0, across, beta=1.0, c=rest, lower=1) if below.size else np.asfortranarray(rest)
        return _Cholesky(root, across), left
    factored, swaps, failed = lapack.dsytrf(head, lower=1, lwork=64 * count)
    if failed:
        raise LinAlgError("a front without an inverse")
    pivots = _BunchKaufman(factored, swaps, np.array(below, order="F"))
    return pivots, np.asfortranarray(rest - below @ pivots.inverse(below.T)) if below.size else np.asfortranarray(rest)
