"""Levels of quotients: 10 lg x, and nothing where there is nothing."""

from __future__ import annotations

from math import log10, nan

import numpy as np
from numpy.typing import ArrayLike

from acoustics.arrays import Floats


def decibel(quotient: float) -> float:
    """10 lg of a quotient of squares [dB]; nan, a level that is not there, of 0 and of what is not known.

    >>> decibel(100.0), decibel(0.0)
    (20.0, nan)
    """
    return 10 * log10(quotient) if quotient > 0 else nan


def decibels(quotients: ArrayLike) -> Floats:
    """The same of each of several.

    >>> decibels([100.0, 0.0]).tolist()
    [20.0, nan]
    """
    values = np.asarray(quotients, dtype=np.float64)
    return np.asarray(10 * np.log10(values, out=np.full(values.shape, nan), where=values > 0))
