"""Plates as they are written."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from femstruct.language.parts.base import Library, PartSpec, Places, Surroundings, check_coordinates
from femstruct.language.yaml.checker import Checker
from femstruct.language.yaml.reader import Steps
from femstruct.language.yaml.spec import Count, Direction3, Length, Position3, Quantity, Text, read_by, refuse
from femstruct.parts.plate import Plate
from femstruct.units import shown_as


def _mesh(value: object) -> object:
    """A largest element side, or the least numbers of divisions."""
    if isinstance(value, list):
        if len(value) == 2 and all(isinstance(n, int) and not isinstance(n, bool) and 0 < n <= 2000 for n in value):
            return (value[0], value[1])
        raise refuse(shown_as(value), "two whole numbers of divisions from 1 to 2000", "write [16, 16] or 30 mm")
    return Quantity(("length",), above=0.0).read(value)


Mesh = Annotated[float | tuple[int, int], read_by(_mesh, Length | tuple[Count, Count])]


class PlateSpec(PartSpec):
    """A flat rectangular plate; origin is a corner of its mid-surface."""

    type: Literal["plate"]
    material: Text
    thickness: Length
    element: Literal["hermite12", "acm12", "bfs16"] = "bfs16"
    origin: Position3
    size: tuple[Length, Length]
    mesh: Mesh
    normal: Direction3 = (0.0, 0.0, 1.0)
    x_direction: Direction3 | None = None

    has_nodes: ClassVar[bool] = True
    has_faces: ClassVar[bool] = True
    has_edges: ClassVar[bool] = True
    is_lined: ClassVar[bool] = True

    def check(self, steps: Steps, around: Surroundings) -> None:
        around.check.known((*steps, "material"), self.material, "material", around.materials)

    def check_place(self, steps: Steps, places: Places, check: Checker) -> None:
        if isinstance(places, tuple):
            check_coordinates(steps, places, "plate", self.size, "", check)
        elif places != "center":
            check.wrong(steps, f"{places} of a plate", "center or [x, y]", "write center")

    def place(self, word: str) -> tuple[float, ...]:
        return self.size[0] / 2, self.size[1] / 2

    def build(self, name: str, of: Library) -> Plate:
        return Plate(
            name,
            of.materials[self.material],
            self.thickness,
            self.origin,
            self.size,
            self.mesh,
            self.element,
            self.normal,
            self.x_direction,
        )
