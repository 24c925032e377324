"""The half space beside a surface in a rigid baffle."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import inf
from typing import ClassVar

import numpy as np

from acoustics.arrays import Complexes, Floats
from acoustics.errors import AcousticsError, Advice
from acoustics.fields.sound_field import FACING, SoundField, faces_out
from acoustics.losses import Losses
from acoustics.open_air.rayleigh import Baffle, field_loads, field_pressures, harmonic_field, in_front, on_plane
from acoustics.receivers import Receiver
from acoustics.room_response import RoomResponse
from acoustics.source import SurfaceShapes, SurfaceVelocity, SurfaceVibration, combine_surfaces, side_by_side
from acoustics.tags import stored_as

PLANE = "plane"


@stored_as("half space/1")
@dataclass(frozen=True, eq=False)
class HalfSpace(Baffle, SoundField):
    """The air in front of a plane, rigid except for what moves in it, infinite and without losses.

    normal : [3], unit vector into the air. The plane goes through the origin; so do receivers' coordinates.

    >>> HalfSpace(normal=[0, 0, -1]).facing.tolist()
    [0.0, 0.0, -1.0]
    """

    word: ClassVar[str] = "a half space"
    losses: Losses = field(default_factory=Losses, init=False)

    @property
    def volume(self) -> float:
        return inf

    @property
    def open_air(self) -> Baffle:
        return self

    def described(self) -> dict[str, object]:
        return {"side": "above" if self.normal[2] > 0 else "below"}

    @property
    def movable(self) -> tuple[str, ...]:
        return (PLANE,)

    @property
    def middle(self) -> Floats:
        return np.zeros(3)

    @property
    def facing(self) -> Floats:
        return self.normal

    def axes(self, along: Floats, normal: Floats) -> Floats:
        return np.eye(3)

    def accept(self, wall: str, points: Floats, normals: Floats) -> None:
        """Refuse what is not in the plane."""
        self.on_wall(wall)
        if (normals @ self.normal < FACING).any():
            raise faces_out(wall)
        on_plane(self, points)

    def places(self, receivers: Sequence[Receiver]) -> Floats:
        return in_front(self, receivers)

    def pressures(
        self, motions: Sequence[Sequence[SurfaceVelocity]], receivers: Sequence[Receiver], up_to_hz: float = inf
    ) -> list[RoomResponse]:
        """By Rayleigh's integral: see `acoustics.open_air.rayleigh.field_pressures`."""
        return field_pressures([combine_surfaces(motion) for motion in motions], self, receivers)

    def harmonic(
        self, surfaces: Sequence[SurfaceVibration], receivers: Sequence[Receiver]
    ) -> tuple[Complexes, tuple[Advice, ...]]:
        """By Rayleigh's integral: see `acoustics.open_air.rayleigh.harmonic_field`."""
        return harmonic_field(combine_surfaces(surfaces), self, receivers)

    def loads(
        self, surfaces: Sequence[SurfaceShapes], source: Receiver, frequency_hz: Floats
    ) -> tuple[Complexes, tuple[Advice, ...]]:
        """By the source and its image: see `acoustics.open_air.rayleigh.field_loads`."""
        return field_loads(side_by_side(surfaces), self, source, frequency_hz)

    def powers(self, surfaces: Sequence[SurfaceVibration]) -> Floats:
        """Refused: pressures on the plane itself are not computed; that of all surfaces together is
        `acoustics.open_air.power.radiated_power`."""
        raise AcousticsError("powers", got=f"powers by surface in {self.word}", expected="a closed room")
