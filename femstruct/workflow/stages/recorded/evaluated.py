"""What a study asks of recorded histories one by one: shock response spectra, perception, and what others add."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

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


def nothing_evaluated() -> Answers:
    """Every kind of evaluation, with nothing where nothing is simulated."""
    return {key: {} for key in EVALUATIONS}


def evaluated(
    study: Study, places: Places, response: Response, channels: Mapping[str, Channel]
) -> tuple[Answers, tuple[Finding, ...]]:
    """The answers, and what is to be known of them; every kind is there, with nothing where nothing is asked.

    They see the means of the motion about each sample, not its samples (`femstruct.impact.result.averaged`).
    """
    found: dict[str, dict[str, Any]] = {key: {} for key in EVALUATIONS}
    told: list[Finding] = []
    if not study.evaluations:
        return found, ()
    means, sampling = averaged(response), response.clock.sampling
    true = np.array([kind != "residual" for kind in response.basis.kind])
    rows = motion_rows(study, places, response.basis)
    for one in study.evaluations:
        what, row = rows.get(one.channel, ("", None))
        values: Floats = channels[one.channel].values if row is None else moved(means, what, row)
        answer = found.setdefault(one.key(), {})[one.name] = one.answer(values, sampling)
        if row is not None and not true.all():
            alone = one.answer(moved(means, what, row * true), sampling)
            told += _beside_modes_alone(one, answer, alone, response.basis.complete_below_hz)
    return found, tuple(told)


def _beside_modes_alone(one: Evaluation, answer: Any, alone: Any, complete_below_hz: float) -> Iterator[Finding]:
    """Numbers of an answer of which residual vectors make more than a little, or that are beyond the modes."""
    pairs = list(zip(one.quoted(answer), one.quoted(alone), strict=True))
    apart = [
        (whole, modes)
        for whole, modes in pairs
        if _apart(whole, modes) > CONVERGED or max(whole.hz, modes.hz) > complete_below_hz
    ]
    if not apart:
        return
    whole, modes = max(apart, key=lambda pair: _apart(*pair))
    factor, unit = readable(whole.unit, max(whole.value, modes.value))
    others = f". So are {len(apart)} of its {len(pairs)} numbers" if apart[1:] else ""
    yield Finding(
        "evaluation-not-converged",
        f"{one.key()}.{one.name}: do not quote its {whole.name}. It is {factor * whole.value:.4g} {unit}, and "
        f"{factor * modes.value:.4g} {unit} without the residual vectors (the static correction for the modes that are "
        f"left out), so it may change with the number of modes and with the mesh{others}. Compute more modes",
        {"allowed": CONVERGED, "apart": _apart(whole, modes)}
        | {name: number for a, b in apart for name, number in ((a.name, a.value), (f"{a.name}, modes alone", b.value))},
    )


def _apart(a: Quoted, b: Quoted) -> float:
    larger = max(abs(a.value), abs(b.value))
    return abs(a.value - b.value) / larger if larger > 0.0 else 0.0
