"""Arrays of bodies: a body at a point of several places is one body each, with its contacts and links.

A standard source is one body, whose places are struck one after the other: one simulation for each.
"""

from __future__ import annotations

from collections.abc import Mapping

from femstruct.impact.scene.impact_sources import DROPPED, HAMMERS, TAPPING_MACHINE
from femstruct.language.study.body import BodySpec
from femstruct.language.yaml import Names, members


def array_sizes(bodies: Mapping[str, BodySpec], names: Names) -> dict[str, int]:
    """How many each body of an array is: at a point of several places, or on another array; a tapping machine's
    hammers are five at whatever multiple of five places."""
    sizes: dict[str, int] = {}
    for _ in bodies:  # each round finds what lies on what the last one found
        for name, body in bodies.items():
            count = sizes.get(body.target, names.points.get(body.target, 1))
            if body.source == TAPPING_MACHINE and not count % HAMMERS:
                count = HAMMERS
            if count > 1 and not (body.source in DROPPED and body.target in names.points):
                sizes[name] = count
    return sizes


def drop_counts(bodies: Mapping[str, BodySpec], names: Names) -> dict[str, int]:
    """How many places each standard source of several is to strike: those of a point, five for a tapping machine."""
    at_once = dict.fromkeys(DROPPED, 1) | {TAPPING_MACHINE: HAMMERS}
    sources = {name: body for name, body in bodies.items() if body.source in at_once}
    counts = {name: names.points.get(one.target, 1) // at_once[one.source or ""] for name, one in sources.items()}
    return {name: count for name, count in counts.items() if count > 1}


def joined(ends: tuple[str, str], sizes: Mapping[str, int], names: Names) -> list[int]:
    """How many places each end stands for: [] unless an array of bodies is one of them."""
    if not any(end in sizes for end in ends):
        return []
    return [sizes.get(end, names.points.get(end, 1)) for end in ends]


def bodies_of(sizes: Mapping[str, int]) -> list[str]:
    """The names of all bodies of arrays.

    >>> bodies_of({"damper": 2})
    ['damper.1', 'damper.2']
    """
    return [one for name, size in sizes.items() for one in members(name, size)]
