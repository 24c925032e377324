"""The march through time: steps of tau 2^level, aligned to their length, so that samples fall on step ends.

A change of status ends a step one tick wide; the alignment then lets steps grow by no more than a factor of two each,
which is the graded mesh that the onset of a contact (indentation^1.5, ^0.5) needs.
"""

from __future__ import annotations

from femstruct.arrays import Floats
from femstruct.impact.collocation.attempt import ERROR, PART, REFUSED, Room, attempt
from femstruct.impact.collocation.events import CHANGES, SHARP, UNCERTAIN, least_excess, switch
from femstruct.impact.collocation.push_moments import gather
from femstruct.impact.compiled.kernels import kernel, unit
from femstruct.impact.engine.booking import (
    DONE,
    FULL,
    NO_FORCES,
    STALLS,
    TOO_MANY_EVENTS,
    balance_books,
    goes_on,
    keep_row,
    log_changes,
    open_books,
)
from femstruct.impact.engine.closings import LIFTED, OPENS, confirm, log_event, settle_events
from femstruct.impact.engine.energy import MODES, integrate_losses, part_energies, take_stock
from femstruct.impact.engine.flow import advance
from femstruct.impact.engine.gauss_points import LONGEST_DOUBLINGS, PLACES, Rule
from femstruct.impact.engine.instant_forces import (
    AWAY,
    CLOSED,
    DISPLACEMENT_ROUNDING,
    OPEN,
    State,
    copy_to,
    load_at,
    net_force,
    rows_now,
)
from femstruct.impact.engine.modal_tables import Tables
from femstruct.impact.engine.propagate import LONGER, Trial
from femstruct.impact.engine.records import CONSTANT, LINK, System
from femstruct.impact.engine.sampling import STEPS, Record, ended, keep, peaks, peaks_at_start, travels
from femstruct.impact.engine.strikes import first_strike, strike, touch

ERROR_BUDGET = 0.1  # share of the tolerance that a step may spend


@unit(seconds=9.0)
def march(system: System, state: State, rule: Rule, tables: Tables, room: Room, record: Record, halvings: int,
          top_level: int, tolerance: float, max_steps: int, paced: int) -> int:  # fmt: skip
    """Run to the end; returns how it ended; when, and the numbers of ledger rows and events, are in record.ended.

    paced : steps tried between two looks at the progress. A record without samples is of one interval of 2^halvings
    ticks, and keeps the first and the last ledger row only.
    """
    history, m, samples = record.history, len(system.interfaces), len(record.at)
    per_sample = 1 << halvings
    end = max(samples, 1) * per_sample
    trial, lost, bounds, place, rate = room.trial, room.lost, room.bounds, room.place, room.rate
    loaded, closed_at = room.loaded, room.closed_at
    lost[:], loaded[:], closed_at[:] = 0.0, 0.0, 0.0
    rows_now(system, state.z, state.v, place, rate)
    _start(system, state, place, rate, loaded)
    initial = open_books(system, state, place, lost, record)
    n_history = 1
    peaks_at_start(system, state, place, rate, record)
    n_events = log_changes(0.0, system, state, loaded, history[0], 0, record)
    stride = max(end // 2048, 1)
    while samples > 0 and top_level > 0 and (1 << top_level) > 4 * stride:  # a ledger row is the end of a step
        top_level -= 1
    t, level, hint, kink, blow = 0, top_level, -1, 0, 0
    while blow < len(system.strikes) and system.strikes[blow]["tick"] == 0:
        first_strike(system, blow, state, record)
        blow += 1
    last, tried, seen, late = 0, 0, 0, record.late_at[0]
    while t < end:
        how = goes_on(record, max_steps)
        if how != DONE:
            return ended(record, how, t * system.tick, n_history, n_events)
        tried += 1
        if tried == paced:
            if t - seen < paced * (end / max_steps):  # at this pace all steps are gone before the end
                return ended(record, STALLS, t * system.tick, n_history, n_events)
            tried, seen = 0, t
        limit = end
        while kink < len(system.kinks) and system.kinks[kink] <= t:
            kink += 1
        if kink < len(system.kinks):
            limit = min(limit, system.kinks[kink])
        if hint > t:
            limit = min(limit, hint)
        level = min(level, _longest(t, limit - t, top_level))
        acting = _acts(system, (t + 0.5 * min(limit - t, per_sample)) * system.tick)
        if acting:  # what a load puts in is kept as finely as what it moves
            level = min(level, halvings)
        h = system.tick * float(1 << level)
        now = t * system.tick
        for a in range(len(place)):
            trial.place[a, 0], trial.rate[a, 0] = place[a], rate[a]
        answer = attempt(now, level, system, state, rule, tables, room, tolerance)
        error, part = room.found[ERROR], room.found[PART]
        if answer == REFUSED:
            if level == 0:
                return ended(record, NO_FORCES, now, n_history, n_events)
            level -= 1 if error < 300.0 else (2 if error < 1e6 else 4)
            level = max(level, 0)
            continue
        ticks = 1 << level
        if answer == UNCERTAIN and level > 0:
            level -= 1
            continue
        if answer == CHANGES and level > 0:
            hint = t + int(part * ticks)
            level -= 1
            continue
        if samples > 0 and t % per_sample == 0:
            keep(t // per_sample, max(level - halvings, 0), state, trial, record)
        peaks(now, h, system, state, rule, trial, record)
        travels(h, system, state, rule, trial, record)
        if record.moments.shape[1] > 0:
            gather(now, h, rule, trial, record.moments, record.shares, record.spacing[0])
        _confirm_step(system, state, trial, bounds, record)
        integrate_losses(h, system, state, rule, trial, lost)
        lost[m + MODES] += advance(level, system, tables, trial.forces, state.z, state.v, room.work)
        t += ticks
        now = t * system.tick
        if 0 <= late <= t:
            copy_to(record.late, state.v)
            late = -1
        changes = answer in (CHANGES, SHARP)
        moment = now - (1.0 - part) * h if changes else now
        rows_now(system, state.z, state.v, place, rate)
        for a in range(len(system.rows)):
            for p in range(PLACES):
                state.pace[a] = max(state.pace[a], abs(trial.rate[a, p]))
        if changes:
            for a in range(len(place)):
                trial.place[a, PLACES - 1], trial.rate[a, PLACES - 1] = place[a], rate[a]
            for a in range(m):
                if system.interfaces[a]["kind"] != LINK:
                    before = loaded[a]
                    state.status[a] = switch(system, state, trial, bounds, a)
                    loaded[a] = _is_loaded(system, state, a, place[a], rate[a], least_excess(system, bounds, a), before)
                    closed_at[a] = moment if loaded[a] > before else closed_at[a]
        struck = blow < len(system.strikes) and system.strikes[blow]["tick"] <= t
        if struck:
            take_stock(now, system, state, place, lost, history[n_history])
            keep_row(n_history, state, record)
            n_history += 1
            while blow < len(system.strikes) and system.strikes[blow]["tick"] <= t:
                strike(now, t, blow, system, state, place, rate, loaded, closed_at, lost, record)
                blow += 1
            for a in range(m):
                if record.closed[a] > 0.0 and record.latest[a] >= 0 and system.strikes[record.latest[a]]["tick"] == t:
                    if n_events == len(record.events):
                        return ended(record, TOO_MANY_EVENTS, now, n_history, n_events)
                    log_event(record, n_events, a, OPENS, LIFTED, history[n_history - 1])
                    part_energies(system, state, record.event_rows[n_events])
                    n_events += 1
                    record.closed[a] = 0.0
            moment = now
        for a in range(m):
            if (
                system.interfaces[a]["kind"] == LINK
                and state.status[a] == OPEN
                and system.interfaces[a]["release"] <= t
            ):
                state.status[a], state.rest[a] = CLOSED, place[a]
            state.force[a] = net_force(system, state, a, place[a], rate[a]) if state.status[a] == CLOSED else 0.0
        if not balance_books(now, initial, system, state, place, lost, history[n_history], record):
            return ended(record, NO_FORCES, now, n_history, n_events)
        n_events = log_changes(moment, system, state, loaded, history[n_history], n_events, record)
        if n_events == FULL:
            return ended(record, TOO_MANY_EVENTS, now, n_history, len(record.events))
        busy = (acting or _total(loaded) > 0.0) and t - last >= per_sample
        if samples > 0 and (busy or struck or t - last >= stride or t == end):
            keep_row(n_history, state, record)
            n_history += 1
            last = t
        record.totals[STEPS] += 1.0
        if error < LONGER:
            level += 1
    return ended(record, DONE, end * system.tick, n_history, settle_events(record, n_events, m))


@kernel
def _acts(system: System, now: float) -> bool:
    """Whether a load other than the weight of bodies pushes."""
    acting = 0
    for i in range(len(system.loads)):
        if system.loads[i]["kind"] != CONSTANT and load_at(system, i, now) != 0.0:
            acting += 1
    return acting > 0


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
        elif system.interfaces[a]["release"] > 0:
            state.status[a] = AWAY
        else:
            touch(system, state, a, place[a], rate[a], 0.0)
            loaded[a] = 1.0 if state.status[a] == CLOSED and system.interfaces[a]["preload"] == 0.0 else 0.0
        if state.status[a] == CLOSED:
            state.force[a] = net_force(system, state, a, place[a], rate[a])
    for a in range(len(rate)):
        state.pace[a] = abs(rate[a])


@kernel
def _is_loaded(system: System, state: State, a: int, place: float, rate: float, least: float, before: float) -> float:
    """Whether a contact counts as closed: it has a force, or one above its preload."""
    if state.status[a] != CLOSED:
        return 0.0
    if system.interfaces[a]["preload"] == 0.0:
        return 1.0
    excess = net_force(system, state, a, place, rate)
    if abs(excess) <= least:
        return before
    return 1.0 if excess > 0.0 else 0.0


@kernel
def _confirm_step(system: System, state: State, trial: Trial, bounds: Floats, record: Record) -> None:
    """Let the events count whose contacts move beyond rounding in this step."""
    for a in range(len(system.interfaces)):
        if system.interfaces[a]["kind"] == LINK:
            continue
        offset = system.interfaces[a]["offset"]
        record.size[a, 0] = max(record.size[a, 0], bounds[a, 2] / DISPLACEMENT_ROUNDING + abs(offset))
        record.size[a, 1] = max(record.size[a, 1], bounds[a, 3] / DISPLACEMENT_ROUNDING)
        if record.newest[a] >= 0:
            for p in range(PLACES):
                if confirm(system, state, a, trial.place[a, p] + offset, trial.rate[a, p], record):
                    break


def levels_for(halvings: int) -> int:
    """Number of step lengths: from a tick to the longest step."""
    return halvings + LONGEST_DOUBLINGS + 1
