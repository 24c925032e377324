"""What a room is beside the surfaces that move it: walls that are left rigid, microphones too near to what radiates."""

from __future__ import annotations

from typing import Final

from femstruct.errors import Finding, some_of
from femstruct.study.asked import RoomPlan
from femstruct.study.room_surfaces import placed_room
from femstruct.study.study import Study
from femstruct.workflow.stages.places import Places
from femstruct.workflow.stages.rated_rooms import method_for

COVERED: Final = 0.95  # share of a wall from which on all of it moves
ROUNDING: Final = 1e-9  # m
NEAR_M: Final = 0.5  # of a microphone from a boundary, at least: ISO 16283-2


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


def near_microphones(plan: RoomPlan, study: Study, places: Places) -> tuple[Finding, ...]:
    """A finding on a rated room with microphones nearer to a surface that moves than its standard allows."""
    if method_for(plan, study) is None or not all(name in places.surfaces for _, name in plan.moved):
        return ()
    room = placed_room(plan, places.surfaces)
    found: dict[str, tuple[float, str]] = {}
    for surface in room.surfaces:
        for one in plan.receivers:
            off = abs(float((room.from_room(one.position) - surface.centre) @ surface.normal))
            if off < NEAR_M - ROUNDING:
                found[one.name] = min((off, surface.name), found.get(one.name, (off, surface.name)))
    if not found:
        return ()
    nearest, (off, surface_name) = min(found.items(), key=lambda one: one[1][0])
    return (
        Finding(
            "microphone-near-surface",
            f"{some_of(found)}: nearer than {NEAR_M:g} m to a surface that radiates ({nearest}: {off:.2g} m from "
            f"{surface_name}). At a wall levels are up to 3 dB above those of the room",
            {"distance_m": off, "wanted_m": NEAR_M, "microphones": len(found)},
        ),
    )
