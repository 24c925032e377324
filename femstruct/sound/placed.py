"""Surfaces of a structure where they move the air of a room, in the room's coordinates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acoustics.errors import AcousticsError
from acoustics.fields.sound_field import FACING, SoundField
from acoustics.source import SurfaceShapes
from femstruct.arrays import Floats
from femstruct.declared import expect
from femstruct.errors import InputError
from femstruct.modal.basis import ModalBasis
from femstruct.model.probe import Surface

LEVEL: Final = 1e-6  # of the size of an outline, by which it may depart from flat
FILLED: Final = 1e-3  # of its area, by which a surface may miss that of its outline
WITHIN = "place its centre with `at`, or give it a `region: {rectangle: [..]}`"


@dataclass(frozen=True, eq=False)
class Placed:
    """A room, and the surfaces of a structure that move its air.

    room : the sound field. name : of the room; a basis that is coupled to it may have a leak of that name.
    surfaces : the first one places the room. walls : those of the room that they move, in their order.
    points : of each [p, 3], in the room's coordinates [m].
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
    walls: tuple[str, ...]

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
    walls: Mapping[str, Surface | Sequence[Surface]] | None = None,
    on: str = "",
) -> Placed:
    """A room under, over or beside surfaces of a structure.

    Parameters
    ----------
    surface : Surface
        The one that places the room, on its ceiling or what stands for it, or on another wall that is named.
    offset : tuple[float, float]
        Of its centre from the middle of that, along the two axes of the room there [m].
    walls : Mapping[str, Surface | Sequence[Surface]] | None
        Further surfaces, by the wall of the room that they move.
    on : str
        The wall of the first surface, where it is not the ceiling.

    Raises
    ------
    InputError
        A surface that faces elsewhere, reaches beyond its wall, does not lie on it or covers another one, or lies on a
        wall that this kind of room cannot move.

    Examples
    --------
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
    expect(where, room, SoundField, "acoustics.Room([4.0, 3.0, 2.5]) is one")
    expect(f"{where} surface", surface, Surface, 'model.surfaces["NAME"] is one')
    first = on or room.movable[0]
    try:
        axes, middle = room.placed_by(first, surface.along, _furthest(room, first, surface))
    except AcousticsError as error:
        raise InputError(where, got=error.got, expected=error.expected, do=error.do) from error
    middle = middle.copy()
    middle[room.along(first)] += offset
    own = [(first, surface), *_each(walls or {})]
    points, outlines = [], []
    for wall, one in own:
        moved = (one.points - surface.centre) @ axes.T + middle
        corners = (one.outline - surface.centre) @ axes.T + middle
        directions = np.concatenate([one.normals, np.tile(one.normal, (len(corners), 1))]) @ axes.T
        try:
            room.accept(wall, np.concatenate([moved, corners]), directions)
        except AcousticsError as error:
            do = error.do or (WITHIN if error.where == "surface.points" else "")
            path = f"{where}.surfaces.{wall}" if error.where == "surface.points" and one is not surface else where
            raise InputError(path, got=error.got, expected=error.expected, do=do) from error
        points.append(moved)
        outlines.append(corners)
    _apart(where, own, points, outlines)
    walls_moved, surfaces = zip(*own, strict=True)
    return Placed(room, name, surfaces, tuple(points), axes, surface.centre - middle @ axes, walls_moved)


def _each(walls: Mapping[str, Surface | Sequence[Surface]]) -> list[tuple[str, Surface]]:
    """Every further surface with its wall."""
    return [(wall, one) for wall, some in walls.items() for one in ([some] if isinstance(some, Surface) else some)]


def _furthest(room: SoundField, wall: str, surface: Surface) -> Floats:
    """The normal of a surface: of one on the first wall, the one that faces least as it should."""
    if wall != room.movable[0]:
        return surface.normal
    facing = surface.normals @ room.facing
    return surface.normal if facing.min() >= FACING else surface.normals[facing.argmin()]


def _apart(
    where: str, own: Sequence[tuple[str, Surface]], points: Sequence[Floats], outlines: Sequence[Floats]
) -> None:
    """Refuse surfaces on one wall that cover each other: what moves there would be counted twice."""
    for (i, (wall, one)), (j, (there, other)) in combinations(enumerate(own), 2):
        if wall != there:
            continue
        inside = _covered((one, points[i], outlines[i]), (other, points[j], outlines[j]))
        if inside > 0.0:
            raise InputError(
                f"{where}.surfaces.{wall}",
                got=f"'{other.name}' over '{one.name}' on {inside:.3g} m^2 of it",
                expected="surfaces beside each other",
                do="give one of them a `region` without the other",
            )


def _covered(one: tuple[Surface, Floats, Floats], other: tuple[Surface, Floats, Floats]) -> float:
    """Area [m^2] of one of two surfaces (each with its points and outline in the room) that lies within the other.

    Of surfaces that do not fill their outlines only points in common tell.
    """
    size = float(np.ptp(np.concatenate([one[2], other[2]]), axis=0).max())
    axes = [axis for axis in range(3) if np.ptp(one[2][:, axis]) > LEVEL * size]
    found = 0.0
    for (mine, points, _), (yours, others, corners) in ((one, other), (other, one)):
        flat = corners[:, axes]
        if len(axes) != 2 or abs(_area(flat) / yours.weights.sum() - 1) > FILLED:
            grid = np.round(np.concatenate([points, others]) / (LEVEL * size)).astype(np.int64)
            inside = np.isin(_numbers(grid)[: len(points)], _numbers(grid)[len(points) :])
        else:
            inside = _within(points[:, axes], flat)
        found = max(found, float(mine.weights[inside].sum()))
    return found


def _numbers(grid: NDArray[np.int64]) -> NDArray[np.int64]:
    return np.unique(grid, axis=0, return_inverse=True)[1].ravel().astype(np.int64)


def _area(corners: Floats) -> float:
    """Area of a polygon [n, 2] [m^2]."""
    x, y = corners.T
    return 0.5 * abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1)))


def _within(points: Floats, corners: Floats) -> NDArray[np.bool_]:
    """Which points [p, 2] lie within a polygon [n, 2], by how often a ray from them crosses its sides."""
    low, high = corners, np.roll(corners, -1, axis=0)
    x, y = points[:, :1], points[:, 1:]
    spans = (low[:, 1] > y) != (high[:, 1] > y)
    rise = np.where(high[:, 1] == low[:, 1], 1.0, high[:, 1] - low[:, 1])
    crossing = low[:, 0] + (y - low[:, 1]) / rise * (high[:, 0] - low[:, 0])
    return np.asarray((spans & (x < crossing)).sum(axis=1) % 2 == 1)
