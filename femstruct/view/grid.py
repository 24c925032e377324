"""Tables for the terminal whose cells are never broken: what is too wide goes on in another table below."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Final

from rich.cells import cell_len
from rich.console import Console
from rich.table import Table

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
        lines = [self.columns, *self.rows]
        widths = [max(cell_len(line) for row in lines for line in row[i].split("\n")) for i in range(len(self.columns))]
        for shown in fitting(widths, self.keys, console.width):
            table = Table(box=None, pad_edge=False)
            for i in shown:
                table.add_column(self.columns[i], justify="left" if i == 0 else "right", no_wrap=True)
            for row in self.rows:
                table.add_row(*(row[i] for i in shown))
            console.print(self.title, style="italic", soft_wrap=True)  # as a table's own title it would be broken
            console.print(table)


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
