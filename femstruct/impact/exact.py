"""The exact integration: power series of the present regime, cut at the first event, until the end."""

from __future__ import annotations

from functools import cache
from math import comb, factorial
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from femstruct.arrays import Floats
from femstruct.compiled.kernels import Counts, CountTable, Matrix, Vector, kernel, summing, unit
from femstruct.compiled.records import CONSTANT, HALF_SINE, LINK, TABLE, System
from femstruct.impact.contact_events import (
    DONE,
    FULL,
    NO_FORCES,
    OF_PLACE,
    OF_SPEED,
    PEAK,
    PEAK_AT,
    STEPS,
    STICKS,
    TOO_MANY_EVENTS,
    RunRecord,
    Standing,
    balance_ledger_row,
    confirm,
    ended,
    log_changes,
    may_continue,
    settle_events,
    standing_room,
    start_ledger,
    store_row,
)
from femstruct.impact.energies import GIVEN, MODES, WORK
from femstruct.impact.propagation import (
    CLAMPED,
    CLOSED,
    OPEN,
    PRELOAD,
    State,
    copy_to,
    load_at,
    move_to,
    terms_of,
    terms_of_rate,
)

# ----------------------------------------------------------------------------------------------------------------------
# Constants of the exact integration, and its work space.
# ----------------------------------------------------------------------------------------------------------------------

ORDER = 26  # of the power series of a step
SHORT = 4  # of a first look at what switches at this very instant
THETA = 2.0  # longest step times the bound of the system's frequencies
TRUNCATION = 1e-17  # of the exponential series at the order used: a tenth of rounding
GAUSS = 10  # points: energies of a longest step are good to 1e-18
COARSE = 8  # degree of the first look at a polynomial; what is left out of it is a margin
PROBES = 6  # parts of a step in one of which its largest value is bracketed
DEPTH = 60  # halvings of a step while a root is bracketed


class ExactRule(NamedTuple):
    """bernstein [j, k] : Bernstein coefficients of degree ORDER on (0, 1) from powers k; every weight is in 0..1, so
    nothing is amplified; coarse [j, k] : the same of degree COARSE. nodes, weights [g] : Gauss's rule on (0, 1).
    at_nodes [g, k], at_probes [p, k] : powers of the nodes, and of p / PROBES from p = 0. factors [k] : 1 / k!.
    reach [p] : largest bound times step for which order p leaves out no more than TRUNCATION."""

    bernstein: Matrix
    coarse: Matrix
    nodes: Vector
    weights: Vector
    at_nodes: Matrix
    at_probes: Matrix
    factors: Vector
    reach: Vector


@cache
def exact_rule() -> ExactRule:
    """The constants.

    >>> rule = exact_rule()
    >>> bool(rule.reach[ORDER] >= THETA), bool(np.isclose(rule.weights @ rule.nodes**19, 1 / 20, rtol=1e-14))
    (True, True)
    """
    size = ORDER + 1
    x, w = legendre.leggauss(GAUSS)
    nodes = (1.0 + x) / 2.0
    return ExactRule(
        bernstein=_bernstein(ORDER),
        coarse=_bernstein(COARSE),
        nodes=nodes,
        weights=w / 2.0,
        at_nodes=nodes[:, None] ** np.arange(size),
        at_probes=np.linspace(0.0, 1.0, PROBES + 1)[:, None] ** np.arange(size),
        factors=np.array([1.0 / factorial(k) for k in range(size)]),
        reach=np.array([0.0] + [(TRUNCATION * factorial(p)) ** (1.0 / p) for p in range(1, size)]),
    )


def _bernstein(degree: int) -> Floats:
    return np.array([[comb(j, k) / comb(degree, k) for k in range(degree + 1)] for j in range(degree + 1)])


class ExactWorkspace(NamedTuple):
    """Work space of one integration, used by every step: nothing is allocated on the way.

    z [ORDER + 1, n] : power series of the coordinates over the step, in parts of it; w : of the rates of oscillators in
    place of coupled modes [1/s], else empty. place, rate, force [r, ORDER + 1]
    : of the rows' displacements, velocities [1/s] and forces as they act. spring, dash, held [m] : force of an
    interface in the present regime = spring place + dash rate + held. way [m] : sign of a link's speed. fresh [m, 3] :
    whether a contact's indentation, its force, a link's speed is zero by an event at this very instant. here : between
    two steps; since when contacts are closed is not kept. watched [ORDER + 1] : a polynomial. boxes [DEPTH, ORDER + 1],
    spans [DEPTH, 2] : its Bernstein coefficients on parts of the step. terms [m, 7] : sizes of what the interfaces'
    displacements and velocities are summed from, STILL and MOVING, the ROOT of their mobilities, and rounding: of both
    at the start, NOISE and NOISE_RATE, and of their other coefficients, SMALL and SMALL_RATE. q, v [n] : coordinates
    and rates somewhere in the step.
    """

    z: Matrix
    w: Matrix
    place: Matrix
    rate: Matrix
    force: Matrix
    spring: Vector
    dash: Vector
    held: Vector
    direction: Counts
    fresh: CountTable
    here: Standing
    watched: Vector
    boxes: Matrix
    spans: Matrix
    terms: Matrix
    q: Vector
    v: Vector


def exact_workspace(system: System) -> ExactWorkspace:
    """Work space for integrations of a system of this size."""
    n, r, m, size = len(system.omega), len(system.rows), len(system.interfaces), ORDER + 1
    return ExactWorkspace(
        z=np.zeros((size, n)),
        w=np.zeros((size, n) if len(system.turn) else (0, 0)),
        place=np.zeros((r, size)),
        rate=np.zeros((r, size)),
        force=np.zeros((r, size)),
        spring=np.zeros(m),
        dash=np.zeros(m),
        held=np.zeros(m),
        direction=np.zeros(m, dtype=np.int64),
        fresh=np.zeros((m, 3), dtype=np.int64),
        here=standing_room(system),
        watched=np.zeros(size),
        boxes=np.zeros((DEPTH, size)),
        spans=np.zeros((DEPTH, 2)),
        terms=np.zeros((m, 7)),
        q=np.zeros(n),
        v=np.zeros(n),
    )


# ----------------------------------------------------------------------------------------------------------------------
# First root of a polynomial over a step: Bernstein coefficients bound it, so that no root is skipped.
#
# A part of the step whose Bernstein coefficients are all positive has no root; one in which they change sign once has
# exactly one (Descartes), which safeguarded Newton finds; any other is halved.
# ----------------------------------------------------------------------------------------------------------------------

NEVER = 2.0
COEFFICIENT_ROUNDING = 2e-15  # of a Bernstein coefficient, relative to the sum of the powers' coefficients


@summing
def value_of(c: Floats, order: int, powers: Floats) -> float:
    """c[0] + c[1] theta + ... + c[order] theta^order, from the powers of theta: no term waits for another."""
    total = 0.0
    for k in range(order + 1):
        total += c[k] * powers[k]
    return float(total)


@summing
def magnitude(c: Floats, first: int, order: int) -> float:
    """|c[first]| + ... + |c[order]|: what these terms are at most on [0, 1]."""
    total = 0.0
    for k in range(first, order + 1):
        total += abs(c[k])
    return float(total)


@summing
def value_and_slope(c: Floats, lead: int, order: int, theta: float) -> tuple[float, float]:
    """c[lead] + c[lead + 1] theta + ... + c[order] theta^(order - lead), and its derivative."""
    value, slope = c[order], 0.0
    for k in range(order - 1, lead - 1, -1):
        slope = slope * theta + value
        value = value * theta + c[k]
    return value, slope


@kernel
def stays_positive(c: Floats, lead: int, order: int, coarse: Floats) -> bool:
    """Whether the first coefficients alone show that the polynomial is positive on [0, 1]."""
    remainder, lowest = magnitude(c, lead + COARSE + 1, order), np.inf
    for j in range(COARSE + 1):
        lowest = min(lowest, value_of(c[lead:], min(j, order - lead), coarse[j]))
    return bool(lowest > remainder)


@kernel
def first_descent(c: Floats, lead: int, order: int, bernstein: Floats, boxes: Floats, spans: Floats) -> float:
    """First place in (0, 1] where the polynomial c[lead:order + 1], not negative at 0, becomes negative; else NEVER.

    Excursions below zero smaller than rounding are none.
    """
    doubt, lowest = COEFFICIENT_ROUNDING * magnitude(c, lead, order), 0.0
    for j in range(ORDER + 1):
        boxes[0, j] = value_of(c[lead:], min(j, order - lead), bernstein[j])
        lowest = min(lowest, boxes[0, j])
    if lowest >= -doubt:
        return NEVER
    spans[0, 0], spans[0, 1] = 0.0, 1.0
    top = 0
    while top >= 0:
        low, high = spans[top, 0], spans[top, 1]
        changes, negative, sign, first = 0, 0, 0, 0
        for j in range(ORDER + 1):
            b = boxes[top, j]
            if abs(b) > doubt or (j == 0 and low == 0.0):  # where it starts it is positive, however little
                now = 1 if b > 0.0 else -1
                if now < 0:
                    negative += 1
                if first == 0:
                    first = now
                elif now != sign:
                    changes += 1
                sign = now
        if negative == 0:
            top -= 1
            continue
        if first < 0 or top == DEPTH - 1 or high - low < 1e-15:  # what lies before this part is not negative
            return float(low)
        if changes == 1:
            return crossing(c, lead, order, low, high, boxes[top, 0], boxes[top, ORDER])
        middle = 0.5 * (low + high)
        for j in range(ORDER + 1):  # de Casteljau: the left part goes on top, the right one stays
            boxes[top + 1, j] = boxes[top, 0]
            for i in range(ORDER - j):
                boxes[top, i] = 0.5 * (boxes[top, i] + boxes[top, i + 1])
        spans[top, 0], spans[top, 1] = middle, high
        spans[top + 1, 0], spans[top + 1, 1] = low, middle
        top += 1
    return NEVER


@kernel
def crossing(c: Floats, lead: int, order: int, low: float, high: float, at_low: float, at_high: float) -> float:
    """The one root between low, where the polynomial is not negative, and high, where it is: safeguarded Newton.

    Parameters
    ----------
    at_low, at_high : float
        Its values there; the first guess is where a line through them crosses zero, but at neither end.
    """
    part = at_low / (at_low - at_high) if at_high < 0.0 < at_low else 0.5
    x = low + (high - low) * min(max(part, 0.1), 0.9)
    for _ in range(100):
        f, slope = value_and_slope(c, lead, order, x)
        if f == 0.0:
            return x
        if f > 0.0:
            low = x
        else:
            high = x
        step = -f / slope if slope != 0.0 else 0.0
        new = x + step
        if not low < new < high:
            if abs(step) <= 1e-16 and step != 0.0:
                return x
            new = 0.5 * (low + high)
        if new == x or high - low <= 1e-16 * high:
            return x
        x = new
    return x


# ----------------------------------------------------------------------------------------------------------------------
# A regime: what each interface does until the next event, how fast it can be, and its flow as a power series.
# ----------------------------------------------------------------------------------------------------------------------


@kernel
def settle(system: System, state: State, scratch: ExactWorkspace) -> None:
    """Springs, dashpots and constant forces of the interfaces in the present regime."""
    for a in range(len(system.interfaces)):
        law = system.interfaces[a]
        scratch.spring[a], scratch.dash[a] = 0.0, 0.0
        if state.status[a] != CLOSED:
            scratch.held[a] = 0.0 if law["kind"] == LINK else -law["preload"]
            continue
        scratch.spring[a] = law["stiffness"]
        if law["kind"] == LINK:
            scratch.dash[a] = law["opening"] if scratch.direction[a] < 0 else law["closing"]
            scratch.held[a] = law["preload"] - law["stiffness"] * state.rest[a]
        else:
            scratch.dash[a] = law["closing"]
            # a preload is in balance with the indentation at rest
            scratch.held[a] = 0.0 if law["preload"] > 0.0 else law["stiffness"] * law["offset"]


@kernel
def fastest(system: System, scratch: ExactWorkspace) -> tuple[float, float]:
    """Bound of the rates [1/s] of a regime, the positive root of x^2 = c x + w^2; and w^2 [1/s^2].

    w^2 and c bound the stiffness and the damping over the coordinates of unit mass: the largest of the modes, and k
    row.row, c row.row of every interface that acts. In the norm max(|z|, |v| / x) the system's matrix is no larger
    than x, so that term p of its power series is below (x h)^p / p!.
    """
    stiffness, damping = system.reach[0], system.reach[1]
    for a in range(len(system.interfaces)):
        stiffness += scratch.spring[a] * system.mobility[a]
        damping += scratch.dash[a] * system.mobility[a]
    return float(0.5 * (damping + np.sqrt(damping * damping + 4.0 * stiffness))), stiffness


@kernel
def load_series(system: System, scratch: ExactWorkspace, t: float, h: float, order: int) -> None:
    """Power series of the loads over a step that no change of their formulas cuts."""
    m = len(system.interfaces)
    for i in range(len(system.loads)):
        load, out = system.loads[i], scratch.force[m + i]
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
def expand(system: System, state: State, rule: ExactRule, scratch: ExactWorkspace, h: float, order: int) -> None:
    """Power series of coordinates, rows and forces over a step of length h from the state, by the equations of motion.

    With y_k = k! z_k, the derivatives, no term is divided by anything: y_(k+2) = h^2 forces_k - (omega h)^2 y_k -
    damping h y_(k+1), and forces_k from the rows' own y_k and y_(k+1).
    """
    if len(system.turn):
        _expand_oscillators(system, state, rule, scratch, h, order)
        return
    n, m, r = len(system.omega), len(system.interfaces), len(system.rows)
    z, place, force, rows, sway, drag = scratch.z, scratch.place, scratch.force, system.rows, scratch.q, scratch.v
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
                push = square * scratch.spring[a] * place[a, k] + h * scratch.dash[a] * place[a, k + 1]
                if k == 0:
                    push += square * scratch.held[a]
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
    _from_derivatives(rule, scratch, m, 1.0 / h, order)


@summing
def _expand_oscillators(
    system: System, state: State, rule: ExactRule, scratch: ExactWorkspace, h: float, order: int
) -> None:
    """The same of oscillators in place of coupled modes, whose forces act on z' too: z and w = v are series alike."""
    n, m, r = len(system.omega), len(system.interfaces), len(system.rows)
    z, w, place, rate, force, rows, tilts = (
        scratch.z,
        scratch.w,
        scratch.place,
        scratch.rate,
        scratch.force,
        system.rows,
        system.tilts,
    )
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
                force[a, k] = scratch.spring[a] * here + scratch.dash[a] * speed
                if k == 0:
                    force[a, 0] += scratch.held[a]
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
def _from_derivatives(rule: ExactRule, scratch: ExactWorkspace, m: int, pace: float, order: int) -> None:
    """Power series from the derivatives of coordinates and rows; rates and forces from them.

    Parameters
    ----------
    pace : float
        1 / h.
    """
    z, place, rate, force = scratch.z, scratch.place, scratch.rate, scratch.force
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
            force[a, k] = scratch.spring[a] * place[a, k] + scratch.dash[a] * rate[a, k]
        force[a, 0] += scratch.held[a]


@kernel
def shorten(scratch: ExactWorkspace, order: int, part: float) -> None:
    """The series of a part of the step: the step ends there."""
    power = 1.0
    for k in range(1, order + 1):
        power *= part
        for i in range(scratch.z.shape[1]):
            scratch.z[k, i] *= power
        for i in range(scratch.w.shape[1]):
            scratch.w[k, i] *= power
        for a in range(len(scratch.place)):
            scratch.place[a, k] *= power
            scratch.rate[a, k] *= power
            scratch.force[a, k] *= power


@summing
def evaluate(scratch: ExactWorkspace, h: float, order: int, theta: float) -> None:
    """Coordinates and rates at a part of the step, into scratch.q and scratch.v."""
    z, w, q, v = scratch.z, scratch.w, scratch.q, scratch.v
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


# ----------------------------------------------------------------------------------------------------------------------
# What ends a regime: the first instant at which a contact or a one-way dashpot must change what it does.
#
# Every condition is a polynomial that must not become negative: minus the indentation of an open contact, the
# indentation or the force of a closed one, the speed of a link in the sense it has. A condition that is zero at the
# start of a step, by an event or by rounding, is decided by its first coefficient that is not; so is one that the next
# terms outgrow at once.
# ----------------------------------------------------------------------------------------------------------------------

INDENTATION, FORCE, SPEED, EXCESS = 0, 1, 2, 3  # what crossed zero; the first three are columns of fresh
DISPLACEMENT_ROUNDING = 4e-15  # of a row's displacement, relative to the terms it is summed from
STILL, MOVING, ROOT, NOISE, NOISE_RATE, SMALL, SMALL_RATE = 0, 1, 2, 3, 4, 5, 6  # columns of terms
AT_ONCE = 1e-20  # of a step: less than a place in it, or the time, can tell from its start


@kernel
def _outgrown(c: Floats, lead: int, order: int) -> bool:
    """Whether a later term is larger than the leading one already AT_ONCE after the start."""
    reach = AT_ONCE
    for k in range(lead + 1, order + 1):
        if abs(c[k]) * reach > abs(c[lead]):
            return True
        reach *= AT_ONCE
    return False


@kernel
def judge(c: Floats, order: int, noise: float, small: float, fresh: int, rule: ExactRule, boxes: Floats,
          spans: Floats) -> tuple[float, int]:  # fmt: skip
    """Where the polynomial becomes negative (NEVER: not in this step), and its leading order when that is at once.

    Parameters
    ----------
    noise : float
        Rounding of its value.
    small : float
        Of its other coefficients.
    fresh : int
        Whether it is zero by an event.
    """
    lead = 0
    if fresh or abs(c[0]) <= noise:
        lead = 1
        while lead <= order and abs(c[lead]) <= small:
            lead += 1
    remainder = magnitude(c, lead + 1, order)
    while lead <= order and abs(c[lead]) <= AT_ONCE * remainder and _outgrown(c, lead, order):
        lead += 1
        while lead <= order and abs(c[lead]) <= small:
            lead += 1
        remainder = magnitude(c, lead + 1, order)
    if lead > order:
        return NEVER, 0
    if c[lead] < 0.0:
        return 0.0, lead
    if c[lead] > remainder or stays_positive(c, lead, order, rule.coarse):
        return NEVER, 0
    return first_descent(c, lead, order, rule.bernstein, boxes, spans), order + 1


@kernel
def weigh_rounding(
    system: System, state: State, h: float, before: float, stiff: float, scratch: ExactWorkspace
) -> None:
    """What rounding leaves unknown of the interfaces in a step of length h, into scratch.terms.

    Parameters
    ----------
    before : float [s]
        The longer of this step and the last one, whose end is known to the rounding of its own series only.
    stiff : float [1/s]
        Of both, the stiffness over unit mass divided by the bound of the rates, w^2 / x. In a step, THETA / x at most,
        springs turn rounding of a displacement into THETA stiff times as much of a speed; dashpots give a speed THETA
        times its own at most, however fast they are.
    """
    shake = 0.0  # acceleration by the rounding of what springs and dashpots see: no contact closes or opens for it
    for a in range(len(system.interfaces)):
        still, moving = terms_of(system, a, state.z, state.v), terms_of_rate(system, a, state.z, state.v)
        scratch.terms[a, STILL], scratch.terms[a, MOVING], scratch.terms[a, ROOT] = (
            still,
            moving,
            np.sqrt(system.mobility[a]),
        )
        held = scratch.spring[a] * (still + before * moving + abs(system.interfaces[a]["offset"]))
        lost = scratch.dash[a] * (moving + 2.0 * stiff * still)
        shake += DISPLACEMENT_ROUNDING * scratch.terms[a, ROOT] * (held + lost)
    for a in range(len(system.interfaces)):
        still, moving = scratch.terms[a, STILL], scratch.terms[a, MOVING]
        noise = DISPLACEMENT_ROUNDING * (still + before * moving + abs(system.interfaces[a]["offset"]))
        noise_rate = DISPLACEMENT_ROUNDING * (moving + 2.0 * stiff * still)
        shaken = h * h * scratch.terms[a, ROOT] * shake
        scratch.terms[a, NOISE], scratch.terms[a, NOISE_RATE] = noise, noise_rate
        scratch.terms[a, SMALL] = DISPLACEMENT_ROUNDING * (4.0 * still + h * moving) + shaken
        scratch.terms[a, SMALL_RATE] = h * (2.0 * (stiff * noise + noise_rate)) + shaken


@kernel
def watch(
    system: System, state: State, order: int, h: float, rule: ExactRule, scratch: ExactWorkspace
) -> tuple[float, int, int]:
    """The first change in the step: where (NEVER: none), of which interface, and what crossed zero.

    Of several changes at one place the one with the lowest leading order comes first: the others depend on it.
    """
    where, rank, interface, what = NEVER, order + 2, -1, -1
    for a in range(len(system.interfaces)):
        for kind in range(4):
            if not _decides(system, state, a, kind):
                continue
            doubt, lesser = _condition(system, state, scratch, a, kind, order, h)
            fresh = 0 if kind == EXCESS else scratch.fresh[a, kind]
            at, order_here = judge(
                scratch.watched, order, doubt, lesser, fresh, rule=rule, boxes=scratch.boxes, spans=scratch.spans
            )
            if at < where or (at == where and at < NEVER and order_here < rank):
                where, rank, interface, what = at, order_here, a, kind
    return where, interface, what


@kernel
def _decides(system: System, state: State, a: int, kind: int) -> bool:
    """Whether an interface, as it is, changes when this condition does."""
    law, status = system.interfaces[a], state.status[a]
    if law["kind"] == LINK:  # its dashpot may differ by the sense of its speed
        return bool(kind == SPEED and status == CLOSED and law["closing"] != law["opening"])
    clamps = law["tensile"] == 0 and law["closing"] > 0.0
    if kind == INDENTATION:
        return bool(status != CLOSED or not clamps)
    if kind == FORCE:
        return bool(status != OPEN and clamps)
    return bool(kind == EXCESS and status == CLOSED and law["preload"] != 0.0)


@kernel
def _condition(
    system: System, state: State, scratch: ExactWorkspace, a: int, kind: int, order: int, h: float
) -> tuple[float, float]:
    """The polynomial that must not become negative, into scratch.watched; returns the rounding of its value and of its
    other coefficients."""
    law, c = system.interfaces[a], scratch.watched
    doubt, lesser = scratch.terms[a, NOISE], scratch.terms[a, SMALL]
    if kind == SPEED:
        by_place, by_rate, constant = 0.0, -h if scratch.direction[a] < 0 else h, 0.0
        doubt, lesser = h * scratch.terms[a, NOISE_RATE], scratch.terms[a, SMALL_RATE]
    elif kind == INDENTATION:
        by_place, by_rate = -1.0 if state.status[a] == OPEN else 1.0, 0.0
        constant = by_place * law["offset"]
    else:
        pushes = state.status[a] == CLOSED if kind == FORCE else scratch.here.loaded[a] > 0.0
        side = 1.0 if pushes else -1.0
        by_place, by_rate = side * law["stiffness"], side * law["closing"]
        doubt = law["stiffness"] * scratch.terms[a, NOISE] + law["closing"] * scratch.terms[a, NOISE_RATE]
        if kind == FORCE:
            constant = by_place * law["offset"]
            lesser = (law["stiffness"] + law["closing"] / h) * scratch.terms[a, SMALL]
        else:
            constant, doubt, lesser = max(PRELOAD * law["preload"], doubt), 0.0, 0.0
    for k in range(order + 1):
        c[k] = by_place * scratch.place[a, k] + by_rate * scratch.rate[a, k]
    c[0] += constant
    return doubt, lesser


@kernel
def switch(system: System, state: State, scratch: ExactWorkspace, a: int, what: int, before: float) -> None:
    """Let interface a do what follows from a condition at zero; its row is in scratch.here."""
    law = system.interfaces[a]
    if what != EXCESS:
        scratch.fresh[a, what] = 1
    if what == SPEED:
        scratch.direction[a] = 1 if scratch.direction[a] < 0 else -1
    elif what == EXCESS:
        scratch.here.loaded[a] = 1.0 - scratch.here.loaded[a]
    elif what == INDENTATION:
        state.status[a] = CLOSED if state.status[a] == OPEN else OPEN
    elif state.status[a] == CLOSED:
        depth = scratch.here.place[a] + law["offset"]
        margin = DISPLACEMENT_ROUNDING * (
            terms_of(system, a, state.z, state.v) + before * terms_of_rate(system, a, state.z, state.v) + law["offset"]
        )
        state.status[a] = CLAMPED if depth > margin else OPEN
    else:
        state.status[a] = CLOSED
    if law["kind"] != LINK:
        if state.status[a] != CLOSED:
            scratch.here.loaded[a] = 0.0
        elif law["preload"] == 0.0:
            scratch.here.loaded[a] = 1.0


# ----------------------------------------------------------------------------------------------------------------------
# Energies of a step from its polynomials, and the peaks of forces and indentations.
# ----------------------------------------------------------------------------------------------------------------------


@kernel
def integrate_step(
    system: System, state: State, h: float, order: int, rule: ExactRule, scratch: ExactWorkspace
) -> None:
    """Add what dashpots took and loads gave over a step, by Gauss's rule on the squares of polynomials."""
    m, k_modes = len(system.interfaces), system.n_modes
    lost, z, v = scratch.here.lost, scratch.z, scratch.v
    for a in range(m):
        law = system.interfaces[a]
        if state.status[a] == CLOSED and scratch.dash[a] > 0.0:
            for g in range(GAUSS):
                speed = value_of(scratch.rate[a], order, rule.at_nodes[g])
                lost[a] += h * rule.weights[g] * scratch.dash[a] * speed * speed
        elif state.status[a] == CLAMPED:  # the spring drives its own dashpot, without force to the outside
            for g in range(GAUSS):
                depth = value_of(scratch.place[a], order, rule.at_nodes[g]) + law["offset"]
                speed = value_of(scratch.rate[a], order, rule.at_nodes[g])
                lost[a] -= h * rule.weights[g] * law["stiffness"] * max(depth, 0.0) * speed
    for a in range(m, len(system.rows)):
        if scratch.force[a, 0] != 0.0 or scratch.force[a, 1] != 0.0:
            for g in range(GAUSS):
                force = value_of(scratch.force[a], order, rule.at_nodes[g])
                lost[m + WORK] += h * rule.weights[g] * force * value_of(scratch.rate[a], order, rule.at_nodes[g])
    if len(system.turn):
        _give(system, h, order, rule, scratch)
        return
    if system.reach[1] == 0.0:  # no mode has damping
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
def _give(system: System, h: float, order: int, rule: ExactRule, scratch: ExactWorkspace) -> None:
    """Add the work of all rows on coupled modes: their forces times their velocities, less those of the bodies."""
    m, k_modes, n = len(system.interfaces), system.n_modes, len(system.omega)
    for g in range(GAUSS):
        power = 0.0
        for a in range(len(system.rows)):
            force = system.sign[a] * value_of(scratch.force[a], order, rule.at_nodes[g])
            if force != 0.0:
                power += force * value_of(scratch.rate[a], order, rule.at_nodes[g])
                for i in range(k_modes, n):
                    if system.rows[a, i] != 0.0:
                        speed = 0.0
                        for k in range(order, -1, -1):
                            speed = speed * rule.nodes[g] + scratch.w[k, i]
                        power -= force * system.rows[a, i] * speed
        scratch.here.lost[m + GIVEN] += h * rule.weights[g] * power


@kernel
def peaks_of_step(system: System, state: State, t: float, h: float, order: int, rule: ExactRule,
                  scratch: ExactWorkspace, record: RunRecord) -> None:  # fmt: skip
    """Raise the largest force and indentation of each closed contact to those in the step."""
    for a in range(len(system.interfaces)):
        if system.interfaces[a]["kind"] == LINK or state.status[a] != CLOSED:
            continue
        preload, offset = system.interfaces[a]["preload"], system.interfaces[a]["offset"]
        depth, where = largest(scratch.place[a], record.deepest[a] - offset, order, rule, scratch.watched)
        if where >= 0.0:
            record.deepest[a] = depth + offset
        if scratch.dash[a] > 0.0:
            force, where = largest(scratch.force[a], record.peak[a, PEAK] - preload, order, rule, scratch.watched)
        else:  # the spring's force is largest where it is deepest
            force = scratch.spring[a] * depth + scratch.held[a]
        if where >= 0.0:
            record.peak[a, PEAK], record.peak[a, PEAK_AT] = force + preload, t + where * h


@kernel
def travels_of_step(system: System, order: int, rule: ExactRule, scratch: ExactWorkspace, record: RunRecord) -> None:
    """Raise the largest displacement of each body, either way, to that in the step."""
    path = scratch.boxes[0]
    for b in range(len(record.travel)):
        for k in range(order + 1):
            path[k] = scratch.z[k, system.n_modes + b]
        for _ in range(2):
            record.travel[b] = largest(path, record.travel[b], order, rule, scratch.watched)[0]
            for k in range(order + 1):
                path[k] = -path[k]


@kernel
def largest(c: Floats, known: float, order: int, rule: ExactRule, slope: Floats) -> tuple[float, float]:
    """Largest value of a polynomial on (0, 1) and where it is; -1 there when it is not above what is known.

    Bracketed, then where its slope is zero.

    Parameters
    ----------
    slope : Floats [order or more]
        Room.
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


# ----------------------------------------------------------------------------------------------------------------------
# The exact integration.
# ----------------------------------------------------------------------------------------------------------------------


class ExactSteps(NamedTuple):
    """How an integration chooses its steps. end [s]; interval [s] : of the samples, and the longest step while a load
    acts; longest [s] : the longest step, and how far apart ledger rows may be otherwise; max_steps : tried at most."""

    end: float
    interval: float
    longest: float
    max_steps: int


@unit(seconds=11.0)
def integrate_exactly(
    system: System, state: State, rule: ExactRule, scratch: ExactWorkspace, record: RunRecord, steps: ExactSteps
) -> int:
    """Run to the end; returns how it ended; when, and the numbers of ledger rows and events, are in record.ended.

    A record without samples keeps the first and the last ledger row only.
    """
    history, samples, here, end = record.history, len(record.at), scratch.here, steps.end
    _begin(system, state, scratch)
    initial = start_ledger(system, state, here, record)
    kept, n_events, kink, at_once = 1, 0, 0, 0
    t, last, before, earlier = 0.0, 0.0, 0.0, 0.0
    while t < end:
        how = may_continue(record, steps.max_steps)
        if how != DONE:
            return ended(record, how, t, kept, n_events)
        settle(system, state, scratch)
        kink = _next_kink(system, kink, t)
        limit = min(end, system.kinks[kink] * system.tick) if kink < len(system.kinks) else end
        acting, fastest_load = _acting(system, t + 0.5 * min(limit - t, steps.interval))
        bound, stiffness = fastest(system, scratch)
        bound = max(bound, fastest_load)
        stiff = stiffness / bound if bound > 0.0 else 0.0
        h = _length(limit - t, bound, min(steps.longest, steps.interval if acting else np.inf))
        order = _order(rule, bound * h)
        weigh_rounding(system, state, h, max(before, h), max(earlier, stiff), scratch)
        fresh = before == 0.0 or at_once > 0
        where, interface, what = _first_change(system, state, rule, scratch, order, t=t, h=h, fresh=fresh)
        part = min(where, 1.0)
        now = limit if where == NEVER and h == limit - t else t + part * h
        if now > t or part > 0.0:
            _keep_samples(state, scratch, record, order, t=t, now=now, h=h, interval=steps.interval)
            _take_step(system, state, rule, scratch, record, order, t=t, h=h, part=part)
            before, earlier = h, stiff
        at_once = at_once + 1 if now == t else 0
        if at_once > 100 + 10 * len(system.interfaces):
            return ended(record, STICKS, t, kept, n_events)
        _keep_late(t, now, system, state, record)
        t = now
        _look(system, state, scratch)
        if where < NEVER:
            switch(system, state, scratch, interface, what, before)
        _release(system, state, scratch, t)
        touching, changed = _touches(here, record)
        recorded, row = samples or changed or t >= end, history[kept]
        if recorded and not balance_ledger_row(t, initial, system, state, here, row, record):
            return ended(record, NO_FORCES, t, kept, n_events)
        record.totals[STEPS] += 1.0
        n_events = log_changes(t, system, state, here.loaded, row, n_events, record)
        if n_events == FULL:
            return ended(record, TOO_MANY_EVENTS, t, kept, len(record.events))
        busy = (acting or touching) and t - last >= steps.interval * (1.0 - 1e-9)
        if t >= end or (samples and (busy or t - last >= 0.5 * steps.longest)):
            store_row(kept, state, record)
            kept += 1
            last = t
    return ended(record, DONE, t, kept, settle_events(record, n_events, len(system.interfaces)))


@kernel
def _next_kink(system: System, kink: int, t: float) -> int:
    """Number of the first kink after t."""
    while kink < len(system.kinks) and system.kinks[kink] * system.tick <= t:
        kink += 1
    return kink


@kernel
def _acting(system: System, t: float) -> tuple[bool, float]:
    """Whether a load other than the weight of bodies pushes, and the fastest rate of those that do [1/s]."""
    acting, rate = False, 0.0
    for i in range(len(system.loads)):
        if system.loads[i]["kind"] != CONSTANT and load_at(system, i, t) != 0.0:
            acting = True
            if system.loads[i]["kind"] == HALF_SINE:
                rate = max(rate, 2.0 * np.pi * system.loads[i]["frequency"])
    return acting, rate


@kernel
def _length(left: float, bound: float, cap: float) -> float:
    """Length of the next step: all that is left, or half of it, or the longest that the bound of the rates allows."""
    if bound * cap > THETA:
        cap = THETA / bound
    if left <= cap:
        return left
    return cap if left > 2.0 * cap else 0.5 * left


@kernel
def _order(rule: ExactRule, turned: float) -> int:
    """Order of the power series of a step.

    Parameters
    ----------
    turned : float
        The bound of the rates times its length.
    """
    order = SHORT
    while order < ORDER and rule.reach[order] < turned:
        order += 1
    return order


@kernel
def _first_change(system: System, state: State, rule: ExactRule, scratch: ExactWorkspace, order: int, t: float,
                  h: float, fresh: bool) -> tuple[float, int, int]:  # fmt: skip
    """The series of a step, and the first change in it.

    Parameters
    ----------
    fresh : bool
        Whether something switched at this very instant, or the run begins: what then switches shows in the first terms,
        and most need no more of them.
    """
    first = fresh
    while True:
        terms = SHORT if first else order
        load_series(system, scratch, t, h, terms)
        expand(system, state, rule, scratch, h, terms)
        where, who, what = watch(system, state, terms, h, rule, scratch)
        if not first or where == 0.0:
            return where, who, what
        first = False


@kernel
def _keep_samples(state: State, scratch: ExactWorkspace, record: RunRecord, order: int, t: float, now: float, h: float,
                  interval: float) -> None:  # fmt: skip
    """Keep the states at all samples from t until now, from the series of the step of length h."""
    while record.kept[0] < len(record.at) and record.kept[0] * interval < now:
        s = record.kept[0]
        evaluate(scratch, h, order, (s * interval - t) / h)
        record.at[s], record.doublings[s] = s, 0
        copy_to(record.z[s], scratch.q)
        copy_to(record.v[s], scratch.v)
        for a in range(len(state.status)):
            record.status[s, a] = state.status[a]
        record.kept[0] += 1


@kernel
def _take_step(system: System, state: State, rule: ExactRule, scratch: ExactWorkspace, record: RunRecord, order: int,
               t: float, h: float, part: float) -> None:  # fmt: skip
    """Go to the end of a part of the step: what it dissipates, its peaks, events that count, and the state there."""
    if part < 1.0:
        shorten(scratch, order, part)
    integrate_step(system, state, part * h, order, rule, scratch)
    peaks_of_step(system, state, t, part * h, order, rule=rule, scratch=scratch, record=record)
    travels_of_step(system, order, rule, scratch, record)
    _confirm_step(system, state, order, rule, scratch, record)
    evaluate(scratch, part * h, order, 1.0)
    move_to(state.z, state.v, scratch.q, scratch.v)
    scratch.fresh[:] = 0


@kernel
def _keep_late(before: float, t: float, system: System, state: State, record: RunRecord) -> None:
    """Keep the rates at the end of the first step that reaches the tick late_at."""
    if record.late_at[0] >= 0 and before < record.late_at[0] * system.tick <= t:
        copy_to(record.late, state.v)


@kernel
def _touches(here: Standing, record: RunRecord) -> tuple[bool, bool]:
    """Whether a contact counts as closed, and whether one counts otherwise than at the last event."""
    touching, changed = False, False
    for a in range(len(here.loaded)):
        touching = touching or here.loaded[a] > 0.0
        changed = changed or here.loaded[a] != record.closed[a]
    return touching, changed


@kernel
def _begin(system: System, state: State, scratch: ExactWorkspace) -> None:
    """Preloaded contacts and links without a release time act, but for contacts whose dashpot would pull: their clamp
    holds; every other contact is open, touching or not, and closes at once when the leading derivative of its
    indentation says so."""
    scratch.here.lost[:] = 0.0
    scratch.here.loaded[:] = 0.0
    scratch.fresh[:] = 0
    for a in range(len(system.interfaces)):
        state.status[a] = OPEN
        if system.interfaces[a]["kind"] != LINK and system.interfaces[a]["preload"] > 0.0:
            state.status[a] = CLOSED
    _look(system, state, scratch)
    for a in range(len(system.interfaces)):
        law = system.interfaces[a]
        if state.status[a] == CLOSED and law["tensile"] == 0:
            force = law["stiffness"] * (scratch.here.place[a] + law["offset"]) + law["closing"] * scratch.here.rate[a]
            if force < 0.0:
                state.status[a] = CLAMPED
    _release(system, state, scratch, 0.0)


@kernel
def _look(system: System, state: State, scratch: ExactWorkspace) -> None:
    """Displacements and velocities of all rows."""
    for a in range(len(system.rows)):
        place, rate = 0.0, 0.0
        for i in range(len(state.z)):
            place += system.rows[a, i] * state.z[i]
            rate += system.rows[a, i] * state.v[i]
        for i in range(system.tilts.shape[1]):
            turning = system.omega[i] * system.omega[i] * state.z[i] + system.damping[i] * state.v[i]
            place += system.tilts[a, i] * state.v[i]
            rate -= system.tilts[a, i] * turning
        scratch.here.place[a], scratch.here.rate[a] = place, rate


@kernel
def _release(system: System, state: State, scratch: ExactWorkspace, t: float) -> None:
    """Links whose time has come act, from the elongation they have."""
    for a in range(len(system.interfaces)):
        law = system.interfaces[a]
        if law["kind"] == LINK and state.status[a] == OPEN and law["release"] * system.tick <= t:
            state.status[a], state.rest[a] = CLOSED, scratch.here.place[a]
            scratch.direction[a] = -1 if scratch.here.rate[a] < 0.0 else 1


@kernel
def _confirm_step(
    system: System, state: State, order: int, rule: ExactRule, scratch: ExactWorkspace, record: RunRecord
) -> None:
    """Let the events count whose contacts move beyond rounding in this step; scratch.terms has what they are summed
    from at its start."""
    for a in range(len(system.interfaces)):
        if system.interfaces[a]["kind"] == LINK:
            continue
        offset = system.interfaces[a]["offset"]
        record.size[a, OF_PLACE] = max(record.size[a, OF_PLACE], scratch.terms[a, STILL] + abs(offset))
        record.size[a, OF_SPEED] = max(record.size[a, OF_SPEED], scratch.terms[a, MOVING])
        if record.newest[a] >= 0:
            for p in range(1, PROBES + 1):
                place = value_of(scratch.place[a], order, rule.at_probes[p])
                record.size[a, OF_PLACE] = max(record.size[a, OF_PLACE], abs(place))  # these steps are long
                speed = value_of(scratch.rate[a], order, rule.at_probes[p])
                if confirm(system, state, a, place + offset, speed, record):
                    break


# ----------------------------------------------------------------------------------------------------------------------
# Which integration a scene takes: a pure function of its laws, its structure and its window.
# ----------------------------------------------------------------------------------------------------------------------

MOST_STEPS = 3000


def is_piecewise_linear(system: System, duration: float) -> bool:
    """Whether a system is piecewise linear and its exact integration, of THETA / (largest rate) a step, is no slower
    one.

    Every law must be linear in each of its states, every load a constant, a half-sine or straight lines that comes
    once, from t = 0 on. Scenes with blows go by collocation.

    Notes: a step of the exact integration costs 1.4 us with 2 modes when nothing is sampled; with all samples kept 2 to
    6 us up to 30 modes and 17 us with 98, whatever happens in it. One of collocation costs several times that, but it
    is as long as the forces allow, not the fastest mode, and an opening or a closing takes about 50 of them. Measured
    with 2, 12, 30 and 98 modes, a ball, a damper and a link, with all samples kept: the exact integration is 1.2 to 1.6
    times faster at 1350 of its steps and 2 to 4 times slower at 6350; a residual vector at 40 kHz that sets the step of
    a window of 0.5 s makes it ten times slower. Up to MOST_STEPS it is taken for its exactness where both take about as
    long.
    """
    laws = system.interfaces["straight"].all()
    loads = np.isin(system.loads["kind"], (CONSTANT, HALF_SINE, TABLE)).all()
    once = (system.loads["repeats"] == 1).all() and not system.loads["start"].any()
    waits = (system.interfaces["release"][system.interfaces["kind"] != LINK] > 0).any()
    if not (laws and loads and once) or waits or len(system.strikes):
        return False
    return largest_rate(system) * duration <= THETA * MOST_STEPS


def largest_rate(system: System) -> float:
    """Bound of the rates [1/s] with every law acting at once and every load."""
    law, mobility = system.interfaces, system.mobility[: len(system.interfaces)]
    stiffness = system.reach[0] + law["stiffness"] @ mobility
    damping = system.reach[1] + np.maximum(law["closing"], law["opening"]) @ mobility
    sines = system.loads[system.loads["kind"] == HALF_SINE]
    sine = 2.0 * np.pi * float(np.max(sines["frequency"], initial=0.0))
    return max(float(0.5 * (damping + np.sqrt(damping**2 + 4.0 * stiffness))), sine)
