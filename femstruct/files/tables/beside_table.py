"""Measured beside computed numbers as one table of comma-separated values."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Final

import numpy as np

from femstruct.files.atomic import replacing
from femstruct.study.matched import Beside

HEAD: Final = (
    "kind", "data", "along", "along_unit", "unit", "measured", "measured_imag", "computed", "computed_imag", "scatter",
    "note",
)  # fmt: skip
ALONG: Final = {"history": "s", "modes": "", "frf": "Hz", "levels": "Hz"}


def write_beside(beside: Sequence[Beside], path: str | Path) -> Path:
    """Write a line for every measured number; imaginary parts are empty of what is real."""
    with replacing(path) as temporary, temporary.open("w", encoding="utf-8-sig", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(HEAD)
        for one in beside:
            writer.writerows(_rows(one))
    return Path(path)


def _rows(one: Beside) -> Iterable[tuple[object, ...]]:
    count, blank = len(one.along), [""] * len(one.along)
    parts = [one.measured, one.computed]
    columns = [
        column
        for values in parts
        for column in (np.real(values).tolist(), np.imag(values).tolist() if np.iscomplexobj(values) else blank)
    ]
    same = ([text] * count for text in (one.kind, one.name, ALONG[one.kind], one.unit))
    kind, name, along_unit, unit = same
    return zip(
        kind,
        name,
        one.along.tolist(),
        along_unit,
        unit,
        *columns,
        one.scatter.tolist(),
        one.notes or blank,
        strict=True,
    )
