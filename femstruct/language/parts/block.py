"""Rigid blocks as they are written."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from femstruct.language.parts.base import Library, PartSpec, Places, check_coordinates
from femstruct.language.yaml.checker import Checker
from femstruct.language.yaml.reader import Steps
from femstruct.language.yaml.spec import Length, MassKg, Position3, Quantity
from femstruct.parts.block import Block

Inertia = Annotated[float, Quantity(("inertia",), above=0.0)]


class BlockSpec(PartSpec):
    """A rigid body: a box along the global axes from its lower corner; center and inertia where it is not uniform."""

    type: Literal["block"]
    mass: MassKg
    origin: Position3
    size: tuple[Length, Length, Length]
    center: Position3 | None = None
    inertia: tuple[Inertia, Inertia, Inertia] | None = None

    has_nodes: ClassVar[bool] = True
    has_faces: ClassVar[bool] = True

    def check_place(self, steps: Steps, places: Places, check: Checker) -> None:
        if isinstance(places, tuple):
            check_coordinates(steps, places, "block", self.size, "from its lower corner", check)

    def place(self, word: str) -> tuple[float, ...]:
        a, b, c = self.size
        return a / 2, b / 2, {"bottom": 0.0, "top": c}.get(word, c / 2)

    def build(self, name: str, of: Library) -> Block:
        return Block(name, self.mass, self.origin, self.size, self.center, self.inertia)
