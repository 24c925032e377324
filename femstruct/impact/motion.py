"""The motion of the coordinates, kept at the starts of steps: every sample follows exactly, when it is asked for.

All coordinates at all samples are a hundred megabytes that most questions do not need; the states at the starts of
steps and the forces' polynomials over them are a few, and say the same.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.impact.compiled import kernel, making
from femstruct.impact.forces import dot
from femstruct.impact.rule import LONGEST_DOUBLINGS, STAGES, Rule
from femstruct.impact.system import System
from femstruct.impact.tables import Tables, flow_of, tabulate

DISPLACEMENT, VELOCITY = 0, 1


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
    out = np.empty((last - first, motion.n_samples))
    _trace(motion, what, first, out)
    out.flags.writeable = False
    return out


def along(motion: Motion, what: int, rows: Floats) -> Floats:
    """Displacement or velocity of weighted sums of the first k coordinates, rows [p, k], at all samples [p, nt]."""
    out = np.empty((len(rows), motion.n_samples))
    _follow(motion, what, np.array(rows, dtype=np.float64), out)
    return out


@making
def inside(level: int, system: System, rule: Rule, tables: Tables, needed: Integers, free: Floats,
           forced: Floats) -> None:  # fmt: skip
    """Fill free, and forced of the step lengths that are needed. level : of a step of one sample."""
    dt = system.tick * 2.0**level
    if not tables.ready[level]:
        tabulate(level, dt, system, rule, tables)
    flow, push, out = tables.flow[level], tables.push[level], np.empty(4)
    for i in range(len(system.omega)):
        for j in range(free.shape[3]):
            flow_of(system.omega[i], system.damping[i], j * dt, out)
            free[0, 0, i, j], free[0, 1, i, j], free[1, 0, i, j], free[1, 1, i, j] = out
    for d in range(len(needed)):
        if not needed[d]:
            continue
        for i in range(len(system.omega)):
            for s in range(STAGES):
                x, v = 0.0, 0.0
                for j in range(1 << d):
                    forced[d, 0, s, i, j], forced[d, 1, s, i, j] = x, v
                    piece = rule.pieces[(1 << d) - 1 + j]
                    x, v = flow[0, i] * x + flow[1, i] * v, flow[2, i] * x + flow[3, i] * v
                    for p in range(STAGES):
                        x += push[0, p, i] * piece[p, s]
                        v += push[1, p, i] * piece[p, s]


def inner_tables(
    system: System, halvings: int, rule: Rule, tables: Tables, used: Integers, pushed: Integers
) -> tuple[Floats, Floats]:
    """free and forced of a Motion. used [l] : doublings of its long steps; pushed [l] : whether forces act on them."""
    n, longest = len(system.omega), 1 << LONGEST_DOUBLINGS
    needed = np.zeros(LONGEST_DOUBLINGS + 1, dtype=np.int64)
    needed[used[pushed > 0]] = 1
    free = np.empty((2, 2, n, longest if len(used) else 1))
    forced = np.empty((len(needed), 2, STAGES, n, longest))
    inside(halvings, system, rule, tables, needed, free, forced)
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


@kernel
def _through(motion: Motion, what: int, state: int, long: int, first: int, last: int, out: Floats) -> None:
    """Samples of the coordinates first .. last - 1 over a long step, its start first: out [coordinate - first, j]."""
    doublings = motion.doublings[state]
    count, z, v = 1 << doublings, motion.z[state], motion.v[state]
    by_z, by_v, forced = motion.free[what, 0], motion.free[what, 1], motion.forced[doublings, what]
    for i in range(first, last):
        for j in range(count):
            out[i - first, j] = by_z[i, j] * z[i] + by_v[i, j] * v[i]
    if not motion.pushed[long]:
        return
    for i in range(first, last):
        for s in range(STAGES):
            force = motion.modal[long, s, i] if i < motion.modal.shape[2] else 0.0
            for a in range(len(motion.acts)):
                force += motion.acts[a, i] * motion.forces[long, a, s]
            if force != 0.0:
                for j in range(count):
                    out[i - first, j] += forced[s, i, j] * force


@making
def _trace(motion: Motion, what: int, first: int, out: Floats) -> None:
    states, count = motion.z if what == DISPLACEMENT else motion.v, len(out)
    samples, long = np.empty((count, 1 << LONGEST_DOUBLINGS)), 0
    for s in range(len(motion.at)):
        at = motion.at[s]
        if not motion.doublings[s]:
            for i in range(count):
                out[i, at] = states[s, first + i]
            continue
        _through(motion, what, s, long, first, first + count, samples)
        for i in range(count):
            for j in range(1 << motion.doublings[s]):
                out[i, at + j] = samples[i, j]
        long += 1


@making
def _follow(motion: Motion, what: int, rows: Floats, out: Floats) -> None:
    states, n = motion.z if what == DISPLACEMENT else motion.v, rows.shape[1]
    samples, long = np.empty((n, 1 << LONGEST_DOUBLINGS)), 0
    for s in range(len(motion.at)):
        at = motion.at[s]
        if not motion.doublings[s]:
            for a in range(len(rows)):
                out[a, at] = dot(rows[a], states[s])
            continue
        count = 1 << motion.doublings[s]
        _through(motion, what, s, long, 0, n, samples)
        for a in range(len(rows)):
            sums = out[a, at : at + count]
            sums[:] = 0.0
            for i in range(n):
                weight = rows[a, i]
                if weight != 0.0:
                    for j in range(count):
                        sums[j] += weight * samples[i, j]
        long += 1
