"""The motion of the coordinates, kept at the starts of steps: every sample follows exactly, when it is asked for.

All coordinates at all samples are a hundred megabytes that most questions do not need; the states at the starts of
steps and the forces' polynomials over them are a few, and say the same.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.compiled.records import System
from femstruct.impact.propagation import LONGEST_DOUBLINGS, STAGES, Tables, flows
from femstruct.tags import stored_as

DISPLACEMENT, VELOCITY = 0, 1
SAMPLES_AT_ONCE = 1 << 14  # of every coordinate: what is in hand at once stays small
SAMPLES_OF_OSCILLATORS = 1 << 11  # the same of all oscillators together: 30 MB of 1000


@stored_as("motion of coordinates/1")
class Motion(NamedTuple):
    """States of n coordinates at the starts of steps, and what leads from them to the samples inside the steps.

    at [s] : sample at which each state is kept, from 0; doublings [s] : the step from there takes 2^d samples, and the
    next state follows it. z, v [s, n].
    acts [r, n] : rows that push; forces [l, r, STAGES] : their forces at the Gauss points of each step of more than one
    sample, in their order. pushed [l] : 1 where any of them is not zero.
    free [2, 2, n, j] : displacement, velocity after j samples from unit displacement, velocity;
    forced [d, 2, STAGES, n, j] : from unit forces at the Gauss points of a step of 2^d samples.
    n_samples : of the record.
    Of modes that damping couples all of this is told of the oscillators in their place: turn [4, K, k], their places,
    tilts, swings and rates (`femstruct.modal.coupled_damping`), makes motions of K modes of theirs; kicks [r, n] : what
    acts on z'; omega, damping [n] : of the oscillators. All empty where nothing is coupled.
    """

    at: Integers
    doublings: Integers
    z: Floats
    v: Floats
    acts: Floats
    forces: Floats
    pushed: Integers
    free: Floats
    forced: Floats
    n_samples: int
    turn: Floats
    kicks: Floats
    omega: Floats
    damping: Floats


def sampled_motion(z: Floats, v: Floats, system: System | None = None) -> Motion:
    """The motion that is known at its samples: z, v [n, nt].

    Parameters
    ----------
    system : System | None
        Where oscillators stand for coupled modes.
    """
    n, nt = z.shape
    return Motion(
        at=np.arange(nt),
        doublings=np.zeros(nt, dtype=np.int64),
        z=np.ascontiguousarray(z.T),
        v=np.ascontiguousarray(v.T),
        acts=np.zeros((0, n)),
        forces=np.zeros((0, 0, STAGES)),
        pushed=np.zeros(0, dtype=np.int64),
        free=np.zeros((2, 2, n, 1)),
        forced=np.zeros((1, 2, STAGES, n, 1)),
        n_samples=nt,
        turn=np.zeros((4, 0, 0)) if system is None or not len(system.turn) else system.turn,
        kicks=np.zeros((0, 0)),
        omega=np.zeros(0) if system is None else system.omega,
        damping=np.zeros(0) if system is None else system.damping,
    )


def uncoupled_motion(motion: Motion, which: Integers) -> Motion:
    """The motion of some coordinates that nothing couples, in the order given."""
    return motion._replace(
        z=np.ascontiguousarray(motion.z[:, which]),
        v=np.ascontiguousarray(motion.v[:, which]),
        acts=np.ascontiguousarray(motion.acts[:, which]),
        free=np.ascontiguousarray(motion.free[:, :, which]),
        forced=np.ascontiguousarray(motion.forced[:, :, :, which]),
    )


def modal_motion(motion: Motion, what: int, modes: Integers) -> Floats:
    """Displacement or velocity of some modes at all samples [len(modes), nt]."""
    if not motion.turn.size:
        return coordinates(uncoupled_motion(motion, modes), what, 0, len(modes))
    (found,) = _of_oscillators(motion, modes, (what,))
    return found


def modal_motions(motion: Motion, first: int, last: int) -> tuple[Floats, Floats]:
    """Displacement and velocity of the modes first .. last - 1 at all samples, each [last - first, nt]."""
    if not motion.turn.size:
        return coordinates(motion, DISPLACEMENT, first, last), coordinates(motion, VELOCITY, first, last)
    place, rate = _of_oscillators(motion, np.arange(first, last), (DISPLACEMENT, VELOCITY))
    return place, rate


def _of_oscillators(motion: Motion, modes: Integers, whats: tuple[int, ...]) -> list[Floats]:
    """Displacement, velocity or both of some modes, in whose place there are oscillators, [len(modes), nt] each."""
    k = motion.turn.shape[2]
    found = [np.empty((len(modes), motion.n_samples)) for _ in whats]
    for steps in _by_length(motion, SAMPLES_OF_OSCILLATORS):
        z, v = motion.z[steps.states, :k].T, motion.v[steps.states, :k].T
        places = motion.at[steps.states]
        if steps.doublings:
            z, v = _inside(motion, steps, z, v)
            places = (places[:, None] + np.arange(1 << steps.doublings)).ravel()
        for out, what in zip(found, whats, strict=True):
            at_z, at_v = motion.turn[2 * what : 2 * what + 2, modes]
            out[:, places] = at_z @ z + at_v @ v
    for out in found:
        out.flags.writeable = False
    return found


def _inside(motion: Motion, steps: _Steps, z: Floats, v: Floats) -> tuple[Floats, Floats]:
    """Displacements and rates of the oscillators at all samples of long steps of one length [k, steps * samples], from
    those at their starts [k, steps]."""
    k, count, acting = len(z), 1 << steps.doublings, motion.pushed[steps.longs] > 0
    free = motion.free[:, :, :k, None, :count]
    found = free[:, 0] * z[None, :, :, None] + free[:, 1] * v[None, :, :, None]
    if acting.any():
        forces = motion.forces[steps.longs[acting]]
        drive, kick = (np.tensordot(of[:, :k], forces, axes=(0, 1)) for of in (motion.acts, motion.kicks))
        x, y = np.moveaxis(motion.forced[steps.doublings, :, :, :k, :count], 2, 1)
        w, c = motion.omega[:k, None, None] ** 2, motion.damping[:k, None, None]
        found[0][:, acting] += drive @ x + kick @ (y + c * x)
        found[1][:, acting] += drive @ y - kick @ (w * x)
    return found[0].reshape(k, -1), found[1].reshape(k, -1)


def modal_states(motion: Motion, what: int) -> Floats:
    """Displacement or velocity of the modes at the starts of all steps [s, k]; with the bodies behind, if nothing is
    coupled."""
    if not motion.turn.size:
        return motion.z if what == DISPLACEMENT else motion.v
    at_z, at_v = motion.turn[2 * what : 2 * what + 2]
    k = motion.turn.shape[2]
    states: Floats = motion.z[:, :k] @ at_z.T + motion.v[:, :k] @ at_v.T
    return states


def coordinates(motion: Motion, what: int, first: int, last: int) -> Floats:
    """Displacement or velocity of the coordinates first .. last - 1 at all samples [last - first, nt]: modes, then
    bodies."""
    k, own = motion.turn.shape[1:]
    if first < k:
        modes = modal_motion(motion, what, np.arange(first, min(last, k)))
        return modes if last <= k else np.vstack([modes, _as_they_are(motion, what, own, own + last - k)])
    return _as_they_are(motion, what, own + first - k, own + last - k)


def _as_they_are(motion: Motion, what: int, first: int, last: int) -> Floats:
    """The same of coordinates that nothing couples."""
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
            push: Floats = np.tensordot(motion.acts[:, first:last], motion.forces[steps.longs[acting]], axes=(0, 1))
            forced = np.moveaxis(motion.forced[steps.doublings, what, :, first:last, :count], 1, 0)
            samples[:, acting] += push @ forced
        out[:, motion.at[steps.states][:, None] + np.arange(count)] = samples
    out.flags.writeable = False
    return out


def weighted_motion(motion: Motion, what: int, rows: Floats) -> Floats:
    """Displacement or velocity of weighted sums of the first coordinates, modes, then bodies, rows [p, K], at all
    samples [p, nt]."""
    if not motion.turn.size:
        return row_motion(motion, what, rows, rows[:0])
    k = motion.turn.shape[1]
    places, tilts = (rows[:, :k] @ part for part in motion.turn[:2])
    own = rows[:, k:]
    return row_motion(motion, what, np.hstack([places, own]), np.hstack([tilts, np.zeros_like(own)]))


def row_motion(motion: Motion, what: int, rows: Floats, tilts: Floats) -> Floats:
    """The same of rows over the coordinates of the motion [p, k], whose displacement is rows . z + tilts . v; without
    tilts where nothing is coupled."""
    at_z, at_v = rows, tilts
    k = rows.shape[1]
    if what == VELOCITY and motion.turn.size:
        at_z, at_v = -tilts * motion.omega[:k] ** 2, rows - tilts * motion.damping[:k]
    out = np.empty((len(rows), motion.n_samples))
    for steps in _by_length(motion):
        z, v = (steps.of(part)[:, :k] for part in (motion.z, motion.v))
        if steps.doublings == 0:
            out[:, motion.at[steps.states]] = at_z @ z.T + at_v @ v.T if motion.turn.size else rows @ (z, v)[what].T
            continue
        count = 1 << steps.doublings
        places = motion.at[steps.states][:, None] + np.arange(count)
        acting = motion.pushed[steps.longs] > 0
        forced = motion.forced[steps.doublings, :, :, :k, :count]
        for p in range(len(rows)):
            if motion.turn.size:
                by_z, by_v = (
                    at_z[p][:, None] * motion.free[0, of, :k, :count]
                    + at_v[p][:, None] * motion.free[1, of, :k, :count]
                    for of in (0, 1)
                )
                samples = z @ by_z + v @ by_v
            else:
                by_z, by_v = motion.free[what, :, :k, :count]
                samples = (z * rows[p]) @ by_z + (v * rows[p]) @ by_v
            if acting.any():
                if motion.turn.size:
                    by_force = _by_force(motion, at_z[p], at_v[p], forced)
                else:
                    by_force = motion.acts[:, :k] @ (rows[p][:, None] * forced[what])
                forces = np.swapaxes(motion.forces[steps.longs[acting]], 1, 2).reshape(int(acting.sum()), -1)
                samples[acting] += forces @ by_force.reshape(-1, count)
            out[p, places] = samples
    return out


def _by_force(motion: Motion, at_z: Floats, at_v: Floats, forced: Floats) -> Floats:
    """What unit forces of the rows at the nodes give a weighted sum of states of oscillators [STAGES, r, j]."""
    k = len(at_z)
    x, v = forced
    w, c = motion.omega[:k, None] ** 2, motion.damping[:k, None]
    driven: Floats = motion.acts[:, :k] @ (at_z[:, None] * x + at_v[:, None] * v)
    kicked: Floats = motion.kicks[:, :k] @ (at_z[:, None] * (v + c * x) - at_v[:, None] * (w * x))
    return driven + kicked


class _Steps(NamedTuple):
    """Steps of one length: which states they start from, and their numbers among the long steps (none for those of
    less than two samples)."""

    doublings: int
    states: Integers
    longs: Integers

    def of(self, values: Floats) -> Floats:
        """Rows of values of all states; of one state after the other without a copy."""
        first, last = int(self.states[0]), int(self.states[-1]) + 1
        return values[first:last] if last - first == len(self.states) else values[self.states]


def _by_length(motion: Motion, at_once: int = SAMPLES_AT_ONCE) -> list[_Steps]:
    """The steps by length, a bounded number of samples in each part."""
    number = np.cumsum(motion.doublings > 0) - 1
    found = []
    for doublings in np.unique(motion.doublings):
        states = np.flatnonzero(motion.doublings == doublings)
        part = max(at_once >> int(doublings), 1)
        for first in range(0, len(states), part):
            some = states[first : first + part]
            found.append(_Steps(int(doublings), some, number[some]))
    return found


def inner_tables(
    system: System, halvings: int, tables: Tables, used: Integers, pushed: Integers
) -> tuple[Floats, Floats]:
    """free and forced of a Motion.

    Parameters
    ----------
    used : Integers [l]
        Doublings of its long steps.
    pushed : Integers [l]
        Whether forces act on them.
    """
    n, longest = len(system.omega), 1 << int(used.max(initial=0))
    dt = system.tick * 2.0**halvings
    times = np.array([dt * j for j in range(longest)])
    free = flows(system.omega, system.damping, times).reshape(2, 2, n, -1)
    forced = np.zeros((LONGEST_DOUBLINGS + 1, 2, STAGES, n, longest))
    flow, push = tables.flow[halvings], tables.push[halvings]
    for d in np.unique(used[pushed > 0]):
        x = np.zeros((STAGES, n))
        v = np.zeros((STAGES, n))
        for j in range(1 << d):
            forced[d, 0, :, :, j], forced[d, 1, :, :, j] = x, v
            piece = tables.rule.pieces[(1 << d) - 1 + j].T
            x, v = flow[0] * x + flow[1] * v + piece @ push[0], flow[2] * x + flow[3] * v + piece @ push[1]
    return free, forced


def state_at(motion: Motion, what: int, sample: int) -> Floats:
    """Displacement or velocity of all n coordinates at one sample [n]; those of oscillators are their z and v."""
    s = int(np.searchsorted(motion.at, sample, side="right")) - 1
    doublings, inside = int(motion.doublings[s]), sample - int(motion.at[s])
    if not inside:
        start: Floats = (motion.z if what == DISPLACEMENT else motion.v)[s].copy()
        return start
    by_z, by_v = motion.free[what, 0, :, inside], motion.free[what, 1, :, inside]
    out: Floats = by_z * motion.z[s] + by_v * motion.v[s]
    long = int(np.count_nonzero(motion.doublings[:s]))
    if motion.pushed[long]:
        x, v = motion.forced[doublings, :, :, :, inside]
        out += ((x, v)[what] * (motion.forces[long].T @ motion.acts)).sum(axis=0)
        if motion.turn.size:
            other = v + motion.damping * x if what == DISPLACEMENT else -(motion.omega**2) * x
            out += (other * (motion.forces[long].T @ motion.kicks)).sum(axis=0)
    return out


def modes_of(motion: Motion, z: Floats, v: Floats) -> tuple[Floats, Floats]:
    """Displacements and velocities of the modes [K, ...] from the first coordinates and their rates [k, ...], of modes
    or of the oscillators in their place."""
    if not motion.turn.size:
        return z, v
    places, tilts, swings, rates = motion.turn
    return places @ z + tilts @ v, swings @ z + rates @ v
