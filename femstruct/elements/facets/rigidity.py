"""Checked matrices of rigidity and densities, as the flat elements take them."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from femstruct.arrays import Floats
from femstruct.errors import InputError

Rigidities = tuple[ArrayLike, ArrayLike, ArrayLike, ArrayLike]
"""A, B, D and As."""
ROUNDING: Final = 1e-12
"""Asymmetry that the products of matrices leave, beside the largest entry."""


def finite_rigidity(name: str, matrix: ArrayLike, size: int = 3) -> Floats:
    """Matrices [size, size] or [n, size, size] as float64; InputError for another shape and for nan or infinity.

    >>> finite_rigidity("B", np.zeros((3, 3))).shape
    (3, 3)
    """
    rigidity = np.asarray(matrix, dtype=np.float64)
    if rigidity.shape[-2:] != (size, size):
        expected = f"shape ({size}, {size}) or (n, {size}, {size})"
        raise InputError(name, got=f"shape {rigidity.shape}", expected=expected)
    if not np.isfinite(rigidity).all():
        raise InputError(name, got="nan or infinity", expected="finite numbers")
    return rigidity


def symmetric_rigidity(name: str, matrix: ArrayLike, size: int = 3) -> Floats:
    """Matrices as of `finite_rigidity`; InputError for those that are not symmetric.

    >>> symmetric_rigidity("A", np.eye(3)).shape
    (3, 3)
    """
    rigidity = finite_rigidity(name, matrix, size)
    if np.abs(rigidity - rigidity.swapaxes(-1, -2)).max(initial=0.0) > ROUNDING * np.abs(rigidity).max(initial=0.0):
        raise InputError(name, got="a matrix that is not symmetric", expected="a symmetric rigidity")
    return rigidity


def per_area(name: str, value: ArrayLike, count: int) -> Floats:
    """Masses or inertias per area [n] of n cells, zero allowed; InputError for others."""
    density = np.broadcast_to(np.asarray(value, dtype=np.float64), (count,))
    if not (np.isfinite(density) & (density >= 0)).all():
        raise InputError(name, got=str(density.min()), expected="finite values, zero or above")
    return density


def masses(count: int, m0: ArrayLike, m1: ArrayLike, m2: ArrayLike) -> tuple[Floats, Floats, Floats]:
    """m0, m1 and m2 [count] of elements; InputError names the one that is none. m1 may have either sign."""
    first = np.broadcast_to(np.asarray(m1, dtype=np.float64), (count,))
    if not np.isfinite(first).all():
        raise InputError("m1", got="nan or infinity", expected="finite values")
    return per_area("m0", m0, count), first, per_area("m2", m2, count)


def section(
    count: int, A: ArrayLike, B: ArrayLike, D: ArrayLike, As: ArrayLike
) -> tuple[Floats, Floats, Floats, Floats]:
    """A, B, D [count, 3, 3] and As [count, 2, 2] of `count` elements; InputError names the one that is none."""
    symmetric = (symmetric_rigidity(name, of, size) for name, of, size in (("A", A, 3), ("D", D, 3), ("As", As, 2)))
    stretch, bend, shear = (np.broadcast_to(of, (count, *of.shape[-2:])) for of in symmetric)
    coupling = finite_rigidity("B", B)
    return stretch, np.broadcast_to(coupling, (count, 3, 3)), bend, shear
