"""Levels in rooms among the numbers of a batch: from what pushes the modes, without the motion between."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from acoustics.errors import Advice
from acoustics.levels.ending import ended
from acoustics.levels.sound_levels import a_levels
from acoustics.room_response import RoomResponse
from femstruct.arrays import Floats
from femstruct.errors import Finding, InputError
from femstruct.impact.batch.batch import Listener
from femstruct.impact.scene.bodies import Clock, Scene
from femstruct.impact.simulate import simulate
from femstruct.modal.basis import ModalBasis
from femstruct.sound.heard_pushes import PushTransfer, push_transfer
from femstruct.sound.surface import at_rest, moving_modes, surface_velocities
from femstruct.study.asked import RoomPlan
from femstruct.study.room_surfaces import placed_room
from femstruct.study.study import Study
from femstruct.workflow.judgement.blank_bands import room_silent
from femstruct.workflow.run.case import known_of_rooms
from femstruct.workflow.stages.places import Places

MADE: Final = ("l_afmax_db", "l_asmax_db", "l_ae_db")  # of every receiver, in the order of `a_levels`
MAIN: Final = "L_AFmax"  # what the first is called among the main numbers


@dataclass(frozen=True, eq=False)
class HeardRooms:
    """Who listens in the rooms of a case. names : of the numbers made [x], all in dB; told : what is known of rooms."""

    listener: Listener
    names: tuple[str, ...]
    told: tuple[Advice | Finding, ...]


def level_names(study: Study) -> list[str]:
    """Names of the levels that a batch can have, `MADE` of each receiver of each rectangular room."""
    return [f"levels / {one} / {level}" for one in _listened(study) for level in MADE]


def main_names(study: Study) -> dict[str, str]:
    """The same for those that are main numbers, too, by their names there."""
    return {f"{one} {MAIN}": f"levels / {one} / {MADE[0]}" for one in _listened(study)}


def _listened(study: Study) -> list[str]:
    rooms = [room for room in study.rooms if room.room.keeps_transfers]
    return [f"{room.name}.{receiver.name}" for room in rooms for receiver in room.receivers]


def heard_rooms(study: Study, places: Places, basis: ModalBasis, scene: Scene, clock: Clock) -> HeardRooms:
    """Listeners in all rooms of a study that keep their transfers, for what pushes the modes.

    basis : damped; scene : of the impact from which the rooms' transfers are found, to 1e-4 of the pressure.

    Raises InputError where they cannot be had: for modes that damping couples and a structure that moves at the start.
    """
    if scene.velocity is not None:
        raise InputError("initial", got="a structure that moves at the start", expected="one at rest")
    response = simulate(basis, scene, clock)
    nt, dt = len(response.t), 1.0 / clock.sampling
    rooms = [room for room in study.rooms if room.room.keeps_transfers]
    told: list[Advice | Finding] = [one for _, one in known_of_rooms(study, places, basis, basis)]
    kept, ends, silent = [], [], []
    for room in rooms:
        placed, end = placed_room(room, places.surfaces), room.heard_to_hz(basis.complete_below_hz)
        heard, one = room.room.pressures_to_keep(surface_velocities([response], placed), room.receivers, end)
        if one is None:
            raise InputError(f"rooms.{room.name}", got="a room without a transfer", expected="losses that have one")
        told += heard[0].findings
        kept.append((one, moving_modes([response], placed)))
        ends.append(end)
        silent.append(at_rest(response, placed))
    told += [room_silent()] * any(silent)
    made: dict[bytes, list[PushTransfer]] = {}

    def transfers(shares: Floats) -> list[PushTransfer]:
        """Of all rooms, once: threads that come first may make the same."""
        key = shares.tobytes()
        if key not in made:
            made[key] = [push_transfer(basis, shares, one, moving, nt, dt) for one, moving in kept]
        return made[key]

    def of(moments: Floats, shares: Floats) -> Floats:
        found = []
        for room, transfer, end, still in zip(rooms, transfers(shares), ends, silent, strict=True):
            pressures = transfer.pressures(moments) * (not still)
            found.append([_levels(room, response.t, p, end) for p in pressures])
        return np.concatenate(found, axis=1)

    names = level_names(study)
    return HeardRooms(Listener(dt, nt, len(names), of), tuple(names), tuple(told))


def _levels(room: RoomPlan, t: Floats, p: Floats, end_hz: float) -> list[float]:
    """Levels at all receivers of a room, one after the other."""
    heard = ended(RoomResponse(room.receivers, t, p), end_hz)
    return [level for one in heard.p for level in a_levels(one, heard.dt)]
