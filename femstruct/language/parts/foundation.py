"""Winkler foundations as they are written."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from femstruct.language.model.like import entry_for, need_losses, told_of
from femstruct.language.model.material import Losses
from femstruct.language.model.region import Region, RegionSpec
from femstruct.language.parts.part import PartSpec
from femstruct.language.yaml import Here, Measured, Quantity, Refers, Spec, Text
from femstruct.model.library.all_entries import library
from femstruct.model.library.library_entry import Use
from femstruct.model.region import Touched
from femstruct.parts.foundation import Foundation

Spread = Annotated[Measured, Quantity(("stiffness/area", "stiffness/length"), least=0.0, which=True)]
Solid = Annotated[Text, Refers("plate, slab or block")]


class SpreadSpec(Spec):
    """Stiffness of a foundation: per area of a whole or rectangle region, per length of a rim or line."""

    short = "normal"
    normal: Spread
    shear: Spread = Measured(0.0, None)


class FoundationSpec(PartSpec):
    """A Winkler foundation: of a plate, slab or block to the ground, or between the facing sides of two of them. like:
    a resilient layer of the library, by its stiffness per area.

    It acts on the faces that it touches, its shear with the arms of them. On the ground that is the lower face, along
    lines and rims, too; side: above for that of a plate or slab, x, -x, y or -y for the side of a wall that faces
    there, middle for the mid-surface, where its shear has no arm."""

    one_of = (("on", "between"), ("stiffness", "like"))

    makes = Foundation
    type: Literal["foundation"]
    on: Solid | None = None
    between: tuple[Solid, Solid] | None = Field(default=None, description="two parts whose facing sides it joins")
    side: Touched = "below"
    region: Region = RegionSpec()
    stiffness: SpreadSpec | None = None
    like: Annotated[Text | None, entry_for(Use.LAYER, "a resilient layer of the library", "layer")] = None
    loss_factor: Losses = 0.0

    def check(self, here: Here) -> None:
        on, to = self.between or (self.on, None)
        here.at("between").need(on != to, f"'{on}' twice", "two different parts")
        between = self.between is not None and "side" in self.model_fields_set
        here.at("side").need(not between, "a side beside 'between'", "none: it joins the sides that face each other")
        along, there = self.region.is_line, here.at("stiffness")
        if self.stiffness is None:
            got = f"{self.like}, whose stiffness is per area, on a rim or a line"
            here.at("like").need(not along, got, "a whole or rectangle region", "write 'stiffness', per length")
            return
        right, unit = ("stiffness/area", "N/m^3 (per area)")
        if along:
            right, unit = ("stiffness/length", "N/m^2 (per length of a rim or line)")
        for key, one in self.stiffness.given().items():
            there.at(key).need(
                one.dimension in (None, right),
                f"a stiffness in {'N/m^3' if along else 'N/m^2'}",
                unit,
                "match the unit to the region",
            )
        there.need(
            any(one.value for one in self.stiffness.given().values()),
            "no stiffness at all",
            "a positive normal or shear stiffness",
        )

    def check_losses(self, here: Here) -> None:
        need_losses(here, self.like, "loss_factor" in self.model_fields_set)

    def given(self) -> dict[str, Any]:
        values = super().given()
        on, to = values.pop("between") or (values["on"], None)
        written = values.pop("stiffness")
        spread = {"normal": library()[values["like"]].number("stiffness_per_area")} if values["like"] else {}
        spread |= {key: one.value for key, one in (written or {}).items()}
        return {**values, **spread, "on": on, "to": to, "like": told_of(values["like"])}
