"""Linear: a unilateral spring and dashpot side by side."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import KW_ONLY, InitVar, dataclass
from math import inf, log, pi, sqrt
from typing import Annotated, ClassVar, Final

import numpy as np

from femstruct.arrays import Floats, freeze
from femstruct.compiled.kernels import kernel
from femstruct.compiled.records import Records, System
from femstruct.declared import NOT_GIVEN, Key, checked
from femstruct.errors import InputError
from femstruct.laws.law import HARDLY, AnyRestitution, Code, Law, PositiveStiffness, StoredLaw, refuse_unless_positive
from femstruct.laws.restitution import damping_ratio_for, swing
from femstruct.quantities import Dashpot, Duration, MassKg
from femstruct.tags import stored_as

SETTLED: Final = 10.0  # time constants after which e^-10 is left
_ROUNDING: Final = 1e-9  # of critical damping, as a law made from a restitution of 0 has it


@kernel
def _spring(system: System, a: int, delta: float) -> tuple[float, float, float]:
    stiffness = system.interfaces[a]["stiffness"]
    return stiffness * delta, stiffness, 0.5 * stiffness * delta * delta


@kernel
def _force(system: System, a: int, delta: float, speed: float) -> tuple[float, float, float, float]:
    stiffness, damping = system.interfaces[a]["stiffness"], system.interfaces[a]["closing"]
    return stiffness * delta + damping * speed, stiffness, damping, damping


@kernel
def _beside(system: System, a: int, static_indentation: float, moved: float) -> float:
    return float(0.5 * system.interfaces[a]["stiffness"] * moved * moved)


CODE: Final = Code(_spring, _force, _beside)


class SpringDashpot(Law):
    """f = k d + c d': the numbers of a spring and a dashpot side by side, and what follows from them."""

    code: ClassVar = CODE
    straight: ClassVar = True
    varies: ClassVar = {"stiffness": "stiffness", "damping": "closing"}

    stiffness: float
    damping: float

    def settling_time(self, mass: Floats, columns: Mapping[str, Floats]) -> Floats | None:
        """Of a dashpot that pulls, at or beyond critical damping z: motion falls as exp(-w (z - sqrt(z^2 - 1)) t)."""
        if not self.tensile:
            return None
        k, c = (columns.get(word, np.array([getattr(self, word)])) for word in ("stiffness", "damping"))
        w, z = np.sqrt(k / mass), 0.5 * c / np.sqrt(k * mass)
        slowest = w * (z - np.sqrt(np.maximum(z * z - 1.0, 0.0)))
        return np.where(z < 1.0 - _ROUNDING, inf, SETTLED / np.where(z > 0.0, slowest, 1.0))

    @property
    def stored(self) -> StoredLaw:
        return StoredLaw(self.stiffness, self.damping)

    def indentation(self, force: float) -> float:
        """Indentation under a force at rest [m]."""
        return force / self.stiffness

    @staticmethod
    def rests(preload: Floats, laws: Records) -> Floats:
        rest: Floats = preload / laws["stiffness"]
        return rest

    @staticmethod
    def quickest(spring: Floats, dashpot: Floats, speed: Floats) -> Floats:
        return np.maximum(np.sqrt(spring), dashpot)


@stored_as("linear contact law/1")
@dataclass(frozen=True)
@checked("{word} law")
class Linear(SpringDashpot):
    """f = k d + c d', spring and dashpot side by side (Kelvin and Voigt): k and c, or the restitution with k or the
    duration of the contact. These count for the body alone against a wall, two bodies by their reduced mass. With
    tensile: true the restitution may be 0: nothing is given back, and the ends part only where something else pulls
    them apart, as a plate that swings back faster than a body falls.

    stiffness k [N/m]; damping c [N s/m]; tensile : let the dashpot pull while it opens (False clamps f >= 0). With
    damping the force jumps to c times the meeting speed at the first touch. Without tension the contact ends when the
    force is zero, the spring still indented by c / k times the parting speed: what it holds is lost in the dashpot.

    restitution, duration [s] with mass [kg] : in place of damping and stiffness, as in `returning`.

    >>> Linear(2e6, damping=100.0).indentation(1000.0)
    0.0005
    """

    word: ClassVar = "linear"
    one_of: ClassVar = (("stiffness", "duration"),)
    at_most_one_of: ClassVar = (("damping", "restitution"),)
    only_with: ClassVar = (("duration", ("restitution",)), ("mass", ("restitution",)))

    stiffness: PositiveStiffness = NOT_GIVEN
    damping: Dashpot = 0.0
    tensile: bool = False
    _: KW_ONLY
    restitution: InitVar[AnyRestitution | None] = None
    duration: InitVar[Duration | None] = None
    mass: InitVar[Annotated[MassKg | None, Key(None)]] = None

    def __post_init__(self, restitution: float | None, duration: float | None, mass: float | None) -> None:
        if restitution is None:
            return
        where = f"{self.word} law restitution"
        if mass is None:
            got = "a restitution between two ends without a body"
            raise InputError(where, got=got, expected="stiffness and damping, or a body with its mass")
        if not (restitution or self.tensile):
            do = f"for a blow that gives nothing back write 'tensile: true' beside it; {HARDLY}"
            raise InputError(where, got="0 of a contact that does not pull", expected="a positive value", do=do)
        if not restitution and duration is not None:
            expected = "a stiffness: ends that stay together do not part"
            raise InputError(where, got="0 with a duration", expected=expected, do="write 'stiffness'")
        made = self.returning(restitution, mass, duration, self.stiffness, self.tensile)
        freeze(self, stiffness=made.stiffness, damping=made.damping)

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

        With tension and a stiffness the restitution may be 0: the bodies stay together.

        Parameters
        ----------
        mass : float [kg]
            Of the body; two bodies that meet count with m1 m2 / (m1 + m2).
        duration : float | None [s]
            Of the contact, from the first touch to the end of its force; or the stiffness [N/m], and the duration
            follows.

        Raises
        ------
        InputError
            Unless 0 < restitution <= 1 (or 0 as above), mass and duration or stiffness are positive, and one of these
            two is given.

        Notes
        -----
        c = 2 z sqrt(k m) with z from `femstruct.laws.restitution.damping_ratio_for`; the contact lasts T = 2 swing(z)
        sqrt(m / k) without tension, and sqrt(pi^2 + ln^2 e) sqrt(m / k) with it.

        Examples
        --------
        >>> law = Linear.returning(0.5, mass=2.0, duration=0.01)
        >>> round(law.stiffness), round(law.damping, 3)
        (147456, 277.259)
        """
        refuse_unless_positive("linear law mass", mass)
        ratio = damping_ratio_for(restitution, tensile)
        if (duration is None) == (stiffness is None):
            raise InputError("linear law", got="both or neither", expected="either a duration or a stiffness")
        if duration is not None:
            refuse_unless_positive("linear law duration", duration)
            if not restitution:
                raise InputError(
                    "linear law",
                    got="a duration with restitution 0",
                    expected="a stiffness: bodies that stay together have no duration of contact",
                )
            angle = sqrt(pi**2 + log(restitution) ** 2) if tensile else 2.0 * swing(ratio)
            stiffness = mass * (angle / duration) ** 2
        assert stiffness is not None
        refuse_unless_positive("linear law stiffness", stiffness)
        return cls(stiffness, 2.0 * ratio * sqrt(stiffness * mass), tensile)
