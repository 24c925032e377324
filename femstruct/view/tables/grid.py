"""Tables for the terminal whose cells are never broken: what is too wide goes on in another table below."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import zip_longest
from typing import Final

from rich.cells import cell_len
from rich.console import Console

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
