"""What every contact law of a study file has, and what it is given to become one.

A law is a module of this package with a `LawSpec` and nothing to enter anywhere else: the package finds it. d is the
indentation, d' its rate, positive while the ends approach.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Final

from pydantic import ValidationInfo, field_validator

from femstruct.errors import shown_as
from femstruct.impact.laws.law import Law
from femstruct.impact.scene.restitution import dissipation_for
from femstruct.language.yaml import Flag, Here, Quantity, Spec, refuse
from femstruct.units import QuantityError, power_stiffness

Positive = Annotated[float, Quantity(("stiffness",), above=0.0)]
_PERCENT: Final = "30 % is 0.3: did you mean {number:g} %?"
HARDLY: Final = "for one that hardly returns write 'restitution: 5 %'"
STAYS: Final = (
    "for a blow that gives nothing back write '{type: linear, stiffness: .., tensile: true, restitution: 0}'; "
    f"{HARDLY}"
)
Restitution = Annotated[float, Quantity(("ratio",), above=0.0, most=1.0, too_large=_PERCENT, at_limit=STAYS)]
AnyRestitution = Annotated[
    float, Quantity(("ratio",), least=0.0, most=1.0, too_large=_PERCENT, too_small="remove the sign")
]
Exponent = Annotated[float, Quantity(("ratio",), least=1.0, most=9.0)]
MeetingSpeed = Annotated[float, Quantity(("speed",), above=0.0)]


@dataclass(frozen=True)
class Ends:
    """What a restitution needs to know of two ends: the striking mass [kg], that of a body alone or the reduced mass
    of two, None without a body; their closing speed [m/s], None where the file does not give it; their radii [m],
    infinite for what is no body, None where a body has none."""

    mass: float | None
    speed: float | None
    radii: tuple[float, float] | None


@dataclass(frozen=True)
class Site:
    """Where a law stands: its two ends, its place in the file, and the texts of the files that laws name, by their
    names, to which its own are added."""

    ends: Ends
    here: Here
    sources: dict[str, str]

    def meeting_speed(self, given: float | None) -> float | None:
        """The speed [m/s] that a restitution holds at: as given, or from the file; None with a mistake noted."""
        speed, there = given or self.ends.speed, self.here.at("restitution")
        there.need(speed, "a restitution without a meeting speed", "at_speed", "add 'at_speed: 2 m/s'")
        return speed


class LawSpec(Spec):
    """A contact law."""

    type: str
    tensile: Flag = False

    @property
    def takes_radius(self) -> bool:
        """Whether it takes the radii of the bodies it stands between."""
        return False

    def law(self, site: Site) -> Law | None:
        """The law; None with a mistake noted. Raises FemstructError for what its constructor refuses."""
        law: Law = self.noun()
        return law


class FactoredSpec(LawSpec):
    """f = s(d) (1 + chi d'): the dissipation chi, or the restitution at a speed. Without at_speed it is the speed with
    which a body placed at the other end starts."""

    at_most_one_of = (("dissipation", "restitution"),)
    needs = (("at_speed", ("restitution",)),)
    only_written = ("restitution", "at_speed")

    dissipation: Annotated[float, Quantity(("dissipation",), least=0.0)] = 0.0
    restitution: Restitution | None = None
    at_speed: MeetingSpeed | None = None

    def law(self, site: Site) -> Law | None:
        chi: float | None = self.dissipation
        if self.restitution is not None:
            speed = site.meeting_speed(self.at_speed)
            chi = None if speed is None else dissipation_for(self.restitution, speed)
        return None if chi is None else self.with_dissipation(chi, site)

    def with_dissipation(self, chi: float, site: Site) -> Law | None:
        """The law with a dissipation [s/m]; None with a mistake noted."""
        law: Law = self.noun(dissipation=chi)
        return law


class PowerSpec(LawSpec):
    """A spring k d^n; k in N/m^n, n = 1.5 unless given."""

    exponent: Exponent = 1.5
    stiffness: float

    @field_validator("stiffness", mode="before", json_schema_input_type=float | str)
    @classmethod
    def _power(cls, value: Any, info: ValidationInfo) -> Any:
        if "exponent" not in info.data:  # refused already
            return 1.0
        try:
            stiffness = power_stiffness(value, info.data["exponent"])
        except QuantityError as error:
            raise refuse(error.got, error.expected, error.do) from None
        if not stiffness > 0.0:
            raise refuse(shown_as(value), "a positive stiffness")
        return stiffness


class PublishedSpec(PowerSpec):
    """A spring k d^n whose dissipation an author gives by restitution and meeting speed."""

    only_written = ("at_speed",)

    restitution: Restitution
    at_speed: MeetingSpeed | None = None

    def law(self, site: Site) -> Law | None:
        speed = site.meeting_speed(self.at_speed)
        return None if speed is None else self.noun(speed=speed)
