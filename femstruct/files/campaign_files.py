"""The rows of a campaign and what an optimisation found, as one HDF5 file each."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator, Sequence
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from femstruct.errors import FemstructError, InputError
from femstruct.files.campaign_tables import design_table
from femstruct.files.datasets import axis, group, put, put_text, refuse_broken_seal, remember_arrays, write_sealed
from femstruct.files.sheets import Cell, Sheet
from femstruct.files.stored_values import NOUNS, read_whole, write_whole
from femstruct.files.writing import replacing
from femstruct.study.campaigns import Swept
from femstruct.study.optima import Found, Front

if TYPE_CHECKING:
    import h5py


# ----------------------------------------------------------------------------------------------------------------------
# The rows of a campaign as one HDF5 file, and as a table for a spreadsheet.
#
#     /value [case, sample, number]       the numbers, nan where there is none; coordinates case, sample, number
#     /unit [number]                      their units; /main [number] : which are asked for first
#     /varied [sample, parameter]         what varied, in SI units; /varied_text : as a file writes it
#     /varied_unit [parameter]
#     /findings, /severe [case, sample]   codes of findings; of those that forbid trust in the row
#     /done, /trouble [sample]            whether it was run; why it has no numbers
#
# ``xarray.open_dataset("sweep.h5", engine="h5netcdf")`` is a labelled table.
# ----------------------------------------------------------------------------------------------------------------------

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
    """The rows of a campaign.

    Parameters
    ----------
    path : str | Path
        A sweep.h5, or the folder that it is in.

    Raises
    ------
    InputError
        For a file that is not there, of another kind, incomplete, or damaged. The example of `write_swept` reads one.
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
    for name, codes, description in (
        ("findings", rows.findings, "Codes of findings"),
        ("severe", rows.severe, "Codes of findings that forbid trust"),
    ):
        joined = [[_BETWEEN.join(one) for one in case] for case in codes]
        _put_texts(file, name, joined, description, ("case", "sample"))
    put(file, "done", rows.done, "1", "Whether the sample was run", ("sample",))
    _put_texts(file, "trouble", rows.trouble, "Why a sample has no numbers", ("sample",))
    inputs = group(file, "input", "The files of the study, verbatim")
    for name, text in rows.sources.items():
        put_text(inputs, name, text, "A file of the study, verbatim", path=name)
    group(file, "provenance", "Where the numbers come from", **rows.provenance)


def _put_texts(
    file: h5py.File, name: str, texts: Sequence[str] | Sequence[Sequence[str]], description: str, axes: Sequence[str]
) -> None:
    import h5py

    shape = tuple(file[one].shape[0] for one in axes)
    made = file.create_dataset(name, data=np.array(texts, dtype=object).reshape(shape), dtype=h5py.string_dtype())
    made.attrs.update(unit="1", description=description, long_name=description)
    for dimension, one in enumerate(axes):
        made.dims[dimension].attach_scale(file[one])


def _read(file: h5py.File) -> Swept:
    def texts(name: str) -> list[str]:
        found: list[str] = file[name].asstr()[()].tolist()
        return found

    def codes(name: str) -> tuple[tuple[tuple[str, ...], ...], ...]:
        return tuple(tuple(tuple(one.split()) for one in case) for case in texts(name))

    names = texts("number")
    main = [name for name, is_main in zip(names, file["main"][()], strict=True) if is_main]
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
    """A row for every sample and case as comma-separated values.

    Columns are what varied, in SI units or as a file writes it, the numbers, findings that forbid trust, and why a
    sample has no numbers. A cell is empty where there is no number.

    Parameters
    ----------
    names : Sequence[str]
        Of the numbers, the main ones if none.
    """
    names = names or rows.main
    columns = [rows.of(name, case) for case in rows.cases for name in names]
    with replacing(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        units = [column_head(path, unit) for path, unit in zip(rows.paths, rows.units, strict=True)]
        numbers = [column_head(name, rows.unit_of(name)) for name in names]
        writer.writerow(["sample", "case", *units, *numbers, "severe findings", "trouble"])
        for i, texts in enumerate(rows.texts):
            varied = [_cell(value) or text for value, text in zip(rows.values[i], texts, strict=True)]
            for c, case in enumerate(rows.cases):
                own = [_cell(column[i]) for column in columns[c * len(names) : (c + 1) * len(names)]]
                writer.writerow([i, case, *varied, *own, " ".join(rows.severe[c][i]), why_not(rows, i)])


def why_not(rows: Swept, i: int) -> str:
    """Why a sample has no numbers, "" where it has."""
    return rows.trouble[i] or ("" if rows.done[i] else "not run")


def column_head(name: str, unit: str) -> str:
    """The head of a column: a name with its unit."""
    return f"{name} [{unit}]" if unit else name


def _cell(value: float) -> str:
    return repr(float(value)) if isfinite(value) else ""


# ----------------------------------------------------------------------------------------------------------------------
# What an optimisation found in one HDF5 file with the rows of all designs, and a front as a table for a spreadsheet.
#
# The file is that of a sweep (`write_swept`) and, of a front,
#
#     /front/goal [design, goal]          the goals of all designs, nan where they are not to be trusted
#     /front/member [design]              whether a design is on the front; /front/held : holds all limits
#     /front/unit [goal]
#
# with the answer itself as nouns. `read_found` reads it back.
# ----------------------------------------------------------------------------------------------------------------------

OPTIMUM: Final = "optimise.h5"


def write_found(path: str | Path, found: Found | Front) -> None:
    """Write the answer of an optimisation to one file that is, at every instant, complete or not there.

    Raises FemstructError when the disk is full or refuses; the file that was there before is then untouched.

    A design that was tried once:

    >>> from pathlib import Path
    >>> import tempfile
    >>> from femstruct.study.optima import Chosen, Search
    >>> from femstruct.study.campaigns import Swept
    >>> from femstruct.study.campaigns import Scattered
    >>> rows = Swept(
    ...     title="hits",
    ...     paths=("bodies.ball.mass",),
    ...     units=("kg",),
    ...     texts=(("1 kg",),),
    ...     values=[[1.0]],
    ...     method="grid",
    ...     cases=("as given",),
    ...     baseline="as given",
    ...     names=("hit peak force",),
    ...     number_units=("N",),
    ...     main=("hit peak force",),
    ...     numbers=[[[5.0]]],
    ...     done=np.array([True]),
    ...     severe=(((),),),
    ...     findings=(((),),),
    ...     trouble=("",),
    ... )
    >>> mass = Scattered("bodies.ball.mass", "uniform", 1.0, 2.0, "kg")
    >>> found = Found(
    ...     search=Search("hit.study.yaml", "hit peak force", (mass,)),
    ...     unit="N",
    ...     goal=5.0,
    ...     ends=(5.0, 5.0),
    ...     chosen=(Chosen("bodies.ball.mass", "1 kg", 1.0, "kg", "lower", 0.1),),
    ...     limits={},
    ...     feasible=True,
    ...     best=0,
    ...     runs=1,
    ...     designs=1,
    ...     left_out=0,
    ...     goals=np.array([5.0]),
    ...     held=np.array([True]),
    ...     history=((1, 5.0),),
    ...     spent=True,
    ...     interrupted=False,
    ...     rows=rows,
    ... )
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_found(Path(folder, "optimise.h5"), found)
    ...     read_found(folder).goal
    5.0
    """

    def write(file: h5py.File) -> None:
        with remember_arrays() as written:
            write_rows(file, found.rows)
            if isinstance(found, Front):
                _write_front(file, found)
            write_whole(file, found, written)

    write_sealed(path, write)


def read_found(path: str | Path) -> Found | Front:
    """The answer of an optimisation.

    Parameters
    ----------
    path : str | Path
        An optimise.h5, or the folder that it is in.

    Raises
    ------
    InputError
        For a file that is not there, of another kind, incomplete, or damaged. The example of `write_found` reads one.
    """
    path = Path(path) / OPTIMUM if Path(path).is_dir() else Path(path)
    if not path.is_file():
        raise InputError(
            str(path), got="no such file", expected=f"an {OPTIMUM}, or its folder", do="run optimise first"
        )
    try:
        refuse_broken_seal(path)
        import h5py

        with h5py.File(path, "r") as file:
            found = read_whole(file) if NOUNS in file else None
    except InputError:
        raise
    except (OSError, KeyError, RuntimeError, ValueError, TypeError, AttributeError, FemstructError) as error:
        expected = "a complete file of this version"
        raise InputError(str(path), got=f"a file that cannot be read ({error})", expected=expected) from error
    if not isinstance(found, Found | Front):
        raise InputError(str(path), got="an HDF5 file of another kind", expected="the answer of an optimisation")
    return found


def write_front_table(path: str | Path, found: Front) -> None:
    """A row for every design of the front as comma-separated values: its number, what it stands out by, what was
    chosen, goals, limited numbers, paths at ends of their ranges, findings, and the command that runs it."""
    search = found.search
    chosen = [column_head(one.path, one.unit) for one in search.designs]
    goals = [column_head(one.name, unit) for one, unit in zip(search.goals, found.units, strict=True)]
    limited = [column_head(name, found.rows.unit_of(name)) for name in search.limits]
    with replacing(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        ended = "paths at an end of their range"
        writer.writerow(["design", "sample", "stands out", *chosen, *goals, *limited, ended, "findings", "command"])
        for k in found.members:
            design = design_table(found, k)
            own = [one["text"] if one["value"] is None else repr(one["value"]) for one in design["chosen"]]
            values = [repr(float(one)) if isfinite(one) else "" for one in (*found.goals[k], *found.limited[k])]
            ends = [f"{one['path']} {one['at']}" for one in design["chosen"] if one["at"]]
            notes, codes = "; ".join(design["notes"]), " ".join(design["findings"])
            writer.writerow([k, design["sample"], notes, *own, *values, "; ".join(ends), codes, design["run_it"]])


def _write_front(file: h5py.File, found: Front) -> None:
    inside = group(file, "front", "Goals of all designs, and which of them no other one beats")
    axis(inside, "design", np.arange(found.designs), "1", "Number of the design")
    axis(inside, "goal_name", [one.name for one in found.search.goals], "1", "What is to be small or large")
    put(inside, "goal", found.goals, "see unit", "Goals of all designs", ("design", "goal_name"))
    member = np.isin(np.arange(found.designs), found.members)
    put(inside, "member", member, "1", "Whether no other design beats it", ("design",))
    put(inside, "held", found.held, "1", "Whether it holds all limits and is to be trusted", ("design",))
    put(inside, "unit", list(found.units), "1", "Unit of a goal", ("goal_name",))


# ----------------------------------------------------------------------------------------------------------------------
# The rows of a sweep or an optimisation as plain tables for a spreadsheet.
# ----------------------------------------------------------------------------------------------------------------------

SAMPLES: Final = "samples"


def campaign_sheets(answer: Swept | Found | Front) -> tuple[Sheet, ...]:
    """A row for every sample and case with all numbers, those that are asked for first ahead; of a front its designs
    first.

    Columns have their units in their heads: "bodies.ball.mass [kg]".
    """
    if isinstance(answer, Swept):
        return (_samples(answer, answer.main),)
    search, rows = answer.search, answer.rows
    first = [name for name in (*(goal.name for goal in search.goals), *search.limits) if name in rows.names]
    return (*((_front(answer),) if isinstance(answer, Front) else ()), _samples(rows, first))


def _samples(rows: Swept, first: Sequence[str]) -> Sheet:
    names = list(dict.fromkeys((*first, *rows.names)))
    varied = [column_head(path, unit) for path, unit in zip(rows.paths, rows.units, strict=True)]
    numbers = [column_head(name, rows.unit_of(name)) for name in names]
    columns = ("sample", "case", *varied, *numbers, "severe findings", "trouble")
    return Sheet(SAMPLES, columns, list(_rows(rows, names)))


def _rows(rows: Swept, names: Sequence[str]) -> Iterator[tuple[Cell, ...]]:
    columns = {case: [rows.of(name, case) for name in names] for case in rows.cases}
    for i, texts in enumerate(rows.texts):
        varied = [
            text if not isfinite(value) else float(value) for value, text in zip(rows.values[i], texts, strict=True)
        ]
        for c, case in enumerate(rows.cases):
            own = [_number(column[i]) for column in columns[case]]
            yield (i, case, *varied, *own, " ".join(rows.severe[c][i]), why_not(rows, i))


def _front(found: Front) -> Sheet:
    """A row for every design of the front."""
    search = found.search
    heads = [column_head(one.path, one.unit) for one in search.designs]
    heads += [column_head(one.name, unit) for one, unit in zip(search.goals, found.units, strict=True)]
    heads += [column_head(name, found.rows.unit_of(name)) for name in search.limits]
    made: list[tuple[Cell, ...]] = []
    for k in found.members:
        design = design_table(found, k)
        chosen = [one["text"] if one["value"] is None else one["value"] for one in design["chosen"]]
        values = [_number(one) for one in (*found.goals[k], *found.limited[k])]
        ends = "; ".join(f"{one['path']} {one['at']}" for one in design["chosen"] if one["at"])
        notes, codes = "; ".join(design["notes"]), " ".join(design["findings"])
        made.append((k, design["sample"], notes, *chosen, *values, ends, codes, design["run_it"]))
    columns = ("design", "sample", "stands out", *heads, "paths at an end of their range", "findings", "command")
    return Sheet("front", columns, made)


def _number(value: float) -> float | None:
    return float(value) if isfinite(value) else None
