"""Cross-sections of bars as they are written."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Tag

from femstruct.language.yaml.checker import Checker
from femstruct.language.yaml.reader import Steps
from femstruct.language.yaml.spec import Factor, Length, Quantity, Spec
from femstruct.model import section
from femstruct.model.section import Section

Area = Annotated[float, Quantity(("area",), above=0.0)]
SecondMoment = Annotated[float, Quantity(("second moment",), above=0.0)]


class RectangleSpec(Spec):
    """A solid rectangle: width along local y, height along local z."""

    shape: Literal["rectangle"]
    width: Length
    height: Length

    def build(self, name: str) -> Section:
        return section.rectangle(name, self.width, self.height)


class CircleSpec(Spec):
    """A solid circle."""

    shape: Literal["circle"]
    diameter: Length

    def build(self, name: str) -> Section:
        return section.circle(name, self.diameter)


class TubeSpec(Spec):
    """A round tube of an outer diameter and a wall thickness."""

    shape: Literal["tube"]
    outer: Length
    thickness: Length

    def build(self, name: str) -> Section:
        return section.tube(name, self.outer, self.thickness)


class BoxSpec(Spec):
    """A rectangular box of even wall thickness; outer sides."""

    shape: Literal["box"]
    width: Length
    height: Length
    thickness: Length

    def build(self, name: str) -> Section:
        return section.box(name, self.width, self.height, self.thickness)


class ISpec(Spec):
    """An I: flanges along local y, web along local z; thicknesses of web and flange."""

    shape: Literal["I"]
    width: Length
    height: Length
    web: Length
    flange: Length

    def build(self, name: str) -> Section:
        return section.i_section(name, self.width, self.height, self.web, self.flange)


class ConstantsSpec(Spec):
    """A cross-section by its constants; shear coefficients 5/6 unless given."""

    A: Area
    Iy: SecondMoment
    Iz: SecondMoment
    J: SecondMoment
    ky: Factor = 5.0 / 6.0
    kz: Factor = 5.0 / 6.0

    def build(self, name: str) -> Section:
        return Section(name, self.A, self.Iy, self.Iz, self.J, self.ky, self.kz)


def _shape(value: Any) -> Any:
    return value.get("shape", "given") if isinstance(value, dict) else "given"


SectionSpec = Annotated[
    Annotated[RectangleSpec, Tag("rectangle")]
    | Annotated[CircleSpec, Tag("circle")]
    | Annotated[TubeSpec, Tag("tube")]
    | Annotated[BoxSpec, Tag("box")]
    | Annotated[ISpec, Tag("I")]
    | Annotated[ConstantsSpec, Tag("given")],
    Discriminator(_shape),
]


def check_section(check: Checker, steps: Steps, given: object) -> None:
    """Note walls thicker than half of what they are the walls of."""
    if isinstance(given, ISpec):
        return
    thickness = getattr(given, "thickness", None)
    if thickness is not None:
        smallest = min(getattr(given, key) for key in ("outer", "width", "height") if hasattr(given, key))
        if not 2 * thickness < smallest:
            check.wrong((*steps, "thickness"), f"{thickness:g} m", f"less than half of {smallest:g} m")
