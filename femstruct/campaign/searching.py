"""What all searches for good designs share: the rows that are kept, who runs them, and a name for all they hang on."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.campaign.designs import Designs
from femstruct.campaign.executors import crew
from femstruct.campaign.gathered import gathered, make_ready, versions
from femstruct.campaign.journal import moved_aside, opened
from femstruct.campaign.tried import refuse_values, with_limits_of_study, with_place
from femstruct.errors import InputError
from femstruct.language import read_study
from femstruct.study.campaign.front import End
from femstruct.study.campaign.sought import VALLEYS, Search
from femstruct.study.campaign.swept import Swept
from femstruct.study.campaign.varied import Listed, Scattered
from femstruct.study.study import Plan
from femstruct.workflow.progress import Progress, counted
from femstruct.workflow.run.provenance import version_of
from femstruct.workflow.stages.fingerprint import fingerprint

ROWS: Final = "optimise.rows"  # where rows are kept as they come
HELD: Final = 1e-9  # share by which a limit may be exceeded: rounding
AT_END: Final = 0.002  # of a range: so near to its end, a design lies at it
SEEN: Final = 3  # designs of a sweep that a search begins with


@contextmanager
def designs_of(
    search: Search,
    folder: Path | None,
    workers: int | None,
    cluster: str,
    progress: Progress,
) -> Iterator[Designs]:
    """The designs of a search, to be tried; they end with the block."""
    plan = read_study(search.file, search.overrides, only=search.case or None)
    refuse_values(search, plan)
    with ExitStack() as stack:
        place = folder or Path(stack.enter_context(TemporaryDirectory()))
        place.mkdir(parents=True, exist_ok=True)
        make_ready(plan, progress)
        journal = stack.enter_context(opened(place / ROWS, name_of(search, plan)))
        run = stack.enter_context(crew(workers or os.cpu_count() or 1, cluster))
        told = counted(search.runs, "runs", progress, most=True)
        try:
            yield Designs(search, search.case or plan.baseline, journal, run, told)
        except KeyboardInterrupt:
            if not journal.rows():
                journal.remove()
            raise
        except InputError as error:
            raise with_place(search, error) from None


def table_of(search: Search, designs: Designs, command: str) -> Swept:
    """The rows of all designs, in their order."""
    samples = designs.samples()
    plan = read_study(search.file, search.overrides, only=search.case or None)
    whole = plan if search.case else read_study(search.file, search.overrides, only=plan.baseline)
    rows = gathered(search.title, whole, samples, designs.rows(), {}, command=command)
    return replace(rows, provenance={**rows.provenance, **_course(search)})


def ends_of(search: Search, point: Floats) -> tuple[End, ...]:
    """For every path the end of its range that a design, a point of the unit cube, lies at; "" inside and of lists."""
    return tuple(
        "" if isinstance(one, Listed) else "lower" if u < AT_END else "upper" if u > 1.0 - AT_END else ""
        for one, u in zip(search.designs, np.asarray(point), strict=True)
    )


def seen_before(search: Search, rows: Swept, case: str) -> Floats:
    """The best designs of a sweep that lie apart, as points of the unit cube [n, d]: those that hold all limits first.

    rows : of a sweep over all paths that may be chosen, and of a case; none of one over fewer, or without a number.
    """
    names = [search.goal, *(name for name in search.limits if name not in rows.paths)]
    columns = [rows.paths.index(one.path) if one.path in rows.paths else -1 for one in search.designs]
    if case not in rows.cases or not set(names) <= set(rows.names) or min(columns) < 0:
        return np.empty((0, len(columns)))
    points = np.array([_unit_of(one, rows, j) for one, j in zip(search.designs, columns, strict=True)]).T
    known = np.isfinite(points).all(axis=1) & rows.trusted(case) & np.isfinite(rows.of(search.goal, case))
    beyond = np.zeros(len(points))
    for name, limit in search.limits.items():
        own = rows.values[:, rows.paths.index(name)] if name in rows.paths else rows.of(name, case)
        over = np.where(np.isfinite(own), (own - limit) / (abs(limit) or 1.0), np.inf)
        beyond += np.where(over > HELD, over, 0.0)
    small = search.goals[0].sign * rows.of(search.goal, case)
    found: list[Floats] = []
    for k in sorted(np.flatnonzero(known & np.isfinite(beyond)), key=lambda k: (beyond[k], small[k])):
        if len(found) < SEEN and all(np.linalg.norm(points[k] - one) > VALLEYS for one in found):
            found.append(points[k])
    return np.array(found).reshape(-1, len(columns))


def _unit_of(one: Listed | Scattered, rows: Swept, j: int) -> Floats:
    """Where the values of a path of a sweep lie in the range, or the list, of what may be chosen [n]; nan outside."""
    values = rows.values[:, j]
    if isinstance(one, Listed):
        count = len(one.texts)
        texts = {text: (k + 0.5) / count for k, text in enumerate(one.texts)}
        numbers = {value: (k + 0.5) / count for k, value in enumerate(one.numbers)}
        told = zip(rows.texts, values.tolist(), strict=True)
        return np.array([texts.get(own[j], numbers.get(value, np.nan)) for own, value in told])
    if one.law == "log-uniform":
        values = np.log(np.where(values > 0.0, values, np.nan) / one.first) / np.log(one.second / one.first)
    else:
        values = (values - one.first) / (one.second - one.first)
    inside = (values > -AT_END) & (values < 1.0 + AT_END)
    return np.where(inside, np.clip(values, 0.0, 1.0), np.nan)


def set_aside(search: Search, folder: Path) -> Path | None:
    """Give the files of another optimisation in a folder names with a number; returns that of its rows, None where
    there are none."""
    if not (folder / ROWS).exists():
        return None
    plan = read_study(search.file, search.overrides, only=search.case or None)
    return moved_aside(folder / ROWS, name_of(search, plan))


def name_of(search: Search, plan: Plan) -> str:
    """A name for all that the rows of an optimisation hang on, but for files that some of its designs alone are read
    from: these the journal knows."""
    return fingerprint((dict(plan.sources), with_limits_of_study(search, plan), versions() | _course(search)))


def _course(search: Search) -> dict[str, str]:
    """The version of what leads a search for several goals, of others none."""
    return version_of("pymoo") if search.also else {}
