"""The table of arrays of bodies a person reads in the terminal: each with its energy at the end, and their sum."""

from __future__ import annotations

from femstruct.files.tables.array_tables import TERMS, array_tables
from femstruct.study.result import StudyResult
from femstruct.view.tables.grid import Grid
from femstruct.view.tables.scales import digits, scaled


def arrays(result: StudyResult) -> Grid:
    """A row for every body of an array, and one for all of them."""
    found = {
        name: array_tables(case.response) if case.response is not None else {} for name, case in result.cases.items()
    }
    ends = [row for tables in found.values() for table in tables.values() for row in table["end"].values()]
    joules = [scaled("J", max((abs(row[term]) for row in ends), default=0.0)) for term in TERMS]  # each column its own
    words = ("kinetic", "stored in its joints", "dissipated there")
    told = (f"{word} [{unit}]" for word, (_, unit) in zip(words, joules, strict=True))
    grid = Grid("arrays of bodies, at the end", ("", "case", "peak force [N]", *told), keys=2)
    for case_name, tables in found.items():
        for array, table in tables.items():
            for name, row in table["end"].items():
                peak = table["peak_force_n"].get(name)
                grid.add(
                    f"{array}, all" if peak is None else name,
                    case_name,
                    "" if peak is None else digits(peak),
                    *(f"{joule * row[term]:.4g}" for term, (joule, _) in zip(TERMS, joules, strict=True)),
                )
    return grid
