"""What a campaign takes, told before it is run: how many solves of each kind, and about how long."""

from __future__ import annotations

import os
import time
from collections.abc import Sequence
from dataclasses import replace

from femstruct.campaign.batch.batch_rows import BatchTask, batch_tasks
from femstruct.campaign.gathered import duration, make_ready
from femstruct.campaign.samples import samples_of
from femstruct.campaign.tasks import Split, Task, Work, forget_bases, run_task, split
from femstruct.study.campaign.varied import Campaign
from femstruct.workflow.run.provenance import Progress
from femstruct.workflow.stages.modal_bases import key_of

MORE, PART = 128, 8  # rows of a batch that are timed, and the share of them that are timed before


def planned(
    campaign: Campaign, workers: int | None = None, progress: Progress = lambda line: None
) -> dict[str, int | str]:
    """How much there is to compute, by kind, how, and about how long it takes on this machine.

    workers : processes, None for one a core. The first sample is run, twice, to see what its modes take and what the
    rest.

    Raises InputErrors where no sample can be read.
    """
    samples, cores = samples_of(campaign), workers or os.cpu_count() or 1
    batch = batch_tasks(campaign, samples, 1)
    parts = split(campaign, samples, progress) if isinstance(batch, str) else batch
    make_ready(parts.plan, progress)
    progress("running one sample")
    seconds = _seconds(parts, parts.tasks) / cores
    on = f"{cores} cores" if cores > 1 else "1 core"
    return {
        "samples": len(samples.texts),
        "cases": len(parts.plan.cases),
        "structures to solve": parts.structures,
        "impacts to simulate": parts.impacts,
        "rows": f"full runs: {batch}" if isinstance(batch, str) else parts.made,
        "about how long": f"{duration(seconds)} on {on}",
        "samples that are refused": len(parts.refused),
        **({"the first of them": next(iter(parts.refused.values()))} if parts.refused else {}),
    }


def _seconds(parts: Split, tasks: Sequence[Work]) -> float:
    """What all tasks take in one process [s]."""
    task, count = tasks[0], sum(len(one.numbers) for one in tasks)
    if isinstance(task, BatchTask):
        size = min(len(task.numbers), MORE)
        few, more = (task.first_of(some) for some in (-(-size // PART), size))
        _timed(few)  # what is made once
        start, longer = _timed(few), _timed(more)
        row = max(longer - start, 0.0) / max(len(more.numbers) - len(few.numbers), 1)
        return count * row + len(tasks) * max(start - len(few.numbers) * row, 0.0)
    assert isinstance(task, Task)
    one = replace(task, samples=task.samples[:1])
    forget_bases()
    whole, row = _timed(one), _timed(one)  # the second time the modes are there
    each = len({key_of(case.study) for case in parts.plan.cases})
    return count * row + parts.structures * max(whole - row, 0.0) / each


def _timed(task: Work) -> float:
    """Seconds of a task."""
    begin = time.monotonic()
    run_task(task)
    return time.monotonic() - begin
