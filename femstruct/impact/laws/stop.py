"""Stop: a bumper on both sides."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from femstruct.arrays import Floats
from femstruct.impact.laws.law import Law, Stored, refuse_negative, refuse_unless_positive
from femstruct.impact.laws.linear import CODE, Linear


@dataclass(frozen=True)
class Stop(Law):
    """A bumper on both sides: a linear contact where the ends have moved further than the gap, towards or apart.

    stiffness k [N/m]; damping c [N s/m]; tensile : let the dashpot pull while it opens.

    >>> Stop(2e6).sides
    (1.0, -1.0)
    """

    word: ClassVar = "stop"
    code: ClassVar = CODE
    sides: ClassVar = (1.0, -1.0)
    straight: ClassVar = True
    varies: ClassVar = {"stiffness": "stiffness", "damping": "closing"}

    stiffness: float
    damping: float = 0.0
    tensile: bool = False

    def __post_init__(self) -> None:
        refuse_unless_positive("stop law stiffness", self.stiffness)
        refuse_negative("stop law damping", self.damping)

    @property
    def stored(self) -> Stored:
        return Stored(self.stiffness, self.damping)

    def indentation(self, force: float) -> float:
        """Indentation under a force at rest [m]."""
        return force / self.stiffness

    @staticmethod
    def quickest(spring: Floats, dashpot: Floats, speed: Floats) -> Floats:
        return Linear.quickest(spring, dashpot, speed)
