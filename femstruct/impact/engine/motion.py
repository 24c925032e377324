"""The motion of the coordinates, kept at the starts of steps: every sample follows exactly, when it is asked for.

All coordinates at all samples are a hundred megabytes that most questions do not need; the states at the starts of
steps and the forces' polynomials over them are a few, and say the same.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.impact.engine.gauss_points import LONGEST_DOUBLINGS, STAGES, Rule
from femstruct.impact.engine.modal_tables import Tables, flows
from femstruct.impact.engine.records import System

DISPLACEMENT, VELOCITY = 0, 1
SAMPLES_AT_ONCE = 1 << 14  # of every coordinate: what is in hand at once stays small


class Motion(NamedTuple):
    """States of n coordinates at the starts of steps, and what leads from them to the samples inside the steps.

    at [s] : sample at which each state is kept, from 0; doublings [s] : the step from there takes 2^d samples, and the
    next state follows it. z, v [s, n].
    acts [r, n] : rows that push; forces [l, r, STAGES] : their forces at the Gauss points of each step of more than one
    sample, in their order; modal [l, STAGES, k] : those of coupled damping, [0, STAGES, 0] without.
    pushed [l] : 1 where any of them is not zero.
    free [2, 2, n, j] : displacement, velocity after j samples from unit displacement, velocity;
    forced [d, 2, STAGES, n, j] : from unit forces at the Gauss points of a step of 2^d samples.
    n_samples : of the record.
    """

    at: Integers
    doublings: Integers
    z: Floats
    v: Floats
    acts: Floats
    forces: Floats
    modal: Floats
    pushed: Integers
    free: Floats
    forced: Floats
    n_samples: int


def sampled_motion(z: Floats, v: Floats) -> Motion:
    """The motion that is known at its samples: z, v [n, nt]."""
    n, nt = z.shape
    return Motion(
        at=np.arange(nt),
        doublings=np.zeros(nt, dtype=np.int64),
        z=np.ascontiguousarray(z.T),
        v=np.ascontiguousarray(v.T),
        acts=np.zeros((0, n)),
        forces=np.zeros((0, 0, STAGES)),
        modal=np.zeros((0, STAGES, 0)),
        pushed=np.zeros(0, dtype=np.int64),
        free=np.zeros((2, 2, n, 1)),
        forced=np.zeros((1, 2, STAGES, n, 1)),
        n_samples=nt,
    )


def only(motion: Motion, which: Integers) -> Motion:
    """The motion of some coordinates, in the order given; with coupled damping, modes before bodies."""
    modal = which[which < motion.modal.shape[2]]
    return motion._replace(
        z=np.ascontiguousarray(motion.z[:, which]),
        v=np.ascontiguousarray(motion.v[:, which]),
        acts=np.ascontiguousarray(motion.acts[:, which]),
        modal=np.ascontiguousarray(motion.modal[:, :, modal]),
        free=np.ascontiguousarray(motion.free[:, :, which]),
        forced=np.ascontiguousarray(motion.forced[:, :, :, which]),
    )


def coordinates(motion: Motion, what: int, first: int, last: int) -> Floats:
    """Displacement or velocity of the coordinates first .. last - 1 at all samples [last - first, nt]."""
    states = (motion.z if what == DISPLACEMENT else motion.v)[:, first:last]
    out = np.empty((last - first, motion.n_samples))
    for steps in _by_length(motion):
        if steps.doublings == 0:
            out[:, motion.at[steps.states]] = states[steps.states].T
            continue
        count = 1 << steps.doublings
        by_z, by_v = motion.free[what, :, first:last, :count]
        samples = by_z[:, None] * motion.z[steps.states, first:last].T[:, :, None]
        samples += by_v[:, None] * motion.v[steps.states, first:last].T[:, :, None]
        acting = motion.pushed[steps.longs] > 0
        if acting.any():
            push = _modal_forces(motion, steps.longs[acting], first, last)
            forced = np.moveaxis(motion.forced[steps.doublings, what, :, first:last, :count], 1, 0)
            samples[:, acting] += push @ forced
        out[:, motion.at[steps.states][:, None] + np.arange(count)] = samples
    out.flags.writeable = False
    return out


def along(motion: Motion, what: int, rows: Floats) -> Floats:
    """Displacement or velocity of weighted sums of the first k coordinates, rows [p, k], at all samples [p, nt]."""
    k = rows.shape[1]
    states = (motion.z if what == DISPLACEMENT else motion.v)[:, :k]
    out = np.empty((len(rows), motion.n_samples))
    for steps in _by_length(motion):
        if steps.doublings == 0:
            out[:, motion.at[steps.states]] = rows @ states[steps.states].T
            continue
        count = 1 << steps.doublings
        by_z, by_v = motion.free[what, :, :k, :count]
        places = motion.at[steps.states][:, None] + np.arange(count)
        acting = motion.pushed[steps.longs] > 0
        forced = motion.forced[steps.doublings, what, :, :k, :count] if acting.any() else None
        for p, row in enumerate(rows):
            samples = (motion.z[steps.states, :k] * row) @ by_z + (motion.v[steps.states, :k] * row) @ by_v
            if forced is not None:
                samples[acting] += _pushed_along(motion, steps.longs[acting], row, forced)
            out[p, places] = samples
    return out


class _Steps(NamedTuple):
    """Steps of one length: which states they start from, and their numbers among the long steps (none for those of
    less than two samples)."""

    doublings: int
    states: Integers
    longs: Integers


def _by_length(motion: Motion) -> list[_Steps]:
    """The steps by length, a bounded number of samples in each part."""
    number = np.cumsum(motion.doublings > 0) - 1
    found = []
    for doublings in np.unique(motion.doublings):
        states = np.flatnonzero(motion.doublings == doublings)
        part = max(SAMPLES_AT_ONCE >> int(doublings), 1)
        for first in range(0, len(states), part):
            some = states[first : first + part]
            found.append(_Steps(int(doublings), some, number[some]))
    return found


def _modal_forces(motion: Motion, longs: Integers, first: int, last: int) -> Floats:
    """Forces on the coordinates first .. last - 1 at the nodes of long steps [last - first, steps, STAGES]."""
    forces: Floats = np.tensordot(motion.acts[:, first:last], motion.forces[longs], axes=(0, 1))
    coupled = motion.modal.shape[2]
    if first < coupled:
        own = motion.modal[longs, :, first : min(last, coupled)]
        forces[: own.shape[2]] += np.moveaxis(own, 2, 0)
    return forces


def _pushed_along(motion: Motion, longs: Integers, row: Floats, forced: Floats) -> Floats:
    """What the forces over long steps add to a weighted sum of coordinates [steps, j]."""
    k, count = len(row), forced.shape[2]
    weighted = row[:, None] * forced
    by_force = motion.acts[:, :k] @ weighted  # [STAGES, r, j]
    forces = np.swapaxes(motion.forces[longs], 1, 2).reshape(len(longs), -1)
    out: Floats = forces @ by_force.reshape(-1, count)
    coupled = min(motion.modal.shape[2], k)
    if coupled:
        own = motion.modal[longs, :, :coupled].reshape(len(longs), -1)
        out += own @ weighted[:, :coupled].reshape(-1, count)
    return out


def inner_tables(
    system: System, halvings: int, rule: Rule, tables: Tables, used: Integers, pushed: Integers
) -> tuple[Floats, Floats]:
    """free and forced of a Motion. used [l] : doublings of its long steps; pushed [l] : whether forces act on them."""
    n, longest = len(system.omega), 1 << LONGEST_DOUBLINGS
    dt = system.tick * 2.0**halvings
    times = np.array([dt * j for j in range(longest if len(used) else 1)])
    free = flows(system.omega, system.damping, times).reshape(2, 2, n, -1)
    forced = np.zeros((LONGEST_DOUBLINGS + 1, 2, STAGES, n, longest if len(used) else 1))
    flow, push = tables.flow[halvings], tables.push[halvings]
    for d in np.unique(used[pushed > 0]):
        x = np.zeros((STAGES, n))
        v = np.zeros((STAGES, n))
        for j in range(1 << d):
            forced[d, 0, :, :, j], forced[d, 1, :, :, j] = x, v
            piece = rule.pieces[(1 << d) - 1 + j].T
            x, v = flow[0] * x + flow[1] * v + piece @ push[0], flow[2] * x + flow[3] * v + piece @ push[1]
    return free, forced


def state_at(motion: Motion, what: int, sample: int) -> Floats:
    """Displacement or velocity of all n coordinates at one sample [n]."""
    s = int(np.searchsorted(motion.at, sample, side="right")) - 1
    doublings, inside = int(motion.doublings[s]), sample - int(motion.at[s])
    if not inside:
        start: Floats = (motion.z if what == DISPLACEMENT else motion.v)[s].copy()
        return start
    by_z, by_v = motion.free[what, 0, :, inside], motion.free[what, 1, :, inside]
    out: Floats = by_z * motion.z[s] + by_v * motion.v[s]
    long = int(np.count_nonzero(motion.doublings[:s]))
    if motion.pushed[long]:
        forces = motion.forces[long].T @ motion.acts
        forces[:, : motion.modal.shape[2]] += motion.modal[long]
        out += (motion.forced[doublings, what, :, :, inside] * forces).sum(axis=0)
    return out
