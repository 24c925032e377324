"""Where things are: words for places, regions of plates, distances and meeting lines, rows on nodes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import csr_array

from femstruct.arrays import Floats, Integers
from femstruct.conventions import N_COMPONENTS
from femstruct.declared import checked
from femstruct.elements.polynomials import gauss_interval
from femstruct.errors import InputError
from femstruct.tags import stored_as

# ----------------------------------------------------------------------------------------------------------------------
# Regions of a plane face, and the words for places that all parts share.
# ----------------------------------------------------------------------------------------------------------------------

Vector = tuple[float, float, float]
Pair = tuple[float, float]
Side = Literal["above", "below"]
Facing = Literal["above", "below", "x", "-x", "y", "-y"]  # also of what stands upright: along global axes
Touched = Facing | Literal["middle"]  # where a foundation acts: on a face, or at the mid-surface


@stored_as("region/1")
@dataclass(frozen=True)
@checked("region")
class Region:
    """A region of a part: all of it; of a plate a rectangle, the rim of a rectangle or a line; of a part that is a mesh
    a named set of it, or what lies in a box.

    size : sides of the rectangle or rim [m]. at : its centre from the part's origin corner along the part's own axes
    [m], None for the centre of the part. line : the two ends of a line, part coordinates [m]. named : a set.
    box : lower and upper corner of a box, global axes [m].

    A rectangle of 0.3 m x 0.2 m about a place, the rim of one in the middle, and a line:

    >>> Region("rectangle", size=(0.3, 0.2), at=(1.0, 0.5)).at, Region("rim", size=(0.3, 0.2)).at
    ((1.0, 0.5), None)
    >>> print(Region("line", line=((0.0, 0.5), (2.0, 0.5))))
    line from (0, 0.5) to (2, 0.5) m
    """

    kind: Literal["whole", "rectangle", "rim", "line", "set", "box"]
    size: Pair | None = None
    at: Pair | None = None
    line: tuple[Pair, Pair] | None = None
    named: str | None = None
    box: tuple[Vector, Vector] | None = None

    def __str__(self) -> str:
        """The region in words.

        >>> str(Region("rectangle", size=(0.3, 0.2), at=(1.0, 0.5)))
        'rectangle of 0.3 x 0.2 m at (1, 0.5) m'
        """
        size = "" if self.size is None else f" of {self.size[0]:g} x {self.size[1]:g} m"
        at = "" if self.at is None else f" at ({self.at[0]:g}, {self.at[1]:g}) m"
        ends = "" if self.line is None else " from ({:g}, {:g}) to ({:g}, {:g}) m".format(*self.line[0], *self.line[1])
        named = "" if self.named is None else f" '{self.named}'"
        box = (
            ""
            if self.box is None
            else " from ({:g}, {:g}, {:g}) to ({:g}, {:g}, {:g}) m".format(*self.box[0], *self.box[1])
        )
        return f"{self.kind}{size}{at}{ends}{named}{box}"


# ----------------------------------------------------------------------------------------------------------------------
# Rows on nodal components: motion at the tips of rigid arms, and sparse matrices of rows.
# ----------------------------------------------------------------------------------------------------------------------


def carry_along_arms(rows: Floats, arms: Floats) -> Floats:
    """Motion at the tips of rigid arms [p, 3] or [3] from that at their feet, rows [p, 6, ...]: u + r x arm."""
    x, y, z = np.moveaxis(np.broadcast_to(arms, (len(rows), 3)), 1, 0).reshape(3, -1, *(1,) * (rows.ndim - 2))
    rx, ry, rz = rows[:, 3], rows[:, 4], rows[:, 5]
    tips = rows.copy()
    tips[:, 0] += ry * z - rz * y
    tips[:, 1] += rz * x - rx * z
    tips[:, 2] += rx * y - ry * x
    return tips


def sparse_rows(nodes: Integers, rows: Floats, n_nodes: int) -> csr_array:
    """Rows [p, r, k, 7] on the components of nodes [p, k] as one sparse matrix [p * r, n_nodes * 7]."""
    p, r = rows.shape[:2]
    columns = np.broadcast_to((nodes[:, :, None] * N_COMPONENTS + np.arange(N_COMPONENTS))[:, None], rows.shape)
    owners = np.broadcast_to(np.arange(p * r).reshape(p, r, 1, 1), rows.shape)
    used = rows != 0.0
    return csr_array((rows[used], (owners[used], columns[used])), shape=(p * r, n_nodes * N_COMPONENTS))


def node_rows(nodes: ArrayLike, components: Floats, n_nodes: int) -> csr_array:
    """Rows [m, n_nodes * 7] that combine the seven components [m, 7] of one node each."""
    numbers = np.asarray(nodes, dtype=np.int64)
    return sparse_rows(numbers[:, None], components[:, None, None, :], n_nodes)


def flat_rows(nodes: Integers, rows: Floats, shares: Floats) -> tuple[Integers, Integers, Floats]:
    """The sum of motions, each by its share [p]: nodes [m], components [m] and weights [6, m] of those that matter.

    nodes [p, k], rows [p, 6, k, 7].
    """
    used, owner = np.unique(nodes, return_inverse=True)
    weights = np.zeros((len(used), 6, N_COMPONENTS))
    np.add.at(weights, owner.reshape(nodes.shape), np.moveaxis(rows, 2, 1) * shares[:, None, None, None])
    flat = np.moveaxis(weights, 1, 0).reshape(6, -1)
    matter = np.flatnonzero((flat != 0.0).any(axis=0))
    return used[matter // N_COMPONENTS], matter % N_COMPONENTS, flat[:, matter]


def mean_of_cells(meets: Integers, components: int) -> csr_array:
    """What takes the mean of values [m * c] at the places [m] that they belong to: [p * c, m * c].

    Across lines of the grid curvatures jump; the mean of the cells errs by one order less than each of them.
    """
    share = 1.0 / np.bincount(meets)[meets]
    component = np.arange(components)
    row = (meets[:, None] * components + component).ravel()
    column = (np.arange(len(meets))[:, None] * components + component).ravel()
    return csr_array((np.repeat(share, components), (row, column)))


# ----------------------------------------------------------------------------------------------------------------------
# Where plates, bars and places lie: local axes, distances, clipping, meeting lines.
# ----------------------------------------------------------------------------------------------------------------------

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


def intersection_line(first: Rectangle, second: Rectangle, tolerance: float) -> tuple[Floats, Floats]:
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


# ----------------------------------------------------------------------------------------------------------------------
# Places among the lines of a grid along one direction.
# ----------------------------------------------------------------------------------------------------------------------


def interval_of(grid: Floats, places: Floats) -> tuple[Integers, Floats, Floats]:
    """Interval of each place, where it lies in it from 0 to 1, and the length of the interval.

    >>> interval, share, length = interval_of(np.array([0.0, 1.0, 3.0]), np.array([0.5, 2.0, 3.0]))
    >>> interval.tolist(), share.tolist(), length.tolist()
    ([0, 1, 1], [0.5, 0.5, 1.0], [1.0, 2.0, 2.0])
    """
    index = np.clip(np.searchsorted(grid, places, side="right") - 1, 0, len(grid) - 2)
    size = grid[index + 1] - grid[index]
    return index, np.clip((places - grid[index]) / size, 0.0, 1.0), size


def snap_to_grid(places: Floats, grid: Floats, tolerance: float) -> Floats:
    """The places, those within the tolerance of a grid line on it.

    >>> snap_to_grid(np.array([0.999, 1.4]), np.array([0.0, 1.0, 2.0]), 0.01).tolist()
    [1.0, 1.4]
    """
    index = np.clip(np.searchsorted(grid, places), 1, len(grid) - 1)
    left, right = grid[index - 1], grid[index]
    near = np.where(places - left < right - places, left, right)
    return np.where(np.abs(near - places) <= tolerance, near, places)


def divide_grid(grid: Floats, divisions: int) -> Floats:
    """The grid with every interval in equal pieces.

    >>> divide_grid(np.array([0.0, 1.0, 3.0]), 2).tolist()
    [0.0, 0.5, 1.0, 2.0, 3.0]
    """
    steps = np.arange(divisions) / divisions
    between = grid[:-1, None] + np.diff(grid)[:, None] * steps
    return np.append(between.ravel(), grid[-1])


# ----------------------------------------------------------------------------------------------------------------------
# Regions of a plate: the grid lines they need, and quadrature points over them.
# ----------------------------------------------------------------------------------------------------------------------

Box = tuple[float, float, float, float]


def region_box(where: str, name: str, size: Pair, region: Region, tolerance: float) -> Box:
    """Bounds x0, x1, y0, y1 of a region in its part's coordinates [m], snapped to the part's edges.

    Parameters
    ----------
    name, size : str, Pair
        Of a plate, or of a block and the face the region is on.

    Raises
    ------
    InputError
        For a region that reaches beyond the part, saying by how much, and for a line that does not run along the part's
        own axes.
    """
    if region.kind in ("set", "box"):
        raise InputError(where, got=f"a {region.kind} of {name}", expected="a rectangle, a rim or a line of a plate")
    if region.kind == "whole":
        bounds = np.array([[0.0, size[0]], [0.0, size[1]]])
    elif region.kind == "line":
        if region.line is None:
            raise InputError(where, got="a line without length", expected="two ends")
        bounds = np.sort(np.array(region.line, dtype=np.float64).T, axis=1)
        spans = bounds[:, 1] - bounds[:, 0]
        if spans.min() > tolerance or spans.max() <= tolerance:
            raise InputError(where, got=f"a line over {spans[0]:g} m x {spans[1]:g} m", expected="a line along x or y")
    else:
        if region.size is None:
            raise InputError(where, got=f"a {region.kind} without size", expected="two sides")
        half = np.asarray(region.size) / 2.0
        if not (half > 0).all():
            raise InputError(where, got=f"sides {region.size}", expected="two positive sides")
        center = np.asarray(region.at if region.at is not None else size) / (1.0 if region.at is not None else 2.0)
        bounds = np.stack([center - half, center + half], axis=1)
    beyond = max(-bounds.min(), float((bounds[:, 1] - size).max()))
    if beyond > tolerance:
        raise InputError(
            where,
            got=f"a region that reaches {beyond:.4g} m beyond {name}",
            expected=f"a region inside {size[0]:g} m x {size[1]:g} m",
        )
    bounds = np.where(np.abs(bounds) <= tolerance, 0.0, bounds)
    side = np.asarray(size)[:, None]
    bounds = np.where(np.abs(bounds - side) <= tolerance, side, bounds)
    return float(bounds[0, 0]), float(bounds[0, 1]), float(bounds[1, 0]), float(bounds[1, 1])


def region_lines(region: Region, box: Box) -> list[tuple[Pair, Pair]]:
    """The straight lines of a rim or line region, as pairs of ends."""
    x0, x1, y0, y1 = box
    if region.kind == "line":
        return [((x0, y0), (x1, y1))]
    return [((x0, y0), (x1, y0)), ((x0, y1), (x1, y1)), ((x0, y0), (x0, y1)), ((x1, y0), (x1, y1))]


def area_points(x: Floats, y: Floats, box: Box, tolerance: float, order: int) -> tuple[Floats, Floats]:
    """Gauss points [p, 2] and weights [p] (m^2) over the cells of a grid inside a box that its lines bound."""
    across, weights_x = _interval_points(x, box[0], box[1], tolerance, order)
    along, weights_y = _interval_points(y, box[2], box[3], tolerance, order)
    places = np.stack(np.meshgrid(across, along, indexing="ij"), axis=-1).reshape(-1, 2)
    return places, np.outer(weights_x, weights_y).ravel()


def line_points(x: Floats, y: Floats, ends: tuple[Pair, Pair], tolerance: float, order: int) -> tuple[Floats, Floats]:
    """Gauss points [p, 2] and weights [p] (m) along a grid line."""
    (x0, y0), (x1, y1) = ends
    if abs(x1 - x0) > abs(y1 - y0):
        along, weights = _interval_points(x, x0, x1, tolerance, order)
        return np.stack([along, np.full_like(along, y0)], axis=1), weights
    along, weights = _interval_points(y, y0, y1, tolerance, order)
    return np.stack([np.full_like(along, x0), along], axis=1), weights


def _interval_points(grid: Floats, low: float, high: float, tolerance: float, order: int) -> tuple[Floats, Floats]:
    inside = grid[(grid >= low - tolerance) & (grid <= high + tolerance)]
    steps = np.diff(inside)
    points, weights = gauss_interval(order)
    return (inside[:-1, None] + steps[:, None] * points).ravel(), (steps[:, None] * weights).ravel()


def grid_points(
    x: Floats, y: Floats, region: Region, box: tuple[float, float, float, float], tolerance: float, order: int
) -> tuple[Floats, Floats]:
    """Gauss points [p, 2] and weights [p] of a region over a grid, in its coordinates [m] (m^2 or m)."""
    if region.kind in ("whole", "rectangle"):
        return area_points(x, y, box, tolerance, order)
    pieces = [line_points(x, y, ends, tolerance, order) for ends in region_lines(region, box)]
    return np.concatenate([points for points, _ in pieces]), np.concatenate([weights for _, weights in pieces])
