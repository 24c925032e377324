"""Tables of frequency responses as files: comma-separated values, NumPy, universal files; the first can be read
back.
"""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final, NamedTuple, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from femstruct.arrays import Floats
from femstruct.conventions import DIRECTIONS
from femstruct.errors import InputError, quote_value
from femstruct.files.text_tables import TextRow, TextTable, read_grid, wrong_in
from femstruct.files.uff import write_uff
from femstruct.files.writing import replacing
from femstruct.modal.frf import FrfKind, frf_unit
from femstruct.modal.measured import FrfTable, MeasuredFrf, MeasuredPlace, Measurement


def write_frf_csv(table: FrfTable, path: str | Path) -> Path:
    """Write a column of frequencies and two columns, real and imaginary, of every response to every drive."""
    pairs = [(i, j) for j in range(len(table.drives)) for i in range(len(table.responses))]
    head = [f"{table.name(i, j)} [{table.unit(i, j)}] {part}" for i, j in pairs for part in ("real", "imag")]
    columns = [part for i, j in pairs for part in (table.values[i, j].real, table.values[i, j].imag)]
    rows = np.column_stack([table.frequency_hz, *columns]).tolist()
    with replacing(path) as temporary, temporary.open("w", encoding="utf-8-sig", newline="") as file:
        csv.writer(file).writerows([["frequency_hz", *head], *rows])
    return Path(path)


def write_frf_npz(table: FrfTable, path: str | Path, about: Mapping[str, Any]) -> Path:
    """Write frequency_hz [nf], values [nr, nd, nf], the names and kinds of drives and responses, units [nr, nd], and
    `about` as JSON."""
    units = [[table.unit(i, j) for j in range(len(table.drives))] for i in range(len(table.responses))]
    with replacing(path) as temporary:
        np.savez_compressed(
            temporary,
            frequency_hz=table.frequency_hz,
            values=table.values,
            drives=np.array(table.drives, dtype=np.str_),
            responses=np.array(table.responses, dtype=np.str_),
            kinds=np.array(table.kinds, dtype=np.str_),
            units=np.array(units, dtype=np.str_),
            about=np.array(json.dumps({"title": table.title, "axes of values": "response, drive, frequency", **about})),
        )
    return Path(path)


def write_frf_uff(table: FrfTable, positions: Mapping[str, ArrayLike], path: str | Path) -> Path:
    """Write a universal file: every point as a node, numbered from 1, every response as a function (data set 58).

    Parameters
    ----------
    positions : Mapping[str, ArrayLike]
        Of all points by name [m].

    Raises
    ------
    InputError
        For a force of the structure, for a direction along a normal, and where pyuff is not installed.
    """
    names = dict.fromkeys(name.rpartition(".")[0] for name in (*table.drives, *table.responses))
    numbers = {name: number for number, name in enumerate(names, 1)}

    def place(text: str) -> MeasuredPlace:
        name, _, direction = text.rpartition(".")
        if direction not in DIRECTIONS or name not in positions:
            expected = f"a point with one of {', '.join(DIRECTIONS)}"
            raise InputError("universal files", got=f"'{text}'", expected=expected, do="use csv or npz for others")
        return MeasuredPlace(numbers[name], direction, name)

    def one(i: int, j: int) -> MeasuredFrf:
        drive, response, unit = place(table.drives[j]), place(table.responses[i]), table.unit(i, j)
        return MeasuredFrf(drive, response, table.kinds[i], table.frequency_hz, table.values[i, j], unit)

    frfs = tuple(one(i, j) for j in range(len(table.drives)) for i in range(len(table.responses)))
    points = np.array([positions[name] for name in names], dtype=np.float64)
    return write_uff(Measurement(table.title, np.arange(1, len(names) + 1), points, frfs=frfs), path)


_HEAD: Final = re.compile(
    r"(?P<kind>\w+) (?P<response>.+?) / (?P<drive>.+?) \[(?P<unit>.*)\] (?P<part>real|imag|scatter)"
)
_HEADS: Final = "'frequency_hz' and pairs of columns, such as 'accelerance Q.z / P.z [m/(N s^2)] real' and '.. imag'"


class FrfColumns(NamedTuple):
    """A frequency response of a table: places as texts, frequencies [n] [Hz], values [n] in SI units, and the standard
    deviation [n] of their real and imaginary parts where there is a column of it."""

    drive: str
    response: str
    kind: FrfKind
    frequency_hz: Floats
    values: NDArray[np.complex128]
    scatter: Floats | None


def read_frf_csv(path: Path) -> list[FrfColumns]:
    """Frequency responses of a table as `write_frf_csv` makes it; a third column of one, "scatter", may stand beside
    it.

    Raises InputError for a file that cannot be read, InputErrors with the line for what is wrong in it.
    """
    grid = read_grid(path, {}, "a table of frequency responses")
    if len(grid.rows) < 2:
        raise wrong_in(path, 1, InputError("", got=f"{len(grid.rows)} lines", expected=_HEADS))
    head, rows = grid.rows[0], grid.rows[1:]
    places: dict[tuple[str, str, str], dict[str, int]] = {}
    for at, cell in enumerate(head.cells[1:], 1):
        found = _HEAD.fullmatch(cell)
        if found is None or found["kind"] not in get_args(FrfKind):
            raise grid.wrong(head, quote_value(cell), _HEADS)
        kind = next(one for one in get_args(FrfKind) if one == found["kind"])
        unit = frf_unit(kind, *(found[end].rpartition(".")[2] for end in ("drive", "response")))
        if found["unit"] != unit:
            raise grid.wrong(head, f"a {kind} in '{found['unit']}'", f"one in {unit}")
        parts = places.setdefault((found["drive"], found["response"], kind), {})
        if found["part"] in parts:
            raise grid.wrong(head, f"two columns {quote_value(cell)}", "one of each name")
        parts[found["part"]] = at
    values = np.array([_numbers(grid, row, len(head.cells)) for row in rows])
    if not (np.diff(values[:, 0]) > 0.0).all():
        line = int(np.flatnonzero(~(np.diff(values[:, 0]) > 0.0))[0]) + 1
        raise grid.wrong(rows[line], f"{values[line, 0]:g} Hz", f"a frequency above {values[line - 1, 0]:g} Hz")
    made = []
    for (drive, response, kind), parts in places.items():
        if not {"real", "imag"} <= parts.keys():
            raise grid.wrong(head, f"'{kind} {response} / {drive}' without its real or imag column", _HEADS)
        answer = np.asarray(values[:, parts["real"]] + 1j * values[:, parts["imag"]], dtype=np.complex128)
        scatter = values[:, parts["scatter"]] if "scatter" in parts else None
        if scatter is not None and not (scatter > 0.0).all():
            row = rows[int(np.flatnonzero(~(scatter > 0.0))[0])]
            raise grid.wrong(row, "a scatter of 0 or less", "one above 0")
        made.append(FrfColumns(drive, response, kind, values[:, 0], answer, scatter))  # type: ignore[arg-type]
    return made


def _numbers(grid: TextTable, row: TextRow, count: int) -> list[float]:
    found = [one for cell in row.cells if (one := grid.number(row, cell)) is not None]
    if len(found) != count or len(row.cells) != count:
        raise grid.wrong(row, f"{len(found)} numbers", f"{count}, one below each head")
    return found
