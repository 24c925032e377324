"""Wool as an equivalent fluid that is causal and passive at all frequencies: Darcy drag and one thermal pole."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from acoustics.air import Air
from acoustics.arrays import Complexes, freeze, positive
from acoustics.errors import AcousticsError

Frame = Literal["limp", "held"]
GAMMA: Final = 1.4  # ratio of the specific heats of air
PRANDTL: Final = 0.71  # of air
LEAST, MOST = 5e3, 30e3
"""Flow resistivities between which the model was compared with Johnson-Champoux-Allard, 20 Hz to 1 kHz [Pa s/m^2]."""


@dataclass(frozen=True)
class Wool:
    """Mineral wool and the like, light and with open pores.

    flow_resistivity : pressure gradient over the velocity of a steady flow [Pa s/m^2]. density : of the bulk [kg/m^3].
    frame : "limp", fibres that the air carries along, or "held", fibres at rest.
    porosity, tortuosity [1] : of the pores. thermal_rate : between isothermal and adiabatic compression [1/s]; 0 is
    adiabatic at all frequencies, None is that of the flow resistivity.

    Raises AcousticsError: numbers that cannot be.

    Notes
    -----
    Per volume flux, with s = j omega,

        rho(s) = tortuosity rho / porosity + sigma / s,    limp: sigma / s in series with the density of the bulk,
        K(s) = P0 / porosity (s + w) / (s / gamma + w),    w = sigma porosity / (4 tortuosity rho Pr),

    w being 8 eta / (L^2 rho Pr) with a thermal length L twice the viscous one, sqrt(8 eta tortuosity / sigma porosity).
    Against Johnson-Champoux-Allard with these lengths, 5 to 30 kPa s/m^2, 20 Hz to 1 kHz: resistance and Re K within
    6.5 %, Im K within 0.09 P0; Re rho is up to 20 % low, which does not matter where the resistance rules, below 1 kHz.

    The formulas of Delany and Bazley, and of Miki, are not used: below f / sigma = 0.01 m^3/kg (100 Hz at 10 kPa s/m^2)
    they describe a medium that gives energy.

    References: J.-F. Allard, N. Atalla, Propagation of Sound in Porous Media, 2nd ed., 2009, chapter 5 (Darcy limit,
    thermal length); limp frame: R. Panneton, J. Acoust. Soc. Am. 122 (2007) EL217, for a porosity of 1.

    >>> wool = Wool(flow_resistivity=10e3, density=40.0)
    >>> round(wool.rate(Air(343.25, 1.204)) / (2 * np.pi))
    465
    """

    flow_resistivity: float
    density: float = 40.0
    frame: Frame = "limp"
    porosity: float = 1.0
    tortuosity: float = 1.0
    thermal_rate: float | None = None

    def __post_init__(self) -> None:
        freeze(
            self,
            flow_resistivity=positive("fill.flow_resistivity", self.flow_resistivity, "Pa s/m^2"),
            density=positive("fill.density", self.density, "kg/m^3"),
        )
        if self.frame not in ("limp", "held"):
            raise AcousticsError("fill.frame", got=f"'{self.frame}'", expected="limp or held")
        if not 0.5 <= self.porosity <= 1.0:
            raise AcousticsError("fill.porosity", got=f"{self.porosity:g}", expected="a number from 0.5 to 1")
        if not 1.0 <= self.tortuosity <= 5.0:
            raise AcousticsError("fill.tortuosity", got=f"{self.tortuosity:g}", expected="a number from 1 to 5")
        if self.thermal_rate is not None and not (np.isfinite(self.thermal_rate) and self.thermal_rate >= 0):
            raise AcousticsError("fill.thermal_rate", got=f"{self.thermal_rate:g} 1/s", expected="a number >= 0")

    def rate(self, air: Air) -> float:
        """Circular frequency below which compression is isothermal [1/s]; 0 where it never is."""
        if self.thermal_rate is not None:
            return self.thermal_rate
        return self.flow_resistivity * self.porosity / (4.0 * self.tortuosity * air.rho * PRANDTL)

    def pores(self, air: Air) -> Air:
        """The air in the pores per volume flux, without drag and adiabatic."""
        return Air(air.c / self.tortuosity**0.5, air.rho * self.tortuosity / self.porosity)

    def density_at(self, s: Complexes, air: Air) -> Complexes:
        """Equivalent density [nf] [kg/m^3] at s [1/s].

        >>> still, carried = (Wool(10e3, frame=one).density_at(np.array([60j]), Air()) for one in ("held", "limp"))
        >>> still.round(2).tolist(), carried.round(2).tolist()
        ([(1.21-166.67j)], [(39.03-9.08j)])
        """
        drag: Complexes = self.flow_resistivity / s
        if self.frame == "limp":
            drag = drag * self.density / (drag + self.density)
        return self.pores(air).rho + drag

    def modulus_at(self, s: Complexes, air: Air) -> Complexes:
        """Bulk modulus [nf] [Pa] at s [1/s].

        >>> (Wool(10e3).modulus_at(np.array([1e-3j, 1e9j]), Air()).real / Air().bulk_modulus).round(3).tolist()
        [0.714, 1.0]
        """
        adiabatic, rate = self.pores(air).bulk_modulus, self.rate(air)
        modulus: Complexes = adiabatic / GAMMA * (1.0 + (GAMMA - 1.0) * s / (s + GAMMA * rate))
        return modulus
