"""Negative eigenvalues of a sparse symmetric matrix, counted by dense fronts: no factor is kept.

Source: I. S. Duff, J. K. Reid, The multifrontal solution of indefinite sparse symmetric linear equations, ACM Trans.
Math. Softw. 9 (1983) 302-325.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lapack
from scipy.linalg.blas import dsyrk, dtrsm

from femstruct.arrays import Floats, Integers
from femstruct.modal.dissection import dissect
from femstruct.modal.patterns import Pattern

# A pivot that cancelled to fewer than about five digits may have either sign.
_LOST = 1e-11


@dataclass(frozen=True, eq=False)
class _Dense:
    """A front as a dense matrix of its `pivots` and of what they touch later, in the order of elimination.

    entries : of the pattern that belong here. place : of each in the flat front. into : by child, places of its rest.
    """

    pivots: Integers
    size: int
    entries: Integers
    place: Integers
    into: tuple[tuple[int, Integers], ...]


class Counter:
    """The analysis of a pattern for counts of negative eigenvalues of many matrices on it."""

    def __init__(self, pattern: Pattern) -> None:
        fronts = dissect(pattern)
        order = np.concatenate([front.unknowns for front in fronts])
        rank = np.empty(pattern.size, dtype=np.int64)
        rank[order] = np.arange(pattern.size)
        rows, columns = rank[pattern.indices], rank[pattern.owner]
        # Entries by the front that eliminates their column, the lower triangle in the order of elimination.
        lower = np.flatnonzero(rows >= columns)
        lower = lower[np.argsort(columns[lower], kind="stable")]
        rows, columns = rows[lower], columns[lower]
        start = np.concatenate([[0], np.cumsum([len(front.unknowns) for front in fronts])])
        edge = np.searchsorted(columns, start)
        later: list[Integers] = []
        dense: list[_Dense] = []
        for i, front in enumerate(fronts):
            mine = slice(edge[i], edge[i + 1])
            touched = np.concatenate([rows[mine], *(later[child] for child in front.children)])
            rest = np.unique(touched[touched >= start[i + 1]])
            all_rows = np.concatenate([np.arange(start[i], start[i + 1]), rest])
            size = len(all_rows)
            place = np.searchsorted(all_rows, rows[mine]) + np.searchsorted(all_rows, columns[mine]) * size
            into = tuple((child, np.searchsorted(all_rows, later[child])) for child in front.children)
            later.append(rest)
            dense.append(_Dense(front.unknowns, size, lower[mine], place, into))
        self._fronts = dense

    def negative(self, values: Floats, scale: Floats) -> int | None:
        """Number of negative eigenvalues of the matrix of these values.

        scale [n] : size of the terms each diagonal entry is summed from. None when a pivot has lost all its digits.
        """
        total = 0
        rests: dict[int, Floats] = {}
        for i, front in enumerate(self._fronts):
            full = np.zeros(front.size * front.size)
            full[front.place] = values[front.entries]
            matrix = full.reshape((front.size, front.size), order="F")
            for child, at in front.into:
                matrix[np.ix_(at, at)] += rests.pop(child)
            count = len(front.pivots)
            if not count:
                rests[i] = matrix
                continue
            eliminated = _eliminated(matrix, count, scale[front.pivots])
            if eliminated is None:
                return None
            negative, rests[i] = eliminated
            total += negative
        return total


def _eliminated(matrix: Floats, count: int, scale: Floats) -> tuple[int, Floats] | None:
    """(negative pivots, what is left [m, m]) of the first unknowns of a matrix given by its lower triangle."""
    head, below = matrix[:count, :count], matrix[count:, :count]
    rest = matrix[count:, count:]
    root, failed = lapack.dpotrf(head, lower=1, clean=0)
    if not failed:
        if (np.diag(root) ** 2 < _LOST * scale).any():
            return None
        if not below.size:
            return 0, rest
        across = dtrsm(1.0, root, below, side=1, lower=1, trans_a=1)
        return 0, dsyrk(-1.0, across, beta=1.0, c=rest, lower=1)
    factored, pivots, failed = lapack.dsytrf(head, lower=1, lwork=64 * count)
    if failed:
        return None
    negative = _signs(factored, pivots, scale)
    if negative is None or not below.size:
        return None if negative is None else (negative, rest)
    across, _ = lapack.dsytrs(factored, pivots, np.asfortranarray(below.T), lower=1)
    return negative, np.asfortranarray(rest - below @ across)


def _signs(factored: Floats, swaps: NDArray[np.int32], scale: Floats) -> int | None:
    """Negative pivots of a Bunch-Kaufman factor; a pair of rows has one of each sign. None if one is rounding."""
    scale, negative, row = scale.copy(), 0, 0
    while row < len(swaps):
        paired = swaps[row] < 0
        moved, partner = row + paired, abs(swaps[row]) - 1
        scale[[moved, partner]] = scale[[partner, moved]]
        pivot = factored[moved, row]
        if abs(pivot) < _LOST * np.sqrt(scale[row] * scale[moved]):
            return None
        negative += int(paired or pivot < 0)
        row += 1 + int(paired)
    return negative
