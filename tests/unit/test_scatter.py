"""Element matrices put together by blocks of nodes, against a plain loop."""

import numpy as np
import pytest
from scipy.sparse import csr_array

from femstruct.model.scatter import interleave, scatter


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
    for got, whole in zip(scatter(*matrices, numbers, count), expected, strict=True):
        np.testing.assert_allclose(got.toarray(), whole, atol=1e-13)  # rounding of sums of up to 30 numbers of size 1
        assert got.has_canonical_format
        if not shift and side > 1:
            assert (got != got.T).nnz == 0  # summed in one order on both sides of the diagonal


@pytest.mark.parametrize("side", [1, 3])
def test_elements_that_share_their_matrices(side):
    """Two matrices for all."""
    random = np.random.default_rng(side)
    nodes = np.array([random.permutation(9)[:4] for _ in range(30)])
    numbers = (side * nodes[:, :, None] + np.arange(side)).reshape(30, -1)
    matrices, which = random.standard_normal((2, 2, 4 * side, 4 * side)), random.integers(0, 2, 30)
    count = 9 * side
    shared = scatter(*matrices, numbers, count, which)
    each = scatter(*matrices[:, which], numbers, count)
    for one, other in zip(shared, each, strict=True):
        assert one.shape == (count, count)
        np.testing.assert_allclose(one.toarray(), other.toarray(), atol=1e-14)  # the same sums


def test_interleaved_matrices_keep_their_entries():
    random = np.random.default_rng(5)
    dense = [random.standard_normal((4 * own, 4 * own)) * (random.random((4 * own, 4 * own)) < 0.4) for own in (4, 3)]
    sparse = [csr_array(one) for one in dense]
    sparse[0].data[0] = 0.0
    dense[0] = sparse[0].toarray()
    got = interleave(sparse, (4, 3))
    own = [(7 * np.arange(4)[:, None] + first + np.arange(n)).ravel() for first, n in ((0, 4), (4, 3))]
    for places, one in zip(own, dense, strict=True):
        np.testing.assert_array_equal(got.toarray()[np.ix_(places, places)], one)
    assert got.nnz == sparse[0].nnz + sparse[1].nnz and got.has_canonical_format
