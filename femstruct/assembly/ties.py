"""Elimination of linear equations between degrees of freedom: ties become a map from the free ones.

The equations are homogeneous. Degrees of freedom that stand alone in an equation are held; then, round by round, those
that occur in no other remaining equation are expressed by the rest of theirs, which needs no arithmetic between
equations; what is left, where plates meet in different planes and closed chains of joints repeat themselves, is solved
as one small dense system whose rank is decided and whose redundant equations are dropped.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import lu_factor, lu_solve, qr
from scipy.sparse import csr_array

from femstruct.arrays import Floats, Integers

NEGLIGIBLE = 1e-12
"""Coefficients below this share of an equation's largest are rounding of direction cosines."""
RANK = 1e-9
"""An equation that follows from others to this share is redundant; positions of joined nodes agree to about 1e-12."""
PIVOT = 0.1
"""Smallest pivot as a share of the largest coefficient of its equation; bounds the growth of coefficients."""


@dataclass(frozen=True, eq=False)
class Elimination:
    """Raw degrees of freedom from the free ones.

    E [n_raw, n_free]; free [n_free] : raw numbers of the free ones. kept [m], pivots [m] : the independent equations
    and the degree of freedom each determines.
    """

    E: csr_array
    free: Integers
    kept: Integers
    pivots: Integers


def eliminate(equations: csr_array) -> Elimination:
    """Solve equations @ u = 0 for as many degrees of freedom as there are independent equations.

    equations [m, n_raw]. Any set of equations is good: redundant ones are dropped, none can contradict another.

    >>> solved = eliminate(csr_array(np.array([[1.0, -1.0, 0.0], [2.0, -2.0, 0.0]])))
    >>> solved.E.toarray()
    array([[1., 0.],
           [1., 0.],
           [0., 1.]])
    """
    n = equations.shape[1]
    work = _normalised(equations)
    rows = np.arange(work.shape[0])
    held = np.zeros(n, dtype=bool)
    rounds: list[tuple[Integers, Integers]] = []
    kept: list[Integers] = []
    pivots: list[Integers] = []
    while len(rows):
        part = _without(work[rows], held)
        counts = np.diff(part.indptr)
        rows, part, counts = rows[counts > 0], part[counts > 0], counts[counts > 0]
        single = counts == 1
        if single.any():
            fixed, first = np.unique(part[single].indices, return_index=True)
            held[fixed] = True
            kept.append(rows[single][first])
            pivots.append(fixed)
            rows = rows[~single]
            continue
        row, column = _lone_pivots(part)
        if not len(row):
            break
        rounds.append((rows[row], column))
        kept.append(rows[row])
        pivots.append(column)
        rows = np.delete(rows, row)
    dense_rows, dense_pivots, dense_solution = _dense(_without(work[rows], held), rows)
    kept.append(dense_rows)
    pivots.append(dense_pivots)
    all_pivots = np.concatenate(pivots)
    is_free = np.ones(n, dtype=bool)
    is_free[all_pivots] = False
    free = np.flatnonzero(is_free)
    E = csr_array((np.ones(len(free)), (free, np.arange(len(free)))), shape=(n, len(free)))
    if len(dense_pivots):
        E = E + _placed(csr_array(dense_solution @ E), dense_pivots, n)
    for at, column in reversed(rounds):
        equation = _without(work[at], held)
        pivot = equation[np.arange(len(at)), column]
        scale = csr_array((-1.0 / np.asarray(pivot), (np.arange(len(at)),) * 2), shape=(len(at),) * 2)
        # E has no row for the pivot yet, so the equation's own pivot term drops out of the product.
        E = E + _placed(csr_array(scale @ (equation @ E)), column, n)
    return Elimination(csr_array(E), free, np.concatenate(kept), all_pivots)


def _normalised(equations: csr_array) -> csr_array:
    """Rows scaled to a largest coefficient of 1, rounding removed, empty rows left empty."""
    work = csr_array(equations, copy=True)
    work.sum_duplicates()
    owner = np.repeat(np.arange(work.shape[0]), np.diff(work.indptr))
    largest = np.zeros(work.shape[0])
    np.maximum.at(largest, owner, np.abs(work.data))
    work.data = work.data / np.where(largest > 0, largest, 1.0)[owner]
    work.data[np.abs(work.data) < NEGLIGIBLE] = 0.0
    work.eliminate_zeros()
    return work


def _without(rows: csr_array, held: np.ndarray) -> csr_array:
    part = csr_array(rows, copy=True)
    part.data[held[part.indices]] = 0.0
    part.eliminate_zeros()
    return part


def _lone_pivots(part: csr_array) -> tuple[Integers, Integers]:
    """Equations with a degree of freedom that no other has, and that one: the largest such coefficient of each."""
    owner = np.repeat(np.arange(part.shape[0]), np.diff(part.indptr))
    lone = np.bincount(part.indices, minlength=part.shape[1])[part.indices] == 1
    size = np.where(lone, np.abs(part.data), 0.0)
    largest = np.zeros(part.shape[0])
    np.maximum.at(largest, owner, np.abs(part.data))
    entries = np.flatnonzero(size >= PIVOT * largest[owner])
    order = entries[np.lexsort((-size[entries], owner[entries]))]
    row, first = np.unique(owner[order], return_index=True)
    return row, part.indices[order[first]].astype(np.int64)


def _dense(part: csr_array, numbers: Integers) -> tuple[Integers, Integers, csr_array]:
    """Independent equations out of those left, the degrees of freedom they determine, and these from all others."""
    n = part.shape[1]
    columns = np.unique(part.indices).astype(np.int64)
    if not len(columns):
        return numbers[:0], columns, csr_array((0, n))
    matrix = part[:, columns].toarray()
    triangle, order = qr(matrix, mode="r", pivoting=True)
    diagonal = np.abs(np.diag(triangle))
    rank = int(np.count_nonzero(diagonal > RANK * diagonal[0]))
    pivot = np.sort(order[:rank])
    _, chosen = qr(matrix[:, pivot].T, mode="r", pivoting=True)
    chosen = np.sort(chosen[:rank])
    rest = np.setdiff1d(np.arange(len(columns)), pivot)
    solution: Floats = -lu_solve(lu_factor(matrix[np.ix_(chosen, pivot)]), matrix[np.ix_(chosen, rest)])
    solution[np.abs(solution) < NEGLIGIBLE] = 0.0
    row, column = np.nonzero(solution)
    shape = (rank, n)
    return (
        numbers[chosen],
        columns[pivot],
        csr_array((solution[row, column], (row, columns[rest][column])), shape=shape),
    )


def _placed(rows: csr_array, at: Integers, n: int) -> csr_array:
    """The rows, moved to the places `at` of a matrix of n rows."""
    coo = rows.tocoo()
    return csr_array((coo.data, (at[coo.row], coo.col)), shape=(n, rows.shape[1]))
