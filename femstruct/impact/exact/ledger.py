"""Energies of a step from its polynomials, and the peaks of forces and indentations."""

from __future__ import annotations

from femstruct.arrays import Floats
from femstruct.impact.compiled import kernel
from femstruct.impact.exact.roots import crossing, value_at
from femstruct.impact.exact.rule import ExactRoom, ExactRule
from femstruct.impact.forces import CLAMPED, CLOSED, State
from femstruct.impact.sampling import Record
from femstruct.impact.system import LINK, System

PROBES = 6  # places at which the largest value in a step is bracketed


@kernel
def integrate_step(system: System, state: State, h: float, order: int, part: float, damped: bool, rule: ExactRule,
                   room: ExactRoom) -> None:  # fmt: skip
    """Add what dashpots took and loads gave over a part of a step, by Gauss's rule on the squares of polynomials."""
    m, k_modes = len(system.interfaces), system.n_modes
    lost, z, v = room.lost, room.z, room.v
    for g in range(len(rule.nodes)):
        theta, weight = part * rule.nodes[g], part * h * rule.weights[g]
        for a in range(m):
            if state.status[a] == CLOSED and room.dash[a] > 0.0:
                speed = value_at(room.rate[a], 0, order, theta)
                lost[a] += weight * room.dash[a] * speed * speed
            elif state.status[a] == CLAMPED:  # the spring drives its own dashpot, without force to the outside
                depth = value_at(room.place[a], 0, order, theta) + system.interfaces[a]["offset"]
                force = system.interfaces[a]["stiffness"] * max(depth, 0.0)
                lost[a] -= weight * force * value_at(room.rate[a], 0, order, theta)
        for a in range(m, len(system.rows)):
            if room.force[a, 0] != 0.0 or room.force[a, 1] != 0.0:
                force = value_at(room.force[a], 0, order, theta)
                lost[m + 1] += weight * force * value_at(room.rate[a], 0, order, theta)
        if damped:
            for i in range(k_modes):
                v[i] = 0.0
            for k in range(order, 0, -1):
                for i in range(k_modes):
                    v[i] = v[i] * theta + k * z[k, i]
            taken = 0.0
            for i in range(k_modes):
                taken += system.damping[i] * v[i] * v[i]
            for i in range(len(system.coupling)):
                total = 0.0
                for j in range(len(system.coupling)):
                    total += system.coupling[i, j] * v[j]
                taken += v[i] * total
            lost[m] += weight * taken / (h * h)


@kernel
def peaks_of_step(system: System, state: State, t: float, h: float, order: int, part: float, room: ExactRoom,
                  record: Record) -> None:  # fmt: skip
    """Raise the largest force and indentation of each closed contact to those in a part of the step."""
    for a in range(len(system.interfaces)):
        if system.interfaces[a]["kind"] == LINK or state.status[a] != CLOSED:
            continue
        preload, offset = system.interfaces[a]["preload"], system.interfaces[a]["offset"]
        force, where = largest(room.force[a], record.peak[a, 0] - preload, order, part, room.watched)
        if where >= 0.0:
            record.peak[a, 0], record.peak[a, 1] = force + preload, t + where * h
        depth, where = largest(room.place[a], record.deepest[a] - offset, order, part, room.watched)
        if where >= 0.0:
            record.deepest[a] = depth + offset


@kernel
def travels_of_step(system: System, order: int, part: float, room: ExactRoom, record: Record) -> None:
    """Raise the largest displacement of each body, either way, to that in a part of the step."""
    path = room.boxes[0]
    for b in range(len(record.travel)):
        for side in (1.0, -1.0):
            for k in range(order + 1):
                path[k] = side * room.z[k, system.n_modes + b]
            record.travel[b] = largest(path, record.travel[b], order, part, room.watched)[0]


@kernel
def largest(c: Floats, known: float, order: int, part: float, slope: Floats) -> tuple[float, float]:
    """Largest value of a polynomial on (0, part) and where it is; -1 there when it is not above what is known.

    Bracketed, then where its slope is zero. slope [order or more] : room.
    """
    most, bend = c[0], 0.0
    for k in range(order):
        slope[k] = (k + 1) * c[k + 1]
        bend += abs(slope[k])
        most += abs(c[k + 1])
    if most <= known:
        return known, -1.0
    where, value = 0.0, c[0]
    if 2.0 * abs(slope[0]) > bend:  # rises or falls all the way
        if slope[0] > 0.0:
            where, value = part, value_at(c, 0, order, part)
    else:
        best = 0
        for p in range(1, PROBES + 1):
            here = value_at(c, 0, order, part * p / PROBES)
            if here > value:
                best, value = p, here
        where = part * best / PROBES
        low, high = part * max(best - 1, 0) / PROBES, part * min(best + 1, PROBES) / PROBES
        if value_at(slope, 0, order - 1, low) > 0.0 > value_at(slope, 0, order - 1, high):
            where = crossing(slope, 0, order - 1, low, high)
            value = value_at(c, 0, order, where)
    return (value, where) if value > known else (known, -1.0)
