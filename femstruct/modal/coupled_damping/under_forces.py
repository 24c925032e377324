"""As few oscillators as move what a few given forces move."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.modal.coupled_damping.oscillator_set import Oscillators
from femstruct.modal.coupled_damping.relaxing import Relaxing

DEPENDENT: Final = 1e-12  # of a unit force: what is left of one beside the others


def under_forces(found: Oscillators, forces: Floats) -> Oscillators:
    """Oscillators that move as these do under modal forces along some rows [r, K], from rest; kicks and drives of other
    forces mean nothing. The same ones where fewer would not do.

    Forty equal modes on dashpots, all overdamped, under one force: sums of sixteen exponentials.

    >>> from femstruct.modal.coupled_damping.oscillators import oscillators
    >>> whole = oscillators(np.full(40, 10.0), np.diag(np.linspace(400.0, 500.0, 40)))
    >>> few = under_forces(whole, np.ones((1, 40)))
    >>> len(whole.omega), len(few.omega) < 20
    (40, True)
    """
    creep = found.relaxing
    inputs = _spanning(forces)
    if creep is None or not len(inputs) or len(inputs) * len(creep.nodes) >= creep.number:
        return found
    first = len(found.omega) - creep.number
    half = len(creep.nodes) // 2
    one, two = creep.nodes[:half], creep.nodes[half:]  # each pair is an oscillator
    to_z, to_v = _expanded(found, inputs, creep, first)
    omega, damping = np.tile(np.sqrt(one * two), len(inputs)), np.tile(-(one + two), len(inputs))
    sets, count = found.turn[0].shape[0], first + len(omega)
    turn = np.empty((4, sets, count))
    turn[:, :, :first] = found.turn[:, :, :first]
    both = np.hstack([found.places[:, first:], found.tilts[:, first:]]) @ np.vstack([to_z, to_v])
    turn[0, :, first:], turn[1, :, first:] = both[:, : len(omega)], both[:, len(omega) :]
    turn[2, :, first:] = -turn[1, :, first:] * omega**2
    turn[3, :, first:] = turn[0, :, first:] - turn[1, :, first:] * damping
    k, own, missed = len(found.omega), found.misses, found.misses[:, None] ** 2
    squares = (missed[first:k] * to_z**2 + missed[k + first :] * to_v**2).sum(axis=0)
    new = np.sqrt(2 * len(omega) * squares)  # a square of a sum is at most as many times the sum of the squares
    return replace(
        found,
        omega=np.append(found.omega[:first], omega),
        damping=np.append(found.damping[:first], damping),
        turn=turn,
        kicks=np.vstack([found.kicks[:first], np.repeat(2.0 * inputs, half, axis=0)]),
        drives=np.vstack([found.drives[:first], np.repeat(inputs, half, axis=0) * -damping[:, None]]),
        gram=_projected(found.gram, to_z, to_v, first),
        surplus=_projected(found.surplus, to_z, to_v, first) if found.surplus.size else found.surplus,
        misses=np.concatenate([own[:first], new[: len(omega)], own[k : k + first], new[len(omega) :]]),
        relaxing=None,
    )


def _spanning(forces: Floats) -> Floats:
    """Orthonormal rows with the span of those given [n, K]."""
    if not forces.any():
        return forces[:0]
    length = np.linalg.norm(forces, axis=1)
    _, size, rows = np.linalg.svd(forces[length > 0.0] / length[length > 0.0, None], full_matrices=False)
    spanning: Floats = rows[size > DEPENDENT]
    return spanning


def _expanded(found: Oscillators, inputs: Floats, creep: Relaxing, first: int) -> tuple[Floats, Floats]:
    """z and v of the oscillators that creep in terms of those in their place, [z; v] of all inputs [n, 2 p]."""
    (slow, fast), half = creep.rates, len(creep.nodes) // 2
    one, two = creep.nodes[:half], creep.nodes[half:]
    z_of: list[tuple[Floats, Floats]] = []
    v_of: list[tuple[Floats, Floats]] = []
    for force in inputs:
        kick, drive = found.kicks[first:] @ force, found.drives[first:] @ force
        of_slow, of_fast = (drive - fast * kick) / (slow - fast), (slow * kick - drive) / (slow - fast)
        sums = [of_slow[:, None] * creep.weights[0], of_fast[:, None] * creep.weights[1]]
        for gathered, part in (
            (z_of, sums[0] + sums[1]),
            (v_of, slow[:, None] * sums[0] + fast[:, None] * sums[1]),
        ):
            early, late = part[:, :half], part[:, half:]
            gathered.append(((one * late - two * early) / (one - two), (early - late) / (one - two)))
    to_z, to_v = (np.hstack([*(a for a, _ in parts), *(b for _, b in parts)]) for parts in (z_of, v_of))
    return to_z, to_v


def _projected(form: Floats, to_z: Floats, to_v: Floats, first: int) -> Floats:
    """A form of [z, v] of all oscillators in terms of those that are left."""
    k, new = len(form) // 2, to_z.shape[1] // 2
    halves = form[:, first:k] @ to_z + form[:, k + first :] @ to_v  # [2 k, 2 new]
    corner = to_z.T @ halves[first:k] + to_v.T @ halves[k + first :]
    m = first + new
    out = np.empty((2 * m, 2 * m))
    added = np.append(np.arange(first, m), np.arange(m + first, 2 * m))
    for at, rows in ((0, slice(0, first)), (m, slice(k, k + first))):
        here = slice(at, at + first)
        out[here, :first], out[here, m : m + first] = form[rows, :first], form[rows, k : k + first]
        out[here, first:m], out[here, m + first :] = halves[rows, :new], halves[rows, new:]
        out[first:m, here], out[m + first :, here] = halves[rows, :new].T, halves[rows, new:].T
    out[np.ix_(added, added)] = corner
    return out
