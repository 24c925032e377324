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
from femstruct.study.campaign.sought import Search
from femstruct.study.campaign.swept import Swept
from femstruct.study.campaign.varied import Listed
from femstruct.study.study import Plan
from femstruct.workflow.progress import Progress, counted
from femstruct.workflow.run.provenance import version_of
from femstruct.workflow.stages.fingerprint import fingerprint

ROWS: Final = "optimise.rows"  # where rows are kept as they come
HELD: Final = 1e-9  # share by which a limit may be exceeded: rounding
AT_END: Final = 0.002  # of a range: so near to its end, a design lies at it


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
