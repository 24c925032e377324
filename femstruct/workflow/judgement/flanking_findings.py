"""Which walls of a room that several surfaces move are left rigid: flanking is never more complete than its model."""

from __future__ import annotations

from typing import Final

from femstruct.errors import Finding
from femstruct.study.asked import RoomPlan
from femstruct.study.room_surfaces import placed_room
from femstruct.workflow.stages.places import Places

COVERED: Final = 0.95  # share of a wall from which on all of it moves


def flanking_findings(plan: RoomPlan, places: Places) -> tuple[Finding, ...]:
    """A finding on a room among several surfaces, parts of whose walls are rigid."""
    if len(plan.moved) < 2 or not all(name in places.surfaces for _, name in plan.moved):
        return ()
    room = placed_room(plan, places.surfaces)
    areas = dict.fromkeys(plan.room.movable, 0.0)
    for (wall, _), surface in zip(plan.moved, room.surfaces, strict=True):
        areas[wall] += float(surface.weights.sum())
    shares = {wall: area / plan.room.wall_area(wall) for wall, area in areas.items()}
    rigid = [wall for wall, share in shares.items() if share == 0.0]
    partly = [f"{100 * (1 - share):.0f} % of {wall}" for wall, share in shares.items() if 0.0 < share < COVERED]
    if not rigid and not partly:
        return ()
    told = ", ".join([*rigid, *partly])
    missing = sum(plan.room.wall_area(wall) - area for wall, area in areas.items())
    return (
        Finding(
            "flanking-incomplete",
            f"{told} of the room has no surface that moves: what it would radiate is not in the levels, nor in the "
            "shares of the surfaces",
            {"walls_rigid": len(rigid), "rigid_m2": missing},
        ),
    )
