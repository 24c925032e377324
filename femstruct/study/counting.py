"""Fatigue as it is asked for: whose cycles are counted, and by what line they do damage."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from femstruct.declared import checked
from femstruct.tags import stored_as

if TYPE_CHECKING:  # a model's modes need none of it
    from femstruct.impact.result.fatigue import SNLine


@stored_as("fatigue request/1")
@dataclass(frozen=True)
@checked("fatigue")
class FatigueRequest:
    """Rainflow cycles of a recorded channel, and the damage they do by an S-N line; of a stress, at the place of its
    part with the most damage, on the worst plane. under : the random excitation of `vibration` that it answers, with a
    duration; "" for the history in time.

    A weld of detail category 71 in a portal:

    >>> from femstruct import SNLine
    >>> FatigueRequest("weld", "portal stress", SNLine(71e6, category=True)).sn.slope
    3.0
    """

    name: str
    of: str
    sn: SNLine | None = None
    under: str = ""
