"""Where the nodes of parts are, while it is being decided: grid lines of rectangles and bars, and who needs them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.errors import InputError, list_some
from femstruct.model.attached import Users
from femstruct.model.part import FilledBox
from femstruct.model.regions import (
    PARALLEL,
    Pair,
    Rectangle,
    Region,
    Vector,
    distance_to_segments,
    rectangle_axes,
    region_box,
    to_rectangle,
)

# ----------------------------------------------------------------------------------------------------------------------
# How large the cells of a rectangle are: as asked for, within what a machine can hold.
# ----------------------------------------------------------------------------------------------------------------------

MOST_DIVISIONS = 2000  # of a side
MOST_CELLS = 300_000  # 1.6 million of them were killed by a machine of some gigabytes


def cell_sides(where: str, size: Pair, mesh: float | tuple[int, int]) -> Pair:
    """Largest sides of cells along both directions [m].

    Parameters
    ----------
    mesh : float | tuple[int, int]
        A largest side [m], or the least number of divisions.

    Raises
    ------
    InputError
        For a mesh that is not positive, and for one that fills the memory of most machines: there the system kills the
        run without a word.

    Examples
    --------
    >>> cell_sides("parts.floor.mesh", (4.0, 3.0), (8, 2)), cell_sides("parts.floor.mesh", (4.0, 3.0), 0.5)
    ((0.5, 1.5), (0.5, 0.5))
    """
    along, across = (_cell_side(where, size[direction], mesh, direction) for direction in (0, 1))
    cells = size[0] / along * (size[1] / across)
    if cells > MOST_CELLS * (1.0 + 1e-9):
        side = (size[0] * size[1] / MOST_CELLS) ** 0.5
        raise InputError(
            where, got=f"{cells:.3g} cells", expected=f"at most {MOST_CELLS}", do=f"use cells of {side:.2g} m or more"
        )
    return along, across


def _cell_side(where: str, side: float, mesh: float | tuple[int, int], direction: int) -> float:
    if isinstance(mesh, tuple):
        if not 1 <= mesh[direction] <= MOST_DIVISIONS:
            raise InputError(where, got=f"{mesh[direction]} divisions", expected=f"1 to {MOST_DIVISIONS}")
        return side / mesh[direction]
    if not mesh > 0:
        raise InputError(where, got=f"{mesh:g} m", expected="a positive length")
    if side > MOST_DIVISIONS * mesh * (1.0 + 1e-9):
        raise InputError(
            where,
            got=f"{mesh:g} m, {side / mesh:.3g} divisions of a side of {side:g} m",
            expected=f"at most {MOST_DIVISIONS} divisions",
            do=f"use {side / MOST_DIVISIONS:.2g} m or more",
        )
    return mesh


# ----------------------------------------------------------------------------------------------------------------------
# Grids over outlines of right angles with rectangular openings: lines through all corners, cells of what is inside.
# ----------------------------------------------------------------------------------------------------------------------

Hole = tuple[Pair, Pair]
"""Sides along x and y, and the middle [m]."""
SAME = 1e-9  # of the size of an outline: coordinates nearer to each other are one


class Gridded(NamedTuple):
    """Nodes [n, 2] [m], cells [m, 4] with corners in turn about +z, and the nodes of named lines."""

    places: Floats
    cells: Integers
    lines: dict[str, Integers]


def grid_cells(
    where: str, outline: tuple[Pair, ...], holes: tuple[Hole, ...], through: tuple[Pair, ...], largest: float
) -> Gridded:
    """Cells with sides of at most `largest` [m] over an outline less its holes, with nodes at the places `through`.

    Lines are "rim", "side 1" (from the first corner to the second), .., "hole 1", ...

    Raises InputError for an outline without right angles along the axes or that crosses itself, for a hole that is not
    inside, and for places that are not on it.

    An L of three squares, in cells of half a side:

    >>> corners = ((0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0))
    >>> grid = grid_cells("parts.l", corners, (), (), 0.5)
    >>> len(grid.cells), len(grid.lines["rim"]), len(grid.lines["side 1"])
    (12, 16, 5)
    """
    corners = _corners(where, outline)
    size = float(np.ptp(corners, axis=0).max())
    if not largest > 0:
        raise InputError(f"{where}.mesh", got=f"{largest:g} m", expected="a positive length")
    boxes = [_hole(f"{where}.holes", hole, corners, size) for hole in holes]
    places = np.array([*corners, *(end for box in boxes for end in box), *through], dtype=np.float64)
    x, y = (_lines(places[:, axis], largest, SAME * size) for axis in (0, 1))
    if (len(x) - 1) * (len(y) - 1) > MOST_CELLS:
        got = f"{largest:g} m, {(len(x) - 1) * (len(y) - 1)} cells"
        raise InputError(f"{where}.mesh", got=got, expected=f"at most {MOST_CELLS} cells")
    middles = np.stack(np.meshgrid((x[:-1] + x[1:]) / 2.0, (y[:-1] + y[1:]) / 2.0, indexing="ij"), axis=-1)
    inside = _inside(corners, middles)
    for low, high in boxes:
        inside &= ~((middles > low) & (middles < high)).all(axis=-1)
    n = np.arange(len(x) * len(y)).reshape(len(x), len(y))
    cells = np.stack([n[:-1, :-1], n[1:, :-1], n[1:, 1:], n[:-1, 1:]], axis=-1)[inside]
    used, cells = np.unique(cells, return_inverse=True)
    nodes = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)[used]
    for place in through:
        if np.abs(nodes - place).max(axis=1).min() > SAME * size:
            raise InputError(f"{where}.through", got=f"({place[0]:g}, {place[1]:g}) m", expected="a place on it")
    named = {f"side {k + 1}": _on(nodes, a, b, size) for k, (a, b) in enumerate(_sides(corners))}
    named["rim"] = np.unique(np.concatenate(list(named.values())))
    for k, (low, high) in enumerate(boxes):
        ends = [low, [high[0], low[1]], high, [low[0], high[1]]]
        named[f"hole {k + 1}"] = np.unique(np.concatenate([_on(nodes, a, b, size) for a, b in _sides(np.array(ends))]))
    return Gridded(nodes, cells.reshape(-1, 4), named)


def _corners(where: str, outline: tuple[Pair, ...]) -> Floats:
    corners = np.array(outline, dtype=np.float64).reshape(-1, 2)
    steps = np.roll(corners, -1, axis=0) - corners
    if len(corners) < 4:
        raise InputError(f"{where}.outline", got=f"{len(corners)} corners", expected="four or more")
    along = np.abs(steps) > SAME * float(np.ptp(corners, axis=0).max())
    if (bad := np.flatnonzero(along.sum(axis=1) != 1)).size:
        a, b = corners[bad[0]], corners[(bad[0] + 1) % len(corners)]
        raise InputError(
            f"{where}.outline",
            got=f"a side from ({a[0]:g}, {a[1]:g}) to ({b[0]:g}, {b[1]:g}) m",
            expected="sides along x or y",
            do="mesh other outlines with a program, and name the file: {type: shell, mesh: FILE}",
        )
    size = float(np.ptp(corners, axis=0).max())
    x, y = (_lines(corners[:, axis], np.inf, SAME * size) for axis in (0, 1))
    middles = np.stack(np.meshgrid((x[:-1] + x[1:]) / 2.0, (y[:-1] + y[1:]) / 2.0, indexing="ij"), axis=-1)
    covered = float(np.outer(np.diff(x), np.diff(y))[_inside(corners, middles)].sum())
    if abs(covered - _area(corners)) > SAME * size**2:
        raise InputError(f"{where}.outline", got="an outline that crosses itself", expected="corners in turn")
    return corners


def _hole(where: str, hole: Hole, corners: Floats, size: float) -> tuple[Floats, Floats]:
    """Lower and upper corner of a hole. It may reach the outline from inside; what counts is where its middle lies."""
    sides, middle = np.asarray(hole[0]), np.asarray(hole[1])
    low, high = middle - sides / 2.0, middle + sides / 2.0
    if not (sides > 0).all():
        raise InputError(where, got=f"sides {hole[0]}", expected="two positive sides")
    ends = np.array([low, [high[0], low[1]], high, [low[0], high[1]]])
    inner = middle + (ends - middle) * (1.0 - 4.0 * SAME * size / sides.min())
    sound = _inside(corners, np.concatenate([inner, middle[None]])).all()
    crossed = any(((low < corner) & (corner < high)).all() for corner in corners)
    if not sound or crossed:
        got = f"a hole of {sides[0]:g} m x {sides[1]:g} m at ({middle[0]:g}, {middle[1]:g}) m that is not inside"
        raise InputError(where, got=got, expected="holes inside the outline")
    return low, high


def _lines(places: Floats, largest: float, same: float) -> Floats:
    """Ascending places of lines: through all that are given, no farther apart than `largest`."""
    fixed = np.sort(places)
    fixed = fixed[np.r_[True, np.diff(fixed) > same]]
    counts = np.maximum(1, np.ceil(np.diff(fixed) / largest - SAME)).astype(int)
    pieces = [np.linspace(a, b, n, endpoint=False) for a, b, n in zip(fixed[:-1], fixed[1:], counts, strict=True)]
    return np.concatenate([*pieces, fixed[-1:]])


def _sides(corners: Floats) -> list[tuple[Floats, Floats]]:
    return list(zip(corners, np.roll(corners, -1, axis=0), strict=True))


def _area(corners: Floats) -> float:
    x, y = corners.T
    return abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2.0


def _inside(corners: Floats, places: Floats) -> np.ndarray:
    """Whether places [..., 2] are inside: upright sides to their right are crossed an odd number of times."""
    crossings = np.zeros(places.shape[:-1], dtype=np.int64)
    for a, b in _sides(corners):
        if abs(a[0] - b[0]) < abs(a[1] - b[1]):
            low, high = sorted((a[1], b[1]))
            crossings += (places[..., 0] < a[0]) & (places[..., 1] > low) & (places[..., 1] < high)
    return np.asarray(crossings % 2 == 1)


def _on(nodes: Floats, start: Floats, end: Floats, size: float) -> Integers:
    """Nodes on a side along x or y."""
    low, high = np.minimum(start, end) - SAME * size, np.maximum(start, end) + SAME * size
    return np.flatnonzero(((nodes >= low) & (nodes <= high)).all(axis=1))


# ----------------------------------------------------------------------------------------------------------------------
# One-dimensional grids of plate sides and bars: nodes where something needs them, and shared along common lines.
# ----------------------------------------------------------------------------------------------------------------------

Key = tuple[str | int, ...]
"""(plate, 0 | 1) for a side of a plate, (frame, line, segment) for a segment of a frame."""

_ROUNDS = 100


@dataclass
class GridAxis:
    """Grid of a side from 0 to `length`: the required places, and no interval longer than `size` [m].

    Places closer than `tolerance` to one already there are the same place. In the stretches `given` the nodes are those
    of a plate, whatever the size.
    """

    length: float
    size: float
    tolerance: float
    required: list[float] = field(default_factory=list)
    given: list[tuple[float, float]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.required = [0.0, self.length]

    def require(self, *places: float) -> bool:
        """Add places; True when one of them is new."""
        new = False
        for place in places:
            if min(abs(place - other) for other in self.required) > self.tolerance:
                self.required.append(place)
                new = True
        return new

    def grid(self) -> Floats:
        """Ascending places [n + 1]: equal intervals between required ones."""
        fixed = np.sort(np.array(self.required))
        # A side of exactly three sizes has three intervals, whatever its rounding.
        counts = np.maximum(1, np.ceil(np.diff(fixed) / self.size - 1e-9)).astype(int)
        middles = (fixed[:-1] + fixed[1:]) / 2.0
        for start, end in self.given:
            counts[(middles > start) & (middles < end)] = 1
        pieces = [
            np.linspace(low, high, count, endpoint=False)
            for low, high, count in zip(fixed[:-1], fixed[1:], counts, strict=True)
        ]
        return np.concatenate([*pieces, fixed[-1:]])


@dataclass(frozen=True)
class Track:
    """A stretch of an axis: the place `start` is the beginning of the shared line, `end` its end."""

    key: Key
    start: float
    end: float


@dataclass(frozen=True)
class SharedLine:
    """Two axes that run along one line; nodes of `source` are put on `target` too."""

    source: Track
    target: Track


def settle(axes: dict[Key, GridAxis], lines: list[SharedLine]) -> dict[Key, Floats]:
    """Grids of all axes, after the nodes of shared lines have travelled from axis to axis until nothing changes.

    Raises InputError when they do not settle.
    """
    for _ in range(_ROUNDS):
        changed = [_pass_on(axes, line) for line in lines]
        if not any(changed):
            return {key: axis.grid() for key, axis in axes.items()}
    raise InputError("mesh", got="grid lines that multiply endlessly", expected="joined parts with compatible grids")


def _pass_on(axes: dict[Key, GridAxis], line: SharedLine) -> bool:
    source, target = line.source, line.target
    axis = axes[source.key]
    places = axis.grid()
    low, high = sorted((source.start, source.end))
    inside = places[(places >= low - axis.tolerance) & (places <= high + axis.tolerance)]
    share = (inside - source.start) / (source.end - source.start)
    moved = target.start + share * (target.end - target.start)
    return axes[target.key].require(*np.clip(moved, 0.0, axes[target.key].length).tolist())


# ----------------------------------------------------------------------------------------------------------------------
# Where the nodes of parts are, while it is being decided.
# ----------------------------------------------------------------------------------------------------------------------

Grids = Mapping[Key, Floats]
"""Grid lines [n] of every side of a rectangle and every straight piece of bars, from its start [m]."""


class AlignedBox(Protocol):
    """A box along the global axes that takes along what touches it."""

    @property
    def name(self) -> str: ...
    @property
    def origin(self) -> Vector: ...
    @property
    def size(self) -> Vector: ...


@dataclass(frozen=True, eq=False)
class Segment:
    """A straight piece of a line of bars; `start`, `end` are the ends of the flexible bar [m].

    arms [2, 3] : from the line to the flexible bar at its nodes near start and end, linear between them [m].
    """

    key: Key
    start: Floats
    end: Floats
    arms: Floats

    @property
    def feet(self) -> Floats:
        """Ends of the straight line its nodes lie on [2, 3]; bars and nodes divide both in the same shares."""
        line: Floats = np.stack([self.start, self.end]) - self.arms
        return line


class Layout:
    """The grids of a structure while they are being decided; `settled` gives the result.

    tolerance : places closer than this are one [m]. rectangles, segments, boxes : what joints can meet, by part;
    vertices [n, 3] : points of the lines of bars. bodies : what layers can lie against. given : names of parts whose
    nodes are their own, as of a mesh from a file: what asks for a node there finds those that it has. taken : cells
    that parts take of their files. covering : mass per length along all bars of a part, beside their own [kg/m].
    loaded : parts of bars and places [3] on them where something acts [m].
    """

    def __init__(self, tolerance: float) -> None:
        self.tolerance = tolerance
        self.rectangles: dict[str, Rectangle] = {}
        self.axes_of: dict[str, Floats] = {}
        self.segments: dict[str, tuple[Segment, ...]] = {}
        self.vertices: dict[str, Floats] = {}
        self.boxes: dict[str, AlignedBox] = {}
        self.bodies: dict[str, FilledBox] = {}
        self.pulled: set[str] = set()
        self.stretched: frozenset[str] = frozenset()
        self.given: set[str] = set()
        self.taken: Users = ()
        self.covering: dict[str, float] = {}
        self.loaded: list[tuple[str, Floats]] = []
        self.grids: dict[Key, GridAxis] = {}
        self.shared: list[SharedLine] = []
        self.tied: list[tuple[Key, float, float]] = []

    def add_rectangle(self, part: Rectangle, largest: tuple[float, float]) -> None:
        """A part that is a grid of cells with sides of at most these lengths [m]."""
        self.rectangles[part.name] = part
        self.axes_of[part.name] = rectangle_axes(part)
        for direction in (0, 1):
            self.grids[part.name, direction] = GridAxis(part.size[direction], largest[direction], self.tolerance)

    def add_bars(self, name: str, vertices: Floats, segments: tuple[Segment, ...], largest: float) -> None:
        """A part of bars of at most this length [m] along straight pieces, with nodes at its own points."""
        self.segments[name], self.vertices[name] = segments, vertices
        for segment in segments:
            length = float(np.linalg.norm(segment.end - segment.start))
            self.grids[segment.key] = GridAxis(length, largest, self.tolerance)
        for vertex in vertices:
            self.on_bars(name, vertex)

    def settled(self) -> Grids:
        """The grid of every side and every straight piece."""
        return settle(self.grids, self.shared)

    def on_rectangle(self, name: str, local: Floats) -> None:
        """A node at a place of a rectangle, in its coordinates."""
        for direction in (0, 1):
            self.grids[name, direction].require(float(local[direction]))

    def on_bars(self, name: str, position: Floats, *, own: bool = False) -> None:
        """Nodes of bars at a place, on every piece that passes through it.

        Parameters
        ----------
        own : bool
            But where these are those of a plate, too.
        """
        for segment in self.segments[name]:
            starts, ends = np.stack([segment.feet, [segment.start, segment.end]], axis=1)
            for distance, share in zip(*distance_to_segments(position, starts, ends), strict=True):
                place = float(share) * self.grids[segment.key].length
                if distance <= self.tolerance and not (own and self._common(segment.key, place)):
                    self.grids[segment.key].require(place)

    def _common(self, key: Key, place: float) -> bool:
        """Whether nodes at a place of an axis are those of another one, too."""
        tracks = [track for line in self.shared for track in (line.source, line.target)]
        ends = [*((track.key, track.start, track.end) for track in tracks), *self.tied]
        return any(min(start, end) <= place <= max(start, end) for one, start, end in ends if one == key)

    def share(self, segment: Segment, places: Floats) -> None:
        """Note the stretch of a piece of bars that has the nodes of another part at places of it [n, 3] [m]."""
        along = segment.feet[1] - segment.feet[0]
        if len(places) > 1:
            shares = np.clip((places - segment.feet[0]) @ along / (along @ along), 0.0, 1.0)
            length = self.grids[segment.key].length
            self.tied.append((segment.key, float(shares.min()) * length, float(shares.max()) * length))

    def length(self, name: str) -> float:
        """Length of all bars of a part [m]."""
        return float(sum(np.linalg.norm(segment.end - segment.start) for segment in self.segments[name]))

    def on_region(self, where: str, name: str, region: Region) -> None:
        """Grid lines along the sides of a region; InputError where there is no rectangle of that name."""
        if name in self.given:
            return
        if name not in self.rectangles:
            known = list_some(self.rectangles) or "there is none"
            raise InputError(where, got=f"'{name}'", expected=f"a plate: {known}")
        x0, x1, y0, y1 = region_box(where, name, self.rectangles[name].size, region, self.tolerance)
        self.grids[name, 0].require(x0, x1)
        self.grids[name, 1].require(y0, y1)


# ----------------------------------------------------------------------------------------------------------------------
# What touches a box: the stretch of a line inside it, the grid lines that bound what it covers.
# ----------------------------------------------------------------------------------------------------------------------


def stretch_inside(places: Floats, across: Floats, low: Floats, high: Floats) -> tuple[Floats, Floats]:
    """Where the lines from place - across (-1) to place + across (1) enter and leave a box, for places [p, 3].

    Parameters
    ----------
    low, high : Floats [3]
        Corners of the box. A line that misses it enters after it leaves.

    Examples
    --------
    >>> places = np.array([[0.5, 0.5, 1.2], [0.5, 0.5, 1.8]])
    >>> first, last = stretch_inside(places, np.array([0.0, 0.0, 0.4]), np.zeros(3), np.ones(3))
    >>> first <= last, last.round(6)[0]
    (array([ True, False]), np.float64(-0.5))
    """
    first, last = np.full(len(places), -1.0), np.full(len(places), 1.0)
    for axis in range(3):
        ends = np.stack([low[axis] - places[:, axis], high[axis] - places[:, axis]])
        if across[axis] == 0.0:
            outside = (ends[0] > 0.0) | (ends[1] < 0.0)
            last = np.where(outside, -np.inf, last)
            continue
        shares = np.sort(ends / across[axis], axis=0)
        first, last = np.maximum(first, shares[0]), np.minimum(last, shares[1])
    return first, last


def lines_under(block: AlignedBox, plate: Rectangle, axes: Floats) -> Floats:
    """Two places [2, 2] of a plate, in its coordinates, whose grid lines bound what a block covers of it.

    Raises InputError for a plate whose sides are not parallel to the block's.
    """
    if np.abs(np.abs(axes) - np.round(np.abs(axes))).max() > PARALLEL:
        raise InputError(
            f"parts.{plate.name}",
            got=f"a plate at an angle to {block.name}, which it is joined to",
            expected="sides parallel to those of the block",
            do="turn the plate, or join it with springs",
        )
    ends = to_rectangle(plate, axes, np.stack([block.origin, np.add(block.origin, block.size)]))
    found: Floats = np.clip(ends[:, :2], 0.0, plate.size)
    return found
