"""What ends a regime: the first instant at which a contact or a one-way dashpot must change what it does.

Every condition is a polynomial that must not become negative: minus the indentation of an open contact, the
indentation or the force of a closed one, the speed of a link in the sense it has. A condition that is zero at the
start of a step, by an event or by rounding, is decided by its first coefficient that is not; so is one that the next
terms outgrow at once.
"""

from __future__ import annotations

import numpy as np

from femstruct.arrays import Floats
from femstruct.impact.compiled.kernels import kernel
from femstruct.impact.engine.instant_forces import CLAMPED, CLOSED, OPEN, PRELOAD, State, terms_of, terms_of_rate
from femstruct.impact.engine.records import LINK, System
from femstruct.impact.exact.exact_constants import ExactRoom, ExactRule
from femstruct.impact.exact.roots import NEVER, first_descent, magnitude, stays_positive

INDENTATION, FORCE, SPEED, EXCESS = 0, 1, 2, 3  # what crossed zero; the first three are columns of fresh
DISPLACEMENT_ROUNDING = 4e-15  # of a row's displacement, relative to the terms it is summed from
AT_ONCE = 1e-20  # of a step: less than a place in it, or the time, can tell from its start


@kernel
def _outgrown(c: Floats, lead: int, order: int) -> bool:
    """Whether a later term is larger than the leading one already AT_ONCE after the start."""
    reach = AT_ONCE
    for k in range(lead + 1, order + 1):
        if abs(c[k]) * reach > abs(c[lead]):
            return True
        reach *= AT_ONCE
    return False


@kernel
def judge(c: Floats, order: int, noise: float, small: float, fresh: int, rule: ExactRule, boxes: Floats,
          spans: Floats) -> tuple[float, int]:  # fmt: skip
    """Where the polynomial becomes negative (NEVER: not in this step), and its leading order when that is at once.

    noise : rounding of its value; small : of its other coefficients; fresh : whether it is zero by an event.
    """
    lead = 0
    if fresh or abs(c[0]) <= noise:
        lead = 1
        while lead <= order and abs(c[lead]) <= small:
            lead += 1
    rest = magnitude(c, lead + 1, order)
    while lead <= order and abs(c[lead]) <= AT_ONCE * rest and _outgrown(c, lead, order):
        lead += 1
        while lead <= order and abs(c[lead]) <= small:
            lead += 1
        rest = magnitude(c, lead + 1, order)
    if lead > order:
        return NEVER, 0
    if c[lead] < 0.0:
        return 0.0, lead
    if c[lead] > rest or stays_positive(c, lead, order, rule.coarse):
        return NEVER, 0
    return first_descent(c, lead, order, rule.bernstein, boxes, spans), order + 1


@kernel
def watch(system: System, state: State, order: int, h: float, before: float, stiff: float, rule: ExactRule,
          room: ExactRoom) -> tuple[float, int, int]:  # fmt: skip
    """The first change in the step: where (NEVER: none), of which interface, and what crossed zero.

    before [s] : length of the last step, whose end is known to the rounding of its own series only. stiff [1/s] : of
    both, the stiffness over unit mass divided by the bound of the rates, w^2 / x. In a step, THETA / x at most, springs
    turn rounding of a displacement into THETA stiff times as much of a speed; dashpots give a speed THETA times its own
    at most, however fast they are. Of several changes at one place the one with the lowest leading order comes
    first: the others depend on it.
    """
    where, rank, who, what = NEVER, order + 2, -1, -1
    c, boxes, spans = room.watched, room.boxes, room.spans
    shake = 0.0  # acceleration by the rounding of what springs and dashpots see: no contact closes or opens for it
    for a in range(len(system.interfaces)):
        still, moving = terms_of(system, a, state.z, state.v), terms_of_rate(system, a, state.z, state.v)
        room.terms[a, 0], room.terms[a, 1], room.terms[a, 2] = still, moving, np.sqrt(system.mobility[a])
        held = room.spring[a] * (still + max(h, before) * moving + abs(system.interfaces[a]["offset"]))
        lost = room.dash[a] * (moving + 2.0 * stiff * still)
        shake += DISPLACEMENT_ROUNDING * room.terms[a, 2] * (held + lost)
    for a in range(len(system.interfaces)):
        law, status, place, rate = system.interfaces[a], state.status[a], room.place[a], room.rate[a]
        link = law["kind"] == LINK
        if link and (status != CLOSED or law["closing"] == law["opening"]):
            continue
        clamps = not link and law["tensile"] == 0 and law["closing"] > 0.0
        still, moving = room.terms[a, 0], room.terms[a, 1]
        noise = DISPLACEMENT_ROUNDING * (still + max(h, before) * moving + abs(law["offset"]))
        noise_rate = DISPLACEMENT_ROUNDING * (moving + 2.0 * stiff * still)
        shaken = h * h * room.terms[a, 2] * shake
        small = DISPLACEMENT_ROUNDING * (4.0 * still + h * moving) + shaken
        small_rate = 2.0 * (stiff * noise + noise_rate)
        for kind in range(4):
            doubt, lesser = noise, small
            if kind == SPEED:
                if not link:
                    continue
                side = -1.0 if room.way[a] < 0 else 1.0
                by_place, by_rate, constant = 0.0, side * h, 0.0
                doubt, lesser = h * noise_rate, h * small_rate + shaken
            elif link:
                continue
            elif kind == INDENTATION:
                if status == CLOSED and clamps:
                    continue
                side = -1.0 if status == OPEN else 1.0
                by_place, by_rate, constant = side, 0.0, side * law["offset"]
            else:
                if (kind == FORCE and (status == OPEN or not clamps)) or (
                    kind == EXCESS and (status != CLOSED or law["preload"] == 0.0)
                ):
                    continue
                side = 1.0 if (status == CLOSED if kind == FORCE else room.loaded[a] > 0.0) else -1.0
                by_place, by_rate = side * law["stiffness"], side * law["closing"]
                doubt = law["stiffness"] * noise + law["closing"] * noise_rate
                if kind == FORCE:
                    constant = by_place * law["offset"]
                    lesser = (law["stiffness"] + law["closing"] / h) * small
                else:
                    constant, doubt, lesser = max(PRELOAD * law["preload"], doubt), 0.0, 0.0
            for k in range(order + 1):
                c[k] = by_place * place[k] + by_rate * rate[k]
            c[0] += constant
            fresh = 0 if kind == EXCESS else room.fresh[a, kind]
            at, order_here = judge(c, order, doubt, lesser, fresh, rule, boxes, spans)
            if at < where or (at == where and at < NEVER and order_here < rank):
                where, rank, who, what = at, order_here, a, kind
    return where, who, what


@kernel
def switch(system: System, state: State, room: ExactRoom, a: int, what: int, before: float) -> None:
    """Let interface a do what follows from a condition at zero; its row is in room.here."""
    law = system.interfaces[a]
    if what != EXCESS:
        room.fresh[a, what] = 1
    if what == SPEED:
        room.way[a] = 1 if room.way[a] < 0 else -1
    elif what == EXCESS:
        room.loaded[a] = 1.0 - room.loaded[a]
    elif what == INDENTATION:
        state.status[a] = CLOSED if state.status[a] == OPEN else OPEN
    elif state.status[a] == CLOSED:
        depth = room.here[a, 0] + law["offset"]
        margin = DISPLACEMENT_ROUNDING * (
            terms_of(system, a, state.z, state.v) + before * terms_of_rate(system, a, state.z, state.v) + law["offset"]
        )
        state.status[a] = CLAMPED if depth > margin else OPEN
    else:
        state.status[a] = CLOSED
    if law["kind"] != LINK:
        if state.status[a] != CLOSED:
            room.loaded[a] = 0.0
        elif law["preload"] == 0.0:
            room.loaded[a] = 1.0
