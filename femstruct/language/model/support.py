"""Supports as they are written."""

from __future__ import annotations

from typing import Annotated, Literal, get_args

from femstruct.conventions import DIRECTIONS
from femstruct.language.yaml import Here, PointName, Position2, Refers, Spec, Text, only, read_by, refuse
from femstruct.model.structure import Edge, Fix, Support
from femstruct.units import shown_as


def _fix(value: object) -> object:
    if isinstance(value, str) and value in get_args(Fix):
        return value
    if isinstance(value, list) and value:
        return tuple(only(DIRECTIONS)(one) for one in value)
    raise refuse(shown_as(value), "simple, clamped or a list of x, y, z, rx, ry, rz", "write it like [z, rx]")


class SupportSpec(Spec):
    """Held directions of an edge or line of a plate (a line: a wall under it), of a point, or of a whole part."""

    one_of = (("on", "at"),)
    at_most_one_of = (("edge", "line"),)

    makes = Support
    fix: Annotated[Fix | tuple[str, ...], read_by(_fix, Fix | list[Literal["x", "y", "z", "rx", "ry", "rz"]])]
    on: Annotated[Text, Refers()] | None = None
    edge: Edge | None = None
    line: tuple[Position2, Position2] | None = None
    at: PointName | None = None

    def check(self, here: Here) -> None:
        along = self.edge is not None or self.line is not None
        if self.on is None:
            here.need(not along, "an edge or line of a point", "only a point, or 'on: PART' with an edge")
            return
        here.at("on").known(self.on, "plate" if along else "part")
        here.at("fix").need(
            along or isinstance(self.fix, tuple),
            f"'{self.fix}' for a whole part",
            "an edge, a line or directions",
            "add edge: all, or list the directions as in [x, y]",
        )
