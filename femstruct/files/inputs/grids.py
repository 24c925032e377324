"""Tables of text as analysers write them: cells by line, whatever separates them and their decimals."""

from __future__ import annotations

import csv
import io
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Final, NamedTuple

from femstruct.errors import InputError, InputErrors, sentence, shown_as
from femstruct.files.inputs.decoded import decoded
from femstruct.files.inputs.opening import content

LARGEST: Final = 50_000_000  # bytes
_NUMBER: Final = re.compile(r"[+-]?(\d+(\.\d*|,\d+)?|[.,]\d+)([eE][+-]?\d+)?", re.ASCII)
_GROUPED: Final = re.compile(
    r"[+-]?\d{1,3}(?:([ '\u2019\u00a0\u202f])\d{3}(?:\1\d{3})*(?:[.,]\d*)?|(?:,\d{3})+\.\d*"
    r"|(?:\.\d{3})+,\d*|(?:,\d{3}){2,}|(?:\.\d{3}){2,})",
    re.ASCII,
)
_BLANKS: Final = re.compile(r"\s+")
_LOOKED: Final = 200  # lines by which separators are told


class Row(NamedTuple):
    """A line of a table: its number, from 1, and its cells."""

    line: int
    cells: list[str]


@dataclass(frozen=True)
class Grid:
    """Lines of a table that are not empty and no comments (#). comma : whether its decimals have a comma."""

    path: Path
    rows: tuple[Row, ...]
    comma: bool

    def number(self, row: Row, cell: str) -> float | None:
        """The number in a cell; None for words. Raises InputErrors for thousands separators, and for decimals of
        another kind than those of the table."""
        if _GROUPED.fullmatch(cell):
            raise self.wrong(row, f"{shown_as(cell)}, a number with a thousands separator", "a number without", _LEAVE)
        if not _NUMBER.fullmatch(cell):
            return None
        if ("," in cell) != self.comma and ("," in cell or "." in cell):
            got = f"{shown_as(cell)} in a table whose decimals have a {'comma' if self.comma else 'point'}"
            raise self.wrong(row, got, "decimals of one kind and no thousands separators", _LEAVE)
        return float(cell.replace(",", "."))

    def refuse_longer(self, row: Row) -> None:
        """Raise InputErrors for a line with more cells than the first has, as decimal commas between commas make it."""
        count, heads = len(row.cells), len(self.rows[0].cells)
        if any(row.cells[heads:]):
            raise self.wrong(row, f"{count} cells below {heads} head{'s' * (heads > 1)}", "one below each", _SEMICOLONS)

    def wrong(self, row: Row, got: str, expected: str, do: str = "") -> InputErrors:
        """A mistake in one of its lines."""
        return wrong_in(self.path, row.line, InputError("", got=got, expected=expected, do=do))


_LEAVE: Final = "leave out thousands separators, and write all decimals alike"
_SEMICOLONS: Final = "where decimals have a comma, separate columns by semicolons"


def wrong_in(path: Path, line: int, error: InputError) -> InputErrors:
    """An error as that of a line of a file."""
    return InputErrors((f"{path}:{line}:1: {sentence('', error.got, error.expected, error.do)}",))


def read_grid(
    path: Path, sources: dict[str, str], what: str = "a CSV file beside the study", single: bool = False
) -> Grid:
    """The table in a file. sources : is given its text under its name. single : whether one column alone is a table:
    below a head without a comma, numbers with one comma each are then decimals, not two columns.

    Raises InputError for a file that cannot be read, InputErrors for one that is no text.

    Notes
    -----
    Cells are separated by tabs, else semicolons, else commas, else blanks: by the first of these that half of the lines
    have, where commas inside of numbers between blanks are decimals. Decimals have a comma where any number has one
    that separates no cells.
    """
    text = decoded(path, content(path, LARGEST, what))
    sources[str(path)] = text
    return grid_of(path, text, single)


def grid_of(path: Path, text: str, single: bool = False) -> Grid:
    """The table in a text; path : for messages; single : as in `read_grid`.

    >>> grid_of(Path("a.csv"), "Hz;T [s]\\n63;1,5\\n").rows[1], grid_of(Path("a.csv"), "63;1,5").comma
    (Row(line=2, cells=['63', '1,5']), True)
    >>> grid_of(Path("a.csv"), "f [Hz]\\n29,35\\n63", single=True).rows[1]
    Row(line=2, cells=['29,35'])
    """
    lines = [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")]
    separator = ";" if single and _is_one_column(lines) else _separator(lines[:_LOOKED])
    try:
        if separator is None:
            found = [(number, _BLANKS.split(line.strip())) for number, line in enumerate(text.splitlines(), start=1)]
        else:
            reader = csv.reader(io.StringIO(text), delimiter=separator)
            found = [(reader.line_num, [cell.strip() for cell in cells]) for cells in reader]
    except csv.Error:
        raise InputError("", got=f"'{path}', which is no table", expected="a CSV file") from None
    rows = tuple(Row(number, cells) for number, cells in found if any(cells) and not cells[0].startswith("#"))
    numbers = [cell for row in rows for cell in row.cells if _NUMBER.fullmatch(cell)]
    commas, points = (any(mark in cell for cell in numbers) for mark in ",.")
    return Grid(path, rows, commas and (separator != "," or not points))  # in a table of commas they are in quotes


def _is_one_column(lines: list[str]) -> bool:
    """Whether below words without a comma all lines are a number: 29,35 is then no pair."""
    head = next((i for i, line in enumerate(lines) if _NUMBER.fullmatch(line.strip())), 0)
    below = [_NUMBER.fullmatch(line.strip()) for line in lines[head:]]
    return head > 0 and all(below) and not any("," in line for line in lines[:head])


def _separator(lines: list[str]) -> str | None:
    """What separates the cells of lines; None for blanks."""
    for mark in "\t;":
        if 2 * sum(mark in line for line in lines) >= len(lines) > 0:
            return mark
    words = [line.split() for line in lines]
    blanks = [all(map(_NUMBER.fullmatch, some)) and len(some) > 1 for some in words]
    return None if lines and 2 * sum(blanks) >= len(lines) else ","
