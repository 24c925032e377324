"""A system whose modes damping couples, in terms of oscillators that nothing couples."""

from __future__ import annotations

import numpy as np

from femstruct.arrays import Floats
from femstruct.impact.engine.records import System
from femstruct.modal.coupled_damping.oscillators import Oscillators


def uncoupled(system: System, start: Floats, found: Oscillators, damping: Floats) -> tuple[System, Floats]:
    """The system and its start [2, n] with oscillators in place of its modes; bodies stay as they are.

    damping [k, k] : of the modes, whose norm bounds the rates.
    """
    k, n = system.n_modes, len(system.omega)
    rows, over = system.rows, system.over
    omega, own = system.omega.copy(), system.damping.copy()
    omega[:k], own[:k] = found.omega, found.damping
    turned = start.copy()
    turned[0, :k], turned[1, :k] = found.kicks @ start[1, :k], found.drives @ start[1, :k]
    return system._replace(
        omega=omega,
        damping=own,
        rows=_seen(rows, found.places, k),
        tilts=_seen(rows, found.tilts, k, bodies=False),
        kicks=_seen(rows, found.kicks.T, k, bodies=False),
        drives=_seen(rows, found.drives.T, k),
        over=_seen(over, found.places, k),
        over_tilts=_seen(over, found.tilts, k, bodies=False),
        energy_form=np.ascontiguousarray(found.energy),
        loss_form=np.ascontiguousarray(found.losses),
        reach=np.array([system.reach[0], float(np.linalg.norm(damping, 2))]),
    ), turned.reshape(2, n)


def _seen(rows: Floats, matrix: Floats, k: int, bodies: bool = True) -> Floats:
    """Rows over [modes; bodies] through a matrix of the modes; 0 for bodies where they have no such part."""
    out = rows.copy() if bodies else np.zeros_like(rows)
    out[:, :k] = rows[:, :k] @ matrix
    return np.ascontiguousarray(out)
