"""Lines along frequency that are as dense as the resonances of a structure are sharp."""

from __future__ import annotations

from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import InputError
from femstruct.modal.basis import ModalBasis
from femstruct.modal.steady.resonances import Resonances, resonances

FINENESS: Final = 24.0
"""Lines in half the half-power bandwidth of a mode, or in the distance to it: the mean square of one oscillator under
white noise is then within 1e-3 of its closed form."""
MOST_LINES: Final = 1_000_000


def resonant_lines(
    basis: ModalBasis,
    band: tuple[float, float],
    also: tuple[float, ...] = (),
    fineness: float = FINENESS,
    more: Resonances | None = None,
) -> Floats:
    """Frequencies [nf] [Hz] that follow every resonance of a basis in a band, rising, both ends among them.

    also : further frequencies in the band, such as the points of a spectrum. fineness : of a mean square the error goes
    with one over its square. more : further resonances, as of a structure with a source on it.

    Raises InputError where that would be more than a million, as with hardly any damping.

    Notes
    -----
    At a frequency f lines are 1/24 of the least of three apart: f, and of the nearest resonance half its half-power
    bandwidth zeta f_r and the distance |f - f_r| together (the root of the sum of squares). All natural frequencies in
    the band are lines. Where damping couples modes, resonances are where the structure swings with it.

    >>> from femstruct.modal.analytic import given_modes
    >>> basis, _ = given_modes([50.0], [0.01], {"P": [1.0]})
    >>> lines = resonant_lines(basis, (10.0, 100.0))
    >>> float(lines[0]), float(lines[-1]), 50.0 in lines, int(((lines > 49.5) & (lines < 50.5)).sum())
    (10.0, 100.0, True, 43)
    """
    low, high = band
    all_of_them = resonances(basis)
    damped = all_of_them.half > 0.0
    modes, half = all_of_them.hz[damped], all_of_them.half[damped]
    if more is not None:
        modes, half = np.append(modes, more.hz), np.append(half, more.half)
    found, f = [low], low
    while f < high:
        nearest = float(np.sqrt((modes - f) ** 2 + half**2).min(initial=np.inf))
        f += min(f, nearest) / fineness
        found.append(f)
        if len(found) > MOST_LINES:
            got = f"more than {MOST_LINES:,} lines to follow its resonances from {low:g} to {high:g} Hz"
            raise InputError("vibration", got=got, expected="more damping, or a narrower band")
    inside = [*found[:-1], *modes[(modes > low) & (modes < high)].tolist(), *also]
    lines: Floats = np.unique(np.array([*(one for one in inside if low <= one < high), high]))
    return lines
