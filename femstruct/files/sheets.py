"""Results as plain tables for a spreadsheet: one file of comma-separated values a table, or one workbook."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np

from femstruct.errors import InputError
from femstruct.files.described import describe
from femstruct.files.study_tables import Table, summary
from femstruct.files.writing import replacing, short
from femstruct.reported import holdings
from femstruct.study.asked import Beside
from femstruct.study.results import StudyResult

# ----------------------------------------------------------------------------------------------------------------------
# Measured beside computed numbers as one table of comma-separated values.
# ----------------------------------------------------------------------------------------------------------------------

HEAD: Final = (
    "kind", "data", "along", "along_unit", "unit", "measured", "measured_imag", "computed", "computed_imag", "scatter",
    "note",
)  # fmt: skip
ALONG: Final = {"history": "s", "modes": "", "frf": "Hz", "levels": "Hz"}


def write_comparison(beside: Sequence[Beside], path: str | Path) -> Path:
    """Write a line for every measured number; imaginary parts are empty of what is real."""
    with replacing(path) as temporary, temporary.open("w", encoding="utf-8-sig", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(HEAD)
        for one in beside:
            writer.writerows(_beside_rows(one))
    return Path(path)


def _beside_rows(one: Beside) -> Iterable[tuple[object, ...]]:
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


# ----------------------------------------------------------------------------------------------------------------------
# Results as plain tables for a spreadsheet.
# ----------------------------------------------------------------------------------------------------------------------

Cell = str | float | int | bool | None
_Row = tuple[tuple[str, ...], tuple[str, ...], Table]  # titles, names, numbers
BANDS: Final[tuple[tuple[str, ...], ...]] = (  # sheet, table of the summary, what of it
    ("third octaves", "levels", "bands_db"),
    ("third octaves total", "total_levels", "bands_db"),
    ("octaves", "levels", "octaves_db"),
    ("exposures", "levels", "exposure_db"),
    ("rated bands", "rated", "bands_db", "bands_from", "mean_db", "low_db", "high_db"),
    ("sound energy bands", "sound_energy", "bands_db"),
)
SYMBOLS: Final = {  # of what is in a column, by table and key; of rated bands each room's own
    **{(table, key): "L_Fmax" for table in ("levels", "total_levels") for key in ("bands_db", "octaves_db")},
    ("levels", "exposure_db"): "L_E",
}
ROWS: Final = ("limits", "peaks", "contacts", "bodies", "blows", "sound_energy")  # of the summary, a row for every name
LONGEST: Final = 31  # characters of a sheet's name


class Sheet(NamedTuple):
    """A table: its name, its columns, its rows; a cell is None where a number does not exist."""

    name: str
    columns: tuple[str, ...]
    rows: list[tuple[Cell, ...]]


def sheets(result: StudyResult) -> tuple[Sheet, ...]:
    """All tables of a study that have rows: third octaves and ratings first, as columns and rows of all cases.

    Columns are named as in JSON, with their units: "peak_force_n"; levels by band with their symbol:
    "bands_db (L_Fmax)".
    """
    table = summary(result)
    cases: Mapping[str, Table] = table["cases"]
    numbers = [
        ((case, room, symbol), one)
        for case, own in cases.items()
        for room, rated in own["rated"].items()
        for symbol, one in rated["numbers"].items()
    ]
    thirds, *others = (_by_band(cases, *which) for which in BANDS)
    changes = [((case, name), one) for case, own in table["comparison"].items() for name, one in own["peaks"].items()]
    findings = [((), one | {"cases": ", ".join(one["cases"])}) for one in table["findings"]]
    made = (
        thirds,
        _rows("ratings", ("case", "room", "number"), numbers),
        *others,
        *(_rows(name.replace("_", " "), ("case", "name"), _named(cases, name)) for name in ROWS),
        *_held_sheets(result),
        _rows("changes of peaks", ("case", "name"), changes),
        _rows("findings", (), findings),
    )
    return tuple(sheet for sheet in made if sheet.rows)


def _named(cases: Mapping[str, Table], table: str) -> list[tuple[tuple[str, ...], Table]]:
    return [((case, name), one) for case, own in cases.items() for name, one in own[table].items()]


def _held_sheets(result: StudyResult) -> Iterator[Sheet]:
    """A sheet for all that cases hold by name, and for what that holds."""
    found = [row for name, case in result.cases.items() for row in _held_rows(case, (name,))]
    for titles in dict.fromkeys(titles for titles, _, _ in found):
        heads = ("case", "name") if len(titles) == 1 else ("case", *titles)
        rows = [(keys, table) for of, keys, table in found if of == titles]
        yield _rows(" ".join(titles), heads[: len(rows[0][0])], rows)


def _held_rows(noun: Any, keys: tuple[str, ...], within: tuple[str, ...] = ()) -> Iterator[_Row]:
    """Titles, names and numbers of the nouns that one holds, with those that these hold."""
    for key, _, value in holdings(noun):
        titles = (*within, key.replace("_", " "))
        named = {(*keys, one): value[one] for one in value} if isinstance(value, Mapping) else {keys: value}
        for own, one in named.items():
            if one is not None:
                yield titles, own, describe(one)
                yield from _held_rows(one, own, titles)


def _by_band(cases: Mapping[str, Table], name: str, table: str, *quantities: str) -> Sheet:
    """A row for every band of any case, columns for every case and place."""
    named = _named(cases, table)
    columns = {
        f"{case}: {place} {what}{_symbol(table, what, one)}": one[what]
        for (case, place), one in named
        for what in quantities
    }
    bands = sorted({band for values in columns.values() for band in values}, key=float)
    rows: list[tuple[Cell, ...]] = [(float(band), *(values.get(band) for values in columns.values())) for band in bands]
    return Sheet(name, ("band_hz", *columns), rows)


def _symbol(table: str, key: str, of: Table) -> str:
    """The symbol of a level, in brackets after the key: " (L_Fmax)"; "" for what is no level of a band."""
    symbol = SYMBOLS.get((table, key)) or (of["band_quantity"] if (table, key) == ("rated", "bands_db") else "")
    return f" ({symbol})" if symbol else ""


def _rows(name: str, keys: tuple[str, ...], found: Sequence[tuple[tuple[str, ...], Table]]) -> Sheet:
    """A row for every table, or where it has lists one for each of their places; tables within tables are left out."""
    flat = [(named, row) for named, one in found for row in _flat(one)]
    columns = list(dict.fromkeys(column for _, row in flat for column in row))
    return Sheet(name, (*keys, *columns), [(*named, *(row.get(column) for column in columns)) for named, row in flat])


def _flat(table: Table) -> Iterator[dict[str, Cell]]:
    plain = {name: value for name, value in table.items() if not isinstance(value, Mapping)}
    listed = {name: value for name, value in plain.items() if isinstance(value, list)}
    for place in range(max(map(len, listed.values()), default=1)):
        yield {name: value[place] if name in listed else value for name, value in plain.items()}


def write_csv(tables: Sequence[Sheet], folder: Path, name: str) -> list[Path]:
    """A file NAME.TABLE.csv for every table, that spreadsheets know for UTF-8 by its mark; returns the files."""
    paths = [folder / f"{short(name)}.{sheet.name.replace(' ', '_')}.csv" for sheet in tables]
    for path, sheet in zip(paths, tables, strict=True):
        with replacing(path) as temporary, temporary.open("w", encoding="utf-8-sig", newline="") as file:
            csv.writer(file).writerows([sheet.columns, *sheet.rows])
    return paths


def write_workbook(tables: Sequence[Sheet], folder: Path, name: str) -> list[Path]:
    """One workbook NAME.xlsx with a sheet for every table; returns the file.

    Raises InputError where the package that writes it is not installed.
    """
    try:
        import xlsxwriter
    except ImportError:
        raise InputError(
            "--to xlsx",
            got="no package xlsxwriter",
            expected="it installed",
            do="pip install xlsxwriter, or use --to csv",
        ) from None
    path = folder / f"{short(name)}.xlsx"
    with replacing(path) as temporary:
        book: Any = xlsxwriter.Workbook(temporary, {"strings_to_formulas": False, "strings_to_urls": False})
        head = book.add_format({"bold": True, "text_wrap": True})
        for sheet in tables:
            page = book.add_worksheet(sheet.name[:LONGEST])
            page.freeze_panes(1, 1)
            for number, row in enumerate([sheet.columns, *sheet.rows]):
                page.write_row(number, 0, row, None if number else head)
            page.autofit()
        book.close()
    return [path]
