"""Rows of many samples at once: where they hold some numbers of impacts, and numbers of impacts alone vary."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite
from typing import Final

from femstruct.arrays import Floats
from femstruct.campaign.batch.batch_stage import Stage, stage_of
from femstruct.campaign.batch.scene_columns import scene_columns
from femstruct.campaign.journal import Row
from femstruct.campaign.numbers import Number, chosen, numbers_of, numbers_of_limit
from femstruct.campaign.samples import Samples
from femstruct.campaign.tasks import Split, Task, read_sample
from femstruct.errors import FemstructError
from femstruct.files.contents import contents
from femstruct.impact.batch.metrics import Batch
from femstruct.impact.batch.vary import numbers_of_scene, variation
from femstruct.impact.laws.registry import DOUBTS
from femstruct.impact.result.contact_findings import NOT_TRUSTED, drifts
from femstruct.impact.scene.bodies import Scene
from femstruct.language import with_position
from femstruct.study.campaign.varied import Campaign
from femstruct.study.study import Case, Study
from femstruct.workflow.stages.modal_bases import key_of, meshed
from femstruct.workflow.stages.staging import scene as staged

BY_BATCH: Final = (
    "by the batch engine: findings that take a history are not looked for, such as structure-not-decayed or "
    "contact-beyond-modes"
)
BY_HISTORY: Final = (
    "from impacts alone, on modes that are solved once: their numerical error is not estimated, and findings that need "
    "the sound of a sample are not looked for"
)
AT_ONCE: Final = 512  # samples of a task at most: what a kill costs
FEW_AT_ONCE: Final = 16  # of them with a history


@dataclass(frozen=True, eq=False)
class BatchTask:
    """Samples to run together.

    first : the task of the sample whose scenes are those of all but for columns, which are what differs between the
    samples in the scene of every case, by name. numbers : of the samples. only : what a row holds; histories : which of
    it take the history of a run. threads : of the batch engine. files : from which they were read.
    """

    first: Task
    numbers: tuple[int, ...]
    columns: Mapping[str, Mapping[str, Floats]]
    only: tuple[str, ...]
    histories: tuple[str, ...]
    threads: int
    files: tuple[str, ...]

    def left(self, known: set[int]) -> BatchTask | None:
        """The task, None where the rows of all its samples are known: they are kept together or not at all."""
        return None if known.issuperset(self.numbers) else self

    def first_of(self, count: int) -> BatchTask:
        """The first samples alone."""
        return _part(self, 0, count)

    def rows(self) -> Iterator[list[Row]]:
        """The rows of all samples at once."""
        stage = stage_of(self.first, self.only)
        found: dict[int, dict[str, Row]] = {number: {} for number in self.numbers}
        metrics = tuple(name for name in self.only if name not in self.histories)
        for case in stage.plan.cases:
            columns, made = self.columns[case.name], []
            if metrics:
                batch = stage.batch(case, columns, len(self.numbers), self.threads)
                made.append(_of_batch(case, self.numbers, batch, stage, metrics))
            if self.histories:
                made.append(_of_histories(case, self.numbers, columns, stage, self.histories))
            for parts in zip(*made, strict=True):
                row = _joined(parts, stage.codes[case.name], self.only)
                found[row.sample][row.case] = row
        files = contents(self.files)
        yield [replace(row, files=files) for own in found.values() for row in _of_sample(own)]


def batch_tasks(
    campaign: Campaign, samples: Samples, threads: int, told: Callable[[str], None] = lambda line: None
) -> Split | str:
    """All samples as tasks of the batch engine; why it takes full runs where it does.

    It takes them where a row is to hold every number, or one that needs a history; where anything but numbers of
    bodies, contacts, links and loads varies (`scene_columns`). told : is given a line while all samples are read.
    """
    if not campaign.only:
        return "a row holds all numbers; name those that you need under 'samples: {only: [..]}' or by --only"
    first = Task(campaign.file, campaign.overrides, campaign.case, ((0, samples.changes(0)),))
    try:
        plan = read_sample(first, samples.changes(0))
        if more := next((f"case '{case.name}' {what}" for case in plan.cases if (what := _beyond(case))), ""):
            return more
        structures = {case.name: key_of(case.study) for case in plan.cases}
        places = {case.name: meshed(case.study.structure, case.studies).places for case in plan.cases}
        files = dict.fromkeys(plan.sources)

        def scenes(texts: Sequence[str]) -> dict[str, tuple[Study, Scene]]:
            read = read_sample(first, texts)
            files.update(dict.fromkeys(read.sources))
            cases = read.cases
            same = {case.name: key_of(case.study) for case in cases} == structures
            return {one.name: (one.study, staged(one.study, places[one.name])) for one in cases} if same else {}

        histories = _by_history(stage_of(first, campaign.only), campaign.only)
        if isinstance(histories, str):  # before all samples are read, which takes long
            return histories
        found = scene_columns(samples, scenes, told)
        if found is None or not all(map(numbers_of_scene, found.scenes.values())):
            return "more varies than numbers of bodies, contacts, links and loads"
    except (FemstructError, TypeError) as error:  # full runs say it of each sample
        return f"the batch engine does not take this study: {error}"
    n = len(samples.texts)
    size = FEW_AT_ONCE if histories else AT_ONCE
    whole = BatchTask(
        first, tuple(range(n)), found.columns, campaign.only, histories, 1 if histories else threads, (*files,)
    )
    return Split(
        tuple(_part(whole, start, start + size) for start in range(0, n, size)),
        plan,
        {},
        len(set(structures.values())),
        n * len(plan.cases),
        made=BY_HISTORY if histories else BY_BATCH,
        threaded=not histories,
    )


def _part(task: BatchTask, start: int, end: int) -> BatchTask:
    """Some samples of a task."""
    columns = {case: {name: one[start:end] for name, one in own.items()} for case, own in task.columns.items()}
    return replace(task, numbers=task.numbers[start:end], columns=columns)


def _by_history(stage: Stage, only: Sequence[str]) -> tuple[str, ...] | str:
    """The names for which a run's history is needed, with those of them that the batch engine has as well: none where
    it has all. Why it takes full runs where neither has a name in any case."""
    cases = stage.plan.cases
    metrics = {name for case in cases for name in stage.offered(case, stage.batch(case, {}, 1, 1))}
    if metrics.issuperset(only):
        return ()
    known = {name for case in cases for name in numbers_of(stage.history(case, stage.scenes[case.name]))}
    missing = next((name for name in only if name not in known | metrics), None)
    if missing is not None:
        return f"'{missing}' is a number of full runs"
    return tuple(name for name in only if name in known)


def _beyond(case: Case) -> str:
    """What a case has beyond one impact on modes that are solved once, "" for nothing."""
    study = case.study
    if study.time is None:
        return "has no 'time:', and so no impact"
    if case.drops:
        return f"has blows at {len(case.drops)} places, and each is an impact of its own"
    if study.accuracy is not None:
        return "has 'accuracy:', for which modes are added until it holds"
    two_way = next((room.name for room in study.rooms if room.coupling == "two-way"), "")
    return two_way and f"has room '{two_way}' with 'coupling: two-way', so that its air changes the modes"


def _of_batch(case: Case, numbers: Sequence[int], batch: Batch, stage: Stage, only: Sequence[str]) -> Iterator[Row]:
    """What the batch engine has of every run of a case."""
    own = stage.offered(case, batch)
    columns = [(name, own[name][0].tolist(), own[name][1]) for name in only if name in own]
    flags = {code: flag.tolist() for code, flag in batch.flags.items() if flag.any()}
    forbids = {code: flags[code] for code, forbid in DOUBTS.items() if forbid and code in flags}
    forbids["energy-drift"] = drifts(batch.residual, NOT_TRUSTED).tolist()
    for i, number in enumerate(numbers):
        if told := batch.trouble(i):
            yield Row(number, case.name, {}, trouble=told)
            continue
        codes = tuple(code for code, flag in flags.items() if flag[i])
        severe = tuple(code for code, flag in forbids.items() if flag[i])
        found = {name: Number(column[i], unit) for name, column, unit in columns}
        yield Row(number, case.name, _with_limits(found, case), codes, severe)


def _with_limits(numbers: dict[str, Number], case: Case) -> dict[str, Number]:
    """Numbers of the batch engine, which are exact, with the limits that the case has of them and the verdicts."""
    for limit in case.study.limits:
        if one := numbers.get(limit.name):
            met = one.value <= limit.value if isfinite(one.value) else None
            numbers |= numbers_of_limit(limit.name, limit.value, one.unit, one.value, met)
    return numbers


def _of_histories(
    case: Case, numbers: Sequence[int], columns: Mapping[str, Floats], stage: Stage, only: Sequence[str]
) -> Iterator[Row]:
    """What the histories have of every run of a case."""
    scene = stage.scenes[case.name]
    varied: Callable[[int], Scene] = variation(scene, columns) if columns else lambda i: scene
    for i, number in enumerate(numbers):
        try:
            run = stage.history(case, varied(i))
        except FemstructError as error:
            yield Row(number, case.name, {}, trouble=with_position(stage.plan, error))
            continue
        codes = tuple(one.code for one in run.findings)
        severe = tuple(one.code for one in run.findings if one.severe)
        yield Row(number, case.name, chosen(numbers_of(run), only), codes, severe)


def _joined(parts: Sequence[Row], known: tuple[tuple[str, ...], tuple[str, ...]], only: Sequence[str]) -> Row:
    """One row of several of a sample in a case. known : codes of findings that all samples have, and of severe ones."""
    failed = next((part for part in parts if part.trouble), None)
    if failed is not None:
        return failed
    values = {name: one for part in parts for name, one in part.numbers.items()}
    return Row(
        parts[0].sample,
        parts[0].case,
        chosen(values, only),
        tuple(dict.fromkeys([*known[0], *(code for part in parts for code in part.findings)])),
        tuple(dict.fromkeys([*known[1], *(code for part in parts for code in part.severe)])),
    )


def _of_sample(rows: Mapping[str, Row]) -> list[Row]:
    """The rows of a sample by case; the one that failed, if there is one."""
    failed = next((row for row in rows.values() if row.trouble), None)
    return list(rows.values()) if failed is None else [replace(failed, case="")]
