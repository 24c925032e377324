"""One step of the modes under the forces of contacts and links, exact for polynomials through Gauss points."""

from __future__ import annotations

from functools import cache
from math import factorial
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from femstruct.arrays import Floats
from femstruct.compiled.kernels import Counts, Cube, Floats4, Floats5, Floats6, Matrix, Vector, kernel, summing
from femstruct.compiled.records import CONSTANT, HALF_SINE, LINK, System
from femstruct.laws.registry import force as force_of

# ----------------------------------------------------------------------------------------------------------------------
# Small full systems of equations, solved in place: a kernel makes no arrays, as a library would.
# ----------------------------------------------------------------------------------------------------------------------


@kernel
def solve_dense(matrix: Floats, right: Floats, size: int) -> bool:
    """Gauss elimination with row pivots of the first `size` rows and columns, in place; the answer is in `right`.
    False for a singular matrix."""
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


# ----------------------------------------------------------------------------------------------------------------------
# The collocation rule: forces as polynomials through Gauss points of a step, and what is known about them.
# ----------------------------------------------------------------------------------------------------------------------

STAGES = 8
POINTS = STAGES + 1  # the Gauss points and the end of the step
PLACES = STAGES + 2  # the start as well: where contacts are watched
TERMS = 20  # of the power series of a mode's response over a step with (omega + c) h <= 1
FINEST_HALVINGS = 36  # of the sampling interval: the resolution of event times
LONGEST_DOUBLINGS = 6  # of the sampling interval: the longest step


class Rule(NamedTuple):
    """Constants of Gauss collocation with `STAGES` points on the unit interval.

    nodes [s], weights [s]. at_start, at_end [s] : values of the polynomial there from its values at the nodes.
    top [s] : its last Legendre coefficient. left, right [s, s] : nodes of the first and second half.
    shift [p, s, s] : values at (theta_p + c_n) / 2. moments [m, p, s] : integrals of (theta_p - u)^m / m! l_n(u)
    from 0 to theta_p. slopes [s, s] : derivatives 0..s-1 at the start. ends [p] : the points theta_p.
    places [s + 2] : start, nodes, end. bernstein [s + 2, s + 2] : Bernstein coefficients from values at the places.
    barycentric [s + 2] : weights of interpolation at the places. lebesgue, node_polynomial : of that interpolation
    (norm of the operator; largest |product of distances|). pieces [i, s, s] : values at the nodes of part j of a
    step cut in 2^m parts, i = 2^m - 1 + j.
    """

    nodes: Vector
    weights: Vector
    at_start: Vector
    at_end: Vector
    top: Vector
    left: Matrix
    right: Matrix
    shift: Cube
    moments: Cube
    slopes: Matrix
    ends: Vector
    places: Vector
    bernstein: Matrix
    barycentric: Vector
    lebesgue: float
    node_polynomial: float
    pieces: Cube


@cache
def collocation_rule() -> Rule:
    """The rule with `STAGES` Gauss points.

    >>> rule = collocation_rule()
    >>> bool(np.isclose(rule.weights @ rule.nodes**9, 1 / 10, rtol=1e-14))
    True
    """
    s = STAGES
    x, w = legendre.leggauss(s)
    nodes, weights = (1.0 + x) / 2.0, w / 2.0
    # discrete orthogonality: Legendre coefficients from values at the nodes, without solving anything
    coefficients = (2.0 * np.arange(s) + 1.0)[:, None] * legendre.legvander(x, s - 1).T * weights

    def values(theta: Floats | list[float]) -> Floats:
        matrix: Floats = legendre.legvander(2.0 * np.asarray(theta) - 1.0, s - 1) @ coefficients
        return matrix

    slopes = np.stack(
        [2.0**j * np.array([legendre.legval(-1.0, legendre.legder(c, j)) for c in coefficients.T]) for j in range(s)]
    )
    ends = np.append(nodes, 1.0)
    xq, wq = legendre.leggauss(20)
    uq, wq = (1.0 + xq) / 2.0, wq / 2.0
    moments = np.zeros((TERMS, POINTS, s))
    for p, theta in enumerate(ends):
        basis = values(theta * uq)
        for m in range(TERMS):
            moments[m, p] = theta * (wq * (theta * (1.0 - uq)) ** m / factorial(m)) @ basis
    places = np.concatenate(([0.0], nodes, [1.0]))
    degree = PLACES - 1
    binomials = np.array([factorial(degree) // (factorial(i) * factorial(degree - i)) for i in range(PLACES)])
    shape = binomials * places[:, None] ** np.arange(PLACES) * (1.0 - places[:, None]) ** (degree - np.arange(PLACES))
    fine = np.linspace(0.0, 1.0, 4001)
    differences = places[:, None] - places
    np.fill_diagonal(differences, 1.0)
    products = np.prod(fine[:, None] - places, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        cardinal = products[:, None] / ((fine[:, None] - places) * differences.prod(axis=1))
    cardinal[~np.isfinite(cardinal)] = 0.0
    pieces = np.concatenate(
        [np.stack([values((j + nodes) / 2.0**m) for j in range(2**m)]) for m in range(LONGEST_DOUBLINGS + 1)]
    )
    return Rule(
        nodes=nodes,
        weights=weights,
        at_start=values([0.0])[0],
        at_end=values([1.0])[0],
        top=coefficients[-1],
        left=values(nodes / 2.0),
        right=values((1.0 + nodes) / 2.0),
        shift=np.stack([values((theta + nodes) / 2.0) for theta in ends]),
        moments=moments,
        slopes=slopes,
        ends=ends,
        places=places,
        bernstein=np.linalg.inv(shape).astype(np.float64),
        barycentric=1.0 / differences.prod(axis=1),
        lebesgue=float(np.abs(cardinal).sum(axis=1).max()),
        node_polynomial=float(np.abs(products).max()),
        pieces=pieces,
    )


# ----------------------------------------------------------------------------------------------------------------------
# Forces as they are at one instant: laws of contacts and links, loads, and the displacements they see.
# ----------------------------------------------------------------------------------------------------------------------

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
    if system.loads[i]["repeats"] > 1:
        last = min(int(np.floor(since / every)), system.loads[i]["repeats"] - 1)
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


# ----------------------------------------------------------------------------------------------------------------------
# What a step of one length does to every mode: exact for forces that are polynomials over the step.
#
# A step is tau 2^level long, so that each length is tabulated once. Long steps follow from short ones by doubling.
# ----------------------------------------------------------------------------------------------------------------------

FORMS = (STAGES + 2) * (STAGES + 3) // 2
SLOW = 6.0  # rate times step below which a remainder bounds what interpolation misses
MODES_AT_ONCE = 4000  # room for their responses: about 5 MB


class Tables(NamedTuple):
    """What is known of steps of every length, by level, of collocation by a rule.

    free [level, 2, n, q] : rows' displacements and velocities at the points from the modes' displacement, velocity;
    q = (row * POINTS + point) * 2 + (0 displacement, 1 velocity).
    forced [level, r, POINTS, 2, r, s] : from unit values of the rows' forces at the nodes.
    flow [level, 4, n] : modes over the step; push [level, 2, s, n] : by unit modal force at a node.
    loss [level, FORMS, n] : the energy a mode's dashpot takes, a quadratic form in start and nodal forces; none of
    oscillators in place of coupled modes, whose losses follow from where they are.
    stray [level, 2, n], stray_push [level, 2, s, r, r] : bounds of what interpolation at PLACES can miss of a row's
    displacement and velocity, per modal energy norm and per force derivative (the last of s: per largest force).
    """

    rule: Rule
    free: Floats4
    forced: Floats6
    flow: Cube
    push: Floats4
    loss: Cube
    stray: Cube
    stray_push: Floats5


def flows(omega: Floats, damping: Floats, t: Floats) -> Floats:
    """The 2 x 2 flows [x x0, x v0, v x0, v v0] of free oscillators over the times t: [4, n, len(t)], any damping.

    >>> flows(np.array([2.0]), np.array([0.0]), np.array([np.pi / 4])).ravel().round(12).tolist()
    [0.0, 0.5, -2.0, 0.0]
    """
    sigma, w = 0.5 * damping[:, None], omega[:, None]
    discriminant = (w - sigma) * (w + sigma)
    g = np.empty((len(omega), len(t)))
    rate = np.empty_like(g)
    kind = discriminant[:, 0]
    rings, still, creeps = kind > 0.0, kind == 0.0, kind < 0.0
    if rings.any():
        ringing, s = np.sqrt(discriminant[rings]), sigma[rings]
        decay, phase = np.exp(-s * t), ringing * t
        sine = np.sin(phase) / ringing
        g[rings], rate[rings] = decay * sine, decay * (np.cos(phase) - s * sine)
    if still.any():
        decay = np.exp(-sigma[still] * t)
        g[still], rate[still] = t * decay, decay * (1.0 - sigma[still] * t)
    if creeps.any():
        spread = np.sqrt(-discriminant[creeps])
        fast = sigma[creeps] + spread
        slow = w[creeps] * w[creeps] / fast
        rise = -np.expm1(-2.0 * spread * t) / (2.0 * spread)
        decay = np.exp(-slow * t)
        g[creeps], rate[creeps] = decay * rise, decay * (1.0 - fast * rise)
    out: Floats = np.empty((4, *g.shape))
    np.add(rate, damping[:, None] * g, out=out[0])
    out[1], out[3] = g, rate
    np.multiply(-w * w, g, out=out[2])
    return out


def tabulated(system: System, levels: int, rule: Rule) -> Tables:
    """The tables of all steps tick 2^level, level = 0 .. levels - 1."""
    n, r = len(system.omega), len(system.rows)
    forms = 0 if len(system.turn) else FORMS
    tables = Tables(
        rule=rule,
        free=np.empty((levels, 2, n, r * POINTS * 2)),
        forced=np.zeros((levels, r, POINTS, 2, r, STAGES)),
        flow=np.empty((levels, 4, n)),
        push=np.empty((levels, 2, STAGES, n)),
        loss=np.empty((levels, forms, n)),
        stray=np.empty((levels, 2, n)),
        stray_push=np.zeros((levels, 2, STAGES + 1, r, r)),
    )
    for first in range(0, n, MODES_AT_ONCE):
        _fill(system, tables, slice(first, min(first + MODES_AT_ONCE, n)))
    return tables


def _fill(system: System, tables: Tables, some: slice) -> None:
    """Fill in what some modes are, and add what they do to the rows."""
    omega, damping, rule = system.omega[some], system.damping[some], tables.rule
    below, lossy = _halvings_below(omega, damping, system.tick), tables.loss.shape[1] > 0
    seen = _rows_of(system, some)
    answers = _responses(seen, omega, damping)
    short = _series(omega, damping, system.tick * 0.5**below, rule, lossy)
    for level in range(-below, len(tables.flow)):
        h = system.tick * 2.0**level
        if level > -below:
            long = (omega + damping) * h > 1.0
            doubled = _doubled(omega[long], damping[long], 0.5 * h, rule, _of(short, long))
            short = _series(omega, damping, h, rule, lossy)
            for whole, part in zip(short, doubled, strict=True):
                whole[long] = part
        if level >= 0:
            _book(system, tables, level, some, short, seen, answers)
            _stray(system, tables, level, some, answers)


def _halvings_below(omega: Floats, damping: Floats, tick: float) -> int:
    """How often a tick is halved until the power series holds for every mode."""
    fastest = float(np.max(omega + damping, initial=0.0)) * tick
    return max(int(np.ceil(np.log2(fastest))), 0) if fastest > 0.0 else 0


class _Step(NamedTuple):
    """Of a step, by mode: responses x, v [n, POINTS, s] at the points to unit polynomials, and the loss as a form
    [n, s + 2, s + 2], [n, 0, 0] where it is not wanted."""

    x: Floats
    v: Floats
    form: Floats


def _of(step: _Step, which: NDArray[np.bool_]) -> _Step:
    return _Step(*(part[which] for part in step))


def _series(omega: Floats, damping: Floats, h: float, rule: Rule, lossy: bool) -> _Step:
    """A step of modes with (omega + damping) h <= 1, by power series; of others it says nothing."""
    fast = (omega + damping) * h > 1.0
    wh, ch = np.where(fast, 0.0, omega * h), np.where(fast, 0.0, damping * h)
    terms = np.empty((TERMS + 1, len(omega)))  # derivatives of the response to unit velocity, times h^(m - 1)
    terms[0], terms[1] = 0.0, 1.0
    for m in range(2, TERMS + 1):
        terms[m] = -ch * terms[m - 1] - wh * wh * terms[m - 2]
    moments = rule.moments.reshape(TERMS, -1)
    shape = (len(omega), POINTS, STAGES)
    x, v = (h * h * (terms[:-1].T @ moments)).reshape(shape), (h * (terms[1:].T @ moments)).reshape(shape)
    if not lossy:
        return _Step(x, v, np.empty((len(omega), 0, 0)))
    flow = flows(wh / h, ch / h, rule.nodes * h)
    rates = np.concatenate((np.moveaxis(flow[2:], 0, 2), v[:, :STAGES]), axis=2)
    weighted = rates * (ch[:, None] * rule.weights)[:, :, None]
    return _Step(x, v, np.swapaxes(weighted, 1, 2) @ rates)


def _doubled(omega: Floats, damping: Floats, h: float, rule: Rule, step: _Step) -> _Step:
    """A step of 2 h from one of h."""
    x, v, form = step
    flow = flows(omega, damping, rule.ends * h)[..., None]
    early_x, early_v = x @ rule.left, v @ rule.left
    late_x, late_v = (np.swapaxes(np.swapaxes(part, 0, 1) @ rule.shift, 0, 1) for part in (x, v))
    if form.size:
        whole = flows(omega, damping, np.array([h]))[..., 0]
        form = _doubled_form(form, whole, x[:, STAGES] @ rule.left, v[:, STAGES] @ rule.left, rule)
    x, v = flow[0] * early_x + flow[1] * early_v + late_x, flow[2] * early_x + flow[3] * early_v + late_v
    return _Step(x, v, form)


def _doubled_form(form: Floats, whole: Floats, x: Floats, v: Floats, rule: Rule) -> Floats:
    """The loss over both halves of a step, from that over one.

    Parameters
    ----------
    whole : Floats [4, n]
        Flow over a half, x, v [n, s] : what forces in the first half make of a mode at its end.
    """
    width = STAGES + 2
    first, second = np.zeros((width, width)), np.zeros((len(form), width, width))
    first[0, 0], first[1, 1], first[2:, 2:] = 1.0, 1.0, rule.left
    second[:, 0, :2], second[:, 1, :2] = whole[:2].T, whole[2:].T
    second[:, 0, 2:], second[:, 1, 2:], second[:, 2:, 2:] = x, v, rule.right
    both: Floats = first.T @ form @ first + np.swapaxes(second, 1, 2) @ form @ second
    return both


_Answers = list[tuple[Floats | None, Floats | None]]


class _Rows(NamedTuple):
    """What rows see of some coordinates, and how their forces act on these [r, n]: displacement = rows . z + tilts . v,
    velocity = swings . z + rates . v; a force adds kicks to z' and drives to v'."""

    rows: Floats
    tilts: Floats
    swings: Floats
    rates: Floats
    kicks: Floats
    drives: Floats


def _rows_of(system: System, some: slice) -> _Rows:
    """Of some coordinates; without coupled damping a row sees a displacement and acts on a velocity."""
    rows, none = system.rows[:, some], np.zeros((0, 0))
    if not len(system.turn):
        return _Rows(rows, none, none, rows, none, rows)
    tilts = system.tilts[:, some]
    swings, rates = -tilts * system.omega[some] ** 2, rows - tilts * system.damping[some]
    return _Rows(rows, tilts, swings, rates, system.kicks[:, some], system.drives[:, some])


def _book(system: System, tables: Tables, level: int, some: slice, step: _Step, seen: _Rows, answers: _Answers) -> None:
    """Write what is known of a step of some modes into the tables."""
    x, v, form = step
    flow = flows(system.omega[some], system.damping[some], tables.rule.ends * (system.tick * 2.0**level))
    n, r = len(x), len(system.rows)
    tables.flow[level, :, some] = flow[:, :, STAGES]
    tables.push[level, 0, :, some], tables.push[level, 1, :, some] = x[:, STAGES].T, v[:, STAGES].T
    if form.size:
        upper = np.triu_indices(STAGES + 2)
        tables.loss[level, :, some] = (form[:, upper[0], upper[1]] * np.where(upper[0] == upper[1], 1.0, 2.0)).T
    free = tables.free[level].reshape(2, len(system.omega), r, POINTS, 2)
    for start in range(2):  # from a displacement, from a velocity
        np.multiply(seen.rows.T[:, :, None], flow[start][:, None], out=free[start, some, :, :, 0])
        np.multiply(seen.rates.T[:, :, None], flow[2 + start][:, None], out=free[start, some, :, :, 1])
        if len(seen.tilts):
            free[start, some, :, :, 0] += seen.tilts.T[:, :, None] * flow[2 + start][:, None]
            free[start, some, :, :, 1] += seen.swings.T[:, :, None] * flow[start][:, None]
    for what, (by_x, by_v) in enumerate(answers):
        for weights, response in ((by_x, x), (by_v, v)):
            if weights is not None:
                sums = (weights.reshape(r * r, n) @ response.reshape(n, -1)).reshape(r, r, POINTS, STAGES)
                tables.forced[level, :, :, what] += np.moveaxis(sums * system.sign[:, None, None], 1, 2)


def _responses(seen: _Rows, omega: Floats, damping: Floats) -> _Answers:
    """What rows see of the response to each other's forces, displacement and velocity: weights [r, r, n] of x and of v,
    the displacement and velocity that a unit force gives an oscillator. A force on z' gives it v + c x and -w^2 x."""
    pairs = seen.rows[:, None] * seen.rows
    if not len(seen.tilts):
        return [(pairs, None), (None, pairs)]
    found: _Answers = []
    for at_z, at_v in ((seen.rows, seen.tilts), (seen.swings, seen.rates)):
        by_x = at_z[:, None] * (seen.drives + damping * seen.kicks) - at_v[:, None] * (omega**2 * seen.kicks)
        found.append((by_x, at_z[:, None] * seen.kicks + at_v[:, None] * seen.drives))
    return found


def _stray(system: System, tables: Tables, level: int, some: slice, answers: _Answers) -> None:
    """What interpolation at the places can miss: its remainder for slow modes, its norm for fast ones."""
    omega, damping, h, rule = system.omega[some], system.damping[some], system.tick * 2.0**level, tables.rule
    lagrange, cap = rule.node_polynomial / factorial(PLACES), 1.0 + rule.lebesgue
    z = (omega + damping) * h
    slow = z < SLOW
    period = np.divide(1.0, omega, out=np.full(len(omega), np.inf), where=omega > 0.0)
    with np.errstate(over="ignore"):
        remainder = lagrange * z ** (PLACES - 1)
        tables.stray[level, 0, some] = np.minimum(remainder * h, cap * np.minimum(h, period))
        tables.stray[level, 1, some] = np.minimum(remainder * z, cap)
    r = tables.stray_push.shape[-1]
    powers = np.empty((STAGES + 1, len(z)))  # from the highest down to the first
    powers[STAGES] = np.where(slow, z, 0.0)
    for j in range(STAGES, 0, -1):
        np.multiply(powers[j], powers[STAGES], out=powers[j - 1])
    fast = ~slow
    by_x = np.column_stack([lagrange * h * h * powers[1:].T, cap * fast * np.minimum(0.5 * h * h, 2.0 * period**2)])
    by_v = np.column_stack([lagrange * h * powers[:STAGES].T, cap * fast * np.minimum(h, 2.0 * period)])
    push = tables.stray_push[level]
    for what, weights in enumerate(answers):
        for sizes, bounds in zip(weights, (by_x, by_v), strict=True):
            if sizes is not None:
                push[what] += (np.abs(sizes).reshape(r * r, len(omega)) @ bounds).T.reshape(STAGES + 1, r, r)


# ----------------------------------------------------------------------------------------------------------------------
# The exact motion of the modes under forces that are polynomials over a step, given at its Gauss points.
# ----------------------------------------------------------------------------------------------------------------------


@kernel
def advance(level: int, system: System, tables: Tables, forces: Floats, z: Floats, v: Floats,
            work: Floats) -> float:  # fmt: skip
    """Move z, v over a step under forces at the nodes; returns the energy the damping took.

    Of oscillators in place of coupled modes it is 0: their losses follow from where they are
    (`femstruct.impact.energies.modal_energies`).

    Parameters
    ----------
    work : Floats [STAGES + 4, n]
        Room; the modal forces at the nodes are left in its first STAGES rows.
    """
    n = len(z)
    if len(system.turn):
        _advance_oscillators(level, system, tables, forces, z, v, work)
        return 0.0
    for j in range(STAGES):
        work[j] = 0.0
        for a in range(len(system.rows)):
            force = system.sign[a] * forces[a, j]
            if force != 0.0:
                for i in range(n):
                    work[j, i] += system.rows[a, i] * force
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
    move_to(z, v, work[basis], work[basis + 1])
    return taken


@kernel
def _advance_oscillators(level: int, system: System, tables: Tables, forces: Floats, z: Floats, v: Floats,
                         work: Floats) -> None:  # fmt: skip
    """The same where a force also acts on z': it gives v + c x in place of x, and -w^2 x in place of v."""
    n, flow, push = len(z), tables.flow[level], tables.push[level]
    place, rate, kick, drive = work[STAGES], work[STAGES + 1], work[STAGES + 2], work[STAGES + 3]
    for i in range(n):
        place[i] = flow[0, i] * z[i] + flow[1, i] * v[i]
        rate[i] = flow[2, i] * z[i] + flow[3, i] * v[i]
    for j in range(STAGES):
        for i in range(n):
            kick[i], drive[i] = 0.0, 0.0
        acting = 0
        for a in range(len(system.rows)):
            force = system.sign[a] * forces[a, j]
            if force != 0.0:
                acting += 1
                for i in range(n):
                    kick[i] += system.kicks[a, i] * force
                    drive[i] += system.drives[a, i] * force
        if acting:
            for i in range(n):
                x, y = push[0, j, i], push[1, j, i]
                place[i] += x * drive[i] + (y + system.damping[i] * x) * kick[i]
                rate[i] += y * drive[i] - system.omega[i] * system.omega[i] * x * kick[i]
    move_to(z, v, place, rate)


# ----------------------------------------------------------------------------------------------------------------------
# One step: forces of the closed contacts and links at the Gauss points, then the modes exactly.
#
# The modes respond exactly to forces that are polynomials over the step, so the only unknowns are the few interface
# forces at the Gauss points: displacement = free motion + compliance . forces, forces = law(displacement, velocity),
# solved by Newton. Gauss collocation: forces are good to order s, impulses and energy to order 2 s.
# ----------------------------------------------------------------------------------------------------------------------

NEWTON_STEPS = 12
SOLVED = 2e-14  # of the largest force of an interface: what Newton's method leaves of it
FAINT = 1e-30  # of the largest force: what is below it is not known better, as where a motion has hardly arrived
ROUGHLY = 1e-12  # what it may leave of it after its last step
EXTRAPOLATED = 6.0  # norm of the extrapolation of a force from the nodes to an end of the step, and 1 for its law there
LONGER = 2e-3  # of the error that is allowed: below it the next step may be longer


class StepTrial(NamedTuple):
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


def step_workspace(system: System) -> StepTrial:
    """Work space for one trial step."""
    r, m = len(system.rows), len(system.interfaces)
    return StepTrial(
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
def try_step(
    t: float, level: int, system: System, state: State, tables: Tables, trial: StepTrial, tolerance: float
) -> float:
    """Solve a step; returns its error over what is allowed, infinite when the forces were not found.

    The error of a force is what its polynomial misses of its law at both ends; what counts is the speed it would give
    the mass behind the row in the step, against the largest speed the row has had.
    """
    n, r, m = len(system.omega), len(system.rows), len(system.interfaces)
    h, rule, q = system.tick * float(1 << level), tables.rule, trial.q
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
def _interface_forces(level: int, system: System, state: State, tables: Tables, trial: StepTrial, count: int) -> bool:
    """Newton for the forces of the `count` active interfaces at the nodes; leaves place and rate of all rows."""
    forced, biggest = tables.forced[level], 0.0
    for a in range(len(system.rows)):
        if a < len(system.interfaces):
            biggest = max(biggest, abs(system.interfaces[a]["preload"]))
        for p in range(STAGES):
            biggest = max(biggest, abs(trial.forces[a, p]))
    for step in range(NEWTON_STEPS):
        _respond(forced, trial)
        if count == 0:
            return True
        worst = _misses(system, state, trial, count, biggest)
        if np.isnan(worst):
            return False
        if worst <= SOLVED:
            return True
        if step == NEWTON_STEPS - 1:
            return worst <= ROUGHLY or _lost_in_rounding(system.tick * float(1 << level), system, state, trial, count)
        _linearise(forced, trial, count)
        if not solve_dense(trial.jacobian, trial.residual, count * STAGES):
            return False
        for i in range(count):
            for p in range(STAGES):
                trial.forces[trial.active[i], p] += trial.residual[i * STAGES + p]
    return False


@kernel
def _respond(forced: Floats, trial: StepTrial) -> None:
    """Displacement and velocity of all rows at the points: free motion, and what the forces at the nodes add."""
    r = len(trial.forces)
    for a in range(r):
        for p in range(POINTS):
            x, v = trial.q[(a * POINTS + p) * 2], trial.q[(a * POINTS + p) * 2 + 1]
            for b in range(r):
                for j in range(STAGES):
                    x += forced[a, p, 0, b, j] * trial.forces[b, j]
                    v += forced[a, p, 1, b, j] * trial.forces[b, j]
            trial.place[a, p + 1], trial.rate[a, p + 1] = x, v


@kernel
def _misses(system: System, state: State, trial: StepTrial, count: int, biggest: float) -> float:
    """What the laws of the active interfaces ask for beyond the forces, into residual, with their slopes: the most
    that one misses of its largest force; nan where a law gives no number.

    Parameters
    ----------
    biggest : float
        Of all forces, what is far below it is not known better.
    """
    place, rate, slope, residual = trial.place, trial.rate, trial.slope, trial.residual
    worst = 0.0
    for i in range(count):
        a = trial.active[i]
        shift = -state.rest[a] if system.interfaces[a]["kind"] == LINK else system.interfaces[a]["offset"]
        held = 0.0 if system.interfaces[a]["kind"] == LINK else system.interfaces[a]["preload"]
        largest, miss = max(abs(system.interfaces[a]["preload"]), FAINT * biggest), 0.0
        for p in range(STAGES):
            f, slope[i, p, 0], slope[i, p, 1], _ = law(system, a, place[a, p + 1] + shift, rate[a, p + 1])
            residual[i * STAGES + p] = f - held - trial.forces[a, p]
            largest = max(largest, abs(f), abs(trial.forces[a, p]))
            miss = max(miss, abs(residual[i * STAGES + p]))
        if not np.isfinite(miss):
            return np.nan
        if largest > 0.0:
            worst = max(worst, miss / largest)
    return worst


@kernel
def _linearise(forced: Floats, trial: StepTrial, count: int) -> None:
    """The matrix of Newton's iteration: 1 less what a force changes of the others through the motion."""
    active, slope, jacobian = trial.active, trial.slope, trial.jacobian
    for i in range(count):
        for p in range(STAGES):
            for j in range(count):
                b = active[j]
                for s in range(STAGES):
                    jacobian[i * STAGES + p, j * STAGES + s] = -(
                        slope[i, p, 0] * forced[active[i], p, 0, b, s] + slope[i, p, 1] * forced[active[i], p, 1, b, s]
                    )
            jacobian[i * STAGES + p, i * STAGES + p] += 1.0


@kernel
def _lost_in_rounding(h: float, system: System, state: State, trial: StepTrial, count: int) -> bool:
    """Whether what Newton's method has left of the forces is no more than their rounding."""
    for i in range(count):
        miss = 0.0
        for p in range(STAGES):
            miss = max(miss, abs(trial.residual[i * STAGES + p]))
        if miss > _unknown(h, system, state, trial, trial.active[i]):
            return False
    return True


@kernel
def _unknown(h: float, system: System, state: State, trial: StepTrial, a: int) -> float:
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
def _error(t: float, h: float, system: System, state: State, rule: Rule, trial: StepTrial, tolerance: float) -> float:
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
