"""The rows of a campaign as one HDF5 file, and as a table for a spreadsheet.

    /value [case, sample, number]       the numbers, nan where there is none; coordinates case, sample, number
    /unit [number]                      their units; /main [number] : which are asked for first
    /varied [sample, parameter]         what varied, in SI units; /varied_text : as a file writes it
    /varied_unit [parameter]
    /findings, /severe [case, sample]   codes of findings; of those that forbid trust in the row
    /done, /trouble [sample]            whether it was run; why it has no numbers

``xarray.open_dataset("sweep.h5", engine="h5netcdf")`` is a labelled table.
"""

from __future__ import annotations

import csv
import json
from collections.abc import Sequence
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from femstruct.errors import FemstructError, InputError
from femstruct.files.atomic import replacing
from femstruct.files.results_file.datasets import axis, group, put, put_text
from femstruct.files.results_file.seal import refuse_broken_seal, write_sealed
from femstruct.study.campaign.swept import Swept

if TYPE_CHECKING:  # slow to import
    import h5py

FORMAT: Final = "femstruct sweep"
FORMAT_VERSION: Final = 1
SWEEP: Final = "sweep.h5"
TABLE: Final = "sweep.csv"
_BETWEEN: Final = " "  # codes of findings in a text


def write_swept(path: str | Path, rows: Swept) -> None:
    """Write the rows of a campaign to one file that is, at every instant, complete or not there.

    Raises FemstructError when the disk is full or refuses; the file that was there before is then untouched.

    >>> from pathlib import Path
    >>> import tempfile
    >>> import numpy as np
    >>> rows = Swept(
    ...     title="hits",
    ...     paths=("bodies.ball.mass",),
    ...     units=("kg",),
    ...     texts=(("1 kg",),),
    ...     values=[[1.0]],
    ...     method="grid",
    ...     cases=("as given",),
    ...     baseline="as given",
    ...     names=("ball on m peak force",),
    ...     number_units=("N",),
    ...     main=("ball on m peak force",),
    ...     numbers=[[[5.0]]],
    ...     done=np.array([True]),
    ...     severe=(((),),),
    ...     findings=(((),),),
    ...     trouble=("",),
    ... )
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_swept(Path(folder, "sweep.h5"), rows)
    ...     read_swept(folder).of("ball on m peak force").tolist()
    [5.0]
    """
    write_sealed(path, lambda file: write_rows(file, rows))


def read_swept(path: str | Path) -> Swept:
    """The rows of a campaign. path : a sweep.h5, or the folder that it is in.

    Raises InputError for a file that is not there, of another kind, incomplete, or damaged. The example of
    `write_swept` reads one.
    """
    path = Path(path) / SWEEP if Path(path).is_dir() else Path(path)
    if not path.is_file():
        raise InputError(str(path), got="no such file", expected=f"a {SWEEP}, or its folder", do="run the sweep first")
    try:
        refuse_broken_seal(path)
        import h5py

        with h5py.File(path, "r") as file:
            if file.attrs.get("format") != FORMAT:
                raise InputError(str(path), got="an HDF5 file of another kind", expected=f"'{FORMAT}'")
            return _read(file)
    except InputError:
        raise
    except (OSError, KeyError, RuntimeError, ValueError, TypeError, AttributeError, FemstructError) as error:
        expected = "a complete file of this version"
        raise InputError(str(path), got=f"a file that cannot be read ({error})", expected=expected) from error


def write_rows(file: h5py.File, rows: Swept) -> None:
    """Put the rows of a campaign into an open file."""
    file.attrs.update(
        Conventions="CF-1.11", format=FORMAT, format_version=FORMAT_VERSION, title=rows.title, baseline=rows.baseline,
        method=rows.method, limits=json.dumps(dict(rows.limits)), made=rows.made,
    )  # fmt: skip
    n = len(rows.texts)
    axis(file, "sample", np.arange(n), "1", "Number of the sample")
    axis(file, "case", list(rows.cases), "1", "Case of the study")
    axis(file, "number", list(rows.names), "1", "Name of the number")
    axis(file, "parameter", list(rows.paths), "1", "Path that varies")
    put(file, "value", rows.numbers, "see unit", "Numbers of all samples", ("case", "sample", "number"))
    _put_texts(file, "unit", rows.number_units, "Unit of a number", ("number",))
    put(file, "main", np.isin(rows.names, rows.main), "1", "Whether a number is asked for first", ("number",))
    put(file, "varied", rows.values, "see varied_unit", "What varied, in SI units", ("sample", "parameter"))
    _put_texts(file, "varied_text", rows.texts, "What varied, as a file writes it", ("sample", "parameter"))
    _put_texts(file, "varied_unit", rows.units, "Unit of what varied", ("parameter",))
    for name, codes, told in (
        ("findings", rows.findings, "Codes of findings"),
        ("severe", rows.severe, "Codes of findings that forbid trust"),
    ):
        joined = [[_BETWEEN.join(one) for one in case] for case in codes]
        _put_texts(file, name, joined, told, ("case", "sample"))
    put(file, "done", rows.done, "1", "Whether the sample was run", ("sample",))
    _put_texts(file, "trouble", rows.trouble, "Why a sample has no numbers", ("sample",))
    inputs = group(file, "input", "The files of the study, verbatim")
    for name, text in rows.sources.items():
        put_text(inputs, name, text, "A file of the study, verbatim", path=name)
    group(file, "provenance", "Where the numbers come from", **rows.provenance)


def _put_texts(
    file: h5py.File, name: str, texts: Sequence[str] | Sequence[Sequence[str]], told: str, axes: Sequence[str]
) -> None:
    import h5py

    shape = tuple(file[one].shape[0] for one in axes)
    made = file.create_dataset(name, data=np.array(texts, dtype=object).reshape(shape), dtype=h5py.string_dtype())
    made.attrs.update(unit="1", description=told, long_name=told)
    for dimension, one in enumerate(axes):
        made.dims[dimension].attach_scale(file[one])


def _read(file: h5py.File) -> Swept:
    def texts(name: str) -> list[str]:
        found: list[str] = file[name].asstr()[()].tolist()
        return found

    def codes(name: str) -> tuple[tuple[tuple[str, ...], ...], ...]:
        return tuple(tuple(tuple(one.split()) for one in case) for case in texts(name))

    names = texts("number")
    main = [name for name, asked in zip(names, file["main"][()], strict=True) if asked]
    return Swept(
        title=str(file.attrs["title"]),
        paths=tuple(texts("parameter")),
        units=tuple(texts("varied_unit")),
        texts=tuple(map(tuple, texts("varied_text"))),
        values=file["varied"][()],
        method=str(file.attrs["method"]),
        cases=tuple(texts("case")),
        baseline=str(file.attrs["baseline"]),
        names=tuple(names),
        number_units=tuple(texts("unit")),
        main=tuple(main),
        numbers=file["value"][()],
        done=file["done"][()].astype(bool),
        severe=codes("severe"),
        findings=codes("findings"),
        trouble=tuple(texts("trouble")),
        limits=json.loads(file.attrs["limits"]),
        sources={str(one.attrs["path"]): one.asstr()[()] for one in file["input"].values()},
        provenance={key: str(value) for key, value in file["provenance"].attrs.items() if key != "description"},
        made=str(file.attrs.get("made", "")),
    )


def write_table(path: str | Path, rows: Swept, names: Sequence[str] = ()) -> None:
    """A row for every sample and case as comma-separated values. names : of the numbers, the main ones if none.

    Columns are what varied, in SI units or as a file writes it, the numbers, findings that forbid trust, and why a
    sample has no numbers. A cell is empty where there is no number.
    """
    names = names or rows.main
    columns = [rows.of(name, case) for case in rows.cases for name in names]
    with replacing(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        units = [headed(path, unit) for path, unit in zip(rows.paths, rows.units, strict=True)]
        numbers = [headed(name, rows.unit_of(name)) for name in names]
        writer.writerow(["sample", "case", *units, *numbers, "severe findings", "trouble"])
        for i, texts in enumerate(rows.texts):
            varied = [_cell(value) or text for value, text in zip(rows.values[i], texts, strict=True)]
            for c, case in enumerate(rows.cases):
                own = [_cell(column[i]) for column in columns[c * len(names) : (c + 1) * len(names)]]
                writer.writerow([i, case, *varied, *own, " ".join(rows.severe[c][i]), why_not(rows, i)])


def why_not(rows: Swept, i: int) -> str:
    """Why a sample has no numbers, "" where it has."""
    return rows.trouble[i] or ("" if rows.done[i] else "not run")


def headed(name: str, unit: str) -> str:
    """The head of a column: a name with its unit."""
    return f"{name} [{unit}]" if unit else name


def _cell(value: float) -> str:
    return repr(float(value)) if isfinite(value) else ""
