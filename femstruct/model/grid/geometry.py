"""Where plates, bars and places lie: local axes, distances, clipping, meeting lines."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import InputError
from femstruct.model.region import Pair, Vector

PARALLEL = 1e-6
"""Sine of the angle below which two directions count as parallel."""


class Rectangle(Protocol):
    """A flat rectangular part, as `femstruct.parts.plate.Plate` is: a corner of its mid-surface, sides, directions."""

    @property
    def name(self) -> str: ...
    @property
    def origin(self) -> Vector: ...
    @property
    def size(self) -> Pair: ...
    @property
    def normal(self) -> Vector: ...
    @property
    def x_direction(self) -> Vector | None: ...


def rectangle_axes(plate: Rectangle) -> Floats:
    """Local axes of a plate [3, 3]: rows are x, y and the normal in global components.

    Without `x_direction`, x is global x projected on the plate, or global y for a plate normal to global x.

    Raises InputError for a normal without length and for an x_direction out of the plate.
    """
    where = f"parts.{plate.name}"
    normal = np.asarray(plate.normal, dtype=np.float64)
    length = np.linalg.norm(normal)
    if not length > 0:
        raise InputError(f"{where}.normal", got="a vector without length", expected="a direction")
    normal = normal / length
    if plate.x_direction is None:
        x = np.array([1.0, 0.0, 0.0])
        if np.linalg.norm(np.cross(normal, x)) < PARALLEL:
            x = np.array([0.0, 1.0, 0.0])
    else:
        x = np.asarray(plate.x_direction, dtype=np.float64)
        length = np.linalg.norm(x)
        if not length > 0 or abs(normal @ x) > PARALLEL * length:
            raise InputError(
                f"{where}.x_direction",
                got=str([float(value) for value in x]),
                expected=f"a direction at a right angle to the normal {[float(value) for value in plate.normal]}",
            )
    x = x - (x @ normal) * normal
    x = x / np.linalg.norm(x)
    return np.stack([x, np.cross(normal, x), normal])


def to_rectangle(plate: Rectangle, axes: Floats, points: Floats) -> Floats:
    """Coordinates along the plate's own axes from its origin corner, and height above its mid-surface [..., 3]."""
    local: Floats = (points - np.asarray(plate.origin, dtype=np.float64)) @ axes.T
    return local


def from_rectangle(plate: Rectangle, axes: Floats, local: Floats) -> Floats:
    """Global positions of places of a plate [..., 2 or 3]."""
    origin = np.asarray(plate.origin, dtype=np.float64)
    result: Floats = origin + local @ axes[: local.shape[-1]]
    return result


def distance_to_rectangle(local: Floats, size: tuple[float, float]) -> Floats:
    """Distance of points in a plate's coordinates [..., 3] from the plate's mid-surface [m]."""
    across = np.maximum(np.maximum(-local[..., :2], local[..., :2] - np.asarray(size)), 0.0)
    distance: Floats = np.linalg.norm(np.concatenate([across, local[..., 2:]], axis=-1), axis=-1)
    return distance


def distance_to_segments(point: Floats, start: Floats, end: Floats) -> tuple[Floats, Floats]:
    """Distances of a point [3] from segments [n, 3] and the nearest place on each, from 0 to 1."""
    along = end - start
    place = np.clip(((point - start) * along).sum(axis=1) / (along**2).sum(axis=1), 0.0, 1.0)
    return np.linalg.norm(start + place[:, None] * along - point, axis=1), place


def clip(start: Floats, end: Floats, size: tuple[float, float], tolerance: float) -> tuple[float, float] | None:
    """The stretch of a segment, 0 to 1 from start to end, that lies over the rectangle [0, size]; None if none does.

    What lies off it by the tolerance lies on it, but along the segment it ends at the edge: a line over two rectangles
    in a row has one place where they meet.
    """
    low, high = 0.0, 1.0
    steps = np.abs(end - start)[:2]
    for axis in (0, 1):
        p, step = start[axis], end[axis] - start[axis]
        if abs(step) <= tolerance:
            if not -tolerance <= p <= size[axis] + tolerance:
                return None
            continue
        bounds = sorted(((-tolerance - p) / step, (size[axis] + tolerance - p) / step))
        low, high = max(low, bounds[0]), min(high, bounds[1])
    if low > high:
        return None
    along = int(np.argmax(steps))
    if steps[along] > tolerance:
        edges = np.sort((np.array([0.0, size[along]]) - start[along]) / (end[along] - start[along]))
        low, high = min(max(low, edges[0]), edges[1]), max(min(high, edges[1]), edges[0])
    return float(low), float(high)


def meeting_line(first: Rectangle, second: Rectangle, tolerance: float) -> tuple[Floats, Floats]:
    """The two ends [3], [3] of the line (or the point, twice) along which two plates meet.

    Raises InputError when they do not meet, when they overlap over an area, or along a line that is not parallel to the
    sides of both.
    """
    where = f"plates {first.name} and {second.name}"
    a, b = rectangle_axes(first), rectangle_axes(second)
    direction = np.cross(a[2], b[2])
    if np.linalg.norm(direction) < PARALLEL:
        return _edge_in_plane(first, second, a, b, tolerance)
    direction = direction / np.linalg.norm(direction)
    for plate, axes in ((first, a), (second, b)):
        if np.abs(axes[:2] @ direction).min() > PARALLEL:
            raise InputError(
                where,
                got=f"a common line oblique to the sides of {plate.name}",
                expected="a common line parallel to the sides of both",
                do="turn the plate's x_direction",
            )
    origins = np.asarray(first.origin), np.asarray(second.origin)
    system = np.stack([a[2], b[2], direction])
    middle = (origins[0] + origins[1]) / 2.0
    anchor = np.linalg.solve(system, np.array([a[2] @ origins[0], b[2] @ origins[1], direction @ middle]))
    reach = sum(first.size) + sum(second.size) + float(np.linalg.norm(origins[1] - origins[0]))
    start, end = anchor - reach * direction, anchor + reach * direction
    low, high = 0.0, 1.0
    for plate, axes in ((first, a), (second, b)):
        stretch = clip(to_rectangle(plate, axes, start), to_rectangle(plate, axes, end), plate.size, tolerance)
        if stretch is None:
            low, high = 1.0, 0.0
            break
        low, high = max(low, stretch[0]), min(high, stretch[1])
    if (low - high) * 2.0 * reach > 2.0 * tolerance:
        raise InputError(
            where,
            got=_apart(first, second, a, b),
            expected="plates with a common line",
            do="move one of them, or write 'reach' in the joint where an edge lies on a face",
        )
    if (high - low) * 2.0 * reach <= tolerance:
        low = high = (low + high) / 2.0
    return start + low * (end - start), start + high * (end - start)


def _edge_in_plane(
    first: Rectangle, second: Rectangle, a: Floats, b: Floats, tolerance: float
) -> tuple[Floats, Floats]:
    where = f"plates {first.name} and {second.name}"
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) * np.asarray(second.size)
    local = to_rectangle(first, a, from_rectangle(second, b, corners))
    if np.abs(local[:, 2]).max() > tolerance:
        raise InputError(
            where,
            got=_apart(first, second, a, b),
            expected="plates with a common line",
            do="move one of them, or write 'reach' in the joint where an edge lies on a face",
        )
    if min(abs(a[0] @ b[0]), abs(a[0] @ b[1])) > PARALLEL:
        raise InputError(where, got="sides that are not parallel", expected="parallel sides", do="turn x_direction")
    low = np.maximum(local[:, :2].min(axis=0), 0.0)
    high = np.minimum(local[:, :2].max(axis=0), first.size)
    width = high - low
    if (width < -tolerance).any():
        raise InputError(
            where,
            got=_apart(first, second, a, b),
            expected="plates with a common line",
            do="move one of them, or write 'reach' in the joint where an edge lies on a face",
        )
    if (width > tolerance).all():
        raise InputError(
            where,
            got=f"an overlap of {width[0]:g} m x {width[1]:g} m in one plane",
            expected="plates with only a line in common",
        )
    high = np.where(width > tolerance, high, low)
    return from_rectangle(first, a, low), from_rectangle(first, a, high)


def _apart(first: Rectangle, second: Rectangle, a: Floats, b: Floats) -> str:
    distance = min(
        float(distance_to_rectangle(to_rectangle(one, axes, from_rectangle(other, others, samples)), one.size).min())
        for one, axes, other, others, samples in (
            (first, a, second, b, _samples(second)),
            (second, b, first, a, _samples(first)),
        )
    )
    return f"mid-surfaces about {distance:.4g} m apart"


def _samples(plate: Rectangle) -> Floats:
    s = np.linspace(0.0, 1.0, 21)
    return np.stack(np.meshgrid(s * plate.size[0], s * plate.size[1]), axis=-1).reshape(-1, 2)
