"""`type: flores`."""

from __future__ import annotations

from typing import Literal

from femstruct.impact.laws.flores import Flores
from femstruct.language.laws.law import PublishedSpec


class FloresSpec(PublishedSpec):
    """f = k d^n (1 + chi d') with the published chi = 8 (1 - e) / (5 e v): returns a little less than asked for."""

    makes = Flores
    type: Literal["flores"]
