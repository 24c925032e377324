"""What a step of one length does to every mode: exact for forces that are polynomials over the step.

A step is tau 2^level long, so that each length is tabulated once. Long steps follow from short ones by doubling.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.impact.compiled import kernel, making
from femstruct.impact.rule import PLACES, POINTS, STAGES, TERMS, Rule
from femstruct.impact.system import System

FORMS = (STAGES + 2) * (STAGES + 3) // 2


class Tables(NamedTuple):
    """Filled level by level as steps of a length are first taken (ready).

    free [level, 2, n, q] : rows' displacements and velocities at the points from the modes' displacement, velocity;
    q = (row * POINTS + point) * 2 + (0 displacement, 1 velocity).
    forced [level, r, POINTS, 2, r, s] : from unit values of the rows' forces at the nodes.
    flow [level, 4, n] : modes over the step; push [level, 2, s, n] : by unit modal force at a node.
    loss [level, FORMS, n] : the energy a mode's dashpot takes, a quadratic form in start and nodal forces.
    stray [level, 2, n], stray_push [level, 2, s, r, r] : bounds of what interpolation at PLACES can miss of a row's
    displacement and velocity, per modal energy norm and per force derivative (the last of s: per largest force).
    mode_free [level, POINTS, 2, n], mode_forced [level, POINTS, s, n] : velocities of the modes at the points, and
    mode_place : their displacements by force; for coupled damping only.
    """

    ready: Integers
    free: Floats
    forced: Floats
    flow: Floats
    push: Floats
    loss: Floats
    stray: Floats
    stray_push: Floats
    mode_free: Floats
    mode_forced: Floats
    mode_place: Floats


def empty_tables(system: System, levels: int) -> Tables:
    """Room for the tables of all levels; memory is touched only where a level is used."""
    n, r = len(system.omega), len(system.rows)
    coupled = levels if system.coupling.size else 0
    return Tables(
        ready=np.zeros(levels, dtype=np.int64),
        free=np.empty((levels, 2, n, r * POINTS * 2)),
        forced=np.empty((levels, r, POINTS, 2, r, STAGES)),
        flow=np.empty((levels, 4, n)),
        push=np.empty((levels, 2, STAGES, n)),
        loss=np.empty((levels, FORMS, n)),
        stray=np.empty((levels, 2, n)),
        stray_push=np.empty((levels, 2, STAGES + 1, r, r)),
        mode_free=np.empty((coupled, POINTS, 2, n)),
        mode_forced=np.empty((coupled, POINTS, STAGES, n)),
        mode_place=np.empty((coupled, POINTS, STAGES, n)),
    )


@kernel
def oscillator(omega: float, damping: float, t: float) -> tuple[float, float]:
    """Displacement and velocity at t of an oscillator of unit mass started with unit velocity, any damping."""
    sigma = 0.5 * damping
    discriminant = (omega - sigma) * (omega + sigma)
    if discriminant > 0.0:
        ringing = np.sqrt(discriminant)
        decay, phase = np.exp(-sigma * t), ringing * t
        sine = np.sin(phase) / ringing
        return decay * sine, decay * (np.cos(phase) - sigma * sine)
    if discriminant == 0.0:
        decay = np.exp(-sigma * t)
        return t * decay, decay * (1.0 - sigma * t)
    spread = np.sqrt(-discriminant)
    fast = sigma + spread
    slow = omega * omega / fast
    rise = -np.expm1(-2.0 * spread * t) / (2.0 * spread)
    decay = np.exp(-slow * t)
    return decay * rise, decay * (1.0 - fast * rise)


@kernel
def flow_of(omega: float, damping: float, t: float, out: Floats) -> None:
    """The 2 x 2 flow of a free oscillator over t: [x x0, x v0, v x0, v v0]."""
    g, rate = oscillator(omega, damping, t)
    out[0], out[1], out[2], out[3] = rate + damping * g, g, -omega * omega * g, rate


@kernel
def _respond(omega: float, damping: float, h: float, rule: Rule, x: Floats, v: Floats) -> None:
    """Responses x, v [POINTS, s] at the points of a short step to unit polynomials, by power series."""
    x[:], v[:] = 0.0, 0.0
    before, now, power = 0.0, 1.0, h  # derivatives m and m + 1 of the unit-velocity response
    for m in range(TERMS):
        for p in range(POINTS):
            for j in range(STAGES):
                x[p, j] += before * power * rule.moments[m, p, j]
                v[p, j] += now * power * rule.moments[m, p, j]
        before, now = now, -damping * now - omega * omega * before
        power *= h
        if (abs(before) + abs(now)) * power <= 1e-19 * h and m > 1:
            break


@making
def _double(omega: float, damping: float, h: float, rule: Rule, x: Floats, v: Floats, form: Floats) -> None:
    """Turn the responses and the loss form of a step h into those of 2 h."""
    width = STAGES + 2
    flow = np.empty(4)
    flow_of(omega, damping, h, flow)
    first, second = np.zeros((width, width)), np.zeros((width, width))
    first[0, 0], first[1, 1] = 1.0, 1.0
    first[2:, 2:] = rule.left
    second[2:, 2:] = rule.right
    second[0, 0], second[0, 1], second[1, 0], second[1, 1] = flow
    for j in range(STAGES):
        for i in range(STAGES):
            second[0, 2 + j] += x[STAGES, i] * rule.left[i, j]
            second[1, 2 + j] += v[STAGES, i] * rule.left[i, j]
    form[:] = _congruent(first, form) + _congruent(second, form)
    for p in range(POINTS):
        flow_of(omega, damping, rule.ends[p] * h, flow)
        old_x, old_v = x[p].copy(), v[p].copy()
        for j in range(STAGES):
            xl, vl, xr, vr = 0.0, 0.0, 0.0, 0.0
            for i in range(STAGES):
                xl += old_x[i] * rule.left[i, j]
                vl += old_v[i] * rule.left[i, j]
                xr += old_x[i] * rule.shift[p, i, j]
                vr += old_v[i] * rule.shift[p, i, j]
            x[p, j] = flow[0] * xl + flow[1] * vl + xr
            v[p, j] = flow[2] * xl + flow[3] * vl + vr


@making
def _congruent(left: Floats, form: Floats) -> Floats:
    """left^T form left, written out: the matrices are too small for a library call."""
    width = len(form)
    half, out = np.zeros((width, width)), np.zeros((width, width))
    for i in range(width):
        for m in range(width):
            if form[i, m] != 0.0:
                for j in range(width):
                    half[i, j] += form[i, m] * left[m, j]
    for m in range(width):
        for i in range(width):
            if left[m, i] != 0.0:
                for j in range(width):
                    out[i, j] += left[m, i] * half[m, j]
    return out


@making
def tabulate(level: int, h: float, system: System, rule: Rule, tables: Tables) -> None:
    """Fill the tables of steps of length h [s]."""
    n, r = len(system.omega), len(system.rows)
    width = STAGES + 2
    x, v, form = np.empty((POINTS, STAGES)), np.empty((POINTS, STAGES)), np.empty((width, width))
    rates, flows = np.empty((POINTS, width)), np.empty((POINTS, 4))
    forced, stray_push = tables.forced[level], tables.stray_push[level]
    forced[:], stray_push[:] = 0.0, 0.0
    factorial = 1.0
    for i in range(2, PLACES + 1):
        factorial *= i
    lagrange, cap = rule.node_polynomial / factorial, 1.0 + rule.lebesgue
    for i in range(n):
        omega, damping = system.omega[i], system.damping[i]
        halvings, short = 0, h
        while (omega + damping) * short > 1.0:
            short *= 0.5
            halvings += 1
        _respond(omega, damping, short, rule, x, v)
        form[:] = 0.0
        if damping > 0.0:
            for p in range(STAGES):
                flow_of(omega, damping, rule.ends[p] * short, flows[p])
                rates[p, 0], rates[p, 1] = flows[p, 2], flows[p, 3]
                rates[p, 2:] = v[p]
                for a in range(width):
                    for b in range(width):
                        form[a, b] += damping * short * rule.weights[p] * rates[p, a] * rates[p, b]
        for _ in range(halvings):
            _double(omega, damping, short, rule, x, v, form)
            short *= 2.0
        for p in range(POINTS):
            flow_of(omega, damping, rule.ends[p] * h, flows[p])
        tables.flow[level, :, i] = flows[STAGES]
        tables.push[level, 0, :, i] = x[STAGES]
        tables.push[level, 1, :, i] = v[STAGES]
        q = 0
        for a in range(width):
            for b in range(a, width):
                tables.loss[level, q, i] = form[a, b] * (1.0 if a == b else 2.0)
                q += 1
        if len(tables.mode_free):
            for p in range(POINTS):
                tables.mode_free[level, p, 0, i], tables.mode_free[level, p, 1, i] = flows[p, 2], flows[p, 3]
                tables.mode_forced[level, p, :, i], tables.mode_place[level, p, :, i] = v[p], x[p]
        # what interpolation at the places can miss: its remainder for slow modes, its norm for fast ones
        z = (omega + damping) * h
        reach = min(h, 1.0 / omega) if omega > 0.0 else h
        remainder = lagrange * z ** (PLACES - 1)
        tables.stray[level, 0, i] = min(remainder * h, cap * reach)
        tables.stray[level, 1, i] = min(remainder * z, cap)
        slow = z < 6.0
        sway = min(0.5 * h * h, 2.0 / (omega * omega)) if omega > 0.0 else 0.5 * h * h
        for a in range(r):
            row = system.rows[a, i]
            if row != 0.0:
                for p in range(POINTS):
                    q = (a * POINTS + p) * 2
                    tables.free[level, 0, i, q], tables.free[level, 1, i, q] = row * flows[p, 0], row * flows[p, 1]
                    tables.free[level, 0, i, q + 1], tables.free[level, 1, i, q + 1] = (
                        row * flows[p, 2],
                        row * flows[p, 3],
                    )
                for b in range(r):
                    pair = row * system.rows[b, i]
                    if pair != 0.0:
                        for p in range(POINTS):
                            for j in range(STAGES):
                                forced[a, p, 0, b, j] += pair * system.sign[b] * x[p, j]
                                forced[a, p, 1, b, j] += pair * system.sign[b] * v[p, j]
                        size = abs(pair)
                        if slow:
                            for j in range(STAGES):
                                stray_push[0, j, a, b] += size * lagrange * h * h * z ** (STAGES - j)
                                stray_push[1, j, a, b] += size * lagrange * h * z ** (STAGES - j + 1)
                        else:
                            stray_push[0, STAGES, a, b] += size * cap * sway
                            stray_push[1, STAGES, a, b] += size * cap * min(h, 2.0 / omega if omega > 0.0 else h)
            else:
                for p in range(POINTS):
                    q = (a * POINTS + p) * 2
                    tables.free[level, :, i, q] = 0.0
                    tables.free[level, :, i, q + 1] = 0.0
    tables.ready[level] = 1
