"""`type: stop`."""

from __future__ import annotations

from typing import Literal

from femstruct.impact.laws.stop import Stop
from femstruct.language.laws.law import LawSpec, Positive
from femstruct.language.model.directions import Dashpot


class StopSpec(LawSpec):
    """A bumper on both sides."""

    makes = Stop
    type: Literal["stop"]
    stiffness: Positive
    damping: Dashpot = 0.0
