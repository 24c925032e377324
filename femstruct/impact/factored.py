"""Contact laws whose dashpot is a factor of their spring: f = s(d) (1 + chi d').

Their force starts and ends at zero without a jump, and what they return of a meeting speed does not depend on the
spring or the masses: `femstruct.impact.restitution`. d is the indentation [m], chi the dissipation factor [s/m].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from femstruct.arrays import Floats, freeze, frozen
from femstruct.errors import FemstructError
from femstruct.impact.restitution import dissipation_for, refuse_restitution, restitution_of


@dataclass(frozen=True)
class HuntCrossley:
    """f = k d^n (1 + chi d'): two bodies of smooth or flat shape that lose energy.

    stiffness k [N/m^n]; exponent n >= 1, 1.5 for Hertz; dissipation chi [s/m]; tensile : let the dashpot pull while
    it opens faster than 1 / chi (False clamps f >= 0; a collision that nothing else pulls apart never gets there).
    In other notation the dashpot is lambda d^n d' with lambda = k chi.

    Raises FemstructError for a stiffness that is not positive, an exponent below 1, or a negative dissipation.

    References: Hunt and Crossley, J. Appl. Mech. 42 (1975) 440.

    >>> law = HuntCrossley.returning(0.6, speed=2.0, stiffness=1e8)
    >>> round(law.dissipation, 6)
    0.487436
    """

    stiffness: float
    exponent: float = 1.5
    dissipation: float = 0.0
    tensile: bool = False

    def __post_init__(self) -> None:
        refuse_unless_positive("hunt-crossley law stiffness", self.stiffness)
        _refuse_exponent("hunt-crossley", self.exponent)
        refuse_negative("hunt-crossley law dissipation", self.dissipation)

    @classmethod
    def returning(
        cls, restitution: float, speed: float, stiffness: float, exponent: float = 1.5, tensile: bool = False
    ) -> HuntCrossley:
        """The law that returns exactly this restitution when two bodies meet at this speed [m/s]; faster ones lose
        more."""
        return cls(stiffness, exponent, dissipation_for(restitution, speed), tensile)

    def indentation(self, force: float) -> float:
        """Indentation under a force at rest [m]."""
        return float((force / self.stiffness) ** (1.0 / self.exponent))


@dataclass(frozen=True)
class LankaraniNikravesh:
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

    stiffness: float
    restitution: float
    speed: float
    exponent: float = 1.5
    tensile: bool = False

    def __post_init__(self) -> None:
        refuse_unless_positive("lankarani-nikravesh law stiffness", self.stiffness)
        _refuse_exponent("lankarani-nikravesh", self.exponent)
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

    def indentation(self, force: float) -> float:
        """Indentation under a force at rest [m]."""
        return float((force / self.stiffness) ** (1.0 / self.exponent))


@dataclass(frozen=True)
class Cubic:
    """f = (k d + k3 d^3) (1 + chi d'): a spring that stiffens, such as a rubber pad or a strip of felt.

    stiffness k [N/m]; cubic k3 [N/m^3]; dissipation chi [s/m]; tensile : let the dashpot pull.

    Raises FemstructError for a negative value, or when both k and k3 are zero.

    >>> Cubic(1e4, 1e10).indentation(20.0)
    0.001
    """

    stiffness: float
    cubic: float
    dissipation: float = 0.0
    tensile: bool = False

    def __post_init__(self) -> None:
        refuse_negative("cubic law stiffness", self.stiffness)
        refuse_negative("cubic law cubic", self.cubic)
        refuse_negative("cubic law dissipation", self.dissipation)
        if not (self.stiffness or self.cubic):
            raise FemstructError("cubic law", got="no stiffness", expected="a stiffness, a cubic stiffness, or both")

    def indentation(self, force: float) -> float:
        """Indentation under a force at rest [m]."""
        if not force:
            return 0.0
        limits = [force / self.stiffness] if self.stiffness else []
        limits += [(force / self.cubic) ** (1.0 / 3.0)] if self.cubic else []

        def miss(d: float) -> float:
            return self.stiffness * d + self.cubic * d**3 - force

        top = min(limits)
        return float(scipy.optimize.brentq(miss, 0.0, top * (1.0 + 1e-12), xtol=1e-16 * top, rtol=1e-15))


@dataclass(frozen=True, eq=False)
class Tabulated:
    """f = s(d) (1 + chi d') with s through measured points: indentation [n] [m], force [n] [N].

    Between the points s is a monotone cubic (PCHIP): its slope is continuous and it has no ripple of its own. Both
    columns begin at 0 and rise. Beyond the last point s goes on along its last slope, and a run that gets there has a
    severe finding, `beyond-table`: the force is then a guess.

    dissipation chi [s/m]; tensile : let the dashpot pull.

    Raises FemstructError for columns of unequal length, fewer than two points, or ones that do not rise from 0.

    References: Fritsch and Carlson, SIAM J. Numer. Anal. 17 (1980) 238; slopes as in scipy's PchipInterpolator.

    >>> pad = Tabulated([0.0, 1e-3, 2e-3], [0.0, 10.0, 40.0])
    >>> round(pad.indentation(10.0), 9)
    0.001
    """

    indentations: Floats
    forces: Floats
    dissipation: float = 0.0
    tensile: bool = False

    def __post_init__(self) -> None:
        depth = frozen("table law indentations", self.indentations, (None,))
        freeze(self, indentations=depth, forces=frozen("table law forces", self.forces, depth.shape))
        refuse_negative("table law dissipation", self.dissipation)
        if len(depth) < 2:
            raise FemstructError("table law", got=f"{len(depth)} points", expected="two or more, the first at 0")
        for word, column, unit in (("indentation", depth, "m"), ("force", self.forces, "N")):
            if column[0] != 0.0:
                raise FemstructError(
                    "table law", got=f"a first {word} of {column[0]:g} {unit}", expected="0: untouched, without force"
                )
            falls = np.flatnonzero(np.diff(column) <= 0)
            if len(falls):
                a, b = column[falls[0]], column[falls[0] + 1]
                raise FemstructError("table law", got=f"{word} {b:g} {unit} after {a:g} {unit}", expected="a rise")

    @property
    def pieces(self) -> Floats:
        """Rows of indentation, force, slope, the coefficients of x^2 and x^3 after it, and energy [J] up to it."""
        cubics = scipy.interpolate.PchipInterpolator(self.indentations, self.forces)
        c3, c2, slope, force = cubics.c
        x = np.diff(self.indentations)
        energy = np.cumsum(x * (force + x * (slope / 2 + x * (c2 / 3 + x * c3 / 4))))
        last = slope[-1] + x[-1] * (2 * c2[-1] + 3 * x[-1] * c3[-1])
        rows = np.zeros((len(self.indentations), 6))
        rows[:, 0], rows[:, 1] = self.indentations, self.forces
        rows[:, 2] = np.append(slope, last)
        rows[:-1, 3], rows[:-1, 4], rows[1:, 5] = c2, c3, energy
        return rows

    def indentation(self, force: float) -> float:
        """Indentation under a force at rest [m].

        Raises FemstructError for a force beyond the last point.
        """
        if force > self.forces[-1]:
            raise FemstructError(
                "table law preload",
                got=f"{force:g} N",
                expected=f"at most the last force of the table, {self.forces[-1]:g} N",
                do="extend the table",
            )
        depth = self.indentations[-1]
        spring = scipy.interpolate.PchipInterpolator(self.indentations, self.forces)
        return float(
            scipy.optimize.brentq(lambda d: float(spring(d)) - force, 0.0, depth, xtol=1e-16 * depth, rtol=1e-15)
        )


def refuse_unless_positive(where: str, value: float) -> None:
    """Raise FemstructError unless a value is positive."""
    if not value > 0:
        raise FemstructError(where, got=f"{value:g}", expected=f"a positive {where.split()[-1]}")


def refuse_negative(where: str, value: float) -> None:
    """Raise FemstructError for a negative value."""
    if not value >= 0:
        raise FemstructError(where, got=f"{value:g}", expected=f"a {where.split()[-1]} >= 0")


def _refuse_exponent(kind: str, exponent: float) -> None:
    if not 1.0 <= exponent <= 9.0:
        raise FemstructError(f"{kind} law exponent", got=f"{exponent:g}", expected="an exponent from 1 to 9")
