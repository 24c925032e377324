"""The rectangular room: each wall in cosines, the way across the room in closed form."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from math import inf
from typing import ClassVar

import numpy as np

from acoustics.arrays import Complexes, Floats, Integers
from acoustics.errors import AcousticsError, Advice
from acoustics.fields.receiver_grids import RoomGrid, box_grid, box_mode_shapes
from acoustics.fields.returned import KeptTransfer, ModesOnSurface
from acoustics.fields.sound_field import FACING, SoundField, described_modes, faces_out
from acoustics.receivers import Receiver, positions
from acoustics.room_response import RoomResponse
from acoustics.rooms.box import Box, overlaps, refuse_outside, room_modes
from acoustics.rooms.box_coupling import CoupledAir
from acoustics.rooms.box_harmonic import PressureMap
from acoustics.rooms.box_pressure import room_transfers
from acoustics.rooms.box_walls import (
    ON,
    WALLS,
    Turn,
    by_wall,
    coupled_walls,
    mode_overlaps,
    wall_harmonic,
    wall_loads,
    wall_map,
    wall_powers,
    wall_pressures,
)
from acoustics.source import SurfaceShapes, SurfaceVelocity, SurfaceVibration, combine_surfaces, side_by_side
from acoustics.tags import stored_as

TOLD_HZ = 1000.0  # up to which its first modes are looked for


@stored_as("rectangular room/1")
@dataclass(frozen=True, eq=False)
class Room(Box, SoundField):
    """A rectangular room, rigid where nothing moves: surfaces move its ceiling, its floor, its walls or parts of them.

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
    def all_walls_area(self) -> float:
        x, y, z = self.size.tolist()
        return float(2.0 * (x * y + y * z + z * x))

    def described(self) -> dict[str, object]:
        return {"size_m": self.size.tolist(), **described_modes(self.losses, room_modes(self, TOLD_HZ)[0])}

    @property
    def movable(self) -> tuple[str, ...]:
        return WALLS

    @property
    def middle(self) -> Floats:
        """Middle of the ceiling [3] [m]."""
        return self.middle_of(WALLS[0])

    def middle_of(self, wall: str) -> Floats:
        middle = self.size / 2.0
        turn = Turn(wall)
        middle[turn.axis] = self.size[turn.axis] if turn.at_end else 0.0
        return np.asarray(middle)

    def wall_area(self, wall: str) -> float:
        return float(np.prod(self.size[self.along(wall)]))

    def along(self, wall: str) -> list[int]:
        return sorted(Turn(wall).axes[:2])

    def placed_by(self, wall: str, along: Floats, normal: Floats) -> tuple[Floats, Floats]:
        """Any wall places it, z being up; the floor, and the ceiling, with x along their first side."""
        self.on_wall(wall)
        if wall == WALLS[0]:
            return super().placed_by(wall, along, normal)
        turn, axes = Turn(wall), np.zeros((3, 3))
        upright = abs(normal[2]) < 1.0 - FACING
        if not (normal[2] >= FACING if turn.axis == 2 else upright):
            raise AcousticsError(
                "surface.normals",
                got=f"a surface with normal ({normal[0]:.2g}, {normal[1]:.2g}, {normal[2]:.2g})",
                expected=f"a normal that points {'up' if turn.axis == 2 else 'sideways'}, into the air of the room",
            )
        if turn.axis == 2:
            return np.stack([*along, normal]), self.middle_of(wall)
        axes[2, 2] = 1.0
        axes[turn.axis] = -normal if turn.at_end else normal
        axes[1 - turn.axis] = np.cross(axes[2], axes[0]) if turn.axis == 0 else np.cross(axes[1], axes[2])
        return axes, self.middle_of(wall)

    def accept(self, wall: str, points: Floats, normals: Floats) -> None:
        """Refuse any surface that is not within its wall."""
        self.on_wall(wall)
        turn = Turn(wall)
        facing = normals @ turn.inward
        if (facing < FACING).any():
            if (facing <= -FACING).all():
                raise faces_out(wall)
            there = [round(float(part), 2) + 0.0 for part in normals[facing.argmin()]]
            expected = f"one that faces along {turn.inward.astype(int).tolist()}"
            got = f"a surface on '{wall}' that faces along {there} of the room"
            raise AcousticsError("surface.normals", got=got, expected=expected)
        beyond = np.abs(points - self.size / 2.0) - self.size / 2.0
        beyond[:, turn.axis] = turn.distance(self, points)
        worst = int(beyond.max(axis=1).argmax())
        across = bool(beyond[worst].argmax() == turn.axis)
        if beyond[worst].max() > 1e-9 + ON * self.size.max() * across:
            sides = " x ".join(f"{self.size[axis]:g}" for axis in sorted(turn.axes[:2]))
            named = wall if wall in ("ceiling", "floor") else f"wall {wall}"
            raise AcousticsError(
                "surface.points",
                got=f"a surface that lies {beyond[worst].max():.3g} m off the {named}, at "
                f"{points[worst].round(6).tolist()} m"
                if across
                else f"a surface that reaches {beyond[worst].max():.3g} m beyond the {named} of {sides} m, to "
                f"{points[worst].round(6).tolist()} m",
                expected="a surface on it" if across else "a surface within it",
                do=f"the {named} is {'xyz'[turn.axis]} = {self.middle_of(wall)[turn.axis]:g} m of the room, which "
                "another surface places: compare the room's size with how far the parts are from each other"
                if across
                else "",
            )

    def places(self, receivers: Sequence[Receiver]) -> Floats:
        for receiver in receivers:
            refuse_outside(self, f"receiver {receiver.name}", receiver.position[None, :])
        return positions(receivers)

    def pressures(
        self, motions: Sequence[Sequence[SurfaceVelocity]], receivers: Sequence[Receiver], up_to_hz: float = inf
    ) -> list[RoomResponse]:
        """By cosines of every wall: see `acoustics.rooms.box_pressure.pressure`."""
        return self.pressures_to_keep(motions, receivers, up_to_hz)[0]

    @property
    def keeps_transfers(self) -> bool:
        return self.losses.kind != "source"

    def pressures_to_keep(
        self, motions: Sequence[Sequence[SurfaceVelocity]], receivers: Sequence[Receiver], up_to_hz: float = inf
    ) -> tuple[list[RoomResponse], KeptTransfer | None]:
        """The cosines that were found are kept."""
        return wall_pressures([combine_surfaces(motion) for motion in motions], self, receivers, up_to_hz)

    def harmonic(
        self, surfaces: Sequence[SurfaceVibration], receivers: Sequence[Receiver]
    ) -> tuple[Complexes, tuple[Advice, ...]]:
        """By cosines of every wall: see `acoustics.rooms.box_harmonic.harmonic_pressure`."""
        return wall_harmonic(combine_surfaces(surfaces), self, receivers)

    def coupled_air(self, surfaces: Sequence[SurfaceShapes], up_to_hz: float) -> CoupledAir:
        """By its modes: see `acoustics.rooms.box_walls.coupled_walls`."""
        return coupled_walls(self, side_by_side(surfaces), up_to_hz)

    def loads(
        self, surfaces: Sequence[SurfaceShapes], source: Receiver, frequency_hz: Floats
    ) -> tuple[Complexes, tuple[Advice, ...]]:
        """By cosines of every wall: see `acoustics.rooms.box_walls.wall_loads`."""
        return wall_loads(self, side_by_side(surfaces), self.places([source])[0], frequency_hz)

    def powers(self, surfaces: Sequence[SurfaceVibration]) -> Floats:
        """By its modes: see `acoustics.rooms.box_walls.wall_powers`."""
        return wall_powers(self, surfaces)

    def modes_on(self, surfaces: Sequence[SurfaceShapes], up_to_hz: float) -> ModesOnSurface:
        frequency_hz, indices = room_modes(self, up_to_hz)
        squares = self.volume * np.where(indices > 0, 0.5, 1.0).prod(axis=1)
        parts = by_wall(self, side_by_side(surfaces))
        products: Floats = np.sum([mode_overlaps(self, indices, *part) for part in parts.items()], axis=0)
        sizes = np.sum([self._squares(indices, *part) for part in parts.items()], axis=0)
        return ModesOnSurface(frequency_hz, products.T, np.sqrt(sizes), squares)

    def _squares(self, indices: Integers, turn: Turn, surface: SurfaceShapes) -> Floats:
        """Integrals [n] of the squares of modes over a surface on a wall."""
        box, there, area = turn.box(self), turn.surface(self, surface), surface.weights[:, None]
        orders, at = np.unique(indices[:, list(turn.axes[:2])], axis=0, return_inverse=True)  # many modes look alike
        # cos^2 a cos^2 b = (1 + cos 2a + cos 2b + cos 2a cos 2b) / 4
        doubled = [overlaps(box, orders * twice, there.points, area)[:, 0] for twice in ([2, 0], [0, 2], [2, 2])]
        return np.asarray(np.maximum(surface.weights.sum() + sum(doubled), 0.0)[at.ravel()] / 4.0)

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

    def transfers(self, surface: SurfaceShapes, places: Floats, s: Complexes) -> Complexes:
        """By cosines: see `acoustics.rooms.box_pressure.room_transfers`."""
        inner = ((surface.points[:, :2] >= 0.0) & (surface.points[:, :2] <= self.size[:2])).all(axis=1)
        within = SurfaceShapes(surface.points[inner], surface.weights[inner], surface.shapes[inner])
        return room_transfers(self, within, places, s)

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
        """By as many cosines as a picture needs: see `acoustics.rooms.box_harmonic.pressure_map`."""
        return wall_map(combine_surfaces(surfaces), self, frequencies_hz, normal=normal, at=at, divisions=divisions)
