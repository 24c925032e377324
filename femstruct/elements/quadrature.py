"""Gauss points on the unit interval and the unit square."""

from __future__ import annotations

from functools import cache

import numpy as np

from femstruct.arrays import Floats


@cache
def gauss_interval(n: int) -> tuple[Floats, Floats]:
    """Points and weights [n] on 0 to 1, exact for polynomials up to degree 2 n - 1; the weights sum to 1.

    >>> points, weights = gauss_interval(3)
    >>> round(float(weights @ points**5), 12)
    0.166666666667
    """
    points, weights = np.polynomial.legendre.leggauss(n)
    return _read_only((points + 1.0) / 2.0), _read_only(weights / 2.0)


@cache
def gauss_square(n: int) -> tuple[Floats, Floats, Floats]:
    """Places xi, eta and weights [n^2] on the unit square; the weights sum to 1.

    >>> xi, eta, weights = gauss_square(2)
    >>> round(float(weights @ (xi**3 * eta)), 12)
    0.125
    """
    points, weights = gauss_interval(n)
    xi, eta = np.repeat(points, n), np.tile(points, n)
    return _read_only(xi), _read_only(eta), _read_only(np.outer(weights, weights).ravel())


def _read_only(array: Floats) -> Floats:
    array.flags.writeable = False
    return array
