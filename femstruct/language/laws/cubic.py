"""`type: cubic`."""

from __future__ import annotations

from typing import Annotated, Literal

from femstruct.impact.laws.cubic import Cubic
from femstruct.language.laws.law import FactoredSpec
from femstruct.language.model.directions import Stiffness
from femstruct.language.yaml import Quantity


class CubicSpec(FactoredSpec):
    """f = (k d + k3 d^3) (1 + chi d')."""

    makes = Cubic
    type: Literal["cubic"]
    stiffness: Stiffness = 0.0
    cubic: Annotated[float, Quantity(("stiffness/area",), above=0.0)]
