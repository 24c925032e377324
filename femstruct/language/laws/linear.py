"""`type: linear`."""

from __future__ import annotations

from typing import Annotated, Literal

from femstruct.impact.laws.linear import Linear
from femstruct.language.laws.law import LawSpec, Positive, Restitution, Site
from femstruct.language.model.directions import Dashpot
from femstruct.language.yaml import Quantity


class LinearSpec(LawSpec):
    """f = k d + c d', spring and dashpot side by side (Kelvin and Voigt): k and c, or the restitution with k or with
    the duration of the contact. These count for the body alone against a wall, two bodies by their reduced mass."""

    one_of = (("stiffness", "duration"),)
    at_most_one_of = (("damping", "restitution"),)
    needs = (("duration", ("restitution",)),)

    type: Literal["linear"]
    stiffness: Positive | None = None
    damping: Dashpot = 0.0
    restitution: Restitution | None = None
    duration: Annotated[float, Quantity(("time",), above=0.0)] | None = None

    def law(self, site: Site) -> Linear | None:
        if self.restitution is None:
            assert self.stiffness is not None
            return Linear(self.stiffness, self.damping, self.tensile)
        if site.ends.mass is None:
            site.here.at("restitution").wrong("a restitution between two ends without a body", "stiffness and damping")
            return None
        return Linear.returning(self.restitution, site.ends.mass, self.duration, self.stiffness, self.tensile)
