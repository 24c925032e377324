"""Elimination of linear equations between degrees of freedom: ties become a map from the free ones.

The equations are homogeneous. Degrees of freedom that stand alone in an equation are held; then, round by round,
those that occur in no other remaining equation are expressed by the rest of theirs, which needs no arithmetic
between equations; what is left, where plates meet in different planes and closed chains of joints repeat
themselves, is solved as one small dense system whose rank is decided and whose redundant equations are dropped.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import overload

import numpy as np
from scipy.linalg import lu_factor, lu_solve, qr
from scipy.sparse import csr_array

from femstruct.arrays import Floats, Integers
from femstruct.conventions import N_COMPONENTS
from femstruct.model.model import Model
from femstruct.model.part import OwnDofs

# ----------------------------------------------------------------------------------------------------------------------
# Raw degrees of freedom, before ties: those of all parts, one part after the other, and the components they make.
# ----------------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class RawDofs:
    """Numbers of the raw degrees of freedom.

    count : how many. parts : first number and degrees of freedom, by part. output [n_nodes * 7, count] : nodal
    components from raw degrees of freedom. translations [count, 3] : unit translations along x, y, z.
    """

    count: int
    parts: Mapping[str, tuple[int, OwnDofs]]
    output: csr_array
    translations: Floats

    def placed(self, name: str, matrix: csr_array) -> csr_array:
        """A matrix on the degrees of freedom of one part [n, n] among all of them [count, count]."""
        first, own = self.parts[name]
        before, after = np.zeros(first), np.full(self.count - first - own.count, matrix.nnz)
        indptr = np.concatenate([before, matrix.indptr, after]).astype(matrix.indptr.dtype)
        return csr_array((matrix.data, matrix.indices + matrix.indices.dtype.type(first), indptr), (self.count,) * 2)


def number_dofs(model: Model) -> RawDofs:
    """Numbers for all raw degrees of freedom of a model, and the map to nodal components."""
    parts: dict[str, tuple[int, OwnDofs]] = {}
    rows: list[Integers] = []
    columns: list[Integers] = []
    values: list[Floats] = []
    count = 0
    for name, part in model.parts.items():
        own = part.dofs()
        used = own.values != 0.0
        rows.append(own.rows[used] + part.first * N_COMPONENTS)
        columns.append(own.columns[used] + count)
        values.append(own.values[used])
        parts[name] = count, own
        count += own.count
    at = np.concatenate(rows), np.concatenate(columns)
    output = csr_array((np.concatenate(values), at), shape=(model.mesh.n_nodes * N_COMPONENTS, count))
    return RawDofs(count, parts, output, np.concatenate([own.translations for _, own in parts.values()]))


class DofLabels(Sequence[str]):
    """Names of degrees of freedom for messages, made when asked for: "floor node 12 (0.1, 0.2, 0) deflection"."""

    def __init__(self, model: Model, dofs: RawDofs, kept: Integers) -> None:
        self._model, self._kept = model, kept
        # Not the maps to nodal components, which take as much memory as K.
        self._parts = {name: (first, own.count, own.labels, own.extra) for name, (first, own) in dofs.parts.items()}

    def __len__(self) -> int:
        return len(self._kept)

    def __iter__(self) -> Iterator[str]:
        return (self._label(int(raw)) for raw in self._kept)

    @overload
    def __getitem__(self, index: int) -> str: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[str, ...]: ...
    def __getitem__(self, index: int | slice) -> str | tuple[str, ...]:
        if isinstance(index, slice):
            return tuple(self._label(int(raw)) for raw in self._kept[index])
        return self._label(int(self._kept[index]))

    def _label(self, raw: int) -> str:
        for name, (first, count, labels, extra) in self._parts.items():
            if first <= raw < first + count:
                at_nodes = count - len(extra)
                if raw - first >= at_nodes:
                    return f"{name} {extra[raw - first - at_nodes]}"
                node, component = divmod(raw - first, len(labels))
                part = self._model.parts[name]
                place = ", ".join(f"{value:.6g}" for value in part.places[node])
                return f"{name} node {part.first + node} ({place}) {labels[component]}"
        raise IndexError(raw)


# ----------------------------------------------------------------------------------------------------------------------
# Elimination of linear equations between degrees of freedom.
# ----------------------------------------------------------------------------------------------------------------------

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
        row, column = _single_pivots(part)
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


def _single_pivots(part: csr_array) -> tuple[Integers, Integers]:
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
