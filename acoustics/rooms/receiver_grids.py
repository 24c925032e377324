"""Cells of a room for pictures, and its modes on them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from acoustics.arrays import Floats, Integers, freeze, frozen
from acoustics.meshed.cavity_mesh import HEX_OF_MESHIO, box_mesh
from acoustics.meshed.finite_elements import probe
from acoustics.meshed.meshed_room import ShapedRoom
from acoustics.rooms.box import Room, room_modes

FINE: Final = 28  # cells along the longest side of a rectangular room
MOST_CELLS: Final = 100_000  # of a meshed room that is divided once more


@dataclass(frozen=True, eq=False)
class RoomGrid:
    """Points [n, 3] [m] and straight cells [m, 4] or [m, 8] of a room, corners in the order of VTK."""

    points: Floats
    cells: Integers

    def __post_init__(self) -> None:
        freeze(self, points=frozen("grid.points", self.points, (None, 3)))


def room_grid(room: Room | ShapedRoom) -> RoomGrid:
    """Cells fine enough for pictures: the halves of a mesh's own, or equal ones of a rectangular room.

    >>> from acoustics.air import Air
    >>> room_grid(Room([4.0, 2.0, 1.0])).cells.shape
    (2744, 8)
    """
    if isinstance(room, Room):
        counts = np.maximum(2, np.rint(FINE * room.size / room.size.max())).astype(int)
        mesh = box_mesh(room.size.tolist(), counts.tolist())
        return RoomGrid(mesh.points, mesh.cells)
    cells = room.mesh.basis.mesh
    if 8 * len(room.mesh.cells) <= MOST_CELLS:
        cells = cells.refined()
    order = np.argsort(HEX_OF_MESHIO) if cells.t.shape[0] == 8 else np.arange(4)
    return RoomGrid(cells.p.T, cells.t[order].T.astype(np.int64))


def mode_shapes(room: Room | ShapedRoom, grid: RoomGrid, count: int) -> tuple[Floats, Floats]:
    """Frequencies [k] [Hz] and shapes [n, k] of the first modes of a room with rigid walls, without the uniform one.

    At the grid's points; their mean square over the room is 1. As many as there are below `up_to_hz` of a meshed room.

    >>> room = Room([4.0, 2.0, 1.0])
    >>> hz, shapes = mode_shapes(room, room_grid(room), 2)
    >>> hz.round(2).tolist(), round(float(shapes.max()), 6)
    ([42.88, 85.75], 1.414214)
    """
    if isinstance(room, ShapedRoom):
        own = slice(1, 1 + count)
        return room.frequency_hz[own], np.asarray(probe(room.mesh, grid.points) @ room.modes.shapes[:, own])
    top = room.air.c / float(room.size.max())
    while len(room_modes(room, top)[0]) < count:
        top *= 1.5
    hz, orders = room_modes(room, top)
    hz, orders = hz[:count], orders[:count]
    shapes = np.ones((len(grid.points), len(hz)))
    for axis, length in enumerate(room.size):
        shapes *= np.cos(np.pi / length * np.outer(grid.points[:, axis], orders[:, axis]))
    return hz, shapes * np.sqrt(np.where(orders > 0, 2.0, 1.0).prod(axis=1))
