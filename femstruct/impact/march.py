"""The march through time: steps of tau 2^level, aligned to their length, so that samples fall on step ends.

A change of status ends a step one tick wide; the alignment then lets steps grow by no more than a factor of two each,
which is the graded mesh that the onset of a contact (indentation^1.5, ^0.5) needs.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.impact.compiled import kernel
from femstruct.impact.energy import integrate_losses, ledger_width, take_stock
from femstruct.impact.events import CHANGES, UNCERTAIN, strays, switch, watch
from femstruct.impact.propagate import (
    CLAMPED,
    CLOSED,
    OPEN,
    State,
    Trial,
    advance,
    dot,
    drift,
    law,
    load_at,
    net_force,
    rows_now,
    try_step,
)
from femstruct.impact.rule import LONGEST_DOUBLINGS, PLACES, STAGES, Rule
from femstruct.impact.system import LINK, System
from femstruct.impact.tables import Tables, tabulate

DONE, TOO_MANY_STEPS, NO_FORCES, TOO_MANY_EVENTS = 0, 1, 2, 3
OPENS, CLOSES = 0, 1
MOST_EVENTS = 500_000


class Record(NamedTuple):
    """What is kept. z, v [nt, n] at the samples; push [nt, r] of all rows, as it acts on the coordinates; force,
    place [nt, m] of the interfaces; peak [m, 2] force and its time; shortest [m] : least time from closing to opening [s]; totals : [0] steps, [1] trials,
    [2] largest |total - start|, [3] largest |work|, then whether each contact counts as closed. history : ledger rows;
    events : interface, what, whether all are open then; event_rows : their ledger rows."""

    z: Floats
    v: Floats
    push: Floats
    force: Floats
    place: Floats
    peak: Floats
    shortest: Floats
    totals: Floats
    history: Floats
    events: Integers
    event_rows: Floats


@kernel
def march(system: System, state: State, rule: Rule, tables: Tables, trial: Trial, record: Record, halvings: int,
          top_level: int, tolerance: float, max_steps: int) -> tuple[int, float, int, int]:  # fmt: skip
    """Run to the end; returns how it ended, when, and the numbers of ledger rows and events in the record."""
    history, events, event_rows = record.history, record.events, record.event_rows
    m, n, nt = len(system.interfaces), len(system.omega), len(record.z)
    per_sample = 1 << halvings
    end = nt * per_sample
    lost = np.zeros(m + 2)
    bounds, work = np.zeros((m, 4)), np.zeros((STAGES + 4, n))
    loaded, closed_at = np.zeros(m), np.zeros(m)
    n_events = 0
    place, rate = np.zeros(len(system.rows)), np.zeros(len(system.rows))
    rows_now(system, state.z, state.v, place, rate)
    _start(system, state, place, rate, loaded)
    initial = take_stock(0.0, system, state, place, lost, history[0])
    n_history = 1
    _sample(0, 0.0, system, state, state.z, state.v, record)
    _peaks_at_start(system, state, place, rate, record)
    for a in range(m):
        if loaded[a] > 0.0:
            _log(events, event_rows, n_events, a, CLOSES, 0, history[0])
            n_events += 1
    t, level, hint, kink = 0, top_level, -1, 0
    stride = max(end // 2048, 1)
    last = 0
    while t < end:
        if record.totals[1] >= max_steps:
            return TOO_MANY_STEPS, t * system.tick, n_history, n_events
        record.totals[1] += 1.0
        limit = end
        while kink < len(system.kinks) and system.kinks[kink] <= t:
            kink += 1
        if kink < len(system.kinks):
            limit = min(limit, system.kinks[kink])
        if hint > t:
            limit = min(limit, hint)
        level = min(level, _longest(t, limit - t, top_level))
        h = system.tick * 2.0**level
        now = t * system.tick
        if not tables.ready[level]:
            tabulate(level, h, system, rule, tables)
        for a in range(len(place)):
            trial.place[a, 0], trial.rate[a, 0] = place[a], rate[a]
        error = try_step(now, level, h, system, state, rule, tables, trial, tolerance)
        if not error <= 1.0 and level > 0:
            level -= 1 if error < 300.0 else (2 if error < 1e6 else 4)
            level = max(level, 0)
            continue
        if not error < np.inf:
            return NO_FORCES, now, n_history, n_events
        strays(level, h, system, state, rule, tables, trial, bounds)
        answer, part = watch(h, system, state, rule, trial, bounds, loaded)
        ticks = 1 << level
        if answer == UNCERTAIN and level > 0:
            level -= 1
            continue
        if answer == CHANGES and level > 0:
            hint = t + int(part * ticks)
            level -= 1
            continue
        _inner_samples(t, level, halvings, system, state, rule, tables, trial, record, work)
        _peaks(now, h, system, state, rule, trial, record)
        integrate_losses(h, system, state, rule, trial, lost)
        lost[m] += advance(level, system, tables, trial.forces, trial.modal, state.z, state.v, work)
        t += ticks
        now = t * system.tick
        rows_now(system, state.z, state.v, place, rate)
        for a in range(len(system.rows)):
            for p in range(PLACES):
                state.pace[a] = max(state.pace[a], abs(trial.rate[a, p]))
        changed = False
        if answer == CHANGES:
            for a in range(len(place)):
                trial.place[a, PLACES - 1], trial.rate[a, PLACES - 1] = place[a], rate[a]
            for a in range(m):
                if system.interfaces[a]["kind"] != LINK:
                    before = loaded[a]
                    state.status[a] = switch(system, state, trial, bounds, a)
                    loaded[a] = _is_loaded(system, state, a, place[a], rate[a], before)
                    changed = changed or loaded[a] != before
                    closed_at[a] = now if loaded[a] > before else closed_at[a]
                    if loaded[a] < before:
                        record.shortest[a] = min(record.shortest[a], now - closed_at[a])
        for a in range(m):
            if (
                system.interfaces[a]["kind"] == LINK
                and state.status[a] == OPEN
                and system.interfaces[a]["release"] <= t
            ):
                state.status[a], state.rest[a] = CLOSED, place[a]
            state.force[a] = net_force(system, state, a, place[a], rate[a]) if state.status[a] == CLOSED else 0.0
        if t % per_sample == 0 and t < end:
            _sample(t // per_sample, now, system, state, state.z, state.v, record)
        total = take_stock(now, system, state, place, lost, history[n_history])
        if not np.isfinite(total):
            return NO_FORCES, now, n_history, n_events
        record.totals[2] = max(record.totals[2], abs(total - initial))
        record.totals[3] = max(record.totals[3], abs(lost[m + 1]))
        if changed:
            for a in range(m):
                if system.interfaces[a]["kind"] != LINK and loaded[a] != record.totals[4 + a]:
                    all_open = 1 if _total(loaded) == 0.0 else 0
                    what = CLOSES if loaded[a] > 0.0 else OPENS
                    if n_events == len(events):
                        return TOO_MANY_EVENTS, now, n_history, n_events
                    _log(events, event_rows, n_events, a, what, all_open, history[n_history])
                    n_events += 1
        for a in range(m):
            record.totals[4 + a] = loaded[a]
        busy = _total(loaded) > 0.0 and t - last >= per_sample
        if busy or t - last >= stride or t == end:
            n_history += 1
            last = t
        record.totals[0] += 1.0
        if error < 2e-3:
            level += 1
    return DONE, end * system.tick, n_history, n_events


@kernel
def _total(values: Floats) -> float:
    total = 0.0
    for i in range(len(values)):
        total += values[i]
    return total


@kernel
def _longest(t: int, room: int, top: int) -> int:
    """Level of the longest step from t that is aligned to its length and fits into the room."""
    level = 0
    while level < top and (t >> level) & 1 == 0 and (2 << level) <= room:
        level += 1
    return level


@kernel
def _start(system: System, state: State, place: Floats, rate: Floats, loaded: Floats) -> None:
    """Contacts that close at once, preloaded contacts, links without a release time; the rest is open, touching or
    not, and closes when the leading derivative of its indentation says so."""
    for a in range(len(system.interfaces)):
        state.status[a] = OPEN
        if system.interfaces[a]["kind"] == LINK:
            if system.interfaces[a]["release"] <= 0:
                state.status[a] = CLOSED
        elif system.interfaces[a]["preload"] > 0.0 or (system.interfaces[a]["offset"] == 0.0 and rate[a] > 0.0):
            state.status[a] = CLOSED
            loaded[a] = 1.0 if system.interfaces[a]["preload"] == 0.0 else 0.0
            if (
                system.interfaces[a]["tensile"] == 0
                and law(system, a, place[a] + system.interfaces[a]["offset"], rate[a])[0] < 0.0
            ):
                state.status[a] = CLAMPED
        if state.status[a] == CLOSED:
            state.force[a] = net_force(system, state, a, place[a], rate[a])
    for a in range(len(rate)):
        state.pace[a] = abs(rate[a])


@kernel
def _is_loaded(system: System, state: State, a: int, place: float, rate: float, before: float) -> float:
    """Whether a contact counts as closed: it has a force, or one above its preload."""
    if state.status[a] != CLOSED:
        return 0.0
    if system.interfaces[a]["preload"] == 0.0:
        return 1.0
    excess = net_force(system, state, a, place, rate)
    if abs(excess) <= 1e-9 * system.interfaces[a]["preload"]:
        return before
    return 1.0 if excess > 0.0 else 0.0


@kernel
def _inner_samples(t: int, level: int, halvings: int, system: System, state: State, rule: Rule, tables: Tables,
                   trial: Trial, record: Record, work: Floats) -> None:  # fmt: skip
    """Samples strictly inside a long step: the modes go through it in pieces, under the same polynomial forces."""
    if level <= halvings:
        return
    pieces = 1 << (level - halvings)
    if not tables.ready[halvings]:
        tabulate(halvings, system.tick * 2.0**halvings, system, rule, tables)
    z, v = state.z.copy(), state.v.copy()
    forces, modal = np.zeros_like(trial.forces), np.zeros_like(trial.modal)
    first = t >> halvings
    for j in range(pieces - 1):
        piece = rule.pieces[pieces - 1 + j]
        for a in range(len(forces)):
            for p in range(STAGES):
                total = 0.0
                for s in range(STAGES):
                    total += piece[p, s] * trial.forces[a, s]
                forces[a, p] = total
        for i in range(modal.shape[1]):
            for p in range(STAGES):
                total = 0.0
                for s in range(STAGES):
                    total += piece[p, s] * trial.modal[s, i]
                modal[p, i] = total
        drift(halvings, system, tables, forces, modal, z, v, work)
        _sample(first + j + 1, (t + ((j + 1) << halvings)) * system.tick, system, state, z, v, record)


@kernel
def _sample(index: int, now: float, system: System, state: State, z: Floats, v: Floats, record: Record) -> None:
    """Write one sample: coordinates, rates, what pushes them, and the interfaces' forces as they are felt."""
    m = len(system.interfaces)
    for a in range(len(system.rows)):
        if a < m:
            x, u = dot(system.rows[a], z), dot(system.rows[a], v)
            net = net_force(system, state, a, x, u)
            record.place[index, a] = x
            record.force[index, a] = (
                net if system.interfaces[a]["kind"] == LINK else net + system.interfaces[a]["preload"]
            )
        else:
            net = load_at(system, a - m, now)
        record.push[index, a] = system.sign[a] * net
    for i in range(len(z)):
        record.z[index, i], record.v[index, i] = z[i], v[i]


@kernel
def _peaks_at_start(system: System, state: State, place: Floats, rate: Floats, record: Record) -> None:
    for a in range(len(system.interfaces)):
        if system.interfaces[a]["kind"] != LINK and state.status[a] == CLOSED:
            record.peak[a, 0] = law(system, a, place[a] + system.interfaces[a]["offset"], rate[a])[0]


@kernel
def _peaks(t: float, h: float, system: System, state: State, rule: Rule, trial: Trial, record: Record) -> None:
    """Largest force of each contact from the polynomials of the step: bracketed on the nodes, then golden section."""
    for a in range(len(system.interfaces)):
        if system.interfaces[a]["kind"] == LINK or state.status[a] != CLOSED:
            continue
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


@kernel
def _log(events: Integers, rows: Floats, count: int, a: int, what: int, all_open: int, row: Floats) -> None:
    events[count, 0], events[count, 1], events[count, 2] = a, what, all_open
    for i in range(len(row)):
        rows[count, i] = row[i]


def room_for(system: System, n_samples: int) -> Record:
    """Empty records of a run; memory is touched only where something is written.

    The history takes at most a row a sample while a contact is closed and 2048 more.
    """
    n, m, width = len(system.omega), len(system.interfaces), ledger_width(system)
    return Record(
        z=np.empty((n_samples, n)),
        v=np.empty((n_samples, n)),
        push=np.empty((n_samples, len(system.rows))),
        force=np.empty((n_samples, m)),
        place=np.empty((n_samples, m)),
        peak=np.zeros((m, 2)),
        shortest=np.full(m, np.inf),
        totals=np.zeros(4 + m),
        history=np.empty((n_samples + 2100, width)),
        events=np.empty((MOST_EVENTS, 3), dtype=np.int64),
        event_rows=np.empty((MOST_EVENTS, width)),
    )


def levels_for(halvings: int) -> int:
    """Number of step lengths: from a tick to the longest step."""
    return halvings + LONGEST_DOUBLINGS + 1
