"""A campaign as tasks: samples that share what is dear to compute, run one after the other in one process."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final, Protocol

from femstruct.campaign.journal import Row
from femstruct.campaign.numbers import Number, numbers_of, only_numbers
from femstruct.campaign.samples import Samples
from femstruct.errors import FemstructError, InputErrors
from femstruct.files.contents import contents
from femstruct.language import read_study, with_position
from femstruct.study.campaign.varied import Campaign
from femstruct.study.result import CaseResult
from femstruct.study.study import Plan
from femstruct.workflow.run.run import run_cases
from femstruct.workflow.stages.modal_bases import Solved, key_of

AT_ONCE: Final = 4  # samples of a task at most: what a kill costs
BASES: Final = 4  # kept by a process


class Work(Protocol):
    """Samples to run together. numbers : of them."""

    @property
    def numbers(self) -> tuple[int, ...]: ...
    def left(self, known: set[int], /) -> Work | None:
        """What is left where the rows of some samples are known."""

    def rows(self) -> Iterator[list[Row]]:
        """The rows, as many samples at a time as are kept together."""


@dataclass(frozen=True)
class Task:
    """Samples to run in full, (number, texts ``PATH=VALUE``), of the cases of a study.

    only : numbers that a row holds, all if none.
    """

    file: str
    overrides: tuple[str, ...]
    case: str
    samples: tuple[tuple[int, tuple[str, ...]], ...]
    only: tuple[str, ...] = ()

    @property
    def numbers(self) -> tuple[int, ...]:
        """Numbers of the samples."""
        return tuple(number for number, _ in self.samples)

    def left(self, known: set[int]) -> Task | None:
        """The task without the samples whose rows are known, None where that is all of them."""
        left = tuple(one for one in self.samples if one[0] not in known)
        return replace(self, samples=left) if left else None

    def rows(self) -> Iterator[list[Row]]:
        """The rows of one sample after the other."""
        return rows_of(self)


@dataclass(frozen=True)
class Split:
    """The tasks of a campaign; one of its studies, read; samples whose files cannot be read, with the reason; how many
    structures are to be solved, and impacts to be simulated. made : how rows are, in words, "" for full runs.
    threaded : whether a task has threads of its own."""

    tasks: tuple[Work, ...]
    plan: Plan
    refused: dict[int, str]
    structures: int
    impacts: int
    made: str = ""
    threaded: bool = False


def split(campaign: Campaign, samples: Samples, told: Callable[[str], None] = lambda line: None) -> Split:
    """All samples as tasks, each of one set of structures.

    Every sample is read here, so that mistakes are known before anything is computed. Raises InputErrors where no
    sample can be read.

    Notes
    -----
    Tasks do not depend on how many processes run them, so that rows do not either.
    """
    groups: dict[frozenset[str], list[tuple[int, tuple[str, ...]]]] = {}
    refused: dict[int, str] = {}
    first: InputErrors | None = None
    one: Plan | None = None
    impacts = 0
    for i in range(len(samples.texts)):
        if i % 50 == 0:
            told(f"reading sample {i + 1} of {len(samples.texts)}")
        try:
            plan = read_sample(campaign, samples.changes(i))
        except InputErrors as errors:
            first = first or errors
            refused[i] = errors.errors[0]
            continue
        one = one or plan
        keys = frozenset(key_of(case.study) for case in plan.cases)
        impacts += sum(study.time is not None for case in plan.cases for study in case.studies)
        groups.setdefault(keys, []).append((i, samples.changes(i)))
    if one is None:
        assert first is not None
        raise first
    tasks = [
        Task(campaign.file, campaign.overrides, campaign.case, tuple(members[start : start + AT_ONCE]), campaign.only)
        for members in groups.values()
        for start in range(0, len(members), AT_ONCE)
    ]
    return Split(tuple(tasks), one, refused, len(frozenset().union(*groups)), impacts)


def first_read(campaign: Campaign, samples: Samples) -> Plan:
    """The study with the values of the first sample that can be read. Raises InputErrors where none can."""
    for i in range(1, len(samples.texts)):
        try:
            return read_sample(campaign, samples.changes(i - 1))
        except InputErrors:
            continue
    return read_sample(campaign, samples.changes(len(samples.texts) - 1))


def read_sample(campaign: Campaign | Task, changes: Sequence[str]) -> Plan:
    """The study with the values of a sample. Raises InputErrors in terms of what varies."""
    try:
        texts = (*campaign.overrides, *changes)
        return read_study(campaign.file, texts, only=campaign.case or None, others=not campaign.case)
    except InputErrors as errors:
        told = errors.errors
        for text in changes:
            told = tuple(line.replace(f"--set {text}", f"vary {text}") for line in told)
        raise InputErrors(told) from None


def run_task(task: Work) -> list[Row]:
    """The rows of all samples of a task, by sample and case."""
    return [row for rows in task.rows() for row in rows]


def rows_of(task: Task) -> Iterator[list[Row]]:
    """The rows of a task, one sample after the other. A sample that fails has a row that says why.

    Raises InputError for a number to keep that no study has.

    Notes
    -----
    Bases are taken from the samples before, of this task or of another that this process has run; nothing else is, so
    that a row is that of a run of its own, wherever and after whatever it is computed.
    """
    for number, changes in task.samples:
        try:
            plan = read_sample(task, changes)
        except InputErrors as errors:
            yield [Row(number, "", {}, trouble=errors.errors[0], again=True)]  # nobody knows from which files
            continue
        files = contents(plan.sources)
        try:
            found, solved = run_cases(plan, _SOLVED)
        except FemstructError as error:
            yield [Row(number, "", {}, trouble=with_position(plan, error), files=files)]
            continue
        _SOLVED[:] = [*(one for one in _SOLVED if one not in solved), *solved][-BASES:]
        numbers = {name: numbers_of(case) for name, case in found.items()}
        kept = only_numbers(numbers, task.only) if task.only else numbers
        yield [_row(number, name, case, kept[name], files) for name, case in found.items()]


def _row(number: int, name: str, case: CaseResult, numbers: dict[str, Number], files: dict[str, str]) -> Row:
    codes = dict.fromkeys(one.code for one in case.findings)
    severe = dict.fromkeys(one.code for one in case.findings if one.severe)
    return Row(number, name, numbers, tuple(codes), tuple(severe), files=files)


_SOLVED: Final[list[Solved]] = []  # of this process, the latest last: tasks of one structure follow each other


def forget_bases() -> None:
    """Leave the next sample without bases from those before."""
    _SOLVED.clear()
