"""What a person reads on: the console, tables whose cells are never broken, easy units, lines of findings."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import zip_longest
from math import isnan
from typing import Final

from rich.cells import cell_len
from rich.console import Console

from femstruct.errors import Finding
from femstruct.findings.catalogue import rank_of, rank_order
from femstruct.findings.entry import REMARK, Rank

# ----------------------------------------------------------------------------------------------------------------------
# Where a person reads: the console, and what is being computed.
# ----------------------------------------------------------------------------------------------------------------------


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


# ----------------------------------------------------------------------------------------------------------------------
# Units in which a number is easy to read: kN rather than 3e5 N.
# ----------------------------------------------------------------------------------------------------------------------

ROUNDING: Final = 1e-9  # of the largest of its kind: what is left of a solved system, shown as 0
ZEROS: Final = f"; 0: below {ROUNDING:g} of the largest in its unit"  # ends titles of tables with such
_SCALES: Final = {  # unit: (how much of the unit, shown unit), the largest first
    "m": ((1.0, "m"), (1e-3, "mm"), (1e-6, "µm"), (1e-9, "nm")),
    "m/s": ((1.0, "m/s"), (1e-3, "mm/s"), (1e-6, "µm/s")),
    "m/s^2": ((1.0, "m/s²"), (1e-3, "mm/s²")),
    "rad": ((1.0, "rad"), (1e-3, "mrad")),
    "N": ((1e6, "MN"), (1e3, "kN"), (1.0, "N"), (1e-3, "mN")),
    "Pa": ((1e9, "GPa"), (1e6, "MPa"), (1e3, "kPa"), (1.0, "Pa"), (1e-3, "mPa"), (1e-6, "µPa")),
    "N/m": ((1e9, "GN/m"), (1e6, "MN/m"), (1e3, "kN/m"), (1.0, "N/m")),
    "N/m^1.5": ((1e9, "GN/m^1.5"), (1e6, "MN/m^1.5"), (1e3, "kN/m^1.5"), (1.0, "N/m^1.5")),
    "N*s/m": ((1e6, "MN*s/m"), (1e3, "kN*s/m"), (1.0, "N*s/m")),
    "J": ((1e6, "MJ"), (1e3, "kJ"), (1.0, "J"), (1e-3, "mJ"), (1e-6, "µJ")),
}


def digits(value: float) -> str:
    """Four significant digits, without an exponent up to a million; "-" for what is not known.

    >>> digits(17553.2), digits(0.0123456), digits(2.5e7), digits(float("nan"))
    ('17550', '0.01235', '2.5e+07', '-')
    """
    if isnan(value):
        return "-"
    return f"{float(f'{value:.4g}'):.0f}" if 1e4 <= abs(value) < 1e6 else f"{value:.4g}"


def rounded(value: float, largest: float) -> float:
    """A number, or 0 where it is rounding beside the largest of its kind.

    >>> rounded(1.3e-12, 40.0), rounded(1.3e-3, 40.0)
    (0.0, 0.0013)
    """
    return 0.0 if abs(value) < ROUNDING * abs(largest) else value


def scaled(unit: str, largest: float) -> tuple[float, str]:
    """A factor and a unit in which `largest` is a number near 1..1000 to read.

    >>> scaled("m", 0.0042)
    (1000.0, 'mm')
    """
    scales = _SCALES.get(unit, ((1.0, unit),))
    if not largest:
        return 1.0, unit
    size, name = next((scale for scale in scales if largest >= scale[0]), scales[-1])
    return 1.0 / size, name


# ----------------------------------------------------------------------------------------------------------------------
# Tables for the terminal whose cells are never broken: what is too wide goes on in another table below.
# ----------------------------------------------------------------------------------------------------------------------

GAP: Final = 2  # characters between columns


@dataclass(frozen=True)
class Grid:
    """A table of texts. keys : how many columns, from the left, name a row; they come again in every table below."""

    title: str
    columns: Sequence[str]
    keys: int = 1
    rows: list[Sequence[str]] = field(default_factory=list)

    def add(self, *cells: str) -> None:
        """One more row; a cell may have several lines."""
        self.rows.append(cells)

    def show(self, console: Console) -> None:
        """Print it, without its rows not at all."""
        if not self.rows:
            return
        table = [[cell.split("\n") for cell in row] for row in (self.columns, *self.rows)]
        widths = [max(cell_len(line) for row in table for line in row[i]) for i in range(len(self.columns))]
        for shown in fitting(widths, self.keys, console.width):
            head, *rest = (_aligned([row[i] for i in shown], [widths[i] for i in shown]) for row in table)
            console.print(self.title, style="italic", soft_wrap=True)
            console.print(head, style="bold", soft_wrap=True)
            console.print("\n".join(rest), soft_wrap=True)


Piece = str | Grid
"""A sentence or a table: what is told in the terminal and on the page."""


def show(pieces: Iterable[Piece], console: Console) -> None:
    """Print sentences and tables one after the other."""
    for one in pieces:
        if isinstance(one, Grid):
            one.show(console)
        else:
            console.print(one, soft_wrap=True)


def _aligned(cells: Sequence[Sequence[str]], widths: Sequence[int]) -> str:
    """One row, each cell given by its lines: the first to the left, the others to the right.

    >>> _aligned([["damper"], ["12.5", "(-3 %)"]], [8, 6])
    'damper      12.5\\n          (-3 %)'
    """
    lines = []
    for texts in zip_longest(*cells, fillvalue=""):
        spaces = [" " * (width - cell_len(text)) for text, width in zip(texts, widths, strict=True)]
        padded = [texts[0] + spaces[0], *(space + text for text, space in zip(texts[1:], spaces[1:], strict=True))]
        lines.append((" " * GAP).join(padded).rstrip())
    return "\n".join(lines)


def fitting(widths: Sequence[int], keys: int, most: int) -> Iterator[list[int]]:
    """Columns of each table: the keys, then as many others as fit into `most` characters, but one at least.

    >>> list(fitting([10, 6, 6, 6], keys=1, most=26))
    [[0, 1, 2], [0, 3]]
    """
    named = list(range(keys))
    start = sum(widths[:keys]) + GAP * (keys - 1)
    shown, taken = list(named), start
    for i in range(keys, len(widths)):
        if len(shown) > keys and taken + GAP + widths[i] > most:
            yield shown
            shown, taken = list(named), start
        shown.append(i)
        taken += GAP + widths[i]
    yield shown


# ----------------------------------------------------------------------------------------------------------------------
# Findings for a person: by rank, remarks only where they are asked for.
# ----------------------------------------------------------------------------------------------------------------------

NotedFinding = tuple[Finding, str]  # and what is said after it


def finding_lines(found: Sequence[NotedFinding], verbose: bool) -> list[tuple[Rank | None, str]]:
    """Lines with their ranks, what forbids trust first; without `verbose` remarks are counted, in a line of no rank.

    >>> found = [(Finding("two-way-coupling", "It has air"), " (case a)"), (Finding("twist-defect", "It twists"), "")]
    >>> [line for _, line in finding_lines(found, verbose=True)]
    ['limits trust, twist-defect: It twists', 'remark, two-way-coupling: It has air (case a)']
    >>> [line for _, line in finding_lines(found, verbose=False)]
    ['limits trust, twist-defect: It twists', '1 remark: -v shows it']
    """
    lines: list[tuple[Rank | None, str]] = []
    hidden = 0
    for finding, after in sorted(found, key=lambda one: rank_order(one[0])):
        rank = rank_of(finding.code, finding.severe)
        if rank is REMARK and not verbose:
            hidden += 1
        else:
            lines.append((rank, f"{rank.value}, {finding.code}: {finding.message}{after}"))
    if hidden:
        lines.append((None, "1 remark: -v shows it" if hidden == 1 else f"{hidden} remarks: -v shows them"))
    return lines


def doubt_note(codes: Iterable[str], before: str = "") -> str:
    """What the mark "?" in a table means, of findings that forbid to quote its numbers; nothing without any.

    >>> doubt_note(["stress-uneven", "peak-not-converged", "stress-uneven"], "; ")
    '; ? : do not quote, see stress-uneven and peak-not-converged'
    >>> doubt_note([])
    ''
    """
    named = " and ".join(dict.fromkeys(codes))
    return f"{before}? : do not quote, see {named}" if named else ""


def show_findings(screen: Console, found: Sequence[NotedFinding], verbose: bool) -> None:
    """Findings on a terminal, and how to learn more of them."""
    lines = finding_lines(found, verbose)
    if not lines:
        return
    hint = " (`femstruct explain CODE` explains one)" if any(rank for rank, _ in lines) else ""
    screen.print(f"findings{hint}", style="bold")
    for rank, line in lines:
        screen.print(f"  {line}", soft_wrap=True, style="bold red" if rank is Rank.FORBIDS else None)
