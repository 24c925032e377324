"""What a person is told while something is computed: how much of it is done, and about how long the rest takes."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Final

Progress = Callable[[str], None]
SOON: Final = 1.0  # seconds, before which nothing is said of what is left


def counted(of: int, what: str, progress: Progress, *, most: bool = False) -> Callable[[int], None]:
    """Tells how many of so many are done, and about how long the others take. most : fewer may do.

    >>> counted(500, "lines", print)(120)
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
