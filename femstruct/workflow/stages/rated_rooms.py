"""Rooms rated by standards, and reasons not to take their numbers for measured ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import inf, isfinite, log, log10
from types import MappingProxyType
from typing import Final

import numpy as np

from acoustics.errors import Advice
from acoustics.levels.ensemble import Ensemble
from acoustics.levels.methods import Blows, Method, method_of, rating_of, sources_of
from acoustics.levels.rated import RatedRoom, rate_room
from acoustics.levels.sound_levels import Levels, equivalent_levels
from acoustics.room_response import RoomResponse
from acoustics.rooms.room_advice import t60_missed
from acoustics.statistical.statistical_bands import StatisticalBands
from femstruct.errors import Finding, some_of
from femstruct.impact.scene.impact_sources import BETWEEN_BLOWS, HAMMERS, TAPPING_MACHINE
from femstruct.modal.basis import ModalBasis
from femstruct.study.asked import RoomPlan
from femstruct.study.study import Study

TURN_S: Final = HAMMERS * BETWEEN_BLOWS  # all hammers of a tapping machine once
FALLEN_DB: Final = 40.0  # between blows that are to be heard alone
NO_STATISTICS: Final[Mapping[str, StatisticalBands]] = MappingProxyType({})
NO_ENSEMBLES: Final[Mapping[str, Ensemble]] = MappingProxyType({})
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
    more = 10 * log10((until - since) / TURN_S) if apart(study) else 0.0  # ten blows a second instead of five in all
    found = [equivalent_levels(p[:samples], whole.dt, since, method.fraction, end_hz) for p in whole.p]
    return [{band: level + more for band, level in one.items()} for one in found]


def apart(study: Study) -> float:
    """Time between the blows of a tapping machine whose blows are uncorrelated [s]; 0 for any other."""
    alone = [body.blows for body in study.bodies if body.source == TAPPING_MACHINE and body.blows and body.blows.alone]
    return study.time.duration / HAMMERS if alone and study.time is not None else 0.0


def running(study: Study) -> tuple[float, float]:
    """From when to when the sound of a tapping machine is averaged [s]: whole turns of its hammers, the later half; of
    blows that are apart all of it.

    Notes
    -----
    Blows of a real machine come a few milliseconds early or late, so that above about 100 Hz their sounds are
    uncorrelated and add in energy: p^2 = f_r mean_k int p_k^2 dt, p_k the sound of hammer k alone, f_r = 10/s. Those of
    blows exactly 0.1 s apart have lines at multiples of 10 Hz, which meet single modes or miss them.
    """
    assert study.time is not None
    if apart(study):
        return 0.0, study.time.duration
    count = max(body.blows.count if body.blows else 1 for body in study.bodies if body.source == TAPPING_MACHINE)
    turns = min(count, int(study.time.duration / TURN_S + 1e-9))
    return (turns - max(1, turns // 2)) * TURN_S, turns * TURN_S


def rate_rooms(
    study: Study,
    drops: Sequence[Mapping[str, Sequence[Mapping[float, float]]]],
    statistical: Mapping[str, StatisticalBands] = NO_STATISTICS,
    ensembles: Mapping[str, Ensemble] = NO_ENSEMBLES,
) -> dict[str, RatedRoom]:
    """Every room that is to be rated, by name, from the levels of its receivers {room: [receivers]} at every drop.

    Of blows that the standards do not rate there are bands, and no single numbers. statistical : levels by room that
    stand where modes have none. ensembles : of low bands, by room.
    """
    found = {}
    for plan in study.rooms:
        method = method_for(plan, study)
        if method is not None:
            beside = statistical.get(plan.name), ensembles.get(plan.name)
            rated = rate_room([drop[plan.name] for drop in drops], plan.room, plan.levels, method.blows, *beside)
            other = bool(_other_blows(method, study))
            found[plan.name] = replace(rated, method=replace(rated.method, numbers=())) if other else rated
    return found


def rated_findings(plan: RoomPlan, study: Study, drops: int = 1) -> tuple[Advice | Finding, ...]:
    """Reverberation times missed, few places, and blows that the standards do not rate: what takes no modes.

    drops : at how many places the source strikes.
    """
    found: list[Advice | Finding] = list(t60_missed({f: plan.room.t60(f) for f in plan.t60_asked}, plan.t60_asked))
    method = method_for(plan, study)
    if method is None:
        return tuple(found)
    if min(drops, len(plan.receivers)) < method.fewest:
        found.append(
            Finding(
                "rating-of-few-places",
                f"{method.measured_by} requires {method.fewest} or more positions of the source and of microphones; "
                "here "
                f"are {drops} and {len(plan.receivers)}",
                {"drops": drops, "receivers": len(plan.receivers), "wanted": method.fewest},
            )
        )
    return (
        *found,
        *_other_blows(method, study),
        *(_building_up(plan, method, study) if method.blows == "tapping" and not apart(study) else ()),
    )


def overlap_findings(plan: RoomPlan, study: Study, basis: ModalBasis) -> tuple[Finding, ...]:
    """Blows of a tapping machine, rated one by one, of which the floor or the room remembers the one before.

    basis : damped.
    """
    method = method_for(plan, study)
    return _overlapping(plan, method, study, basis) if method is not None and apart(study) else ()


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
    one = f"one {wanted} with five hammers" if tapping else f"one {wanted}"
    if not tapping and TAPPING_MACHINE in sources_of(method.standards):
        one += f" or a {TAPPING_MACHINE}"
    what = "hammers" if tapping else f"{wanted}s"
    here_are = f"{here} {what}{' and ' + told if told else ''} strike" if here else f"the source is {told or 'missing'}"
    elsewhere = rating_of(others[0]) if len(others) == 1 and not here else ()
    here_are += f", for {' or '.join(elsewhere)}" if elsewhere and not set(elsewhere) & set(method.standards) else ""
    return (
        Finding(
            "rating-of-other-blows",
            f"levels by {' and '.join(method.standards)} require {one}; here {here_are}"
            f"{': single numbers are withheld' if method.numbers else ''}",
            {what.replace(" ", "_"): here, "others": len(others) + len(pushed)},
        ),
    )


def _overlapping(plan: RoomPlan, method: Method, study: Study, basis: ModalBasis) -> tuple[Finding, ...]:
    """Uncorrelated blows that come before the sound of the last one has died away, so that they are not heard alone."""
    lowest = method.bands_hz[0] * 10**-0.05
    t60 = max(plan.room.t60(band, method.fraction) for band in method.bands_hz)
    rated = (basis.frequency_hz >= lowest) & (np.array(basis.kind) == "elastic")
    decay = np.diag(basis.time_damping)[rated].min(initial=inf)  # of a mode's energy [1/s]
    floor_t60 = 6 * log(10) / decay if decay > 0 else inf
    fallen, least = 60 * apart(study) / max(t60, floor_t60), HAMMERS * max(t60, floor_t60) * FALLEN_DB / 60
    if fallen >= FALLEN_DB:
        return ()
    whose = "room" if t60 >= floor_t60 else "floor"
    enough = f"'time: {{duration: {least:.2g} s}}'" if isfinite(least) else "a 'damping', without which it never decays"
    return (
        Finding(
            "blows-overlap",
            f"uncorrelated blows are {apart(study):.3g} s apart; the sound of the {whose}, with a reverberation time "
            f"of {max(t60, floor_t60):.2g} s, decays by {fallen:.0f} dB between them; {FALLEN_DB:g} dB are needed "
            f"for an error below 0.1 dB. Give the study {enough}",
            {"apart_s": apart(study), "fallen_db": fallen, "wanted_db": FALLEN_DB, "t60_s": max(t60, floor_t60)},
        ),
    )


def _building_up(plan: RoomPlan, method: Method, study: Study) -> tuple[Finding, ...]:
    """A tapping machine that has not run long enough for the room to fill with sound before levels are averaged."""
    since, until = running(study)
    t60 = max(plan.room.t60(band, method.fraction) for band in method.bands_hz)
    missing = -10 * log10(1 - 10 ** (-6 * since / t60)) if since else float("inf")
    if missing <= BUILT_UP_DB:
        return ()
    short = f"is then {missing:.2g} dB below its steady level" if since else "is then silent"
    return (
        Finding(
            "tapping-not-steady",
            f"levels are averaged from {since:g} to {until:g} s; a room with a reverberation time of {t60:.2g} s "
            f"{short}. Give the machine more blows, and a longer time",
            {"since_s": since, "until_s": until, "t60_s": t60},
        ),
    )
