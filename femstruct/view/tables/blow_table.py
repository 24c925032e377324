"""The table of blows a person reads in the terminal."""

from __future__ import annotations

from femstruct.files.tables.study_tables import growth
from femstruct.study.result import StudyResult
from femstruct.view.tables.grid import Grid
from femstruct.view.tables.scales import digits, scaled

SHOWN_BLOWS = 5  # at each end of a row of blows


def blows(result: StudyResult) -> Grid:
    """Blow by blow; of a long row the first and the last, all are in summary.json."""
    every = [blow for case in result.cases.values() if case.response is not None for blow in case.response.blows]
    joule, unit = scaled("J", max((blow.largest_energy for blow in every), default=0.0))
    grid = Grid(
        "blows",
        (
            "",
            "case",
            "blow",
            "t [ms]",
            "peak force [N]",
            "closings",
            f"structure at most [{unit}]",
            "at rest after [ms]",
        ),
        keys=3,
    )
    for case_name, case in result.cases.items():
        struck = case.response.blows if case.response is not None else ()
        for body in dict.fromkeys(blow.body for blow in struck):
            mine = [blow for blow in struck if blow.body == body]
            for blow in mine if len(mine) <= 2 * SHOWN_BLOWS else (*mine[:SHOWN_BLOWS], *mine[-SHOWN_BLOWS:]):
                grown = growth((mine[0], blow))
                change = f" ({100.0 * (grown - 1.0):+.1f} %)" if blow.number > 1 and grown is not None else ""
                rest = "" if not blow.seen else f"not in {1e3 * blow.interval:.4g}"
                rest = rest if blow.rest_after is None else f"{1e3 * blow.rest_after:.4g}"
                none = not case.basis.omega.size  # no structure that could take up energy, or come to rest
                grid.add(
                    body,
                    case_name,
                    f"{blow.number} of {len(mine)}",
                    f"{1e3 * blow.t:.3f}",
                    digits(blow.peak_force),
                    str(blow.closings),
                    "no structure" if none else f"{joule * blow.largest_energy:.4g}{change}",
                    "" if none else rest,
                )
    return grid
