"""The own sound of striking bodies in open air: which of them, where they are, and what is left out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from acoustics.errors import AcousticsError, Advice
from acoustics.levels.sound_levels import Levels, response_levels
from acoustics.open_air.sphere import TOUCHING, refuse_inside, sphere_pressures
from acoustics.room_response import RoomResponse
from femstruct.arrays import Floats
from femstruct.errors import Finding, InputError, some_of
from femstruct.impact.result.response import Response
from femstruct.sound.impactor import moved_advice, sphere_of
from femstruct.study.acting import PlacedBody
from femstruct.study.asked import RoomPlan
from femstruct.study.result import OwnSound
from femstruct.study.room_surfaces import placed_room
from femstruct.study.study import Study
from femstruct.workflow.stages.places import Places


def spheres_before(plan: RoomPlan, study: Study, places: Places) -> dict[str, tuple[float, Floats]]:
    """Radius [m] and centre [3] [m] of all bodies with a radius that are in the air of a half space, by name.

    Centres are in the coordinates of the half space, from its surface's centre. Empty for a room.

    Raises InputError for a receiver inside a sphere.

    Notes
    -----
    A body is its radius above (below) what it is placed on, where it is pushed; what gap there is at the start is then
    closed. A body that is placed on another one is above the top of its sphere.
    """
    space = plan.room.open_air
    if space is None or not plan.receivers:
        return {}
    found = {}
    for body in study.bodies:
        centre = _from_surface(body, plan, study, places)
        height = None if centre is None else float(centre @ space.normal)
        if body.radius is None or centre is None or height is None or height < body.radius * (1 - TOUCHING):
            continue
        if _upward(body) * space.normal[2] < 0:  # placed below what is above the surface
            continue
        try:
            refuse_inside(body.radius, centre, plan.receivers)
        except AcousticsError as error:
            raise InputError(f"rooms.{plan.name}.receivers", got=error.got, expected=error.expected) from error
        found[body.name] = (body.radius, centre)
    return found


def sound_of_bodies(
    study: Study,
    places: Places,
    response: Response,
    rooms: Mapping[str, RoomResponse],
    whole: Mapping[str, RoomResponse],
) -> OwnSound:
    """The own sound of striking bodies in open air, and the total with that of the structure, by room.

    rooms : of the structure, which end where its modes do; whole : the same before.

    Raises InputError as `spheres_before` does.
    """
    sounds = {plan.name: _own_sound(plan, study, places, response) for plan in study.rooms if plan.name in rooms}
    own = {name: one for name, one in sounds.items() if one is not None}
    total = {name: replace(rooms[name], p=rooms[name].p + one.p, findings=()) for name, one in own.items()}
    both = {name: replace(total[name], p=whole[name].p + one.p) for name, one in own.items()}
    return OwnSound(own, total, levels_by_receiver(own, own), levels_by_receiver(total, both))


def levels_by_receiver(rooms: Mapping[str, RoomResponse], whole: Mapping[str, RoomResponse]) -> dict[str, Levels]:
    """Levels of the pressures in rooms, by "ROOM.RECEIVER"; their bands of the whole pressures, before they ended."""
    return {
        f"{room}.{receiver}": levels
        for room, response in rooms.items()
        for receiver, levels in response_levels(response, whole[room]).items()
    }


def _own_sound(plan: RoomPlan, study: Study, places: Places, response: Response) -> RoomResponse | None:
    """Pressures that the bodies in the air of a half space make themselves; None where there are none."""
    placed, space = spheres_before(plan, study, places), plan.room.open_air
    if not placed or space is None:
        return None
    spheres = [sphere_of(response, name, *sphere, space) for name, sphere in placed.items()]
    heard = sphere_pressures(spheres, space, plan.receivers)
    moved = [advice for name, (radius, _) in placed.items() for advice in moved_advice(response, name, radius)]
    return replace(heard, findings=(*heard.findings, *moved))


def own_findings(
    study: Study, places: Places, response: Response, heard: OwnSound
) -> list[tuple[str, Advice | Finding]]:
    """How far to trust the sound of bodies, by room; bodies that strike on the side of receivers and are
    not heard; radii of no use."""
    told: list[tuple[str, Advice | Finding]] = [(name, one) for name, own in heard.own.items() for one in own.findings]
    sounding: set[str] = set()
    for plan in study.rooms:
        sounding |= spheres_before(plan, study, places).keys()
        silent = [body.name for body in study.bodies if _left_out(body, plan, study, places, response)]
        if silent:
            verb = "strike" if len(silent) > 1 else "strikes"
            told.append(
                (
                    plan.name,
                    Finding(
                        "own-sound-left-out",
                        f"{some_of(silent)} {verb} on the side of the receivers: its direct sound is not computed, "
                        "which may "
                        "be louder than that of the surface at high frequencies. Give a 'radius' if the body is "
                        "roughly "
                        "spherical",
                        {"bodies": len(silent)},
                    ),
                )
            )
    listening = [plan for plan in study.rooms if plan.room.open_air is not None and plan.receivers]
    for body in study.bodies:
        if body.radius is not None and body.name not in sounding and listening:
            finding = Finding(
                "radius-unused",
                f"{body.name} is not in front of the surface of {some_of(plan.name for plan in listening)}: its "
                f"radius of {1e3 * body.radius:g} mm has no effect",
                {"radius_m": body.radius},
            )
            told.append((body.name, finding))
    return told


def _left_out(body: PlacedBody, plan: RoomPlan, study: Study, places: Places, response: Response) -> bool:
    """Whether a body without a radius strikes something in the air of a half space with receivers."""
    space = plan.room.open_air
    if body.radius is not None or space is None or not plan.receivers:
        return False
    centre = _from_surface(body, plan, study, places)
    strikes = any(
        response.contacts[contact.name].closings
        for contact in response.scene.contacts
        if body.name in (contact.upper, contact.lower)
    )
    on_side = _upward(body) * space.normal[2] > 0
    return strikes and on_side and centre is not None and float(centre @ space.normal) > -1e-9


def _from_surface(body: PlacedBody, plan: RoomPlan, study: Study, places: Places) -> Floats | None:
    """Centre of a body from that of a surface [3] [m]; None for one that moves along x, or over the ground."""
    if body.side not in ("above", "below"):
        return None
    found = _centre(body, {one.name: one for one in study.bodies}, places, ())
    if found is None:
        return None
    return np.asarray(found - placed_room(plan, places.surfaces).first.centre)


def _centre(body: PlacedBody, bodies: Mapping[str, PlacedBody], places: Places, seen: Sequence[str]) -> Floats | None:
    """Centre of a body when it touches what it is placed on, global axes [3] [m]."""
    if body.target == "ground" or body.name in seen:
        return None
    radii, carrier = body.radius or 0.0, bodies.get(body.target)
    if carrier is None:
        at = places.point(body.target, f"bodies.{body.name}").position
    else:
        found = _centre(carrier, bodies, places, (*seen, body.name))
        if found is None:
            return None
        at, radii = found, radii + (carrier.radius or 0.0)
    centre: Floats = at + np.array([0.0, 0.0, _upward(body) * radii])
    return centre


def _upward(body: PlacedBody) -> float:
    return 1.0 if body.side == "above" else -1.0
