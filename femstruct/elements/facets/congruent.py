"""Matrices of many elements: blocks that stay in the cache, and elements that are alike computed once."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from femstruct.arrays import Floats, Integers

AT_ONCE: Final = 500
"""Elements of a block: their strain rows take 2 MB."""
SAMPLE: Final = 500
"""Elements that are looked at before all are compared: the next ones of a regular mesh are alike."""
ALIKE: Final = 1e-12
"""Of the largest number: what differs by less is the same, since coordinates of equal elements differ by rounding."""
_KEPT: Final = 31 * 2**20  # bytes


def each_once(size: int, matrices: Callable[..., Floats], *arrays: Floats) -> Floats:
    """Matrices [n, size, size] of elements by a function of arrays that have one entry an element [n, ..].

    Elements with the same entries but for rounding get the matrix of the first of them; a mesh whose first
    elements differ is computed element by element.

    >>> def squares(sides):
    ...     return sides[:, None, None] ** 2
    >>> each_once(1, squares, np.array([1.0, 2.0, 1.0, 2.0, 2.0])).ravel()
    array([1., 4., 1., 4., 4.])
    """
    count = len(arrays[0])
    first = of = np.arange(count)
    if 2 * len(alike(*(array[:SAMPLE] for array in arrays))[0]) <= min(count, SAMPLE):
        first, of = alike(*arrays)
    # A freed array of this size makes glibc keep what is freed: a third of the time went into getting memory again.
    np.empty(_KEPT, np.uint8)
    found = np.empty((len(first), size, size))
    for start in range(0, len(first), AT_ONCE):
        block = first[start : start + AT_ONCE]
        found[start : start + AT_ONCE] = matrices(*(array[block] for array in arrays))
    return found if len(first) == count else found[of]


def alike(*arrays: Floats) -> tuple[Integers, Integers]:
    """The first elements of each kind [k] and the kind of every element [n], by arrays with one entry an element.

    >>> [numbers.tolist() for numbers in alike(np.array([[0.1, 1.0], [0.3, 1.0], [0.1 + 1e-16, 1.0]]))]
    [[0, 1], [0, 1, 0]]
    """
    steps = np.concatenate([_steps(array) for array in arrays], axis=1)
    factors = np.random.default_rng(1).integers(1, 2**62, steps.shape[1]) | 1
    _, first, of = np.unique(steps @ factors, return_index=True, return_inverse=True)
    if (steps[first][of] != steps).any():  # two kinds with one sum: none is alike
        return np.arange(len(steps)), np.arange(len(steps))
    order = np.argsort(first)
    return first[order], np.argsort(order)[of]


def _steps(array: Floats) -> Integers:
    """Entries of each element in whole steps [n, k]; none for an array that is the same for all."""
    flat = np.reshape(array, (len(array), -1))
    largest = np.abs(flat).max(initial=0.0)
    if largest == 0.0 or array.strides[0] == 0:
        return np.zeros((len(array), 0), dtype=np.int64)
    steps: Integers = np.rint(flat / (ALIKE * largest)).astype(np.int64)
    return steps
