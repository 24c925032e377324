"""Many runs of one scene, a row of metrics each: the tables of the modes are shared, the bodies' added in closed form.

A body's coordinate is sqrt(m) x, so that its mass is in its entries of the rows and nowhere else: what the tables owe
to bodies is that of a free unit mass times these entries.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from femstruct.arrays import Floats
from femstruct.impact.compiled import released
from femstruct.impact.energy import TIME
from femstruct.impact.exact.march import exact_march
from femstruct.impact.exact.rule import ExactRoom, ExactRule
from femstruct.impact.forces import State, copy_to
from femstruct.impact.march import CLOSES, DONE, Room, march
from femstruct.impact.rule import POINTS, STAGES, Rule
from femstruct.impact.sampling import Record
from femstruct.impact.system import LINK, Records, System
from femstruct.impact.tables import Tables

STATUS, STEPS, RESIDUAL, SEPARATED, ENDED, FIRST = 0, 1, 2, 3, 4, 5  # columns; then what `columns` says
NO_CONTACTS, NEVER_TOUCHED, SEPARATED_AT_END, CLOSED_AT_END = 0, 1, 2, 3


class Columns(NamedTuple):
    """First columns of what has one for each interface, body or term of the ledger, and the number of columns."""

    peak: int
    peak_time: int
    deepest: int
    closings: int
    first_open: int
    velocity: int
    travel: int
    separation: int
    end: int
    width: int


def columns(interfaces: int, bodies: int, ledger: int) -> Columns:
    """Layout of a row of metrics."""
    sizes = np.array([FIRST, *5 * [interfaces], *2 * [bodies], *2 * [ledger]])
    return Columns(*(int(start) for start in np.cumsum(sizes)))


class Shared(NamedTuple):
    """What all runs share. start [2, k] of the modes; entries [r, b] of the bodies in the rows, for unit masses;
    weight : the row of the bodies' weight, -1 without; mobility [r] of the modes; tables of the modes, and of a free
    unit mass with a row of its own."""

    start: Floats
    entries: Floats
    weight: int
    mobility: Floats
    modes: Tables
    mass: Tables


class Runs(NamedTuple):
    """Some runs: mass, velocity [c, b] of the bodies, interfaces [c, m], loads [c, l]."""

    mass: Floats
    velocity: Floats
    interfaces: Records
    loads: Records


class Marches(NamedTuple):
    """What both marches need. exact : whether it is the exact one, which needs no tables; duration [s] and quiet [s];
    halvings, top_level, tolerance : of the march by collocation."""

    exact: bool
    duration: float
    quiet: float
    max_steps: int
    halvings: int
    top_level: int
    tolerance: float
    rule: Rule
    room: Room
    exact_rule: ExactRule
    exact_room: ExactRoom


@released
def run_many(frame: System, shared: Shared, tables: Tables, runs: Runs, marches: Marches, record: Record,
             state: State, at: Columns, out: Floats) -> None:  # fmt: skip
    """Fill a row of metrics [c, width] for each run. tables : their parts that depend on masses are this call's own."""
    k, bodies = frame.n_modes, runs.mass.shape[1]
    for i in range(len(out)):
        new = i == 0
        for b in range(bodies):
            new = new or runs.mass[i, b] != runs.mass[i - 1, b]
        if new:
            _weigh(frame, shared, tables, runs.mass[i])
        system = System(
            frame.omega, frame.damping, frame.coupling, frame.n_modes, frame.rows, frame.sign, frame.mobility,
            runs.interfaces[i], frame.curves, runs.loads[i], frame.table, frame.strikes, frame.over, frame.kinks,
            frame.tick,
        )  # fmt: skip
        state.z[:], state.v[:] = 0.0, 0.0
        copy_to(state.z, shared.start[0])
        copy_to(state.v, shared.start[1])
        for b in range(bodies):
            state.v[k + b] = np.sqrt(runs.mass[i, b]) * runs.velocity[i, b]
        state.status[:], state.rest[:], state.pace[:], state.force[:] = 0, 0.0, 0.0, 0.0
        record.kept[:], record.peak[:], record.shortest[:] = 0, 0.0, np.inf
        record.totals[:], record.travel[:], record.deepest[:] = 0.0, 0.0, 0.0
        if marches.exact:
            status, _, _, events = exact_march(
                system, state, marches.exact_rule, marches.exact_room, record, marches.duration, np.inf, np.inf,
                np.inf, marches.max_steps,
            )  # fmt: skip
        else:
            status, _, _, events = march(
                system, state, marches.rule, tables, marches.room, record, marches.halvings, marches.top_level,
                marches.tolerance, marches.max_steps,
            )  # fmt: skip
        _measure(system, state, record, status, events, runs.mass[i], marches.quiet, at, out[i])


@released
def _weigh(frame: System, shared: Shared, tables: Tables, mass: Floats) -> None:
    """The rows, and all of the tables that depends on them, for these masses."""
    k, r, rows = frame.n_modes, len(frame.rows), frame.rows
    modes, unit = shared.modes, shared.mass
    for a in range(r):
        frame.mobility[a] = shared.mobility[a]
        for b in range(len(mass)):
            root = np.sqrt(mass[b])
            rows[a, k + b] = shared.entries[a, b] * (root if a == shared.weight else 1.0 / root)
            frame.mobility[a] += rows[a, k + b] ** 2
    copy_to(tables.forced.reshape(-1), modes.forced.reshape(-1))
    copy_to(tables.stray_push.reshape(-1), modes.stray_push.reshape(-1))
    for level in range(len(tables.ready)):
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


@released
def _measure(system: System, state: State, record: Record, status: int, events: int, mass: Floats, quiet: float,
             at: Columns, row: Floats) -> None:  # fmt: skip
    """One row of metrics; a run that failed has its status and steps only."""
    m, k, log, times = len(system.interfaces), system.n_modes, record.events, record.event_rows[:, TIME]
    row[:] = np.nan
    row[STATUS], row[STEPS] = status, record.totals[0]
    if status != DONE:
        return
    first, last = record.history[0], record.history[1]
    ledger, end = len(first), last[TIME]
    total = 0.0
    for i in range(1, ledger - 2):  # nothing has worked yet
        total += first[i]
    scale = max(abs(total), record.totals[3])
    row[RESIDUAL] = record.totals[2] / scale if scale > 0.0 else 0.0
    contacts = 0
    for a in range(m):
        contacts += 0 if system.interfaces[a]["kind"] == LINK else 1
        row[at.peak + a], row[at.peak_time + a] = record.peak[a, 0], record.peak[a, 1]
        row[at.closings + a], row[at.deepest + a] = 0.0, record.deepest[a]
    for e in range(events):
        a = log[e, 0]
        if log[e, 1] == CLOSES:
            row[at.closings + a] += 1.0
        elif np.isnan(row[at.first_open + a]):
            row[at.first_open + a] = times[e]
    if contacts == 0:
        row[ENDED] = NO_CONTACTS
    elif events == 0:
        row[ENDED] = NEVER_TOUCHED
    else:
        row[ENDED] = SEPARATED_AT_END if log[events - 1, 2] else CLOSED_AT_END
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
