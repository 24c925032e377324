"""Which closings and openings count: those that lead farther than displacements are known.

A contact that grazes opens and closes for rounding, and one that decays does so for ever: how often depends on the
march. So an event counts when, before its contact's next one, the indentation after a closing or the gap after an
opening exceeds RESOLVED of what the displacement was summed from so far. The others are not reported.
"""

from __future__ import annotations

import numpy as np

from femstruct.arrays import Floats
from femstruct.impact.compiled.kernels import kernel
from femstruct.impact.engine.energy import TIME
from femstruct.impact.engine.instant_forces import CLAMPED, CLOSED, State, copy_to, sense
from femstruct.impact.engine.records import System
from femstruct.impact.engine.sampling import Record

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
