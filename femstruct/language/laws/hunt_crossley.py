"""`type: hunt-crossley`."""

from __future__ import annotations

from typing import Literal

from femstruct.impact.laws.hunt_crossley import HuntCrossley
from femstruct.language.laws.law import FactoredSpec, PowerSpec, Site


class HuntCrossleySpec(PowerSpec, FactoredSpec):
    """f = k d^n (1 + chi d'), exactly the restitution asked for; k in N/m^n, n = 1.5 unless given."""

    type: Literal["hunt-crossley"]

    def law(self, site: Site) -> HuntCrossley | None:
        chi = self.chi(site)
        return None if chi is None else HuntCrossley(self.stiffness, self.exponent, chi, self.tensile)
