"""`type: barrier`."""

from typing import Literal

from femstruct.language.laws import FactoredSpec, Positive
from femstruct.quantities import Length
from femstruct_guest.barrier import Barrier


class BarrierSpec(FactoredSpec):
    """f = k d (1 + (d / depth)^4) (1 + chi d')."""

    makes = Barrier
    type: Literal["barrier"]
    stiffness: Positive
    depth: Length
