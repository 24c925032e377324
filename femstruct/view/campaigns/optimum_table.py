"""The answer of an optimisation, as lines and tables."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from femstruct.files.tables.optimum_tables import run_command
from femstruct.study.campaign.sought import Chosen, Found
from femstruct.view.campaigns.swept_table import in_unit, left_out_pieces, written
from femstruct.view.tables.grid import Grid, Piece
from femstruct.view.tables.scales import digits


def optimum_pieces(found: Found) -> Iterator[Piece]:
    """The best design with its limits, what lies beside it, and how it was found."""
    search = found.search
    factor, unit = in_unit(found.unit, abs(found.goal))
    quantile = f", {100 * search.quantile:g} % quantile of {search.scatter} samples" if search.over else ""
    word = "least" if search.sense == "minimise" else "largest"
    value = f"{digits(factor * found.goal)} {unit}".strip()
    yield f"{search.title}: {word} {search.goal}: {value}{quantile}"
    if search.over:
        low, high = (digits(factor * one) for one in found.ends)
        paths = ", ".join(one.path for one in search.over)
        yield f"over the scatter of {paths} it lies between {low} and {high} {unit}"
    head = ("chosen", "value", "at the end of its range", f"{search.goal} changes per 1 % of the range")
    grid = Grid("the best design found", head)
    for one in found.chosen:
        grid.add(one.path, _value(one), one.at, _change(one, factor, unit))
    yield grid
    limits = Grid("its limits", ("number", "value", "limit"))
    for name, limit in search.limits.items():
        scale, told = in_unit(found.rows.unit_of(name), abs(limit))
        limits.add(name, f"{digits(scale * found.limits[name])} {told}", f"{digits(scale * limit)} {told}")
    yield limits
    if not found.feasible:
        yield "No design that was tried holds all limits: this one exceeds them least"
    for one in found.chosen:
        if one.at:
            yield f"{one.path} is at the {one.at} end of its range: a wider range may give more"
    yield from _doubts(found)
    ended = "all runs were made" if found.spent else "it ended since nothing got better any more"
    tried = f"{found.designs} designs, {found.runs} runs; the last improvement at design {_last(found)}; {ended}"
    yield f"{tried}. A global optimum is not proven: another 'seed' gives another search"
    if found.interrupted:
        yield "Interrupted: the same command goes on"
    yield from left_out_pieces(found.rows)
    yield f"To run it: {run_command(found)}"


def _doubts(found: Found) -> Iterator[str]:
    """Why the design is not to be taken for the best."""
    search = found.search
    if found.flat:
        yield f"{search.goal} is the same for all designs that were tried: none of them is better than the others"
    elif found.still_improving:
        yield "The goal still got better when the runs ended: more 'runs' will find a better design"
    if search.over and search.scatter * min(search.quantile, 1.0 - search.quantile) < 1.0:
        share = f"{100.0 * search.quantile:g} %"
        yield f"{search.scatter} samples say little of a quantile of {share}: more 'robust: {{samples: ..}}' say more"


def _last(found: Found) -> str:
    return str(found.history[-1][0]) if found.history else "-"


def _value(one: Chosen) -> str:
    return written(one.number, one.unit, one.text)


def _change(one: Chosen, factor: float, unit: str) -> str:
    if np.isnan(one.change):
        return ""
    return f"{factor * one.change:+.2g} {unit}".strip()
