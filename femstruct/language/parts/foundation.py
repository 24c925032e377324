"""Winkler foundations as they are written."""

from __future__ import annotations

from typing import Annotated, Literal

from femstruct.language.parts.base import Library, PartSpec, Surroundings
from femstruct.language.regions import Region, RegionSpec
from femstruct.language.yaml.checker import Checker
from femstruct.language.yaml.reader import Steps
from femstruct.language.yaml.spec import MaterialLossFactor, Measured, Quantity, Spec, Text
from femstruct.parts.foundation import Foundation

Spread = Annotated[Measured, Quantity(("stiffness/area", "stiffness/length"), least=0.0, which=True)]


class SpreadSpec(Spec):
    """Stiffness of a foundation: per area of a whole or rectangle region, per length of a rim or line."""

    normal: Spread
    shear: Spread = Measured(0.0, None)


class FoundationSpec(PartSpec):
    """A Winkler foundation: of a plate or block to the ground, or between the facing sides of two of them."""

    one_of = (("on", "between"),)

    type: Literal["foundation"]
    on: Text | None = None
    between: tuple[Text, Text] | None = None
    region: Region = RegionSpec()
    stiffness: SpreadSpec
    loss_factor: MaterialLossFactor = 0.0

    def check(self, steps: Steps, around: Surroundings) -> None:
        if self._check_ends(steps, around.check, around.named("has_faces")):
            self._check_spread(steps, around.check)

    def _check_ends(self, steps: Steps, check: Checker, solid: list[str]) -> bool:
        """Whether a foundation is on plates and blocks that are there."""
        if self.between is None:
            return check.known((*steps, "on"), self.on or "", "plate or block", solid)
        good = [
            check.known((*steps, "between", i), name, "plate or block", solid) for i, name in enumerate(self.between)
        ]
        if all(good) and self.between[0] == self.between[1]:
            check.wrong((*steps, "between"), f"'{self.between[0]}' twice", "two different parts")
            return False
        return all(good)

    def _check_spread(self, steps: Steps, check: Checker) -> None:
        along = self.region.is_line
        right = "stiffness/length" if along else "stiffness/area"
        unit = "N/m^2 (per length of a rim or line)" if along else "N/m^3 (per area)"
        for key in ("normal", "shear"):
            measured = getattr(self.stiffness, key)
            if measured.dimension not in (None, right):
                other = "N/m^3" if along else "N/m^2"
                check.wrong((*steps, "stiffness", key), f"a stiffness in {other}", unit, "match the unit to the region")
        if not (self.stiffness.normal.value or self.stiffness.shear.value):
            check.wrong((*steps, "stiffness"), "no stiffness at all", "a positive normal or shear stiffness")

    def build(self, name: str, of: Library) -> Foundation:
        normal, shear = self.stiffness.normal.value, self.stiffness.shear.value
        on, to = self.between or (self.on or "", None)
        return Foundation(name, on, self.region.build(), normal, shear, self.loss_factor, to)
