"""Tables of frequency responses as files: comma-separated values, NumPy, universal files."""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from femstruct.conventions import DIRECTIONS
from femstruct.errors import InputError
from femstruct.files.atomic import replacing
from femstruct.files.exchange.uff_writing import write_uff
from femstruct.modal.measured.frf_table import FrfTable
from femstruct.modal.measured.measurement import MeasuredFrf, MeasuredPlace, Measurement


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

    positions : of all points by name [m].

    Raises InputError for a force of the structure, for a direction along a normal, and where pyuff is not installed.
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
