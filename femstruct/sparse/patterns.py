"""Symmetric sparse matrices brought to one pattern, so that sums of them need one analysis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, eye_array

Values = NDArray[Any]
"""Numbers on a pattern, real or complex [nnz]."""


@dataclass(frozen=True, eq=False)
class Pattern:
    """Where symmetric matrices may have entries, the whole diagonal among them: columns, with rows in ascending order.

    indptr [n + 1], indices [nnz], as in a csc_array. diagonal [n] : which entries are on it.
    """

    indptr: NDArray[np.int32]
    indices: NDArray[np.int32]
    diagonal: NDArray[np.int64]

    @property
    def size(self) -> int:
        """Number of rows."""
        return len(self.indptr) - 1

    @property
    def owner(self) -> NDArray[np.int32]:
        """Column of every entry [nnz]."""
        return _owner(self.indptr)

    def matrix(self, values: Values) -> csc_array:
        """The matrix of these values."""
        return csc_array((values, self.indices, self.indptr), shape=(self.size, self.size))


def aligned(matrices: Sequence[csc_array]) -> tuple[Pattern, tuple[Values, ...]]:
    """The union of the patterns and of the diagonal, and the values of each matrix on it.

    >>> first, second = csc_array(np.diag([1.0, 2.0])), csc_array(np.array([[0.0, 3.0], [3.0, 0.0]]))
    >>> pattern, values = aligned([first, second])
    >>> pattern.matrix(values[0] + values[1]).toarray()
    array([[1., 3.],
           [3., 2.]])
    """
    sums = [_canonical(matrix) for matrix in matrices]
    union = sums[0]
    different = [union, *(one for one in sums[1:] if not _alike(one, union))]
    if len(different) > 1 or not _has_diagonal(union):
        union = csc_array(eye_array(union.shape[0], format="csc"))
        for one in different:
            union = csc_array(union + _ones(one))
        union = _canonical(union)
    indptr, indices = union.indptr.astype(np.int32, copy=False), union.indices.astype(np.int32, copy=False)
    pattern = Pattern(_fixed(indptr), _fixed(indices), np.flatnonzero(indices == _owner(indptr)))
    return pattern, tuple(_spread(one, union) for one in sums)


def _canonical(matrix: csc_array) -> csc_array:
    if matrix.has_canonical_format:
        return matrix
    matrix = matrix.copy()
    matrix.sum_duplicates()
    return matrix


def _has_diagonal(matrix: csc_array) -> bool:
    return int(np.count_nonzero(matrix.indices == _owner(matrix.indptr))) == matrix.shape[0]


def _owner(indptr: NDArray[Any]) -> NDArray[np.int32]:
    """Column of every entry [nnz]."""
    return np.repeat(np.arange(len(indptr) - 1, dtype=np.int32), np.diff(indptr))


def _fixed(places: NDArray[np.int32]) -> NDArray[np.int32]:
    """A read-only view: matrices made of a pattern share it."""
    view = places.view()
    view.flags.writeable = False
    return view


def _alike(one: csc_array, other: csc_array) -> bool:
    """Whether two matrices have entries at the same places."""
    return np.array_equal(one.indptr, other.indptr) and np.array_equal(one.indices, other.indices)


def _ones(matrix: csc_array) -> csc_array:
    return csc_array((np.ones(matrix.nnz), matrix.indices, matrix.indptr), shape=matrix.shape)


def _spread(matrix: csc_array, union: csc_array) -> Values:
    """Values of a matrix at the entries of a union that contains its pattern; zero at the others."""
    if matrix.nnz == union.nnz:
        return matrix.data
    n = matrix.shape[0]
    at, all_at = (
        np.repeat(np.arange(n, dtype=np.int64), np.diff(one.indptr)) * n + one.indices for one in (matrix, union)
    )
    values: Values = np.zeros(union.nnz, dtype=matrix.dtype)
    values[np.searchsorted(all_at, at)] = matrix.data
    return values
