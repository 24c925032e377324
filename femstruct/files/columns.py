"""Histories, spectra and contact laws from CSV files of two or three columns."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final, TypeVar

import numpy as np

from femstruct.errors import FemstructError, InputError, InputErrors, quote_value, sentence
from femstruct.files.text_tables import Scale, TextRow, TextTable, head_of, read_grid, scale_of, wrong_in
from femstruct.impact.scene import Table

T = TypeVar("T")


def read_history(path: Path, what: str, sources: dict[str, str]) -> Table:
    """A force [N] or pressure [Pa] over time [s] from two columns, time and value; raises as `read_columns`.

    Parameters
    ----------
    what : str
        "force" or "pressure".
    sources : dict[str, str]
        Is given the text of the file under its name.
    """
    return read_columns(path, ("time", what), sources, Table)


def read_footstep(path: Path, sources: dict[str, str]) -> Table:
    """The force of a foot over time from a force plate, positive downwards in the file, along z in the table.

    Raises as `read_columns`, and for a record that pulls at the floor on the average.
    """

    def downwards(times: list[float], forces: list[float]) -> Table:
        table = Table(np.array(times), -np.array(forces))
        if not float(np.trapezoid(table.values, table.times)) < 0.0:
            got, do = "a force that is upwards on the average", "record it positive downwards, or change its sign"
            raise InputError("", got=got, expected="the force of a foot on the floor", do=do)
        return table

    return read_columns(path, ("time", "force"), sources, downwards)


def read_measured(path: str | Path, what: str) -> Table:
    """A measured history from a CSV file of two columns, time [s] and value.

    Parameters
    ----------
    what : str
        A dimension, such as "force".

    Raises
    ------
    InputErrors
        The mistake of the file in one line.
    """
    try:
        return read_history(Path(path), what, {})
    except InputErrors:
        raise
    except InputError as error:
        raise InputErrors((f"{path}: {sentence('', error.got, error.expected, error.do)}",)) from None


_COUNTS: Final = {2: "two", 3: "three"}
_WORDS: Final = {
    "time": {2: "time, value"},
    "length": {2: "indentation, force"},
    "frequency": {2: "frequency, value", 3: "frequency, real part, imaginary part"},
}
_DO: Final = "separate them by a semicolon, a tab or a comma; where a comma does, write decimals with a point"


def read_columns(path: Path, dimensions: Sequence[str], sources: dict[str, str], make: Callable[..., T]) -> T:
    """What is made of columns in SI units, one for each of their dimensions.

    Lines of words before the numbers are a head; a unit after a word in the last of them, as in ``time [ms], force
    [kN]``, ``t / ms`` or ``Kraft in kN``, scales its column. Lines that are empty or begin with # are skipped. See
    `read_grid` for separators, decimals and encodings.

    Parameters
    ----------
    sources : dict[str, str]
        Is given the text of the file under its name.

    Raises
    ------
    InputError
        For a file that is no table, InputErrors with the line for what is wrong in it.
    """
    grid, count = read_grid(path, sources), len(dimensions)
    expected = f"{_COUNTS[count]}: {_WORDS[dimensions[0]][count]}"
    lines: list[list[float]] = []
    head: list[TextRow] = []
    scales: list[Scale] = []
    for row in grid.rows:
        numbers = _numbers(grid, row)
        if numbers is None and lines and len(row.cells) == count:
            raise grid.wrong(row, quote_value(", ".join(row.cells)), f"{_COUNTS[count]} numbers")
        if numbers is None and not lines:
            if len(row.cells) == count and grid.number(row, row.cells[0]) is not None:  # a line of data, no head
                raise grid.wrong(row, quote_value(", ".join(row.cells)), f"{_COUNTS[count]} numbers")
            head.append(row)
            continue
        scales = scales or _scales(grid, head, dimensions)
        if numbers is None or len(numbers) != count:
            raise grid.wrong(row, f"{len(row.cells)} columns", expected, _DO)
        lines.append([scale(value) for value, scale in zip(numbers, scales, strict=True)])
    odd = next((row for row in head if len(row.cells) != count), None)
    if odd is not None and not lines:
        raise grid.wrong(odd, f"{len(odd.cells)} columns", expected, _DO)
    if len(lines) < 2:
        raise InputError("", got=f"{len(lines)} lines of numbers in '{path}'", expected="two or more")
    try:
        return make(*([line[i] for line in lines] for i in range(count)))
    except FemstructError as error:
        raise InputErrors((f"{path}:1:1: {sentence('', error.got, error.expected, error.do)}",)) from None


def _numbers(grid: TextTable, row: TextRow) -> list[float] | None:
    """The numbers of a line; None for words."""
    found = [grid.number(row, cell) for cell in row.cells]
    numbers = [one for one in found if one is not None]
    if any(cell.lower().lstrip("+-") in _ENDLESS for cell in row.cells):
        raise grid.wrong(row, quote_value(", ".join(row.cells)), "finite numbers")
    return numbers if len(numbers) == len(found) else None


_ENDLESS: Final = ("nan", "inf", "infinity")


def _scales(grid: TextTable, head: Sequence[TextRow], dimensions: Sequence[str]) -> list[Scale]:
    """What the units in the last two lines of a head make of the columns."""
    above = [row for row in head[-2:] if len(row.cells) == len(dimensions)]
    try:
        return [
            scale_of(head_of([row.cells[i] for row in above], dimension), dimension)
            for i, dimension in enumerate(dimensions)
        ]
    except InputError as error:
        raise wrong_in(grid.path, above[-1].line, error) from None
