"""What walls do: admittances of locally reacting walls, the absorption coefficients they stand for, and walls that
yield."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import log
from types import MappingProxyType
from typing import Final

import numpy as np
import scipy

from acoustics.arrays import Floats, freeze, positive
from acoustics.errors import AcousticsError
from acoustics.tags import stored_as

_RESISTANCE_OF_MOST: Final = 1.567  # specific resistance of the highest random-incidence absorption
MOST_ABSORBED: Final = 0.951  # which it is


@stored_as("wall of a room/1")
@dataclass(frozen=True, eq=False)
class Wall:
    """A locally reacting wall that absorbs sound: rho c over its impedance, a real number.

    admittance : {frequency [Hz]: rho c / Z [-]}; between them it is linear in log frequency, beyond them constant.

    Raises AcousticsError: no admittance, a frequency not above 0, a negative admittance.

    Notes
    -----
    A real admittance that depends on frequency is no causal wall; it damps each mode with its value there.

    >>> Wall({100.0: 0.0, 400.0: 0.02}).at(np.array([50.0, 200.0])).round(9).tolist()
    [0.0, 0.01]
    """

    admittance: Mapping[float, float]

    def __post_init__(self) -> None:
        if not self.admittance:
            raise AcousticsError("wall.admittance", got="nothing", expected="at least one value")
        for frequency, value in self.admittance.items():
            positive("wall.admittance", frequency, "Hz")
            if not (np.isfinite(value) and value >= 0):
                raise AcousticsError("wall.admittance", got=f"{value:g} at {frequency:g} Hz", expected="a number >= 0")
        freeze(self, admittance=MappingProxyType(dict(sorted(self.admittance.items()))))

    def __str__(self) -> str:
        """What it absorbs, in words."""
        return "admittance " + ", ".join(f"{value:.4g} at {f:g} Hz" for f, value in self.admittance.items())

    def at(self, frequency_hz: Floats) -> Floats:
        """Admittance [n] at frequencies [n] [Hz]."""
        known = np.log(list(self.admittance))
        wanted = np.log(np.maximum(frequency_hz, float(np.exp(known[0]))))
        values: Floats = np.interp(wanted, known, list(self.admittance.values()))
        return values

    @property
    def constant(self) -> bool:
        """Whether it is the same at all frequencies, and the wall therefore causal."""
        return len(set(self.admittance.values())) == 1


@stored_as("yielding wall of a room/1")
@dataclass(frozen=True, eq=False)
class YieldingWall:
    """A locally reacting wall that gives way: every bit of it a mass on a spring and a dashpot, held from behind.

    mass : per area [kg/m^2]; 0 for a wall far below its resonance. stiffness : per area [N/m^3]. resistance : per area
    [Pa s/m].

    Raises AcousticsError: one of them below 0, neither mass nor stiffness.

    Notes
    -----
    Its impedance r + j omega m + s / (j omega) is causal, so that it is exact in time. Neighbouring bits do not hold
    each other: a plate that bends is no such wall near and above the frequency at which its bending waves travel as
    fast as sound. A resistance alone is a `Wall`: rho c / r.

    >>> wall = YieldingWall(mass=25.0, stiffness=2e6)
    >>> round((wall.stiffness / wall.mass) ** 0.5 / (2 * np.pi), 2)
    45.02
    """

    mass: float = 0.0
    stiffness: float = 0.0
    resistance: float = 0.0

    def __str__(self) -> str:
        """How it yields, in words."""
        return f"{self.mass:g} kg/m^2, {self.stiffness:g} N/m^3, {self.resistance:g} Pa s/m"

    def __post_init__(self) -> None:
        for name, unit in (("mass", "kg/m^2"), ("stiffness", "N/m^3"), ("resistance", "Pa s/m")):
            value = float(getattr(self, name))
            if not (np.isfinite(value) and value >= 0):
                raise AcousticsError(f"wall.{name}", got=f"{value:g} {unit}", expected="a number >= 0")
            freeze(self, **{name: value})
        if self.mass == 0 and self.stiffness == 0:
            raise AcousticsError(
                "wall",
                got="neither mass nor stiffness",
                expected="one of them",
                do="give a wall with a resistance only as an impedance",
            )


AnyWall = Wall | YieldingWall


def absorbing(absorption: float | Mapping[float, float]) -> Wall:
    """The wall with a random-incidence absorption coefficient, one or {frequency [Hz]: alpha}.

    Raises AcousticsError: a coefficient below 0 or above 0.951, the most that a real admittance reaches.

    Notes
    -----
    Paris' formula for a specific resistance r: alpha = (8 / r) (1 + 1 / (1 + r) - (2 / r) ln(1 + r)), on its stiff
    side; 8 / r for a little. (H. Kuttruff, Room Acoustics, 5th ed., eq. 2.42.)

    >>> round(absorbing(0.1).at(np.array([100.0])).item(), 4)
    0.014
    """
    by_frequency = absorption if isinstance(absorption, Mapping) else {1000.0: absorption}
    return Wall({frequency: _admittance(alpha) for frequency, alpha in by_frequency.items()})


def random_incidence_absorption(admittance: float) -> float:
    """Absorption coefficient of a real specific admittance for sound from all directions; see `absorbing`."""
    if admittance == 0:
        return 0.0
    r = 1 / admittance
    return 8 / r * (1 + 1 / (1 + r) - 2 / r * log(1 + r))


def _admittance(alpha: float) -> float:
    most = random_incidence_absorption(1 / _RESISTANCE_OF_MOST)
    if not 0 <= alpha <= most:
        raise AcousticsError(
            "absorption", got=f"{alpha:g}", expected=f"0 to {most:.3f}, the largest of a locally reacting resistance"
        )
    if alpha == 0:
        return 0.0
    return float(
        scipy.optimize.brentq(
            lambda y: random_incidence_absorption(y) - alpha, alpha / 16, 1 / _RESISTANCE_OF_MOST, xtol=1e-15
        )
    )
