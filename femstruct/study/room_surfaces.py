"""The rooms of a study beside the surfaces of its structure."""

from __future__ import annotations

from collections.abc import Mapping

from femstruct.errors import InputError, some_of
from femstruct.model.probe import Surface
from femstruct.sound.placed import Placed, placed
from femstruct.study.asked import RoomPlan


def placed_room(plan: RoomPlan, surfaces: Mapping[str, Surface]) -> Placed:
    """A room where its surfaces place it. surfaces : of the structure, by name.

    Raises InputError when the structure has no such surface, and as `placed` does.
    """
    for key, name in (("under", plan.under), *((f"walls.{wall}", name) for wall, name in plan.walls.items())):
        if name not in surfaces:
            raise InputError(f"rooms.{plan.name}.{key}", got=f"'{name}'", expected=some_of(surfaces) or "a surface")
    others = {wall: surfaces[name] for wall, name in plan.walls.items()}
    return placed(plan.room, surfaces[plan.under], plan.offset, plan.name, others)
