"""`type: lankarani-nikravesh`."""

from __future__ import annotations

from typing import Literal

from femstruct.impact.laws.lankarani_nikravesh import LankaraniNikravesh
from femstruct.language.laws.law import MeetingSpeed, PowerSpec, Restitution, Site


class LankaraniNikraveshSpec(PowerSpec):
    """f = k d^n (1 + chi d') with the published chi = 3 (1 - e^2) / (4 v): for restitutions near 1 only."""

    type: Literal["lankarani-nikravesh"]
    restitution: Restitution
    at_speed: MeetingSpeed | None = None

    def law(self, site: Site) -> LankaraniNikravesh | None:
        speed = site.meeting_speed(self.at_speed)
        if speed is None:
            return None
        return LankaraniNikravesh(self.stiffness, self.restitution, speed, self.exponent, self.tensile)
