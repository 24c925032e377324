"""Rectangular rooms as they are written."""

from __future__ import annotations

from typing import Any

import numpy as np

from acoustics.fields.rectangular import Room
from femstruct.language.rooms.closed import ClosedSpec
from femstruct.language.rooms.room import Asked
from femstruct.language.yaml import Here, SideLength

Size = tuple[SideLength, SideLength, SideLength]


class BoxRoomSpec(ClosedSpec):
    """A rectangular room under a surface, and its receivers.

    at: centre of the surface in the ceiling, from the room's corner; by default the middle.
    surfaces: further surfaces of the structure, by the wall of the room that they move: here its ceiling alone.
    coupling: one-way (the air does not react on the structure) or two-way.
    animate: a frequency, `pulse`, or a list of these: a moving picture of each.
    levels: standards for the levels of a standard source: ISO 16283-2 and ISO 717-2, or JIS A 1419-2 and KS F 2863-2.
    ensemble: rooms with sides within 5 %, places of source and microphones drawn anew, over which low rated bands have
        a mean and an interval; 0 for none.
    beyond_modes: what rated bands have that the modes do not reach: statistical (the default), levels of statistical
        energies, which a single bare plate has, or blank.
    """

    size: Size

    def check_in(self, here: Here, name: str, asked: Asked) -> None:
        super().check_in(here, name, asked)
        check_sound_crosses(self.size, self, here)

    def check_receiver(self, here: Here, place: tuple[float, ...]) -> None:
        check_inside(self.size, here, place)

    def room(self, here: Here, receivers: Any, sources: Any, shaped: Any) -> Room:
        return Room(np.array(self.size), self.air.noun(), self.losses_of())


def check_inside(size: Size, here: Here, place: tuple[float, ...]) -> None:
    """Note a receiver that is not in a box."""
    inside = all(0 <= x <= length for x, length in zip(place, size, strict=True))
    told = " x ".join(f"{length:g}" for length in size)
    here.need(inside, f"{list(place)} m", f"a point of the room, {told} m", "from its lower corner")


def check_sound_crosses(size: Size, room: ClosedSpec, here: Here) -> None:
    """Sound of a box goes from wall to wall at least once while it dies away."""
    x, y, z = size
    between = 4.0 * x * y * z / (2.0 * (x * y + y * z + z * x)) / room.air.c
    shortest = room.losses.shortest if room.losses is not None else None
    if shortest is not None:
        here.at("losses", "t60").need(
            shortest >= between,
            f"{1e3 * shortest:g} ms, less than sound takes from wall to wall, {1e3 * between:.2g} ms",
            "a reverberation time: sound falls by 60 dB in it",
            f"did you mean {1e3 * shortest:g} s?",
        )
