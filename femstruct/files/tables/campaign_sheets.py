"""The rows of a sweep or an optimisation as plain tables for a spreadsheet."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isfinite
from typing import Final

from femstruct.files.results_file.swept_file import headed, why_not
from femstruct.files.tables.front_tables import design_table
from femstruct.files.tables.sheets import Cell, Sheet
from femstruct.study.campaign.front import Front
from femstruct.study.campaign.sought import Found
from femstruct.study.campaign.swept import Swept

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
    varied = [headed(path, unit) for path, unit in zip(rows.paths, rows.units, strict=True)]
    numbers = [headed(name, rows.unit_of(name)) for name in names]
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
    heads = [headed(one.path, one.unit) for one in search.designs]
    heads += [headed(one.name, unit) for one, unit in zip(search.goals, found.units, strict=True)]
    heads += [headed(name, found.rows.unit_of(name)) for name in search.limits]
    made: list[tuple[Cell, ...]] = []
    for k in found.members:
        told = design_table(found, k)
        chosen = [one["text"] if one["value"] is None else one["value"] for one in told["chosen"]]
        values = [_number(one) for one in (*found.goals[k], *found.limited[k])]
        ends = "; ".join(f"{one['path']} {one['at']}" for one in told["chosen"] if one["at"])
        notes, codes = "; ".join(told["notes"]), " ".join(told["findings"])
        made.append((k, told["sample"], notes, *chosen, *values, ends, codes, told["run_it"]))
    columns = ("design", "sample", "stands out", *heads, "paths at an end of their range", "findings", "command")
    return Sheet("front", columns, made)


def _number(value: float) -> float | None:
    return float(value) if isfinite(value) else None
