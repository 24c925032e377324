"""Lines of frames as straight pieces, with the rigid arms between the line and the flexible bars."""

from __future__ import annotations

from itertools import pairwise
from typing import Protocol

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import InputError
from femstruct.model.grid.layout import Segment
from femstruct.model.region import Vector


class Lines(Protocol):
    """What is said of the lines of a frame."""

    @property
    def name(self) -> str: ...
    @property
    def lines(self) -> tuple[tuple[Vector, ...], ...]: ...
    @property
    def start_offset(self) -> Vector: ...
    @property
    def end_offset(self) -> Vector: ...


def frame_segments(frame: Lines, tolerance: float) -> tuple[Segment, ...]:
    """The straight pieces of a frame's lines, moved by their rigid arms as `Frame` says.

    Raises InputError for a line of fewer than two points and for two consecutive points in one place.
    """
    segments = []
    if not frame.lines:
        raise InputError(f"parts.{frame.name}.lines", got="no lines", expected="at least one")
    for number, line in enumerate(frame.lines):
        where = f"parts.{frame.name}.lines[{number}]"
        if len(line) < 2:
            raise InputError(where, got=f"{len(line)} point", expected="at least two points")
        points = np.asarray(line, dtype=np.float64)
        offsets = _vertex_offsets(frame, points)
        tips = points + offsets
        lengths = np.minimum(*(np.linalg.norm(np.diff(ends, axis=0), axis=1) for ends in (points, tips)))
        if lengths.min() <= tolerance:
            raise InputError(where, got=f"two points {lengths.min():g} m apart", expected="a length above zero")
        for index, (start, end) in enumerate(pairwise(tips)):
            arms = offsets[index : index + 2]
            if (arms[0] != arms[1]).any():  # what an arm has along the line shortens the bar and is an end's own
                along = (points[index + 1] - points[index]) / np.linalg.norm(points[index + 1] - points[index])
                arms = arms - np.outer(arms @ along, along)
            segments.append(Segment((frame.name, number, index), start, end, arms))
    return tuple(segments)


def _vertex_offsets(frame: Lines, points: Floats) -> Floats:
    """Rigid arms at the points of a line [n, 3]: between two given ones linear in the distance along it."""
    first, last = np.asarray(frame.start_offset, dtype=np.float64), np.asarray(frame.end_offset, dtype=np.float64)
    if (first == last).all():
        return np.tile(first, (len(points), 1))
    offsets = np.zeros_like(points)
    if first.any() and last.any():
        way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
        offsets = first + np.outer(way / max(way[-1], np.finfo(float).tiny), last - first)
    offsets[0], offsets[-1] = first, last
    return offsets
