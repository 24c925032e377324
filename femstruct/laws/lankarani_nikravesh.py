"""Lankarani and Nikravesh: Hunt and Crossley's law with the dissipation they published."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf
from typing import ClassVar

from femstruct.errors import Finding
from femstruct.laws.by_restitution import ByRestitution
from femstruct.laws.law import MISSED, missed_restitution, misses
from femstruct.tags import stored_as


@stored_as("contact law of Lankarani and Nikravesh/1")
@dataclass(frozen=True)
class LankaraniNikravesh(ByRestitution):
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
    doubts: ClassVar = {MISSED: False}

    @property
    def dissipation(self) -> float:
        """Dissipation factor chi [s/m]."""
        return 0.75 * (1.0 - self.restitution**2) / self.speed

    def findings(self, contact: str, deepest: float) -> tuple[Finding, ...]:
        return missed_restitution(contact, "Lankarani and Nikravesh", self.restitution, self.returns, self.speed)

    @property
    def doubted_from(self) -> Mapping[str, float]:
        return {MISSED: -inf if misses(self.restitution, self.returns) else inf}
