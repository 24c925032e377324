"""Contact laws: force from indentation and its rate, compressive and positive."""

from __future__ import annotations

from dataclasses import dataclass
from math import log, pi, sqrt

from femstruct.errors import FemstructError
from femstruct.impact.factored import (
    Cubic,
    HuntCrossley,
    LankaraniNikravesh,
    Tabulated,
    refuse_negative,
    refuse_unless_positive,
)
from femstruct.impact.restitution import damping_ratio_for, swing


@dataclass(frozen=True)
class Hertz:
    """f = k delta^1.5 + c delta^0.5 delta': two rounded bodies.

    stiffness k [N/m^1.5]; damping c [N s/m^1.5]; tensile : let the dashpot pull while it opens (False clamps f >= 0).

    >>> round(Hertz(1e6).indentation(1000.0), 6)
    0.01
    """

    stiffness: float
    damping: float = 0.0
    tensile: bool = False

    def __post_init__(self) -> None:
        _refuse(self)

    @classmethod
    def of_spheres(cls, radius: tuple[float, float], E: tuple[float, float], nu: tuple[float, float]) -> Hertz:
        """Two elastic spheres: k = 4/3 E* sqrt(R), 1/E* = sum (1 - nu^2) / E, 1/R = sum 1 / radius, without loss.

        radius [m], infinite for a flat face; E [Pa]; nu : Poisson's ratios.

        References: Johnson, Contact Mechanics (1985), equations 4.22 and 4.23.

        >>> f"{Hertz.of_spheres((5e-3, float('inf')), (5.9e9, 210e9), (0.34, 0.34)).stiffness:.2g}"
        '6.1e+08'
        """
        for word, pair in (("radius", radius), ("E", E)):
            for value in pair:
                refuse_unless_positive(f"hertz law {word}", value)
        if not all(-1.0 < one <= 0.5 for one in nu):
            raise FemstructError("hertz law nu", got=f"{nu[0]:g} and {nu[1]:g}", expected="values from -1 to 0.5")
        curvature = sum(1.0 / one for one in radius)
        if not curvature > 0.0:
            raise FemstructError("hertz law radius", got="two flat faces", expected="one of them round")
        plane = 1.0 / sum((1.0 - n * n) / e for n, e in zip(nu, E, strict=True))
        return cls(4.0 / 3.0 * plane / sqrt(curvature))

    def indentation(self, force: float) -> float:
        """Indentation under a force at rest [m]."""
        return float((force / self.stiffness) ** (2.0 / 3.0))


@dataclass(frozen=True)
class Linear:
    """f = k delta + c delta': a unilateral spring and dashpot side by side (Kelvin and Voigt).

    stiffness k [N/m]; damping c [N s/m]; tensile : let the dashpot pull while it opens (False clamps f >= 0). With
    damping the force jumps to c times the meeting speed at the first touch. Without tension the contact ends when the
    force is zero, the spring still indented by c / k times the parting speed: what it holds is lost in the dashpot.

    >>> Linear(2e6, damping=100.0).indentation(1000.0)
    0.0005
    """

    stiffness: float
    damping: float = 0.0
    tensile: bool = False

    def __post_init__(self) -> None:
        _refuse(self)

    @classmethod
    def returning(
        cls,
        restitution: float,
        mass: float,
        duration: float | None = None,
        stiffness: float | None = None,
        tensile: bool = False,
    ) -> Linear:
        """The law with which a mass returns from a rigid wall with a restitution, at every speed.

        mass [kg] : of the body; two bodies that meet count with m1 m2 / (m1 + m2). duration [s] : of the contact, from
        the first touch to the end of its force; or the stiffness [N/m], and the duration follows.

        Notes: c = 2 z sqrt(k m) with z from `femstruct.impact.restitution.damping_ratio_for`; the contact lasts
        T = 2 swing(z) sqrt(m / k) without tension, and sqrt(pi^2 + ln^2 e) sqrt(m / k) with it.

        Raises FemstructError unless 0 < restitution <= 1, mass and duration or stiffness are positive, and one of these
        two is given.

        >>> law = Linear.returning(0.5, mass=2.0, duration=0.01)
        >>> round(law.stiffness), round(law.damping, 3)
        (147456, 277.259)
        """
        refuse_unless_positive("linear law mass", mass)
        ratio = damping_ratio_for(restitution, tensile)
        if (duration is None) == (stiffness is None):
            raise FemstructError("linear law", got="both or neither", expected="either a duration or a stiffness")
        if duration is not None:
            refuse_unless_positive("linear law duration", duration)
            angle = sqrt(pi**2 + log(restitution) ** 2) if tensile else 2.0 * swing(ratio)
            stiffness = mass * (angle / duration) ** 2
        assert stiffness is not None
        refuse_unless_positive("linear law stiffness", stiffness)
        return cls(stiffness, 2.0 * ratio * sqrt(stiffness * mass), tensile)

    def indentation(self, force: float) -> float:
        """Indentation under a force at rest [m]."""
        return force / self.stiffness


@dataclass(frozen=True)
class Stop:
    """A bumper on both sides: a linear contact where the ends have moved further than the gap, towards or apart.

    stiffness k [N/m]; damping c [N s/m].
    """

    stiffness: float
    damping: float = 0.0
    tensile: bool = False

    def __post_init__(self) -> None:
        _refuse(self)

    def indentation(self, force: float) -> float:
        """Indentation under a force at rest [m]."""
        return force / self.stiffness


Law = Hertz | Linear | Stop | HuntCrossley | LankaraniNikravesh | Cubic | Tabulated


def _refuse(law: Hertz | Linear | Stop) -> None:
    kind = type(law).__name__.lower()
    refuse_unless_positive(f"{kind} law stiffness", law.stiffness)
    refuse_negative(f"{kind} law damping", law.damping)
