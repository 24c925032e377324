"""Where the nodes of parts are, while it is being decided: grid lines of rectangles and bars, and who needs them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import InputError, some_of
from femstruct.model.grid.geometry import Rectangle, distance_to_segments, rectangle_axes
from femstruct.model.grid.gridlines import Axis, Key, SharedLine, settle
from femstruct.model.grid.regions import region_box
from femstruct.model.imported.attached import Users
from femstruct.model.part import Body
from femstruct.model.region import Region, Vector

Grids = Mapping[Key, Floats]
"""Grid lines [n] of every side of a rectangle and every straight piece of bars, from its start [m]."""


class Box(Protocol):
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
        self.boxes: dict[str, Box] = {}
        self.bodies: dict[str, Body] = {}
        self.pulled: set[str] = set()
        self.stretched: frozenset[str] = frozenset()
        self.given: set[str] = set()
        self.taken: Users = ()
        self.covering: dict[str, float] = {}
        self.loaded: list[tuple[str, Floats]] = []
        self.grids: dict[Key, Axis] = {}
        self.shared: list[SharedLine] = []
        self.tied: list[tuple[Key, float, float]] = []

    def add_rectangle(self, part: Rectangle, largest: tuple[float, float]) -> None:
        """A part that is a grid of cells with sides of at most these lengths [m]."""
        self.rectangles[part.name] = part
        self.axes_of[part.name] = rectangle_axes(part)
        for direction in (0, 1):
            self.grids[part.name, direction] = Axis(part.size[direction], largest[direction], self.tolerance)

    def add_bars(self, name: str, vertices: Floats, segments: tuple[Segment, ...], largest: float) -> None:
        """A part of bars of at most this length [m] along straight pieces, with nodes at its own points."""
        self.segments[name], self.vertices[name] = segments, vertices
        for segment in segments:
            length = float(np.linalg.norm(segment.end - segment.start))
            self.grids[segment.key] = Axis(length, largest, self.tolerance)
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
        """Nodes of bars at a place, on every piece that passes through it; own : but where these are those of a plate,
        too."""
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
            known = some_of(self.rectangles) or "there is none"
            raise InputError(where, got=f"'{name}'", expected=f"a plate: {known}")
        x0, x1, y0, y1 = region_box(where, name, self.rectangles[name].size, region, self.tolerance)
        self.grids[name, 0].require(x0, x1)
        self.grids[name, 1].require(y0, y1)
