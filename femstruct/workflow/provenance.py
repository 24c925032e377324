"""Where a result comes from, and the CPU seconds that its stages took."""

from __future__ import annotations

import os
import platform
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from typing import Final

from femstruct.sparse import FASTEST
from femstruct.study.study import Plan
from femstruct.workflow.bases import fingerprint

# ----------------------------------------------------------------------------------------------------------------------
# What a person is told while something is computed: how much of it is done, and about how long the rest takes.
# ----------------------------------------------------------------------------------------------------------------------

Progress = Callable[[str], None]
SOON: Final = 1.0  # seconds, before which nothing is said of what is left


def progress_counter(of: int, what: str, progress: Progress, *, most: bool = False) -> Callable[[int], None]:
    """Tells how many of so many are done, and about how long the others take.

    Parameters
    ----------
    most : bool
        Fewer may do.

    Examples
    --------
    >>> progress_counter(500, "lines", print)(120)
    120 of 500 lines
    """
    began = time.monotonic()
    words = ("at most ", "at most ") if most else ("", "about ")

    def tell(done: int) -> None:
        elapsed = time.monotonic() - began
        left = f", {words[1]}{duration(elapsed * (of - done) / done)} left" if done and elapsed > SOON else ""
        progress(f"{done} of {words[0]}{of} {what}{left}")

    return tell


def place(number: int, of: int, elapsed: float) -> str:
    """Which of several cases it is, counted from 1, and about how long all that are left take [s]; "" for one alone.

    >>> place(1, 3, 0.0), place(3, 4, 10.0), place(1, 1, 0.0)
    (' (1 of 3)', ' (3 of 4, about 10 s left)', '')
    """
    if of == 1:
        return ""
    left = f", about {elapsed * (of - number + 1) / (number - 1):.0f} s left" if number > 1 else ""
    return f" ({number} of {of}{left})"


def duration(seconds: float) -> str:
    """A time as it is told.

    >>> duration(8.2), duration(100.0), duration(7300.0)
    ('9 s', '2 min', '2.0 h')
    """
    if seconds < 90.0:
        return f"{int(seconds) + 1} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 5400.0 else f"{seconds / 3600.0:.1f} h"


# ----------------------------------------------------------------------------------------------------------------------
# Where a result comes from, and the CPU seconds that its stages took.
# ----------------------------------------------------------------------------------------------------------------------


def provenance(command: str) -> dict[str, str]:
    """Versions, platform, time and command line of a run."""
    return _versions() | {
        "sparse_solver": FASTEST,
        "python": sys.version.split()[0],
        "platform": platform.platform(),
        "utc": datetime.now(UTC).isoformat(timespec="seconds"),
        "command": command,
    }


def inputs_of(plan: Plan) -> str:
    """A name for all that a run of a plan hangs on: its files verbatim, wherever they are, and what was changed in them
    or left out of them. Not the program: a run of another version takes the place of an older one.

    >>> inputs_of(Plan("", (), "a")) == inputs_of(Plan("", (), "b"))
    False
    """
    cases = plan.cases
    content = (sorted(plan.sources.values()), plan.baseline, [case.name for case in cases])
    try:
        return fingerprint((content, cases))
    except TypeError:  # a function of a script has no value of its own
        return fingerprint((content, [dict(case.changes) for case in cases]))


@cache
def _versions() -> dict[str, str]:
    packages: tuple[str, ...] = ("femstruct", "numpy", "scipy", "numba", "h5py")
    packages += ("rslab",) if FASTEST == "rslab" else ()
    return {f"{name}_version": version(name) for name in packages}


def version_of(name: str) -> dict[str, str]:
    """The version of an extra, as `provenance` names it; {} where it is not installed.

    >>> version_of("no such package")
    {}
    """
    try:
        return {f"{name}_version": version(name)}
    except PackageNotFoundError:
        return {}


class Stopwatch:
    """CPU seconds by stage, told to a listener as each stage starts."""

    def __init__(self, progress: Progress) -> None:
        self.tell = progress
        self._place = ""
        self.seconds: dict[str, float] = {}

    def at(self, number: int, of: int, since: float) -> None:
        """Say from now on which of several cases is run, and about how long all of them still take.

        Parameters
        ----------
        since : float
            When the first of them began, by `time.monotonic`.
        """
        self._place = place(number, of, time.monotonic() - since)

    @contextmanager
    def __call__(self, stage: str, case: str = "") -> Iterator[Progress]:
        """Yields what tells how far the stage is."""
        line = (f"{case}: {stage}" if case else stage) + self._place
        self.tell(line)
        begin = _cpu_seconds()
        try:
            yield lambda how_far: self.tell(f"{line}: {how_far}")
        finally:
            self.seconds[stage] = self.seconds.get(stage, 0.0) + _cpu_seconds() - begin


def _cpu_seconds() -> float:
    """Of this process and of those it has waited for."""
    return time.process_time() + sum(os.times()[2:4])
