"""How many hangers a ceiling has and what each of them carries in the mean: what `check` tells of them."""

from __future__ import annotations

from typing import Any

from femstruct.conventions import GRAVITY
from femstruct.model.facts import part_masses
from femstruct.model.library.all_entries import library
from femstruct.model.model import Model
from femstruct.parts.hangers import Hangers


def hung(model: Model) -> dict[str, dict[str, Any]]:
    """Of all hangers one by one, by name: the ceiling, how many there are, and the mean load of each [N].

    mean_load_n : of the ceiling alone, shared by all hangers that it has. largest_load_n : what the library recommends
    at most; None where the hangers are not of it.
    """
    counts = {one.name: len(one.places) for one in model.elastics}
    pieces = [part for part in model.structure.parts if isinstance(part, Hangers) and part.per == "piece"]
    masses, found = part_masses(model), {}
    for part in pieces:
        together = sum(counts[other.name] for other in pieces if other.to == part.to)
        entry = library().get(part.like.partition(": ")[0])  # the rest is its source
        found[part.name] = {
            "ceiling": part.to,
            "count": counts[part.name],
            "mean_load_n": masses.get(part.to, 0.0) * GRAVITY / together,
            "largest_load_n": None if entry is None else entry.number("load"),
        }
    return found
