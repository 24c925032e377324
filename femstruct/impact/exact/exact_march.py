"""The exact march: power series of the present regime, cut at the first event, until the end."""

from __future__ import annotations

import numpy as np

from femstruct.impact.compiled.kernels import kernel, unit
from femstruct.impact.engine.booking import (
    DONE,
    FULL,
    NO_FORCES,
    STICKS,
    TOO_MANY_EVENTS,
    balance_books,
    goes_on,
    keep_row,
    log_changes,
    open_books,
)
from femstruct.impact.engine.closings import confirm, settle_events
from femstruct.impact.engine.instant_forces import CLAMPED, CLOSED, OPEN, State, copy_to, load_at, move_to
from femstruct.impact.engine.records import CONSTANT, HALF_SINE, LINK, System
from femstruct.impact.engine.sampling import STEPS, Record, ended
from femstruct.impact.exact.exact_constants import ORDER, PROBES, SHORT, THETA, ExactRoom, ExactRule
from femstruct.impact.exact.ledger import integrate_step, peaks_of_step, travels_of_step
from femstruct.impact.exact.next_event import switch, watch
from femstruct.impact.exact.regime import evaluate, expand, fastest, load_series, settle, shorten
from femstruct.impact.exact.roots import NEVER, value_of


@unit(seconds=11.0)
def exact_march(system: System, state: State, rule: ExactRule, room: ExactRoom, record: Record, end: float,
                interval: float, longest: float, max_steps: int) -> int:  # fmt: skip
    """Run to the end; returns how it ended; when, and the numbers of ledger rows and events, are in record.ended.

    end [s]; interval [s] : of the samples, and the longest step while a load acts; longest [s] : the longest step, and
    how far apart ledger rows may be otherwise. A record without samples keeps the first and the last ledger row only.
    """
    history, m, samples = record.history, len(system.interfaces), len(record.at)
    damped = False
    for i in range(system.n_modes):
        damped = damped or system.damping[i] > 0.0
    _begin(system, state, room)
    initial = open_books(system, state, room.here[:, 0], room.lost, record)
    kept, n_events, kink, at_once = 1, 0, 0, 0
    late = record.late_at[0] * system.tick if record.late_at[0] >= 0 else np.inf
    t, last, before, earlier = 0.0, 0.0, 0.0, 0.0
    while t < end:
        how = goes_on(record, max_steps)
        if how != DONE:
            return ended(record, how, t, kept, n_events)
        settle(system, state, room)
        bound, stiffness = fastest(system, room)
        while kink < len(system.kinks) and system.kinks[kink] * system.tick <= t:
            kink += 1
        limit = end
        if kink < len(system.kinks):
            limit = min(limit, system.kinks[kink] * system.tick)
        h, acting = limit - t, False
        for i in range(len(system.loads)):
            if system.loads[i]["kind"] != CONSTANT and load_at(system, i, t + 0.5 * min(h, interval)) != 0.0:
                acting = True
                if system.loads[i]["kind"] == HALF_SINE:
                    bound = max(bound, 2.0 * np.pi * system.loads[i]["frequency"])
        stiff = stiffness / bound if bound > 0.0 else 0.0
        room_left, cap = h, min(longest, interval if acting else np.inf)
        if bound * cap > THETA:
            cap = THETA / bound
        if h > cap:
            h = cap if h > 2.0 * cap else 0.5 * h
        order = 4
        while order < ORDER and rule.reach[order] < bound * h:
            order += 1
        first, where, who, what = before == 0.0 or at_once > 0, NEVER, -1, -1
        while True:  # what switches at this very instant shows in the first terms: most need no more of them
            terms = SHORT if first else order
            load_series(system, room, t, h, terms)
            expand(system, state, rule, room, h, terms)
            where, who, what = watch(system, state, terms, h, max(before, h), max(earlier, stiff), rule, room)
            if not first or where == 0.0:
                break
            first = False
        part = min(where, 1.0)
        now = t + part * h
        if where == NEVER and h == room_left:
            now = limit
        if now > t or part > 0.0:
            while record.kept[0] < samples and record.kept[0] * interval < now:
                s = record.kept[0]
                evaluate(room, h, order, (s * interval - t) / h)
                record.at[s], record.doublings[s] = s, 0
                copy_to(record.z[s], room.q)
                copy_to(record.v[s], room.v)
                for a in range(m):
                    record.status[s, a] = state.status[a]
                record.kept[0] += 1
            if part < 1.0:
                shorten(room, order, part)
            integrate_step(system, state, part * h, order, damped, rule, room)
            peaks_of_step(system, state, t, part * h, order, rule, room, record)
            travels_of_step(system, order, rule, room, record)
            _confirm_step(system, state, order, rule, room, record)
            evaluate(room, part * h, order, 1.0)
            move_to(state.z, state.v, room.q, room.v)
            room.fresh[:] = 0
            before, earlier = h, stiff
        at_once = at_once + 1 if now == t else 0
        if at_once > 100 + 10 * m:
            return ended(record, STICKS, t, kept, n_events)
        t = now
        if t >= late:
            copy_to(record.late, state.v)
            late = np.inf
        _look(system, state, room)
        if where < NEVER:
            switch(system, state, room, who, what, before)
        _release(system, state, room, t)
        touching, changed = 0.0, False
        for a in range(m):
            touching += room.loaded[a]
            changed = changed or room.loaded[a] != record.closed[a]
        told, row = samples or changed or t >= end, history[kept]
        if told and not balance_books(t, initial, system, state, room.here[:, 0], room.lost, row, record):
            return ended(record, NO_FORCES, t, kept, n_events)
        record.totals[STEPS] += 1.0
        n_events = log_changes(t, system, state, room.loaded, row, n_events, record)
        if n_events == FULL:
            return ended(record, TOO_MANY_EVENTS, t, kept, len(record.events))
        busy = (acting or touching > 0.0) and t - last >= interval * (1.0 - 1e-9)
        if t >= end or (samples and (busy or t - last >= 0.5 * longest)):
            keep_row(kept, state, record)
            kept += 1
            last = t
    return ended(record, DONE, t, kept, settle_events(record, n_events, m))


@kernel
def _begin(system: System, state: State, room: ExactRoom) -> None:
    """Preloaded contacts and links without a release time act, but for contacts whose dashpot would pull: their clamp
    holds; every other contact is open, touching or not, and closes at once when the leading derivative of its
    indentation says so."""
    room.lost[:] = 0.0
    room.loaded[:] = 0.0
    room.fresh[:] = 0
    for a in range(len(system.interfaces)):
        state.status[a] = OPEN
        if system.interfaces[a]["kind"] != LINK and system.interfaces[a]["preload"] > 0.0:
            state.status[a] = CLOSED
    _look(system, state, room)
    for a in range(len(system.interfaces)):
        law = system.interfaces[a]
        if state.status[a] == CLOSED and law["tensile"] == 0:
            force = law["stiffness"] * (room.here[a, 0] + law["offset"]) + law["closing"] * room.here[a, 1]
            if force < 0.0:
                state.status[a] = CLAMPED
    _release(system, state, room, 0.0)


@kernel
def _look(system: System, state: State, room: ExactRoom) -> None:
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
        room.here[a, 0], room.here[a, 1] = place, rate


@kernel
def _release(system: System, state: State, room: ExactRoom, t: float) -> None:
    """Links whose time has come act, from the elongation they have."""
    for a in range(len(system.interfaces)):
        law = system.interfaces[a]
        if law["kind"] == LINK and state.status[a] == OPEN and law["release"] * system.tick <= t:
            state.status[a], state.rest[a] = CLOSED, room.here[a, 0]
            room.way[a] = -1 if room.here[a, 1] < 0.0 else 1


@kernel
def _confirm_step(system: System, state: State, order: int, rule: ExactRule, room: ExactRoom, record: Record) -> None:
    """Let the events count whose contacts move beyond rounding in this step; room.terms has what they are summed from
    at its start."""
    for a in range(len(system.interfaces)):
        if system.interfaces[a]["kind"] == LINK:
            continue
        offset = system.interfaces[a]["offset"]
        record.size[a, 0] = max(record.size[a, 0], room.terms[a, 0] + abs(offset))
        record.size[a, 1] = max(record.size[a, 1], room.terms[a, 1])
        if record.newest[a] >= 0:
            for p in range(1, PROBES + 1):
                place = value_of(room.place[a], order, rule.at_probes[p])
                record.size[a, 0] = max(record.size[a, 0], abs(place))  # these steps are long
                speed = value_of(room.rate[a], order, rule.at_probes[p])
                if confirm(system, state, a, place + offset, speed, record):
                    break
