"""The table of arrays of bodies a person reads in the terminal: each with its energy at the end, and their sum."""

from __future__ import annotations

from femstruct.files.tables.array_tables import TERMS, array_tables
from femstruct.study.result import StudyResult
from femstruct.view.tables.grid import Grid
from femstruct.view.tables.scales import digits


def arrays(result: StudyResult) -> Grid:
    """A row for every body of an array, and one for all of them."""
    columns = ("", "case", "peak force [N]", "kinetic [mJ]", "stored in its joints [mJ]", "dissipated there [mJ]")
    grid = Grid("arrays of bodies, at the end", columns, keys=2)
    for case_name, case in result.cases.items():
        for array, table in array_tables(case.response).items() if case.response is not None else ():
            for name, row in table["end"].items():
                peak = table["peak_force_n"].get(name)
                grid.add(
                    f"{array}, all" if peak is None else name,
                    case_name,
                    "" if peak is None else digits(peak),
                    *(f"{1e3 * row[term]:.4g}" for term in TERMS),
                )
    return grid
