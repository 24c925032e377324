"""A regime: what each interface does until the next event, how fast it can be, and its flow as a power series."""

from __future__ import annotations

import numpy as np

from femstruct.impact.compiled.kernels import kernel, summing
from femstruct.impact.engine.instant_forces import CLOSED, State
from femstruct.impact.engine.records import CONSTANT, HALF_SINE, LINK, System
from femstruct.impact.exact.exact_constants import ExactRoom, ExactRule


@kernel
def settle(system: System, state: State, room: ExactRoom) -> None:
    """Springs, dashpots and constant forces of the interfaces in the present regime."""
    for a in range(len(system.interfaces)):
        law = system.interfaces[a]
        room.spring[a], room.dash[a] = 0.0, 0.0
        if state.status[a] != CLOSED:
            room.held[a] = 0.0 if law["kind"] == LINK else -law["preload"]
            continue
        room.spring[a] = law["stiffness"]
        if law["kind"] == LINK:
            room.dash[a] = law["opening"] if room.way[a] < 0 else law["closing"]
            room.held[a] = law["preload"] - law["stiffness"] * state.rest[a]
        else:
            room.dash[a] = law["closing"]
            # a preload is in balance with the indentation at rest
            room.held[a] = 0.0 if law["preload"] > 0.0 else law["stiffness"] * law["offset"]


@kernel
def fastest(system: System, room: ExactRoom) -> tuple[float, float]:
    """Bound of the rates [1/s] of a regime, the positive root of x^2 = c x + w^2; and w^2 [1/s^2].

    w^2 and c bound the stiffness and the damping over the coordinates of unit mass: the largest of the modes, and k
    row.row, c row.row of every interface that acts. In the norm max(|z|, |v| / x) the system's matrix is no larger
    than x, so that term p of its power series is below (x h)^p / p!.
    """
    stiffness, damping = system.reach[0], system.reach[1]
    for a in range(len(system.interfaces)):
        stiffness += room.spring[a] * system.mobility[a]
        damping += room.dash[a] * system.mobility[a]
    return float(0.5 * (damping + np.sqrt(damping * damping + 4.0 * stiffness))), stiffness


@kernel
def load_series(system: System, room: ExactRoom, t: float, h: float, order: int) -> None:
    """Power series of the loads over a step that no change of their formulas cuts."""
    m = len(system.interfaces)
    for i in range(len(system.loads)):
        load, out = system.loads[i], room.force[m + i]
        for k in range(order + 1):
            out[k] = 0.0
        middle = t + 0.5 * h
        if load["kind"] == CONSTANT:
            out[0] = load["value"]
        elif load["kind"] == HALF_SINE:
            if middle * load["frequency"] < 0.5:
                omega = 2.0 * np.pi * load["frequency"]
                out[0] = load["value"] * np.sin(omega * t)
                out[1] = load["value"] * np.cos(omega * t) * omega * h
                for k in range(order - 1):
                    out[k + 2] = -out[k] * (omega * h) ** 2 / ((k + 1) * (k + 2))
        else:
            first, last = load["first"], load["first"] + load["length"] - 1
            if system.table[first, 0] < middle < system.table[last, 0]:
                left, right = first, last
                while right - left > 1:
                    between = (left + right) // 2
                    if system.table[between, 0] <= middle:
                        left = between
                    else:
                        right = between
                slope = (system.table[right, 1] - system.table[left, 1]) / (
                    system.table[right, 0] - system.table[left, 0]
                )
                out[0] = system.table[left, 1] + slope * (t - system.table[left, 0])
                out[1] = slope * h


@summing
def expand(system: System, state: State, rule: ExactRule, room: ExactRoom, h: float, order: int) -> None:
    """Power series of coordinates, rows and forces over a step of length h from the state, by the equations of motion.

    With y_k = k! z_k, the derivatives, no term is divided by anything: y_(k+2) = h^2 forces_k - (omega h)^2 y_k -
    damping h y_(k+1), and forces_k from the rows' own y_k and y_(k+1).
    """
    if len(system.turn):
        _expand_oscillators(system, state, rule, room, h, order)
        return
    n, m, r = len(system.omega), len(system.interfaces), len(system.rows)
    z, place, force, rows, sway, drag = room.z, room.place, room.force, system.rows, room.q, room.v
    square = h * h
    for i in range(n):
        z[0, i], z[1, i] = state.z[i], state.v[i] * h
        sway[i], drag[i] = -system.omega[i] * system.omega[i] * square, -system.damping[i] * h
    for a in range(r):
        for k in range(2):
            total = 0.0
            for i in range(n):
                total += rows[a, i] * z[k, i]
            place[a, k] = total
    for k in range(order - 1):
        for i in range(n):
            z[k + 2, i] = sway[i] * z[k, i] + drag[i] * z[k + 1, i]
        for a in range(r):
            if a < m:
                push = square * room.spring[a] * place[a, k] + h * room.dash[a] * place[a, k + 1]
                if k == 0:
                    push += square * room.held[a]
            else:
                push = square * force[a, k] / rule.factors[k]
            push *= system.sign[a]
            if push != 0.0:
                for i in range(n):
                    z[k + 2, i] += rows[a, i] * push
        for a in range(r):
            total = 0.0
            for i in range(n):
                total += rows[a, i] * z[k + 2, i]
            place[a, k + 2] = total
    _from_derivatives(rule, room, m, 1.0 / h, order)


@summing
def _expand_oscillators(system: System, state: State, rule: ExactRule, room: ExactRoom, h: float, order: int) -> None:
    """The same of oscillators in place of coupled modes, whose forces act on z' too: z and w = v are series alike."""
    n, m, r = len(system.omega), len(system.interfaces), len(system.rows)
    z, w, place, rate, force, rows, tilts = room.z, room.w, room.place, room.rate, room.force, system.rows, system.tilts
    for i in range(n):
        z[0, i], w[0, i] = state.z[i], state.v[i]
    for k in range(order + 1):
        for a in range(r):
            here, speed = 0.0, 0.0
            for i in range(n):
                x, v = z[k, i], w[k, i]
                here += rows[a, i] * x + tilts[a, i] * v
                turning = system.omega[i] * system.omega[i] * x + system.damping[i] * v
                speed += rows[a, i] * v - tilts[a, i] * turning
            place[a, k], rate[a, k] = here, speed
            if a < m:
                force[a, k] = room.spring[a] * here + room.dash[a] * speed
                if k == 0:
                    force[a, 0] += room.held[a]
        if k == order:
            return
        part = h * rule.factors[k + 1] / rule.factors[k]
        for i in range(n):
            z[k + 1, i] = part * w[k, i]
            w[k + 1, i] = -part * (system.omega[i] * system.omega[i] * z[k, i] + system.damping[i] * w[k, i])
        for a in range(r):
            push = part * system.sign[a] * force[a, k]
            if push != 0.0:
                for i in range(n):
                    z[k + 1, i] += system.kicks[a, i] * push
                    w[k + 1, i] += system.drives[a, i] * push


@kernel
def _from_derivatives(rule: ExactRule, room: ExactRoom, m: int, pace: float, order: int) -> None:
    """Power series from the derivatives of coordinates and rows; rates and forces from them. pace : 1 / h."""
    z, place, rate, force = room.z, room.place, room.rate, room.force
    for k in range(2, order + 1):
        for i in range(z.shape[1]):
            z[k, i] *= rule.factors[k]
    for a in range(len(place)):
        for k in range(order):
            rate[a, k] = pace * place[a, k + 1] * rule.factors[k]
        rate[a, order] = 0.0
        for k in range(2, order + 1):
            place[a, k] *= rule.factors[k]
    for a in range(m):
        for k in range(order + 1):
            force[a, k] = room.spring[a] * place[a, k] + room.dash[a] * rate[a, k]
        force[a, 0] += room.held[a]


@kernel
def shorten(room: ExactRoom, order: int, part: float) -> None:
    """The series of a part of the step: the step ends there."""
    power = 1.0
    for k in range(1, order + 1):
        power *= part
        for i in range(room.z.shape[1]):
            room.z[k, i] *= power
        for i in range(room.w.shape[1]):
            room.w[k, i] *= power
        for a in range(len(room.place)):
            room.place[a, k] *= power
            room.rate[a, k] *= power
            room.force[a, k] *= power


@summing
def evaluate(room: ExactRoom, h: float, order: int, theta: float) -> None:
    """Coordinates and rates at a part of the step, into room.q and room.v."""
    z, w, q, v = room.z, room.w, room.q, room.v
    if len(w):
        for i in range(len(q)):
            q[i], v[i] = z[order, i], w[order, i]
        for k in range(order - 1, -1, -1):
            for i in range(len(q)):
                q[i] = q[i] * theta + z[k, i]
                v[i] = v[i] * theta + w[k, i]
        return
    for i in range(len(q)):
        q[i], v[i] = z[order, i], 0.0
    for k in range(order - 1, -1, -1):
        for i in range(len(q)):
            v[i] = v[i] * theta + q[i]
            q[i] = q[i] * theta + z[k, i]
    for i in range(len(v)):
        v[i] /= h
