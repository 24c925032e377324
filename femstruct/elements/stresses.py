"""Stresses at a place as engineers compare them: the equivalent stress of von Mises, principal stresses."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from femstruct.arrays import Floats

STRESSES: Final = ("xx", "yy", "zz", "xy", "yz", "zx")
"""Components of a stress, along local axes."""


def von_mises(stresses: Floats, components: tuple[str, ...]) -> Floats:
    """Equivalent stress of von Mises [p, ...] from stresses [p, c, ...], named components first to last.

    R. von Mises, Nachr. Ges. Wiss. Goettingen (1913) 582-592. Components that are not named are zero.

    >>> von_mises(np.array([[3.0, 2.0]]), ("xx", "xy"))
    array([4.58257569])
    """
    s = {name: stresses[:, i] for i, name in enumerate(components)}
    zero = np.zeros(())
    xx, yy, zz, xy, yz, zx = (s.get(name, zero) for name in STRESSES)
    squared = ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2.0 + 3.0 * (xy**2 + yz**2 + zx**2)
    result: Floats = np.sqrt(squared)
    return result


def von_mises_in_a_cycle(stresses: NDArray[np.complex128], components: tuple[str, ...]) -> Floats:
    """Largest equivalent stress of von Mises in a cycle [p, ...] of harmonic stresses, complex amplitudes [p, c, ...].

    Notes
    -----
    Components of different phase have no equivalent amplitude. The square Q of the equivalent stress is a quadratic
    form with a matrix A. Of s(t) = a cos(omega t) - b sin(omega t) it swings between (Q(a) + Q(b)) / 2 -+ |s' A s| / 2,
    s = a + j b.

    Two shear stresses of 3 and 4 Pa, a quarter of a period apart: the larger counts, not the root of their squares.

    >>> von_mises_in_a_cycle(np.array([[3.0, 4.0j]]), ("xy", "yz")).round(9) ** 2 / 3.0
    array([16.])
    """
    a, b = stresses.real, stresses.imag
    first, second, both = (von_mises(one, components) ** 2 for one in (a, b, a + b))
    swing = np.hypot(first - second, both - first - second)
    result: Floats = np.sqrt((first + second + swing) / 2.0)
    return result


def principal(stresses: Floats, components: tuple[str, ...]) -> Floats:
    """Principal stresses [p, 3], the largest first, from stresses [p, c].

    >>> principal(np.array([[0.0, 5.0]]), ("xx", "xy"))
    array([[ 5.,  0., -5.]])
    """
    tensor = np.zeros((len(stresses), 3, 3))
    for i, name in enumerate(components):
        row, column = ("xyz".index(axis) for axis in name)
        tensor[:, row, column] = tensor[:, column, row] = stresses[:, i]
    result: Floats = np.asarray(np.linalg.eigvalsh(tensor)[:, ::-1], dtype=np.float64)
    return result
