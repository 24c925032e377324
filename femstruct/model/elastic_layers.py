"""Where an elastic layer lies: between the facing sides of two parts, or under one of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from femstruct.arrays import Floats, freeze, frozen
from femstruct.errors import InputError, list_some
from femstruct.model.imported_mesh import faces_towards, outwards
from femstruct.model.part import FilledBox
from femstruct.model.regions import PARALLEL, Box, Region, Touched, region_box


@dataclass(frozen=True, eq=False)
class LayerPlane:
    """The plane that a layer acts in, the part of it that is filled: its middle, or the face that is on the ground.

    origin [3] : global place of the coordinates (0, 0) [m]. axes [3, 3] : rows are its two directions and its
    normal, all axes of the first part. box : x0, x1, y0, y1 of the region along them [m].
    """

    origin: Floats
    axes: Floats
    box: Box

    def __post_init__(self) -> None:
        freeze(self, origin=frozen("Layer origin", self.origin, (3,)), axes=frozen("Layer axes", self.axes, (3, 3)))

    def places(self, local: Floats) -> Floats:
        """Global places [p, 3] of places of the layer [p, 2]."""
        found: Floats = self.origin + local @ self.axes[:2]
        return found

    @property
    def corners(self) -> Floats:
        """Global places of two opposite corners of the region [2, 3]."""
        return self.places(np.reshape(self.box, (2, 2)).T)


class Filling(Protocol):
    """What a layer is said to fill: the region of a part, or of the gap to another."""

    @property
    def name(self) -> str: ...
    @property
    def on(self) -> str: ...
    @property
    def to(self) -> str | None: ...
    @property
    def region(self) -> Region: ...
    @property
    def side(self) -> Touched: ...


def layer_of(part: Filling, bodies: Mapping[str, FilledBox], tolerance: float) -> LayerPlane:
    """The layer a foundation fills.

    Parameters
    ----------
    bodies : Mapping[str, FilledBox]
        Of plates, slabs and blocks by name.

    Raises
    ------
    InputError
        For parts that do not exist, are not parallel, do not face or reach into each other, and for a region that is
        not on both.
    """
    where = f"parts.{part.name}"
    key = "on" if part.to is None else "between"
    for name in (part.on, part.to):
        if name is not None and name not in bodies:
            known = list_some(bodies) or "there is none"
            raise InputError(f"{where}.{key}", got=f"'{name}'", expected=f"a plate, slab or block: {known}")
    body = bodies[part.on]
    if part.to is None:
        size = (float(body.size[0]), float(body.size[1]))
        box = region_box(f"{where}.region", part.on, size, part.region, tolerance)
        return LayerPlane(_on_ground(f"{where}.side", part, body), body.axes, box)
    if part.on == part.to:
        raise InputError(f"{where}.between", got=f"'{part.on}' twice", expected="two parts")
    return _between(part, (part.on, body), (part.to, bodies[part.to]), tolerance)


def _on_ground(where: str, part: Filling, body: FilledBox) -> Floats:
    """The corner [3] of the face that the ground is on: the lower one, or that of a plate or slab which is named; or of
    the middle between its faces."""
    if body.across is None:
        if part.side != "below":
            raise InputError(where, got=f"'{part.side}' of a block", expected="below: it stands on its lower face")
        return body.corner
    normal = body.axes[body.across]
    if part.side == "middle":
        return np.asarray(body.corner + body.size[body.across] / 2.0 * normal)
    if not faces_towards(normal, part.side):
        got, expected = f"'{part.side}', which {part.on} does not face", "a side within 45 degrees of that"
        raise InputError(where, got=got, expected=expected)
    reached = float(body.size[body.across]) if outwards(normal, part.side) @ normal > 0.0 else 0.0
    return np.asarray(body.corner + reached * normal)


def _between(part: Filling, one: tuple[str, FilledBox], other: tuple[str, FilledBox], tolerance: float) -> LayerPlane:
    where = f"parts.{part.name}.between"
    (first, body), (second, _) = one, other
    corner, axes, size, own = body
    low, high, across = _seen_from(where, one, other)
    apart = np.maximum(low - size, -high)
    overlap = np.minimum(high, size) - np.maximum(low, 0.0)
    facing = [
        axis
        for axis in (range(3) if own is None else [own])
        if across in (None, axis) and np.delete(overlap, axis).min() > tolerance
    ]
    if not facing:
        raise InputError(
            where,
            got=f"{first} and {second}, which do not face each other",
            expected="parts with sides opposite each other",
            do="move one of them",
        )
    axis = max(facing, key=lambda one: float(apart[one]))
    if apart[axis] < -tolerance:
        raise InputError(
            where,
            got=f"{second} reaching {-apart[axis]:.4g} m into {first}",
            expected="a gap for the layer, or faces that touch",
            do="move one of them (the origin of a plate is on its mid-surface, half its thickness below its face)",
        )
    after = low[axis] + high[axis] > size[axis]
    middle = (size[axis] + low[axis]) / 2.0 if after else high[axis] / 2.0
    along = np.delete(np.arange(3), axis)
    sides = (float(size[along[0]]), float(size[along[1]]))
    shared = (np.maximum(low, 0.0)[along], np.minimum(high, size)[along])
    region = f"parts.{part.name}.region"
    box = region_box(region, first, sides, part.region, tolerance)
    if part.region.kind == "whole":
        box = (float(shared[0][0]), float(shared[1][0]), float(shared[0][1]), float(shared[1][1]))
    beyond = max(*(shared[0] - np.asarray(box)[[0, 2]]), *(np.asarray(box)[[1, 3]] - shared[1]))
    if beyond > tolerance:
        raise InputError(
            region,
            got=f"a region that reaches {beyond:.4g} m beyond {second}",
            expected=f"a region of {first} that faces {second}",
        )
    return LayerPlane(corner + middle * axes[axis], axes[[*along, axis]], box)


def _seen_from(
    where: str, one: tuple[str, FilledBox], other: tuple[str, FilledBox]
) -> tuple[Floats, Floats, int | None]:
    """Lower and upper corner [3] of the second part along the first's axes from its corner [m].

    Also the one of these axes that the sides of the second part face along, None for a block, whose sides face along
    all.
    """
    (first, (corner, axes, _, _)), (second, (start, others, size, faces)) = one, other
    turn = others @ axes.T
    if np.abs(np.abs(turn) - np.round(np.abs(turn))).max() > PARALLEL:
        raise InputError(
            where,
            got=f"{first} and {second} with sides at an angle",
            expected="parts with parallel sides",
            do="turn one of them",
        )
    turn = np.round(turn)
    start = (start - corner) @ axes.T
    end = start + size @ turn
    across = None if faces is None else int(np.argmax(np.abs(turn[faces])))
    return np.minimum(start, end), np.maximum(start, end), across
