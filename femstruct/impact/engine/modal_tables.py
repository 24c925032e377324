"""What a step of one length does to every mode: exact for forces that are polynomials over the step.

A step is tau 2^level long, so that each length is tabulated once. Long steps follow from short ones by doubling.
"""

from __future__ import annotations

from math import factorial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from femstruct.arrays import Floats
from femstruct.impact.compiled.byte_layout import Cube, Floats4, Floats5, Floats6
from femstruct.impact.engine.gauss_points import PLACES, POINTS, STAGES, TERMS, Rule
from femstruct.impact.engine.records import System

FORMS = (STAGES + 2) * (STAGES + 3) // 2
SLOW = 6.0  # rate times step below which a remainder bounds what interpolation misses
MODES_AT_ONCE = 4000  # room for their responses: about 5 MB


class Tables(NamedTuple):
    """What is known of steps of every length, by level.

    free [level, 2, n, q] : rows' displacements and velocities at the points from the modes' displacement, velocity;
    q = (row * POINTS + point) * 2 + (0 displacement, 1 velocity).
    forced [level, r, POINTS, 2, r, s] : from unit values of the rows' forces at the nodes.
    flow [level, 4, n] : modes over the step; push [level, 2, s, n] : by unit modal force at a node.
    loss [level, FORMS, n] : the energy a mode's dashpot takes, a quadratic form in start and nodal forces; none of
    oscillators in place of coupled modes, whose losses follow from where they are.
    stray [level, 2, n], stray_push [level, 2, s, r, r] : bounds of what interpolation at PLACES can miss of a row's
    displacement and velocity, per modal energy norm and per force derivative (the last of s: per largest force).
    """

    free: Floats4
    forced: Floats6
    flow: Cube
    push: Floats4
    loss: Cube
    stray: Cube
    stray_push: Floats5


def flows(omega: Floats, damping: Floats, t: Floats) -> Floats:
    """The 2 x 2 flows [x x0, x v0, v x0, v v0] of free oscillators over the times t: [4, n, len(t)], any damping.

    >>> flows(np.array([2.0]), np.array([0.0]), np.array([np.pi / 4])).ravel().round(12).tolist()
    [0.0, 0.5, -2.0, 0.0]
    """
    sigma, w = 0.5 * damping[:, None], omega[:, None]
    discriminant = (w - sigma) * (w + sigma)
    g = np.empty((len(omega), len(t)))
    rate = np.empty_like(g)
    kind = discriminant[:, 0]
    rings, still, creeps = kind > 0.0, kind == 0.0, kind < 0.0
    if rings.any():
        ringing, s = np.sqrt(discriminant[rings]), sigma[rings]
        decay, phase = np.exp(-s * t), ringing * t
        sine = np.sin(phase) / ringing
        g[rings], rate[rings] = decay * sine, decay * (np.cos(phase) - s * sine)
    if still.any():
        decay = np.exp(-sigma[still] * t)
        g[still], rate[still] = t * decay, decay * (1.0 - sigma[still] * t)
    if creeps.any():
        spread = np.sqrt(-discriminant[creeps])
        fast = sigma[creeps] + spread
        slow = w[creeps] * w[creeps] / fast
        rise = -np.expm1(-2.0 * spread * t) / (2.0 * spread)
        decay = np.exp(-slow * t)
        g[creeps], rate[creeps] = decay * rise, decay * (1.0 - fast * rise)
    out: Floats = np.empty((4, *g.shape))
    np.add(rate, damping[:, None] * g, out=out[0])
    out[1], out[3] = g, rate
    np.multiply(-w * w, g, out=out[2])
    return out


def tabulated(system: System, levels: int, rule: Rule) -> Tables:
    """The tables of all steps tick 2^level, level = 0 .. levels - 1."""
    n, r = len(system.omega), len(system.rows)
    forms = 0 if len(system.turn) else FORMS
    tables = Tables(
        free=np.empty((levels, 2, n, r * POINTS * 2)),
        forced=np.zeros((levels, r, POINTS, 2, r, STAGES)),
        flow=np.empty((levels, 4, n)),
        push=np.empty((levels, 2, STAGES, n)),
        loss=np.empty((levels, forms, n)),
        stray=np.empty((levels, 2, n)),
        stray_push=np.zeros((levels, 2, STAGES + 1, r, r)),
    )
    for first in range(0, n, MODES_AT_ONCE):
        _fill(system, rule, tables, slice(first, min(first + MODES_AT_ONCE, n)))
    return tables


def _fill(system: System, rule: Rule, tables: Tables, some: slice) -> None:
    """Fill in what some modes are, and add what they do to the rows."""
    omega, damping = system.omega[some], system.damping[some]
    below, lossy = _halvings_below(omega, damping, system.tick), tables.loss.shape[1] > 0
    seen = _rows_of(system, some)
    answers = _responses(seen, omega, damping)
    short = _series(omega, damping, system.tick * 0.5**below, rule, lossy)
    for level in range(-below, len(tables.flow)):
        h = system.tick * 2.0**level
        if level > -below:
            long = (omega + damping) * h > 1.0
            doubled = _doubled(omega[long], damping[long], 0.5 * h, rule, _of(short, long))
            short = _series(omega, damping, h, rule, lossy)
            for whole, part in zip(short, doubled, strict=True):
                whole[long] = part
        if level >= 0:
            _book(system, tables, level, some, short, flows(omega, damping, rule.ends * h), seen, answers)
            _stray(omega, damping, h, rule, tables, level, some, answers)


def _halvings_below(omega: Floats, damping: Floats, tick: float) -> int:
    """How often a tick is halved until the power series holds for every mode."""
    fastest = float(np.max(omega + damping, initial=0.0)) * tick
    return max(int(np.ceil(np.log2(fastest))), 0) if fastest > 0.0 else 0


class _Step(NamedTuple):
    """Of a step, by mode: responses x, v [n, POINTS, s] at the points to unit polynomials, and the loss as a form
    [n, s + 2, s + 2], [n, 0, 0] where it is not wanted."""

    x: Floats
    v: Floats
    form: Floats


def _of(step: _Step, which: NDArray[np.bool_]) -> _Step:
    return _Step(*(part[which] for part in step))


def _series(omega: Floats, damping: Floats, h: float, rule: Rule, lossy: bool) -> _Step:
    """A step of modes with (omega + damping) h <= 1, by power series; of others it says nothing."""
    fast = (omega + damping) * h > 1.0
    wh, ch = np.where(fast, 0.0, omega * h), np.where(fast, 0.0, damping * h)
    terms = np.empty((TERMS + 1, len(omega)))  # derivatives of the response to unit velocity, times h^(m - 1)
    terms[0], terms[1] = 0.0, 1.0
    for m in range(2, TERMS + 1):
        terms[m] = -ch * terms[m - 1] - wh * wh * terms[m - 2]
    moments = rule.moments.reshape(TERMS, -1)
    shape = (len(omega), POINTS, STAGES)
    x, v = (h * h * (terms[:-1].T @ moments)).reshape(shape), (h * (terms[1:].T @ moments)).reshape(shape)
    if not lossy:
        return _Step(x, v, np.empty((len(omega), 0, 0)))
    flow = flows(wh / h, ch / h, rule.nodes * h)
    rates = np.concatenate((np.moveaxis(flow[2:], 0, 2), v[:, :STAGES]), axis=2)
    weighted = rates * (ch[:, None] * rule.weights)[:, :, None]
    return _Step(x, v, np.swapaxes(weighted, 1, 2) @ rates)


def _doubled(omega: Floats, damping: Floats, h: float, rule: Rule, step: _Step) -> _Step:
    """A step of 2 h from one of h."""
    x, v, form = step
    flow = flows(omega, damping, rule.ends * h)[..., None]
    early_x, early_v = x @ rule.left, v @ rule.left
    late_x, late_v = (np.swapaxes(np.swapaxes(part, 0, 1) @ rule.shift, 0, 1) for part in (x, v))
    if form.size:
        whole = flows(omega, damping, np.array([h]))[..., 0]
        form = _doubled_form(form, whole, x[:, STAGES] @ rule.left, v[:, STAGES] @ rule.left, rule)
    x, v = flow[0] * early_x + flow[1] * early_v + late_x, flow[2] * early_x + flow[3] * early_v + late_v
    return _Step(x, v, form)


def _doubled_form(form: Floats, whole: Floats, x: Floats, v: Floats, rule: Rule) -> Floats:
    """The loss over both halves of a step, from that over one; whole [4, n] : flow over a half, x, v [n, s] : what
    forces in the first half make of a mode at its end."""
    width = STAGES + 2
    first, second = np.zeros((width, width)), np.zeros((len(form), width, width))
    first[0, 0], first[1, 1], first[2:, 2:] = 1.0, 1.0, rule.left
    second[:, 0, :2], second[:, 1, :2] = whole[:2].T, whole[2:].T
    second[:, 0, 2:], second[:, 1, 2:], second[:, 2:, 2:] = x, v, rule.right
    both: Floats = first.T @ form @ first + np.swapaxes(second, 1, 2) @ form @ second
    return both


_Answers = list[tuple[Floats | None, Floats | None]]


class _Rows(NamedTuple):
    """What rows see of some coordinates, and how their forces act on these [r, n]: displacement = rows . z + tilts . v,
    velocity = swings . z + rates . v; a force adds kicks to z' and drives to v'."""

    rows: Floats
    tilts: Floats
    swings: Floats
    rates: Floats
    kicks: Floats
    drives: Floats


def _rows_of(system: System, some: slice) -> _Rows:
    """Of some coordinates; without coupled damping a row sees a displacement and acts on a velocity."""
    rows, none = system.rows[:, some], np.zeros((0, 0))
    if not len(system.turn):
        return _Rows(rows, none, none, rows, none, rows)
    tilts = system.tilts[:, some]
    swings, rates = -tilts * system.omega[some] ** 2, rows - tilts * system.damping[some]
    return _Rows(rows, tilts, swings, rates, system.kicks[:, some], system.drives[:, some])


def _book(system: System, tables: Tables, level: int, some: slice, step: _Step, flow: Floats, seen: _Rows,
          answers: _Answers) -> None:  # fmt: skip
    """Write what is known of a step of some modes into the tables."""
    x, v, form = step
    n, r = len(x), len(system.rows)
    tables.flow[level, :, some] = flow[:, :, STAGES]
    tables.push[level, 0, :, some], tables.push[level, 1, :, some] = x[:, STAGES].T, v[:, STAGES].T
    if form.size:
        upper = np.triu_indices(STAGES + 2)
        tables.loss[level, :, some] = (form[:, upper[0], upper[1]] * np.where(upper[0] == upper[1], 1.0, 2.0)).T
    free = tables.free[level].reshape(2, len(system.omega), r, POINTS, 2)
    for start in range(2):  # from a displacement, from a velocity
        np.multiply(seen.rows.T[:, :, None], flow[start][:, None], out=free[start, some, :, :, 0])
        np.multiply(seen.rates.T[:, :, None], flow[2 + start][:, None], out=free[start, some, :, :, 1])
        if len(seen.tilts):
            free[start, some, :, :, 0] += seen.tilts.T[:, :, None] * flow[2 + start][:, None]
            free[start, some, :, :, 1] += seen.swings.T[:, :, None] * flow[start][:, None]
    for what, (by_x, by_v) in enumerate(answers):
        for weights, response in ((by_x, x), (by_v, v)):
            if weights is not None:
                sums = (weights.reshape(r * r, n) @ response.reshape(n, -1)).reshape(r, r, POINTS, STAGES)
                tables.forced[level, :, :, what] += np.moveaxis(sums * system.sign[:, None, None], 1, 2)


def _responses(seen: _Rows, omega: Floats, damping: Floats) -> _Answers:
    """What rows see of the response to each other's forces, displacement and velocity: weights [r, r, n] of x and of v,
    the displacement and velocity that a unit force gives an oscillator. A force on z' gives it v + c x and -w^2 x."""
    pairs = seen.rows[:, None] * seen.rows
    if not len(seen.tilts):
        return [(pairs, None), (None, pairs)]
    found: _Answers = []
    for at_z, at_v in ((seen.rows, seen.tilts), (seen.swings, seen.rates)):
        by_x = at_z[:, None] * (seen.drives + damping * seen.kicks) - at_v[:, None] * (omega**2 * seen.kicks)
        found.append((by_x, at_z[:, None] * seen.kicks + at_v[:, None] * seen.drives))
    return found


def _stray(omega: Floats, damping: Floats, h: float, rule: Rule, tables: Tables, level: int, some: slice,
           answers: _Answers) -> None:  # fmt: skip
    """What interpolation at the places can miss: its remainder for slow modes, its norm for fast ones."""
    lagrange, cap = rule.node_polynomial / factorial(PLACES), 1.0 + rule.lebesgue
    z = (omega + damping) * h
    slow = z < SLOW
    period = np.divide(1.0, omega, out=np.full(len(omega), np.inf), where=omega > 0.0)
    with np.errstate(over="ignore"):
        remainder = lagrange * z ** (PLACES - 1)
        tables.stray[level, 0, some] = np.minimum(remainder * h, cap * np.minimum(h, period))
        tables.stray[level, 1, some] = np.minimum(remainder * z, cap)
    r = tables.stray_push.shape[-1]
    powers = np.empty((STAGES + 1, len(z)))  # from the highest down to the first
    powers[STAGES] = np.where(slow, z, 0.0)
    for j in range(STAGES, 0, -1):
        np.multiply(powers[j], powers[STAGES], out=powers[j - 1])
    fast = ~slow
    by_x = np.column_stack([lagrange * h * h * powers[1:].T, cap * fast * np.minimum(0.5 * h * h, 2.0 * period**2)])
    by_v = np.column_stack([lagrange * h * powers[:STAGES].T, cap * fast * np.minimum(h, 2.0 * period)])
    push = tables.stray_push[level]
    for what, weights in enumerate(answers):
        for sizes, bounds in zip(weights, (by_x, by_v), strict=True):
            if sizes is not None:
                push[what] += (np.abs(sizes).reshape(r * r, len(omega)) @ bounds).T.reshape(STAGES + 1, r, r)
