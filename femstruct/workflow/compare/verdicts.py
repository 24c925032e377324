"""Verdicts on the limits of a study. A limit that is exceeded is a result, not a failure: it has no exit code."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import isfinite
from typing import TypeVar

import numpy as np

from acoustics.levels.rated import RatedRoom
from femstruct.errors import InputError, some_of
from femstruct.impact.closer import ENOUGH, samples_of_a_pulse
from femstruct.impact.result.blow_by_blow import AT_REST, structure_energy
from femstruct.impact.result.response import Response
from femstruct.study.asked import SETTLED, Limit
from femstruct.study.machine import Verdict
from femstruct.study.recorded import Channel
from femstruct.study.result import CaseResult, Drop
from femstruct.study.study import Study
from femstruct.workflow.stages.places import Places
from femstruct.workflow.stages.recorded.channels import record
from femstruct.workflow.stages.recorded.peaks import converged
from femstruct.workflow.stages.recorded.windowed_peaks import closings

T = TypeVar("T")
SAME = 1e-9  # relative rounding of an interval that is a difference of two times


def verdicts(case: CaseResult) -> tuple[Verdict, ...]:
    """What came of every limit of a case: peaks are those of the whole window, through the filter of `peaks`.

    Where a source strikes several places, of each limit the worst over the drops; ratings are of all drops together.
    """
    if case.response is None:
        return ()
    limits = case.case.study.limits
    own = _of_one_run(limits, case.channels, case.response) if not case.drops else _worst(case.drops)
    found = iter(own)
    return tuple(
        _rating(limit, _known(limit, limit.room, case.rated)) if limit.room else next(found) for limit in limits
    )


def judged(study: Study, places: Places, response: Response) -> tuple[Verdict, ...]:
    """What came of the limits of one drop of several, but for those of ratings."""
    if not any(not limit.room for limit in study.limits):
        return ()
    return _of_one_run(study.limits, record(study, places, response, {}), response)


def _of_one_run(limits: Sequence[Limit], channels: Mapping[str, Channel], response: Response) -> tuple[Verdict, ...]:
    """Without those of ratings, which are of all drops."""
    exact = {f"{name} force" for name in response.contacts}
    least = set(channels) - exact if samples_of_a_pulse(response) < ENOUGH else set()
    return tuple(
        _settled(limit, response)
        if limit.name == SETTLED
        else _peak(limit, _known(limit, limit.name, channels), limit.name in least)
        for limit in limits
        if not limit.room
    )


def _known(limit: Limit, name: str, found: Mapping[str, T]) -> T:
    """What a limit is of. Raises InputError for what is not recorded, or not rated: a study in Python may have it."""
    if name not in found:
        what = "a rated room" if limit.room else f"a recorded channel or {SETTLED}"
        raise InputError(f"limits.{limit.name}", got=f"'{name}'", expected=f"{what}: {some_of(found)}".rstrip(": "))
    return found[name]


def _worst(drops: Mapping[str, Drop]) -> tuple[Verdict, ...]:
    """Of every limit the verdict of the worst drop, with its place."""
    by_limit = zip(*(drop.verdicts for drop in drops.values()), strict=True)
    found = []
    for several in by_limit:
        place, worst = max(zip(drops, several, strict=True), key=lambda pair: _badness(pair[1]))
        found.append(replace(worst, name=_common([one.name for one in several]), at=place))
    return tuple(found)


def _badness(verdict: Verdict) -> tuple[int, float]:
    """Exceeded is worse than not seen, and that than met; then the larger value is, and most of all none."""
    rank = 2 if verdict.met is False else 1 if verdict.met is None else 0
    return rank, np.inf if verdict.value is None else verdict.value


def _common(names: Sequence[str]) -> str:
    """What a limit is called for all drops.

    >>> _common(["ball on drops.1 force", "ball on drops.2 force"])
    'ball on drops force'
    """
    words = zip(*(name.split(" ") for name in names), strict=True)
    return " ".join(one[0] if len(set(one)) == 1 else one[0].rpartition(".")[0] for one in words)


def _rating(limit: Limit, room: RatedRoom) -> Verdict:
    """The number that the room's standards state, as a building code asks for it; of a lower bound it can only be told
    that it is too high."""
    if room.rating is None:  # withheld
        return Verdict(limit.name, None, limit.value, "dB", None, least=True)
    value = room.rating.value_db
    if not room.rating.blank_hz:
        met, beyond = value <= limit.value, room.rating.statistical
        return Verdict(limit.name, value, limit.value, "dB", met, statistical=beyond)
    least = value if isfinite(value) else None
    return Verdict(limit.name, least, limit.value, "dB", False if value > limit.value else None, least=True)


def _peak(limit: Limit, channel: Channel, least: bool) -> Verdict:
    """least : whether the peak is a lower bound."""
    if not isfinite(channel.whole):  # its samples are too coarse to tell
        return Verdict(limit.name, None, limit.value, channel.unit, None, least=True)
    met = channel.whole <= limit.value
    verdict = None if met and least else met
    sure = converged(channel)
    return Verdict(limit.name, channel.whole, limit.value, channel.unit, verdict, least=least, converged=sure)


def _settled(limit: Limit, response: Response) -> Verdict:
    """The longest time to rest; not at rest in an interval no shorter than the limit is an answer, too."""
    waits = settling(response)
    seen = min((interval for after, interval in waits if after is None), default=0.0)
    late = any(
        after > limit.value if after is not None else interval >= limit.value * (1.0 - SAME)
        for after, interval in waits
    )
    told = [after for after, _ in waits if after is not None]
    value = max(told) if told and len(told) == len(waits) else None
    met = False if late else None if value is None else True
    return Verdict(limit.name, value, limit.value, "s", met, seen if value is None else None)


def settling(response: Response) -> tuple[tuple[float | None, float], ...]:
    """After every blow, the time until the structure has less than 1 % of its largest energy for good [s], None when it
    has not in its interval, and that interval [s], to the end of the window at most.

    Without blows: once, from the first closing on (from the start where nothing closes).
    """
    if response.blows:
        return tuple((blow.rest_after, blow.interval) for blow in response.blows)
    start = min((event.t for event in closings(response)), default=0.0)
    energy = structure_energy(response.motion, response.basis.omega)
    loud = np.flatnonzero(energy > AT_REST * energy.max(initial=0.0))
    if not loud.size:
        return ((0.0, float(response.t[-1]) - start),)
    after = float(response.t[min(loud[-1] + 1, len(energy) - 1)]) - start
    return ((after if loud[-1] + 1 < len(energy) else None, float(response.t[-1]) - start),)
