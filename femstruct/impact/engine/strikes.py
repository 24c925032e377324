"""Blows: a body is lifted off and given its starting state again, between two steps.

What it takes along (its motion, the energy of the contacts it is lifted off) and what it brings is booked by itself.
"""

from __future__ import annotations

from femstruct.arrays import Floats
from femstruct.impact.compiled.kernels import kernel
from femstruct.impact.engine.energy import BROUGHT, stored
from femstruct.impact.engine.instant_forces import (
    CLAMPED,
    CLOSED,
    DISPLACEMENT_ROUNDING,
    OPEN,
    State,
    copy_to,
    dot,
    law,
    net_force,
    rows_now,
    terms_of,
)
from femstruct.impact.engine.records import LINK, System
from femstruct.impact.engine.sampling import Record

ENERGY, MOMENTUM, HELD, SINCE = 0, 1, 2, 3  # columns of a strike in the record
REST_FORCE_ERROR = 0.1  # of its weight: what the contact force under a body that lies still may miss


@kernel
def lies(force: float, weight: float) -> bool:
    """Whether a body under gravity lay still on a contact of this force when it was lifted off."""
    return abs(force - weight) <= REST_FORCE_ERROR * weight


@kernel
def touch(system: System, state: State, a: int, place: float, rate: float, margin: float) -> None:
    """Status of a contact whose ends were just put where they are: it closes when it is indented, or when it touches
    and its ends approach; touching without speed it is open until the leading derivative closes it."""
    delta = place + system.interfaces[a]["offset"]
    if not (delta > margin or (delta >= -margin and rate > 0.0)):
        state.status[a] = OPEN
    elif delta > margin and system.interfaces[a]["tensile"] == 0 and law(system, a, delta, rate)[0] < 0.0:
        state.status[a] = CLAMPED
    else:
        state.status[a] = CLOSED


@kernel
def first_strike(system: System, number: int, state: State, record: Record) -> None:
    """Book a blow at t = 0: it is the start itself, its energy is that of the start."""
    coordinate = system.strikes[number]["coordinate"]
    record.strikes[number, ENERGY] = 0.5 * state.v[coordinate] ** 2
    record.strikes[number, MOMENTUM] = state.v[coordinate]
    for a in range(len(system.interfaces)):
        if system.rows[a, coordinate] != 0.0:
            record.latest[a] = number


@kernel
def strike(now: float, t: int, number: int, system: System, state: State, place: Floats, rate: Floats, loaded: Floats,
           closed_at: Floats, lost: Floats, record: Record) -> None:  # fmt: skip
    """Lift a body off and let it strike again; place and rate of all rows are renewed.

    Peaks since the last blow go to the record of that blow, and begin again.
    """
    m, i = len(system.interfaces), system.strikes[number]["coordinate"]
    mine = record.strikes[number]
    mine[ENERGY] = -0.5 * state.v[i] ** 2
    for a in range(m):
        if system.rows[a, i] != 0.0:
            mine[ENERGY] -= stored(system, state, a, place[a])
            if loaded[a] > 0.0:
                mine[HELD] = max(mine[HELD], net_force(system, state, a, place[a], rate[a]))
                mine[SINCE] = closed_at[a]
            copy_to(record.strike_peak[record.latest[a], a], record.peak[a])
            record.peak[a] = 0.0
            record.latest[a] = number
    mine[MOMENTUM] = -state.v[i]
    over = system.strikes[number]["over"]
    below = dot(system.over[over], state.z)
    if len(system.over_tilts):
        below += dot(system.over_tilts[over], state.v)
    state.z[i] = below
    state.v[i] = system.strikes[number]["velocity"]
    mine[MOMENTUM] += state.v[i]
    mine[ENERGY] += 0.5 * state.v[i] ** 2
    rows_now(system, state.z, state.v, place, rate)
    for a in range(m):
        state.pace[a] = max(state.pace[a], abs(rate[a]))
        if system.rows[a, i] != 0.0 and system.interfaces[a]["kind"] != LINK and system.interfaces[a]["release"] <= t:
            margin = DISPLACEMENT_ROUNDING * terms_of(system, a, state.z, state.v)
            touch(system, state, a, place[a], rate[a], margin)
            mine[ENERGY] += stored(system, state, a, place[a])
            loaded[a] = 1.0 if state.status[a] == CLOSED else 0.0
            if loaded[a] > 0.0:
                closed_at[a] = now
                force = law(system, a, place[a] + system.interfaces[a]["offset"], rate[a])[0]
                record.peak[a, 0], record.peak[a, 1] = force, now
    lost[m + BROUGHT] += mine[ENERGY]
