"""Plates as they are written."""

from __future__ import annotations

from typing import Annotated, Literal

from femstruct.elements.plate import PlateElement
from femstruct.language.parts.part import MaterialName, PartSpec, Places, check_coordinates
from femstruct.language.yaml import LENGTH, Count, Direction3, Here, Length, Position3, read_by, refuse
from femstruct.parts.plate import Plate
from femstruct.units import shown_as


def _mesh(value: object) -> object:
    """A largest element side, or the least numbers of divisions."""
    if isinstance(value, list):
        if len(value) == 2 and all(isinstance(n, int) and not isinstance(n, bool) and 0 < n <= 2000 for n in value):
            return (value[0], value[1])
        raise refuse(shown_as(value), "two whole numbers of divisions from 1 to 2000", "write [16, 16] or 30 mm")
    return LENGTH.read(value)


class PlateSpec(PartSpec):
    """A flat rectangular plate; origin is a corner of its mid-surface."""

    makes = Plate
    known_as = ("part", "plate", "plate or block", "plate or frame")
    type: Literal["plate"]
    material: MaterialName
    thickness: Length
    element: PlateElement = "bfs16"
    origin: Position3
    size: tuple[Length, Length]
    mesh: Annotated[float | tuple[int, int], read_by(_mesh, Length | tuple[Count, Count])]
    normal: Direction3 = (0.0, 0.0, 1.0)
    x_direction: Direction3 | None = None

    def check_place(self, here: Here, places: Places) -> None:
        if isinstance(places, tuple):
            check_coordinates(here, places, "plate", self.size, "")
        else:
            here.need(places == "center", f"{places} of a plate", "center or [x, y]", "write center")

    def place(self, word: str) -> tuple[float, ...]:
        return self.size[0] / 2, self.size[1] / 2
