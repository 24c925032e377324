"""Element matrices of a part, put together as sparse ones."""

from __future__ import annotations

import numpy as np
from scipy.sparse import bsr_array, coo_array, csr_array

from femstruct.arrays import Floats, Integers


def scattered(stiffness: Floats, mass: Floats, of_elements: Integers, count: int) -> tuple[csr_array, csr_array]:
    """Sums of two sets of element matrices [n, nd, nd] at the degrees of freedom [n, nd] of each element, sparse.

    Where the degrees of freedom of every node stand side by side, blocks of them are put together: a 36th of the places
    to sort for shells, in a quarter of the time.

    >>> K, M = scattered(np.ones((2, 4, 4)), np.ones((2, 4, 4)), np.array([[0, 1, 2, 3], [2, 3, 4, 5]]), 6)
    >>> K.sum(axis=0)
    array([4., 4., 8., 8., 4., 4.])
    """
    side = _side_by_side(of_elements, count)
    if side == 1:
        return _by_entries(stiffness, mass, of_elements, count)
    nodes = of_elements[:, ::side] // side
    each = nodes.shape[1]
    n_nodes = count // side
    places = (nodes[:, :, None].astype(np.int64) * n_nodes + nodes[:, None, :]).ravel()
    order = np.argsort(places, kind="stable")
    ordered = places[order]
    starts = np.flatnonzero(np.diff(ordered, prepend=-1))
    # Blocks of one place are summed in the order of the elements on either side of the diagonal: exactly symmetric.
    sums = csr_array((np.ones(len(order)), order, np.append(starts, len(order))), shape=(len(starts), len(order)))
    rows, columns = np.divmod(ordered[starts], n_nodes)
    first_of_rows = np.searchsorted(rows, np.arange(n_nodes + 1)).astype(np.int32)
    pair = []
    for matrices in (stiffness, mass):
        blocks = matrices.reshape(-1, each, side, each, side).swapaxes(2, 3).reshape(-1, side * side)
        together = (sums @ blocks).reshape(-1, side, side)
        whole = bsr_array((together, columns.astype(np.int32), first_of_rows), shape=(count, count))
        pair.append(csr_array(whole.tocsr()))
    return pair[0], pair[1]


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
