"""Measured natural frequencies from a table: a column of frequencies, and beside it mode numbers and their scatter."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.errors import InputError, quote_value
from femstruct.files.text_tables import Head, TextRow, TextTable, factor_of, head_of, read_grid, wrong_in

NUMBER, FREQUENCY, SCATTER = "mode", "frequency", "scatter"
_WORDS: Final = {
    NUMBER: ("mode", "number", "no", "no.", "nr", "nr."),
    FREQUENCY: ("frequency", "frequency_hz", "natural frequency", "f", "hz"),
    SCATTER: ("scatter", "scatter_hz", "sd", "standard deviation", "sigma", "+-"),
}
_HEADLESS: Final = "if 29,35 is a decimal, put a line 'frequency [Hz]' above"
MOST_SCATTER: Final = 0.2  # of a frequency: two of it leave stiffness, its square, between 0.36 and 1.96 times
_EXPECTED: Final = "a line of heads, such as 'mode, frequency [Hz], scatter [%]', and numbers below"


@dataclass(frozen=True, eq=False)
class FrequencyTable:
    """Natural frequencies [k] [Hz], ascending. numbers [k] : of the modes, from 1; None where they are not given.
    scatter [k] : standard deviations [Hz]; None where they are not given."""

    frequency_hz: Floats
    numbers: Integers | None
    scatter: Floats | None


def read_frequencies(path: Path) -> FrequencyTable:
    """Natural frequencies of a file of one column, or of columns with heads: frequency [Hz], mode, scatter [%] or [Hz].

    Raises InputError for a file that cannot be read, InputErrors with the line for what is wrong in it.
    """
    grid = read_grid(path, {}, "a table of natural frequencies", single=True)
    if not grid.rows:
        raise wrong_in(path, 1, InputError("", got="an empty table", expected=_EXPECTED))
    first = grid.rows[0]
    headed = any(grid.number(first, cell) is None for cell in first.cells)
    if not headed and len(first.cells) > 1:
        do = _HEADLESS if all(len(row.cells) == 2 for row in grid.rows) else ""
        raise grid.wrong(first, f"{len(first.cells)} columns without heads", _EXPECTED, do)
    columns = _columns(grid, first) if headed else {FREQUENCY: (0, Head("", "Hz"))}
    rows = grid.rows[1:] if headed else grid.rows
    if not rows:
        raise grid.wrong(first, "no numbers", _EXPECTED)
    for row in rows:
        grid.refuse_longer(row)
    found = {name: np.array([_value(grid, row, at) for row in rows]) for name, (at, _) in columns.items()}
    frequency = found[FREQUENCY] * _hertz(grid, first, columns[FREQUENCY][1])
    for row, hz in zip(rows, frequency.tolist(), strict=True):
        if not hz > 0.0:
            raise grid.wrong(row, f"a frequency of {hz:g} Hz", "one above 0", "leave out rigid modes")
    order = np.argsort(frequency, kind="stable")
    numbers = found[NUMBER].astype(np.int64)[order] if NUMBER in found else None
    scatter = _scatter(grid, rows, found[SCATTER], columns[SCATTER][1], frequency) if SCATTER in found else None
    if numbers is not None:
        _check_numbers(grid, rows, found[NUMBER])
    return FrequencyTable(frequency[order], numbers, None if scatter is None else scatter[order])


def _columns(grid: TextTable, head: TextRow) -> dict[str, tuple[int, Head]]:
    """Where each column is, by what its head says."""
    heads = [head_of([cell], "frequency") for cell in head.cells]
    known = {word: name for name, words in _WORDS.items() for word in words}
    named = [known.get((one.name or one.unit or cell).lower()) for one, cell in zip(heads, head.cells, strict=True)]
    found = {name: (i, heads[i]) for i, name in enumerate(named) if name is not None}
    twice = next((name for name in found if named.count(name) > 1), None)
    if twice is not None:
        same = [cell for cell, name in zip(head.cells, named, strict=True) if name == twice]
        raise grid.wrong(head, f"columns {', '.join(same)}, all of them a {twice}", "one of each", "rename the others")
    if FREQUENCY not in found:
        raise grid.wrong(head, quote_value(", ".join(head.cells)), _EXPECTED)
    return found


def _hertz(grid: TextTable, row: TextRow, head: Head) -> float:
    """What the unit of a column multiplies its numbers with; plain ones are in Hz."""
    try:
        return factor_of(head.unit, "frequency")[0]
    except InputError as error:
        raise wrong_in(grid.path, row.line, error) from None


def _value(grid: TextTable, row: TextRow, at: int) -> float:
    value = grid.number(row, row.cells[at]) if at < len(row.cells) else None
    if value is None:
        raise grid.wrong(row, quote_value(row.cells[at]) if at < len(row.cells) else "no value", "a number")
    return value


def _scatter(grid: TextTable, rows: tuple[TextRow, ...], values: Floats, head: Head, frequency: Floats) -> Floats:
    """Standard deviations [Hz]: of a column in per cent they are shares of the frequencies."""
    scatter = values * (frequency / 100.0 if head.unit == "%" else _hertz(grid, grid.rows[0], head))
    for row, one, hertz in zip(rows, scatter.tolist(), frequency.tolist(), strict=True):
        if not one > 0.0:
            raise grid.wrong(row, f"a scatter of {one:g} Hz", "one above 0")
        if one > MOST_SCATTER * hertz:
            got, expected = f"a scatter of {one:.4g} Hz at {hertz:.4g} Hz", f"{100.0 * MOST_SCATTER:g} % of it or less"
            raise grid.wrong(row, got, expected, "write its unit in the head: scatter [%] or scatter [Hz]")
    return np.asarray(scatter)


def _check_numbers(grid: TextTable, rows: tuple[TextRow, ...], numbers: Floats) -> None:
    for row, number in zip(rows, numbers.tolist(), strict=True):
        if number < 1 or number != int(number):
            raise grid.wrong(row, f"mode {number:g}", "a mode number from 1, as 'femstruct modes' prints it")
    if len(set(numbers.tolist())) < len(numbers):
        raise grid.wrong(rows[-1], "a mode number twice", "each mode once")
