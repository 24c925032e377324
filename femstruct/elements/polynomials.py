"""Shape functions on the unit interval as polynomial coefficients, and their exact integrals.

A family of shape functions is an array [n, 4]: row k holds the coefficients of 1, s, s^2, s^3. All coefficients are
whole numbers or halves, so integrals of products, computed as whole numbers over 420 = lcm(1..7), are exact but for
one final division.
"""

from __future__ import annotations

from functools import cache
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from femstruct.arrays import Floats
from femstruct.errors import InputError

TERMS: Final = 4
DENOMINATOR: Final = 420.0
"""Least common multiple of 1..7, the denominators of the integrals of s^0 .. s^6 over the unit interval."""


def _constant(rows: list[list[float]]) -> Floats:
    array = np.array(rows, dtype=np.float64)
    array.flags.writeable = False
    return array


LINEAR: Final = _constant([[1, -1, 0, 0], [0, 1, 0, 0]])
"""Value at 0 and at 1."""

HERMITE_VALUE: Final = _constant([[1, 0, -3, 2], [0, 0, 3, -2]])
"""(1 + 2 s)(1 - s)^2 and (3 - 2 s) s^2: unit value at one end, no slope at either."""

HERMITE_SLOPE: Final = _constant([[0, 1, -2, 1], [0, 0, -1, 1]])
"""s (1 - s)^2 and -(1 - s) s^2: unit slope at one end, no value at either."""

QUADRATIC: Final = _constant([[1, -3, 2, 0], [0, -1, 2, 0], [0, 4, -4, 0]])
"""Value at 0, at 1 and in the middle."""


def derivative(coefficients: Floats, axis: int = -1) -> Floats:
    """Coefficients of the derivative along one axis of coefficients, the array keeping its shape.

    >>> derivative(np.array([5.0, 3.0, 2.0, 1.0]))
    array([3., 4., 3., 0.])
    """
    rows = np.moveaxis(coefficients, axis, -1)
    slope = np.zeros_like(rows)
    slope[..., :-1] = rows[..., 1:] * np.arange(1.0, TERMS)
    return np.moveaxis(slope, -1, axis)


def powers(points: ArrayLike) -> Floats:
    """1, s, s^2, s^3 at the points: [m] -> [m, 4]."""
    return np.asarray(points, dtype=np.float64)[..., None] ** np.arange(TERMS)


@cache
def moment_numerators() -> Floats:
    """Whole numbers n_ij [4, 4] with n_ij / 420 the integral of s^i s^j over the unit interval."""
    i = np.arange(TERMS)
    numerators = np.rint(DENOMINATOR / (i[:, None] + i + 1))
    numerators.flags.writeable = False
    return numerators


def integral(left: Floats, right: Floats) -> Floats:
    """Integrals over the unit interval of all products of two families: [n, 4], [m, 4] -> [n, m].

    >>> integral(LINEAR, LINEAR) * 6
    array([[2., 1.],
           [1., 2.]])
    """
    product: Floats = left @ moment_numerators() @ right.T
    return product / DENOMINATOR


def positive(where: str, values: ArrayLike) -> Floats:
    """The values as float64, refused when one is not finite and above zero."""
    array = np.asarray(values, dtype=np.float64)
    good = np.isfinite(array) & (array > 0)
    if not good.all():
        raise InputError(where, got=str(array[~good].flat[0]), expected="finite values above zero")
    return array


# ----------------------------------------------------------------------------------------------------------------------
# Gauss points on the unit interval.
# ----------------------------------------------------------------------------------------------------------------------


@cache
def gauss_interval(n: int) -> tuple[Floats, Floats]:
    """Points and weights [n] on 0 to 1, exact for polynomials up to degree 2 n - 1; the weights sum to 1.

    >>> points, weights = gauss_interval(3)
    >>> round(float(weights @ points**5), 12)
    0.166666666667
    """
    points, weights = np.polynomial.legendre.leggauss(n)
    points, weights = (points + 1.0) / 2.0, weights / 2.0
    points.flags.writeable = weights.flags.writeable = False  # the cached arrays are shared by all who ask
    return points, weights
