"""Force histories and contact laws from CSV files of two columns."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final, TypeVar

from femstruct.errors import FemstructError, InputError, InputErrors, sentence, shown_as
from femstruct.files.inputs.opening import content
from femstruct.impact.scene.bodies import Table
from femstruct.units import QuantityError, quantity

LARGEST: Final = 50_000_000  # bytes
T = TypeVar("T")


def read_history(path: Path, what: str, sources: dict[str, str]) -> Table:
    """A force [N] or pressure [Pa] over time [s] from two columns, time and value; raises as `read_columns`.

    what : "force" or "pressure". sources : is given the text of the file under its name.
    """
    return read_columns(path, ("time", what), sources, Table)


def read_measured(path: str | Path, what: str) -> Table:
    """A measured history from a CSV file of two columns, time [s] and value; what : a dimension, such as "force".

    Raises InputErrors: the mistake of the file in one line.
    """
    try:
        return read_history(Path(path), what, {})
    except InputErrors:
        raise
    except InputError as error:
        raise InputErrors((f"{path}: {sentence('', error.got, error.expected, error.do)}",)) from None


_WORDS: Final = {"time": "time, value", "length": "indentation, force"}


def read_columns(path: Path, dimensions: tuple[str, str], sources: dict[str, str], make: Callable[[Any, Any], T]) -> T:
    """What is made of two columns in SI units.

    A first line of words is a header; a unit in brackets or parentheses after a word, as in ``time [ms], force [kN]``,
    scales its column. Lines that are empty or begin with # are skipped.

    sources : is given the text of the file under its name.

    Raises InputError for a file that is no table, InputErrors with the line for what is wrong in it.
    """
    try:
        text = content(path, LARGEST, "a CSV file beside the study").decode("utf-8-sig")
        rows = list(csv.reader(io.StringIO(text)))
    except (UnicodeDecodeError, csv.Error):
        raise InputError("", got=f"'{path}', which is no table", expected="a CSV file of text in UTF-8") from None
    sources[str(path)] = text
    scales, header = [1.0, 1.0], True
    pairs: list[list[float]] = []
    for number, row in enumerate(rows, start=1):
        cells = [cell.strip() for cell in row]
        if not any(cells) or cells[0].startswith("#"):
            continue
        try:
            if len(cells) != 2:
                raise InputError(
                    "",
                    got=f"{len(cells)} columns",
                    expected=f"two: {_WORDS[dimensions[0]]}",
                    do="separate them by a comma, and write decimals with a point",
                )
            numbers = _numbers(cells)
            if numbers is not None:
                pairs.append([value * scale for value, scale in zip(numbers, scales, strict=True)])
            elif not header:
                raise InputError("", got=shown_as(", ".join(cells)), expected="two numbers")
            else:
                scales = [_scale(cell, dimension) for cell, dimension in zip(cells, dimensions, strict=True)]
        except InputError as error:
            raise _in_line(path, number, error) from None
        header = False
    if len(pairs) < 2:
        raise InputError("", got=f"{len(pairs)} lines of numbers in '{path}'", expected="two or more")
    try:
        return make([first for first, _ in pairs], [second for _, second in pairs])
    except FemstructError as error:
        raise _in_line(path, 1, error) from None


def _in_line(path: Path, number: int, error: FemstructError) -> InputErrors:
    return InputErrors((f"{path}:{number}:1: {sentence('', error.got, error.expected, error.do)}",))


def _numbers(cells: list[str]) -> list[float] | None:
    """Two finite numbers; None for words."""
    try:
        return [quantity(float(cell), "ratio") for cell in cells]
    except QuantityError:
        raise InputError("", got=shown_as(", ".join(cells)), expected="finite numbers") from None
    except ValueError:
        return None


def _scale(cell: str, dimension: str) -> float:
    """What the unit in a column's header multiplies it with."""
    unit = cell.replace("(", "[").replace(")", "]").partition("[")[2].rstrip("] ")
    try:
        return quantity(f"1 {unit}", dimension) if unit else 1.0
    except QuantityError as error:
        raise InputError("", got=shown_as(cell), expected=error.expected, do=error.do) from None
