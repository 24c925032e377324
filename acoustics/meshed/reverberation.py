"""How fast sound dies away in a room of any shape: decays of its modes, and the reverberation time that is measured."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf, log
from typing import Final, Literal

import numpy as np

from acoustics.air import Air
from acoustics.arrays import Floats
from acoustics.losses import Losses, modal_damping_ratios
from acoustics.meshed.absorbing_walls import absorbed, coupling, solved_together
from acoustics.meshed.coupled_wall_modes import resonances
from acoustics.meshed.finite_elements import CavityModes
from acoustics.meshed.walls import AnyWall
from acoustics.meshed.yielding_walls import wall_motion

TOP_DB: Final = -5.0  # of the decay: a line is fitted to the level from here ...
BOTTOM_DB: Final = -25.0  # ... to here, T20 of ISO 3382-2, as ISO 16283 measures it
_TIMES: Final = 500
_STILL: Final = 1e-12  # rate [1/s] below which nothing decays


@dataclass(frozen=True, eq=False)
class Decays:
    """Damped modes of a room: their frequencies [n] [Hz], rates of their amplitudes [n] [1/s], and how much each is in
    the mean square of a pulse, over all places of its source and of microphones [n]."""

    frequency_hz: Floats
    rate: Floats
    square: Floats


def decays(modes: CavityModes, air: Air, losses: Losses, walls: Mapping[str, AnyWall]) -> Decays:
    """The modes of a room with its losses and what its walls absorb, without the uniform one: as its pressure has them.

    One by one they decay with the rate of the losses and c int beta P_n^2 / 2 V; where walls couple them, as their
    complex modes do.
    """
    taken = absorbed(modes, walls, air)
    together, constant = solved_together(walls, coupling(modes, taken, air))
    if together:
        taken = taken if constant else np.diag(np.diag(taken))
        poles, heard, driven = resonances(modes, air, losses, taken, wall_motion(modes, walls))
        squares = (np.abs(heard) ** 2).sum(axis=0) * (np.abs(driven) ** 2).sum(axis=1)
        ring = poles.imag > 0
        return Decays(poles.imag[ring] / (2 * np.pi), -poles.real[ring], squares[ring])
    hz = modes.wavenumber[1:] * air.c / (2 * np.pi)
    rate = 2 * np.pi * hz * modal_damping_ratios(losses, hz) + 0.5 * air.c * np.diag(taken)[1:]
    return Decays(hz, rate, np.ones(len(hz)))


def measured_t60(modes: Decays, centre_hz: float, fraction: Literal[1, 3] = 3) -> float:
    """Reverberation time T20 [s] of a band, the mean over places of the squares of a pulse through its filter; infinite
    without losses.

    Notes
    -----
    The squares of modes add, each with its own rate: backward integration of them, and a line by least squares through
    the level from -5 to -25 dB. Where a band has no mode, those beside it are what its filter passes.

    >>> two = Decays(np.array([100.0, 101.0]), np.array([6.907755, 6.907755]), np.ones(2))
    >>> round(measured_t60(two, 100.0), 6)
    1.0
    """
    ratio, edge = modes.frequency_hz / centre_hz, 10 ** (0.15 / fraction)
    share = modes.square / (1 + ((ratio - 1 / ratio) / (edge - 1 / edge)) ** 8)  # order-4 Butterworth
    heard = share > 1e-6 * share.max(initial=0.0)
    rates, share = modes.rate[heard], share[heard]
    if not len(rates) or rates.min() <= _STILL:
        return inf
    t = np.linspace(0.0, -BOTTOM_DB / 10 * log(10) / (2 * rates.min()), _TIMES)
    left = (share / rates) @ np.exp(-2 * np.outer(rates, t))
    level = 10 * np.log10(left / left[0])
    part = (level <= TOP_DB) & (level >= BOTTOM_DB)
    return float(-60 / np.polyfit(t[part], level[part], 1)[0])
