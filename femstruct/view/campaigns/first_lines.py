"""What an answer of an optimisation says before all else, where it is not the best design that was asked for."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Final

import numpy as np

from femstruct.study.asked import SETTLED
from femstruct.study.campaign.sought import SAME, Search
from femstruct.study.campaign.swept import Swept
from femstruct.view.campaigns.not_known import why_not_known
from femstruct.view.campaigns.swept_table import in_unit
from femstruct.view.tables.scales import digits

INTERRUPTED: Final = "Interrupted: the same command goes on"
NOT_AT_REST: Final = "not at rest when the window, or the time between blows, ends"
TOTAL_MASS: Final = "total mass"  # of the structure alone


def no_design(search: Search, rows: Swept, limited: Mapping[str, float], named: str = "") -> str:
    """By how much the design that comes nearest exceeds its limits. limited : its values by name. named : ", design 7"
    where designs have numbers."""
    words, unseen = list[str](), list[str]()
    for name, limit in search.limits.items():
        value = limited[name]
        if np.isnan(value):
            unseen.append(f"'{name}' is not shown: the structure is {NOT_AT_REST}")
        elif value - limit > SAME * abs(limit):
            factor, unit = in_unit(rows.unit_of(name), abs(value - limit))
            words.append(f"'{name}' by {digits(factor * (value - limit))} {unit}".strip())
    told = [f"the nearest{named} exceeds {' and '.join(words)}"] if words else []
    return f"No design holds all limits: {'; '.join([*told, *unseen])}" + ("" if words else f" (the nearest{named})")


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
        elif told := why_not_known(name, {code for case in rows.findings for own in case for code in own}):
            why = f": {told}"
        yield f"'{name}' has no number in {count}{why}"


def same_for_all(search: Search, name: str) -> str:
    """That a goal is no matter of choice."""
    told = f"'{name}' is the same for all designs that were tried: it does not depend on what may be chosen"
    if name != TOTAL_MASS:
        return told
    bodies = next((one.path for one in search.designs if one.path.startswith("bodies.")), "")
    return f"{told}; it is the mass of the structure without bodies" + (
        f". The path '{bodies}' can be a goal" if bodies else ""
    )
