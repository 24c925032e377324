"""What both marches keep account of: how they end, their trials, the ledger's drift, closings and openings."""

from __future__ import annotations

import numpy as np

from femstruct.arrays import Floats
from femstruct.impact.compiled.kernels import kernel
from femstruct.impact.engine.closings import CERTAIN, CLOSES, DOUBTFUL, OPENS, log_event
from femstruct.impact.engine.energy import BROUGHT, GIVEN, TIME, WORK, modal_energies, part_energies, take_stock
from femstruct.impact.engine.instant_forces import State, copy_to
from femstruct.impact.engine.records import System
from femstruct.impact.engine.sampling import DRIFT, TRIALS, WORKED, Record

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
