"""Masses as they are written."""

from __future__ import annotations

from typing import Annotated, Any, Final, Literal

from femstruct.language.model.region import Region
from femstruct.language.parts.part import PartSpec
from femstruct.language.yaml import Here, Measured, PointName, Quantity, Refers, Text
from femstruct.model import region
from femstruct.parts.mass import Mass

AnyMass = Annotated[Measured, Quantity(("mass", "mass/length", "mass/area"), above=0.0, which=True)]
PER: Final = {"mass/length": "length", "mass/area": "area"}
UNITS: Final = {"mass": "kg", "mass/length": "kg/m", "mass/area": "kg/m^2"}


class MassSpec(PartSpec):
    """A mass at the places of a point (kg each), over a region of a plate or shell (kg, kg/m, kg/m^2), or along a
    frame."""

    makes = Mass
    type: Literal["mass"]
    mass: AnyMass
    at: PointName | None = None
    on: Annotated[Text, Refers("plate or frame")] | None = None
    region: Region | None = None

    def check(self, here: Here) -> None:
        if not here.need(
            (self.at is None) != (self.on is None),
            "both 'at' and 'on'" if self.at else "no place",
            "one of at: POINT and on: PART",
            of_key=True,
        ):
            return
        known = here.names.known
        frame = self.on in known["plate or frame"] and self.on not in known["plate or shell"]
        where, allowed = "over an area", ["mass", "mass/area"]
        if self.at is not None:
            where, allowed = "at a point", ["mass"]
        elif frame or (self.region is not None and self.region.is_line):
            where, allowed = "along a frame" if frame else "along a rim or line", ["mass", "mass/length"]
        unit = UNITS[self.mass.dimension or "mass"]
        here.at("mass").need(
            self.mass.dimension in (None, *allowed),
            f"a mass in {unit} {where}",
            " or ".join(UNITS[one] for one in allowed),
        )
        there, whole = here.at("region"), self.region is None
        there.need(whole or self.at is None, "a region at a point", "a region on a part", "use on: PART", of_key=True)
        there.need(whole or not frame, "a region of a frame", "all of the frame", "remove 'region'", of_key=True)

    def given(self) -> dict[str, Any]:
        values, (mass, dimension) = super().given(), self.mass
        if self.at is not None:
            return {"mass": mass, "at": self.at}
        area = values["region"] or region.Region("whole")
        return {**values, "mass": mass, "region": area, "per": PER.get(dimension or "mass", "total")}
