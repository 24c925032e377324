"""A front of designs as a plain table, ready for JSON."""

from __future__ import annotations

from typing import Any

from femstruct.files.tables.json_numbers import number
from femstruct.files.tables.optimum_tables import command_of
from femstruct.study.campaign.front import Front

Table = dict[str, Any]


def front_table(found: Front) -> Table:
    """All designs of the front, what stands out among them, and how they were found."""
    search, s = found.search, found.search.samples
    return {
        "title": search.title,
        "case": search.case,
        "goals": [
            {"name": one.name, "sense": one.sense, "unit": unit}
            for one, unit in zip(search.goals, found.units, strict=True)
        ],
        "limits": [
            {"name": name, "limit": number(limit), "of_study": name in search.of_study}
            for name, limit in search.limits.items()
        ],
        "feasible": found.feasible,
        "front": [design_table(found, k) for k in found.members],
        "ends": dict(found.ends),
        "knee": found.knee,
        "nearest": None if found.nearest is None else design_table(found, found.nearest),
        "robust": None if not search.over else {"over": [one.path for one in search.over], "quantile": search.quantile},
        "runs": found.runs,
        "runs_of_a_design": s,
        "designs": found.designs,
        "left_out": found.left_out,
        "flat": list(found.flat),
        "still_improving": found.still_improving,
        "spent": found.spent,
        "interrupted": found.interrupted,
        "hypervolume": [{"designs": count, "share": number(share)} for count, share in found.convergence],
    }


def design_table(found: Front, k: int) -> Table:
    """A design: what was chosen, its goals and limited numbers, and the command that runs it."""
    search, texts = found.search, found.texts(k)
    row = k * search.samples
    return {
        "design": k,
        "sample": row,
        "notes": found.notes(k),
        "chosen": [
            {"path": one.path, "text": texts[one.path], "value": number(float(value)), "unit": one.unit, "at": end}
            for one, value, end in zip(search.designs, found.rows.values[row], found.at[k], strict=False)
        ],
        "goals": {one.name: number(float(value)) for one, value in zip(search.goals, found.goals[k], strict=True)},
        "limited": {name: number(float(value)) for name, value in zip(search.limits, found.limited[k], strict=True)},
        "findings": _codes(found, row),
        "run_it": command_of(search, texts),
    }


def _codes(found: Front, row: int) -> list[str]:
    """Of all runs of a design whose first has this number."""
    own = [codes for case in found.rows.findings for codes in case[row : row + found.search.samples]]
    return sorted({code for codes in own for code in codes})
