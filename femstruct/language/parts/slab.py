"""Slabs as they are written."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from femstruct.errors import shown_as
from femstruct.language.model.lay_up import DeckSpec
from femstruct.language.parts.part import CEILING, FLOOR, MESHED, STRESSED, Places
from femstruct.language.yaml import (
    CELL,
    CellSide,
    Coordinate,
    Direction3,
    Here,
    Length,
    Position2,
    Position3,
    Spec,
    read_by,
    refuse,
)
from femstruct.parts.slab import Slab


class HoleSpec(Spec):
    """A rectangular opening: its sides, and its middle in the coordinates of the outline."""

    rectangle: tuple[Length, Length]
    at: Position2


def _cells(value: object) -> object:
    if isinstance(value, list):
        raise refuse(shown_as(value), "a largest side of its elements", "write it like 200 mm")
    return CELL.read(value)


class SlabSpec(DeckSpec):
    """A flat slab. outline: corners in turn, sides along x or y; holes: rectangular openings; mesh: largest element
    side; through: places that get a node. It has the sets rim, side 1, .., hole 1, ..."""

    makes = Slab
    known_as = ("part", "plate or shell", "plate or frame", "plate, slab or block", MESHED, STRESSED, FLOOR, CEILING)
    instead = (
        *DeckSpec.instead,
        ("size", "outline", "for a rectangle of 5 m by 4 m write outline: [[0, 0], [5, 0], [5, 4], [0, 4]]"),
    )
    type: Literal["slab"]
    outline: Annotated[list[Position2], Field(min_length=4)]
    mesh: Annotated[float, read_by(_cells, CellSide), Field(description="largest side of an element [m]")]
    holes: list[HoleSpec] = Field(default_factory=list)
    through: list[Position2] = Field(default_factory=list)
    origin: Position3 = (0.0, 0.0, 0.0)
    normal: Direction3 = (0.0, 0.0, 1.0)
    x_direction: Direction3 | None = None
    offset: Coordinate = 0.0

    def check_place(self, here: Here, places: Places) -> None:
        if isinstance(places, str):
            middle = [(min(along) + max(along)) / 2 for along in zip(*self.outline, strict=True)]
            do = f"use the coordinates of its outline, whose middle is [{middle[0]:g}, {middle[1]:g}]"
            here.wrong(f"{places} of a slab", "[x, y]", do)
        elif any(len(place) != 2 for place in places):
            here.wrong(f"{len(places[0])} coordinates", "2 on a slab", "use the coordinates of its outline")

    def given(self) -> dict[str, Any]:
        holes = tuple((one.rectangle, one.at) for one in self.holes)
        return {**super().given(), "holes": holes, "outline": tuple(self.outline), "through": tuple(self.through)}
