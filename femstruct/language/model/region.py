"""Regions of a plate as they are written."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from femstruct.language.yaml import Length, Position2, Spec, exactly_one, read_by, refuse
from femstruct.model import region
from femstruct.units import shown_as


class RegionSpec(Spec):
    """A region of a plate: nothing for all of it, the rim of a rectangle, a rectangle, or a line."""

    makes = region.Region
    rim: tuple[Length, Length] | None = None
    rectangle: tuple[Length, Length] | None = None
    line: tuple[Position2, Position2] | None = None
    at: Position2 | None = None

    @property
    def is_line(self) -> bool:
        """Whether it is a line or a rim, not an area."""
        return self.rim is not None or self.line is not None

    def given(self) -> dict[str, Any]:
        kind = next((key for key in ("line", "rim", "rectangle") if getattr(self, key) is not None), "whole")
        size = self.rim or self.rectangle
        return {"kind": kind, "size": size, "at": self.at if size else None, "line": self.line}


def _region(value: object) -> object:
    if value == "whole":
        return {}
    if not isinstance(value, dict):
        raise refuse(shown_as(value), "whole, {rim: [..]}, {rectangle: [..]} or {line: [[..], [..]]}")
    if value.keys() <= {"rim", "rectangle", "line", "at"}:
        exactly_one(value, ("rim", "rectangle", "line"))
    return value


Region = Annotated[RegionSpec, read_by(_region, Literal["whole"] | RegionSpec)]
