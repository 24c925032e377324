"""Masses as they are written."""

from __future__ import annotations

from typing import Annotated, Literal

from femstruct.language.parts.base import Library, PartSpec, Surroundings
from femstruct.language.regions import Region
from femstruct.language.yaml.reader import Steps
from femstruct.language.yaml.spec import Measured, Quantity, Text
from femstruct.model import region
from femstruct.parts.mass import Mass, Per

AnyMass = Annotated[Measured, Quantity(("mass", "mass/length", "mass/area"), above=0.0, which=True)]
PER: dict[str, Per] = {"mass/length": "length", "mass/area": "area"}


class MassSpec(PartSpec):
    """A mass at the places of a point (kg each), over a region of a plate (kg, kg/m, kg/m^2), or along a frame."""

    type: Literal["mass"]
    mass: AnyMass
    at: Text | None = None
    on: Text | None = None
    region: Region | None = None

    def check(self, steps: Steps, around: Surroundings) -> None:
        check = around.check
        if (self.at is None) == (self.on is None):
            check.wrong(
                steps, "both 'at' and 'on'" if self.at else "no place", "one of at: POINT and on: PART", of_key=True
            )
            return
        under = around.parts.get(self.on or "")
        frame = under is not None and under.is_lined and not under.has_edges
        along = frame or (self.region is not None and (self.region.is_line))
        allowed = ("mass",) if self.at is not None else ("mass", "mass/length") if along else ("mass", "mass/area")
        if self.mass.dimension not in (None, *allowed):
            units = {"mass": "kg", "mass/length": "kg/m", "mass/area": "kg/m^2"}
            got = f"a mass in {units[self.mass.dimension or 'mass']}"
            where = (
                "at a point"
                if self.at is not None
                else "along a frame"
                if frame
                else "along a rim or line"
                if along
                else "over an area"
            )
            check.wrong((*steps, "mass"), f"{got} {where}", " or ".join(units[one] for one in allowed))
        if self.at is not None:
            check.known((*steps, "at"), self.at, "point", around.points)
            if self.region is not None:
                check.wrong(
                    (*steps, "region"), "a region at a point", "a region on a part", "use on: PART", of_key=True
                )
        elif self.on is not None:
            check.known((*steps, "on"), self.on, "plate or frame", around.named("is_lined"))
            if frame and self.region is not None:
                check.wrong(
                    (*steps, "region"), "a region of a frame", "all of the frame", "remove 'region'", of_key=True
                )

    def build(self, name: str, of: Library) -> Mass:
        if self.at is not None:
            return Mass(name, self.mass.value, at=self.at)
        per = PER.get(self.mass.dimension or "mass", "total")
        area = self.region.build() if self.region is not None else region.Region("whole")
        return Mass(name, self.mass.value, on=self.on, region=area, per=per)
