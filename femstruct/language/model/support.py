"""Supports as they are written."""

from __future__ import annotations

from typing import Annotated, Any, Literal, get_args

from femstruct.conventions import DIRECTIONS
from femstruct.errors import shown_as
from femstruct.language.parts.part import MESHED
from femstruct.language.yaml import Here, PointName, Position2, Position3, Refers, Spec, Text, only, read_by, refuse
from femstruct.model.region import Region
from femstruct.model.structure import Edge, Fix, Support


def _fix(value: object) -> object:
    if isinstance(value, str) and value in get_args(Fix):
        return value
    if isinstance(value, list) and value:
        return tuple(only(DIRECTIONS)(one) for one in value)
    raise refuse(shown_as(value), "simple, roller, clamped or a list of x, y, z, rx, ry, rz", "write it like [z, rx]")


class SupportSpec(Spec):
    """Held directions of an edge or line of a plate (a line: a wall under it), of a set or a box of a part that is a
    mesh, of a point, or of a whole part."""

    one_of = (("on", "at"),)
    at_most_one_of = (("edge", "line", "set", "box"),)

    makes = Support
    fix: Annotated[Fix | tuple[str, ...], read_by(_fix, Fix | list[Literal["x", "y", "z", "rx", "ry", "rz"]])]
    on: Annotated[Text, Refers()] | None = None
    edge: Edge | None = None
    line: tuple[Position2, Position2] | None = None
    at: PointName | None = None
    set: Text | None = None
    box: tuple[Position3, Position3] | None = None

    def check(self, here: Here) -> None:
        along = self.edge is not None or self.line is not None
        among = self.set is not None or self.box is not None
        if self.on is None:
            got = "a set or a box of a point" if among else "an edge or line of a point"
            here.need(not along and not among, got, "only a point, or 'on: PART' with an edge")
            return
        if along and self.on in here.names.known[MESHED]:
            do = "of a slab write 'set: rim' or 'set: side 1', of another mesh a set or a box of it"
            here.at("on").wrong(f"'{self.on}'", "the name of a plate", do)
            return
        here.at("on").known(self.on, "plate" if along else MESHED if among else "part")
        here.at("fix").need(
            along or self.fix != "roller", "a roller that is no edge or line", "directions", "write [z]"
        )
        here.at("fix").need(
            along or among or isinstance(self.fix, tuple),
            f"'{self.fix}' for a whole part",
            "an edge, a line or directions",
            "add edge: all, or list the directions as in [x, y]",
        )

    def given(self) -> dict[str, Any]:
        values = super().given()
        named, box = values.pop("set"), values.pop("box")
        if named is not None or box is not None:
            values["region"] = Region("box" if named is None else "set", named=named, box=box)
        return values
