"""A campaign as tasks: samples that share what is dear to compute, run one after the other in one process."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any, Final, Protocol

import numpy as np

from femstruct.arrays import Floats
from femstruct.campaign.rows import APART, Number, Row, numbers_of, only_numbers
from femstruct.compiled.store import compilation
from femstruct.errors import FemstructError, InputErrors
from femstruct.files.writing import contents
from femstruct.impact.simulate import BY_COLLOCATION, EXACTLY
from femstruct.language.cases import read_study
from femstruct.language.models import with_position
from femstruct.language.varied import written
from femstruct.study.campaigns import INDICES, Campaign, Listed, Scattered, Swept, is_of_limit
from femstruct.study.results import CaseResult
from femstruct.study.study import Plan
from femstruct.units import DIMENSIONS, QuantityError, quantity_of
from femstruct.workflow.bases import Solved, key_of
from femstruct.workflow.provenance import Progress, provenance
from femstruct.workflow.run import run_cases
from femstruct.yaml.reader import Mistakes, parse_value

# ----------------------------------------------------------------------------------------------------------------------
# The samples of a campaign: a value of every path that varies, for each of them.
# ----------------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Samples:
    """n samples of p paths.

    texts : the values as a file writes them, [n][p]. numbers [n, p] : the same in SI units, nan for words and lists.
    """

    paths: tuple[str, ...]
    units: tuple[str, ...]
    texts: tuple[tuple[str, ...], ...]
    numbers: Floats

    def changes(self, i: int) -> tuple[str, ...]:
        """Sample i as texts ``PATH=VALUE``."""
        return tuple(f"{path}={text}" for path, text in zip(self.paths, self.texts[i], strict=True))


def samples_of(campaign: Campaign) -> Samples:
    """The samples that a campaign asks for: of a grid the last path varies fastest.

    Notes
    -----
    Latin hypercube and scrambled Sobol sequence are those of scipy.stats.qmc. A point u of the unit interval takes the
    quantile of a distribution, or the listed value of number floor(u n). The numbers depend on the seed alone, not on
    the machine. For indices the samples are two tables A and B, then A with one column after the other from B.

    >>> two = Listed("a", ("1", "2"), (1.0, 2.0), "1"), Listed("b", ("x", "y"))
    >>> samples_of(Campaign("s.yaml", two)).texts
    (('1', 'x'), ('1', 'y'), ('2', 'x'), ('2', 'y'))
    """
    varied, sampling = campaign.varied, campaign.sampling
    if sampling.method == "grid":
        listed = [one for one in varied if isinstance(one, Listed)]
        rows = list(product(*(range(len(one.texts)) for one in listed)))
        columns = [_chosen(one, [row[j] for row in rows]) for j, one in enumerate(listed)]
    else:
        assert sampling.count is not None
        unit = _points(sampling.method, sampling.count, len(varied), sampling.seed)
        columns = [at(one, unit[:, j]) for j, one in enumerate(varied)]
    texts = tuple(zip(*(column[0] for column in columns), strict=True))
    numbers = np.column_stack([column[1] for column in columns])
    return Samples(tuple(one.path for one in varied), tuple(one.unit for one in varied), texts, numbers)


def _points(method: str, count: int, dimension: int, seed: int) -> Floats:
    """Points of the unit cube [count, dimension]."""
    from scipy.stats import qmc

    if method == INDICES:
        both = qmc.Sobol(2 * dimension, rng=np.random.default_rng(seed)).random(count)
        a, b = both[:, :dimension], both[:, dimension:]
        mixed = [np.where(np.arange(dimension) == j, b, a) for j in range(dimension)]
        return np.concatenate([a, b, *mixed])
    kind: Any = qmc.LatinHypercube if method == "latin hypercube" else qmc.Sobol
    engine = kind(dimension, rng=np.random.default_rng(seed))
    # Sobol points are balanced in powers of two: of these the first are taken
    whole = count if method == "latin hypercube" else 1 << (count - 1).bit_length()
    points: Floats = engine.random(whole)[:count]
    return points


def at(one: Listed | Scattered, u: Floats) -> tuple[Sequence[str], Floats]:
    """Texts [n] and numbers [n] of a path at points of the unit interval [n]."""
    if isinstance(one, Listed):
        return _chosen(one, np.minimum((u * len(one.texts)).astype(int), len(one.texts) - 1).tolist())
    numbers = quantile(one, u)
    return [written(float(value), one.unit) for value in numbers], numbers


def quantile(one: Scattered, u: Floats) -> Floats:
    """The numbers of a distribution that are exceeded with probability 1 - u.

    >>> quantile(Scattered("a", "log-uniform", 1.0, 100.0), np.array([0.0, 0.5])).round(12).tolist()
    [1.0, 10.0]
    """
    from scipy.special import ndtri

    if one.law == "normal":
        found: Floats = one.first + one.second * ndtri(np.clip(u, 1e-12, 1.0 - 1e-12))  # a Sobol point may be 0
        return found
    if one.law == "log-uniform":
        return np.asarray(one.first * (one.second / one.first) ** u)
    return np.asarray(one.first + (one.second - one.first) * u)


def _chosen(one: Listed, numbers: Sequence[int]) -> tuple[Sequence[str], Floats]:
    values = np.array(one.numbers or (np.nan,) * len(one.texts))
    return [one.texts[i] for i in numbers], values[list(numbers)]


# ----------------------------------------------------------------------------------------------------------------------
# A campaign as tasks.
# ----------------------------------------------------------------------------------------------------------------------

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


def split(campaign: Campaign, samples: Samples, report: Callable[[str], None] = lambda line: None) -> Split:
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
            report(f"reading sample {i + 1} of {len(samples.texts)}")
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
        messages = errors.errors
        for text in changes:
            messages = tuple(line.replace(f"--set {text}", f"vary {text}") for line in messages)
        raise InputErrors(messages) from None


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


# ----------------------------------------------------------------------------------------------------------------------
# The rows of a campaign as one table; what all campaigns share before and while they run.
# ----------------------------------------------------------------------------------------------------------------------


def make_ready(plan: Plan, progress: Progress) -> None:
    """Compile the kernels that the cases take, once for all processes."""
    if not any(study.time is not None for case in plan.cases for study in case.studies):
        return
    with compilation((*EXACTLY, *BY_COLLOCATION)) as kernels:  # which of them is told by the modes of each sample
        if kernels.units:
            kernels.wait(progress)


def gather_rows(
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

    Parameters
    ----------
    plan : Plan
        One of its studies, for cases and limits.
    refused : Mapping[int, str]
        Samples that cannot be read, with the reason.
    method : str
        Of sampling.
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
    for i, message in refused.items():
        done[i], trouble[i] = True, message
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
