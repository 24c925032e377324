"""Rooms rated by standards, and reasons not to take their numbers for measured ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

from numpy import log10

from acoustics.errors import Advice
from acoustics.judgement import t60_missed
from acoustics.levels import Levels, equivalent_levels
from acoustics.methods import Blows, Method, method_of, rating_of
from acoustics.pressure import RoomResponse
from acoustics.rated import RatedRoom, rate_room
from acoustics.room import t60_of
from femstruct.errors import Finding, some_of
from femstruct.impact.sources import BETWEEN_BLOWS, HAMMERS, TAPPING_MACHINE
from femstruct.study.study import RoomPlan, Study

TURN_S: Final = HAMMERS * BETWEEN_BLOWS  # all hammers of a tapping machine once
BUILT_UP_DB: Final = 0.2  # what may be missing of a tapping machine's level when averaging begins


def blows_of(study: Study) -> Blows:
    """Which blows a study's rooms are rated for."""
    return "tapping" if any(body.source == TAPPING_MACHINE for body in study.bodies) else "heavy"


def method_for(plan: RoomPlan, study: Study) -> Method | None:
    """How a room's standards rate a study's blows; None for a room that is not to be rated."""
    return method_of(plan.levels, blows_of(study)) if plan.levels and plan.receivers else None


def band_levels(
    study: Study, method: Method, whole: RoomResponse, end_hz: float, levels: Sequence[Levels]
) -> list[Mapping[float, float]]:
    """What the standards rate at every receiver of a room {nominal band [Hz]: [dB]}: the largest Fast levels, of a
    tapping machine those of the mean square while it runs.

    whole : the sound, before it ends at `end_hz`, above which bands are nan. levels : of the one that ends there.
    """
    if method.blows == "heavy":
        return [one.octaves_db if method.fraction == 1 else one.bands_db for one in levels]
    since, until = running(study)
    samples = round(until / whole.dt)
    return [equivalent_levels(p[:samples], whole.dt, since, method.fraction, end_hz) for p in whole.p]


def running(study: Study) -> tuple[float, float]:
    """From when to when the sound of a tapping machine is averaged [s]: whole turns of its hammers, the later half."""
    assert study.time is not None
    count = max(body.blows.count if body.blows else 1 for body in study.bodies if body.source == TAPPING_MACHINE)
    turns = min(count, int(study.time.duration / TURN_S + 1e-9))
    return (turns - max(1, turns // 2)) * TURN_S, turns * TURN_S


def rate_rooms(study: Study, drops: Sequence[Mapping[str, Sequence[Mapping[float, float]]]]) -> dict[str, RatedRoom]:
    """Every room that is to be rated, by name, from the levels of its receivers {room: [receivers]} at every drop."""
    return {
        plan.name: rate_room([drop[plan.name] for drop in drops], plan.room, plan.levels, blows_of(study))
        for plan in study.rooms
        if plan.levels and plan.receivers
    }


def rated_findings(plan: RoomPlan, study: Study, drops: int = 1) -> tuple[Advice | Finding, ...]:
    """Reverberation times missed, few places, and blows that the standards do not rate.

    drops : at how many places the source strikes.
    """
    found: list[Advice | Finding] = list(t60_missed(plan.room.losses, plan.t60_asked))
    method = method_for(plan, study)
    if method is None:
        return tuple(found)
    if min(drops, len(plan.receivers)) < method.fewest:
        found.append(
            Finding(
                "rating-of-few-places",
                f"measurements by {method.measured_by} have {method.fewest} or more places of the source and of "
                f"microphones; here are {drops} and {len(plan.receivers)}",
                {"drops": drops, "receivers": len(plan.receivers), "wanted": method.fewest},
            )
        )
    return (
        *found,
        *_other_blows(method, study),
        *(_building_up(plan, method, study) if method.blows == "tapping" else ()),
    )


def _other_blows(method: Method, study: Study) -> tuple[Finding, ...]:
    """A rating of something else than the one source that the standards rate."""
    tapping = method.blows == "tapping"
    wanted, count = method.source, HAMMERS if tapping else 1
    struck = [body for body in study.bodies if body.speed and body.side == "above"]
    others = [body.source or body.name for body in struck if body.source != wanted]
    here = len(struck) - len(others)
    pushed = [load.name for load in study.loads] + [walker.name for walker in study.walks]
    if not others and here == count and not pushed:
        return ()
    told = some_of(dict.fromkeys([*others, *pushed]))
    one = f"one {wanted}, five hammers" if tapping else f"one {wanted}"
    what = "hammers" if tapping else f"{wanted}s"
    here_are = f"strike {here} {what}{' and ' + told if told else ''}" if here else f"it is {told or 'nothing'}"
    elsewhere = rating_of(others[0]) if len(others) == 1 and not here else ()
    here_are += f", for {' or '.join(elsewhere)}" if elsewhere and not set(elsewhere) & set(method.standards) else ""
    return (
        Finding(
            "rating-of-other-blows",
            f"the levels of {' and '.join(method.standards)} are those of {one}; here {here_are}",
            {what.replace(" ", "_"): here, "others": len(others) + len(pushed)},
        ),
    )


def _building_up(plan: RoomPlan, method: Method, study: Study) -> tuple[Finding, ...]:
    """A tapping machine that has not run long enough for the room to fill with sound before levels are averaged."""
    since, until = running(study)
    t60 = max(t60_of(plan.room.losses, band) for band in method.bands_hz)
    missing = -10 * log10(1 - 10 ** (-6 * since / t60)) if since else float("inf")
    if missing <= BUILT_UP_DB:
        return ()
    short = f"is then {missing:.2g} dB short of its steady level" if since else "is silent then"
    return (
        Finding(
            "tapping-not-steady",
            f"levels are averaged from {since:g} to {until:g} s; a room with a reverberation time of {t60:.2g} s "
            f"{short}: give the machine more blows, and the time for them",
            {"since_s": since, "until_s": until, "t60_s": t60},
        ),
    )
