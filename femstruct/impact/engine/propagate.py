"""One step: forces of the closed contacts and links at the Gauss points, then the modes exactly.

The modes respond exactly to forces that are polynomials over the step, so the only unknowns are the few interface
forces at the Gauss points: displacement = free motion + compliance . forces, forces = law(displacement, velocity),
solved by Newton. Gauss collocation: forces are good to order s, impulses and energy to order 2 s.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from femstruct.impact.compiled.byte_layout import Counts, Cube, Matrix, Vector
from femstruct.impact.compiled.kernels import kernel
from femstruct.impact.engine.dense import solve_dense
from femstruct.impact.engine.gauss_points import PLACES, POINTS, STAGES, Rule
from femstruct.impact.engine.instant_forces import (
    CLOSED,
    DISPLACEMENT_ROUNDING,
    State,
    law,
    load_at,
    net_force,
    terms_of,
    terms_of_rate,
)
from femstruct.impact.engine.modal_tables import Tables
from femstruct.impact.engine.records import HALF_SINE, LINK, System

NEWTON_STEPS = 12
SOLVED = 2e-14  # of the largest force of an interface: what Newton's method leaves of it
FAINT = 1e-30  # of the largest force: what is below it is not known better, as where a motion has hardly arrived
ROUGHLY = 1e-12  # what it may leave of it after its last step
EXTRAPOLATED = 6.0  # norm of the extrapolation of a force from the nodes to an end of the step, and 1 for its law there
LONGER = 2e-3  # of the error that is allowed: below it the next step may be longer


class Trial(NamedTuple):
    """A step that was solved and may be kept. place, rate [r, PLACES] : displacement and velocity of the rows at start,
    nodes, end. forces [r, s] : forces at the nodes as they act, less preloads. q : free motion. active [m], slope
    [m, s, 2], jacobian [m s, m s], residual [m s] : of Newton's iteration; derivatives [r, s + 1], watched [PLACES] :
    of the watch over the contacts. Nothing is allocated in a step."""

    place: Matrix
    rate: Matrix
    forces: Matrix
    q: Vector
    active: Counts
    slope: Cube
    jacobian: Matrix
    residual: Vector
    derivatives: Matrix
    watched: Vector


def trial_room(system: System) -> Trial:
    """Work space for one trial step."""
    r, m = len(system.rows), len(system.interfaces)
    return Trial(
        place=np.zeros((r, PLACES)),
        rate=np.zeros((r, PLACES)),
        forces=np.zeros((r, STAGES)),
        q=np.zeros(r * POINTS * 2),
        active=np.zeros(m, dtype=np.int64),
        slope=np.empty((m, STAGES, 2)),
        jacobian=np.empty((m * STAGES, m * STAGES)),
        residual=np.empty(m * STAGES),
        derivatives=np.empty((r, STAGES + 1)),
        watched=np.empty(PLACES),
    )


@kernel
def try_step(t: float, level: int, h: float, system: System, state: State, rule: Rule, tables: Tables, trial: Trial,
             tolerance: float) -> float:  # fmt: skip
    """Solve a step; returns its error over what is allowed, infinite when the forces were not found.

    The error of a force is what its polynomial misses of its law at both ends; what counts is the speed it would give
    the mass behind the row in the step, against the largest speed the row has had.
    """
    n, r, m = len(system.omega), len(system.rows), len(system.interfaces)
    q = trial.q
    q[:] = 0.0
    free = tables.free[level]
    for i in range(n):
        z, v = state.z[i], state.v[i]
        if z != 0.0 or v != 0.0:
            for j in range(len(q)):
                q[j] += z * free[0, i, j] + v * free[1, i, j]
    active, count = trial.active, 0
    for a in range(m):
        if state.status[a] == CLOSED:
            active[count] = a
            count += 1
            trial.forces[a] = state.force[a]
        else:
            trial.forces[a] = 0.0 if system.interfaces[a]["kind"] == LINK else -system.interfaces[a]["preload"]
    for i in range(r - m):
        for j in range(STAGES):
            trial.forces[m + i, j] = load_at(system, i, t + rule.nodes[j] * h)
    if not _interface_forces(level, system, state, tables, trial, count):
        return np.inf
    return _error(t, h, system, state, rule, trial, tolerance)


@kernel
def _interface_forces(level: int, system: System, state: State, tables: Tables, trial: Trial, count: int) -> bool:
    """Newton for the forces of the `count` active interfaces at the nodes; leaves place and rate of all rows."""
    r, size = len(system.rows), count * STAGES
    forced = tables.forced[level]
    place, rate = trial.place, trial.rate
    active, slope, jacobian, residual = trial.active, trial.slope, trial.jacobian, trial.residual
    biggest = 0.0
    for a in range(r):
        if a < len(system.interfaces):
            biggest = max(biggest, abs(system.interfaces[a]["preload"]))
        for p in range(STAGES):
            biggest = max(biggest, abs(trial.forces[a, p]))
    for step in range(NEWTON_STEPS):
        for a in range(r):
            for p in range(POINTS):
                x, v = trial.q[(a * POINTS + p) * 2], trial.q[(a * POINTS + p) * 2 + 1]
                for b in range(r):
                    for j in range(STAGES):
                        x += forced[a, p, 0, b, j] * trial.forces[b, j]
                        v += forced[a, p, 1, b, j] * trial.forces[b, j]
                place[a, p + 1], rate[a, p + 1] = x, v
        if count == 0:
            return True
        worst = 0.0
        for i in range(count):
            a = active[i]
            shift = -state.rest[a] if system.interfaces[a]["kind"] == LINK else system.interfaces[a]["offset"]
            held = 0.0 if system.interfaces[a]["kind"] == LINK else system.interfaces[a]["preload"]
            largest, miss = max(abs(system.interfaces[a]["preload"]), FAINT * biggest), 0.0
            for p in range(STAGES):
                f, slope[i, p, 0], slope[i, p, 1], _ = law(system, a, place[a, p + 1] + shift, rate[a, p + 1])
                residual[i * STAGES + p] = f - held - trial.forces[a, p]
                largest = max(largest, abs(f), abs(trial.forces[a, p]))
                miss = max(miss, abs(residual[i * STAGES + p]))
            if not np.isfinite(miss):
                return False
            if largest > 0.0:
                worst = max(worst, miss / largest)
        if worst <= SOLVED:
            return True
        if step == NEWTON_STEPS - 1:
            return worst <= ROUGHLY or _lost_in_rounding(system.tick * float(1 << level), system, state, trial, count)
        for i in range(count):
            for p in range(STAGES):
                for j in range(count):
                    b = active[j]
                    for s in range(STAGES):
                        jacobian[i * STAGES + p, j * STAGES + s] = -(
                            slope[i, p, 0] * forced[active[i], p, 0, b, s]
                            + slope[i, p, 1] * forced[active[i], p, 1, b, s]
                        )
                jacobian[i * STAGES + p, i * STAGES + p] += 1.0
        if not solve_dense(jacobian, residual, size):
            return False
        for i in range(count):
            for p in range(STAGES):
                trial.forces[active[i], p] += residual[i * STAGES + p]
    return False


@kernel
def _lost_in_rounding(h: float, system: System, state: State, trial: Trial, count: int) -> bool:
    """Whether what Newton's method has left of the forces is no more than their rounding."""
    for i in range(count):
        miss = 0.0
        for p in range(STAGES):
            miss = max(miss, abs(trial.residual[i * STAGES + p]))
        if miss > _unknown(h, system, state, trial, trial.active[i]):
            return False
    return True


@kernel
def _unknown(h: float, system: System, state: State, trial: Trial, a: int) -> float:
    """What rounding of displacement, speed and force leaves unknown of the force of an active interface in a step."""
    shift = -state.rest[a] if system.interfaces[a]["kind"] == LINK else system.interfaces[a]["offset"]
    still = abs(shift) + terms_of(system, a, state.z, state.v)
    moving = terms_of_rate(system, a, state.z, state.v)
    still, moving = DISPLACEMENT_ROUNDING * (still + h * moving), DISPLACEMENT_ROUNDING * moving
    largest, shaken = abs(system.interfaces[a]["preload"]), 0.0
    for p in range(PLACES):
        depth = trial.place[a, p] + shift
        if system.interfaces[a]["kind"] != LINK:  # one that is open within rounding is not known to be
            depth = max(depth, still)
        force, by_place, by_rate, _ = law(system, a, depth, trial.rate[a, p])
        largest = max(largest, abs(force))
        shaken = max(shaken, abs(by_place) * still + abs(by_rate) * moving)
    return float(SOLVED * largest + shaken)


@kernel
def _error(t: float, h: float, system: System, state: State, rule: Rule, trial: Trial, tolerance: float) -> float:
    m = len(system.interfaces)
    worst = 0.0
    for a in range(len(system.rows)):
        start, end, top = 0.0, 0.0, 0.0
        for j in range(STAGES):
            start += rule.at_start[j] * trial.forces[a, j]
            end += rule.at_end[j] * trial.forces[a, j]
            top += rule.top[j] * trial.forces[a, j]
        if a < m:
            if state.status[a] != CLOSED:
                continue
            start -= net_force(system, state, a, trial.place[a, 0], trial.rate[a, 0])
            end -= net_force(system, state, a, trial.place[a, PLACES - 1], trial.rate[a, PLACES - 1])
        else:
            load, curl, speed = 0.0, 0.0, state.pace[a]
            for j in range(STAGES):
                load = max(load, abs(trial.forces[a, j]))
                curl += rule.top[j] * trial.rate[a, j + 1]
                speed = max(speed, abs(trial.rate[a, j + 1]))
            if load > 0.0 and speed > 0.0:
                # the load's work is a Gauss sum, good to the square of what a polynomial misses of the speed
                worst = max(worst, (curl / speed) ** 2 / tolerance)
            if system.loads[a - m]["kind"] != HALF_SINE:
                continue
            start -= load_at(system, a - m, t)
            end -= load_at(system, a - m, t + h * (1.0 - 1e-12))
        pace = state.pace[a]
        for p in range(PLACES):
            pace = max(pace, abs(trial.rate[a, p]))
        miss, speeds = max(abs(start), abs(end), 0.1 * abs(top)), h * system.mobility[a]
        if a < m and miss * speeds > LONGER * tolerance * pace:  # no shorter step has less of rounding
            miss = max(miss - EXTRAPOLATED * _unknown(h, system, state, trial, a), 0.0)
        if miss > 0.0:
            worst = max(worst, miss * speeds / (tolerance * pace)) if pace > 0.0 else np.inf
    return worst
