"""A study that is run again whenever one of its files is saved, with what did not change kept from run to run."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Final

from femstruct.language.cases import read_study
from femstruct.study.results import StudyResult
from femstruct.study.study import Plan
from femstruct.workflow.bases import with_positions
from femstruct.workflow.provenance import Progress
from femstruct.workflow.run import KeptStages, run_again, write_numbers

LOOK: Final = 0.05  # seconds between two looks at the files
Stamp = tuple[tuple[int, int] | None, ...]  # time and size of every file, None for one that is not there


@dataclass(frozen=True, eq=False)
class Round:
    """One run of a watched study: result, what it took from the last one, seconds until its numbers and sound were
    written; or the error that it ended with."""

    result: StudyResult | None
    reused: str
    seconds: float
    error: Exception | None = None


def _look_again() -> bool:
    time.sleep(LOOK)
    return True


def rounds(
    study: Path,
    sets: Sequence[str],
    case: str,
    folder: Path,
    progress: Progress = lambda line: None,
    wait: Callable[[], bool] = _look_again,
    command: str = "",
    keep: Progress | None = None,
) -> Iterator[Round]:
    """Run a study, and again at every change of its files, its model's, and those they name, until nobody waits.

    Numbers, tables and sound are written to the folder at every round, no results.h5 and no pictures. A file that
    cannot be read, or a result that cannot be had, is a round with an error: what was kept stays, and the watch goes
    on.

    Parameters
    ----------
    wait : Callable[[], bool]
        Called between two looks at the files; False ends the watch.
    keep : Progress | None
        As for `write_all`, of what is in the folder before the first round; a round replaces the one before.
    """
    kept = KeptStages()
    files: tuple[Path, ...] = (study,)
    while True:
        stamp, begin = _stamp(files), time.perf_counter()
        try:
            plan = read_study(study, tuple(sets), only=case or None)
            files = _files(study, plan)
            stamp = _stamp(files)
            with with_positions(plan):
                result, left = run_again(plan, kept, progress, command)
            # Ctrl-C after the baseline: the watch ends, and what is not whole is not kept
            if any(one.code == "interrupted" for one in result.findings):
                raise KeyboardInterrupt
            kept = left
            write_numbers(result, folder, progress, keep)
            keep = None
            yield Round(result, kept.reused, time.perf_counter() - begin)
        except Exception as error:  # told by who watches: a saved mistake does not end the watch
            yield Round(None, "nothing", time.perf_counter() - begin, error=error)
        if not _changed(files, stamp, wait):
            return


def _files(study: Path, plan: Plan) -> tuple[Path, ...]:
    return tuple(dict.fromkeys(chain((study,), map(Path, plan.sources))))


def _changed(files: Sequence[Path], stamp: Stamp, wait: Callable[[], bool]) -> bool:
    """Wait until a file differs and then stays as it is for one look; False where nobody waits any longer."""
    before = stamp
    while wait():
        now = _stamp(files)
        if now != stamp and now == before and None not in now:
            return True
        before = now
    return False


def _stamp(files: Sequence[Path]) -> Stamp:
    stamps: list[tuple[int, int] | None] = []
    for path in files:
        try:
            found = path.stat()
            stamps.append((found.st_mtime_ns, found.st_size))
        except OSError:
            stamps.append(None)
    return tuple(stamps)
