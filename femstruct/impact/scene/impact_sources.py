"""Standard impact sources: the rubber ball, the bang machine and the tapping machine, and what they must do on a rigid
floor.

The contact laws of the ball and the bang machine are fitted to the tables of the standards, which give what a source
does, not what it is made of: mass, drop height, force exposure in octaves, restitution and duration of the contact.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import sqrt
from types import MappingProxyType
from typing import Any, Final, Generic, TypeVar

import numpy as np

from femstruct.arrays import Floats
from femstruct.conventions import GRAVITY
from femstruct.impact.laws.hertz import Hertz
from femstruct.impact.laws.law import Law
from femstruct.impact.laws.tabulated import Tabulated

L = TypeVar("L", bound=Law)
EXPOSURE_ALLOWED_DB: Final = MappingProxyType({31.5: 1.0, 63.0: 1.5, 125.0: 1.5, 250.0: 2.0, 500.0: 2.0})
RESTITUTION: Final = (0.8, 0.1)  # and what is allowed
CONTACT_S: Final = (20e-3, 2e-3)


@dataclass(frozen=True, eq=False)
class StandardSource(Generic[L]):
    """A source that is dropped: mass [kg], drop height [m], contact law, and its table.

    exposure_db : impact force exposure level on a rigid floor by octave {nominal [Hz]: [dB re 1 N^2 s]}; allowed are
    `EXPOSURE_ALLOWED_DB`, and the same `RESTITUTION` and `CONTACT_S` for both.
    """

    mass: float
    drop_height: float
    law: L
    exposure_db: Mapping[float, float]

    @property
    def speed(self) -> float:
        """Speed at the floor [m/s]."""
        return sqrt(2.0 * GRAVITY * self.drop_height)


def _ball() -> Tabulated:
    """s(d) = k d + f0 (1 - exp(-d / d0)), a spring with a stiff skin, times (1 + chi d'); out to a third of the ball.

    Its four numbers are fitted by least squares to the table below: k 51.8 kN/m, f0 335 N, d0 .827 mm, chi .0596 s/m.
    """
    depth = 1e-3 * np.array([0, 0.2, 0.4, 0.6, 0.8, 1, 1.3, 1.6, 2, 2.5, 3, 4, 5, 7, 10, 15, 20, 30, 40, 50, 60])
    return Tabulated(
        depth, 51.848e3 * depth - 335.13 * np.expm1(-depth / 0.82695e-3), dissipation=0.059583, smooth=True
    )


# ISO 16283-2:2020 table A.1 = ISO 10140-5 table F.1 = JIS A 1418-2 table A.2, and JIS A 1418-2 table A.1, as quoted in
# https://github.com/jmrplens/phonometry (building/measurement/heavy_impact.py) and
# https://kikakurui.com/a1/A1418-2-2019-01.html
RUBBER_BALL: Final[StandardSource[Tabulated]] = StandardSource(
    2.5, 1.0, _ball(), MappingProxyType({31.5: 39.0, 63.0: 31.0, 125.0: 23.0, 250.0: 17.0, 500.0: 12.5})
)
BANG_MACHINE: Final[StandardSource[Hertz]] = StandardSource(
    7.3,
    0.85,
    Hertz(857_926.0, 1277.5),  # fitted by least squares
    MappingProxyType({31.5: 47.0, 63.0: 40.0, 125.0: 22.0, 250.0: 11.5, 500.0: 5.5}),
)
DROPPED: Final[Mapping[str, StandardSource[Any]]] = MappingProxyType(
    {"rubber ball": RUBBER_BALL, "bang machine": BANG_MACHINE}
)

# ISO 10140-5 annex E, ISO 16283-2 annex A: five hammers strike in turn, ten blows a second in all, at .886 +- .022 m/s
TAPPING_MACHINE: Final = "tapping machine"
HAMMERS: Final = 5
HAMMER_MASS: Final = 0.5  # kg
HAMMER_DROP: Final = 0.040  # m
BETWEEN_BLOWS: Final = 0.1  # s
SINGLE_WITHIN_S: Final = 0.020  # a single interval, and the mean of them: ISO 10140-5 annex E, from memory
MEAN_WITHIN_S: Final = 0.005


def scattered(turns: int, seed: int) -> Floats:
    """How much later than evenly the blows of a tapping machine come [turns, hammers] [s], repeatable by its seed.

    Each is up to 10 ms early or late, all alike probable and independent, and 10 ms later than that: every interval
    between two blows is then within 100 +- 20 ms, and the mean of n of them within 20 ms / n of 100 ms: for a turn
    within 5 ms. Of the lines of an even machine sinc^2(2 f 10 ms) of the power is left: above 50 Hz none.

    >>> late = scattered(2, seed=1)
    >>> late.shape, bool((late >= 0).all() and (late <= SINGLE_WITHIN_S).all())
    ((2, 5), True)
    """
    found: Floats = np.random.default_rng(seed).uniform(0.0, SINGLE_WITHIN_S, (turns, HAMMERS))
    return found
