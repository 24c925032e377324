"""Gauss points on the unit interval."""

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
    points, weights = (points + 1.0) / 2.0, weights / 2.0
    points.flags.writeable = weights.flags.writeable = False  # the cached arrays are shared by all who ask
    return points, weights
