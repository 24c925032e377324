"""Flores, Machado, Silva and Martins: Hunt and Crossley's law with the dissipation they published for soft bodies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from femstruct.laws.by_restitution import ByRestitution
from femstruct.tags import stored_as


@stored_as("contact law of Flores/1")
@dataclass(frozen=True)
class Flores(ByRestitution):
    """f = k d^n (1 + chi d') with chi = 8 (1 - e) / (5 e v): as published, by restitution e and meeting speed v [m/s].

    Its spring holds k d^(n+1) / (n + 1). Published for all restitutions from 0 to 1, it returns a little less than it
    is asked for: for 0.9 0.894, for 0.7 0.683, for 0.5 0.470, for 0.3 0.256, for 0.1 0.069, whatever the exponent and
    the masses. `HuntCrossley.returning` returns what it is asked for.

    stiffness k [N/m^n]; exponent n >= 1; tensile : let the dashpot pull.

    Raises InputError for a stiffness or speed that is not positive, or a restitution beyond 0 to 1.

    References: Flores, Machado, Silva and Martins, On the continuous contact force models for soft materials in
    multibody dynamics, Multibody System Dynamics 25 (2011) 357, doi:10.1007/s11044-010-9237-4.

    >>> law = Flores(1e8, restitution=0.5, speed=2.0)
    >>> round(law.dissipation, 6), round(law.returns, 3)
    (0.8, 0.47)
    """

    word: ClassVar = "flores"

    @property
    def dissipation(self) -> float:
        """Dissipation factor chi [s/m]."""
        return 1.6 * (1.0 - self.restitution) / (self.restitution * self.speed)
