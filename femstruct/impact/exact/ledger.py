"""Energies of a step from its polynomials, and the peaks of forces and indentations."""

from __future__ import annotations

from femstruct.arrays import Floats
from femstruct.impact.compiled.kernels import kernel
from femstruct.impact.engine.energy import GIVEN, MODES, WORK
from femstruct.impact.engine.instant_forces import CLAMPED, CLOSED, State
from femstruct.impact.engine.records import LINK, System
from femstruct.impact.engine.sampling import Record
from femstruct.impact.exact.exact_constants import GAUSS, PROBES, ExactRoom, ExactRule
from femstruct.impact.exact.roots import crossing, magnitude, value_and_slope, value_of


@kernel
def integrate_step(system: System, state: State, h: float, order: int, damped: bool, rule: ExactRule,
                   room: ExactRoom) -> None:  # fmt: skip
    """Add what dashpots took and loads gave over a step, by Gauss's rule on the squares of polynomials."""
    m, k_modes = len(system.interfaces), system.n_modes
    lost, z, v = room.lost, room.z, room.v
    for a in range(m):
        law = system.interfaces[a]
        if state.status[a] == CLOSED and room.dash[a] > 0.0:
            for g in range(GAUSS):
                speed = value_of(room.rate[a], order, rule.at_nodes[g])
                lost[a] += h * rule.weights[g] * room.dash[a] * speed * speed
        elif state.status[a] == CLAMPED:  # the spring drives its own dashpot, without force to the outside
            for g in range(GAUSS):
                depth = value_of(room.place[a], order, rule.at_nodes[g]) + law["offset"]
                speed = value_of(room.rate[a], order, rule.at_nodes[g])
                lost[a] -= h * rule.weights[g] * law["stiffness"] * max(depth, 0.0) * speed
    for a in range(m, len(system.rows)):
        if room.force[a, 0] != 0.0 or room.force[a, 1] != 0.0:
            for g in range(GAUSS):
                force = value_of(room.force[a], order, rule.at_nodes[g])
                lost[m + WORK] += h * rule.weights[g] * force * value_of(room.rate[a], order, rule.at_nodes[g])
    if len(system.turn):
        _give(system, h, order, rule, room)
        return
    if not damped:
        return
    for g in range(GAUSS):
        for i in range(k_modes):
            v[i] = 0.0
        for k in range(order, 0, -1):
            for i in range(k_modes):
                v[i] = v[i] * rule.nodes[g] + k * z[k, i]
        taken = 0.0
        for i in range(k_modes):
            taken += system.damping[i] * v[i] * v[i]
        lost[m + MODES] += rule.weights[g] * taken / h


@kernel
def _give(system: System, h: float, order: int, rule: ExactRule, room: ExactRoom) -> None:
    """Add the work of all rows on coupled modes: their forces times their velocities, less those of the bodies."""
    m, k_modes, n = len(system.interfaces), system.n_modes, len(system.omega)
    for g in range(GAUSS):
        power = 0.0
        for a in range(len(system.rows)):
            force = system.sign[a] * value_of(room.force[a], order, rule.at_nodes[g])
            if force != 0.0:
                power += force * value_of(room.rate[a], order, rule.at_nodes[g])
                for i in range(k_modes, n):
                    if system.rows[a, i] != 0.0:
                        speed = 0.0
                        for k in range(order, -1, -1):
                            speed = speed * rule.nodes[g] + room.w[k, i]
                        power -= force * system.rows[a, i] * speed
        room.lost[m + GIVEN] += h * rule.weights[g] * power


@kernel
def peaks_of_step(system: System, state: State, t: float, h: float, order: int, rule: ExactRule, room: ExactRoom,
                  record: Record) -> None:  # fmt: skip
    """Raise the largest force and indentation of each closed contact to those in the step."""
    for a in range(len(system.interfaces)):
        if system.interfaces[a]["kind"] == LINK or state.status[a] != CLOSED:
            continue
        preload, offset = system.interfaces[a]["preload"], system.interfaces[a]["offset"]
        depth, where = largest(room.place[a], record.deepest[a] - offset, order, rule, room.watched)
        if where >= 0.0:
            record.deepest[a] = depth + offset
        if room.dash[a] > 0.0:
            force, where = largest(room.force[a], record.peak[a, 0] - preload, order, rule, room.watched)
        else:  # the spring's force is largest where it is deepest
            force = room.spring[a] * depth + room.held[a]
        if where >= 0.0:
            record.peak[a, 0], record.peak[a, 1] = force + preload, t + where * h


@kernel
def travels_of_step(system: System, order: int, rule: ExactRule, room: ExactRoom, record: Record) -> None:
    """Raise the largest displacement of each body, either way, to that in the step."""
    path = room.boxes[0]
    for b in range(len(record.travel)):
        for k in range(order + 1):
            path[k] = room.z[k, system.n_modes + b]
        for _ in range(2):
            record.travel[b] = largest(path, record.travel[b], order, rule, room.watched)[0]
            for k in range(order + 1):
                path[k] = -path[k]


@kernel
def largest(c: Floats, known: float, order: int, rule: ExactRule, slope: Floats) -> tuple[float, float]:
    """Largest value of a polynomial on (0, 1) and where it is; -1 there when it is not above what is known.

    Bracketed, then where its slope is zero. slope [order or more] : room.
    """
    if c[0] + magnitude(c, 1, order) <= known:
        return known, -1.0
    for k in range(order):
        slope[k] = (k + 1) * c[k + 1]
    where, value = 0.0, c[0]
    if 2.0 * abs(slope[0]) > magnitude(slope, 0, order - 1):  # rises or falls all the way
        if slope[0] > 0.0:
            where, value = 1.0, value_of(c, order, rule.at_probes[PROBES])
    else:
        best = 0
        for p in range(1, PROBES + 1):
            here = value_of(c, order, rule.at_probes[p])
            if here > value:
                best, value = p, here
        where, low, high = best / PROBES, max(best - 1, 0), min(best + 1, PROBES)
        rising = value_of(slope, order - 1, rule.at_probes[low])
        falling = value_of(slope, order - 1, rule.at_probes[high])
        if rising > 0.0 > falling:
            where = crossing(slope, 0, order - 1, low / PROBES, high / PROBES, rising, falling)
            value = value_and_slope(c, 0, order, where)[0]
    return (value, where) if value > known else (known, -1.0)
