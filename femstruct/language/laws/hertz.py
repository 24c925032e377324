"""`type: hertz`."""

from __future__ import annotations

from math import inf
from typing import Annotated, Literal

from pydantic import Field

from femstruct.impact.laws.hertz import Hertz
from femstruct.language.laws.law import LawSpec, Site
from femstruct.language.model.material import Modulus
from femstruct.language.yaml import AnyRatio, Length, Quantity, read_by


def _radii(value: object) -> object:
    """One radius, of a sphere on a flat face, or two."""
    return value if isinstance(value, list) else [value]


class HertzSpec(LawSpec):
    """f = k d^1.5 + c d^0.5 d', two rounded bodies: their stiffness, or E and nu of both and the radius (one, or two)
    where they touch, that of the bodies themselves when left out."""

    one_of = (("stiffness", "E"),)
    needs = (("radius", ("E", "nu")), ("E", ("nu",)), ("nu", ("E",)))

    type: Literal["hertz"]
    stiffness: Annotated[float, Quantity(("hertz stiffness",), above=0.0)] | None = None
    radius: (
        Annotated[
            tuple[Length, ...], Field(min_length=1, max_length=2), read_by(_radii, Length | tuple[Length, Length])
        ]
        | None
    ) = None
    E: tuple[Modulus, Modulus] | None = None
    nu: tuple[AnyRatio, AnyRatio] | None = None
    damping: Annotated[float, Quantity(("hertz damping",), least=0.0)] = 0.0

    @property
    def takes_radius(self) -> bool:
        return self.stiffness is None and self.radius is None

    def law(self, site: Site) -> Hertz | None:
        stiffness = self.stiffness
        if self.E is not None and self.nu is not None:
            radii = site.ends.radii
            if self.radius is not None:
                first, *second = self.radius
                radii = (first, second[0] if second else inf)
            if radii is None:
                site.here.wrong("a hertz law without a radius", "one", "add 'radius: 5 mm', or the radius of the body")
                return None
            stiffness = Hertz.of_spheres(radii, self.E, self.nu).stiffness
        assert stiffness is not None
        return Hertz(stiffness, self.damping, self.tensile)
