"""Stiffnesses that depend on frequency, for solutions at one frequency after the other."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.sparse import csc_array

from femstruct.assembly.matrices import Assembly
from femstruct.model.materials.loss_by_frequency import LossByFrequency


class Varying(NamedTuple):
    """What a part adds at an angular frequency [rad/s], which may be complex: factor(omega) stiffness.

    grows : with the square root of frequency.
    """

    stiffness: csc_array
    factor: Callable[[complex], complex]
    grows: bool


def varying(assembly: Assembly, lossy: bool) -> tuple[Varying, ...]:
    """Walls at edges, and the losses of parts whose loss factors depend on frequency; lossy : whether the law of
    damping asks for those of parts, else walls are springs alone."""
    found = []
    for name, stiffness in assembly.part_stiffness.items():
        loss = assembly.loss_factors.get(name, 0.0)
        if name in assembly.growing:
            own = 1.0 + 1j * float(loss) * lossy if isinstance(loss, float) else 1.0
            found.append(Varying(stiffness, _growing(assembly.growing[name], own), True))
        elif lossy and isinstance(loss, LossByFrequency):
            found.append(Varying(stiffness, _tabled(loss), False))
    return tuple(found)


def _growing(at_hz: float, factor: complex) -> Callable[[complex], complex]:
    return lambda omega: complex(factor * np.sqrt(complex(omega) / (2.0 * np.pi * at_hz)))


def _tabled(loss: LossByFrequency) -> Callable[[complex], complex]:
    return lambda omega: 1j * float(loss.at(abs(omega) / (2.0 * np.pi)))
