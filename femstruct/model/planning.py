"""Where nodes are needed: grid lines from joints, regions, supports, and points that carry something."""

from __future__ import annotations

from math import inf

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import InputError, some_of
from femstruct.model.extent import extent
from femstruct.model.geometry import (
    clip,
    distance_to_rectangle,
    distance_to_segments,
    meeting_line,
    plate_axes,
    to_plate,
)
from femstruct.model.gridlines import Axis, Key, SharedLine, Track, settle
from femstruct.model.layers import layer_of
from femstruct.model.parts import Block, Foundation, Frame, Joint, Mass, PlaceOn, Plate, Region, Spring, Structure
from femstruct.model.regions import region_box
from femstruct.model.segments import Segment, frame_segments
from femstruct.model.touching import lines_under, stretch_inside

RELATIVE_TOLERANCE = 1e-6
"""Places closer than this share of the structure's extent are one place."""
MOST_DIVISIONS = 2000
MOST_CELLS = 300_000  # of a plate: 1.6 million of them were killed by a machine of some gigabytes
"""Of a side of a plate."""
MOST_BARS = 100_000
"""Of a frame; more of either is a slip of a unit, and does not fit into memory."""


class Plan:
    """The grids of a structure while they are being decided; `settled` gives the result."""

    def __init__(self, structure: Structure) -> None:
        self.structure = structure
        self.plates = {part.name: part for part in structure.parts if isinstance(part, Plate)}
        self.frames = {part.name: part for part in structure.parts if isinstance(part, Frame)}
        self.blocks = {part.name: part for part in structure.parts if isinstance(part, Block)}
        self.axes_of = {name: plate_axes(plate) for name, plate in self.plates.items()}
        self.tolerance = RELATIVE_TOLERANCE * extent(structure)
        self.segments = {name: frame_segments(frame, self.tolerance) for name, frame in self.frames.items()}
        self.grids: dict[Key, Axis] = {}
        self.shared: list[SharedLine] = []
        for name, plate in self.plates.items():
            for direction in (0, 1):
                self.grids[name, direction] = Axis(plate.size[direction], _plate_size(plate, direction), self.tolerance)
            _refuse_many_cells(plate)
        for name, frame in self.frames.items():
            size = frame.mesh if frame.mesh is not None else inf
            if not size > 0:
                raise InputError(f"parts.{name}.mesh", got=f"{size:g} m", expected="a positive length")
            lengths = [float(np.linalg.norm(segment.end - segment.start)) for segment in self.segments[name]]
            if sum(lengths) > MOST_BARS * size:
                raise InputError(
                    f"parts.{name}.mesh",
                    got=f"{size:g} m, {sum(lengths) / size:.3g} bars",
                    expected=f"at most {MOST_BARS} bars",
                    do=f"use {sum(lengths) / MOST_BARS:.2g} m or more",
                )
            for segment, length in zip(self.segments[name], lengths, strict=True):
                self.grids[segment.key] = Axis(length, size, self.tolerance)
            self._own_vertices(name)
        self._regions()
        self._carrying_points()
        for joint in structure.joints:
            self._joint(joint)

    def settled(self) -> dict[Key, Floats]:
        """Grids of all plate sides and frame segments."""
        return settle(self.grids, self.shared)

    def require_on_plate(self, name: str, local: Floats) -> None:
        """A node of a plate at a place in its own coordinates."""
        for direction in (0, 1):
            self.grids[name, direction].require(float(local[direction]))

    def require_on_frame(self, name: str, position: Floats) -> None:
        """Nodes of a frame at a place, on every segment that passes through it."""
        for segment in self.segments[name]:
            starts, ends = np.stack([segment.feet, [segment.start, segment.end]], axis=1)
            for distance, place in zip(*distance_to_segments(position, starts, ends), strict=True):
                if distance <= self.tolerance:
                    self.grids[segment.key].require(float(place) * self.grids[segment.key].length)

    def _own_vertices(self, name: str) -> None:
        for line in self.frames[name].lines:
            for vertex in np.asarray(line, dtype=np.float64):
                self.require_on_frame(name, vertex)

    def _regions(self) -> None:
        for part in self.structure.parts:
            if isinstance(part, Foundation):
                self._layer(part)
            elif isinstance(part, Mass) and part.on is not None and part.on not in self.frames:
                self._region(f"parts.{part.name}.region", part.on, part.region or Region("whole"))
        for surface in self.structure.surfaces:
            self._region(f"surfaces.{surface.name}.region", surface.on, surface.region)
        for support in self.structure.supports:
            if support.line is not None:
                region = Region("line", line=support.line)
                self._region(f"supports.{support.name}.line", support.on or "", region)

    def _region(self, where: str, name: str, region: Region) -> None:
        if name not in self.plates:
            raise InputError(where, got=f"'{name}'", expected=f"a plate: {some_of(self.plates) or 'there is none'}")
        x0, x1, y0, y1 = region_box(where, name, self.plates[name].size, region, self.tolerance)
        self.grids[name, 0].require(x0, x1)
        self.grids[name, 1].require(y0, y1)

    def _layer(self, part: Foundation) -> None:
        layer = layer_of(part, {**self.plates, **self.blocks}, self.tolerance)
        for name in (part.on, part.to):
            if name in self.plates:
                for corner in to_plate(self.plates[name], self.axes_of[name], layer.corners):
                    self.require_on_plate(name, np.clip(corner[:2], 0.0, self.plates[name].size))

    def _carrying_points(self) -> None:
        """Springs, masses and supports hold a node; a point that is only hit or heard does not."""
        used = {part.at for part in self.structure.parts if isinstance(part, Mass)}
        used |= {support.at for support in self.structure.supports}
        used |= {end for part in self.structure.parts if isinstance(part, Spring) for end in (part.a, part.b)}
        for point in self.structure.points:
            numbered = {f"{point.name}.{number + 1}" for number in range(len(point.at))}
            for number, place in enumerate(point.at):
                if point.name in used or (f"{point.name}.{number + 1}" in used & numbered):
                    self._carrying_place(point, np.asarray(place, dtype=np.float64))

    def _carrying_place(self, point: PlaceOn, place: Floats) -> None:
        if point.on in self.plates:
            self.require_on_plate(point.on, np.clip(place[:2], 0.0, self.plates[point.on].size))
        elif point.on in self.frames:
            self.require_on_frame(point.on, place)

    def _joint(self, joint: Joint) -> None:
        for end in (joint.a, joint.b):
            if end not in self.plates and end not in self.frames and end not in self.blocks:
                expected = "the name of a plate, a frame or a block"
                raise InputError(f"joints.{joint.name}", got=f"'{end}'", expected=expected)
        if joint.a == joint.b:
            raise InputError(f"joints.{joint.name}", got=f"'{joint.a}' twice", expected="two parts")
        if joint.a in self.blocks or joint.b in self.blocks:
            self._on_block(*((joint.b, joint.a) if joint.a in self.blocks else (joint.a, joint.b)))
        elif joint.a in self.plates and joint.b in self.plates:
            self._plate_on_plate(joint.a, joint.b)
        elif joint.a in self.frames and joint.b in self.frames:
            self._frame_on_frame(joint)
        elif joint.a in self.frames:
            self._frame_on_plate(joint, joint.a, joint.b)
        else:
            self._frame_on_plate(joint, joint.b, joint.a)

    def _plate_on_plate(self, first: str, second: str) -> None:
        start, end = meeting_line(self.plates[first], self.plates[second], self.tolerance)
        tracks = []
        for name in (first, second):
            ends = to_plate(self.plates[name], self.axes_of[name], np.stack([start, end]))
            self.require_on_plate(name, ends[0])
            self.require_on_plate(name, ends[1])
            direction = int(np.argmax(np.abs(ends[1] - ends[0])))
            tracks.append(Track((name, direction), float(ends[0, direction]), float(ends[1, direction])))
        if np.linalg.norm(end - start) > self.tolerance:
            self.shared += [SharedLine(tracks[0], tracks[1]), SharedLine(tracks[1], tracks[0])]

    def _frame_on_frame(self, joint: Joint) -> None:
        nearest = inf
        for one, other in ((joint.a, joint.b), (joint.b, joint.a)):
            starts, ends = np.stack([segment.feet for segment in self.segments[other]], axis=1)
            for vertex in np.concatenate([np.asarray(line, dtype=np.float64) for line in self.frames[one].lines]):
                nearest = min(nearest, float(distance_to_segments(vertex, starts, ends)[0].min()))
                self.require_on_frame(other, vertex)
        self._refuse_apart(joint, nearest)

    def _frame_on_plate(self, joint: Joint, frame: str, plate: str) -> None:
        size, tolerance = self.plates[plate].size, self.tolerance
        vertices = np.concatenate([np.asarray(line, dtype=np.float64) for line in self.frames[frame].lines])
        local = to_plate(self.plates[plate], self.axes_of[plate], vertices)
        distances = distance_to_rectangle(local, size)
        for vertex in local[distances <= tolerance]:
            self.require_on_plate(plate, np.clip(vertex[:2], 0.0, size))
        touching = bool((distances <= tolerance).any())
        for segment in self.segments[frame]:
            touching |= self._segment_on_plate(segment, plate)
        if not touching:
            self._refuse_apart(joint, float(distances.min()))

    def _segment_on_plate(self, segment: Segment, plate: str) -> bool:
        size, tolerance = self.plates[plate].size, self.tolerance
        ends = to_plate(self.plates[plate], self.axes_of[plate], segment.feet)
        heights = ends[:, 2]
        axis = self.grids[segment.key]
        if np.abs(heights).max() > tolerance:
            if heights[0] * heights[1] > 0:
                return False
            share = heights[0] / (heights[0] - heights[1])
            place = ends[0] + share * (ends[1] - ends[0])
            if distance_to_rectangle(place, size) > tolerance:
                return False
            self.require_on_plate(plate, np.clip(place[:2], 0.0, size))
            axis.require(float(share) * axis.length)
            return True
        stretch = clip(ends[0], ends[1], size, tolerance)
        if stretch is None:
            return False
        inside = [float(np.clip(share, 0.0, 1.0)) for share in stretch]
        places = [np.clip(ends[0] + share * (ends[1] - ends[0]), 0.0, [*size, inf]) for share in inside]
        for share, place in zip(inside, places, strict=True):
            axis.require(share * axis.length)
            self.require_on_plate(plate, place)
        own = Track(segment.key, inside[0] * axis.length, inside[1] * axis.length)
        if own.end - own.start > tolerance:
            self._share(own, plate, places[0], places[1])
        return True

    def _share(self, own: Track, plate: str, start: Floats, end: Floats) -> None:
        """A frame line in a plate takes the plate's nodes; an oblique one gives it crossings at its own."""
        along = np.abs(end - start)[:2] > self.tolerance
        for direction in np.flatnonzero(along):
            track = Track((plate, int(direction)), float(start[direction]), float(end[direction]))
            if along.all():
                self.shared.append(SharedLine(own, track))
            else:
                self.grids[own.key].given.append((own.start, own.end))
                self.shared += [SharedLine(track, own), SharedLine(own, track)]

    def _on_block(self, name: str, block: str) -> None:
        """Nodes of a plate or frame where it enters and leaves a block."""
        solid = self.blocks[block]
        if name in self.plates:
            for place in lines_under(solid, self.plates[name], self.axes_of[name]):
                self.require_on_plate(name, place)
        low = np.asarray(solid.origin)
        for segment in self.segments.get(name, ()):
            middle, half = segment.feet.mean(axis=0), np.diff(segment.feet, axis=0)[0] / 2.0
            first, last = stretch_inside(middle[None], half, low - self.tolerance, low + solid.size + self.tolerance)
            if first[0] <= last[0]:
                length = self.grids[segment.key].length
                self.grids[segment.key].require(*((1.0 + share) / 2.0 * length for share in (first[0], last[0])))

    def _refuse_apart(self, joint: Joint, distance: float) -> None:
        if distance > self.tolerance:
            raise InputError(
                f"joints.{joint.name}",
                got=f"{joint.a} and {joint.b} {distance:.4g} m apart",
                expected="parts that touch: an end or a line of a frame on the mid-surface of a plate or on a frame",
                do="move one of them",
            )


def _refuse_many_cells(plate: Plate) -> None:
    """A mesh that fills the memory of most machines is stopped here: there, the system kills it without a word."""
    cells = 1.0
    for direction in (0, 1):
        cells *= plate.size[direction] / _plate_size(plate, direction)
    if cells > MOST_CELLS * (1.0 + 1e-9):
        side = (plate.size[0] * plate.size[1] / MOST_CELLS) ** 0.5
        raise InputError(
            f"parts.{plate.name}.mesh",
            got=f"{cells:.3g} cells",
            expected=f"at most {MOST_CELLS}",
            do=f"use cells of {side:.2g} m or more",
        )


def _plate_size(plate: Plate, direction: int) -> float:
    where = f"parts.{plate.name}.mesh"
    side, mesh = plate.size[direction], plate.mesh
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
