"""Stop: a bumper on both sides."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from femstruct.laws.linear import Linear
from femstruct.tags import stored_as


@stored_as("contact law of a stop/1")
@dataclass(frozen=True)
class Stop(Linear):
    """A bumper on both sides: a linear contact where the ends have moved further than the gap, towards or apart.

    stiffness k [N/m]; damping c [N s/m]; tensile : let the dashpot pull while it opens.

    >>> Stop(2e6).sides
    (1.0, -1.0)
    """

    word: ClassVar = "stop"
    sides: ClassVar = (1.0, -1.0)
