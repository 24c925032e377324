"""`type: flores`."""

from __future__ import annotations

from typing import Literal

from femstruct.impact.laws.flores import Flores
from femstruct.language.laws.law import MeetingSpeed, PowerSpec, Restitution, Site


class FloresSpec(PowerSpec):
    """f = k d^n (1 + chi d') with the published chi = 8 (1 - e) / (5 e v): returns a little less than asked for."""

    type: Literal["flores"]
    restitution: Restitution
    at_speed: MeetingSpeed | None = None

    def law(self, site: Site) -> Flores | None:
        speed = site.meeting_speed(self.at_speed)
        return None if speed is None else Flores(self.stiffness, self.restitution, speed, self.exponent, self.tensile)
