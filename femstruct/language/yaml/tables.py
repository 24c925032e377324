"""Force histories and contact laws from CSV files of two columns."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import Final

from femstruct.errors import FemstructError, InputError
from femstruct.impact.laws.tabulated import Tabulated
from femstruct.impact.scene.bodies import Table
from femstruct.language.yaml.opening import content
from femstruct.language.yaml.reader import Mistakes, Position
from femstruct.units import QuantityError, quantity, shown_as

LARGEST: Final = 50_000_000  # bytes


def read_history(
    path: Path, what: str, asked_at: Position, asked_path: str, mistakes: Mistakes, sources: dict[str, str]
) -> Table | None:
    """A force [N] or pressure [Pa] over time [s] from two columns, time and value; None with mistakes noted.

    what : "force" or "pressure". sources : is given the text of the file under its name.
    """
    columns = _read_columns(path, ("time", what), asked_at, asked_path, mistakes, sources)
    if columns is None:
        return None
    try:
        return Table(*columns)  # type: ignore[arg-type]
    except FemstructError as error:
        mistakes.add(Position(str(path), 1, 1), "", got=error.got, expected=error.expected)
        return None


def read_measured(path: str | Path, what: str) -> Table:
    """A measured history from a CSV file of two columns, time [s] and value; what : a dimension, such as "force".

    Raises InputErrors: every mistake of the file, a line each.
    """
    mistakes = Mistakes()
    found = read_history(Path(path), what, Position(str(path)), "", mistakes, {})
    mistakes.stop_if_any()
    assert found is not None
    return found


def read_curve(
    path: Path, asked_at: Position, asked_path: str, mistakes: Mistakes, sources: dict[str, str]
) -> Tabulated | None:
    """A contact law from two columns, indentation [m] and force [N]; None with mistakes noted.

    sources : is given the text of the file under its name.
    """
    columns = _read_columns(path, ("length", "force"), asked_at, asked_path, mistakes, sources)
    if columns is None:
        return None
    try:
        return Tabulated(*columns)  # type: ignore[arg-type]
    except FemstructError as error:
        mistakes.add(Position(str(path), 1, 1), "", got=error.got, expected=error.expected)
        return None


_WORDS: Final = {"time": "time, value", "length": "indentation, force"}


def _read_columns(
    path: Path,
    dimensions: tuple[str, str],
    asked_at: Position,
    asked_path: str,
    mistakes: Mistakes,
    sources: dict[str, str],
) -> tuple[list[float], list[float]] | None:
    """Two columns in SI units; None with mistakes noted.

    A first line of words is a header; a unit in brackets or parentheses after a word, as in ``time [ms], force [kN]``,
    scales its column. Lines that are empty or begin with # are skipped.
    """
    try:
        text = content(path, LARGEST, "a CSV file beside the study").decode("utf-8-sig")
        rows = list(csv.reader(io.StringIO(text)))
    except InputError as error:
        mistakes.add(asked_at, asked_path, got=error.got, expected=error.expected, do=error.do)
        return None
    except (UnicodeDecodeError, csv.Error):
        mistakes.add(asked_at, asked_path, got=f"'{path}', which is no table", expected="a CSV file of text in UTF-8")
        return None
    sources[str(path)] = text
    scales = [1.0, 1.0]
    firsts: list[float] = []
    seconds: list[float] = []
    header = True
    for number, row in enumerate(rows, start=1):
        cells = [cell.strip() for cell in row]
        if not any(cells) or cells[0].startswith("#"):
            continue
        at = Position(str(path), number, 1)
        if len(cells) != 2:
            mistakes.add(
                at,
                "",
                got=f"{len(cells)} columns",
                expected=f"two: {_WORDS[dimensions[0]]}",
                do="separate them by a comma, and write decimals with a point",
            )
            return None
        try:
            pair = [quantity(float(cell), "ratio") for cell in cells]
        except QuantityError:
            mistakes.add(at, "", got=shown_as(", ".join(cells)), expected="finite numbers")
            return None
        except ValueError:
            if not header:
                mistakes.add(at, "", got=shown_as(", ".join(cells)), expected="two numbers")
                return None
            found = _scales(cells, dimensions, at, mistakes)
            if found is None:
                return None
            scales, header = found, False
            continue
        header = False
        firsts.append(pair[0] * scales[0])
        seconds.append(pair[1] * scales[1])
    if len(firsts) < 2:
        mistakes.add(asked_at, asked_path, got=f"{len(firsts)} lines of numbers in '{path}'", expected="two or more")
        return None
    return firsts, seconds


def _scales(cells: list[str], dimensions: tuple[str, str], at: Position, mistakes: Mistakes) -> list[float] | None:
    scales = []
    for cell, dimension in zip(cells, dimensions, strict=True):
        unit = cell.replace("(", "[").replace(")", "]").partition("[")[2].rstrip("] ")
        try:
            scales.append(quantity(f"1 {unit}", dimension) if unit else 1.0)
        except QuantityError as error:
            mistakes.add(at, "", got=shown_as(cell), expected=error.expected, do=error.do)
            return None
    return scales
