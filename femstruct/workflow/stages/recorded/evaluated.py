"""What a study asks of recorded histories one by one: shock response spectra, perception, and what others add."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final, NamedTuple

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import Finding
from femstruct.impact.evaluations.evaluation import Evaluation, Quoted
from femstruct.impact.evaluations.known_evaluations import EVALUATIONS
from femstruct.impact.result.averaged import averaged
from femstruct.impact.result.response import Response
from femstruct.study.recorded import Channel
from femstruct.study.study import Study
from femstruct.units import readable
from femstruct.workflow.stages.places import Places
from femstruct.workflow.stages.recorded.channels import motion_rows, moved
from femstruct.workflow.stages.recorded.peaks import CONVERGED

Answers = Mapping[str, Mapping[str, Any]]  # by kind and name
STATIC: Final = "the residual vectors (the static correction for the modes that are left out)"


class LessStatic(NamedTuple):
    """The same impact with less of the residual vectors, also in the force: what is kept of each mode [k], how that is
    said in short and before `STATIC`, and how far numbers may be apart then, as a share."""

    response: Response
    scales: Floats
    short: str
    way: str
    allowed: float


class OtherPush(NamedTuple):
    """By how many times what a body gives the structure is larger by another way, and that way."""

    times: float
    way: str


def nothing_evaluated() -> Answers:
    """Every kind of evaluation, with nothing where nothing is simulated."""
    return {key: {} for key in EVALUATIONS}


def evaluated(
    study: Study,
    places: Places,
    response: Response,
    channels: Mapping[str, Channel],
    beside: Sequence[LessStatic] = (),
    pushes: Sequence[OtherPush] = (),
) -> tuple[Answers, tuple[Finding, ...]]:
    """The answers, and what is to be known of them; every kind is there, with nothing where nothing is asked.

    They see the means of the motion about each sample, not its samples (`femstruct.impact.result.averaged`).
    beside : the same impact with less of the residual vectors, where contacts reach beyond the modes. pushes : what
    blows give by another way; all numbers are in proportion to it.
    """
    found: dict[str, dict[str, Any]] = {key: {} for key in EVALUATIONS}
    told: list[Finding] = []
    if not study.evaluations:
        return found, ()
    means, sampling = averaged(response), response.clock.sampling
    others = [(one, averaged(one.response)) for one in beside]
    true = np.array([kind != "residual" for kind in response.basis.kind])
    rows = motion_rows(study, places, response.basis)
    for one in study.evaluations:
        what, row = rows.get(one.channel, ("", None))
        values: Floats = channels[one.channel].values if row is None else moved(means, what, row)
        answer = found.setdefault(one.key(), {})[one.name] = one.answer(values, sampling)
        if row is None or true.all():
            continue
        alone = _Other(
            one.answer(moved(means, what, row * true), sampling), "modes alone", f"without {STATIC}", CONVERGED
        )
        less = [
            _Other(
                one.answer(moved(other, what, row * kept.scales), sampling),
                kept.short,
                f"{kept.way} {STATIC}",
                kept.allowed,
            )
            for kept, other in others
        ]
        less += [_Other(one.answer(push.times * values, sampling), push.way, push.way, CONVERGED) for push in pushes]
        told += _beside(one, answer, [alone, *less], response.basis.complete_below_hz)
    return found, tuple(told)


class _Other(NamedTuple):
    """The same answer by another way, said in short and in a sentence, and how far its numbers may be apart."""

    answer: Any
    short: str
    way: str
    allowed: float


def _beside(one: Evaluation, answer: Any, others: Sequence[_Other], complete_below_hz: float) -> Iterator[Finding]:
    """Numbers of an answer that residual vectors change by more than a little, or that are beyond the modes."""
    numbers = one.quoted(answer)
    by_ways = [(other, one.quoted(other.answer)) for other in others]
    worst: list[tuple[float, Quoted, Quoted, _Other]] = []
    for i, whole in enumerate(numbers):
        pairs = [(_apart(whole, found[i]) / other.allowed, whole, found[i], other) for other, found in by_ways]
        most = max(pairs, key=lambda pair: pair[0])
        if most[0] > 1.0 or max(whole.hz, most[2].hz) > complete_below_hz:
            worst.append(most)
    if not worst:
        return
    _, whole, told, other = max(worst, key=lambda pair: pair[0])
    factor, unit = readable(whole.unit, max(whole.value, told.value))
    more = f". So are {len(worst)} of its {len(numbers)} numbers" if worst[1:] else ""
    values = {"allowed": other.allowed, "apart": _apart(whole, told)}
    for _, a, b, which in worst:
        values |= {a.name: a.value, f"{b.name}, {which.short}": b.value}
    yield Finding(
        "evaluation-not-converged",
        f"{one.key()}.{one.name}: do not quote its {whole.name}. It is {factor * whole.value:.4g} {unit}, and "
        f"{factor * told.value:.4g} {unit} {other.way}, so it may change with the number of modes "
        f"and with the mesh{more}. Compute more modes",
        values,
    )


def _apart(a: Quoted, b: Quoted) -> float:
    larger = max(abs(a.value), abs(b.value))
    return abs(a.value - b.value) / larger if larger > 0.0 else 0.0
