"""Slabs as they are written."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from femstruct.language.model.lay_up import Layers, SmearedSpec, lay_up
from femstruct.language.parts.part import CEILING, FLOOR, MESHED, STRESSED, Library, MaterialName, PartSpec, Places
from femstruct.language.yaml import Coordinate, Direction3, Here, Length, Position2, Position3, Spec
from femstruct.model.part import Part
from femstruct.parts.slab import Slab


class HoleSpec(Spec):
    """A rectangular opening: its sides, and its middle in the coordinates of the outline."""

    rectangle: tuple[Length, Length]
    at: Position2


class SlabSpec(PartSpec):
    """A flat slab. outline: corners in turn, sides along x or y; holes: rectangular openings; mesh: largest element
    side; through: places that get a node. It has the sets rim, side 1, .., hole 1, ..."""

    makes = Slab
    one_of = (("material", "layers", "smeared"),)
    at_most_one_of = (("layers", "thickness"),)
    known_as = ("part", "plate or shell", "plate or frame", "plate, slab or block", MESHED, STRESSED, FLOOR, CEILING)
    type: Literal["slab"]
    material: MaterialName | None = None
    layers: Layers | None = None
    smeared: SmearedSpec | None = None
    thickness: Length | None = None
    outline: Annotated[list[Position2], Field(min_length=4)]
    mesh: Length
    holes: list[HoleSpec] = Field(default_factory=list)
    through: list[Position2] = Field(default_factory=list)
    origin: Position3 = (0.0, 0.0, 0.0)
    normal: Direction3 = (0.0, 0.0, 1.0)
    x_direction: Direction3 | None = None
    offset: Coordinate = 0.0

    def check(self, here: Here) -> None:
        there = here.at("thickness")
        there.need(self.layers or self.thickness, "nothing", "'thickness'", "add 'thickness: ...'", of_key=True)

    def check_place(self, here: Here, places: Places) -> None:
        if isinstance(places, str):
            here.wrong(f"{places} of a slab", "[x, y]", "use the coordinates of its outline")
        elif any(len(place) != 2 for place in places):
            here.wrong(f"{len(places[0])} coordinates", "2 on a slab", "use the coordinates of its outline")

    def given(self) -> dict[str, Any]:
        written = ("type", "layers", "smeared")
        values = {key: getattr(self, key) for key in type(self).model_fields if key not in written}
        values["holes"] = tuple((one.rectangle, one.at) for one in self.holes)
        return {**values, "outline": tuple(self.outline), "through": tuple(self.through)}

    def made_of(self, name: str, of: Library, **more: Any) -> Part:
        if self.material is not None:
            return super().made_of(name, of, **more)
        deck = lay_up(self.layers, self.smeared, self.thickness, of.materials)
        return super().made_of(name, of, material=deck, thickness=deck.thickness, **more)
