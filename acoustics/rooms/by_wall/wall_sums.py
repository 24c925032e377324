"""Sound of surfaces on several walls of a rectangular room: a sum over them, each the ceiling of a turned room."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

import numpy as np

from acoustics.arrays import Complexes, Floats
from acoustics.errors import Advice
from acoustics.receivers import Receiver, positions
from acoustics.room_response import RoomResponse
from acoustics.rooms.box import Box
from acoustics.rooms.box_harmonic import harmonic_pressure
from acoustics.rooms.by_wall.box_walls import Turn, by_wall
from acoustics.rooms.kept_transfers import RoomTransfer, search
from acoustics.rooms.pressure_maps import PressureMap, pressure_map
from acoustics.source import SurfaceVelocity, SurfaceVibration, alike


@dataclass(frozen=True, eq=False)
class WallTransfers:
    """Kept transfers of the walls of a room, summed; of : motions of the surface that they were found with."""

    room: Box
    receivers: tuple[Receiver, ...]
    walls: tuple[tuple[Turn, RoomTransfer], ...]

    def of(self, surface: SurfaceVelocity, room: object, receivers: Sequence[Receiver], up_to_hz: float) -> bool:
        """Whether a motion is one of these surfaces in this room, in a record of the same length and sampling."""
        mine = self.room
        if not isinstance(room, Box) or (*room.size, room.air, room.losses) != (*mine.size, mine.air, mine.losses):
            return False
        parts = by_wall(room, surface)
        if [*parts] != [turn for turn, _ in self.walls]:
            return False
        return all(
            kept.of(turn.surface(room, parts[turn]), turn.box(room), turn.receivers(room, [*receivers]), up_to_hz)
            for turn, kept in self.walls
        )

    def prepare(self) -> None:
        """Find the ways of all walls now."""
        for _, kept in self.walls:
            kept.prepare()

    @property
    def per_rate(self) -> Complexes:
        """As that of each wall, summed."""
        whole: Complexes = np.sum([kept.per_rate for _, kept in self.walls], axis=0)
        return whole

    def pressures(self, surfaces: Sequence[SurfaceVelocity]) -> list[RoomResponse] | None:
        """Pressures of other motions; None where a wall needs other cosines."""
        split = [by_wall(self.room, surface) for surface in surfaces]
        heard = []
        for turn, kept in self.walls:
            found = kept.pressures([turn.surface(self.room, parts[turn]) for parts in split])
            if found is None:
                return None
            heard.append(found)
        return [_sum(self.receivers, each) for each in zip(*heard, strict=True)]


def wall_pressures(
    surfaces: Sequence[SurfaceVelocity], room: Box, receivers: Sequence[Receiver], up_to_hz: float = inf
) -> tuple[list[RoomResponse], RoomTransfer | WallTransfers | None]:
    """Pressures of each of several motions of surfaces on any walls, and what is kept for further ones.

    Raises AcousticsError as `acoustics.rooms.box_pressure.pressures` does, and for points on no wall.

    Notes
    -----
    The field of every wall is the closed form along its own normal, those of the others being rigid meanwhile; the
    pressure is their sum. The search for cosines ends at every wall as it does at a ceiling alone.
    """
    alike(surfaces)
    positions(receivers)
    split = [by_wall(room, surface) for surface in surfaces]
    turns = [*split[0]]
    if turns == [Turn("ceiling")]:
        return search(surfaces, room, receivers, up_to_hz)
    heard, kept = [], []
    for turn in turns:
        moving = [turn.surface(room, parts[turn]) for parts in split]
        found, transfer = search(moving, turn.box(room), turn.receivers(room, [*receivers]), up_to_hz)
        heard.append(found)
        kept.append((turn, transfer))
    whole = [(turn, one) for turn, one in kept if one is not None]
    transfers = WallTransfers(room, tuple(receivers), tuple(whole)) if len(whole) == len(turns) else None
    return [_sum(receivers, each) for each in zip(*heard, strict=True)], transfers


def wall_harmonic(
    surface: SurfaceVibration, room: Box, receivers: Sequence[Receiver]
) -> tuple[Complexes, tuple[Advice, ...]]:
    """Complex pressure [n_receivers, nf] [Pa] of surfaces on any walls, and advice on it; each wall as
    `acoustics.rooms.box_harmonic.harmonic_pressure` has a ceiling."""
    p = np.zeros((len(positions(receivers)), len(surface.frequency_hz)), dtype=np.complex128)
    advice: list[Advice] = []
    for turn, part in by_wall(room, surface).items():
        own, told = harmonic_pressure(turn.surface(room, part), turn.box(room), turn.receivers(room, [*receivers]))
        p += own
        advice += told
    return p, _once(advice)


def wall_map(
    surface: SurfaceVelocity,
    room: Box,
    frequencies_hz: Sequence[float] | Floats,
    *,
    normal: str,
    at: float,
    divisions: tuple[int, int],
) -> PressureMap:
    """Spectrum of the pressure on a plane of the room, of surfaces on any walls: see
    `acoustics.rooms.pressure_maps.pressure_map`."""
    maps = []
    for turn, part in by_wall(room, surface).items():
        moved = turn.surface(room, part)
        if turn == Turn("ceiling") or normal not in ("x", "y", "z"):
            maps.append(pressure_map(moved, room, frequencies_hz, normal=normal, at=at, divisions=divisions))
            continue
        fixed = turn.axes.index("xyz".index(normal))
        mirrored = not turn.at_end
        others = [turn.axes[axis] for axis in range(3) if axis != fixed]
        swapped = others[0] > others[1]
        there = room.size[turn.axis] - at if mirrored and fixed == 2 else at
        cut = (divisions[1], divisions[0]) if swapped else divisions
        own = pressure_map(moved, turn.box(room), frequencies_hz, normal="xyz"[fixed], at=float(there), divisions=cut)
        spectrum = own.spectrum[:, :, ::-1] if mirrored and fixed != 2 else own.spectrum
        first, second, spectrum = (
            (own.second, own.first, spectrum.swapaxes(1, 2)) if swapped else (own.first, own.second, spectrum)
        )
        maps.append(PressureMap(normal, at, first, second, own.frequency_hz, spectrum))
    first_map = maps[0]
    if len(maps) == 1:
        return first_map
    whole: Complexes = np.sum([one.spectrum for one in maps], axis=0)
    return PressureMap(normal, at, first_map.first, first_map.second, first_map.frequency_hz, whole)


def _sum(receivers: Sequence[Receiver], parts: Sequence[RoomResponse]) -> RoomResponse:
    if len(parts) == 1:
        return RoomResponse(tuple(receivers), parts[0].t, parts[0].p, parts[0].findings)
    p: Floats = np.sum([one.p for one in parts], axis=0)
    p.flags.writeable = False
    return RoomResponse(tuple(receivers), parts[0].t, p, _once([told for one in parts for told in one.findings]))


def _once(told: Sequence[Advice]) -> tuple[Advice, ...]:
    """The first advice of every code: walls have their own."""
    return tuple({one.code: one for one in reversed(told)}.values())[::-1]
