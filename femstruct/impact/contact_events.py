"""What is kept of a run while it goes on: samples, peak forces, when contacts close and open, blows, ledger rows."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from femstruct.arrays import Floats
from femstruct.compiled.kernels import Counts, CountTable, Cube, Matrix, Vector, kernel, unit
from femstruct.compiled.records import LINK, System
from femstruct.impact.energies import (
    BODIES,
    BROUGHT,
    GIVEN,
    INTEGRATED,
    STRUCTURE,
    TIME,
    WORK,
    fill_ledger_row,
    ledger_width,
    modal_energies,
    part_energies,
    stored,
)
from femstruct.impact.motion import Motion, inner_tables
from femstruct.impact.propagation import (
    CLAMPED,
    CLOSED,
    DISPLACEMENT_ROUNDING,
    OPEN,
    PLACES,
    POINTS,
    STAGES,
    Rule,
    State,
    StepTrial,
    Tables,
    copy_to,
    dot,
    law,
    load_at,
    net_force,
    rows_now,
    sense,
    terms_of,
)
from femstruct.impact.system import Compiled
from femstruct.modal.coupled_damping import energies_of_states

# ----------------------------------------------------------------------------------------------------------------------
# What is kept of a run: states that its samples follow from, peak forces, ledger rows, events.
# ----------------------------------------------------------------------------------------------------------------------

MOST_EVENTS = 500_000
STEPS, TRIALS, DRIFT, WORKED = 0, 1, 2, 3  # columns of Record.totals
WHEN, ROWS, EVENTS = 0, 1, 2  # of Record.ended
PEAK, PEAK_AT = 0, 1  # of Record.peak: how large, and when
OF_PLACE, OF_SPEED = 0, 1  # of Record.size
WHOSE, WHAT, ALL_OPEN, COUNTS = 0, 1, 2, 3  # of Record.events


class RunRecord(NamedTuple):
    """What is kept of a run.

    at, doublings [s], z, v [s, n], status [s, m] : the states of the coordinates and interfaces at samples that are
    starts of steps, and the steps' lengths: see `femstruct.impact.motion`. forces, pushed [l] : what acts
    over the steps of more than one sample. kept : numbers of these states and steps. A record of no samples keeps
    none.
    peak [m, 2] : force and its time; deepest [m] : indentation; shortest [m] : least time from closing to
    opening [s].
    totals : STEPS, TRIALS, DRIFT, the largest |total - start|, and WORKED, the largest |work| + |brought by blows|;
    closed [m] : whether each contact counts as closed. history : ledger rows; events : interface, what, whether all are
    open then, whether it counts ("Which closings and openings count"); event_rows : their ledger rows. newest [m] :
    the last event of each contact while it does not count, else -1; size [m, 2] : the most that its displacement and
    speed were summed from. strikes [s, 4] : of every blow ("Blows"); latest [m] : number
    of the last blow of a body at an interface, -1 before any; strike_peak [s + 1, m, 2] : peaks after every blow, in
    the last row before any.
    late [n] : the rates at the end of the first step that reaches the tick late_at [1], negative for none.
    rows_z, rows_v [rows, k] : where oscillators in place of coupled modes are at the ledger rows, else empty.
    moments [r, cells + 2] : of what pushes, on a grid of times `spacing` [1] s apart, where it is asked for, else of no
    columns; shares [STAGES] : room for them.
    stop [1] : not zero when the integration shall end at once. ended : WHEN [s], ledger ROWS, EVENTS.
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


def empty_record(system: System, n_samples: int) -> RunRecord:
    """Empty records of a run; memory is touched only where something is written.

    The history takes at most a row a sample while a contact is closed or a load acts, 2048 more, and two a blow.
    """
    blows = len(system.strikes)
    n, m, width = len(system.omega), len(system.interfaces), ledger_width(system)
    longs, rows = n_samples // 2 + 1, n_samples + 2100 + 2 * blows
    coupled = (rows, system.n_modes) if len(system.turn) else (0, 0)
    return RunRecord(
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
def store_state(index: int, doublings: int, state: State, trial: StepTrial, record: RunRecord) -> None:
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


def motion_of(record: RunRecord, system: System, halvings: int, tables: Tables, turn: Floats | None = None) -> Motion:
    """The motion that a record holds.

    Parameters
    ----------
    turn : Floats | None
        Of coupled modes, as the motion has it.
    """
    states, longs = int(record.kept[0]), int(record.kept[1])
    doublings, pushed = record.doublings[:states].copy(), record.pushed[:longs].copy()
    free, forced = inner_tables(system, halvings, tables, doublings[doublings > 0], pushed)
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
def ended(record: RunRecord, how: int, when: float, rows: int, events: int) -> int:
    """Note how an integration ended."""
    record.ended[WHEN], record.ended[ROWS], record.ended[EVENTS] = when, rows, events
    return how


class Standing(NamedTuple):
    """How rows and contacts stand now. place, rate [r] : of the rows. loaded, closed_at [m] : whether a contact counts
    as closed, and since when. lost [m + INTEGRATED] : dissipated by interfaces, by modes; work; brought by blows; given
    to coupled modes."""

    place: Vector
    rate: Vector
    loaded: Vector
    closed_at: Vector
    lost: Vector


def standing_room(system: System) -> Standing:
    """Room for it."""
    m, r = len(system.interfaces), len(system.rows)
    return Standing(
        place=np.zeros(r), rate=np.zeros(r), loaded=np.zeros(m), closed_at=np.zeros(m), lost=np.zeros(m + INTEGRATED)
    )


class ContactForces(NamedTuple):
    """Displacement and speed of the interfaces at the samples, place, rate [m, nt]; force [m, nt] : as it is felt;
    push [r, nt] : of all rows, as they push the rest."""

    place: Matrix
    rate: Matrix
    force: Matrix
    push: Matrix


@unit(seconds=1.0)
def fill_forces(system: System, state: State, halvings: int, record: RunRecord, out: ContactForces) -> int:
    """Fill in the forces at the samples.

    Parameters
    ----------
    state : State
        At the end; its status is changed on the way.
    """
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
def peaks_at_start(system: System, state: State, place: Floats, rate: Floats, record: RunRecord) -> None:
    for a in range(len(system.interfaces)):
        if system.interfaces[a]["kind"] != LINK and state.status[a] == CLOSED:
            record.peak[a, PEAK] = max(0.0, law(system, a, place[a] + system.interfaces[a]["offset"], rate[a])[0])


@kernel
def peaks(t: float, h: float, system: System, state: State, rule: Rule, trial: StepTrial, record: RunRecord) -> None:
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
        if largest < 0.9 * record.peak[a, PEAK]:
            continue
        rising, falling = 0.0, 0.0  # slopes at the end and at the start
        for p in range(STAGES):
            rising -= rule.slopes[1, STAGES - 1 - p] * trial.forces[a, p]
            falling += rule.slopes[1, p] * trial.forces[a, p]
        if (at == STAGES - 1 and rising >= 0.0) or (at == 0 and falling <= 0.0):
            if largest > record.peak[a, PEAK]:
                record.peak[a, PEAK], record.peak[a, PEAK_AT] = largest, t + h if at else t
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
            if value > record.peak[a, PEAK]:
                record.peak[a, PEAK], record.peak[a, PEAK_AT] = value, t + where * h


@kernel
def travels(h: float, system: System, state: State, rule: Rule, trial: StepTrial, record: RunRecord) -> None:
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
def rests_on_contact(force: float, weight: float) -> bool:
    """Whether a body under gravity lay still on a contact of this force when it was lifted off."""
    return abs(force - weight) <= REST_FORCE_ERROR * weight


@kernel
def update_status(system: System, state: State, a: int, place: float, rate: float, margin: float) -> None:
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
def log_initial_blow(system: System, number: int, state: State, record: RunRecord) -> None:
    """Book a blow at t = 0: it is the start itself, its energy is that of the start."""
    coordinate = system.strikes[number]["coordinate"]
    record.strikes[number, ENERGY] = 0.5 * state.v[coordinate] ** 2
    record.strikes[number, MOMENTUM] = state.v[coordinate]
    for a in range(len(system.interfaces)):
        if system.rows[a, coordinate] != 0.0:
            record.latest[a] = number


@kernel
def apply_blow(
    now: float, t: int, number: int, system: System, state: State, here: Standing, record: RunRecord
) -> None:
    """Lift a body off and let it strike again; place and rate of all rows are renewed.

    Peaks since the last blow go to the record of that blow, and begin again.
    """
    m, i = len(system.interfaces), system.strikes[number]["coordinate"]
    mine, place, rate, loaded = record.strikes[number], here.place, here.rate, here.loaded
    mine[ENERGY] = -0.5 * state.v[i] ** 2
    for a in range(m):
        if system.rows[a, i] != 0.0:
            mine[ENERGY] -= stored(system, state, a, place[a])
            if loaded[a] > 0.0:
                mine[HELD] = max(mine[HELD], net_force(system, state, a, place[a], rate[a]))
                mine[SINCE] = here.closed_at[a]
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
            update_status(system, state, a, place[a], rate[a], margin)
            mine[ENERGY] += stored(system, state, a, place[a])
            loaded[a] = 1.0 if state.status[a] == CLOSED else 0.0
            if loaded[a] > 0.0:
                here.closed_at[a] = now
                force = law(system, a, place[a] + system.interfaces[a]["offset"], rate[a])[0]
                record.peak[a, PEAK], record.peak[a, PEAK_AT] = force, now
    here.lost[m + BROUGHT] += mine[ENERGY]


# ----------------------------------------------------------------------------------------------------------------------
# Which closings and openings count: those that lead farther than displacements are known.
#
# A contact that grazes opens and closes for rounding, and one that decays does so for ever: how often depends on the
# integration. So an event counts when, before its contact's next one, the indentation after a closing or the gap after
# an opening exceeds RESOLVED of what the displacement was summed from so far. The others are not reported.
# ----------------------------------------------------------------------------------------------------------------------

OPENS, CLOSES = 0, 1
DOUBTFUL, CERTAIN, LIFTED = 0, 1, 2  # an event within rounding so far; beyond it; of a body that was lifted off
RESOLVED = 1e-12  # of the terms a displacement is summed from: 1e-16 of them a step, grown over thousands of steps


@kernel
def log_event(record: RunRecord, count: int, a: int, what: int, counts: int, row: Floats) -> None:
    """Add an event with its ledger row to the log.

    Parameters
    ----------
    counts : int
        DOUBTFUL until the contact is seen far enough.
    """
    record.events[count, WHOSE], record.events[count, WHAT] = a, what
    record.events[count, ALL_OPEN], record.events[count, COUNTS] = 0, counts
    record.newest[a] = count if counts == DOUBTFUL else -1
    for i in range(len(row)):
        record.event_rows[count, i] = row[i]


@kernel
def confirm(system: System, state: State, a: int, depth: float, speed: float, record: RunRecord) -> bool:
    """Let the newest event of contact a count if its indentation and speed, after it, are beyond rounding: whether so.

    A dashpot that would pull opens its contact while it is indented: then its force must be below zero by more.
    """
    e = record.newest[a]
    floor = RESOLVED * record.size[a, OF_PLACE]
    if record.events[e, WHAT] == CLOSES:
        certain = state.status[a] == CLOSED and depth > floor
    else:
        certain = state.status[a] != CLOSED and depth < -floor
        if state.status[a] == CLAMPED:
            constant, by_depth, by_speed = sense(system, a)
            pull = constant + by_depth * depth + by_speed * speed
            certain = certain or pull < -by_depth * floor - by_speed * RESOLVED * record.size[a, OF_SPEED]
    if certain:
        record.events[e, COUNTS] = CERTAIN
        record.newest[a] = -1
    return bool(certain)


@kernel
def settle_events(record: RunRecord, count: int, interfaces: int) -> int:
    """Leave the events that count in the log, closings and openings of a contact in turn; returns their number.

    Tells whether all contacts are open after each, whether each contact is closed at the end, and its shortest closing.
    """
    closed, kept, touching = record.closed, 0, 0
    for a in range(interfaces):
        closed[a], record.shortest[a], record.newest[a] = 0.0, np.inf, -1
    for e in range(count):
        a, what, counts = record.events[e, WHOSE], record.events[e, WHAT], record.events[e, COUNTS]
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
        record.events[kept, WHOSE], record.events[kept, WHAT], record.events[kept, COUNTS] = a, what, counts
        record.events[kept, ALL_OPEN] = 1 if touching == 0 else 0
        if kept != e:
            copy_to(record.event_rows[kept], record.event_rows[e])
        kept += 1
    return kept


# ----------------------------------------------------------------------------------------------------------------------
# What both integrations keep account of: how they end, their trials, the ledger's drift, closings and openings.
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
def start_ledger(system: System, state: State, here: Standing, record: RunRecord) -> float:
    """The first ledger row, and no event so far; returns the total that the others are held against."""
    record.closed[:], record.newest[:], record.size[:] = 0.0, -1, 0.0
    if len(system.turn):
        here.lost[len(system.interfaces) + GIVEN] = modal_energies(system, state)[1]
        store_row(0, state, record)
    return fill_ledger_row(0.0, system, state, here.place, here.lost, record.history[0])


@kernel
def store_row(index: int, state: State, record: RunRecord) -> None:
    """Keep where coupled modes are at a ledger row: their energies are told from there when the run is over."""
    if len(record.rows_z):
        copy_to(record.rows_z[index], state.z[: record.rows_z.shape[1]])
        copy_to(record.rows_v[index], state.v[: record.rows_v.shape[1]])


@kernel
def may_continue(record: RunRecord, max_steps: int) -> int:
    """Count a trial; DONE while there may be one, else why the integration ends."""
    if record.totals[TRIALS] >= max_steps:
        return TOO_MANY_STEPS
    record.totals[TRIALS] += 1.0
    return STOPPED if record.stop[0] != 0 else DONE


@kernel
def balance_ledger_row(
    t: float, initial: float, system: System, state: State, here: Standing, row: Floats, record: RunRecord
) -> bool:
    """Fill a ledger row, and hold its total against the first one; whether it is a number."""
    m, lost = len(system.interfaces), here.lost
    total = fill_ledger_row(t, system, state, here.place, lost, row)
    if not np.isfinite(total):
        return False
    record.totals[DRIFT] = max(record.totals[DRIFT], abs(total - initial))
    record.totals[WORKED] = max(record.totals[WORKED], abs(lost[m + WORK]) + abs(lost[m + BROUGHT]))
    return True


@kernel
def log_changes(moment: float, system: System, state: State, loaded: Floats, row: Floats, n_events: int,
                record: RunRecord) -> int:  # fmt: skip
    """Log the contacts that closed or opened at a moment; returns the number of events, FULL where they are too many.

    Parameters
    ----------
    loaded : Floats [m]
        Whether a contact counts as closed now.
    row : Floats
        Of the ledger. Openings may be the end of a collision: there coupled modes part their energy.
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


def part_history(compiled: Compiled, record: RunRecord, rows: int) -> None:
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
