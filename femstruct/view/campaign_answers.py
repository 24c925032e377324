"""What campaigns found, as lines and tables: sweeps, optimisations, fronts, and numbers that no sample has."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from math import ceil
from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import list_some
from femstruct.files.campaign_tables import command_of, left_out, limited, run_command, spreads, unchanged
from femstruct.language.campaigns import set_by_cases
from femstruct.study.asked import SETTLED
from femstruct.study.campaigns import (
    FEWEST,
    INDICES,
    UNROUNDED,
    HeldLimit,
    Listed,
    Scattered,
    Swept,
    held_limits,
    independent,
    influences,
)
from femstruct.study.optima import NEARLY, SAME, SMALL, VALLEYS, Chosen, Found, Front, Reference, Search, picked
from femstruct.view.console import Grid, Piece, digits, scaled
from femstruct.yaml.reader import Mistakes, parse_value

# ----------------------------------------------------------------------------------------------------------------------
# Numbers that no sample has, and why.
# ----------------------------------------------------------------------------------------------------------------------

RATING: Final = " rating"  # ends the name of a room's number
BLANK: Final = "rating-beyond-modes"  # the finding of rated bands that are blank
SILENT: Final = "room-silent"
LEVEL: Final = " L_AFmax"  # ends the name of a receiver's number
NAMED: Final = 6  # numbers


def not_known(rows: Swept, names: Sequence[str]) -> list[str]:
    """Numbers that no sample has in any case, of those that are to be trusted; none where no sample is."""
    sound = np.array([rows.trusted(case) for case in rows.cases])
    if not sound.any():
        return []
    return [name for name in names if not (np.isfinite(rows.numbers[:, :, rows.names.index(name)]) & sound).any()]


def not_known_pieces(rows: Swept, names: Sequence[str], many: str) -> Iterator[str]:
    """A sentence for each reason.

    Parameters
    ----------
    many : str
        What rows are.
    """
    codes = {code for case in rows.findings for own in case for code in own}
    by_reason: dict[str, list[str]] = {}
    for name in not_known(rows, names):
        by_reason.setdefault(why_not_known(name, codes), []).append(name)
    for why, found in by_reason.items():
        yield f"Not known in any of the {many}: {list_some(found, NAMED)}" + (f" ({why})" if why else "")


def why_not_known(name: str, codes: Collection[str]) -> str:
    """Why a number cannot be had, as far as its name and the findings of its rows say; "" where they do not.

    >>> why_not_known("bedroom rating", ["rating-beyond-modes"])
    'it needs bands that are blank; femstruct explain rating-beyond-modes'
    >>> why_not_known("settled", [])
    'not at rest when the window, or the time between blows, ends'
    """
    if name == SETTLED:
        return "not at rest when the window, or the time between blows, ends"
    if name.removesuffix(UNROUNDED).endswith(RATING):
        known = [code for code in (BLANK, SILENT) if code in codes]
        return "it needs bands that are blank" + "".join(f"; femstruct explain {code}" for code in known)
    if name.endswith(LEVEL) and SILENT in codes:
        return f"nothing moves the room; femstruct explain {SILENT}"
    return ""


# ----------------------------------------------------------------------------------------------------------------------
# What a campaign found, as lines and tables: the extremes of chosen samples or the scatter of drawn ones, and what
# was left out.
# ----------------------------------------------------------------------------------------------------------------------

MOST_NAMED: Final = 6  # numbers that are named
WIDE: Final = 0.3  # of the variance: an interval from which on more samples are asked for
MOVING: Final = "not at rest"
REASONS_SHOWN: Final = 3  # samples without numbers whose reason is printed


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
        factor, unit = _shown_number(rows, name)
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
        share_text = f"{100.0 * one.share:.0f} % ({between})" if np.isfinite(one.share) else between
        count = (f"{one.unknown}",) if unknown else ()
        of_all = f"{one.held} of {one.count}"
        grid.add(one.name, one.case, limit, of_all, f"{one.exceeded}", *count, *((share_text,) if share else ()))
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
        factor, unit = _shown_number(rows, one.name)
        case = f"{one.case} less {one.above}" if one.above else one.case
        statistics = (one.mean, one.deviation, *one.quantiles)
        grid.add(one.name, case, unit, *(digits(factor * value) for value in statistics), f"{one.count}")
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
    """What does not change, how many samples have no number or are not to be trusted, and why.

    Parameters
    ----------
    one : str
        What a row is.
    """
    n, many = len(rows.texts), f"{one}s"
    yield from not_known_pieces(rows, names, many)
    unknown = not_known(rows, names)
    if same := [name for name in unchanged(rows, names) if name not in unknown]:
        yield f"The same in all {many}: {list_some(same, MOST_NAMED)}"
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
        sentence = f"Left out: {count} of {n} {many} with the finding {code}, which forbids trust"
        yield f"{sentence}; femstruct explain {code}"
    failed = [(i, why) for i, why in enumerate(rows.trouble) if why]
    for i, why in failed[:REASONS_SHOWN]:
        yield f"No result for {one} {i} ({_at(rows, i)}): {why}"
    if len(failed) > REASONS_SHOWN:
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
    return list_some([f"{name} {_varied_value(rows, i, j)}".strip() for j, name in enumerate(named)], 4)


def _varied_value(rows: Swept, i: int, j: int) -> str:
    return value_text(float(rows.values[i, j]), rows.units[j], rows.texts[i][j])


def value_text(value: float, unit: str, text: str) -> str:
    """A value in a unit that is easy to read; what is no number as a file writes it.

    >>> value_text(0.0042, "m", ""), value_text(float("nan"), "", "steel"), value_text(0.25, "1", "")
    ('4.2 mm', 'steel', '0.25')
    """
    if not np.isfinite(value):
        return text
    factor, shown = in_unit(unit, abs(value))
    return f"{digits(factor * value)} {shown}".strip()


def in_unit(unit: str, largest: float) -> tuple[float, str]:
    """A factor and the unit in which numbers are printed; levels and plain numbers as they are."""
    return (1.0, "" if unit == "1" else unit) if unit in ("", "1", "dB") else scaled(unit, largest)


def _shown_number(rows: Swept, name: str) -> tuple[float, str]:
    values = rows.numbers[:, :, rows.names.index(name)]
    return in_unit(rows.unit_of(name), float(np.nanmax(np.abs(values), initial=0.0)))


# ----------------------------------------------------------------------------------------------------------------------
# What varies, in words: ranges, lists and distributions in units that are easy to read.
# ----------------------------------------------------------------------------------------------------------------------


def range_of(one: Listed | Scattered) -> str:
    """The values that a path may take.

    >>> range_of(Scattered("bodies.damper.mass", "log-uniform", 50.0, 4000.0, "kg"))
    '50 kg .. 4000 kg, on a logarithmic scale'
    >>> range_of(Scattered("bodies.ram.speed", "normal", 6.0, 0.3, "m/s"))
    'normal: mean 6 m/s, deviation 300 mm/s'
    >>> range_of(Listed("points.centre.at", ("center", "[1, 2]")))
    'one of center, [1, 2]'
    """
    if isinstance(one, Listed):
        return f"one of {', '.join(one.texts)}"
    first, second = (value_text(value, one.unit, "") for value in (one.first, one.second))
    if one.law == "normal":
        return f"normal: mean {first}, deviation {second}"
    return f"{first} .. {second}" + (", on a logarithmic scale" if one.law == "log-uniform" else "")


# ----------------------------------------------------------------------------------------------------------------------
# What an answer of an optimisation says before all else, where it is not the best design that was asked for.
# ----------------------------------------------------------------------------------------------------------------------

INTERRUPTED: Final = "Interrupted: the same command goes on"
NOT_AT_REST: Final = "not at rest when the window, or the time between blows, ends"
TOTAL_MASS: Final = "total mass"  # of the structure alone


def no_design(search: Search, rows: Swept, limited: Mapping[str, float], named: str = "") -> str:
    """By how much the design that comes nearest exceeds its limits.

    Parameters
    ----------
    limited : Mapping[str, float]
        Its values by name.
    named : str
        ", design 7" where designs have numbers.
    """
    words, unseen = list[str](), list[str]()
    for name, limit in search.limits.items():
        value = limited[name]
        if np.isnan(value):
            unseen.append(f"'{name}' is not shown: the structure is {NOT_AT_REST}")
        elif value - limit > SAME * abs(limit):
            factor, unit = in_unit(rows.unit_of(name), abs(value - limit))
            words.append(f"'{name}' by {digits(factor * (value - limit))} {unit}".strip())
    reasons = [f"the nearest{named} exceeds {' and '.join(words)}"] if words else []
    return f"No design holds all limits: {'; '.join([*reasons, *unseen])}" + ("" if words else f" (the nearest{named})")


def nothing_to_compare(search: Search, rows: Swept) -> Iterator[str]:
    """Why no design has its goals."""
    why = list(without_number(search, rows))
    if why:
        yield f"No design has all numbers that are asked for. {why[0]}"
        yield from why[1:]
    else:
        yield "No design is to be trusted: each has a finding that forbids it, or no result"


def without_number(search: Search, rows: Swept) -> Iterator[str]:
    """Goals and limits that designs have no number of, in how many samples, and why where it is known."""
    chosen, goals = [one.path for one in search.designs], [one.name for one in search.goals]
    ran = rows.done & np.array([not one for one in rows.trouble], dtype=bool)
    for name in dict.fromkeys((*goals, *search.limits)):
        if name in chosen or not ran.any():
            continue
        lacking = ran & ~np.isfinite(rows.of(name)) if name in rows.names else ran
        if not lacking.any():
            continue
        designs = lacking.reshape(-1, search.samples).any(axis=1)
        count = f"{int(designs.sum())} of {len(designs)} designs"
        if search.over:
            count = f"{int(lacking.sum())} of {len(lacking)} samples, of {count}"
        why = ""
        if name == SETTLED and name in goals:
            do = "a longer one, 'time: {duration: ..}', is required"
            why = f". The window is too short: the structure does not come to rest in it; {do}"
        elif name == SETTLED:
            why = f". The structure is {NOT_AT_REST} there, so that the limit is not shown to hold"
        elif reason := why_not_known(name, {code for case in rows.findings for own in case for code in own}):
            why = f": {reason}"
        yield f"'{name}' has no number in {count}{why}"


def same_for_all(search: Search, name: str) -> str:
    """That a goal is no matter of choice."""
    sentence = f"'{name}' is the same for all designs that were tried: it does not depend on what may be chosen"
    if name != TOTAL_MASS:
        return sentence
    bodies = next((one.path for one in search.designs if one.path.startswith("bodies.")), "")
    return f"{sentence}; it is the mass of the structure without bodies" + (
        f". The path '{bodies}' can be a goal" if bodies else ""
    )


# ----------------------------------------------------------------------------------------------------------------------
# A front of designs, as lines and tables.
# ----------------------------------------------------------------------------------------------------------------------

MOST_OF_FRONT: Final = 12  # designs that are printed; the table on the disk has all


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
    yield from _front_sentences(found)
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
            value_text(float(row[j]), one.unit, texts[one.path])
            + (f" ({found.at[k][j]} end)" if found.at[k][j] else "")
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
    shown = [members[i] for i in picked(found.small[list(members)], first, MOST_OF_FRONT)]
    some = "" if len(shown) == len(members) else f"{len(shown)} of {len(members)} "
    return shown, f"{some}designs of which none is better than another in all goals"


def _front_sentences(found: Front) -> Iterator[str]:
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
    course = found.convergence
    some = sorted({round(i) for i in np.linspace(0, len(course) - 1, min(len(course), 6))})
    return list_some([f"{course[i][0]}: {100.0 * course[i][1]:.1f}" for i in some], 6)


def _largest(values: Floats) -> float:
    return float(np.nanmax(np.abs(values), initial=0.0))


# ----------------------------------------------------------------------------------------------------------------------
# The answer of an optimisation, as lines and tables.
# ----------------------------------------------------------------------------------------------------------------------

ROUNDING: Final = 1e-9  # of a share of samples
MOST_VALUES: Final = 4  # values of a list that are printed
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
        scale, unit_shown = in_unit(found.rows.unit_of(name), abs(limit))
        own = found.limits[name]
        shown = "not at rest in time" if np.isnan(own) else f"{digits(scale * own)} {unit_shown}"
        word = "not shown" if np.isnan(own) else "met" if own - limit <= SAME * abs(limit) else "exceeded"
        place = "limits (of the study)" if name in search.of_study else "optimise"
        limits.add(name, shown, f"{digits(scale * limit)} {unit_shown}", word, place)
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
        return list_some(list(dict.fromkeys(rows.texts[i][j] for i in near)), MOST_VALUES)
    values, one = np.sort(values), found.search.designs[j]
    scale = np.log(values) if isinstance(one, Scattered) and one.law == "log-uniform" else values
    every = rows.values[:, j]
    whole = np.ptp(np.log(every)) if scale is not values else np.ptp(every)
    parts = np.split(values, np.flatnonzero(np.diff(scale) > VALLEYS * whole) + 1)
    ranges = [
        [value_text(float(end), rows.units[j], "") for end in (part[0], part[-1])] for part in parts[:MOST_VALUES]
    ]
    more = f" and {len(parts) - MOST_VALUES} more" if len(parts) > MOST_VALUES else ""
    return ", ".join(low if low == high else f"{low} .. {high}" for low, high in ranges) + more


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
        cells = [digits(factor * one.goal), _less(found.goal - one.goal, one.goal, factor, unit, shared)]
        if search.over:
            cells[0] += f" ({digits(factor * one.ends[0])} .. {digits(factor * one.ends[1])})"
            low, high = factor * one.less.min(), factor * one.less.max()
            mean = _less(float(one.less.mean()), one.mean, factor, unit, shared)
            cells.append(f"{mean} ({low:+.3g} .. {high:+.3g})")
        grid.add(name, *cells)
    yield grid
    for one in found.references:
        if not one.why and found.feasible:
            yield from _worth(found, one)


def _less(difference: float, of: float, factor: float, unit: str, shared: bool) -> str:
    """What the design is above a case; as a share of the same statistic of that case, too."""
    difference_text = f"{factor * difference:+.3g} {unit}".strip()
    return difference_text + (f", {100.0 * difference / abs(of):+.2g} %" if shared and of else "")


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
    return value_text(one.number, one.unit, one.text)


def _change(one: Chosen, factor: float, unit: str) -> str:
    if np.isnan(one.change):
        return "not run: too few runs"
    return f"{factor * one.change:+.2g} {unit}".strip()
