"""`type: lankarani-nikravesh`."""

from __future__ import annotations

from typing import Literal

from femstruct.impact.laws.lankarani_nikravesh import LankaraniNikravesh
from femstruct.language.laws.law import PublishedSpec


class LankaraniNikraveshSpec(PublishedSpec):
    """f = k d^n (1 + chi d') with the published chi = 3 (1 - e^2) / (4 v): for restitutions near 1 only."""

    makes = LankaraniNikravesh
    type: Literal["lankarani-nikravesh"]
