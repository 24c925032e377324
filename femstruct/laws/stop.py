"""Stop: a bumper on both sides."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from femstruct.declared import checked
from femstruct.laws.law import PositiveStiffness
from femstruct.laws.linear import SpringDashpot
from femstruct.quantities import Dashpot
from femstruct.tags import stored_as


@stored_as("contact law of a stop/1")
@dataclass(frozen=True)
@checked("{word} law")
class Stop(SpringDashpot):
    """A bumper on both sides: a linear contact where the ends have moved further than the gap, towards or apart.

    stiffness k [N/m]; damping c [N s/m]; tensile : let the dashpot pull while it opens.

    >>> Stop(2e6).sides
    (1.0, -1.0)
    """

    word: ClassVar = "stop"
    sides: ClassVar = (1.0, -1.0)

    stiffness: PositiveStiffness
    damping: Dashpot = 0.0
    tensile: bool = False
