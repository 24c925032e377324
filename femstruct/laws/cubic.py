"""Cubic: a spring that stiffens."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar, Final

import scipy

from femstruct.compiled.kernels import kernel
from femstruct.compiled.records import System
from femstruct.declared import Key, checked
from femstruct.errors import InputError
from femstruct.laws.law import Code, Dissipation, FactorLaw, StoredLaw
from femstruct.quantities import Quantity, Stiffness
from femstruct.tags import stored_as


@kernel
def _spring(system: System, a: int, delta: float) -> tuple[float, float, float]:
    square, stiffness, cubic = delta * delta, system.interfaces[a]["stiffness"], system.interfaces[a]["shape"]
    return (
        (stiffness + cubic * square) * delta,
        stiffness + 3.0 * cubic * square,
        (0.5 * stiffness + 0.25 * cubic * square) * square,
    )


@kernel
def _beside(system: System, a: int, static_indentation: float, moved: float) -> float:
    stiffness, cubic = system.interfaces[a]["stiffness"], system.interfaces[a]["shape"]
    square = 1.5 * static_indentation * static_indentation + moved * (static_indentation + 0.25 * moved)
    return float((0.5 * stiffness + cubic * square) * moved * moved)


CODE: Final = Code(_spring, beside=_beside)


@stored_as("cubic contact law/1")
@dataclass(frozen=True)
@checked("{word} law")
class Cubic(FactorLaw):
    """f = (k d + k3 d^3) (1 + chi d'): a spring that stiffens, such as a rubber pad or a strip of felt.

    stiffness k [N/m]; cubic k3 [N/m^3]; dissipation chi [s/m]; tensile : let the dashpot pull.

    Raises InputError for a negative value, or when both k and k3 are zero.

    >>> Cubic(1e4, 1e10).indentation(20.0)
    0.001
    """

    word: ClassVar = "cubic"
    code: ClassVar = CODE
    varies: ClassVar = {"stiffness": "stiffness", "cubic": "shape", "dissipation": "closing"}

    stiffness: Annotated[Stiffness, Key(default=0.0)]
    cubic: Annotated[float, Quantity(("stiffness/area",), least=0.0)]
    dissipation: Dissipation = 0.0
    tensile: bool = False

    def __post_init__(self, restitution: float | None, at_speed: float | None) -> None:
        super().__post_init__(restitution, at_speed)
        if not (self.stiffness or self.cubic):
            raise InputError("cubic law", got="no stiffness", expected="a stiffness, a cubic stiffness, or both")

    @property
    def stored(self) -> StoredLaw:
        return StoredLaw(self.stiffness, self.dissipation, self.cubic)

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
