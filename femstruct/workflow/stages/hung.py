"""How many hangers a ceiling has and what each of them carries in the mean: what `check` and findings tell of them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Final

import numpy as np

from femstruct.conventions import GRAVITY
from femstruct.errors import Finding
from femstruct.model.library.all_entries import library
from femstruct.model.library.library_entry import Entry
from femstruct.model.model import Model
from femstruct.parts.findings.connections import pieces
from femstruct.parts.hangers import Hangers

ALLOWED: Final = 1.0  # of the largest load that the maker of a hanger recommends
_WHOLE: Final = 1.0 - 1e-9  # of a shift that nothing resists


def hung(model: Model) -> dict[str, dict[str, Any]]:
    """Of all hangers one by one, by name: the ceiling, how many there are, and the mean load of each [N].

    mean_load_n : of all that hangs on the ceiling, shared by all hangers that it has; None where other parts or
    supports carry it, too. largest_load_n : what the library recommends at most; None where the hangers are not of it.
    """
    counts = {one.name: len(one.places) for one in model.elastics}
    singles = _singles(model)
    carried = {ceiling: _carried(model, ceiling) for ceiling in {part.to for part in singles}}
    found = {}
    for part in singles:
        together = sum(counts[other.name] for other in singles if other.to == part.to)
        entry, mass = _entry(part), carried[part.to]
        found[part.name] = {
            "ceiling": part.to,
            "count": counts[part.name],
            "mean_load_n": None if mass is None else mass * GRAVITY / together,
            "largest_load_n": None if entry is None else entry.number("load"),
        }
    return found


def hanger_findings(model: Model) -> tuple[Finding, ...]:
    """Hangers of the library whose mean load is more than their maker recommends."""
    entries, told = {part.name: _entry(part) for part in _singles(model)}, []
    for name, one in hung(model).items():
        entry, load, most = entries[name], one["mean_load_n"], one["largest_load_n"]
        if entry is None or load is None or most is None or load <= ALLOWED * most:
            continue
        fact = entry.fact("load")
        assert fact is not None, "a number has its fact"
        count = one["count"]
        needed = int(np.ceil(count * load / (ALLOWED * most)))
        told.append(
            Finding(
                "hangers-overloaded",
                f"{name}: each of the {count} hangers carries {load:.4g} N of {one['ceiling']} in the mean, and "
                f"{most:.4g} N are the most for {entry.name} ({fact.source.work}). At least {needed} of them, or "
                "stronger ones, are needed",
                {"mean_load_n": load, "largest_load_n": most, "hangers": count},
            )
        )
    return tuple(told)


def _singles(model: Model) -> list[Hangers]:
    return [part for part in model.structure.parts if isinstance(part, Hangers) and part.per == "piece"]


def _entry(part: Hangers) -> Entry | None:
    return library().get(part.like.partition(": ")[0])  # the rest is its source


def _carried(model: Model, ceiling: str) -> float | None:
    """The mass of all that hangs on a ceiling [kg]; None where something else than its hangers resists its fall."""
    own = {part.name for part in _singles(model) if part.to == ceiling}
    loose = replace(model, elastics=tuple(one for one in model.elastics if one.name not in own))
    piece = next(one for one in pieces(loose) if ceiling in one.parts)
    alone = not any(part.on in piece.parts for part in _singles(model) if part.to == ceiling)
    return piece.mass if alone and np.linalg.norm(piece.free[:, 2]) >= _WHOLE else None
