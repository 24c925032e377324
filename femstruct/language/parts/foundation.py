"""Winkler foundations as they are written."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from femstruct.language.model.material import Losses
from femstruct.language.model.region import Region, RegionSpec
from femstruct.language.parts.part import PartSpec
from femstruct.language.yaml import Here, Measured, Quantity, Refers, Spec, Text
from femstruct.parts.foundation import Foundation

Spread = Annotated[Measured, Quantity(("stiffness/area", "stiffness/length"), least=0.0, which=True)]
Solid = Annotated[Text, Refers("plate, slab or block")]


class SpreadSpec(Spec):
    """Stiffness of a foundation: per area of a whole or rectangle region, per length of a rim or line."""

    normal: Spread
    shear: Spread = Measured(0.0, None)


class FoundationSpec(PartSpec):
    """A Winkler foundation: of a plate, slab or block to the ground, or between the facing sides of two of them."""

    one_of = (("on", "between"),)

    makes = Foundation
    type: Literal["foundation"]
    on: Solid | None = None
    between: tuple[Solid, Solid] | None = None
    region: Region = RegionSpec()
    stiffness: SpreadSpec
    loss_factor: Losses = 0.0

    def check(self, here: Here) -> None:
        on, to = self.between or (self.on, None)
        here.at("between").need(on != to, f"'{on}' twice", "two different parts")
        along, there = self.region.is_line, here.at("stiffness")
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

    def given(self) -> dict[str, Any]:
        values = super().given()
        on, to = values.pop("between") or (values["on"], None)
        spread = {key: one.value for key, one in values.pop("stiffness").items()}
        return {**values, **spread, "on": on, "to": to}
