"""Element matrices of a part, put together as sparse ones."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import bsr_array, coo_array, csr_array

from femstruct.arrays import Floats, Integers


def scatter(
    stiffness: Floats, mass: Floats, of_elements: Integers, count: int, which: Integers | None = None
) -> tuple[csr_array, csr_array]:
    """Sums of two sets of element matrices [m, nd, nd] at the degrees of freedom [n, nd] of each element, sparse.

    Parameters
    ----------
    count : int
        Of all degrees of freedom. Where the degrees of freedom of every node stand side by side, blocks of them are put
        together: a 36th of the places to sort for shells, in a quarter of the time.
    which : Integers | None [n]
        Whose matrices each element has, where many have the same; None: its own.

    Examples
    --------
    >>> K, M = scatter(np.ones((1, 4, 4)), np.ones((1, 4, 4)), np.array([[0, 1, 2, 3], [2, 3, 4, 5]]), 6, [0, 0])
    >>> K.sum(axis=0)
    array([4., 4., 8., 8., 4., 4.])
    """
    every = np.arange(len(of_elements)) if which is None else np.asarray(which)
    side = _side_by_side(of_elements, count)
    if side == 1:
        return _by_entries(stiffness[every], mass[every], of_elements, count)
    nodes = of_elements[:, ::side] // side
    each = nodes.shape[1]
    n_nodes = count // side
    places = (nodes[:, :, None].astype(np.int64) * n_nodes + nodes[:, None, :]).ravel()
    order = np.argsort(places, kind="stable")
    ordered = places[order]
    starts = np.flatnonzero(np.diff(ordered, prepend=-1))
    blocks_of = (every[:, None] * each**2 + np.arange(each**2)).ravel()[order]
    # Blocks of one place are summed in the order of the elements on either side of the diagonal: exactly symmetric.
    summed = (np.ones(len(order)), blocks_of, np.append(starts, len(order)))
    sums = csr_array(summed, shape=(len(starts), len(stiffness) * each**2))
    rows, columns = np.divmod(ordered[starts], n_nodes)
    first_of_rows = np.searchsorted(rows, np.arange(n_nodes + 1)).astype(np.int32)
    pair: list[csr_array] = []
    for matrices in (stiffness, mass):
        blocks = matrices.reshape(-1, each, side, each, side).swapaxes(2, 3).reshape(-1, side * side)
        together = (sums @ blocks).reshape(-1, side, side)
        whole = bsr_array((together, columns.astype(np.int32), first_of_rows), shape=(count, count))
        pair.append(csr_array(whole.tocsr()))
    return _reached(*pair)


def interleave(matrices: Sequence[csr_array], per_node: Sequence[int]) -> csr_array:
    """Matrices that are not coupled, each on so many degrees of freedom a node, as one in which those of a node stand
    one behind the other. Entries that are zero stay.

    >>> interleave([csr_array(np.diag([1.0, 2.0])), csr_array(np.diag([3.0, 4.0]))], (1, 1)).toarray().diagonal()
    array([1., 3., 2., 4.])
    """
    whole, first, behind = sum(per_node), 0, 0
    to, indptr = [], [np.zeros(1, dtype=np.int64)]
    for matrix, own in zip(matrices, per_node, strict=True):
        numbers = np.arange(matrix.shape[0])
        to.append(numbers // own * whole + first + numbers % own)
        indptr.append(matrix.indptr[1:].astype(np.int64) + behind)
        first, behind = first + own, behind + matrix.nnz
    columns = np.concatenate([at.astype(np.int32)[one.indices] for at, one in zip(to, matrices, strict=True)])
    values = np.concatenate([one.data for one in matrices])
    order = np.argsort(np.concatenate(to))
    stacked = csr_array((values, columns, np.concatenate(indptr).astype(np.int32)), shape=(len(order), len(order)))
    return csr_array(stacked[order])


def with_diagonal(matrix: csr_array, values: Floats) -> csr_array:
    """A matrix with a diagonal matrix behind it.

    >>> with_diagonal(csr_array(np.ones((1, 1))), [2.0, 0.0]).toarray().diagonal()
    array([1., 2., 0.])
    """
    n, more = matrix.shape[0], len(values)
    behind = np.arange(1, more + 1, dtype=matrix.indptr.dtype)
    parts = (
        np.concatenate([matrix.data, values]),
        np.concatenate([matrix.indices, n - 1 + behind]).astype(matrix.indices.dtype),
        np.concatenate([matrix.indptr, matrix.indptr[-1] + behind]),
    )
    return csr_array(parts, shape=(n + more, n + more))


def _reached(one: csr_array, other: csr_array) -> tuple[csr_array, csr_array]:
    """Two matrices with entries at the same places, without those where both are zero: a third of them in a regular
    grid. They share where their entries are."""
    kept = (one.data != 0.0) | (other.data != 0.0)
    indptr = np.zeros_like(one.indptr)
    indptr[1:] = np.add.reduceat(np.append(kept, False), one.indptr[:-1], dtype=indptr.dtype)
    indptr[1:][np.diff(one.indptr) == 0] = 0  # of an empty row, `reduceat` has the first entry of the next
    np.cumsum(indptr, out=indptr)
    indices = one.indices[kept]
    first, second = (csr_array((each.data[kept], indices, indptr), shape=each.shape) for each in (one, other))
    return first, second


def _side_by_side(of_elements: Integers, count: int) -> int:
    """Largest number of degrees of freedom that always stand side by side, each group at a multiple of it."""
    n_dofs = of_elements.shape[1]
    for side in range(n_dofs // 2, 1, -1):
        if n_dofs % side or count % side:
            continue
        groups = of_elements.reshape(len(of_elements), -1, side)
        if not (groups[..., 0] % side).any() and (groups == groups[..., :1] + np.arange(side)).all():
            return side
    return 1


def _by_entries(stiffness: Floats, mass: Floats, of_elements: Integers, count: int) -> tuple[csr_array, csr_array]:
    n_dofs = of_elements.shape[1]
    numbers = of_elements.astype(np.int32)
    rows = np.repeat(numbers, n_dofs, axis=1).ravel()
    columns = np.tile(numbers, (1, n_dofs)).ravel()
    # Sorting the places costs most of it and is the same for both, so they travel as one complex matrix.
    both = np.empty(stiffness.shape, dtype=np.complex128)
    both.real, both.imag = stiffness, mass
    together = csr_array(coo_array((both.ravel(), (rows, columns)), shape=(count, count)))
    K, M = (
        csr_array((values.copy(), together.indices, together.indptr), shape=together.shape)
        for values in (together.data.real, together.data.imag)
    )
    return K, M
