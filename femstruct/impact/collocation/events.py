"""Watching the contacts: what a step may do before a contact changes its status. No excursion is missed.

Over a step the rows' displacements are interpolated at start, nodes and end. Bernstein coefficients bound the
interpolant, and a remainder from every mode's energy and the forces' derivatives bounds what it can miss: Lagrange's
form for modes slow beside the step, the norm of the interpolation for fast ones. A step in which a change of status
cannot be excluded is halved until it can, or until it is one tick long or what is watched moves by no more than its
rounding: there the change happens.
"""

from __future__ import annotations

import numpy as np

from femstruct.arrays import Floats
from femstruct.impact.compiled.kernels import kernel
from femstruct.impact.engine.gauss_points import PLACES, STAGES, Rule
from femstruct.impact.engine.instant_forces import (
    AWAY,
    CLAMPED,
    CLOSED,
    DISPLACEMENT_ROUNDING,
    OPEN,
    PRELOAD,
    State,
    law,
    sense,
)
from femstruct.impact.engine.modal_tables import Tables
from femstruct.impact.engine.propagate import Trial
from femstruct.impact.engine.records import LINK, System

RELATIVE = 1e-12  # relative to the largest value in the step: rounding of the Bernstein coefficients
AMPLIFIED = 400.0  # rounding of the values in the Bernstein coefficients: the norm of that matrix is 375
SAFE, CHANGES, UNCERTAIN, SHARP = 0, 1, 2, 3


@kernel
def strays(level: int, h: float, system: System, state: State, rule: Rule, tables: Tables, trial: Trial,
           out: Floats) -> None:  # fmt: skip
    """Per interface what interpolation can miss of displacement and velocity, and their rounding: out [i, 4]."""
    r = len(system.rows)
    derivatives = trial.derivatives
    derivatives[:] = 0.0
    for a in range(r):
        for j in range(STAGES):
            for s in range(STAGES):
                derivatives[a, j] += rule.slopes[j, s] * trial.forces[a, s]
            derivatives[a, j] = abs(derivatives[a, j])
            derivatives[a, STAGES] = max(derivatives[a, STAGES], 4.6 * abs(trial.forces[a, j]))
    place, rate, push = tables.stray[level, 0], tables.stray[level, 1], tables.stray_push[level]
    out[:] = 0.0
    coupled = len(system.turn) > 0
    for i in range(len(system.omega)):
        z, v = abs(state.z[i]), abs(state.v[i])
        if z != 0.0 or v != 0.0:
            norm = system.omega[i] * z + v
            for a in range(len(out)):
                row = abs(system.rows[a, i])
                out[a, 2] += row * z
                out[a, 3] += row * v
                if coupled:
                    tilt, squared = abs(system.tilts[a, i]), system.omega[i] * system.omega[i]
                    out[a, 0] += tilt * rate[i] * norm
                    out[a, 1] += tilt * squared * place[i] * norm
                    out[a, 2] += tilt * v
                    out[a, 3] += tilt * (squared * z + system.damping[i] * v)
                    out[a, 0] += row * place[i] * norm
                    row = abs(system.rows[a, i] - system.tilts[a, i] * system.damping[i])
                    out[a, 1] += row * rate[i] * norm
                else:
                    out[a, 0] += row * place[i] * norm
                    out[a, 1] += row * rate[i] * norm
    for a in range(len(out)):
        for b in range(r):
            for j in range(STAGES + 1):
                out[a, 0] += push[0, j, a, b] * derivatives[b, j]
                out[a, 1] += push[1, j, a, b] * derivatives[b, j]
        out[a, 2] *= DISPLACEMENT_ROUNDING
        out[a, 3] *= DISPLACEMENT_ROUNDING


@kernel
def excursion(values: Floats, margin: float, stray: float, rule: Rule) -> tuple[int, float]:
    """Whether the function with these values at the places exceeds the margin, and where first it is seen to do so.

    SHARP where it moves by less than the margin in all of the step: a shorter one would not find the place any better,
    and in much shorter ones the state itself stands still, each change being lost in rounding.
    """
    largest, moves = 0.0, 0.0
    for i in range(PLACES):
        largest = max(largest, abs(values[i]))
        moves = max(moves, abs(values[i] - values[0]))
    found = SHARP if moves <= margin else CHANGES
    doubt = AMPLIFIED * margin + RELATIVE * largest
    margin += RELATIVE * largest
    for i in range(PLACES):
        if values[i] > margin:
            if i == 0:
                return found, 0.0
            low, high = rule.places[i - 1], rule.places[i]
            for _ in range(60):
                middle = 0.5 * (low + high)
                if _interpolant(values, middle, rule) > margin:
                    high = middle
                else:
                    low = middle
            return found, low
    bound = -np.inf
    for i in range(PLACES):
        coefficient = 0.0
        for j in range(PLACES):
            coefficient += rule.bernstein[i, j] * values[j]
        bound = max(bound, coefficient)
    return (SAFE if bound + stray <= doubt else UNCERTAIN), 1.0


@kernel
def _interpolant(values: Floats, theta: float, rule: Rule) -> float:
    top, bottom = 0.0, 0.0
    for i in range(PLACES):
        distance = theta - rule.places[i]
        if distance == 0.0:
            return float(values[i])
        weight = rule.barycentric[i] / distance
        top += weight * values[i]
        bottom += weight
    return top / bottom


@kernel
def watch(h: float, system: System, state: State, rule: Rule, trial: Trial, bounds: Floats,
          loaded: Floats) -> tuple[int, float]:  # fmt: skip
    """First change of status in a trial step: SAFE, CHANGES or SHARP with the part before it, or UNCERTAIN."""
    values = trial.watched
    answer, part = SAFE, 1.0
    for a in range(len(system.interfaces)):
        if system.interfaces[a]["kind"] == LINK or state.status[a] == AWAY:
            continue
        clamps = system.interfaces[a]["tensile"] == 0 and system.interfaces[a]["closing"] > 0.0
        constant, by_depth, by_speed = sense(system, a)
        stray, margin, status = bounds[a, 0], bounds[a, 2], state.status[a]
        # indentation must stay negative when open, positive when closed; a dashpot beside the spring pulls before that
        if status != CLOSED or not clamps or by_depth == 0.0:
            side = 1.0 if status == OPEN else -1.0
            for p in range(PLACES):
                values[p] = side * (trial.place[a, p] + system.interfaces[a]["offset"])
            code, where = excursion(values, margin, stray, rule)
            answer, part = _first(answer, part, code, where)
        if clamps and status != OPEN:
            side = -1.0 if status == CLOSED else 1.0
            for p in range(PLACES):
                depth = trial.place[a, p] + system.interfaces[a]["offset"]
                values[p] = side * (constant + by_depth * depth + by_speed * trial.rate[a, p])
            margin = by_depth * bounds[a, 2] + by_speed * bounds[a, 3]
            code, where = excursion(values, margin, by_depth * bounds[a, 0] + by_speed * bounds[a, 1], rule)
            answer, part = _first(answer, part, code, where)
        if system.interfaces[a]["preload"] > 0.0 and status == CLOSED:
            side = -1.0 if loaded[a] > 0.0 else 1.0
            values[0] = side * _ends(trial.forces[a], rule.at_start)
            values[PLACES - 1] = side * _ends(trial.forces[a], rule.at_end)
            for p in range(STAGES):
                values[p + 1] = side * trial.forces[a, p]
            code, where = excursion(values, least_excess(system, bounds, a), 0.0, rule)
            answer, part = _first(answer, part, code, where)
    return answer, part


@kernel
def least_excess(system: System, bounds: Floats, a: int) -> float:
    """What the force of a preloaded contact must differ from its preload by for its sign to be known."""
    _, by_place, by_rate, _ = law(system, a, system.interfaces[a]["offset"], 0.0)
    rounding = by_place * bounds[a, 2] + by_rate * bounds[a, 3]
    return float(max(PRELOAD * system.interfaces[a]["preload"], rounding))


@kernel
def _ends(forces: Floats, weights: Floats) -> float:
    total = 0.0
    for j in range(STAGES):
        total += weights[j] * forces[j]
    return total


@kernel
def _first(answer: int, part: float, code: int, where: float) -> tuple[int, float]:
    """The earlier of two changes; a change comes before a doubt, a doubt before a sharp change, that before nothing."""
    if code in (CHANGES, SHARP):
        part = min(part, where)
    if answer == CHANGES or code == CHANGES:
        return CHANGES, part
    if answer == UNCERTAIN or code == UNCERTAIN:
        return UNCERTAIN, part
    return max(answer, code), part


@kernel
def switch(system: System, state: State, trial: Trial, bounds: Floats, a: int) -> int:
    """Status of contact a at the end of a step of one tick."""
    if state.status[a] == AWAY:
        return AWAY
    p = PLACES - 1
    delta, speed = trial.place[a, p] + system.interfaces[a]["offset"], trial.rate[a, p]
    margin = bounds[a, 2]
    constant, by_depth, by_speed = sense(system, a)
    psi = constant + by_depth * delta + by_speed * speed
    clamps = system.interfaces[a]["tensile"] == 0 and system.interfaces[a]["closing"] > 0.0
    psi_margin = by_depth * margin + by_speed * bounds[a, 3]
    if state.status[a] == OPEN:
        if delta > margin:
            return CLOSED if psi > 0.0 or not clamps else CLAMPED
        return OPEN
    if state.status[a] == CLOSED:
        if clamps and psi < -psi_margin:
            return CLAMPED if delta > margin else OPEN
        if clamps and by_depth > 0.0:
            return CLOSED
        return OPEN if delta < -margin else CLOSED
    if delta < -margin:
        return OPEN
    return CLOSED if psi > psi_margin else CLAMPED
