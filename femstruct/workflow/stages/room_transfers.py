"""What rooms cost, paid once: their transfers, kept by the value of what they are of, over cases and over runs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from acoustics.rooms.box import Receiver, Room
from acoustics.rooms.box_pressure import RoomResponse
from acoustics.rooms.kept_transfers import RoomTransfer, Searched, pressures_through, room_transfer, search
from acoustics.source import SurfaceVelocity
from femstruct.sound.surface import AnyRoom, heard

MOST: Final = 8  # rooms kept, the latest


class RoomTransfers:
    """Transfers of rectangular rooms, held by who runs cases: a run, or a caller who runs a study again and again.

    The first motion of a ceiling finds the cosines that it takes; with the second, or with `prepare`, their transfer is
    made, and that and every further one cost little more than their Fourier transforms.

    Notes
    -----
    Rooms, ceilings (points, shapes of the modes), receivers and records are compared by value; where anything differs,
    or a motion needs other cosines, the search is made anew.
    """

    def __init__(self) -> None:
        self._kept: list[Searched | RoomTransfer] = []

    def heard(
        self, moving: Sequence[SurfaceVelocity], room: AnyRoom, receivers: Sequence[Receiver], up_to_hz: float
    ) -> list[RoomResponse]:
        """Pressures as `femstruct.sound.surface.heard` has them."""
        if not isinstance(room, Room) or room.losses.kind == "source":
            return heard(moving, room, receivers, up_to_hz)
        for number, kept in enumerate(self._kept):
            if _searched(kept).of(moving[0], room, receivers, up_to_hz):
                transfer = self._kept[number] = _made(kept)
                found = pressures_through(transfer, moving)
                if found is not None:
                    return found
                del self._kept[number]
                break
        found, searched = search(moving, room, receivers, up_to_hz)
        self._kept = [*self._kept[1 - MOST :], searched]
        return found

    def prepare(self) -> None:
        """Make the transfers of all ceilings that were heard, for motions to come."""
        self._kept = [_made(kept) for kept in self._kept]


def _searched(kept: Searched | RoomTransfer) -> Searched:
    return kept.searched if isinstance(kept, RoomTransfer) else kept


def _made(kept: Searched | RoomTransfer) -> RoomTransfer:
    return kept if isinstance(kept, RoomTransfer) else room_transfer(kept)
