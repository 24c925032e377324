"""Where a person reads: the console, and what is being computed."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console


@contextmanager
def progress() -> Iterator[Callable[[str], None]]:
    """A line that says what is being computed and for how long already, on a terminal; silence in a pipe."""
    screen = Console(stderr=True)
    if not screen.is_terminal:
        yield lambda line: None
        return
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    columns = (SpinnerColumn(), TextColumn("{task.description}", markup=False), TimeElapsedColumn())
    with Progress(*columns, console=screen, transient=True) as shown:
        task = shown.add_task("")
        yield lambda line: shown.update(task, description=line)


def console() -> Console:
    """Where tables go: as wide as the terminal, of a fixed width in a pipe."""
    return Console(width=None if sys.stdout.isatty() else 160, highlight=False, markup=False)
