"""The six walls of a rectangular room: each is the ceiling of the same room turned."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final, TypeVar

import numpy as np

from acoustics.arrays import Floats, Integers
from acoustics.errors import AcousticsError
from acoustics.receivers import Receiver
from acoustics.rooms.box import Box
from acoustics.rooms.box_transfer import overlaps
from acoustics.source import SurfaceShapes

CEILING: Final = "ceiling"
AXIS: Final = {"x": 0, "y": 1, "floor": 2, "ceiling": 2}
WALLS: Final = (CEILING, "floor", "x0", "x1", "y0", "y1")
ON: Final = 1e-6  # of the room's size, by which points may miss their wall
_TURNED: Final = ((1, 2, 0), (0, 2, 1), (0, 1, 2))  # which axis is which of the turned room, by the wall's normal
Shapes = TypeVar("Shapes", bound=SurfaceShapes)


@dataclass(frozen=True)
class Turn:
    """A room turned so that one of its walls is the ceiling.

    wall : its name. The pressure of a surface on it is that of the ceiling of the turned room.

    >>> Turn("x0").points(Box([4.0, 3.0, 2.5]), np.array([[1.0, 0.5, 0.2]])).tolist()
    [[0.5, 0.2, 3.0]]
    """

    wall: str

    @property
    def axis(self) -> int:
        """Along which axis its normal lies."""
        return AXIS[self.wall] if self.wall in AXIS else AXIS[self.wall[0]]

    @property
    def at_end(self) -> bool:
        """Whether it is the wall at the far end of that axis."""
        return self.wall == CEILING or self.wall.endswith("1")

    @property
    def axes(self) -> tuple[int, int, int]:
        """Which axis of the room every axis of the turned one is; the last is the wall's normal."""
        return _TURNED[self.axis]

    @property
    def inward(self) -> Floats:
        """Unit normal into the room [3]."""
        normal = np.zeros(3)
        normal[self.axis] = -1.0 if self.at_end else 1.0
        return normal

    def box(self, room: Box) -> Box:
        """The turned room."""
        return room if self.wall == CEILING else Box(room.size[list(self.axes)], room.air, room.losses)

    def points(self, room: Box, points: Floats) -> Floats:
        """Places of the room [p, 3] in the turned one."""
        if self.wall == CEILING:
            return points
        there = points[:, list(self.axes)]
        if not self.at_end:
            there[:, 2] = room.size[self.axis] - there[:, 2]
        return there

    def surface(self, room: Box, surface: Shapes) -> Shapes:
        """A surface on the wall as one on the ceiling of the turned room."""
        return surface if self.wall == CEILING else replace(surface, points=self.points(room, surface.points))

    def receivers(self, room: Box, receivers: list[Receiver]) -> list[Receiver]:
        """Who listens, in the turned room."""
        if self.wall == CEILING:
            return receivers
        return [Receiver(one.name, self.points(room, one.position[None, :])[0]) for one in receivers]

    def distance(self, room: Box, points: Floats) -> Floats:
        """How far points [p, 3] are from the plane of the wall [p] [m]."""
        end = room.size[self.axis] if self.at_end else 0.0
        return np.asarray(np.abs(points[:, self.axis] - end))


def by_wall(room: Box, surface: Shapes) -> dict[Turn, Shapes]:
    """The parts of a surface by the wall on which their points lie; one part is the surface itself.

    Raises AcousticsError: points off all walls.
    """
    turns = [Turn(wall) for wall in WALLS]
    apart = np.stack([turn.distance(room, surface.points) for turn in turns])
    nearest = apart.argmin(axis=0)
    off = apart.min(axis=0)
    if off.max() > ON * room.size.max():
        raise AcousticsError(
            "surface.points",
            got=f"a point {off.max():.3g} m off the walls, at {surface.points[off.argmax()].tolist()} m",
            expected=f"the ceiling of the room, z = {room.size[2]:g} m, or another of its walls",
            do="measure from the room's lower corner, z up",
        )
    found = {}
    for number, turn in enumerate(turns):
        rows = nearest == number
        if rows.all():
            return {turn: surface}
        if rows.any():
            points, weights, shapes = (getattr(surface, word)[rows] for word in ("points", "weights", "shapes"))
            found[turn] = replace(surface, points=points, weights=weights, shapes=shapes)
    return found


def mode_overlaps(room: Box, indices: Integers, turn: Turn, surface: SurfaceShapes) -> Floats:
    """Integrals [n, k] over a surface on a wall of the modes with `indices` [n, 3] times its shapes.

    The modes are cosines of unit amplitude, positive where the corner x = y = 0 meets the ceiling.
    """
    along = list(turn.axes[:2])
    flat, place = np.unique(indices[:, along], axis=0, return_inverse=True)
    there = turn.surface(room, surface)
    found = overlaps(turn.box(room), flat, there.points, there.weights[:, None] * there.shapes)[place.ravel()]
    return np.asarray(signs_at(indices, turn)[:, None] * found)


def signs_at(indices: Integers, turn: Turn) -> Floats:
    """What the modes [n] are at the wall, beside their cosines along it."""
    upside = 1.0 - 2.0 * (indices[:, 2] % 2)  # positive at the ceiling
    return np.asarray(upside * (1.0 - 2.0 * (indices[:, turn.axis] % 2)) if turn.at_end else upside)
