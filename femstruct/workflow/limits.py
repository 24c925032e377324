"""Verdicts on the limits of a study. A limit that is exceeded is a result, not a failure: no exit code tells of it."""

from __future__ import annotations

import numpy as np

from femstruct.impact.blows import AT_REST, structure_energy
from femstruct.impact.response import Response
from femstruct.language.limits import SETTLED
from femstruct.study.machine import Verdict
from femstruct.study.result import CaseResult
from femstruct.study.study import Limit
from femstruct.workflow.channels import closings

SAME = 1e-9  # relative rounding of an interval that is a difference of two times


def verdicts(case: CaseResult) -> tuple[Verdict, ...]:
    """What came of every limit of a case: peaks are those of the whole window, through the filter of `peaks`."""
    if case.response is None:
        return ()
    response = case.response
    return tuple(
        _settled(limit, response) if limit.name == SETTLED else _peak(limit, case) for limit in case.case.study.limits
    )


def _peak(limit: Limit, case: CaseResult) -> Verdict:
    channel = case.channels[limit.name]
    return Verdict(limit.name, channel.whole, limit.value, channel.unit, channel.whole <= limit.value)


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
