"""`type: hunt-crossley`."""

from __future__ import annotations

from typing import Literal

from femstruct.impact.laws.hunt_crossley import HuntCrossley
from femstruct.language.laws.law import FactoredSpec, PowerSpec


class HuntCrossleySpec(PowerSpec, FactoredSpec):
    """f = k d^n (1 + chi d'), exactly the restitution asked for; k in N/m^n, n = 1.5 unless given."""

    makes = HuntCrossley
    type: Literal["hunt-crossley"]
