"""Plates as they are written."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Literal

from pydantic import Field

from femstruct.elements.plate import PlateElement
from femstruct.errors import shown_as
from femstruct.language.model.lay_up import DeckSpec
from femstruct.language.parts.part import CEILING, FLOOR, STRESSED, Places, check_coordinates
from femstruct.language.yaml import CELL, CellSide, Count, Direction3, Here, Position3, SideLength, read_by, refuse
from femstruct.parts.plate import InPlane, Plate


def _mesh(value: object) -> object:
    """A largest element side, or the least numbers of divisions."""
    if isinstance(value, list):
        if len(value) == 2 and all(isinstance(n, int) and not isinstance(n, bool) and 0 < n <= 2000 for n in value):
            return (value[0], value[1])
        raise refuse(shown_as(value), "two whole numbers of divisions from 1 to 2000", "write [16, 16] or 30 mm")
    return CELL.read(value)


class PlateSpec(DeckSpec):
    """A flat rectangular plate of one material, of layers from below, or of smeared ribs; origin is a corner of its
    mid-surface."""

    makes = Plate
    known_as = ("part", "plate", "plate, slab or block", "plate or frame", "plate or shell", STRESSED, FLOOR, CEILING)
    type: Literal["plate"]
    element: PlateElement = "bfs16"
    origin: Position3
    size: tuple[SideLength, SideLength]
    mesh: Annotated[
        float | tuple[int, int],
        read_by(_mesh, CellSide | tuple[Count, Count]),
        Field(description="largest side of an element [m], or the least numbers of them along x and y"),
    ]
    normal: Direction3 = (0.0, 0.0, 1.0)
    x_direction: Direction3 | None = None
    in_plane: InPlane | None = None

    def check_place(self, here: Here, places: Places) -> None:
        if isinstance(places, tuple):
            check_coordinates(here, places, "plate", self.size, "")
        else:
            here.need(places == "center", f"{places} of a plate", "center or [x, y]", "write center")

    @property
    def named_places(self) -> Mapping[str, tuple[float, ...]]:
        return {"center": (self.size[0] / 2, self.size[1] / 2)}
