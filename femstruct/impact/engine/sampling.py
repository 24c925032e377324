"""What is kept of a run: states that its samples follow from, peak forces, ledger rows, events."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from femstruct.arrays import Floats
from femstruct.impact.compiled.byte_layout import Counts, CountTable, Cube, Matrix, Vector
from femstruct.impact.compiled.kernels import kernel, unit
from femstruct.impact.engine.energy import ledger_width
from femstruct.impact.engine.gauss_points import PLACES, POINTS, STAGES, Rule
from femstruct.impact.engine.instant_forces import CLOSED, State, copy_to, law, load_at, net_force
from femstruct.impact.engine.modal_tables import Tables
from femstruct.impact.engine.motion import Motion, inner_tables
from femstruct.impact.engine.propagate import Trial
from femstruct.impact.engine.records import LINK, System

MOST_EVENTS = 500_000
STEPS, TRIALS, DRIFT, WORKED = 0, 1, 2, 3  # columns of Record.totals
WHEN, ROWS, EVENTS = 0, 1, 2  # and of Record.ended


class Record(NamedTuple):
    """What is kept of a run.

    at, doublings [s], z, v [s, n], status [s, m] : the states of the coordinates and interfaces at samples that are
    starts of steps, and the steps' lengths: see `femstruct.impact.engine.motion`. forces, pushed [l] : what acts
    over the steps of more than one sample. kept : numbers of these states and steps. A record of no samples keeps
    none.
    peak [m, 2] : force and its time; deepest [m] : indentation; shortest [m] : least time from closing to
    opening [s].
    totals : STEPS, TRIALS, DRIFT, the largest |total - start|, and WORKED, the largest |work| + |brought by blows|;
    closed [m] : whether each contact counts as closed. history : ledger rows; events : interface, what, whether all are
    open then, whether it counts (see `femstruct.impact.engine.closings`); event_rows : their ledger rows. newest [m] :
    the last event of each contact while it does not count, else -1; size [m, 2] : the most that its displacement and
    speed were summed from. strikes [s, 4] : of every blow (see `femstruct.impact.engine.strikes`); latest [m] : number
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
