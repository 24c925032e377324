"""Element matrices put together by blocks of nodes, against a plain loop."""

import numpy as np
import pytest

from femstruct.model.grid.scatter import scattered


@pytest.mark.parametrize("side", [1, 2, 3, 6])
@pytest.mark.parametrize("shift", [0, 1])
def test_sums_are_those_of_a_loop(side, shift):
    """Elements of four nodes that share nodes, numbered at random; a DOF in front of all puts them off their blocks."""
    random = np.random.default_rng(side)
    nodes = np.array([random.permutation(9)[:4] for _ in range(30)])
    numbers = (side * nodes[:, :, None] + np.arange(side)).reshape(30, -1) + shift
    count = 10 * side
    matrices = random.standard_normal((2, 30, 4 * side, 4 * side))
    matrices += matrices.swapaxes(2, 3)
    expected = np.zeros((2, count, count))
    for of, whole in zip(matrices, expected, strict=True):
        for dofs, matrix in zip(numbers, of, strict=True):
            whole[np.ix_(dofs, dofs)] += matrix
    for got, whole in zip(scattered(*matrices, numbers, count), expected, strict=True):
        np.testing.assert_allclose(got.toarray(), whole, atol=1e-13)  # rounding of sums of up to 30 numbers of size 1
        assert got.has_canonical_format
        if not shift and side > 1:
            assert (got != got.T).nnz == 0  # summed in one order on both sides of the diagonal
