"""The rooms of a study beside the surfaces of its structure."""

from __future__ import annotations

from collections.abc import Mapping

from femstruct.errors import InputError, list_some
from femstruct.model.probe import Surface
from femstruct.sound.placed import Placed, placed
from femstruct.study.asked import RoomPlan


def placed_room(plan: RoomPlan, surfaces: Mapping[str, Surface]) -> Placed:
    """A room where its surfaces place it.

    Parameters
    ----------
    surfaces : Mapping[str, Surface]
        Of the structure, by name.

    Raises
    ------
    InputError
        When the structure has no such surface, and as `placed` does.
    """
    others: dict[str, list[Surface]] = {}
    for number, (wall, name) in enumerate(plan.moved):
        key = f"surfaces.{wall}" if number or plan.on else "under"
        if name not in surfaces:
            raise InputError(f"rooms.{plan.name}.{key}", got=f"'{name}'", expected=list_some(surfaces) or "a surface")
        if number:
            others.setdefault(wall, []).append(surfaces[name])
    return placed(plan.room, surfaces[plan.under], plan.offset, plan.name, others, plan.on)
