"""One run of the march for laws that are not linear, at a tolerance."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from femstruct.impact.collocation.attempt import march_room
from femstruct.impact.collocation.collocation_march import ERROR_BUDGET, levels_for, march
from femstruct.impact.engine.gauss_points import collocation_rule
from femstruct.impact.engine.instant_forces import State
from femstruct.impact.engine.modal_tables import Tables
from femstruct.impact.engine.records import System
from femstruct.impact.engine.sampling import Record
from femstruct.impact.engine.system import Compiled

MAX_STEPS = 20_000_000
STEPS_BETWEEN_CHECKS = (
    200_000  # steps tried between two looks at the progress, at least: enough for thousands of closings
)
WORK_BETWEEN_CHECKS = 5e7  # and their number times SELF + n: about 4 s where the modes are not thousands
SELF = 30  # what a step costs beside its coordinates, 2.1 us against 0.07 us for each of them
LEDGER_ROWS = 2048  # at most, while nothing acts


class Ended(NamedTuple):
    """How a march ended, when [s], and how many ledger rows and events it left."""

    how: int
    when: float
    rows: int
    events: int

    @staticmethod
    def of(how: int, record: Record) -> Ended:
        """What a march that returned `how` has noted."""
        when, rows, events = record.ended
        return Ended(how, float(when), int(rows), int(events))


def state_at_start(compiled: Compiled) -> State:
    """The state that a scene starts from, before contacts close."""
    m, r = len(compiled.system.interfaces), len(compiled.system.rows)
    return State(
        z=compiled.start[0].copy(),
        v=compiled.start[1].copy(),
        status=np.zeros(m, dtype=np.int64),
        rest=np.zeros(m),
        pace=np.zeros(r),
        force=np.zeros(m),
    )


def collocate(
    compiled: Compiled, tolerance: float, tables: Tables, state: State, record: Record, finer: int = 0
) -> Ended:
    """March to the end of the record; state and record are filled on the way.

    tables : of all levels.
    finer : how often the longest step is halved, which a loose tolerance takes wherever it can.
    """
    system = compiled.system
    top_level = levels_for(compiled.halvings) - 1
    if finer:
        end = compiled.n_samples << compiled.halvings
        longest = 4 * max(end // LEDGER_ROWS, 1)  # as the march has it, for its ledger
        top_level = max(min(top_level, longest.bit_length() - 1) - finer, 0)
    how = march(
        system,
        state,
        collocation_rule(),
        tables,
        march_room(system),
        record,
        compiled.halvings,
        top_level,
        tolerance * ERROR_BUDGET,
        MAX_STEPS,
        paced(system),
    )
    return Ended.of(how, record)


def paced(system: System) -> int:
    """Steps tried between two looks at the progress of a run alone: at a pace at which MAX_STEPS are too few it ends.

    One look takes some seconds, so that a run which gets nowhere does not take minutes to say so; a burst of collisions
    may still be that slow for a hundredth of the window or more.
    """
    return max(int(WORK_BETWEEN_CHECKS / (SELF + len(system.omega))), STEPS_BETWEEN_CHECKS)
