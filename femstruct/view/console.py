"""Where a person reads: the console, what is being computed, findings."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

from rich.console import Console

from femstruct.errors import Finding


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


def show_findings(screen: Console, findings: Sequence[tuple[Finding, str]]) -> None:
    """Findings, each with what is said after it."""
    if findings:
        screen.print("findings", style="bold")
    for finding, after in findings:
        mark = "NOT TO BE TRUSTED " if finding.severe else ""
        screen.print(f"  {mark}{finding.code}: {finding.message}{after}", soft_wrap=True)
