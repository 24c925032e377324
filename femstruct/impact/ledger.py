"""What is kept of a run while it goes on: samples, events, peak forces, and the energy ledger."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from femstruct.arrays import Floats
from femstruct.compiled.kernels import Counts, CountTable, Cube, Matrix, Vector, kernel, summing, unit
from femstruct.compiled.records import LINK, System
from femstruct.impact.motion import Motion, inner_tables
from femstruct.impact.propagation import (
    AWAY,
    CLAMPED,
    CLOSED,
    DISPLACEMENT_ROUNDING,
    OPEN,
    PLACES,
    POINTS,
    STAGES,
    Rule,
    State,
    Tables,
    Trial,
    copy_to,
    dot,
    law,
    load_at,
    net_force,
    rows_now,
    sense,
    terms_of,
)
from femstruct.impact.response import EnergyBalance, EnergyLedger
from femstruct.impact.scene import Scene
from femstruct.impact.system import Compiled
from femstruct.laws.registry import beside, spring
from femstruct.modal.coupled_damping import energies_of_states

# ----------------------------------------------------------------------------------------------------------------------
# The energy ledger: every term evaluated or integrated by itself, none a remainder.
# ----------------------------------------------------------------------------------------------------------------------

TIME, STRUCTURE, BODIES = 0, 1, 2  # columns of a ledger row; then stored [i], lost in modes, lost [i], work, blows
MODES, WORK, BROUGHT, GIVEN = 0, 1, 2, 3  # of what is integrated, behind the interfaces: by modes; by loads; by blows;
INTEGRATED = 4  # and what coupled modes had at the start and were given since


def ledger_width(system: System) -> int:
    """Columns of a ledger row."""
    return BODIES + len(system.omega) - system.n_modes + 2 * len(system.interfaces) + 3


@kernel
def potential(system: System, a: int, delta: float) -> float:
    """Energy of the spring of a contact at an indentation, none when it is open."""
    return spring(system, a, delta)[2] if delta > 0.0 else 0.0


@kernel
def stored(system: System, state: State, a: int, displacement: float) -> float:
    """Energy interface a holds, from zero at rest; a link's preload counts from the start, released or not."""
    stiffness, preload = system.interfaces[a]["stiffness"], system.interfaces[a]["preload"]
    if system.interfaces[a]["kind"] == LINK:
        held = 0.5 * preload * preload / stiffness if stiffness > 0.0 else 0.0
        if state.status[a] != CLOSED:
            return float(held)
        moved = displacement - state.rest[a]
        return float(held + 0.5 * stiffness * moved * moved + preload * moved)
    rest = system.interfaces[a]["offset"]
    delta = displacement + rest if state.status[a] != OPEN and state.status[a] != AWAY else 0.0
    if preload > 0.0:
        if delta > 0.0:
            return float(beside(system, a, rest, displacement))
        return float(-potential(system, a, rest) - preload * displacement)
    return potential(system, a, delta)


@kernel
def take_stock(t: float, system: System, state: State, place: Floats, lost: Floats, row: Floats) -> float:
    """Fill a ledger row; lost [m + INTEGRATED] holds what was integrated: by interface, then modes, work, what blows
    brought and what coupled modes were given. Returns the total: stored and dissipated less the work and the blows.

    Of coupled modes the row has what they were given, stored and lost together, until `part_energies` or
    `femstruct.impact.engine.modal_energies` parts it."""
    k, n, m = system.n_modes, len(system.omega), len(system.interfaces)
    structure = 0.0
    if len(system.turn):
        structure = lost[m + GIVEN]
    else:
        for i in range(k):
            structure += 0.5 * (state.v[i] ** 2 + (system.omega[i] * state.z[i]) ** 2)
    row[TIME], row[STRUCTURE] = t, structure
    total = structure
    for i in range(k, n):
        row[BODIES + i - k] = 0.5 * state.v[i] ** 2
        total += row[BODIES + i - k]
    at = BODIES + n - k
    for a in range(m):
        row[at + a] = stored(system, state, a, place[a])
        row[at + m + 1 + a] = lost[a]
        total += row[at + a] + lost[a]
    row[at + m] = lost[m + MODES]
    row[at + 2 * m + 1], row[at + 2 * m + 2] = lost[m + WORK], lost[m + BROUGHT]
    return float(total + lost[m + MODES] - lost[m + WORK] - lost[m + BROUGHT])


@summing
def modal_energies(system: System, state: State) -> tuple[float, float]:
    """Energy of coupled modes as they are, and what they would lose from now on: the same, told in two ways."""
    k, held, surplus, moving = system.n_modes, 0.0, 0.0, 0
    for j in range(k):
        if state.z[j] != 0.0 or state.v[j] != 0.0:
            moving += 1
    if moving == 0:
        return 0.0, 0.0
    for i in range(len(system.modes)):
        place, speed = 0.0, 0.0
        for j in range(k):
            place += system.turn[0, i, j] * state.z[j] + system.turn[1, i, j] * state.v[j]
            speed += system.turn[2, i, j] * state.z[j] + system.turn[3, i, j] * state.v[j]
        held += 0.5 * ((system.modes[i] * place) ** 2 + speed * speed)
    for i in range(2 * k):
        if len(system.surplus) == 0:
            surplus += 0.5 * (system.misses[i] * (state.z[i] if i < k else state.v[i - k])) ** 2
            continue
        more = 0.0
        for j in range(k):
            more += system.surplus[i, j] * state.z[j] + system.surplus[i, k + j] * state.v[j]
        surplus += 0.5 * more * (state.z[i] if i < k else state.v[i - k])
    return held, held + surplus


@kernel
def part_energies(system: System, state: State, row: Floats) -> float:
    """Part what coupled modes were given, in a ledger row, into what they have and what they lost; returns by how much
    the row's total changes. Without coupled modes it is parted already."""
    if len(system.turn) == 0:
        return 0.0
    held, lasting = modal_energies(system, state)
    lost_at = BODIES + len(system.omega) - system.n_modes + len(system.interfaces)
    row[lost_at] = row[STRUCTURE] - lasting
    row[STRUCTURE] = held
    return float(held - lasting)


@kernel
def integrate_losses(h: float, system: System, state: State, rule: Rule, trial: Trial, lost: Floats) -> None:
    """Add what dashpots took and loads gave over a step, by Gauss quadrature at its nodes."""
    m = len(system.interfaces)
    for a in range(m):
        status = state.status[a]
        if status == CLOSED:
            for p in range(STAGES):
                speed = trial.rate[a, p + 1]
                damping = law(system, a, trial.place[a, p + 1] + system.interfaces[a]["offset"], speed)[3]
                lost[a] += h * rule.weights[p] * damping * speed * speed
        elif status == CLAMPED:  # the spring drives its own dashpot, without force to the outside
            for p in range(STAGES):
                delta = max(trial.place[a, p + 1] + system.interfaces[a]["offset"], 0.0)
                lost[a] -= h * rule.weights[p] * spring(system, a, delta)[0] * trial.rate[a, p + 1]
    for a in range(m, len(system.rows)):
        for p in range(STAGES):
            lost[m + WORK] += h * rule.weights[p] * trial.forces[a, p] * trial.rate[a, p + 1]
    if len(system.turn):
        lost[m + GIVEN] += _given(h, system, state, rule, trial)


@kernel
def _given(h: float, system: System, state: State, rule: Rule, trial: Trial) -> float:
    """Work of all rows on the structure in a step: their forces times their velocities, less those of the bodies.

    A body moves by itself: its velocity at a node is the integral of the forces until then.
    """
    total, k = 0.0, system.n_modes
    for p in range(STAGES):
        power = 0.0
        for a in range(len(system.rows)):
            power += system.sign[a] * trial.forces[a, p] * trial.rate[a, p + 1]
        for i in range(k, len(system.omega)):
            push, speed = 0.0, state.v[i]
            for a in range(len(system.rows)):
                weight = system.sign[a] * system.rows[a, i]
                if weight != 0.0:
                    push += weight * trial.forces[a, p]
                    for s in range(STAGES):
                        speed += h * rule.moments[0, p, s] * weight * trial.forces[a, s]
            power -= push * speed
        total += h * rule.weights[p] * power
    return total


def balance(row: Floats, scene: Scene, compiled: Compiled) -> EnergyBalance:
    """A ledger row with names."""
    system = compiled.system
    m, at = len(system.interfaces), BODIES + len(scene.bodies)
    held, lost = row[at : at + m], row[at + m + 1 : at + 2 * m + 1]
    return EnergyBalance(
        t=float(row[TIME]),
        bodies={body.name: float(row[BODIES + i]) for i, body in enumerate(scene.bodies)},
        structure=float(row[STRUCTURE]),
        contacts={name: float(sum(held[a] for a in rows)) for name, rows in compiled.contacts.items()},
        links={name: float(held[a]) for name, a in compiled.links.items()},
        lost_modes=float(row[at + m]),
        lost_contacts={name: float(sum(lost[a] for a in rows)) for name, rows in compiled.contacts.items()},
        lost_links={name: float(lost[a]) for name, a in compiled.links.items()},
        work=float(row[at + 2 * m + 1]),
        blows=float(row[at + 2 * m + 2]),
    )


def ledger(
    history: Floats, separation: Floats | None, largest_work: float, residual: float, scene: Scene, compiled: Compiled
) -> EnergyLedger:
    """The ledger of a run from its rows: first and last are its start and end.

    residual [J] : largest change of the total; largest_work [J] : largest |work| + |energy brought by blows|.
    """
    m, at = len(compiled.system.interfaces), BODIES + len(scene.bodies)
    lost = history[:, at + m + 1 : at + 2 * m + 1]
    start, end = balance(history[0], scene, compiled), balance(history[-1], scene, compiled)
    scale = max(abs(start.total), largest_work)
    return EnergyLedger(
        start=start,
        at_separation=None if separation is None else balance(separation, scene, compiled),
        end=end,
        t=history[:, TIME].copy(),
        bodies={body.name: history[:, BODIES + i].copy() for i, body in enumerate(scene.bodies)},
        structure=history[:, STRUCTURE].copy(),
        stored=history[:, at : at + m].sum(axis=1),
        lost_modes=history[:, at + m].copy(),
        lost_contacts={name: lost[:, rows].sum(axis=1) for name, rows in compiled.contacts.items()},
        lost_links={name: lost[:, a].copy() for name, a in compiled.links.items()},
        work=history[:, at + 2 * m + 1].copy(),
        blows=history[:, at + 2 * m + 2].copy(),
        residual=residual / scale if scale > 0.0 else 0.0,
    )


# ----------------------------------------------------------------------------------------------------------------------
# What is kept of a run: states that its samples follow from, peak forces, ledger rows, events.
# ----------------------------------------------------------------------------------------------------------------------

MOST_EVENTS = 500_000
STEPS, TRIALS, DRIFT, WORKED = 0, 1, 2, 3  # columns of Record.totals
WHEN, ROWS, EVENTS = 0, 1, 2  # and of Record.ended


class Record(NamedTuple):
    """What is kept of a run.

    at, doublings [s], z, v [s, n], status [s, m] : the states of the coordinates and interfaces at samples that are
    starts of steps, and the steps' lengths: see `femstruct.impact.motion`. forces, pushed [l] : what acts
    over the steps of more than one sample. kept : numbers of these states and steps. A record of no samples keeps
    none.
    peak [m, 2] : force and its time; deepest [m] : indentation; shortest [m] : least time from closing to
    opening [s].
    totals : STEPS, TRIALS, DRIFT, the largest |total - start|, and WORKED, the largest |work| + |brought by blows|;
    closed [m] : whether each contact counts as closed. history : ledger rows; events : interface, what, whether all are
    open then, whether it counts (see `femstruct.impact.ledger`); event_rows : their ledger rows. newest [m] :
    the last event of each contact while it does not count, else -1; size [m, 2] : the most that its displacement and
    speed were summed from. strikes [s, 4] : of every blow (see `femstruct.impact.ledger`); latest [m] : number
    of the last blow of a body at an interface, -1 before any; strike_peak [s + 1, m, 2] : peaks after every blow, in
    the last row before any.
    late [n] : the rates at the end of the first step that reaches the tick late_at [1], negative for none.
    rows_z, rows_v [rows, k] : where oscillators in place of coupled modes are at the ledger rows, else empty.
    moments [r, cells + 2] : of what pushes, on a grid of times `spacing` [1] s apart, where it is asked for, else of no
    columns; shares [STAGES] : room for them.
    stop [1] : not zero when the march shall end at once. ended : WHEN [s], ledger ROWS, EVENTS.
    """

    at: Counts
    doublings: Counts
    z: Matrix
    v: Matrix
    status: CountTable
    forces: Cube
    pushed: Counts
    kept: Counts
    peak: Matrix
    deepest: Vector
    shortest: Vector
    travel: Vector
    totals: Vector
    closed: Vector
    history: Matrix
    events: CountTable
    event_rows: Matrix
    newest: Counts
    size: Matrix
    strikes: Matrix
    latest: Counts
    strike_peak: Cube
    late_at: Counts
    late: Vector
    rows_z: Matrix
    rows_v: Matrix
    moments: Matrix
    spacing: Vector
    shares: Vector
    stop: Counts
    ended: Vector


def room_for(system: System, n_samples: int) -> Record:
    """Empty records of a run; memory is touched only where something is written.

    The history takes at most a row a sample while a contact is closed or a load acts, 2048 more, and two a blow.
    """
    blows = len(system.strikes)
    n, m, width = len(system.omega), len(system.interfaces), ledger_width(system)
    longs, rows = n_samples // 2 + 1, n_samples + 2100 + 2 * blows
    coupled = (rows, system.n_modes) if len(system.turn) else (0, 0)
    return Record(
        at=np.empty(n_samples, dtype=np.int64),
        doublings=np.empty(n_samples, dtype=np.int64),
        z=np.empty((n_samples, n)),
        v=np.empty((n_samples, n)),
        status=np.empty((n_samples, m), dtype=np.int64),
        forces=np.empty((longs, len(system.rows), STAGES)),
        pushed=np.empty(longs, dtype=np.int64),
        kept=np.zeros(2, dtype=np.int64),
        peak=np.zeros((m, 2)),
        deepest=np.zeros(m),
        shortest=np.full(m, np.inf),
        travel=np.zeros(n - system.n_modes),
        totals=np.zeros(4),
        closed=np.zeros(m),
        history=np.empty((rows, width)),
        events=np.empty((MOST_EVENTS, 4), dtype=np.int64),
        event_rows=np.empty((MOST_EVENTS, width)),
        newest=np.full(m, -1, dtype=np.int64),
        size=np.zeros((m, 2)),
        strikes=np.zeros((blows, 4)),
        latest=np.full(m, -1, dtype=np.int64),
        strike_peak=np.zeros((blows + 1, m, 2)),
        late_at=np.full(1, -1, dtype=np.int64),
        late=np.zeros(n),
        rows_z=np.empty(coupled),
        rows_v=np.empty(coupled),
        moments=np.zeros((len(system.rows), 0)),
        spacing=np.ones(1),
        shares=np.zeros(STAGES),
        stop=np.zeros(1, dtype=np.int64),
        ended=np.zeros(3),
    )


@kernel
def keep(index: int, doublings: int, state: State, trial: Trial, record: Record) -> None:
    """Keep the state at a sample, the start of a step of 2^doublings samples, or of less than two for 0."""
    s, long = record.kept[0], record.kept[1]
    record.at[s], record.doublings[s] = index, doublings
    copy_to(record.z[s], state.z)
    copy_to(record.v[s], state.v)
    for a in range(len(state.status)):
        record.status[s, a] = state.status[a]
    record.kept[0] += 1
    if doublings > 0:
        record.pushed[long] = 0
        for i in range(trial.forces.shape[0]):
            for j in range(trial.forces.shape[1]):
                record.forces[long, i, j] = trial.forces[i, j]
                if trial.forces[i, j] != 0.0:
                    record.pushed[long] = 1
        record.kept[1] += 1


def motion_of(
    record: Record, system: System, halvings: int, rule: Rule, tables: Tables, turn: Floats | None = None
) -> Motion:
    """The motion that a record holds; turn : of coupled modes, as the motion has it."""
    states, longs = int(record.kept[0]), int(record.kept[1])
    doublings, pushed = record.doublings[:states].copy(), record.pushed[:longs].copy()
    free, forced = inner_tables(system, halvings, rule, tables, doublings[doublings > 0], pushed)
    return Motion(
        at=record.at[:states].copy(),
        doublings=doublings,
        z=record.z[:states],  # what is behind was never touched: it takes no memory
        v=record.v[:states],
        acts=system.sign[:, None] * (system.drives if len(system.turn) else system.rows),
        forces=record.forces[:longs].copy(),
        pushed=pushed,
        free=free,
        forced=forced,
        n_samples=len(record.at),
        turn=np.zeros((4, 0, 0)) if turn is None else turn,
        kicks=system.sign[:, None] * system.kicks if len(system.turn) else system.kicks,
        omega=system.omega,
        damping=system.damping,
    )


@kernel
def ended(record: Record, how: int, when: float, rows: int, events: int) -> int:
    """Note how a march ended."""
    record.ended[WHEN], record.ended[ROWS], record.ended[EVENTS] = when, rows, events
    return how


class Felt(NamedTuple):
    """Displacement and speed of the interfaces at the samples, place, rate [m, nt]; force [m, nt] : as it is felt;
    push [r, nt] : of all rows, as they push the rest."""

    place: Matrix
    rate: Matrix
    force: Matrix
    push: Matrix


@unit(seconds=1.0)
def feel(system: System, state: State, halvings: int, record: Record, out: Felt) -> int:
    """Fill in the forces at the samples. state : at the end; its status is changed on the way."""
    m, nt = out.place.shape
    for s in range(record.kept[0]):
        for a in range(m):
            state.status[a] = record.status[s, a]
        for a in range(m):
            link, acts = system.interfaces[a]["kind"] == LINK, state.status[a] == CLOSED
            net = net_force(system, state, a, 0.0, 0.0)  # while nothing acts, wherever the ends are
            for j in range(record.at[s], record.at[s] + (1 << record.doublings[s])):
                if acts:
                    net = net_force(system, state, a, out.place[a, j], out.rate[a, j])
                out.force[a, j] = net if link else net + system.interfaces[a]["preload"]
                out.push[a, j] = system.sign[a] * net
    for i in range(len(system.loads)):
        for j in range(nt):
            out.push[m + i, j] = system.sign[m + i] * load_at(system, i, (j << halvings) * system.tick)
    return int(nt)


@kernel
def peaks_at_start(system: System, state: State, place: Floats, rate: Floats, record: Record) -> None:
    for a in range(len(system.interfaces)):
        if system.interfaces[a]["kind"] != LINK and state.status[a] == CLOSED:
            record.peak[a, 0] = max(0.0, law(system, a, place[a] + system.interfaces[a]["offset"], rate[a])[0])


@kernel
def peaks(t: float, h: float, system: System, state: State, rule: Rule, trial: Trial, record: Record) -> None:
    """Largest force of each contact from the polynomials of the step: bracketed on the nodes, then golden section."""
    for a in range(len(system.interfaces)):
        if system.interfaces[a]["kind"] == LINK or state.status[a] != CLOSED:
            continue
        for p in range(PLACES):
            record.deepest[a] = max(record.deepest[a], trial.place[a, p] + system.interfaces[a]["offset"])
        largest, at = -np.inf, 0
        for p in range(STAGES):
            if trial.forces[a, p] > largest:
                largest, at = trial.forces[a, p], p
        start, end = 0.0, 0.0
        for p in range(STAGES):
            start += rule.at_start[p] * trial.forces[a, p]
            end += rule.at_end[p] * trial.forces[a, p]
        largest = max(largest, start, end) + system.interfaces[a]["preload"]
        if largest < 0.9 * record.peak[a, 0]:
            continue
        rising, falling = 0.0, 0.0  # slopes at the end and at the start
        for p in range(STAGES):
            rising -= rule.slopes[1, STAGES - 1 - p] * trial.forces[a, p]
            falling += rule.slopes[1, p] * trial.forces[a, p]
        if (at == STAGES - 1 and rising >= 0.0) or (at == 0 and falling <= 0.0):
            if largest > record.peak[a, 0]:
                record.peak[a, 0], record.peak[a, 1] = largest, t + h if at else t
            continue
        low, high = rule.places[at], rule.places[at + 2]
        golden = 0.6180339887498949
        for _ in range(45):
            left, right = high - golden * (high - low), low + golden * (high - low)
            if _polynomial(trial.forces[a], left, rule) > _polynomial(trial.forces[a], right, rule):
                high = right
            else:
                low = left
        place = 0.5 * (low + high)
        force = _polynomial(trial.forces[a], place, rule) + system.interfaces[a]["preload"]
        for value, where in (
            (force, place),
            (start + system.interfaces[a]["preload"], 0.0),
            (end + system.interfaces[a]["preload"], 1.0),
        ):
            if value > record.peak[a, 0]:
                record.peak[a, 0], record.peak[a, 1] = value, t + where * h


@kernel
def travels(h: float, system: System, state: State, rule: Rule, trial: Trial, record: Record) -> None:
    """Largest displacement of each body in the step: at its nodes and end, and at the vertex of the cubic between."""
    for b in range(len(record.travel)):
        i = system.n_modes + b
        x, v, before, most = state.z[i], state.v[i], 0.0, record.travel[b]
        for p in range(POINTS):
            theta = rule.ends[p]
            place, rate = state.z[i] + theta * h * state.v[i], state.v[i]
            for a in range(len(system.rows)):
                weight = system.sign[a] * system.rows[a, i]
                if weight != 0.0:
                    for s in range(STAGES):
                        place += h * h * rule.moments[1, p, s] * weight * trial.forces[a, s]
                        rate += h * rule.moments[0, p, s] * weight * trial.forces[a, s]
            most = max(most, abs(place))
            if v * rate < 0.0:
                span = (theta - before) * h
                part = v / (v - rate)  # where the speed changes sign, were it straight
                least = x + span * part * (v + 0.5 * part * (rate - v))
                most = max(most, abs(least))
            x, v, before = place, rate, theta
        record.travel[b] = most


@kernel
def _polynomial(values: Floats, theta: float, rule: Rule) -> float:
    """Lagrange's form through the Gauss nodes."""
    top, bottom = 0.0, 0.0
    for i in range(STAGES):
        distance = theta - rule.nodes[i]
        if distance == 0.0:
            return float(values[i])
        # barycentric weights of the places without both ends
        weight = rule.barycentric[i + 1] * (rule.nodes[i]) * (rule.nodes[i] - 1.0) / distance
        top += weight * values[i]
        bottom += weight
    return top / bottom


# ----------------------------------------------------------------------------------------------------------------------
# Blows: a body is lifted off and given its starting state again, between two steps.
#
# What it takes along (its motion, the energy of the contacts it is lifted off) and what it brings is booked by itself.
# ----------------------------------------------------------------------------------------------------------------------

ENERGY, MOMENTUM, HELD, SINCE = 0, 1, 2, 3  # columns of a strike in the record
REST_FORCE_ERROR = 0.1  # of its weight: what the contact force under a body that lies still may miss


@kernel
def lies(force: float, weight: float) -> bool:
    """Whether a body under gravity lay still on a contact of this force when it was lifted off."""
    return abs(force - weight) <= REST_FORCE_ERROR * weight


@kernel
def touch(system: System, state: State, a: int, place: float, rate: float, margin: float) -> None:
    """Status of a contact whose ends were just put where they are: it closes when it is indented, or when it touches
    and its ends approach; touching without speed it is open until the leading derivative closes it."""
    delta = place + system.interfaces[a]["offset"]
    if not (delta > margin or (delta >= -margin and rate > 0.0)):
        state.status[a] = OPEN
    elif delta > margin and system.interfaces[a]["tensile"] == 0 and law(system, a, delta, rate)[0] < 0.0:
        state.status[a] = CLAMPED
    else:
        state.status[a] = CLOSED


@kernel
def first_strike(system: System, number: int, state: State, record: Record) -> None:
    """Book a blow at t = 0: it is the start itself, its energy is that of the start."""
    coordinate = system.strikes[number]["coordinate"]
    record.strikes[number, ENERGY] = 0.5 * state.v[coordinate] ** 2
    record.strikes[number, MOMENTUM] = state.v[coordinate]
    for a in range(len(system.interfaces)):
        if system.rows[a, coordinate] != 0.0:
            record.latest[a] = number


@kernel
def strike(now: float, t: int, number: int, system: System, state: State, place: Floats, rate: Floats, loaded: Floats,
           closed_at: Floats, lost: Floats, record: Record) -> None:  # fmt: skip
    """Lift a body off and let it strike again; place and rate of all rows are renewed.

    Peaks since the last blow go to the record of that blow, and begin again.
    """
    m, i = len(system.interfaces), system.strikes[number]["coordinate"]
    mine = record.strikes[number]
    mine[ENERGY] = -0.5 * state.v[i] ** 2
    for a in range(m):
        if system.rows[a, i] != 0.0:
            mine[ENERGY] -= stored(system, state, a, place[a])
            if loaded[a] > 0.0:
                mine[HELD] = max(mine[HELD], net_force(system, state, a, place[a], rate[a]))
                mine[SINCE] = closed_at[a]
            copy_to(record.strike_peak[record.latest[a], a], record.peak[a])
            record.peak[a] = 0.0
            record.latest[a] = number
    mine[MOMENTUM] = -state.v[i]
    over = system.strikes[number]["over"]
    below = dot(system.over[over], state.z)
    if len(system.over_tilts):
        below += dot(system.over_tilts[over], state.v)
    state.z[i] = below
    state.v[i] = system.strikes[number]["velocity"]
    mine[MOMENTUM] += state.v[i]
    mine[ENERGY] += 0.5 * state.v[i] ** 2
    rows_now(system, state.z, state.v, place, rate)
    for a in range(m):
        state.pace[a] = max(state.pace[a], abs(rate[a]))
        if system.rows[a, i] != 0.0 and system.interfaces[a]["kind"] != LINK and system.interfaces[a]["release"] <= t:
            margin = DISPLACEMENT_ROUNDING * terms_of(system, a, state.z, state.v)
            touch(system, state, a, place[a], rate[a], margin)
            mine[ENERGY] += stored(system, state, a, place[a])
            loaded[a] = 1.0 if state.status[a] == CLOSED else 0.0
            if loaded[a] > 0.0:
                closed_at[a] = now
                force = law(system, a, place[a] + system.interfaces[a]["offset"], rate[a])[0]
                record.peak[a, 0], record.peak[a, 1] = force, now
    lost[m + BROUGHT] += mine[ENERGY]


# ----------------------------------------------------------------------------------------------------------------------
# Which closings and openings count: those that lead farther than displacements are known.
#
# A contact that grazes opens and closes for rounding, and one that decays does so for ever: how often depends on the
# march. So an event counts when, before its contact's next one, the indentation after a closing or the gap after an
# opening exceeds RESOLVED of what the displacement was summed from so far. The others are not reported.
# ----------------------------------------------------------------------------------------------------------------------

OPENS, CLOSES = 0, 1
DOUBTFUL, CERTAIN, LIFTED = 0, 1, 2  # an event within rounding so far; beyond it; of a body that was lifted off
RESOLVED = 1e-12  # of the terms a displacement is summed from: 1e-16 of them a step, grown over thousands of steps


@kernel
def log_event(record: Record, count: int, a: int, what: int, counts: int, row: Floats) -> None:
    """Add an event with its ledger row to the log; counts : DOUBTFUL until the contact is seen far enough."""
    record.events[count, 0], record.events[count, 1] = a, what
    record.events[count, 2], record.events[count, 3] = 0, counts
    record.newest[a] = count if counts == DOUBTFUL else -1
    for i in range(len(row)):
        record.event_rows[count, i] = row[i]


@kernel
def confirm(system: System, state: State, a: int, depth: float, speed: float, record: Record) -> bool:
    """Let the newest event of contact a count if its indentation and speed, after it, are beyond rounding: whether so.

    A dashpot that would pull opens its contact while it is indented: then its force must be below zero by more.
    """
    e = record.newest[a]
    floor = RESOLVED * record.size[a, 0]
    if record.events[e, 1] == CLOSES:
        certain = state.status[a] == CLOSED and depth > floor
    else:
        certain = state.status[a] != CLOSED and depth < -floor
        if state.status[a] == CLAMPED:
            constant, by_depth, by_speed = sense(system, a)
            pull = constant + by_depth * depth + by_speed * speed
            certain = certain or pull < -by_depth * floor - by_speed * RESOLVED * record.size[a, 1]
    if certain:
        record.events[e, 3] = CERTAIN
        record.newest[a] = -1
    return bool(certain)


@kernel
def settle_events(record: Record, count: int, interfaces: int) -> int:
    """Leave the events that count in the log, closings and openings of a contact in turn; returns their number.

    Tells whether all contacts are open after each, whether each contact is closed at the end, and its shortest closing.
    """
    closed, kept, touching = record.closed, 0, 0
    for a in range(interfaces):
        closed[a], record.shortest[a], record.newest[a] = 0.0, np.inf, -1
    for e in range(count):
        a, what, counts = record.events[e, 0], record.events[e, 1], record.events[e, 3]
        if counts == DOUBTFUL or (what == CLOSES) == (closed[a] > 0.0):
            continue
        if what == CLOSES:
            closed[a] = 1.0
            touching += 1
            record.newest[a] = kept
        else:
            closed[a] = 0.0
            touching -= 1
            if counts != LIFTED:
                since = record.event_rows[record.newest[a], TIME]
                record.shortest[a] = min(record.shortest[a], record.event_rows[e, TIME] - since)
        record.events[kept, 0], record.events[kept, 1], record.events[kept, 3] = a, what, counts
        record.events[kept, 2] = 1 if touching == 0 else 0
        if kept != e:
            copy_to(record.event_rows[kept], record.event_rows[e])
        kept += 1
    return kept


# ----------------------------------------------------------------------------------------------------------------------
# What both marches keep account of: how they end, their trials, the ledger's drift, closings and openings.
# ----------------------------------------------------------------------------------------------------------------------

DONE, TOO_MANY_STEPS, NO_FORCES, TOO_MANY_EVENTS, STICKS, STALLS, STOPPED = 0, 1, 2, 3, 4, 5, 6
TROUBLE = {
    TOO_MANY_STEPS: "too many steps",
    TOO_MANY_EVENTS: "a contact chatters",
    NO_FORCES: "no contact force was found",
    STICKS: "contacts or one-way dashpots switch endlessly",
    STALLS: "no progress",
}
FULL = -1  # in place of a number of events: the log has no room


@kernel
def open_books(system: System, state: State, place: Floats, lost: Floats, record: Record) -> float:
    """The first ledger row, and no event so far; returns the total that the others are held against."""
    record.closed[:], record.newest[:], record.size[:] = 0.0, -1, 0.0
    if len(system.turn):
        lost[len(system.interfaces) + GIVEN] = modal_energies(system, state)[1]
        keep_row(0, state, record)
    return take_stock(0.0, system, state, place, lost, record.history[0])


@kernel
def keep_row(index: int, state: State, record: Record) -> None:
    """Keep where coupled modes are at a ledger row: their energies are told from there when the run is over."""
    if len(record.rows_z):
        copy_to(record.rows_z[index], state.z[: record.rows_z.shape[1]])
        copy_to(record.rows_v[index], state.v[: record.rows_v.shape[1]])


@kernel
def goes_on(record: Record, max_steps: int) -> int:
    """Count a trial; DONE while there may be one, else why the march ends."""
    if record.totals[TRIALS] >= max_steps:
        return TOO_MANY_STEPS
    record.totals[TRIALS] += 1.0
    return STOPPED if record.stop[0] != 0 else DONE


@kernel
def balance_books(t: float, initial: float, system: System, state: State, place: Floats, lost: Floats, row: Floats,
                  record: Record) -> bool:  # fmt: skip
    """Fill a ledger row, and hold its total against the first one; whether it is a number."""
    m, total = len(system.interfaces), take_stock(t, system, state, place, lost, row)
    if not np.isfinite(total):
        return False
    record.totals[DRIFT] = max(record.totals[DRIFT], abs(total - initial))
    record.totals[WORKED] = max(record.totals[WORKED], abs(lost[m + WORK]) + abs(lost[m + BROUGHT]))
    return True


@kernel
def log_changes(moment: float, system: System, state: State, loaded: Floats, row: Floats, n_events: int,
                record: Record) -> int:  # fmt: skip
    """Log the contacts that closed or opened at a moment; returns the number of events, FULL where they are too many.

    loaded [m] : whether a contact counts as closed now; row : of the ledger. Openings may be the end of a collision:
    there coupled modes part their energy.
    """
    for a in range(len(loaded)):
        if loaded[a] != record.closed[a]:
            if n_events == len(record.events):
                return FULL
            counts = CERTAIN if system.interfaces[a]["preload"] > 0.0 else DOUBTFUL
            log_event(record, n_events, a, CLOSES if loaded[a] > 0.0 else OPENS, counts, row)
            record.event_rows[n_events, TIME] = moment
            if loaded[a] == 0.0:
                part_energies(system, state, record.event_rows[n_events])
            record.closed[a] = loaded[a]
            n_events += 1
    return n_events


# ----------------------------------------------------------------------------------------------------------------------
# Energies of coupled modes at the rows of a ledger: what they have and what they lost, of all rows at once.
# ----------------------------------------------------------------------------------------------------------------------


def part_history(compiled: Compiled, record: Record, rows: int) -> None:
    """Part what coupled modes were given, in the first rows of a ledger, into what they have and what they lost.

    Notes: what they have is kinetic and elastic energy. What they lost is what they were given less what they would
    still lose if nothing acted on them any more: the integral of their damping over all of that time
    (`femstruct.modal.oscillators`), in which masses and stiffnesses do not enter. The ledger closes if
    both agree: its drift is raised to what they differ by.
    """
    found, system = compiled.oscillators, compiled.system
    if found is None:
        return
    history = record.history[:rows]
    given = history[:, STRUCTURE]
    held, surplus = energies_of_states(
        found, record.rows_z[:rows], record.rows_v[:rows], float(np.abs(given).max(initial=0.0))
    )
    lost_at = BODIES + len(system.omega) - system.n_modes + len(system.interfaces)
    history[:, lost_at] = given - (held + surplus)
    history[:, STRUCTURE] = held
    record.totals[DRIFT] += np.abs(surplus).max(initial=0.0)
