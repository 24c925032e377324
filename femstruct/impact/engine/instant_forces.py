"""Forces as they are at one instant: laws of contacts and links, loads, and the displacements they see."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from femstruct.arrays import Floats
from femstruct.impact.compiled.byte_layout import Counts, Vector
from femstruct.impact.compiled.kernels import kernel, summing
from femstruct.impact.engine.records import CONSTANT, HALF_SINE, LINK, System
from femstruct.impact.laws.dispatch import force as force_of

OPEN, CLOSED, CLAMPED = 0, 1, 2  # a contact without force; with force; indented, its dashpot out of force
DISPLACEMENT_ROUNDING = 4e-15  # relative to the terms a displacement is summed from
PRELOAD = 1e-9  # of a preload: what a force must exceed it by, or fall short of it; its rounding if that is more
TINY = 1e-100  # of a coordinate and its rate: no motion
AWAY = 3  # one that waits for the first blow of its body: never closed by motion


class State(NamedTuple):
    """Where the system is; changed in place. z, v [n] : coordinates and rates. status [i] : of the interfaces (a link
    is CLOSED from its release on). rest [i] : displacement of a link at its release. pace [r] : largest speed of a
    row so far. force [r] : force of a row at the end of the last step."""

    z: Vector
    v: Vector
    status: Counts
    rest: Vector
    pace: Vector
    force: Vector


@kernel
def sense(system: System, a: int) -> tuple[float, float, float]:
    """Whether contact a pushes or pulls: the sign of first + second * indentation + third * speed, while indented.

    The dashpot beside a spring: k delta + c delta'. The dashpot that is a factor: 1 + chi delta'.
    """
    if system.interfaces[a]["factor"]:
        return 1.0, 0.0, float(system.interfaces[a]["closing"])
    return 0.0, float(system.interfaces[a]["stiffness"]), float(system.interfaces[a]["closing"])


@kernel
def law(system: System, a: int, delta: float, speed: float) -> tuple[float, float, float, float]:
    """Force of interface a by its formula (no clamp), its derivatives to indentation and speed, and the dashpot's part
    of the force over the speed."""
    if system.interfaces[a]["kind"] == LINK:
        stiffness, damping = system.interfaces[a]["stiffness"], system.interfaces[a]["closing"]
        if speed < 0.0:
            damping = system.interfaces[a]["opening"]
        return stiffness * delta + damping * speed + system.interfaces[a]["preload"], stiffness, damping, damping
    return force_of(system, a, delta, speed)  # type: ignore[no-any-return]


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
    """Value of load i at time t: a weight from its start on, or all occurrences of a history that are not over."""
    since = t - system.loads[i]["start"]
    if system.loads[i]["kind"] == CONSTANT:
        return float(system.loads[i]["value"]) if since >= 0.0 else 0.0
    first, last, every = 0, 0, system.loads[i]["every"]
    if system.loads[i]["count"] > 1:
        last = min(int(np.floor(since / every)), system.loads[i]["count"] - 1)
        first = max(int(np.floor((since - system.loads[i]["span"]) / every)), 0)
    total = 0.0
    for n in range(first, last + 1):
        total += _history_at(system, i, since - n * every)
    return total


@kernel
def _history_at(system: System, i: int, t: float) -> float:
    """Value of the history of load i at its own time, by the formula of the piece it is in."""
    if t < 0.0:
        return 0.0
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


@summing
def dot(left: Floats, right: Floats) -> float:
    """Sum of products."""
    total = 0.0
    for i in range(len(left)):
        total += left[i] * right[i]
    return total


@kernel
def copy_to(out: Floats, values: Floats) -> None:
    """Values into an array that may be longer."""
    for i in range(len(values)):
        out[i] = values[i]


@kernel
def move_to(z: Floats, v: Floats, coordinates: Floats, rates: Floats) -> None:
    """Put the state where it is next, what neither is anywhere nor moves at rest.

    What bounces between two stops halves for ever. Where squares of its numbers leave the range of floating point each
    operation takes a hundred times as long, and rounding is no longer relative.
    """
    for i in range(len(z)):
        moves = abs(coordinates[i]) > TINY or abs(rates[i]) > TINY
        z[i], v[i] = (coordinates[i], rates[i]) if moves else (0.0, 0.0)


@kernel
def rows_now(system: System, z: Floats, v: Floats, place: Floats, rate: Floats) -> None:
    """Displacements and velocities of all rows."""
    for a in range(len(system.rows)):
        place[a], rate[a] = dot(system.rows[a], z), dot(system.rows[a], v)
    for a in range(system.tilts.shape[0]):
        tilted, swung = 0.0, 0.0
        for i in range(len(z)):
            tilted += system.tilts[a, i] * v[i]
            swung += system.tilts[a, i] * (system.omega[i] * system.omega[i] * z[i] + system.damping[i] * v[i])
        place[a] += tilted
        rate[a] -= swung


@summing
def terms_of(system: System, a: int, z: Floats, v: Floats) -> float:
    """Sum of the magnitudes that a row's displacement is summed from: what rounding is relative to."""
    total = 0.0
    for i in range(len(z)):
        total += abs(system.rows[a, i] * z[i])
    for i in range(system.tilts.shape[1]):
        total += abs(system.tilts[a, i] * v[i])
    return total


@summing
def terms_of_rate(system: System, a: int, z: Floats, v: Floats) -> float:
    """The same of its velocity."""
    total = 0.0
    for i in range(len(z)):
        total += abs(system.rows[a, i] * v[i])
    for i in range(system.tilts.shape[1]):
        turning = system.omega[i] * system.omega[i] * abs(z[i]) + system.damping[i] * abs(v[i])
        total += abs(system.tilts[a, i]) * turning
    return total
