"""Hunt and Crossley: a power of the indentation, and a dashpot that is a factor of it."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import Annotated, ClassVar, Final

from femstruct.arrays import Floats
from femstruct.compiled.kernels import kernel
from femstruct.compiled.records import Records, System
from femstruct.declared import checked
from femstruct.laws.law import Code, Dissipation, FactorLaw, Law, StoredLaw
from femstruct.laws.restitution import dissipation_for
from femstruct.quantities import PowerStiffness, Quantity
from femstruct.tags import stored_as


@kernel
def _spring(system: System, a: int, delta: float) -> tuple[float, float, float]:
    if delta <= 0.0:
        return 0.0, 0.0, 0.0
    exponent = system.interfaces[a]["shape"]
    slope = system.interfaces[a]["stiffness"] * delta ** (exponent - 1.0)
    return slope * delta, exponent * slope, slope * delta * delta / (exponent + 1.0)


CODE: Final = Code(_spring)  # its numbers: stiffness, chi, exponent
Exponent = Annotated[float, Quantity(("ratio",), least=1.0, most=9.0, too_small="", words="an exponent")]


class PowerLaw(Law):
    """f = k d^n (1 + chi d'), chi given or derived: what the engine keeps of it, and its indentations at rest."""

    code: ClassVar = CODE

    stiffness: float
    exponent: float

    @property
    @abstractmethod
    def dissipation(self) -> float:
        """Dissipation factor chi [s/m]."""

    @property
    def stored(self) -> StoredLaw:
        return StoredLaw(self.stiffness, self.dissipation, self.exponent)

    def indentation(self, force: float) -> float:
        """Indentation under a force at rest [m]."""
        return float((force / self.stiffness) ** (1.0 / self.exponent))

    @staticmethod
    def rests(preload: Floats, laws: Records) -> Floats:
        indentation: Floats = (preload / laws["stiffness"]) ** (1.0 / laws["shape"])
        return indentation


@stored_as("contact law of Hunt and Crossley/1")
@dataclass(frozen=True)
@checked("{word} law")
class HuntCrossley(PowerLaw, FactorLaw):
    """f = k d^n (1 + chi d'): two bodies of smooth or flat shape that lose energy.

    stiffness k [N/m^n]; exponent n >= 1, 1.5 for Hertz; dissipation chi [s/m]; tensile : let the dashpot pull while
    it opens faster than 1 / chi (False clamps f >= 0; a collision that nothing else pulls apart never gets there).
    In other notation the dashpot is lambda d^n d' with lambda = k chi.

    Raises InputError for a stiffness that is not positive, an exponent below 1, or a negative dissipation.

    References: Hunt and Crossley, J. Appl. Mech. 42 (1975) 440.

    >>> law = HuntCrossley.returning(0.6, speed=2.0, stiffness=1e8)
    >>> round(law.dissipation, 6)
    0.487436
    """

    word: ClassVar = "hunt-crossley"
    varies: ClassVar = {"stiffness": "stiffness", "exponent": "shape", "dissipation": "closing"}

    stiffness: Annotated[float, PowerStiffness()]
    exponent: Exponent = 1.5
    dissipation: Dissipation = 0.0
    tensile: bool = False

    @classmethod
    def returning(
        cls, restitution: float, speed: float, stiffness: float, exponent: float = 1.5, tensile: bool = False
    ) -> HuntCrossley:
        """The law that returns exactly this restitution when two bodies meet at this speed [m/s]; faster ones lose
        more."""
        return cls(stiffness, exponent, dissipation_for(restitution, speed), tensile)
