"""Values by octave or third octave from the files of analysers: reverberation times, forces, mobilities, reductions."""

from __future__ import annotations

import re
from collections.abc import Sequence
from math import floor, log10
from pathlib import Path
from typing import Final, NamedTuple

from femstruct.errors import InputError, list_some, quote_value
from femstruct.files.text_tables import Head, TextRow, TextTable, head_of, read_grid, scale_of, wrong_in

LOWEST_HZ, HIGHEST_HZ = 10.0, 20e3  # nominal third octaves
_NOMINAL: Final = (1.0, 1.25, 1.6, 2.0, 2.5, 3.15, 4.0, 5.0, 6.3, 8.0)  # IEC 61260-1 annex E, one decade
_NEAR: Final = 0.02  # nominal centres are up to 1.2 % from the exact ones, and analysers write either
_NAME: Final = re.compile(r"(\d+(?:[.,]\d+)?)\s*([kK]?)\s*(\d*)\s*(Hz|HZ|hz|㎐)?", re.ASCII)
_TOTALS: Final = {
    *("a", "b", "c", "z", "lin", "linear", "ap", "oa", "overall", "total", "sum", "mean", "average", "avg"),
    *("summe", "gesamt", "mittel", "mittelwert", "合計", "全体", "合成", "평균", "합계", "전체"),
}
_BLANK: Final = {"", "-", "--", "---", "\u2013", "*", "n/a", "nan", "n.a.", "x"}
_THOUSANDS: Final = "a thousands separator? Write 1250, 1.25 kHz or 1k25"


class BandValue(NamedTuple):
    """A value in SI units and the line of the file that it stands in."""

    value: float
    line: int


def band_of(text: str, in_kilohertz: bool = False) -> float | None:
    """Nominal centre [Hz] of the third octave that a text names; None for other words.

    Parameters
    ----------
    in_kilohertz : bool
        Whether plain numbers are in kHz.

    Raises
    ------
    InputError
        For a number that is near no nominal centre from 10 Hz to 20 kHz.

    Examples
    --------
    >>> [band_of(text) for text in ("1k", "1,25 kHz", "63 Hz", "1k25", "31.5", "125.89", "T20")]
    [1000.0, 1250.0, 63.0, 1250.0, 31.5, 125.0, None]
    """
    found = _NAME.fullmatch(text.strip())
    if found is None or (found[3] and not found[2]):
        return None
    number, kilo = found[1].replace(",", "."), bool(found[2]) or (in_kilohertz and not found[4])
    if found[3]:  # 1k25
        if "." in number:
            return None
        number = f"{number}.{found[3]}"
    frequency = float(number) * (1000.0 if kilo else 1.0)
    do = _THOUSANDS if re.fullmatch(r"\d{1,2}[.,]\d{3}", found[1]) else ""
    expected = f"a nominal octave or third octave from {LOWEST_HZ:g} Hz to {HIGHEST_HZ / 1e3:g} kHz"
    if not frequency > 0.0:
        raise InputError("", got=f"a band of {quote_value(text)}", expected=expected, do=do)
    step = round(10.0 * log10(frequency / 1000.0))
    nominal = float(f"{_NOMINAL[step % 10] * 10.0 ** (3 + floor(step / 10)):.6g}")
    off = abs(frequency / (1000.0 * 10.0 ** (step / 10.0)) - 1.0)
    if not LOWEST_HZ <= nominal <= HIGHEST_HZ or off > _NEAR:
        raise InputError("", got=f"a band of {quote_value(text)}", expected=expected, do=do)
    return nominal


def read_bands(path: Path, dimension: str, sources: dict[str, str], column: str = "") -> dict[float, BandValue]:
    """A table of bands {nominal centre [Hz]: value in SI units, with its line} from a file, as an analyser wrote it.

    Bands are in the first column or, beside one another, in a line; lines before them (title, date, device) and totals
    (A, Lin, Sum) are left out.

    Parameters
    ----------
    dimension : str
        Of the values, such as "time".
    sources : dict[str, str]
        Is given the text of the file under its name.
    column : str
        Which of several columns of values, by its name.

    Raises
    ------
    InputError
        For a file that cannot be read, InputErrors with the line for what is wrong in it: no bands, a band that is no
        nominal one or is there twice, a value missing, several columns and none chosen.
    """
    grid = read_grid(path, sources, "a table of bands beside the study")
    return bands_in(grid, dimension, column)


def bands_in(grid: TextTable, dimension: str, column: str = "") -> dict[float, BandValue]:
    """The bands of a table that is read; as `read_bands`."""
    heads, kilo, rows = _table(grid)
    number = _chosen(grid, [head_of(one, dimension) for one in heads], column, rows[0].line)
    head = head_of(heads[number], dimension)
    try:
        scale = scale_of(head, dimension)
    except InputError as error:
        raise wrong_in(grid.path, max(1, rows[0].line - 1), error) from None
    found: dict[float, BandValue] = {}
    for row in rows:
        try:
            band = band_of(row.cells[0], kilo)
        except InputError as error:
            raise wrong_in(grid.path, row.line, error) from None
        if band is None:
            if row.cells[0].lower().split("[")[0].strip(" ()") in _TOTALS:
                continue
            alike = len(row.cells) == len(rows[0].cells)  # else it may be another file altogether
            got = quote_value(row.cells[0]) if alike else f"{len(row.cells)} columns"
            raise grid.wrong(row, got, f"a band, such as 63, 1k or 1,25 kHz, and {len(rows[0].cells) - 1} values")
        if band in found:
            raise grid.wrong(row, f"{band:g} Hz again (line {found[band].line})", "each band once")
        cell = row.cells[number + 1] if number + 1 < len(row.cells) else ""
        value = None if cell.lower() in _BLANK else grid.number(row, cell)
        if value is None:
            got = f"no value at {band:g} Hz" if cell.lower() in _BLANK else quote_value(cell)
            raise grid.wrong(row, got, "a number in every band", "leave out the line of a band that was not measured")
        if lost := next((one for one in row.cells[len(heads) + 1 :] if grid.number(row, one) is not None), ""):
            raise grid.wrong(row, f"{quote_value(lost)} beyond the columns above", f"{len(rows[0].cells) - 1} values")
        found[band] = BandValue(scale(value), row.line)
    return found


def _table(grid: TextTable) -> tuple[list[list[str]], bool, list[TextRow]]:
    """What stands above each column of values, from the top; whether bands are in kHz; lines that begin with a band,
    and all that follow."""
    across = next((i for i in range(len(grid.rows)) if _is_across(grid, i)), None)
    if across is not None:
        return _turned(grid, across)
    first = next((i for i, row in enumerate(grid.rows) if len(row.cells) > 1 and _begins(grid, row)), None)
    for row in grid.rows[:first]:  # a value that cannot be read would take its band with it
        if first is not None and len(row.cells) == len(grid.rows[first].cells) and _is_band(row.cells[0]):
            raise grid.wrong(row, quote_value(", ".join(row.cells[1:])), "a number in every band")
    if first is None:
        line = grid.rows[0].line if grid.rows else 1
        expected = "lines of a band and a value, such as '63;0,52' or '1k, 0.52'"
        raise wrong_in(grid.path, line, InputError("", got="no table of bands", expected=expected))
    width = len(grid.rows[first].cells)
    above = [row.cells for row in grid.rows[max(0, first - 2) : first] if len(row.cells) >= width]
    heads = [[cells[j] for cells in above] for j in range(1, width)]
    return heads, any(_in_kilohertz(cells[0]) for cells in above), list(grid.rows[first:])


def _is_across(grid: TextTable, at: int) -> bool:
    """Whether a line has bands beside one another, behind a label or from its first cell on.

    Raises InputErrors where its first cell is neither, and where bands may as well stand below one another.
    """
    row = grid.rows[at]
    try:
        labelled = band_of(row.cells[0]) is None
    except InputError as error:
        if _bands(row.cells[1:]) < 3:
            return False
        raise grid.wrong(row, f"{quote_value(row.cells[0])} before bands", f"a label, or {error.expected}") from None
    if labelled:
        return _bands(row.cells[1:]) >= 3
    if _bands(row.cells) < 3:
        return False
    down = [row.cells[0], *(one.cells[0] for one in grid.rows[at + 1 :])]
    if len(down) < 2 or _bands(down) < len(down) or sum("hz" in cell.lower() for cell in row.cells) > 1:
        return True
    if any(len(one.cells) == len(row.cells) for one in grid.rows[:at]):
        return False  # it has heads above
    got = "bands in the first line and in the first column"
    raise grid.wrong(row, got, "one of them", "write a word, such as 'Band', before the bands of a line")


def _turned(grid: TextTable, across: int) -> tuple[list[list[str]], bool, list[TextRow]]:
    """A table with its bands beside one another, as one with its bands below one another."""
    head, below = grid.rows[across], [row for row in grid.rows[across + 1 :] if len(row.cells) > 1]
    if not below:
        raise grid.wrong(head, "bands beside one another and no values below", "a line of values")
    if _is_band(head.cells[0]):
        head, below = _labelled(grid, head, below)
    for row in below:
        if len(row.cells) < len(head.cells) or any(row.cells[len(head.cells) :]):
            raise grid.wrong(row, f"{len(row.cells) - 1} values", f"one for each of the {len(head.cells) - 1} bands")
        lost = next((cell for name, cell in zip(head.cells, row.cells, strict=False) if cell and not name), "")
        if lost and lost != row.cells[0]:
            raise grid.wrong(row, f"{quote_value(lost)} below no band", "a band above each value")
    named = [i for i, cell in enumerate(head.cells) if i and cell]
    rows = [TextRow(below[0].line, [head.cells[i], *(row.cells[i] for row in below)]) for i in named]
    return [[row.cells[0]] for row in below], _in_kilohertz(head.cells[0]), rows


def _labelled(grid: TextTable, head: TextRow, below: list[TextRow]) -> tuple[TextRow, list[TextRow]]:
    """Lines that begin with a band and with its values, with a blank label before each; values may have theirs."""
    made = []
    for row in below:
        words = bool(row.cells[0]) and row.cells[0].lower() not in _BLANK and grid.number(row, row.cells[0]) is None
        if words and len(row.cells) <= len(head.cells):
            got = f"{quote_value(row.cells[0])} below the band {head.cells[0]}"
            raise grid.wrong(row, got, "a value", "write a word, such as 'Band', before the first band")
        made.append(row if words else TextRow(row.line, ["", *row.cells]))
    return TextRow(head.line, ["", *head.cells]), made


def _chosen(grid: TextTable, heads: Sequence[Head], column: str, line: int) -> int:
    """Which column of values is meant, from 0."""
    names = [head.name for head in heads]
    if column:
        fitting = [i for i, name in enumerate(names) if name == column]
        if not fitting:
            error = InputError("", got=f"no column '{column}'", expected=f"one of {list_some(names)}")
            raise wrong_in(grid.path, line, error)
        if len(fitting) > 1:
            got = f"{len(fitting)} columns '{column}'"
            raise wrong_in(
                grid.path, line, InputError("", got=got, expected="one of that name", do="rename the others")
            )
        return fitting[0]
    if len(heads) > 1:
        known = list_some([name or f"column {i + 2}" for i, name in enumerate(names)])
        do = f"write 'column: {names[0]}' beside the file" if names[0] else "keep one column, or name them in a head"
        raise wrong_in(
            grid.path, line, InputError("", got=f"{len(heads)} columns of values: {known}", expected="one", do=do)
        )
    return 0


def _begins(grid: TextTable, row: TextRow) -> bool:
    """Whether a line is the first of a table: a band, and a number or a blank."""
    try:
        is_band = band_of(row.cells[0]) is not None
    except InputError:
        is_band = True  # a number that is no band: a mistake in the table, or a table of something else
    filled = [cell for cell in row.cells[1:] if cell.lower() not in _BLANK]
    return is_band and all(grid.number(row, cell) is not None for cell in filled)


def _is_band(cell: str) -> bool:
    """Whether a cell names a band."""
    try:
        return band_of(cell) is not None
    except InputError:
        return False


def _bands(cells: Sequence[str]) -> int:
    """How many cells name bands, if all that are not blank do, but for totals, and they rise as bands do."""
    known: list[float] = []
    for cell in cells:
        try:
            band = band_of(cell)
        except InputError:
            return 0
        if band is not None:
            known.append(band)
        elif cell and cell.lower() not in _TOTALS:
            return 0
    return len(known) if known == sorted(set(known)) else 0


def _in_kilohertz(cell: str) -> bool:
    return "kHz" in cell
