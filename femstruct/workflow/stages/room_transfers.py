"""What rooms cost, paid once: their transfers, kept by the value of what they are of, over cases and over runs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from acoustics.fields.returned import KeptTransfer
from acoustics.fields.sound_field import SoundField
from acoustics.receivers import Receiver
from acoustics.room_response import RoomResponse
from acoustics.source import together
from femstruct.sound.surface import Motion

MOST: Final = 8  # rooms kept, the latest


class RoomTransfers:
    """Transfers of rooms, held by who runs cases: a run, or a caller who runs a study again and again.

    The first motion of a room's surfaces finds what it takes; with the second, or with `prepare`, the transfer is made,
    and that and every further one cost little more than their Fourier transforms. A kind of room that keeps nothing is
    asked anew.

    Notes
    -----
    Rooms, surfaces (points, shapes of the modes), receivers and records are compared by value; where anything differs,
    or a motion needs another search, it is made anew.
    """

    def __init__(self) -> None:
        self._kept: list[KeptTransfer] = []

    def heard(
        self, moving: Sequence[Motion], room: SoundField, receivers: Sequence[Receiver], up_to_hz: float
    ) -> list[RoomResponse]:
        """Pressures as `SoundField.pressures` has them."""
        whole = [together(motion) for motion in moving]
        for kept in self._kept:
            if kept.of(whole[0], room, receivers, up_to_hz):
                found = kept.pressures(whole)
                if found is not None:
                    return found
                self._kept.remove(kept)
                break
        found, new = room.pressures_to_keep(moving, receivers, up_to_hz)
        if new is not None:
            self._kept = [*self._kept[1 - MOST :], new]
        return found

    def prepare(self) -> None:
        """Make the transfers of all rooms that were heard, for motions to come."""
        for kept in self._kept:
            kept.prepare()
