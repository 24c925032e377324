"""Rigid blocks as they are written."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Literal

from femstruct.language.parts.part import FLOOR, PartSpec, Places, check_coordinates
from femstruct.language.yaml import Here, Length, MassKg, Position3, Quantity
from femstruct.parts.block import Block

Inertia = Annotated[float, Quantity(("inertia",), above=0.0)]


class BlockSpec(PartSpec):
    """A rigid body: a box along the global axes from its lower corner; center and inertia where it is not uniform."""

    makes = Block
    known_as = ("part", "plate, slab or block", FLOOR)
    type: Literal["block"]
    mass: MassKg
    origin: Position3
    size: tuple[Length, Length, Length]
    center: Position3 | None = None
    inertia: tuple[Inertia, Inertia, Inertia] | None = None

    def check_place(self, here: Here, places: Places) -> None:
        if isinstance(places, tuple):
            check_coordinates(here, places, "block", self.size, "from its lower corner")

    @property
    def named_places(self) -> Mapping[str, tuple[float, ...]]:
        a, b, c = self.size
        return {word: (a / 2, b / 2, z) for word, z in (("bottom", 0.0), ("center", c / 2), ("top", c))}
