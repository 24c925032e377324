"""The rectangular room with rigid walls as its formulas know it: size, air, losses, modes, what lies in it."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import ceil

import numpy as np

from acoustics.air import Air
from acoustics.arrays import Floats, Integers, freeze, frozen, positive
from acoustics.errors import AcousticsError
from acoustics.losses import Losses
from acoustics.source import SurfaceShapes


@dataclass(frozen=True, eq=False)
class Box:
    """The size, the air and the losses of a rectangular room with rigid walls and floor; its ceiling, z = Lz, moves.

    size : Lx, Ly, Lz [m]. Coordinates are measured from the lower corner, z up.

    >>> from acoustics.losses import losses_from_beta
    >>> room = Box([0.58, 0.47, 0.1], Air(340, 1.29), losses_from_beta(0.0116, 293))
    >>> round(room.volume, 5), round(room.ceiling_area, 4)
    (0.02726, 0.2726)
    """

    size: Floats
    air: Air = field(default_factory=Air)
    losses: Losses = field(default_factory=Losses)

    def __post_init__(self) -> None:
        size = frozen("room.size", self.size, (3,))
        if (size <= 0).any():
            raise AcousticsError("room.size", got=f"{size.tolist()} m", expected="positive lengths")
        freeze(self, size=size)

    @property
    def volume(self) -> float:
        """Volume Lx Ly Lz [m^3]."""
        return float(np.prod(self.size))

    @property
    def ceiling_area(self) -> float:
        """Area Lx Ly of the ceiling [m^2]."""
        return float(self.size[0] * self.size[1])


def inside(room: Box, name: str, points: Floats) -> None:
    """Refuse `points` [n, 3] outside the room; raises AcousticsError with the first of them.

    A rounding error of 1e-9 of the room's size is let through.
    """
    slack = 1e-9 * room.size.max()
    outside = ((points < -slack) | (points > room.size + slack)).any(axis=1)
    if outside.any():
        raise AcousticsError(
            name,
            got=f"{points[outside.argmax()].tolist()} m",
            expected=f"a point of the room of {room.size.tolist()} m",
            do="measure from the room's lower corner, z up",
        )


def room_modes(room: Box, up_to_hz: float) -> tuple[Floats, Integers]:
    """Frequencies [n] [Hz] and indices (l, m, n) [n, 3] of the modes up to `up_to_hz`, without the uniform one at 0.

    f = (c / 2) sqrt((l/Lx)^2 + (m/Ly)^2 + (n/Lz)^2), without losses.

    >>> frequency_hz, indices = room_modes(Box([0.58, 0.47, 0.1], Air(340, 1.29)), 500)
    >>> frequency_hz.round(1).tolist(), indices.tolist()
    ([293.1, 361.7, 465.6], [[1, 0, 0], [0, 1, 0], [1, 1, 0]])
    """
    top = positive("up_to_hz", up_to_hz, "Hz")
    counts = [ceil(2 * top * length / room.air.c) + 1 for length in room.size.tolist()]
    indices = np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1).reshape(-1, 3).astype(np.int64)
    frequency_hz: Floats = room.air.c / 2 * np.sqrt(((indices / room.size) ** 2).sum(axis=1))
    order = np.argsort(frequency_hz, kind="stable")
    order = order[(frequency_hz[order] > 0) & (frequency_hz[order] <= top)]
    return frequency_hz[order], indices[order]


def on_ceiling(surface: SurfaceShapes, room: Box) -> None:
    """Refuse a surface whose points do not lie on the room's ceiling, or cover more than it has.

    Raises AcousticsError: a point off the plane z = Lz by more than 1e-6 of the room's size, a point outside the
    rectangle, weights that sum to more than the area of the ceiling.
    """
    off = np.abs(surface.points[:, 2] - room.size[2])
    if off.max() > 1e-6 * room.size.max():
        raise AcousticsError(
            "surface.points",
            got=f"z = {surface.points[off.argmax(), 2]:g} m",
            expected=f"the ceiling of the room, z = {room.size[2]:g} m",
            do="measure from the room's lower corner, z up",
        )
    flat = surface.points.copy()
    flat[:, 2] = room.size[2]
    inside(room, "surface.points", flat)
    if surface.area > room.ceiling_area * (1 + 1e-6):
        raise AcousticsError(
            "surface.weights",
            got=f"a sum of {surface.area:g} m^2",
            expected=f"at most the ceiling, {room.ceiling_area:g} m^2",
            do="give each point its share of the area",
        )
