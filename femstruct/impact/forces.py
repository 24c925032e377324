"""Forces as they are at one instant: laws of contacts and links, loads, and the displacements they see."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from femstruct.arrays import Floats
from femstruct.impact.compiled.kernels import kernel, summing
from femstruct.impact.compiled.layout import Counts, Vector
from femstruct.impact.system import CONSTANT, CUBIC, HALF_SINE, HERTZ, LINEAR, LINK, POWER, System

OPEN, CLOSED, CLAMPED = 0, 1, 2  # a contact without force; with force; indented, its dashpot out of force
ROUNDING = 4e-15  # relative to the terms a displacement is summed from
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
def spring(system: System, a: int, delta: float) -> tuple[float, float, float]:
    """Force of contact a's spring at an indentation, its slope, and the energy it holds."""
    stiffness, kind = system.interfaces[a]["stiffness"], system.interfaces[a]["kind"]
    if kind == LINEAR:
        return stiffness * delta, stiffness, 0.5 * stiffness * delta * delta
    if kind == HERTZ:
        if delta <= 0.0:
            return 0.0, 0.0, 0.0
        root = np.sqrt(delta)
        return stiffness * delta * root, 1.5 * stiffness * root, 0.4 * stiffness * delta * delta * root
    if kind == POWER:
        if delta <= 0.0:
            return 0.0, 0.0, 0.0
        exponent = system.interfaces[a]["shape"]
        slope = stiffness * delta ** (exponent - 1.0)
        return slope * delta, exponent * slope, slope * delta * delta / (exponent + 1.0)
    if kind == CUBIC:
        square, cubic = delta * delta, system.interfaces[a]["shape"]
        return (
            (stiffness + cubic * square) * delta,
            stiffness + 3.0 * cubic * square,
            (0.5 * stiffness + 0.25 * cubic * square) * square,
        )
    return _curve(system, a, delta)


@kernel
def _curve(system: System, a: int, delta: float) -> tuple[float, float, float]:
    """As `spring`, for a tabulated law: its cubic pieces, and straight on at both ends."""
    left = system.interfaces[a]["first"]
    right = left + system.interfaces[a]["length"]
    while right - left > 1:
        middle = (left + right) // 2
        if system.curves[middle, 0] <= delta:
            left = middle
        else:
            right = middle
    x = delta - system.curves[left, 0]
    force, slope, energy = system.curves[left, 1], system.curves[left, 2], system.curves[left, 5]
    c2, c3 = (system.curves[left, 3], system.curves[left, 4]) if x > 0.0 else (0.0, 0.0)
    return (
        force + x * (slope + x * (c2 + x * c3)),
        slope + x * (2.0 * c2 + 3.0 * x * c3),
        energy + x * (force + x * (slope / 2.0 + x * (c2 / 3.0 + x * c3 / 4.0))),
    )


@kernel
def sense(system: System, a: int) -> tuple[float, float, float]:
    """Whether contact a pushes or pulls: the sign of first + second * indentation + third * speed, while indented.

    The dashpot beside a spring: k delta + c delta'. The dashpot that is a factor: 1 + chi delta'.
    """
    if system.interfaces[a]["kind"] == LINEAR or system.interfaces[a]["kind"] == HERTZ:
        return 0.0, float(system.interfaces[a]["stiffness"]), float(system.interfaces[a]["closing"])
    return 1.0, 0.0, float(system.interfaces[a]["closing"])


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
    if system.interfaces[a]["kind"] == LINEAR:
        return stiffness * delta + damping * speed, stiffness, damping
    force, slope, _ = spring(system, a, delta)
    factor = 1.0 + damping * speed
    return force * factor, slope * factor, force * damping


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
