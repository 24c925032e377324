"""Rooms rated by standards, and reasons not to take their numbers for measured ones."""

from __future__ import annotations

from collections.abc import Mapping

from acoustics.errors import Advice
from acoustics.judgement import t60_missed
from acoustics.levels import Levels
from acoustics.rated import HIGHEST_HZ, RatedRoom, rate_room
from femstruct.errors import Finding
from femstruct.modal.basis import ModalBasis
from femstruct.study.study import RoomPlan, Study

BALL = "rubber ball"


def rate_rooms(study: Study, heard: Mapping[str, Levels]) -> dict[str, RatedRoom]:
    """Every room that is to be rated, by name, from the levels of its receivers ("ROOM.RECEIVER")."""
    return {
        plan.name: rate_room([heard[f"{plan.name}.{one.name}"] for one in plan.receivers], plan.room, plan.levels)
        for plan in study.rooms
        if plan.levels and plan.receivers
    }


def rated_findings(plan: RoomPlan, study: Study, basis: ModalBasis) -> tuple[Advice | Finding, ...]:
    """Reverberation times missed, bands without modes, and blows that the standards do not rate."""
    found: list[Advice | Finding] = list(t60_missed(plan.room.losses, plan.t60_asked))
    if not (plan.levels and plan.receivers):
        return tuple(found)
    if basis.complete_below_hz < HIGHEST_HZ:
        found.append(
            Finding(
                "rating-beyond-modes",
                f"the rated bands go up to {HIGHEST_HZ:.0f} Hz, the modes of the floor to "
                f"{basis.complete_below_hz:.0f} Hz: levels above are too low",
                {"highest_hz": HIGHEST_HZ, "complete_below_hz": basis.complete_below_hz},
            )
        )
    struck = [body for body in study.bodies if body.speed and body.side == "above"]
    others = [body.source or body.name for body in struck if body.source != BALL]
    balls = len(struck) - len(others)
    if others or balls != 1 or study.loads:
        told = ", ".join(dict.fromkeys([*others, *(load.name for load in study.loads)]))
        found.append(
            Finding(
                "rating-of-other-blows",
                f"the levels of {' and '.join(plan.levels)} are those of one rubber ball; here strike {balls} rubber "
                f"balls{' and ' + told if told else ''}",
                {"rubber_balls": balls, "others": len(others) + len(study.loads)},
            )
        )
    return tuple(found)
