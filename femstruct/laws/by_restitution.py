"""Laws of Hunt and Crossley's form whose dissipation follows from a restitution and a meeting speed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from femstruct.declared import checked
from femstruct.laws.hunt_crossley import PowerLaw, refuse_exponent
from femstruct.laws.law import refuse_unless_positive
from femstruct.laws.restitution import refuse_restitution, restitution_of


@dataclass(frozen=True)
@checked("law")
class ByRestitution(PowerLaw):
    """f = k d^n (1 + chi d'), chi as an author gives it by restitution e and meeting speed v [m/s].

    stiffness k [N/m^n]; exponent n >= 1; tensile : let the dashpot pull.

    Raises InputError for a stiffness or speed that is not positive, or a restitution beyond 0 to 1.
    """

    varies: ClassVar = {"stiffness": "stiffness", "exponent": "shape"}
    units: ClassVar = {"stiffness": "N/m^exponent", "speed": "m/s"}

    stiffness: float
    restitution: float
    speed: float
    exponent: float = 1.5
    tensile: bool = False

    def __post_init__(self) -> None:
        refuse_unless_positive(f"{self.word} law stiffness", self.stiffness)
        refuse_exponent(self.word, self.exponent)
        refuse_restitution(self.restitution)
        refuse_unless_positive(f"{self.word} law speed", self.speed)

    @property
    def returns(self) -> float:
        """Restitution that it returns at its meeting speed."""
        return restitution_of(self.dissipation, self.speed)
