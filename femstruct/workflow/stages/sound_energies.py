"""Sound energies: what the surfaces of a study send into the open in a record, and which gives what to a room."""

from __future__ import annotations

from typing import Final

from acoustics.errors import Advice
from femstruct.errors import Finding
from femstruct.impact.result.response import Response
from femstruct.sound.flanking import SurfaceShares, leak_apart, surface_shares
from femstruct.sound.power import Radiated, not_taken, radiated_by
from femstruct.sound.surface import moving_modes, surface_velocity
from femstruct.study.room_surfaces import placed_room
from femstruct.study.study import Study
from femstruct.workflow.stages.places import Places

FEWEST: Final = 2  # surfaces of a room among which there is something to share out


def sound_energies(
    study: Study, places: Places, response: Response
) -> tuple[dict[str, Radiated], list[tuple[str, Advice | Finding]]]:
    """What was radiated into every half space, by name, and what is to be known of it, by name."""
    radiated: dict[str, Radiated] = {}
    told: list[tuple[str, Advice | Finding]] = []
    for plan in study.rooms:
        if plan.room.open_air is not None:
            room = placed_room(plan, places.surfaces)
            radiated[plan.name], found = radiated_by(response, room, plan.directivity)
            told += [(plan.name, one) for one in found]
    everywhere = sum(one.energy.energy_j for one in radiated.values())
    told += [(name, one) for one in not_taken(everywhere, response.ledger.end.lost_modes) for name in radiated]
    return radiated, told


def shares_by_surface(study: Study, places: Places, response: Response, end_hz: float) -> dict[str, SurfaceShares]:
    """What each surface gives the air of every closed room that several move, by name. end_hz : where modes end."""
    found: dict[str, SurfaceShares] = {}
    for plan in study.rooms:
        if len(plan.moved) < FEWEST or plan.room.open_air is not None:
            continue
        room = placed_room(plan, places.surfaces)
        motion = surface_velocity(response, room)
        if (volume := response.basis.volumes.get(plan.name)) is not None:
            area = sum(one.area for one in motion)
            motion = leak_apart(motion, volume[moving_modes([response], room)] / area)
        shares = surface_shares(motion, room, plan.receivers, plan.heard_to_hz(end_hz))
        found |= {} if shares is None else {plan.name: shares}
    return found
