"""What the structure's own dashpots took of the energy that its modes lost."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy

from femstruct.arrays import Floats
from femstruct.impact.engine.motion import VELOCITY, along, modal_motion
from femstruct.impact.result.response import EnergyBalance, Response

CHUNK = 32  # rows or modes whose samples are in memory at a time
EIGENVALUE_ROUNDING = 1e-14  # of the largest eigenvalue of a damping matrix: rounding


def dashpot_losses(response: Response) -> tuple[float | None, float]:
    """Lost in the dashpots of springs and foundations until the separation (None without one) and until the end [J].

    They are a part of `EnergyBalance.lost_modes`.

    Notes: the march books all damping of the structure as one term, exactly. The share of the dashpots in it is that of
    their power in the power of all damping, both summed over the samples, which cancels most of what samples miss.
    """
    basis, ledger = response.basis, response.ledger
    if not basis.dashpots.any():
        return None if ledger.at_separation is None else 0.0, 0.0
    taken, whole = _energies(response, (basis.dashpots, basis.time_damping))

    def until(balance: EnergyBalance) -> float:
        mine, all_of_it = (float(np.interp(balance.t, response.t, energy)) for energy in (taken, whole))
        return balance.lost_modes * mine / all_of_it if all_of_it > 0.0 else 0.0

    return None if ledger.at_separation is None else until(ledger.at_separation), until(ledger.end)


def _energies(response: Response, dampings: Sequence[Floats]) -> list[Floats]:
    """What damping matrices [k, k] take until every sample [nt] [J], by trapezoids."""
    k = len(response.basis.omega)
    if k <= CHUNK:
        rate = modal_motion(response.motion, VELOCITY, np.arange(k))
        powers = [(rate * (damping @ rate)).sum(axis=0) for damping in dampings]
    else:
        powers = [_power(response, damping) for damping in dampings]
    return [scipy.integrate.cumulative_trapezoid(power, response.t, initial=0) for power in powers]


def _power(response: Response, damping: Floats) -> Floats:
    """What a damping matrix takes at every sample [nt] [W], a few rows at a time."""
    values, vectors = np.linalg.eigh(damping)
    kept = np.abs(values) > EIGENVALUE_ROUNDING * np.abs(values).max()
    values, rows = values[kept], vectors[:, kept].T
    power = np.zeros(len(response.t))
    for first in range(0, len(rows), CHUNK):
        speeds = along(response.motion, VELOCITY, rows[first : first + CHUNK])
        power += values[first : first + CHUNK] @ speeds**2
    return power
