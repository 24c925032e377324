"""The air that pushes back: bases of structures joined to the rooms of a study whose coupling is two-way."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence

from acoustics.field import HalfSpace
from acoustics.room import Room
from acoustics.shaped import ShapedRoom
from acoustics.walls import YieldingWall
from femstruct.coupling import with_cavity
from femstruct.errors import Finding, InputError
from femstruct.modal.basis import ModalBasis
from femstruct.model.probe import Surface
from femstruct.study.study import RoomPlan
from femstruct.workflow.places import Places


def ceiling(plan: RoomPlan, places: Places) -> Surface:
    """The surface a room lies under.

    Raises InputError when the structure has no such surface.
    """
    if plan.under not in places.surfaces:
        raise InputError(
            f"rooms.{plan.name}.under", got=f"'{plan.under}'", expected=", ".join(places.surfaces) or "a surface"
        )
    return places.surfaces[plan.under]


def coupled(
    basis: ModalBasis, rooms: Sequence[RoomPlan], places: Places
) -> tuple[ModalBasis, list[tuple[str, Finding]]]:
    """The basis with the air of all rooms whose coupling is two-way, and what is to be known of it, by room.

    basis : in vacuo, damped; rooms are joined to it one after the other.
    """
    told: list[tuple[str, Finding]] = []
    for plan in rooms:
        if plan.coupling == "two-way" and not isinstance(plan.room, HalfSpace):
            known = len(basis.findings)
            surface = ceiling(plan, places)
            basis = with_cavity(basis, surface, plan.room, plan.offset, leak=plan.leak, name=plan.name)
            told += [(plan.name, found) for found in basis.findings[known:]]
    return basis, told


def coupled_key(key: str, rooms: Sequence[RoomPlan]) -> str:
    """The name of a basis joined to rooms: that of the structure alone where none pushes back."""
    joined = [
        (plan.name, plan.under, plan.offset, _shape(plan.room), plan.room.air.c, plan.room.air.rho)
        + (() if plan.leak is None else (plan.leak.inertance,))
        for plan in rooms
        if plan.coupling == "two-way"
    ]
    return hashlib.sha256(repr((key, joined)).encode()).hexdigest()[:12] if joined else key


def _shape(room: Room | ShapedRoom | HalfSpace) -> object:
    """What tells rooms apart, but for their air."""
    if isinstance(room, ShapedRoom):
        cells = hashlib.sha256(room.mesh.points.tobytes() + room.mesh.cells.tobytes()).hexdigest()
        yielding = {name: wall for name, wall in room.walls.items() if isinstance(wall, YieldingWall)}
        springs = [(name, wall.mass, wall.stiffness) for name, wall in sorted(yielding.items())]
        return cells, room.ceiling, room.up_to_hz, springs
    return room.size.tolist() if isinstance(room, Room) else ()
