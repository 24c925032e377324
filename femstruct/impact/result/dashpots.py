"""What the structure's own dashpots took of the energy that its modes lost."""

from __future__ import annotations

import numpy as np
import scipy

from femstruct.arrays import Floats
from femstruct.impact.engine.motion import VELOCITY, along
from femstruct.impact.result.response import EnergyBalance, Response

CHUNK = 32  # rows whose samples are in memory at a time
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
    taken, whole = (_energy(response, matrix) for matrix in (basis.dashpots, basis.time_damping))

    def until(balance: EnergyBalance) -> float:
        mine, all_of_it = (float(np.interp(balance.t, response.t, energy)) for energy in (taken, whole))
        return balance.lost_modes * mine / all_of_it if all_of_it > 0.0 else 0.0

    return None if ledger.at_separation is None else until(ledger.at_separation), until(ledger.end)


def _energy(response: Response, damping: Floats) -> Floats:
    """What a damping matrix [k, k] takes until every sample [nt] [J], by trapezoids."""
    values, vectors = np.linalg.eigh(damping)
    kept = np.abs(values) > EIGENVALUE_ROUNDING * np.abs(values).max()
    values, rows = values[kept], vectors[:, kept].T
    power = np.zeros(len(response.t))
    for first in range(0, len(rows), CHUNK):
        speeds = along(response.motion, VELOCITY, rows[first : first + CHUNK])
        power += values[first : first + CHUNK] @ speeds**2
    energy: Floats = scipy.integrate.cumulative_trapezoid(power, response.t, initial=0)
    return energy
