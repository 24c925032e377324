"""What the walls of a room of any shape absorb: how they damp its modes, and couple them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np

from acoustics.air import Air
from acoustics.arrays import Floats
from acoustics.errors import Advice
from acoustics.meshed.finite_elements import CavityModes, wall_integrals
from acoustics.meshed.walls import AnyWall, Wall

COUPLED: Final = 0.05  # what walls couple two modes by, over the distance of their frequencies, to need complex modes


def absorbed(modes: CavityModes, walls: Mapping[str, AnyWall], air: Air) -> Floats:
    """Integrals of beta psi_n psi_m over all walls, over the volume [n, n] [1/m]; beta is the two modes' geometric
    mean. Walls that yield are not among them."""
    frequency_hz = modes.wavenumber * air.c / (2 * np.pi)
    total = np.zeros((len(frequency_hz), len(frequency_hz)))
    for name, wall in walls.items():
        if isinstance(wall, Wall):
            root = np.sqrt(wall.at(frequency_hz))
            total += root[:, None] * wall_integrals(modes, name) * root / modes.mesh.volume
    return total


def coupling(modes: CavityModes, taken_up: Floats, air: Air) -> float:
    """Largest rate by which walls couple two modes, c |A_nm|, over the distance of their frequencies or, where they lie
    closer than that, over their own rates.

    taken_up [n, n] : of `absorbed` [1/m].
    """
    distance = air.c * np.abs(modes.wavenumber[:, None] - modes.wavenumber)
    rates = air.c * np.abs(taken_up)
    off = rates - np.diag(np.diag(rates))
    span = np.hypot(distance, np.add.outer(np.diag(rates), np.diag(rates)))
    ratio = np.divide(off, span, out=np.zeros_like(off), where=off > 0)
    return float(ratio.max(initial=0.0))


def solved_together(walls: Mapping[str, AnyWall], coupled: float) -> tuple[bool, bool]:
    """Whether modes are complex ones that walls couple, and whether walls that absorb are the same at all frequencies.

    coupled : of `coupling`.
    """
    resistive = [wall for wall in walls.values() if isinstance(wall, Wall)]
    constant = all(wall.constant for wall in resistive)
    return len(resistive) < len(walls) or (coupled > COUPLED and constant), constant


def coupled_walls(coupled: float) -> Advice:
    """Advice ``coupled-absorption``: modes are damped one by one where walls couple them."""
    return Advice(
        "coupled-absorption",
        f"the walls couple two room modes by {coupled:.2g} of the distance of their frequencies; {COUPLED:g} is "
        "allowed. "
        "The absorption depends on frequency, so each mode is damped separately, which is then a rough approximation",
        {"coupling": coupled, "allowed": COUPLED},
    )


def two_way_absorption(
    modes: CavityModes, walls: Mapping[str, AnyWall], air: Air, first_hz: float
) -> tuple[Advice, ...]:
    """Advice where walls absorb more than the damping of each mode by itself, which is what two-way coupling has.

    first_hz : the lowest mode of structure and air, 0 for none [Hz].
    """
    taken = absorbed(modes, walls, air)
    coupled = coupling(modes, taken, air)
    rate = air.c * float(taken[0, 0])  # at which walls let go of uniform pressure [1/s]
    lost = rate / (2 * np.pi * first_hz) if first_hz else 0.0
    if coupled <= COUPLED and lost <= COUPLED:
        return ()
    return (
        Advice(
            "two-way-absorption",
            f"The walls couple two room modes by {coupled:.2g} of the distance of their frequencies, and would absorb "
            f"uniform pressure with a loss factor of {lost:.2g} at the first mode, {first_hz:.4g} Hz. "
            f"Above {COUPLED:g}, two-way coupling is a rough approximation: its walls damp each room mode separately "
            "and do not damp uniform pressure. One-way coupling includes both, but not the reaction of the air",
            {"coupling": coupled, "uniform_loss_factor": lost, "allowed": COUPLED},
        ),
    )
