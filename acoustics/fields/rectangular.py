"""The rectangular room: its ceiling in cosines, its height in closed form."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from math import inf
from typing import ClassVar

import numpy as np

from acoustics.arrays import Complexes, Floats
from acoustics.errors import AcousticsError, Advice
from acoustics.fields.sound_field import FACING, KeptTransfer, ModesOnSurface, SoundField, described_modes, faces_out
from acoustics.receivers import Receiver, positions
from acoustics.room_response import RoomResponse
from acoustics.rooms.box import Box, inside, room_modes
from acoustics.rooms.box_harmonic import harmonic_pressure
from acoustics.rooms.box_pressure import pressures
from acoustics.rooms.box_transfer import overlaps
from acoustics.rooms.box_two_way import CoupledAir, coupled_air
from acoustics.rooms.kept_transfers import search
from acoustics.rooms.pressure_maps import PressureMap, pressure_map
from acoustics.rooms.receiver_grids import RoomGrid, box_grid, box_mode_shapes
from acoustics.rooms.room_ways import room_ways
from acoustics.source import SurfaceShapes, SurfaceVelocity, SurfaceVibration, side_by_side, together

CEILING = "ceiling"
OTHERS = ("floor", "x0", "x1", "y0", "y1")
TOLD_HZ = 1000.0  # up to which its first modes are looked for
ON = 1e-6  # of the room's size, by which points may miss the ceiling


@dataclass(frozen=True, eq=False)
class Room(Box, SoundField):
    """A rectangular room with rigid walls and floor; its ceiling, z = Lz, or parts of it move.

    size : Lx, Ly, Lz [m]. Coordinates are measured from the lower corner, z up.

    >>> from acoustics import Air, losses_from_beta
    >>> room = Room([0.58, 0.47, 0.1], Air(340, 1.29), losses_from_beta(0.0116, 293))
    >>> round(room.volume, 5), round(room.ceiling_area, 4), room.middle.tolist()
    (0.02726, 0.2726, [0.29, 0.235, 0.1])
    """

    word: ClassVar[str] = "a rectangular room"
    pushes_back: ClassVar[bool] = True
    bounded: ClassVar[bool] = True

    @property
    def identity(self) -> object:
        return self.size.tolist()

    @property
    def wall_area(self) -> float:
        x, y, z = self.size.tolist()
        return float(2.0 * (x * y + y * z + z * x))

    def described(self) -> dict[str, object]:
        return {"size_m": self.size.tolist(), **described_modes(self.losses, room_modes(self, TOLD_HZ)[0])}

    @property
    def movable(self) -> tuple[str, ...]:
        return (CEILING,)

    @property
    def middle(self) -> Floats:
        """Middle of the ceiling [3] [m]."""
        return np.array([self.size[0] / 2.0, self.size[1] / 2.0, self.size[2]])

    def on_wall(self, wall: str) -> None:
        """Its ceiling alone."""
        if wall in OTHERS:
            got, do = (
                f"a surface on '{wall}' of {self.word}",
                "give the room `walls` or a mesh: any wall may move then",
            )
            raise AcousticsError("surface.wall", got=got, expected="surfaces on its ceiling", do=do)
        if wall != CEILING:
            got, expected = f"a surface on '{wall}' of {self.word}", f"one on {CEILING}"
            do = f"there is no wall '{wall}': the walls are {', '.join((CEILING, *OTHERS))}"
            raise AcousticsError("surface.wall", got=got, expected=expected, do=do)

    def accept(self, wall: str, points: Floats, normals: Floats) -> None:
        """Refuse any surface that is not within the ceiling."""
        self.on_wall(wall)
        if (normals[:, 2] > -FACING).any():
            raise faces_out(wall)
        beyond = np.abs(points - self.size / 2.0) - self.size / 2.0
        beyond[:, 2] = np.abs(points[:, 2] - self.size[2])
        worst = int(beyond.max(axis=1).argmax())
        if beyond[worst].max() > 1e-9 + ON * self.size.max() * (beyond[worst].argmax() == 2):
            raise AcousticsError(
                "surface.points",
                got=f"a surface that reaches {beyond[worst].max():.3g} m beyond the ceiling of {self.size[0]:g} x "
                f"{self.size[1]:g} m, to {points[worst].round(6).tolist()} m",
                expected="a surface within it",
            )

    def places(self, receivers: Sequence[Receiver]) -> Floats:
        for receiver in receivers:
            inside(self, f"receiver {receiver.name}", receiver.position[None, :])
        return positions(receivers)

    def pressures(
        self, motions: Sequence[Sequence[SurfaceVelocity]], receivers: Sequence[Receiver], up_to_hz: float = inf
    ) -> list[RoomResponse]:
        """By cosines: see `acoustics.rooms.box_pressure.pressure`."""
        return pressures([together(motion) for motion in motions], self, receivers, up_to_hz=up_to_hz)

    def pressures_to_keep(
        self, motions: Sequence[Sequence[SurfaceVelocity]], receivers: Sequence[Receiver], up_to_hz: float = inf
    ) -> tuple[list[RoomResponse], KeptTransfer | None]:
        """The cosines that were found are kept."""
        return search([together(motion) for motion in motions], self, receivers, up_to_hz)

    def harmonic(
        self, surfaces: Sequence[SurfaceVibration], receivers: Sequence[Receiver]
    ) -> tuple[Complexes, tuple[Advice, ...]]:
        """By cosines: see `acoustics.rooms.box_harmonic.harmonic_pressure`."""
        return harmonic_pressure(together(surfaces), self, receivers)

    def coupled_air(self, surfaces: Sequence[SurfaceShapes], up_to_hz: float) -> CoupledAir:
        """By its modes: see `acoustics.rooms.box_two_way.coupled_air`."""
        return coupled_air(self, side_by_side(surfaces), up_to_hz)

    def modes_on(self, surfaces: Sequence[SurfaceShapes], up_to_hz: float) -> ModesOnSurface:
        moving = side_by_side(surfaces)
        frequency_hz, indices = room_modes(self, up_to_hz)
        squares = self.volume * np.where(indices > 0, 0.5, 1.0).prod(axis=1)
        orders, at = np.unique(indices[:, :2], axis=0, return_inverse=True)  # on the ceiling many modes look alike
        at, area = at.ravel(), moving.weights[:, None]
        products = overlaps(self, orders, moving.points, area * moving.shapes).T
        # cos^2 a cos^2 b = (1 + cos 2a + cos 2b + cos 2a cos 2b) / 4
        doubled = [overlaps(self, orders * twice, moving.points, area)[:, 0] for twice in ([2, 0], [0, 2], [2, 2])]
        sizes = np.sqrt(np.maximum(moving.weights.sum() + sum(doubled), 0.0) / 4.0)
        return ModesOnSurface(frequency_hz, products[:, at], sizes[at], squares)

    @property
    def outline(self) -> Floats:
        """Its twelve edges [12, 2, 3] [m]."""
        corners = np.array(list(product((0, 1), repeat=3)))
        pairs = [(a, b) for a, b in product(range(8), repeat=2) if a < b and (corners[a] != corners[b]).sum() == 1]
        return np.asarray(corners[np.array(pairs)] * self.size)

    def grid(self) -> RoomGrid:
        return box_grid(self)

    def varied(self, factors: Floats) -> Room:
        return Room(self.size * factors, self.air, self.losses)

    def ways(self, surface: SurfaceShapes, places: Floats, s: Complexes) -> Complexes:
        """By cosines: see `acoustics.rooms.room_ways.room_ways`."""
        inner = ((surface.points[:, :2] >= 0.0) & (surface.points[:, :2] <= self.size[:2])).all(axis=1)
        within = SurfaceShapes(surface.points[inner], surface.weights[inner], surface.shapes[inner])
        return room_ways(self, within, places, s)

    def mode_shapes(self, points: Floats, count: int) -> tuple[Floats, Floats]:
        return box_mode_shapes(self, points, count)

    def pressure_map(
        self,
        surfaces: Sequence[SurfaceVelocity],
        frequencies_hz: Sequence[float] | Floats,
        *,
        normal: str = "z",
        at: float,
        divisions: tuple[int, int] = (48, 40),
    ) -> PressureMap:
        """By as many cosines as a picture needs: see `acoustics.rooms.pressure_maps.pressure_map`."""
        return pressure_map(together(surfaces), self, frequencies_hz, normal=normal, at=at, divisions=divisions)
