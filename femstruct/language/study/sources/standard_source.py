"""Standard sources in a study file: `source: rubber ball` is a body of the standard's mass, drop height and law."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any, Final

from femstruct.impact.scene.impact_sources import (
    BANG_MACHINE,
    BETWEEN_BLOWS,
    DROPPED,
    HAMMER_DROP,
    HAMMER_MASS,
    HAMMERS,
    RUBBER_BALL,
    TAPPING_MACHINE,
)
from femstruct.language.yaml import refuse

SOURCES: Final = (*DROPPED, TAPPING_MACHINE)
UNCORRELATED: Final = "uncorrelated"
SCATTERED: Final = "scattered"


def refuse_beside_source(body: Mapping[str, Any], of_blows: Collection[str]) -> None:
    """Refuse keys that a `source` brings itself, and a tapping machine without a law or whose hammers strike at given
    times. of_blows : the keys that blows can have."""
    name = str(body["source"])
    tapping = name == TAPPING_MACHINE
    brought = ["mass", "drop_height", "speed", "below", "before", "after"] + ([] if tapping else ["contact"])
    given = [key for key in brought if key in body]
    if given:
        told = "is above a place" if given[0] in ("below", "before", "after") else f"has its own {_WORDS[given[0]]}"
        raise refuse(f"'{given[0]}' with a {name}", f"only a source: it {told}", f"remove '{given[0]}', or 'source'")
    if tapping and "contact" not in body:
        raise refuse(
            "a tapping machine without a contact",
            "the law between its hammers and this floor",
            "add 'contact: {type: hertz, radius: 0.5 m, E: [210 GPa, ...], nu: [0.3, ...]}'",
        )
    blows = body.get("blows")
    if tapping and isinstance(blows, Mapping) and set(blows) <= set(of_blows):
        _refuse_blows(blows)


def _refuse_blows(blows: Mapping[str, Any]) -> None:
    given = [key for key in ("every", "first") if key in blows]
    if given:
        raise refuse(
            f"'blows.{given[0]}' of a tapping machine",
            f"only a count: every hammer strikes every {HAMMERS * BETWEEN_BLOWS:g} s, in turn",
            f"remove '{given[0]}'",
        )
    if blows.get("timing", UNCORRELATED) == UNCORRELATED and blows.get("count", 1) != 1:
        raise refuse(
            f"'blows.count' {blows['count']} of a tapping machine whose blows are uncorrelated",
            "no count: one blow of each hammer represents all",
            "remove 'count'; or add 'timing: regular', or scattered, for turns of blows 0.1 s apart",
        )


def from_source(body: Mapping[str, Any]) -> dict[str, Any]:
    """The keys of a body whose `source` is given, with those that the source brings; of one that is none, with those
    that any would bring, so that it is one mistake."""
    name = str(body["source"])
    if name not in SOURCES:
        turns = {"blows": _turns(body["blows"])} if "blows" in body else {}
        return {"mass": HAMMER_MASS, **body, **turns}
    if name != TAPPING_MACHINE:
        return {**body, **_dropped(name)}
    return {**body, "mass": HAMMER_MASS, "drop_height": HAMMER_DROP, "blows": _turns(body.get("blows", {}))}


def _turns(blows: Any) -> Any:
    """The blows of a hammer, with what the machine brings; as they are where they are no mapping."""
    if not isinstance(blows, Mapping):
        return blows
    return {"count": 1, "timing": UNCORRELATED, **blows, "every": HAMMERS * BETWEEN_BLOWS}


def turn(number: int, apart: float = BETWEEN_BLOWS) -> float:
    """When hammer `number`, from 1, strikes first [s].

    >>> turn(1), turn(3), turn(3, 0.4)
    (0.0, 0.2, 0.8)
    """
    return (number - 1) * apart


_WORDS: Final = {"mass": "mass", "drop_height": "drop height", "speed": "speed", "contact": "contact law"}


def _dropped(name: str) -> dict[str, Any]:
    pad, fist, source = RUBBER_BALL.law, BANG_MACHINE.law, DROPPED[name]
    curve = [list(pair) for pair in zip(pad.indentations.tolist(), pad.forces.tolist(), strict=True)]
    contacts = {
        "rubber ball": {"type": pad.word, "curve": curve, "dissipation": pad.dissipation, "smooth": pad.smooth},
        "bang machine": {"type": fist.word, "stiffness": fist.stiffness, "damping": fist.damping},
    }
    return {"mass": source.mass, "drop_height": source.drop_height, "contact": contacts[name]}
