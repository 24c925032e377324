"""Element matrices of a part, put together as sparse ones."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array, csr_array

from femstruct.arrays import Floats, Integers


def scattered(stiffness: Floats, mass: Floats, of_elements: Integers, count: int) -> tuple[csr_array, csr_array]:
    """Sums of two sets of element matrices [n, nd, nd] at the degrees of freedom [n, nd] of each element, sparse."""
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
