"""Where an elastic layer lies: between the facing sides of two parts, or under one of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from femstruct.arrays import Floats, freeze, frozen
from femstruct.errors import InputError, some_of
from femstruct.model.geometry import PARALLEL, plate_axes
from femstruct.model.parts import Block, Foundation, Plate
from femstruct.model.regions import Box, region_box

Solid = Plate | Block
_ACROSS = 2  # the axis of a plate that its sides face along


@dataclass(frozen=True, eq=False)
class Layer:
    """The plane in the middle of a layer, and the part of it that is filled.

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


def layer_of(part: Foundation, solids: Mapping[str, Solid], tolerance: float) -> Layer:
    """The layer a foundation fills; solids : plates and blocks by name.

    Raises InputError for parts that do not exist, are not parallel, do not face or reach into each other, and for a
    region that is not on both.
    """
    where = f"parts.{part.name}"
    key = "on" if part.to is None else "between"
    for name in (part.on, part.to):
        if name is not None and name not in solids:
            known = some_of(solids) or "there is none"
            raise InputError(f"{where}.{key}", got=f"'{name}'", expected=f"a plate or a block: {known}")
    solid = solids[part.on]
    if part.to is None:
        # A block stands on its lower face; a plate is held at its mid-surface.
        size = (solid.size[0], solid.size[1])
        axes = plate_axes(solid) if isinstance(solid, Plate) else np.eye(3)
        box = region_box(f"{where}.region", part.on, size, part.region, tolerance)
        return Layer(np.asarray(solid.origin, dtype=np.float64), axes, box)
    return _between(part, solid, solids[part.to], tolerance)


def _between(part: Foundation, first: Solid, second: Solid, tolerance: float) -> Layer:
    where = f"parts.{part.name}.between"
    if first.name == second.name:
        raise InputError(where, got=f"'{first.name}' twice", expected="two parts")
    corner, axes, size = body_box(first)
    low, high, across = _seen_from(where, first, second)
    apart = np.maximum(low - size, -high)
    overlap = np.minimum(high, size) - np.maximum(low, 0.0)
    facing = [
        axis
        for axis in ([_ACROSS] if isinstance(first, Plate) else range(3))
        if across in (None, axis) and np.delete(overlap, axis).min() > tolerance
    ]
    if not facing:
        raise InputError(
            where,
            got=f"{first.name} and {second.name}, which do not face each other",
            expected="parts with sides opposite each other",
            do="move one of them",
        )
    axis = max(facing, key=lambda one: float(apart[one]))
    if apart[axis] < -tolerance:
        raise InputError(
            where,
            got=f"{second.name} reaching {-apart[axis]:.4g} m into {first.name}",
            expected="a gap for the layer, or faces that touch",
            do="move one of them (the origin of a plate is on its mid-surface, half its thickness below its face)",
        )
    after = low[axis] + high[axis] > size[axis]
    middle = (size[axis] + low[axis]) / 2.0 if after else high[axis] / 2.0
    along = np.delete(np.arange(3), axis)
    sides = (float(size[along[0]]), float(size[along[1]]))
    shared = (np.maximum(low, 0.0)[along], np.minimum(high, size)[along])
    region = f"parts.{part.name}.region"
    box = region_box(region, first.name, sides, part.region, tolerance)
    if part.region.kind == "whole":
        box = (float(shared[0][0]), float(shared[1][0]), float(shared[0][1]), float(shared[1][1]))
    beyond = max(*(shared[0] - np.asarray(box)[[0, 2]]), *(np.asarray(box)[[1, 3]] - shared[1]))
    if beyond > tolerance:
        raise InputError(
            region,
            got=f"a region that reaches {beyond:.4g} m beyond {second.name}",
            expected=f"a region of {first.name} that faces {second.name}",
        )
    return Layer(corner + middle * axes[axis], axes[[*along, axis]], box)


def body_box(solid: Solid) -> tuple[Floats, Floats, Floats]:
    """Corner [3], axes [3, 3] and size [3] of the box that a plate or a block fills."""
    origin = np.asarray(solid.origin, dtype=np.float64)
    if isinstance(solid, Block):
        return origin, np.eye(3), np.asarray(solid.size, dtype=np.float64)
    axes = plate_axes(solid)
    return origin - solid.thickness / 2.0 * axes[2], axes, np.array([*solid.size, solid.thickness])


def _seen_from(where: str, first: Solid, second: Solid) -> tuple[Floats, Floats, int | None]:
    """Lower and upper corner [3] of the second part along the first's axes from its corner [m].

    Also the one of these axes that the sides of the second part face along, None for a block, whose sides face along
    all.
    """
    corner, axes, _ = body_box(first)
    other, others, size = body_box(second)
    turn = others @ axes.T
    if np.abs(np.abs(turn) - np.round(np.abs(turn))).max() > PARALLEL:
        raise InputError(
            where,
            got=f"{first.name} and {second.name} with sides at an angle",
            expected="parts with parallel sides",
            do="turn one of them",
        )
    turn = np.round(turn)
    start = (other - corner) @ axes.T
    end = start + size @ turn
    across = int(np.argmax(np.abs(turn[_ACROSS]))) if isinstance(second, Plate) else None
    return np.minimum(start, end), np.maximum(start, end), across
