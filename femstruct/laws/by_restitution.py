"""Laws of Hunt and Crossley's form whose dissipation follows from a restitution and a meeting speed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar

from femstruct.declared import NOT_GIVEN, Key, checked
from femstruct.laws.hunt_crossley import Exponent, PowerLaw
from femstruct.laws.law import MeetingSpeed, Restitution, meeting_speed
from femstruct.laws.restitution import restitution_of
from femstruct.quantities import PowerStiffness


@dataclass(frozen=True)
@checked("{word} law")
class ByRestitution(PowerLaw):
    """f = k d^n (1 + chi d'), chi as an author gives it by restitution e and meeting speed v [m/s].

    stiffness k [N/m^n]; exponent n >= 1; tensile : let the dashpot pull.

    Raises InputError for a stiffness or speed that is not positive, or a restitution beyond 0 to 1.
    """

    varies: ClassVar = {"stiffness": "stiffness", "exponent": "shape"}

    stiffness: Annotated[float, PowerStiffness()]
    restitution: Restitution
    speed: Annotated[MeetingSpeed, Key("at_speed")] = NOT_GIVEN
    exponent: Exponent = 1.5
    tensile: bool = False

    def __post_init__(self) -> None:
        meeting_speed(self.word, self.speed)

    @property
    def returns(self) -> float:
        """Restitution that it returns at its meeting speed."""
        return restitution_of(self.dissipation, self.speed)
