"""The table of the largest stresses of parts a person reads in the terminal."""

from __future__ import annotations

from femstruct.study.result import StudyResult
from femstruct.view.tables.grid import Grid


def stresses(result: StudyResult) -> Grid:
    """A row for every part whose stress is recorded and every case: how large, where, and when."""
    grid = Grid("largest stresses of von Mises", ("", "case", "stress [MPa]", "where", "at [ms]"), keys=2)
    for case_name, case in result.cases.items():
        for name, channel in case.channels.items():
            if (found := channel.stressed) is not None:
                worst = found.worst
                amount, time = f"{1e-6 * found.largest[worst]:.4g}", f"{1e3 * found.time[worst]:.3f}"
                grid.add(name.rpartition(" ")[0], case_name, amount, found.where, time)
    return grid
