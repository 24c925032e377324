"""What the best design is held against: its case as the file has it, and the baseline, with the same scatter."""

from __future__ import annotations

import numpy as np

from femstruct.campaign.designs import Designs
from femstruct.campaign.journal import Row
from femstruct.errors import InputErrors
from femstruct.language import read_study
from femstruct.study.campaign.sought import Reference, Search
from femstruct.study.study import Plan


def references(search: Search, designs: Designs) -> tuple[Reference, ...]:
    """The case whose numbers are chosen as it is written, then the baseline where that is another."""
    plan = _plan(search)
    case = search.case or plan.baseline
    cases = tuple(dict.fromkeys((case, plan.baseline)))
    if search.goal in [one.path for one in search.designs]:
        none, why = np.full(search.samples, np.nan), f"'{search.goal}' is chosen, and no number of a run"
        return tuple(Reference(name, name == case, np.nan, (np.nan, np.nan), np.nan, none, why) for name in cases)
    own = designs.goals_of(designs.of_design(designs.best))[2]
    found = []
    for name, rows in zip(cases, designs.as_written(cases), strict=True):
        why = _missing(search, rows)
        goal, ends, values = designs.goals_of(rows)
        if why:
            goal, ends, values = np.nan, (np.nan, np.nan), np.full(len(rows), np.nan)
        found.append(Reference(name, name == case, goal, ends, float(values.mean()), own - values, why))
    return tuple(found)


def _plan(search: Search) -> Plan:
    """The study with all its cases, or with its own alone where another cannot be read."""
    try:
        return read_study(search.file, search.overrides)
    except InputErrors:
        return read_study(search.file, search.overrides, only=search.case or None)


def _missing(search: Search, rows: list[Row]) -> str:
    """Why rows have no goal to compare with, "" where they have."""
    if trouble := next((row.trouble for row in rows if row.trouble), ""):
        return trouble
    if severe := dict.fromkeys(code for row in rows for code in row.severe):
        return f"{', '.join(severe)}, which forbids trust"
    if any(search.goal not in row.numbers or not np.isfinite(row.numbers[search.goal].value) for row in rows):
        return f"no {search.goal}"
    return ""
