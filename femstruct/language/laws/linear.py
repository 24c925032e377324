"""`type: linear`."""

from __future__ import annotations

from typing import Annotated, Literal

from femstruct.impact.laws.linear import Linear
from femstruct.language.laws.law import HARDLY, AnyRestitution, LawSpec, Positive, Site
from femstruct.language.model.directions import Dashpot
from femstruct.language.yaml import Quantity


class LinearSpec(LawSpec):
    """f = k d + c d', spring and dashpot side by side (Kelvin and Voigt): k and c, or the restitution with k or with
    the duration of the contact. These count for the body alone against a wall, two bodies by their reduced mass. With
    tensile: true the restitution may be 0: nothing is given back, and the ends part only where something else pulls
    them apart, as a plate that swings back faster than a body falls."""

    one_of = (("stiffness", "duration"),)
    at_most_one_of = (("damping", "restitution"),)
    needs = (("duration", ("restitution",)),)

    type: Literal["linear"]
    stiffness: Positive | None = None
    damping: Dashpot = 0.0
    restitution: AnyRestitution | None = None
    duration: Annotated[float, Quantity(("time",), above=0.0)] | None = None

    def law(self, site: Site) -> Linear | None:
        if self.restitution is None:
            assert self.stiffness is not None
            return Linear(self.stiffness, self.damping, self.tensile)
        if site.ends.mass is None:
            site.here.at("restitution").wrong("a restitution between two ends without a body", "stiffness and damping")
            return None
        if not self.restitution:
            there = site.here.at("restitution")
            if not self.tensile:
                there.wrong(
                    "0 of a contact that does not pull",
                    "a positive value",
                    f"for a blow that gives nothing back write 'tensile: true' beside it; {HARDLY}",
                )
                return None
            if self.stiffness is None:
                there.wrong(
                    "0 with a duration", "a stiffness: ends that stay together do not part", "write 'stiffness'"
                )
                return None
        return Linear.returning(self.restitution, site.ends.mass, self.duration, self.stiffness, self.tensile)
