"""Surfaces of a structure where they move the air of a room, in the room's coordinates."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from acoustics.errors import AcousticsError
from acoustics.fields.sound_field import FACING, SoundField
from acoustics.source import SurfaceShapes
from femstruct.arrays import Floats
from femstruct.errors import InputError
from femstruct.modal.basis import ModalBasis
from femstruct.model.probe import Surface

WITHIN = "place its centre with `at`, or give it a `region: {rectangle: [..]}`"


@dataclass(frozen=True, eq=False)
class Placed:
    """A room, and the surfaces of a structure that move its air.

    room : the sound field. name : of the room; a basis that is coupled to it may have a leak of that name.
    surfaces : the first one places the room. points : of each [p, 3], in the room's coordinates [m].
    axes [3, 3], origin [3] : of the room, global; axes as rows [m].

    `placed` makes one. The plane of a half space, the room's axes being those of the structure:

    >>> from scipy.sparse import csr_array
    >>> from acoustics import HalfSpace
    >>> corners = [[0, 0, 1], [2, 0, 1], [2, 2, 1], [0, 2, 1]]
    >>> top = Surface("top", [[1, 1, 1]], [4], [[0, 0, 1]], [[1, 0, 0], [0, 1, 0]], corners, csr_array((1, 7)))
    >>> placed(HalfSpace(), top).origin.tolist()
    [1.0, 1.0, 1.0]
    """

    room: SoundField
    name: str
    surfaces: tuple[Surface, ...]
    points: tuple[Floats, ...]
    axes: Floats
    origin: Floats

    @property
    def first(self) -> Surface:
        """The surface that places the room."""
        return self.surfaces[0]

    def shapes(self, basis: ModalBasis) -> list[SurfaceShapes]:
        """Motion of the surfaces into the room in every mode, with the flow through a leak of the room spread over
        them."""
        area = sum(float(surface.weights.sum()) for surface in self.surfaces)
        flow = basis.volumes[self.name] / area if self.name in basis.volumes else 0.0
        parts = zip(self.points, self.surfaces, strict=True)
        return [SurfaceShapes(points, one.weights, one.shapes(basis.shapes) + flow) for points, one in parts]

    def from_room(self, points: Floats) -> Floats:
        """Global coordinates [.., 3] of places in the room [.., 3] [m]."""
        return np.asarray(points @ self.axes + self.origin)


def placed(
    room: SoundField,
    surface: Surface,
    offset: tuple[float, float] = (0.0, 0.0),
    name: str = "room",
    walls: Mapping[str, Surface] | None = None,
) -> Placed:
    """A room under, over or beside surfaces of a structure.

    surface : the one that places the room, on its ceiling or what stands for it. offset : of its centre from the middle
    of that, room axes [m]. walls : further surfaces, by the wall of the room that they move.

    Raises InputError: a surface that faces elsewhere, reaches beyond its wall, or lies on a wall that this kind of room
    cannot move.

    A room of 4 x 3 m under a slab of 2 x 2 m, whose middle is 1 m from that of the ceiling:

    >>> from scipy.sparse import csr_array
    >>> from acoustics import Room
    >>> corners = [[0, 0, 2.5], [2, 0, 2.5], [2, 2, 2.5], [0, 2, 2.5]]
    >>> slab = Surface("slab", [[1, 1, 2.5]], [4], [[0, 0, -1]], [[1, 0, 0], [0, 1, 0]], corners, csr_array((1, 7)))
    >>> room = placed(Room([4, 3, 2.5]), slab, offset=(1.0, 0.0))
    >>> room.points[0].tolist(), room.from_room(np.zeros(3)).tolist()
    ([[3.0, 1.5, 2.5]], [-2.0, -0.5, 0.0])
    """
    where = f"rooms.{name}"
    if (surface.normals @ room.facing).min() < FACING:
        towards = "up" if room.facing[2] > 0 else "down"
        normal = surface.normal
        raise InputError(
            where,
            got=f"a surface with normal ({normal[0]:.2g}, {normal[1]:.2g}, {normal[2]:.2g})",
            expected=f"a normal that points {towards}, into the air of the room",
            do=f"use `side: {'above' if towards == 'up' else 'below'}` on a horizontal plate",
        )
    axes = room.axes(surface.along, surface.normal)
    middle = room.middle + np.array([*offset, 0.0])
    own = [(room.movable[0], surface), *(walls or {}).items()]
    points = []
    for wall, one in own:
        moved = (one.points - surface.centre) @ axes.T + middle
        corners = (one.outline - surface.centre) @ axes.T + middle
        directions = np.concatenate([one.normals, np.tile(one.normal, (len(corners), 1))]) @ axes.T
        try:
            room.accept(wall, np.concatenate([moved, corners]), directions)
        except AcousticsError as error:
            do = WITHIN if error.where == "surface.points" else error.do
            raise InputError(where, got=error.got, expected=error.expected, do=do) from error
        points.append(moved)
    return Placed(room, name, tuple(one for _, one in own), tuple(points), axes, surface.centre - middle @ axes)
