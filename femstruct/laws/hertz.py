"""Hertz: two rounded bodies, with a dashpot beside the spring that touches as much as they do."""

from __future__ import annotations

from dataclasses import KW_ONLY, InitVar, dataclass
from math import inf, sqrt
from typing import Annotated, ClassVar, Final

import numpy as np

from femstruct.arrays import Floats, freeze
from femstruct.compiled.kernels import kernel
from femstruct.compiled.records import Records, System
from femstruct.declared import NOT_GIVEN, checked
from femstruct.errors import InputError
from femstruct.laws.law import Code, Law, StoredLaw, refuse_unless_positive
from femstruct.quantities import AnyRatio, Length, Modulus, Quantity
from femstruct.tags import stored_as


@kernel
def _spring(system: System, a: int, delta: float) -> tuple[float, float, float]:
    if delta <= 0.0:
        return 0.0, 0.0, 0.0
    stiffness, root = system.interfaces[a]["stiffness"], np.sqrt(delta)
    return stiffness * delta * root, 1.5 * stiffness * root, 0.4 * stiffness * delta * delta * root


@kernel
def _force(system: System, a: int, delta: float, speed: float) -> tuple[float, float, float, float]:
    if delta <= 0.0:
        return 0.0, 0.0, 0.0, 0.0
    stiffness, damping, root = system.interfaces[a]["stiffness"], system.interfaces[a]["closing"], np.sqrt(delta)
    force = root * (stiffness * delta + damping * speed)
    return force, 1.5 * stiffness * root + 0.5 * damping * speed / root, damping * root, damping * root


@kernel
def _beside(system: System, a: int, static_indentation: float, moved: float) -> float:
    """With r = sqrt(1 + x / d): k d^(5/2) (r - 1)^2 (0.4 r^3 + 0.8 r^2 + 1.2 r + 0.6)."""
    stiffness, share = system.interfaces[a]["stiffness"], moved / static_indentation
    r = np.sqrt(1.0 + share)
    beyond = share / (1.0 + r)
    return float(
        stiffness
        * static_indentation
        * static_indentation
        * np.sqrt(static_indentation)
        * beyond
        * beyond
        * (0.6 + r * (1.2 + r * (0.8 + r * 0.4)))
    )


CODE: Final = Code(_spring, _force, _beside)


@stored_as("contact law of Hertz/1")
@dataclass(frozen=True)
@checked("{word} law")
class Hertz(Law):
    """f = k d^1.5 + c d^0.5 d', two rounded bodies: their stiffness, or E and nu of both and the radius (one, or two)
    where they touch, that of the bodies themselves when a study file leaves it out.

    stiffness k [N/m^1.5]; damping c [N s/m^1.5]; tensile : let the dashpot pull while it opens (False clamps f >= 0).
    radius [m], E [Pa], nu : of both, as in `of_spheres`; one radius is that of a sphere on a flat face.

    >>> round(Hertz(1e6).indentation(1000.0), 6), Hertz("1 MN/m^1.5") == Hertz(1e6)
    (0.01, True)
    """

    word: ClassVar = "hertz"
    code: ClassVar = CODE
    varies: ClassVar = {"stiffness": "stiffness", "damping": "closing"}
    one_of: ClassVar = (("stiffness", "E"),)
    only_with: ClassVar = (("radius", ("E", "nu")), ("E", ("nu",)), ("nu", ("E",)))

    stiffness: Annotated[float, Quantity(("hertz stiffness",), above=0.0)] = NOT_GIVEN
    damping: Annotated[float, Quantity(("hertz damping",), least=0.0)] = 0.0
    tensile: bool = False
    _: KW_ONLY
    radius: InitVar[Length | tuple[Length, ...] | None] = None
    E: InitVar[tuple[Modulus, Modulus] | None] = None
    nu: InitVar[tuple[AnyRatio, AnyRatio] | None] = None

    def __post_init__(
        self,
        radius: float | tuple[float, ...] | None,
        E: tuple[float, float] | None,
        nu: tuple[float, float] | None,
    ) -> None:
        if E is None or nu is None:
            return
        if radius is None:
            do = "add 'radius: 5 mm', or the radius of the body"
            raise InputError("hertz law", got="a hertz law without a radius", expected="one", do=do)
        first, *second = radius if isinstance(radius, tuple) else (radius,)
        freeze(self, stiffness=self.of_spheres((first, second[0] if second else inf), E, nu).stiffness)

    @classmethod
    def of_spheres(cls, radius: tuple[float, float], E: tuple[float, float], nu: tuple[float, float]) -> Hertz:
        """Two elastic spheres: k = 4/3 E* sqrt(R), 1/E* = sum (1 - nu^2) / E, 1/R = sum 1 / radius, without loss.

        radius [m], infinite for a flat face; E [Pa].

        Parameters
        ----------
        nu : tuple[float, float]
            Poisson's ratios.

        References
        ----------
        Johnson, Contact Mechanics (1985), equations 4.22 and 4.23.

        Examples
        --------
        >>> f"{Hertz.of_spheres((5e-3, float('inf')), (5.9e9, 210e9), (0.34, 0.34)).stiffness:.2g}"
        '6.1e+08'
        """
        for word, pair in (("radius", radius), ("E", E)):
            for value in pair:
                refuse_unless_positive(f"hertz law {word}", value)
        if not all(-1.0 < one <= 0.5 for one in nu):
            raise InputError("hertz law nu", got=f"{nu[0]:g} and {nu[1]:g}", expected="values from -1 to 0.5")
        curvature = sum(1.0 / one for one in radius)
        if not curvature > 0.0:
            raise InputError("hertz law radius", got="two flat faces", expected="one of them round")
        plane = 1.0 / sum((1.0 - n * n) / e for n, e in zip(nu, E, strict=True))
        return cls(4.0 / 3.0 * plane / sqrt(curvature))

    @property
    def stored(self) -> StoredLaw:
        return StoredLaw(self.stiffness, self.damping)

    def indentation(self, force: float) -> float:
        """Indentation under a force at rest [m]."""
        return float((force / self.stiffness) ** (2.0 / 3.0))

    @staticmethod
    def rests(preload: Floats, laws: Records) -> Floats:
        indentation: Floats = (preload / laws["stiffness"]) ** (1.0 / 1.5)
        return indentation

    @staticmethod
    def quickest(spring: Floats, dashpot: Floats, speed: Floats) -> Floats:
        return np.maximum(spring**0.4 * speed**0.2, (dashpot * np.sqrt(speed)) ** (2.0 / 3.0))
