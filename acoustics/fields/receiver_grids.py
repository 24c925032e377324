"""Cells of a room for pictures, and its modes on them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from acoustics.arrays import Floats, Integers, freeze, frozen
from acoustics.meshed.cavity_mesh import HEX_OF_MESHIO, CavityMesh, box_cells
from acoustics.rooms.box import Box, room_modes

FINE: Final = 28  # cells along the longest side of a rectangular room
MOST_CELLS: Final = 100_000  # of a meshed room that is divided once more


@dataclass(frozen=True, eq=False)
class RoomGrid:
    """Points [n, 3] [m] and straight cells [m, 4] or [m, 8] of a room, corners in the order of VTK."""

    points: Floats
    cells: Integers

    def __post_init__(self) -> None:
        freeze(self, points=frozen("grid.points", self.points, (None, 3)))


def box_grid(room: Box) -> RoomGrid:
    """Equal cells of a rectangular room, fine enough for pictures.

    >>> box_grid(Box([4.0, 2.0, 1.0])).cells.shape
    (2744, 8)
    """
    counts = np.maximum(2, np.rint(FINE * room.size / room.size.max())).astype(int)
    return RoomGrid(*box_cells(room.size.tolist(), counts.tolist()))


def halved_grid(mesh: CavityMesh) -> RoomGrid:
    """The halves of a mesh's own cells."""
    cells = mesh.skfem_mesh
    if 8 * len(mesh.cells) <= MOST_CELLS:
        cells = cells.refined()
    order = np.argsort(HEX_OF_MESHIO) if cells.t.shape[0] == 8 else np.arange(4)
    return RoomGrid(cells.p.T, cells.t[order].T.astype(np.int64))


def box_mode_shapes(room: Box, points: Floats, count: int) -> tuple[Floats, Floats]:
    """Frequencies [k] [Hz] and shapes [n, k] at points [n, 3] of the first modes, without the uniform one.

    The mean square of a shape over the room is 1.

    >>> room = Box([4.0, 2.0, 1.0])
    >>> hz, shapes = box_mode_shapes(room, box_grid(room).points, 2)
    >>> hz.round(2).tolist(), round(float(shapes.max()), 6)
    ([42.88, 85.75], 1.414214)
    """
    top = room.air.c / float(room.size.max())
    while len(room_modes(room, top)[0]) < count:
        top *= 1.5
    hz, orders = room_modes(room, top)
    hz, orders = hz[:count], orders[:count]
    shapes = np.ones((len(points), len(hz)))
    for axis, length in enumerate(room.size):
        shapes *= np.cos(np.pi / length * np.outer(points[:, axis], orders[:, axis]))
    return hz, shapes * np.sqrt(np.where(orders > 0, 2.0, 1.0).prod(axis=1))
