"""One step: forces of the closed contacts and links at the Gauss points, then the modes exactly.

The modes respond exactly to forces that are polynomials over the step, so the only unknowns are the few interface
forces at the Gauss points: displacement = free motion + compliance . forces, forces = law(displacement, velocity),
solved by Newton. Gauss collocation: forces are good to order s, impulses and energy to order 2 s.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.impact.compiled import kernel, summing
from femstruct.impact.rule import PLACES, POINTS, STAGES, Rule
from femstruct.impact.system import CONSTANT, HALF_SINE, HERTZ, LINK, System
from femstruct.impact.tables import Tables

OPEN, CLOSED, CLAMPED = 0, 1, 2  # a contact without force; with force; indented, its dashpot out of force
NEWTON_STEPS = 12
PICARD_STEPS = 40


class State(NamedTuple):
    """Where the system is; changed in place. z, v [n] : coordinates and rates. status [i] : of the interfaces (a link
    is CLOSED from its release on). rest [i] : displacement of a link at its release. pace [r] : largest speed of a
    row so far. force [r] : force of a row at the end of the last step."""

    z: Floats
    v: Floats
    status: Integers
    rest: Floats
    pace: Floats
    force: Floats


class Trial(NamedTuple):
    """A step that was solved and may be kept. place, rate [r, PLACES] : displacement and velocity of the rows at start,
    nodes, end. forces [r, s] : forces at the nodes as they act, less preloads. modal [s, k], speeds [s, k] : forces
    and speeds of coupled damping. d, u : free motion."""

    place: Floats
    rate: Floats
    forces: Floats
    modal: Floats
    speeds: Floats
    q: Floats


def trial_room(system: System) -> Trial:
    """Work space for one trial step."""
    r, k = len(system.rows), len(system.coupling)
    return Trial(
        place=np.zeros((r, PLACES)),
        rate=np.zeros((r, PLACES)),
        forces=np.zeros((r, STAGES)),
        modal=np.zeros((STAGES, k)),
        speeds=np.zeros((STAGES, k)),
        q=np.zeros(r * POINTS * 2),
    )


@kernel
def law(system: System, a: int, delta: float, speed: float) -> tuple[float, float, float]:
    """Force of interface a by its formula (no clamp) and its derivatives to indentation and speed."""
    stiffness, damping = system.interfaces[a]["stiffness"], system.interfaces[a]["closing"]
    if system.interfaces[a]["kind"] == LINK:
        if speed < 0.0:
            damping = system.interfaces[a]["opening"]
        return stiffness * delta + damping * speed + system.interfaces[a]["preload"], stiffness, damping
    if system.interfaces[a]["kind"] == HERTZ:
        if delta <= 0.0:
            return 0.0, 0.0, 0.0
        root = np.sqrt(delta)
        force = root * (stiffness * delta + damping * speed)
        return force, 1.5 * stiffness * root + 0.5 * damping * speed / root, damping * root
    return stiffness * delta + damping * speed, stiffness, damping


@kernel
def net_force(system: System, state: State, a: int, displacement: float, speed: float) -> float:
    """Force with which interface a acts in its present status: preloads of contacts are in balance with the rest."""
    if system.interfaces[a]["kind"] == LINK:
        return law(system, a, displacement - state.rest[a], speed)[0] if state.status[a] == CLOSED else 0.0
    if state.status[a] == CLOSED:
        return float(
            law(system, a, displacement + system.interfaces[a]["offset"], speed)[0] - system.interfaces[a]["preload"]
        )
    return float(-system.interfaces[a]["preload"])


@kernel
def load_at(system: System, i: int, t: float) -> float:
    """Value of load i at time t, by the formula of the piece it is in."""
    if system.loads[i]["kind"] == CONSTANT:
        return float(system.loads[i]["value"])
    if system.loads[i]["kind"] == HALF_SINE:
        amplitude, frequency = system.loads[i]["value"], system.loads[i]["frequency"]
        return float(amplitude * np.sin(2.0 * np.pi * frequency * t)) if t * frequency < 0.5 else 0.0
    first, length = system.loads[i]["first"], system.loads[i]["length"]
    last = first + length - 1
    if t < system.table[first, 0] or t > system.table[last, 0]:
        return 0.0
    left, right = first, last
    while right - left > 1:
        middle = (left + right) // 2
        if system.table[middle, 0] <= t:
            left = middle
        else:
            right = middle
    share = (t - system.table[left, 0]) / (system.table[right, 0] - system.table[left, 0])
    return float((1.0 - share) * system.table[left, 1] + share * system.table[right, 1])


@kernel
def solve_dense(matrix: Floats, right: Floats) -> bool:
    """Gauss elimination with row pivots, in place; the answer is in `right`. False for a singular matrix."""
    size = len(right)
    for i in range(size):
        pivot = i
        for m in range(i + 1, size):
            if abs(matrix[m, i]) > abs(matrix[pivot, i]):
                pivot = m
        if not abs(matrix[pivot, i]) > 0.0:
            return False
        if pivot != i:
            for j in range(i, size):
                matrix[i, j], matrix[pivot, j] = matrix[pivot, j], matrix[i, j]
            right[i], right[pivot] = right[pivot], right[i]
        for m in range(i + 1, size):
            factor = matrix[m, i] / matrix[i, i]
            if factor != 0.0:
                for j in range(i + 1, size):
                    matrix[m, j] -= factor * matrix[i, j]
                right[m] -= factor * right[i]
    for i in range(size - 1, -1, -1):
        total = right[i]
        for j in range(i + 1, size):
            total -= matrix[i, j] * right[j]
        right[i] = total / matrix[i, i]
    return True


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
    active = np.empty(m, dtype=np.int64)
    count = 0
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
    if len(system.coupling):
        trial.modal[:] = 0.0
        for round_ in range(PICARD_STEPS):
            if not _interface_forces(level, system, state, tables, trial, active[:count]):
                return np.inf
            change, size = _couple(level, system, state, tables, trial)
            if change <= 1e-15 * size:
                break
            if round_ == PICARD_STEPS - 1:
                return np.inf
    elif not _interface_forces(level, system, state, tables, trial, active[:count]):
        return np.inf
    return _error(t, h, system, state, rule, trial, tolerance)


@kernel
def _interface_forces(level: int, system: System, state: State, tables: Tables, trial: Trial, active: Integers) -> bool:
    """Newton for the forces of the active interfaces at the nodes; leaves place and rate of all rows in the trial."""
    r, count = len(system.rows), len(active)
    size = count * STAGES
    forced = tables.forced[level]
    place, rate = trial.place, trial.rate
    jacobian, residual = np.empty((size, size)), np.empty(size)
    slope = np.empty((count, STAGES, 2))
    for step in range(NEWTON_STEPS):
        for a in range(r):
            for p in range(POINTS):
                x, v = trial.q[(a * POINTS + p) * 2], trial.q[(a * POINTS + p) * 2 + 1]
                for b in range(r):
                    for j in range(STAGES):
                        x += forced[a, p, 0, b, j] * trial.forces[b, j]
                        v += forced[a, p, 1, b, j] * trial.forces[b, j]
                place[a, p + 1], rate[a, p + 1] = x, v
        if len(system.coupling):
            _add_coupled(level, system, tables, trial)
        if count == 0:
            return True
        worst = 0.0
        for i in range(count):
            a = active[i]
            shift = -state.rest[a] if system.interfaces[a]["kind"] == LINK else system.interfaces[a]["offset"]
            held = 0.0 if system.interfaces[a]["kind"] == LINK else system.interfaces[a]["preload"]
            largest, miss = system.interfaces[a]["preload"], 0.0
            for p in range(STAGES):
                f, slope[i, p, 0], slope[i, p, 1] = law(system, a, place[a, p + 1] + shift, rate[a, p + 1])
                residual[i * STAGES + p] = f - held - trial.forces[a, p]
                largest = max(largest, abs(f), abs(trial.forces[a, p]))
                miss = max(miss, abs(residual[i * STAGES + p]))
            if not np.isfinite(miss):
                return False
            if largest > 0.0:
                worst = max(worst, miss / largest)
        if worst <= 2e-14:
            return True
        if step == NEWTON_STEPS - 1:
            return worst <= 1e-12
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
        if not solve_dense(jacobian, residual):
            return False
        for i in range(count):
            for p in range(STAGES):
                trial.forces[active[i], p] += residual[i * STAGES + p]
    return False


@kernel
def _couple(level: int, system: System, state: State, tables: Tables, trial: Trial) -> tuple[float, float]:
    """Forces of the damping off the diagonal from the modes' speeds; returns the largest change and speed force."""
    k, m = system.n_modes, len(system.rows)
    speeds = trial.speeds
    for p in range(STAGES):
        for i in range(k):
            speeds[p, i] = tables.mode_free[level, p, 0, i] * state.z[i] + tables.mode_free[level, p, 1, i] * state.v[i]
        for j in range(STAGES):
            for i in range(k):
                speeds[p, i] += tables.mode_forced[level, p, j, i] * trial.modal[j, i]
            for a in range(m):
                force = system.sign[a] * trial.forces[a, j]
                if force != 0.0:
                    for i in range(k):
                        speeds[p, i] += tables.mode_forced[level, p, j, i] * system.rows[a, i] * force
    change, size = 0.0, 0.0
    for p in range(STAGES):
        for i in range(k):
            force = 0.0
            for j in range(k):
                force -= system.coupling[i, j] * speeds[p, j]
            change, size = max(change, abs(force - trial.modal[p, i])), max(size, abs(force))
            trial.modal[p, i] = force
    return change, size


@kernel
def _add_coupled(level: int, system: System, tables: Tables, trial: Trial) -> None:
    """Add what the coupled damping does to the rows; their responses are those of a unit force in each mode."""
    k = system.n_modes
    for a in range(len(system.rows)):
        for p in range(POINTS):
            x, v = 0.0, 0.0
            for j in range(STAGES):
                for i in range(k):
                    force = system.rows[a, i] * trial.modal[j, i]
                    x += tables.mode_place[level, p, j, i] * force
                    v += tables.mode_forced[level, p, j, i] * force
            trial.place[a, p + 1] += x
            trial.rate[a, p + 1] += v


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
            if system.loads[a - m]["kind"] != HALF_SINE:
                continue
            start -= load_at(system, a - m, t)
            end -= load_at(system, a - m, t + h * (1.0 - 1e-12))
        pace = state.pace[a]
        for p in range(PLACES):
            pace = max(pace, abs(trial.rate[a, p]))
        miss = max(abs(start), abs(end), 0.1 * abs(top)) * h * system.mobility[a]
        if miss > 0.0:
            worst = max(worst, miss / (tolerance * pace)) if pace > 0.0 else np.inf
    if len(system.coupling):
        energy, tail = 0.0, 0.0
        for i in range(system.n_modes):
            energy += state.v[i] ** 2 + (system.omega[i] * state.z[i]) ** 2
            top = 0.0
            for j in range(STAGES):
                top += rule.top[j] * trial.modal[j, i]
            tail += top * top
        if tail > 0.0:
            fastest = 0.0
            for p in range(STAGES):
                for i in range(system.n_modes):
                    fastest += trial.speeds[p, i] ** 2 / STAGES
            fastest = np.sqrt(max(energy, fastest))
            worst = max(worst, 0.1 * h * np.sqrt(tail) / (tolerance * fastest))
    return worst


@summing
def dot(left: Floats, right: Floats) -> float:
    """Sum of products."""
    total = 0.0
    for i in range(len(left)):
        total += left[i] * right[i]
    return total


@kernel
def rows_now(system: System, z: Floats, v: Floats, place: Floats, rate: Floats) -> None:
    """Displacements and velocities of all rows."""
    for a in range(len(system.rows)):
        place[a], rate[a] = dot(system.rows[a], z), dot(system.rows[a], v)


@kernel
def advance(level: int, system: System, tables: Tables, forces: Floats, modal: Floats, z: Floats, v: Floats,
            work: Floats) -> float:  # fmt: skip
    """Move z, v over a step under forces at the nodes; returns the energy the diagonal damping took.

    work [STAGES + 4, n] : room; the modal forces at the nodes are left in its first STAGES rows.
    """
    n = len(z)
    for j in range(STAGES):
        work[j] = 0.0
        for a in range(len(system.rows)):
            force = system.sign[a] * forces[a, j]
            if force != 0.0:
                for i in range(n):
                    work[j, i] += system.rows[a, i] * force
        for i in range(modal.shape[1]):
            work[j, i] += modal[j, i]
    flow, push, loss = tables.flow[level], tables.push[level], tables.loss[level]
    basis = STAGES + 2
    for i in range(n):
        work[basis, i] = flow[0, i] * z[i] + flow[1, i] * v[i]
        work[basis + 1, i] = flow[2, i] * z[i] + flow[3, i] * v[i]
    for j in range(STAGES):
        for i in range(n):
            work[basis, i] += push[0, j, i] * work[j, i]
            work[basis + 1, i] += push[1, j, i] * work[j, i]
    work[STAGES] = 0.0
    q = 0
    for a in range(basis):
        left = z if a == 0 else (v if a == 1 else work[a - 2])
        for b in range(a, basis):
            right = z if b == 0 else (v if b == 1 else work[b - 2])
            for i in range(n):
                work[STAGES, i] += loss[q, i] * left[i] * right[i]
            q += 1
    taken = 0.0
    for i in range(n):
        taken += work[STAGES, i]
    z[:] = work[basis]
    v[:] = work[basis + 1]
    return taken


@kernel
def drift(level: int, system: System, tables: Tables, forces: Floats, modal: Floats, z: Floats, v: Floats,
          work: Floats) -> None:  # fmt: skip
    """As `advance`, without the loss: the samples inside a step."""
    n = len(z)
    flow, push = tables.flow[level], tables.push[level]
    for i in range(n):
        work[0, i] = flow[0, i] * z[i] + flow[1, i] * v[i]
        work[1, i] = flow[2, i] * z[i] + flow[3, i] * v[i]
    for j in range(STAGES):
        pushed = modal.shape[1] > 0
        for i in range(n):
            work[2, i] = 0.0
        for a in range(len(system.rows)):
            force = system.sign[a] * forces[a, j]
            if force != 0.0:
                pushed = True
                for i in range(n):
                    work[2, i] += system.rows[a, i] * force
        if not pushed:
            continue
        for i in range(modal.shape[1]):
            work[2, i] += modal[j, i]
        for i in range(n):
            work[0, i] += push[0, j, i] * work[2, i]
            work[1, i] += push[1, j, i] * work[2, i]
    z[:] = work[0]
    v[:] = work[1]
