"""`type: barrier`."""

from typing import Literal

from femstruct.language.laws.law import FactoredSpec, Positive
from femstruct.language.yaml.spec import Length
from femstruct_guest.barrier import Barrier


class BarrierSpec(FactoredSpec):
    """f = k d (1 + (d / depth)^4) (1 + chi d')."""

    type: Literal["barrier"]
    stiffness: Positive
    depth: Length

    def law(self, site):
        chi = self.chi(site)
        return None if chi is None else Barrier(self.stiffness, self.depth, chi, self.tensile)
