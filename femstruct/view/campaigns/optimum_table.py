"""The answer of an optimisation, as lines and tables."""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil
from typing import Final

import numpy as np

from femstruct.errors import some_of
from femstruct.files.tables.optimum_tables import run_command
from femstruct.study.campaign.sought import NEARLY, SAME, SMALL, VALLEYS, Chosen, Found, Reference
from femstruct.study.campaign.swept import UNROUNDED
from femstruct.study.campaign.varied import Listed, Scattered
from femstruct.view.campaigns.first_lines import (
    INTERRUPTED,
    no_design,
    nothing_to_compare,
    same_for_all,
    without_number,
)
from femstruct.view.campaigns.swept_table import in_unit, left_out_pieces, written
from femstruct.view.tables.grid import Grid, Piece
from femstruct.view.tables.scales import digits

ROUNDING: Final = 1e-9  # of a share of samples
MOST: Final = 4  # values of a list that are printed
WHOLE: Final = 1.0  # dB: the step of a rating as it is stated


def optimum_pieces(found: Found) -> Iterator[Piece]:
    """The best design with its limits, what lies beside it, and how it was found."""
    search = found.search
    if found.interrupted:
        yield INTERRUPTED
    if np.isfinite(found.goal):
        yield from _best(found)
        yield from without_number(search, found.rows)
        yield from _doubts(found)
    else:
        yield from nothing_to_compare(search, found.rows)
    ended = f"{search.runs} runs are allowed" if found.spent else "it ended since nothing got better any more"
    tried = f"{found.designs} designs, {found.runs} runs"
    tried += f"; the last improvement at design {found.history[-1][0]}" if found.history else ""
    tried += "" if found.interrupted else f"; {ended}"
    if found.begun:
        yield f"The search began with the {found.begun} best designs of a sweep that lie apart, and with others"
    yield f"{tried}. A global optimum is not proven: another 'seed' gives another search"
    yield from left_out_pieces(found.rows, one="run" if search.over else "design")
    if np.isfinite(found.goal):
        yield f"To run it: {run_command(found)}"


def _best(found: Found) -> Iterator[Piece]:
    """The design itself; first that it is not what was asked for, where it is not."""
    search = found.search
    factor, unit = in_unit(found.unit, abs(found.goal))
    quantile = f", {100 * search.quantile:g} % quantile of {search.scatter} samples" if search.over else ""
    value = f"{digits(factor * found.goal)} {unit}".strip()
    named = f"{'least' if search.sense == 'minimise' else 'largest'} {found.goal_name}"
    if not found.feasible:
        yield no_design(search, found.rows, found.limits)
        named = f"{found.goal_name} of the design that exceeds the limits least"
    if found.flat:
        yield same_for_all(search, search.goal)
        named = found.goal_name if found.feasible else named
    yield f"{search.title}: {named}: {value}{quantile}"
    if search.over:
        low, high = (digits(factor * one) for one in found.ends)
        paths = ", ".join(one.path for one in search.over)
        yield f"In the {search.scatter} samples of {paths} it is between {low} and {high} {unit}"
    head = (
        "chosen",
        "value",
        "of the designs tried,\nnearly as good",
        "at the end of its range",
        f"{search.goal} changes per 1 % of the range",
    )
    grid = Grid("the best design found" if found.feasible else "the design that exceeds the limits least", head)
    for j, (one, path) in enumerate(zip(found.chosen, search.designs, strict=True)):
        change = "of a list" if isinstance(path, Listed) else _change(one, factor, unit)
        grid.add(one.path, _value(one), _nearly(found, j), one.at or "no", change)
    yield grid
    if found.feasible:
        yield _how_near(found)
    yield from reference_pieces(found, factor, unit)
    limits = Grid("its limits", ("number", "value", "limit", "", "stated under"))
    for name, limit in search.limits.items():
        scale, told = in_unit(found.rows.unit_of(name), abs(limit))
        own = found.limits[name]
        shown = "not at rest in time" if np.isnan(own) else f"{digits(scale * own)} {told}"
        word = "not shown" if np.isnan(own) else "met" if own - limit <= SAME * abs(limit) else "exceeded"
        place = "limits (of the study)" if name in search.of_study else "optimise"
        limits.add(name, shown, f"{digits(scale * limit)} {told}", word, place)
    yield limits
    for one in found.chosen:
        if one.at:
            yield f"{one.path} is at the {one.at} end of its range: a wider range may give more"


def _nearly(found: Found, j: int) -> str:
    """The values of a path among the designs that are nearly as good: a range for each valley that they lie in."""
    s, rows = found.search.samples, found.rows
    near = np.flatnonzero(found.nearly) * s
    values = rows.values[near, j]
    if not len(near) or not np.isfinite(values).all():
        return some_of(list(dict.fromkeys(rows.texts[i][j] for i in near)), MOST)
    values, one = np.sort(values), found.search.designs[j]
    scale = np.log(values) if isinstance(one, Scattered) and one.law == "log-uniform" else values
    every = rows.values[:, j]
    whole = np.ptp(np.log(every)) if scale is not values else np.ptp(every)
    parts = np.split(values, np.flatnonzero(np.diff(scale) > VALLEYS * whole) + 1)
    told = [[written(float(end), rows.units[j], "") for end in (part[0], part[-1])] for part in parts[:MOST]]
    more = f" and {len(parts) - MOST} more" if len(parts) > MOST else ""
    return ", ".join(low if low == high else f"{low} .. {high}" for low, high in told) + more


def _how_near(found: Found) -> str:
    """What counts as nearly as good, and how many designs are."""
    over, count = found.gained_over, int(found.nearly.sum())
    if over is None:
        what = f"within {100.0 * SMALL:g} % of the best"
    else:
        name = f"'{over.name}'" + (" as written" if over.chosen else "")
        what = f"those that keep {100.0 * (1.0 - NEARLY):g} % of what the best gains over {name}"
    return f"Nearly as good: {count} of {found.designs} designs, {what}; there may be others where none was tried"


def reference_pieces(found: Found, factor: float, unit: str) -> Iterator[Piece]:
    """What the best design is held against, and whether it is better at all."""
    search, named = found.search, f"{found.goal_name} [{unit}]".replace(" []", "")
    design = "the best design" if found.feasible else "the nearest design"
    head = ["case", named, f"{design} less this one"]
    if search.over:
        share = f"{100.0 * search.quantile:g} % quantile"
        head[1:] = [
            f"{named},\n{share} (smallest .. largest)",
            f"{design} less this one:\n{share}s",
            f"mean of the {search.scatter} paired\ndifferences (smallest .. largest)",
        ]
    grid = Grid("beside it, in the same samples" if search.over else "beside it", tuple(head))
    shared = found.unit != "dB"
    for one in found.references:
        name = f"{one.name}, as written" if one.chosen else f"{one.name}, the baseline"
        if one.why:
            grid.add(name, "", f"none: {one.why}", *([""] if search.over else []))
            continue
        told = [digits(factor * one.goal), _less(found.goal - one.goal, one.goal, factor, unit, shared)]
        if search.over:
            told[0] += f" ({digits(factor * one.ends[0])} .. {digits(factor * one.ends[1])})"
            low, high = factor * one.less.min(), factor * one.less.max()
            mean = _less(float(one.less.mean()), one.mean, factor, unit, shared)
            told.append(f"{mean} ({low:+.3g} .. {high:+.3g})")
        grid.add(name, *told)
    yield grid
    for one in found.references:
        if not one.why and found.feasible:
            yield from _worth(found, one)


def _less(difference: float, of: float, factor: float, unit: str, shared: bool) -> str:
    """What the design is above a case; as a share of the same statistic of that case, too."""
    told = f"{factor * difference:+.3g} {unit}".strip()
    return told + (f", {100.0 * difference / abs(of):+.2g} %" if shared and of else "")


def _worth(found: Found, one: Reference) -> Iterator[str]:
    """Where the best design is no better than a case, or not by what a stated number can show."""
    better = -one.less if found.search.sense == "minimise" else one.less
    name = f"case '{one.name}'" + (" as written" if one.chosen else "")
    if (better <= 0.0).all():
        yield f"The best design is not better than {name}"
    elif (better <= 0.0).any():
        yield f"The best design is better than {name} in {int((better > 0.0).sum())} of {len(better)} samples only"
    if found.goal_name.endswith(UNROUNDED) and np.abs(better).max() < WHOLE:
        yield f"It differs from {name} by less than 1 dB, the step in which the rating is stated"


def _doubts(found: Found) -> Iterator[str]:
    """Why the design is not to be taken for the best."""
    search = found.search
    if found.still_improving:
        yield "The goal still got better when the runs ended: more 'runs' will find a better design"
    least = 1.0 / min(search.quantile, 1.0 - search.quantile)
    if search.over and search.scatter < least * (1.0 - ROUNDING):
        share, enough = f"{100.0 * search.quantile:g} %", ceil(least * (1.0 - ROUNDING))
        yield (
            f"{search.scatter} samples say little of a quantile of {share}: {enough} or more, 'robust: {{samples: ..}}'"
            ", say more"
        )


def _value(one: Chosen) -> str:
    return written(one.number, one.unit, one.text)


def _change(one: Chosen, factor: float, unit: str) -> str:
    if np.isnan(one.change):
        return "not run: too few runs"
    return f"{factor * one.change:+.2g} {unit}".strip()
