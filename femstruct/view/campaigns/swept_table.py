"""What a campaign found, as lines and tables: the extremes of chosen samples or the scatter of drawn ones, and what
was left out."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from femstruct.errors import some_of
from femstruct.files.tables.sweep_tables import left_out, limited, spreads, unchanged
from femstruct.language.campaigns import set_by_cases
from femstruct.language.yaml import Mistakes, parse_value
from femstruct.study.asked import SETTLED
from femstruct.study.campaign.held_limits import HeldLimit, held_limits
from femstruct.study.campaign.influence import influences
from femstruct.study.campaign.spread import FEWEST
from femstruct.study.campaign.swept import Swept, independent
from femstruct.study.campaign.varied import INDICES
from femstruct.view.campaigns.not_known import not_known, not_known_pieces
from femstruct.view.tables.grid import Grid, Piece
from femstruct.view.tables.scales import digits, scaled

SAME: Final = 6  # numbers that are named
WIDE: Final = 0.3  # of the variance: an interval from which on more samples are asked for
MOVING: Final = "not at rest"
TOLD: Final = 3  # samples without numbers whose reason is printed


def swept_pieces(rows: Swept, names: Sequence[str] = ()) -> Iterator[Piece]:
    """The main numbers, or those of these names, over all samples that are to be trusted."""
    names = names or rows.main
    cases = f" in {len(rows.cases)} cases" if len(rows.cases) > 1 else ""
    run, failed = int(rows.done.sum()), sum(map(bool, rows.trouble))
    without = f", of which {failed} have no result" if failed else ""
    yield f"{rows.title}: {run} of {len(rows.texts)} samples{cases}{without}"
    yield from _set_by_cases(rows)
    if limits := list(held_limits(rows, names)):
        yield _limits(rows, limits)
    yield (_scatter if rows.drawn else _extremes)(rows, names)
    if rows.drawn:
        yield (_influence if rows.method == INDICES else _followed)(rows, names)
    if rows.method == INDICES and _unsure(rows, names):
        yield "These shares are not to be used yet, their intervals are too wide: take a larger 'count'"
    yield from left_out_pieces(rows, names)


def _set_by_cases(rows: Swept) -> Iterator[str]:
    """Which cases set themselves what varies in the others."""
    files = [
        parse_value(text, name, Mistakes()).value
        for name, text in rows.sources.items()
        if name.endswith((".yaml", ".yml"))
    ]
    study = next((one for one in files if isinstance(one, dict) and "model" in one), {})
    for case, paths in set_by_cases(study, rows.paths, rows.cases).items():
        varies = "does not vary" if len(paths) == 1 else "do not vary"
        names, there = " and ".join(paths), f"cases.{case}.{paths[0]}"
        yield f"{names} {varies} in '{case}', which sets this itself: vary '{there}' for that"


def _extremes(rows: Swept, names: Sequence[str]) -> Grid:
    grid = Grid("smallest and largest", ("number", "case", "unit", "smallest", "at", "largest", "at"), keys=2)
    same = unchanged(rows, names)
    for name in names:
        factor, unit = _shown(rows, name)
        for case in rows.cases if name not in same else ():
            own = np.where(rows.trusted(case), rows.of(name, case), np.nan)
            if np.isfinite(own).any():
                low, high = int(np.nanargmin(own)), int(np.nanargmax(own))
                at = (_at(rows, low), _at(rows, high)) if own[low] < own[high] else ("all", "all")
                largest, where = digits(factor * own[high]), at[1]
                moving = np.flatnonzero(rows.trusted(case) & np.isnan(own))
                if name == SETTLED and len(moving):
                    largest, where = MOVING, f"{_at(rows, int(moving[0]))}{_more(len(moving))}"
                grid.add(name, case, unit, digits(factor * own[low]), at[0], largest, where)
    return grid


def _more(count: int) -> str:
    return f" and {count - 1} more" if count > 1 else ""


def _limits(rows: Swept, limits: Sequence[HeldLimit]) -> Grid:
    """In how many samples limits are held; of drawn ones also how likely that is."""
    share = ("share that holds it (95 % interval)",) if rows.drawn else ()
    unknown = ("not known in",) if any(one.unknown for one in limits) else ()
    grid = Grid("limits", ("number", "case", "limit", "held in", "exceeded in", *unknown, *share), keys=2)
    for one in limits:
        factor, unit = in_unit(one.unit, one.limits[1])
        low, high = (digits(factor * each) for each in one.limits)
        limit = f"{high if low == high else f'{low} .. {high}'} {unit}".strip()
        between = f"{100.0 * one.low:.0f} .. {100.0 * one.high:.0f} %"
        told = f"{100.0 * one.share:.0f} % ({between})" if np.isfinite(one.share) else between
        count = (f"{one.unknown}",) if unknown else ()
        of_all = f"{one.held} of {one.count}"
        grid.add(one.name, one.case, limit, of_all, f"{one.exceeded}", *count, *((told,) if share else ()))
    return grid


def _scatter(rows: Swept, names: Sequence[str]) -> Grid:
    head = (
        "number",
        "case",
        "unit",
        "mean",
        "deviation",
        "5 %",
        "median",
        "95 %",
        "samples",
    )
    grid = Grid("scatter over the samples", head, keys=2)
    for one in spreads(rows, names):
        factor, unit = _shown(rows, one.name)
        case = f"{one.case} less {one.above}" if one.above else one.case
        told = (one.mean, one.deviation, *one.quantiles)
        grid.add(one.name, case, unit, *(digits(factor * value) for value in told), f"{one.count}")
    return grid


def _followed(rows: Swept, names: Sequence[str]) -> Grid:
    title = "rank correlation with what varies: 1 or -1 where a number follows that alone"
    grid = Grid(title, ("number", "case", *rows.paths), keys=2)
    for one in spreads(rows, names):
        if not one.above:
            grid.add(one.name, one.case, *("" if np.isnan(share) else f"{share:+.2f}" for share in one.follows))
    return grid


def _influence(rows: Swept, names: Sequence[str]) -> Grid:
    title = "share of the variance [%]: alone / with all that it acts together with (95 % interval)"
    grid = Grid(title, ("number", "case", *rows.paths), keys=2)
    for name in names:
        for case in rows.cases:
            found = influences(rows, name, case)
            if found:
                grid.add(name, case, *(f"{_share(one.alone)} / {_share(one.total)}" for one in found))
    return grid


def _unsure(rows: Swept, names: Sequence[str]) -> bool:
    found = [one for name in names for case in rows.cases for one in influences(rows, name, case)]
    return any(high - low > WIDE for one in found for _, low, high in (one.alone, one.total))


def _share(ends: tuple[float, float, float]) -> str:
    value, low, high = (100.0 * one for one in ends)
    return f"{value:.0f} ({low:.0f} .. {high:.0f})"


def left_out_pieces(rows: Swept, names: Sequence[str] = (), one: str = "sample") -> Iterator[Piece]:
    """What does not change, how many samples have no number or are not to be trusted, and why. one : what a row is."""
    n, many = len(rows.texts), f"{one}s"
    yield from not_known_pieces(rows, names, many)
    unknown = not_known(rows, names)
    if same := [name for name in unchanged(rows, names) if name not in unknown]:
        yield f"The same in all {many}: {some_of(same, SAME)}"
    at_most = max((int(rows.trusted(case).sum()) for case in rows.cases), default=0)
    if rows.drawn and at_most < FEWEST:
        yield f"No statistics: {at_most} samples are to be trusted, and {FEWEST} or more are needed"
    if rows.drawn:
        yield from _partly(rows, names)
    if rows.made:
        yield f"Rows are made {rows.made}"
    for code, count in limited(rows).items():
        yield f"Limits trust: {code} in {count} of {n} {many}; femstruct explain {code}"
    for code, count in left_out(rows).items():
        told = f"Left out: {count} of {n} {many} with the finding {code}, which forbids trust"
        yield f"{told}; femstruct explain {code}"
    failed = [(i, why) for i, why in enumerate(rows.trouble) if why]
    for i, why in failed[:TOLD]:
        yield f"No result for {one} {i} ({_at(rows, i)}): {why}"
    if len(failed) > TOLD:
        yield f"No result for {len(failed)} of {n} {many} in all; the table has the reasons"
    if missing := int((~rows.done).sum()):
        yield f"Interrupted: {missing} of {n} {many} were not run. Run the command again to go on"


def _partly(rows: Swept, names: Sequence[str]) -> Iterator[str]:
    """Numbers that are blank in some of the samples: their statistics are those of the others, or have no mean."""
    for one in spreads(rows, names):
        if one.above:
            continue
        if one.longer:
            yield (
                f"{one.name}: {one.longer} of {one.count} samples of '{one.case}' are not at rest in time. They count "
                "as longer than all others, and there is no mean"
            )
        blank = int((rows.trusted(one.case) & independent(rows)).sum()) - one.count
        if blank:
            yield f"{one.name}: blank in {blank} samples of '{one.case}'; its statistics are those of the others"
    if any(rows.trouble):
        yield "Samples without a result are missing from all statistics: the others are not of the whole distribution"


def _at(rows: Swept, i: int) -> str:
    """What varied in a sample, in short."""
    last = [path.rpartition(".")[2] for path in rows.paths]
    named = last if len(set(last)) == len(last) else list(rows.paths)
    if len(rows.paths) == 1:
        named = [""]
    return some_of([f"{name} {_value(rows, i, j)}".strip() for j, name in enumerate(named)], 4)


def _value(rows: Swept, i: int, j: int) -> str:
    return written(float(rows.values[i, j]), rows.units[j], rows.texts[i][j])


def written(value: float, unit: str, text: str) -> str:
    """A value in a unit that is easy to read; what is no number as a file writes it.

    >>> written(0.0042, "m", ""), written(float("nan"), "", "steel"), written(0.25, "1", "")
    ('4.2 mm', 'steel', '0.25')
    """
    if not np.isfinite(value):
        return text
    factor, shown = in_unit(unit, abs(value))
    return f"{digits(factor * value)} {shown}".strip()


def in_unit(unit: str, largest: float) -> tuple[float, str]:
    """A factor and the unit in which numbers are printed; levels and plain numbers as they are."""
    return (1.0, "" if unit == "1" else unit) if unit in ("", "1", "dB") else scaled(unit, largest)


def _shown(rows: Swept, name: str) -> tuple[float, str]:
    values = rows.numbers[:, :, rows.names.index(name)]
    return in_unit(rows.unit_of(name), float(np.nanmax(np.abs(values), initial=0.0)))
