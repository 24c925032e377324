"""What a campaign takes, told before it is run: how many solves of each kind, and about how long."""

from __future__ import annotations

import os
import time
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import numpy as np

from femstruct.campaign.batch_rows import BatchTask, batch_tasks
from femstruct.campaign.designs import Designs, refuse_values, refused_ends, with_limits_of_study, with_place
from femstruct.campaign.executors import Done, Tick
from femstruct.campaign.rows import APART, Row, open_journal
from femstruct.campaign.tasks import Split, Task, Work, forget_bases, make_ready, run_task, samples_of, split
from femstruct.errors import InputError
from femstruct.language.campaigns import set_by_cases
from femstruct.language.cases import read_study
from femstruct.study.campaigns import Campaign, Listed, Scattered
from femstruct.study.optima import FEWEST_RUNS, Search
from femstruct.study.study import Plan
from femstruct.view.campaign_answers import range_of, value_text, why_not_known
from femstruct.workflow.bases import key_of
from femstruct.workflow.provenance import Progress, duration
from femstruct.yaml.reader import read_yaml

POINT: Final = {"lower": 0.95, "upper": 0.05}  # of a range of which that end cannot be
MANY: Final = 8  # values that are listed
MORE, PART = 128, 8  # rows of a batch that are timed, and the share of them that are timed before


def forecast_campaign(
    campaign: Campaign, workers: int | None = None, progress: Progress = lambda line: None
) -> dict[str, int | str]:
    """How much there is to compute, by kind, how, and about how long it takes on this machine.

    Parameters
    ----------
    workers : int | None
        Processes, None for one a core. The first sample is run, twice, to see what its modes take and what the rest.

    Raises
    ------
    InputErrors
        Where no sample can be read.
    """
    samples, cores = samples_of(campaign), workers or os.cpu_count() or 1
    batch = batch_tasks(campaign, samples, 1, progress)
    parts = split(campaign, samples, progress) if isinstance(batch, str) else batch
    make_ready(parts.plan, progress)
    progress("running one sample")
    seconds, rows = _seconds(parts, parts.tasks)
    return {
        **{f"varies: {one.path}": _values(one) for one in campaign.varied},
        "samples": len(samples.texts),
        "cases": len(parts.plan.cases),
        **{f"set by case '{case}' itself": ", ".join(own) for case, own in _set_by_cases(campaign, parts.plan)},
        "structures to solve": parts.structures,
        "impacts to simulate": parts.impacts,
        "rows": f"full runs: {batch}" if isinstance(batch, str) else parts.made,
        "about how long": _long(seconds, cores),
        "main numbers": ", ".join(_main(rows)) or "none: the first sample has no result",
        **_not_known(_main(rows), rows, "the first sample"),
        "samples that are refused": len(parts.refused),
        **({"the first of them": next(iter(parts.refused.values()))} if parts.refused else {}),
    }


def forecast_search(
    search: Search, workers: int | None = None, progress: Progress = lambda line: None
) -> dict[str, int | str]:
    """What an optimisation will try, and about how long it takes on this machine.

    Parameters
    ----------
    workers : int | None
        Processes, None for one a core. The design in the middle of all ranges is run, once for the first sample of what
        scatters; of a range of which the files cannot have one end, one near the other.

    Raises
    ------
    InputErrors
        Where the files cannot be read, and what trying a design raises for names of numbers.
    """
    cores = workers or os.cpu_count() or 1
    plan = read_study(search.file, search.overrides, only=search.case or None)
    search = with_limits_of_study(search, plan)
    refuse_values(search, plan)
    refused = refused_ends(search)
    middle = [POINT[refused[one.path][0]] if one.path in refused else 0.5 for one in search.designs]
    make_ready(plan, progress)
    progress("running one design")
    taken = 0.0

    def run(tasks: Sequence[Work], done: Done, tick: Tick = lambda: None) -> None:
        nonlocal taken
        begin = time.monotonic()
        for task in tasks:
            done(run_task(task))
        taken = time.monotonic() - begin

    one = replace(search, over=(), runs=max(search.runs, FEWEST_RUNS))
    with TemporaryDirectory() as place, open_journal(Path(place) / "plan.rows", "") as journal:
        designs = Designs(one, search.case or plan.baseline, journal, run, lambda count: None)
        try:
            designs(np.array([middle]))
        except InputError as error:
            raise with_place(search, error) from None
        rows = designs.of_design(0)
    most = search.runs // search.samples
    return {
        "goals": ", ".join(f"{goal.sense} {goal.name}" for goal in search.goals) + _robust(search),
        "case": search.case or plan.baseline,
        "limits": "; ".join(_limit(search, name, rows) for name in search.limits) or "none",
        **{f"may be chosen: {one.path}": range_of(one) for one in search.designs},
        **{f"refused: {path}, {end} end of its range": why for path, (end, why) in refused.items()},
        **{f"scatters: {one.path}": range_of(one) for one in search.over},
        **({"samples of what scatters, for each design": search.samples} if search.over else {}),
        "designs at most": most,
        "runs at most": most * search.samples,
        "about how long": _long(most * search.samples * taken, cores),
        "main numbers": ", ".join(_main(rows)) or f"none: {rows[0].trouble}",
        **_not_known([*(goal.name for goal in search.goals), *search.limits], rows, "the design that was run"),
    }


def _set_by_cases(campaign: Campaign, plan: Plan) -> Iterable[tuple[str, tuple[str, ...]]]:
    paths, cases = [one.path for one in campaign.varied], [case.name for case in plan.cases]
    return set_by_cases(read_yaml(campaign.file).value, paths, cases).items()


def _values(one: Listed | Scattered) -> str:
    """What varies, in short."""
    if isinstance(one, Listed) and one.numbers and len(one.texts) > MANY:
        low, high = (value_text(end, one.unit, "") for end in (min(one.numbers), max(one.numbers)))
        return f"{len(one.texts)} values from {low} to {high}"
    return range_of(one)


def _robust(search: Search) -> str:
    return f"; goals and limits are {100.0 * search.quantile:g} % quantiles of what scatters" if search.over else ""


def _limit(search: Search, name: str, rows: Sequence[Row]) -> str:
    """A limit with its unit, and whether the study states it."""
    unit = next((row.numbers[name].unit for row in rows if name in row.numbers), "")
    value = value_text(search.limits[name], unit, "")
    return f"{name} {value}" + (" (of the study)" if name in search.of_study else "")


def _long(seconds: float, cores: int) -> str:
    """How long work takes on some cores, in words."""
    return f"{duration(seconds / cores)} on {f'{cores} cores' if cores > 1 else '1 core'}"


def _main(rows: Sequence[Row]) -> list[str]:
    """The main numbers of rows; all others are named by their place in summary.json."""
    return [name for name in dict.fromkeys(name for row in rows for name in row.numbers) if APART not in name]


def _not_known(names: Sequence[str], rows: Sequence[Row], of: str) -> dict[str, str]:
    """Numbers that no row of what was run has, each with the reason, by the line that states them."""
    codes = {code for row in rows for code in row.findings}
    ran = [row for row in rows if not row.trouble]
    lacking = [
        name
        for name in dict.fromkeys(names)
        if (values := [row.numbers[name].value for row in ran if name in row.numbers]) and not np.isfinite(values).any()
    ]
    listed = [name + (f" ({why})" if (why := why_not_known(name, codes)) else "") for name in lacking]
    return {f"not known in {of}": ", ".join(listed)} if listed else {}


def _seconds(parts: Split, tasks: Sequence[Work]) -> tuple[float, list[Row]]:
    """What all tasks take in one process [s], and the rows that tell it."""
    task, count = tasks[0], sum(len(one.numbers) for one in tasks)
    if isinstance(task, BatchTask):
        size = min(len(task.numbers), MORE)
        few, more = (task.first_of(some) for some in (-(-size // PART), size))
        _timed(few)  # what is made once
        (start, rows), (longer, _) = _timed(few), _timed(more)
        row = max(longer - start, 0.0) / max(len(more.numbers) - len(few.numbers), 1)
        return count * row + len(tasks) * max(start - len(few.numbers) * row, 0.0), rows
    assert isinstance(task, Task)
    one = replace(task, samples=task.samples[:1])
    forget_bases()
    (whole, _), (row, rows) = _timed(one), _timed(one)  # the second time the modes are there
    each = len({key_of(case.study) for case in parts.plan.cases})
    return count * row + parts.structures * max(whole - row, 0.0) / each, rows


def _timed(task: Work) -> tuple[float, list[Row]]:
    """Seconds of a task, and its rows."""
    begin = time.monotonic()
    rows = run_task(task)
    return time.monotonic() - begin, rows
