"""Many runs of one scene, a row of metrics each: the tables of the modes are shared, the bodies' added in closed form.

A body's coordinate is sqrt(m) x, so that its mass is in its entries of the rows and nowhere else: what the tables owe
to bodies is that of a free unit mass times these entries.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from femstruct.arrays import Floats
from femstruct.impact.collocation.attempt import Room
from femstruct.impact.collocation.collocation_march import march
from femstruct.impact.compiled.byte_layout import Counts, Cube, Matrix, Vector
from femstruct.impact.compiled.kernels import kernel, unit
from femstruct.impact.engine.booking import DONE
from femstruct.impact.engine.closings import CLOSES
from femstruct.impact.engine.energy import TIME, part_energies
from femstruct.impact.engine.gauss_points import POINTS, STAGES, Rule
from femstruct.impact.engine.instant_forces import State, copy_to
from femstruct.impact.engine.modal_tables import Tables
from femstruct.impact.engine.records import ManyInterfaces, ManyLoads, ManyStrikes, System
from femstruct.impact.engine.sampling import DRIFT, EVENTS, ROWS, WORKED, Record
from femstruct.impact.engine.sampling import STEPS as STEPS_TAKEN
from femstruct.impact.engine.strikes import HELD, SINCE, lies
from femstruct.impact.exact.exact_constants import ExactRoom, ExactRule
from femstruct.impact.exact.exact_march import exact_march

STATUS, STEPS, RESIDUAL, SEPARATED, FIRST = 0, 1, 2, 3, 4  # columns; then what `columns` says


class Columns(NamedTuple):
    """First columns of what has one for each interface, body or term of the ledger, and the number of columns."""

    peak: int
    peak_time: int
    deepest: int
    closings: int
    first_open: int
    shortest: int
    last: int
    closed: int
    velocity: int
    travel: int
    gain: int
    lifts: int
    lift_number: int
    lift_force: int
    lift_since: int
    separation: int
    end: int
    width: int


def columns(interfaces: int, bodies: int, ledger: int) -> Columns:
    """Layout of a row of metrics."""
    sizes = np.array([FIRST, *8 * [interfaces], *7 * [bodies], *2 * [ledger]])
    return Columns(*(int(start) for start in np.cumsum(sizes)))


class Shared(NamedTuple):
    """What all runs share. start [2, k] of the modes; waits [b] : 1 for a body that is at rest until its first blow;
    entries [r, b] of the bodies in the rows and over [o, n] of what struck bodies are placed on, for unit masses;
    struck [o] : which bodies; weight : the first row of the bodies' weight, and all rows from there on; gravity
    [m/s^2]; mobility [r] of the modes; tables of the modes, and of a free unit mass with a row of its own."""

    start: Matrix
    waits: Counts
    entries: Matrix
    over: Matrix
    over_tilts: Matrix
    struck: Counts
    weight: int
    gravity: float
    mobility: Vector
    modes: Tables
    mass: Tables


class Runs(NamedTuple):
    """Some runs: mass, velocity [c, b] of the bodies, interfaces [c, m], loads [c, l], strikes [c, s]."""

    mass: Matrix
    velocity: Matrix
    interfaces: ManyInterfaces
    loads: ManyLoads
    strikes: ManyStrikes


class Marches(NamedTuple):
    """What both marches need. exact : whether it is the exact one, which needs no tables; duration [s] and quiet [s];
    halvings, top_level, tolerance, and paced, the steps tried between two looks at the progress : of the march by
    collocation."""

    exact: bool
    duration: float
    quiet: float
    max_steps: int
    paced: int
    halvings: int
    top_level: int
    tolerance: float
    rule: Rule
    room: Room
    exact_rule: ExactRule
    exact_room: ExactRoom


class Out(NamedTuple):
    """A row of metrics for each run [c, width], and the moments of what pushes [c, r, cells + 2] where asked for."""

    rows: Matrix
    moments: Cube


@unit(seconds=3.0)
def run_many(frame: System, shared: Shared, tables: Tables, runs: Runs, marches: Marches, record: Record,
             state: State, at: Columns, out: Out) -> int:  # fmt: skip
    """Fill a row of metrics [c, width] for each run. frame, tables : what of them
    depends on a run is this call's own."""
    k, bodies = frame.n_modes, runs.mass.shape[1]
    for i in range(len(out.rows)):
        new = i == 0
        for b in range(bodies):
            new = new or runs.mass[i, b] != runs.mass[i - 1, b]
        if new:
            _weigh(frame, shared, tables, runs.mass[i])
        for a in range(len(frame.interfaces)):
            frame.interfaces[a] = runs.interfaces[i, a]
        for a in range(len(frame.loads)):
            frame.loads[a] = runs.loads[i, a]
        for a in range(len(frame.strikes)):
            frame.strikes[a] = runs.strikes[i, a]
        state.z[:], state.v[:] = 0.0, 0.0
        copy_to(state.z, shared.start[0])
        copy_to(state.v, shared.start[1])
        for b in range(bodies):
            state.v[k + b] = 0.0 if shared.waits[b] else np.sqrt(runs.mass[i, b]) * runs.velocity[i, b]
        state.status[:], state.rest[:], state.pace[:], state.force[:] = 0, 0.0, 0.0, 0.0
        record.kept[:], record.peak[:], record.shortest[:] = 0, 0.0, np.inf
        record.totals[:], record.travel[:], record.deepest[:], record.late[:] = 0.0, 0.0, 0.0, np.nan
        record.strikes[:], record.latest[:], record.strike_peak[:], record.moments[:] = 0.0, -1, 0.0, 0.0
        if marches.exact:
            status = exact_march(
                frame, state, marches.exact_rule, marches.exact_room, record, marches.duration, np.inf, np.inf,
                marches.max_steps,
            )  # fmt: skip
        else:
            status = march(
                frame, state, marches.rule, tables, marches.room, record, marches.halvings, marches.top_level,
                marches.tolerance, marches.max_steps, marches.paced,
            )  # fmt: skip
        if out.moments.shape[2] > 0:
            for a in range(len(record.moments)):
                copy_to(out.moments[i, a], record.moments[a])
        rows, events = int(record.ended[ROWS]), int(record.ended[EVENTS])
        end = record.history[rows - 1 if marches.exact else rows]  # collocation counts it with samples only
        record.totals[DRIFT] += abs(part_energies(frame, state, end))
        mass, row = runs.mass[i], out.rows[i]
        _measure(frame, state, record, status, events, end, mass, shared.gravity, marches.quiet, at, row)
    return len(out.rows)


@kernel
def _weigh(frame: System, shared: Shared, tables: Tables, mass: Floats) -> None:
    """The rows, and all of the tables that depends on them, for these masses."""
    k, r, rows = frame.n_modes, len(frame.rows), frame.rows
    modes, unit = shared.modes, shared.mass
    _weigh_rows(frame, shared, mass)
    for level in range(len(tables.flow)):
        for a in range(r):
            for p in range(POINTS):
                for x in range(2):
                    for c in range(r):
                        copy_to(tables.forced[level, a, p, x, c], modes.forced[level, a, p, x, c])
        for x in range(2):
            for j in range(STAGES + 1):
                for a in range(r):
                    copy_to(tables.stray_push[level, x, j, a], modes.stray_push[level, x, j, a])
        for b in range(len(mass)):
            for a in range(r):
                here = rows[a, k + b]
                if here == 0.0:
                    continue
                for p in range(2 * POINTS):
                    for x in range(2):
                        tables.free[level, x, k + b, a * 2 * POINTS + p] = here * unit.free[level, x, 0, p]
                for c in range(r):
                    pair = here * rows[c, k + b]
                    if pair == 0.0:
                        continue
                    acts = pair * frame.sign[c]
                    for p in range(POINTS):
                        for x in range(2):
                            for s in range(STAGES):
                                tables.forced[level, a, p, x, c, s] += acts * unit.forced[level, 0, p, x, 0, s]
                    for x in range(2):
                        for s in range(STAGES + 1):
                            tables.stray_push[level, x, s, a, c] += abs(pair) * unit.stray_push[level, x, s, 0, 0]


@kernel
def _weigh_rows(frame: System, shared: Shared, mass: Floats) -> None:
    """The rows, and what of the system depends on them."""
    k, rows = frame.n_modes, frame.rows
    for a in range(len(rows)):
        frame.mobility[a] = shared.mobility[a]
        for b in range(len(mass)):
            root = np.sqrt(mass[b])
            rows[a, k + b] = shared.entries[a, b] * (root if a >= shared.weight else 1.0 / root)
            frame.mobility[a] += rows[a, k + b] ** 2
            if len(frame.turn):
                frame.drives[a, k + b] = rows[a, k + b]
    for o in range(len(shared.struck)):
        root = np.sqrt(mass[shared.struck[o]])
        for j in range(len(frame.omega)):
            frame.over[o, j] = shared.over[o, j] * (root if j < k else root / np.sqrt(mass[j - k]))
        for j in range(frame.over_tilts.shape[1]):
            frame.over_tilts[o, j] = shared.over_tilts[o, j] * root


@kernel
def _measure(system: System, state: State, record: Record, status: int, events: int, last: Floats, mass: Floats,
             gravity: float, quiet: float, at: Columns, row: Floats) -> None:  # fmt: skip
    """One row of metrics; a run that failed has its status and steps only."""
    m, k, log, times = len(system.interfaces), system.n_modes, record.events, record.event_rows[:, TIME]
    row[:] = np.nan
    row[STATUS], row[STEPS] = status, record.totals[STEPS_TAKEN]
    if status != DONE:
        return
    first = record.history[0]
    ledger, end = len(first), last[TIME]
    total = 0.0
    for i in range(1, ledger - 2):  # nothing has worked yet
        total += first[i]
    scale = max(abs(total), record.totals[WORKED])
    row[RESIDUAL] = record.totals[DRIFT] / scale if scale > 0.0 else 0.0
    for a in range(m):
        row[at.peak + a], row[at.peak_time + a] = record.peak[a, 0], record.peak[a, 1]
        for s in range(len(record.strike_peak)):  # peaks are those since the last blow
            if record.strike_peak[s, a, 0] > row[at.peak + a]:
                row[at.peak + a], row[at.peak_time + a] = record.strike_peak[s, a, 0], record.strike_peak[s, a, 1]
        row[at.closings + a], row[at.deepest + a] = 0.0, record.deepest[a]
        row[at.shortest + a], row[at.closed + a] = record.shortest[a], record.closed[a]
    for e in range(events):
        a = log[e, 0]
        row[at.last + a] = times[e]
        if log[e, 1] == CLOSES:
            row[at.closings + a] += 1.0
        elif np.isnan(row[at.first_open + a]):
            row[at.first_open + a] = times[e]
    again = np.inf  # when the next closing is, going back
    row[SEPARATED] = 0.0
    for e in range(events - 1, -1, -1):
        if log[e, 1] == CLOSES:
            again = times[e]
        elif log[e, 2] and times[e] + quiet <= end and again > times[e] + quiet:
            row[SEPARATED] = 1.0
            for i in range(ledger):
                row[at.separation + i] = record.event_rows[e, i]
    for i in range(ledger):
        row[at.end + i] = last[i]
    for b in range(len(mass)):
        root = np.sqrt(mass[b])
        row[at.velocity + b], row[at.travel + b] = state.v[k + b] / root, record.travel[b] / root
        row[at.gain + b] = abs(state.v[k + b] - record.late[k + b]) / (root * (end - record.late_at[0] * system.tick))
        row[at.lifts + b] = 0.0
        blows = 0
        for s in range(len(system.strikes)):
            if system.strikes[s]["coordinate"] != k + b:
                continue
            held = record.strikes[s, HELD]
            if held > 0.0 and not lies(held, gravity * mass[b]):
                if row[at.lifts + b] == 0.0:
                    row[at.lift_number + b], row[at.lift_force + b] = blows, held
                    row[at.lift_since + b] = system.strikes[s]["tick"] * system.tick - record.strikes[s, SINCE]
                row[at.lifts + b] += 1.0
            blows += 1
