"""One trial step: its forces, its error, and whether a contact changes in it. Compiled by itself."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from femstruct.impact.collocation.events import strays, watch
from femstruct.impact.compiled.byte_layout import Matrix, Vector
from femstruct.impact.compiled.kernels import unit
from femstruct.impact.engine.energy import INTEGRATED
from femstruct.impact.engine.gauss_points import STAGES, Rule
from femstruct.impact.engine.instant_forces import State
from femstruct.impact.engine.modal_tables import Tables
from femstruct.impact.engine.propagate import Trial, trial_room, try_step
from femstruct.impact.engine.records import System

REFUSED = -1  # a step whose error is too large, or whose forces were not found
ERROR, PART = 0, 1  # columns of what is found


class Room(NamedTuple):
    """Work space of a march. trial : of its steps, with their work space. lost [m + INTEGRATED] : dissipated by
    interfaces, by modes; work; brought by blows; given to coupled modes. bounds [m, 4] : what interpolation can miss of
    an interface. work [s + 4, n]. loaded, closed_at [m] : whether a contact counts as closed, and since when. place,
    rate [r] : of the rows.
    found [2] : of a trial step: its error over what is allowed, and the part of it before the first change of status.
    """

    trial: Trial
    lost: Vector
    bounds: Matrix
    work: Matrix
    loaded: Vector
    closed_at: Vector
    place: Vector
    rate: Vector
    found: Vector


def march_room(system: System) -> Room:
    """Work space for marches of a system of this size."""
    n, r, m = len(system.omega), len(system.rows), len(system.interfaces)
    return Room(
        trial=trial_room(system),
        lost=np.zeros(m + INTEGRATED),
        bounds=np.zeros((m, 4)),
        work=np.zeros((STAGES + 4, n)),
        loaded=np.zeros(m),
        closed_at=np.zeros(m),
        place=np.zeros(r),
        rate=np.zeros(r),
        found=np.zeros(2),
    )


@unit(seconds=6.0)
def attempt(now: float, level: int, system: System, state: State, rule: Rule, tables: Tables, room: Room,
            tolerance: float) -> int:  # fmt: skip
    """Try a step of tick 2^level from now on; what the watch over the contacts says of it, or REFUSED.

    One that is a tick long is taken whatever its error, as long as its forces were found.
    """
    h = system.tick * float(1 << level)
    error = try_step(now, level, h, system, state, rule, tables, room.trial, tolerance)
    room.found[ERROR] = error
    if not error < np.inf or (error > 1.0 and level > 0):
        return REFUSED
    strays(level, h, system, state, rule, tables, room.trial, room.bounds)
    answer, part = watch(h, system, state, rule, room.trial, room.bounds, room.loaded)
    room.found[PART] = part
    return answer
