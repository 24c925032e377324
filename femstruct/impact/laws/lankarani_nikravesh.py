"""Lankarani and Nikravesh: Hunt and Crossley's law with the dissipation they published."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf
from typing import ClassVar

from femstruct.arrays import Floats
from femstruct.errors import Finding
from femstruct.impact.engine.records import Records
from femstruct.impact.laws.hunt_crossley import CODE, indentation_of_power, refuse_exponent, rests_of_power
from femstruct.impact.laws.law import MISSED, Law, Stored, missed_restitution, misses, refuse_unless_positive
from femstruct.impact.scene.restitution import refuse_restitution, restitution_of


@dataclass(frozen=True)
class LankaraniNikravesh(Law):
    """f = k d^n (1 + chi d') with chi = 3 (1 - e^2) / (4 v): as published, by restitution e and meeting speed v [m/s].

    The factor equates the loss of a collision to that along a lossless path, so it holds for e near 1 only: asked for
    0.9 it returns 0.913, for 0.7 0.796, for 0.5 0.725, and never less than 0.66. `HuntCrossley.returning` returns
    what it is asked for.

    stiffness k [N/m^n]; exponent n >= 1; tensile : let the dashpot pull.

    References: Lankarani and Nikravesh, J. Mech. Des. 112 (1990) 369, doi:10.1115/1.2912617.

    >>> law = LankaraniNikravesh(1e8, restitution=0.7, speed=2.0)
    >>> round(law.dissipation, 5), round(law.returns, 3)
    (0.19125, 0.796)
    """

    word: ClassVar = "lankarani-nikravesh"
    code: ClassVar = CODE
    varies: ClassVar = {"stiffness": "stiffness", "exponent": "shape"}
    doubts: ClassVar = {MISSED: False}

    stiffness: float
    restitution: float
    speed: float
    exponent: float = 1.5
    tensile: bool = False

    def __post_init__(self) -> None:
        refuse_unless_positive("lankarani-nikravesh law stiffness", self.stiffness)
        refuse_exponent("lankarani-nikravesh", self.exponent)
        refuse_restitution(self.restitution)
        refuse_unless_positive("lankarani-nikravesh law speed", self.speed)

    @property
    def dissipation(self) -> float:
        """Dissipation factor chi [s/m]."""
        return 0.75 * (1.0 - self.restitution**2) / self.speed

    @property
    def returns(self) -> float:
        """Restitution that it returns at its meeting speed."""
        return restitution_of(self.dissipation, self.speed)

    @property
    def stored(self) -> Stored:
        return Stored(self.stiffness, self.dissipation, self.exponent)

    def indentation(self, force: float) -> float:
        """Indentation under a force at rest [m]."""
        return indentation_of_power(force, self.stiffness, self.exponent)

    def findings(self, contact: str, deepest: float) -> tuple[Finding, ...]:
        return missed_restitution(contact, "Lankarani and Nikravesh", self.restitution, self.returns, self.speed)

    @property
    def doubted_from(self) -> Mapping[str, float]:
        return {MISSED: -inf if misses(self.restitution, self.returns) else inf}

    @staticmethod
    def rests(preload: Floats, laws: Records) -> Floats:
        return rests_of_power(preload, laws)
