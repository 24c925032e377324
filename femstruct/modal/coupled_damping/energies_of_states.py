"""Energies of modes that damping couples, of many states at once, from where their oscillators are."""

from __future__ import annotations

from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.modal.coupled_damping.oscillator_set import Oscillators

AT_ONCE: Final = 32  # states, one after the other: those that have about as many oscillators in motion
SEEN: Final = 1e-15  # of the root of an energy: an oscillator that has less of it is lost in rounding
ALIKE: Final = 1e4  # times an energy: where oscillators have more, against each other, it is summed by its roots


def energies_of_states(found: Oscillators, z: Floats, v: Floats, scale: float) -> tuple[Floats, Floats]:
    """Energy of states z, v [s, k] of oscillators, and by how much more than that free motion would lose, or would at
    most [s] [J].

    scale : an energy that none of the states exceeds by far; what is lost in its rounding is left out [J].

    Notes
    -----
    Oscillators are in the order of how long they ring: some time after a blow the first few have all of the energy.
    A form of the state loses what large motions against each other cancel, as of oscillators of almost one shape:
    there the energy is the sum of its squares.

    >>> from femstruct.modal.coupled_damping.oscillators import oscillators
    >>> found = oscillators(np.array([10.0, 20.0]), np.array([[60.0, 30.0], [30.0, 60.0]]))
    >>> z, v = found.kicks @ [[0.6], [0.8]], found.drives @ [[0.6], [0.8]]
    >>> held, surplus = energies_of_states(found, z.T, v.T, 0.5)
    >>> round(float(held[0]), 12), bool(abs(surplus[0]) < 1e-12)
    (0.5, True)
    """
    k, size = z.shape[1], np.sqrt(np.diag(found.gram))
    held, surplus, doubtful = np.zeros(len(z)), np.zeros(len(z)), np.zeros(len(z), dtype=bool)
    for first in range(0, len(z), AT_ONCE):
        some = slice(first, first + AT_ONCE)
        parts = size[:k] * np.abs(z[some]).max(axis=0) + size[k:] * np.abs(v[some]).max(axis=0)
        ring = parts[: found.ringing]
        left = np.cumsum(ring[::-1])[::-1]  # what an oscillator that rings and those behind it have at most
        m = int((left > SEEN * np.sqrt(2.0 * scale)).sum())
        moving = [slice(at, at + size) for at, size in ((0, m), (found.ringing, k - found.ringing)) if size]
        moving = [slice(one.start + at, one.stop + at) for at in (0, k) for one in moving]
        states = np.hstack([z[some], v[some]])
        held[some] = _half(found.gram, states, moving)
        if found.surplus.size:
            surplus[some] = _half(found.surplus, states, moving)
        else:
            surplus[some] = 0.5 * (states**2 @ found.misses**2)
        doubtful[some] = parts.sum() ** 2 > ALIKE * scale
    if doubtful.any():
        x, y = z[doubtful].T, v[doubtful].T
        stored = (found.modes[:, None] * (found.places @ x + found.tilts @ y)) ** 2
        held[doubtful] = 0.5 * (stored + (found.swings @ x + found.rates @ y) ** 2).sum(axis=0)
    return held, surplus


def _half(form: Floats, states: Floats, moving: list[slice]) -> Floats:
    """y . form y / 2 of states y [s, 2 k], of which only these parts move; form [2 k, 2 k], symmetric."""
    total = np.zeros(len(states))
    for number, one in enumerate(moving):
        pushed = states[:, one] @ form[one, one]
        for other in moving[number + 1 :]:
            pushed += 2.0 * (states[:, other] @ form[other, one])
        total += (states[:, one] * pushed).sum(axis=1)
    return 0.5 * total
