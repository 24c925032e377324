"""The rows of a campaign as one table; what all campaigns share before and while they run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from femstruct.campaign.journal import Row
from femstruct.campaign.numbers import APART
from femstruct.campaign.samples import Samples
from femstruct.dimensions import DIMENSIONS
from femstruct.impact.compiled.workers import compilation
from femstruct.impact.engine.needed_units import BY_COLLOCATION, EXACTLY
from femstruct.language.yaml import Mistakes
from femstruct.language.yaml.reader import parse_value
from femstruct.study.campaign.swept import Swept, is_of_limit
from femstruct.study.study import Plan
from femstruct.units import QuantityError, quantity_of
from femstruct.workflow.progress import Progress
from femstruct.workflow.run.provenance import provenance


def make_ready(plan: Plan, progress: Progress) -> None:
    """Compile the kernels that the cases take, once for all processes."""
    if not any(study.time is not None for case in plan.cases for study in case.studies):
        return
    with compilation((*EXACTLY, *BY_COLLOCATION)) as kernels:  # which of them is told by the modes of each sample
        if kernels.units:
            kernels.wait(progress)


def gathered(
    title: str,
    plan: Plan,
    samples: Samples,
    rows: Sequence[Row],
    refused: Mapping[int, str],
    *,
    method: str = "grid",
    command: str = "",
    made: str = "",
    only: Sequence[str] = (),
) -> Swept:
    """The rows of a campaign as one table.

    plan : one of its studies, for cases and limits. refused : samples that cannot be read, with the reason. method : of
    sampling.
    """
    n = len(samples.texts)
    base = next(case for case in plan.cases if case.name == plan.baseline)
    cases = tuple(case.name for case in plan.cases)
    names: dict[str, str] = {}
    for row in rows:  # the main numbers stand first in each
        for name, one in row.numbers.items():
            names.setdefault(name, one.unit)
    place, at = {name: k for k, name in enumerate(names)}, {case: c for c, case in enumerate(cases)}
    numbers = np.full((len(cases), n, len(names)), np.nan)
    done, trouble = np.zeros(n, dtype=bool), [""] * n
    findings: list[list[tuple[str, ...]]] = [[()] * n for _ in cases]
    severe: list[list[tuple[str, ...]]] = [[()] * n for _ in cases]
    for i, told in refused.items():
        done[i], trouble[i] = True, told
    for row in rows:
        done[row.sample] = True
        if row.trouble:
            trouble[row.sample] = row.trouble
            continue
        c = at[row.case]
        findings[c][row.sample], severe[c][row.sample] = row.findings, row.severe
        for name, one in row.numbers.items():
            numbers[c, row.sample, place[name]] = one.value
    return Swept(
        title=title,
        paths=samples.paths,
        units=tuple(
            one or (unit_in(plan, path) if np.isfinite(column).all() else "")
            for path, one, column in zip(samples.paths, samples.units, samples.numbers.T, strict=True)
        ),
        texts=samples.texts,
        values=samples.numbers,
        method=method,
        cases=cases,
        baseline=plan.baseline,
        names=tuple(names),
        number_units=tuple(names.values()),
        main=tuple(name for name in names if not is_of_limit(name) and (only or APART not in name)),
        numbers=numbers,
        done=done,
        severe=tuple(map(tuple, severe)),
        findings=tuple(map(tuple, findings)),
        trouble=tuple(trouble),
        limits={one.name: one.value for one in base.study.limits},
        sources=plan.sources,
        provenance=provenance(command),
        made=made,
    )


def unit_in(plan: Plan, path: str) -> str:
    """The unit of what stands at a path in the files of a study, where it is written with one: plain numbers that it
    varies over are in that unit. "" for all else.

    >>> unit_in(Plan("", (), "", {"a.study.yaml": "rooms: {bed: {losses: {t60: 0.5 s}}}"}), "rooms.bed.losses.t60")
    's'
    """
    for text in (text for name, text in plan.sources.items() if name.endswith((".yaml", ".yml"))):
        value = parse_value(text, "", Mistakes()).value
        for step in path.split("."):
            value = value.get(step) if isinstance(value, dict) else None
        if isinstance(value, str):
            try:
                dimension = quantity_of(value, tuple(DIMENSIONS))[1]
            except QuantityError:
                return ""
            return DIMENSIONS[dimension].unit if dimension else ""
    return ""


def versions() -> dict[str, str]:
    """Of the program and of what it computes with: rows of others are not gone on with."""
    return {key: value for key, value in provenance("").items() if key.endswith("_version")}
