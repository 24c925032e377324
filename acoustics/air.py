"""The air: speed of sound and density."""

from __future__ import annotations

from dataclasses import dataclass

from acoustics.arrays import freeze, positive
from acoustics.tags import stored_as


@stored_as("air/1")
@dataclass(frozen=True, eq=False)
class Air:
    """Speed of sound `c` [m/s] and density `rho` [kg/m^3] of the air; the defaults are those of 20 degC at sea level.

    >>> air = Air(c=340, rho=1.29)
    >>> round(air.bulk_modulus)
    149124
    """

    c: float = 343.0
    rho: float = 1.21

    def __post_init__(self) -> None:
        freeze(self, c=positive("air.c", self.c, "m/s"), rho=positive("air.rho", self.rho, "kg/m^3"))

    @property
    def bulk_modulus(self) -> float:
        """Stiffness of the air against compression, rho c^2 [Pa]."""
        return self.rho * self.c**2
