"""A front of designs, as lines and tables."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import some_of
from femstruct.files.tables.optimum_tables import command_of
from femstruct.study.campaign.front import Front
from femstruct.study.campaign.pareto import picked
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

MOST: Final = 12  # designs that are printed; the table on the disk has all


def front_pieces(found: Front) -> Iterator[Piece]:
    """Designs all along the front, those that stand out, and how far to trust it."""
    search = found.search
    quantile = f", {100 * search.quantile:g} % quantiles of {search.scatter} samples" if search.over else ""
    goals = " and ".join(f"{'small' if one.sign > 0 else 'large'} {one.name}" for one in search.goals)
    if found.interrupted:
        yield INTERRUPTED
    yield from _first(found)
    yield f"{search.title}: {goals}{quantile}: {len(found.members)} designs on the front"
    yield _designs(found)
    yield from _told(found)
    ended = "all runs were made" if found.spent else "it ended since no new design came up"
    tried = f"{found.designs} designs, {found.runs} runs" + ("" if found.interrupted else f"; {ended}")
    yield f"{tried}. That no better front exists is not proven: another 'seed' gives another search"
    yield from left_out_pieces(found.rows, one="run" if search.over else "design")
    for k in dict.fromkeys([*([] if found.knee is None else [found.knee]), *found.ends.values()]):
        yield f"To run design {k} ({', '.join(found.notes(k))}): {command_of(search, found.texts(k))}"


def _first(found: Front) -> Iterator[str]:
    """That there is no front, or none in some of the goals."""
    search, nearest = found.search, found.nearest
    if nearest is not None:
        limited = dict(zip(search.limits, map(float, found.limited[nearest]), strict=True))
        yield no_design(search, found.rows, limited, f", design {nearest},")
    elif not found.feasible:
        yield from nothing_to_compare(search, found.rows)
    for name in found.flat:
        yield same_for_all(search, name)


def _designs(found: Front) -> Grid:
    """Some designs of the front, the ends and the knee among them; of none, the one that comes nearest."""
    search = found.search
    shown, title = _shown(found)
    scales = [in_unit(unit, _largest(found.goals[:, g])) for g, unit in enumerate(found.units)]
    goals = [one.name for one in search.goals]
    others = {m: name for m, name in enumerate(search.limits) if name not in goals}
    limited = [in_unit(found.rows.unit_of(name), abs(search.limits[name])) for name in others.values()]
    names = [*goals, *others.values()]
    heads = [f"{name} [{unit}]" if unit else name for name, (_, unit) in zip(names, (*scales, *limited), strict=True)]
    grid = Grid(title, ("design", *heads, *(one.path for one in search.designs), "stands out"))
    for k in shown:
        pairs = zip((*found.goals[k], *found.limited[k, list(others)]), (*scales, *limited), strict=True)
        values = [digits(factor * float(value)) for value, (factor, _) in pairs]
        row, texts = found.rows.values[k * search.samples], found.texts(k)
        chosen = [
            written(float(row[j]), one.unit, texts[one.path]) + (f" ({found.at[k][j]} end)" if found.at[k][j] else "")
            for j, one in enumerate(search.designs)
        ]
        grid.add(str(k), *values, *chosen, ", ".join(found.notes(k)))
    return grid


def _shown(found: Front) -> tuple[list[int], str]:
    """Numbers of the designs to print, and the title over them."""
    if not found.members:
        return ([], "") if found.nearest is None else ([found.nearest], "the design that exceeds the limits least")
    members = found.members
    first = [members.index(k) for k in (*found.ends.values(), *([] if found.knee is None else [found.knee]))]
    shown = [members[i] for i in picked(found.small[list(members)], first, MOST)]
    some = "" if len(shown) == len(members) else f"{len(shown)} of {len(members)} "
    return shown, f"{some}designs of which none is better than another in all goals"


def _told(found: Front) -> Iterator[str]:
    """What the front says, and why it is not to be taken for the best."""
    if found.feasible:
        yield from without_number(found.search, found.rows)
    if len(found.members) == 1 and not found.flat:
        yield "One design is best in all goals: they do not exclude each other within these ranges"
    elif len(found.members) > 1 and found.knee is None:
        yield "The front has no knee: no design stands out in front of the line through its ends"
    ends = Counter((j, end) for k in found.members for j, end in enumerate(found.at[k]) if end)
    for (j, end), count in sorted(ends.items()):
        path = found.search.designs[j].path
        yield f"{path} is at the {end} end of its range in {count} of {len(found.members)} designs of the front"
    if found.still_improving:
        yield "The front still got better when the runs ended: more 'runs' will find better designs"
    search = found.search
    if search.over and search.scatter * min(search.quantile, 1.0 - search.quantile) < 1.0:
        share = f"{100.0 * search.quantile:g} %"
        yield f"{search.scatter} samples say little of a quantile of {share}: more 'robust: {{samples: ..}}' say more"
    if found.convergence:
        yield f"hypervolume by designs tried [% of its box]: {_convergence(found)}"


def _convergence(found: Front) -> str:
    told = found.convergence
    some = sorted({round(i) for i in np.linspace(0, len(told) - 1, min(len(told), 6))})
    return some_of([f"{told[i][0]}: {100.0 * told[i][1]:.1f}" for i in some], 6)


def _largest(values: Floats) -> float:
    return float(np.nanmax(np.abs(values), initial=0.0))
