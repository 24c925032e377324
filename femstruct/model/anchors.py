"""Where things are fastened: the motion of named points, of places on plates and blocks, of regions."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from scipy.sparse import csr_array

from femstruct.arrays import Floats
from femstruct.conventions import DIRECTIONS, N_COMPONENTS
from femstruct.errors import InputError, some_of
from femstruct.model.geometry import to_plate
from femstruct.model.interpolation import block_rows, carried, plate_rows, sparse_rows
from femstruct.model.layers import Layer
from femstruct.model.model import Model, PlateMesh
from femstruct.model.parts import Region
from femstruct.model.probe import Point
from femstruct.model.regions import area_points, line_points, region_box, region_lines

ORDER = 4
"""Gauss points a direction: exact for products of two cubic deflections."""


def places_of(where: str, name: str, model: Model) -> tuple[Point, ...]:
    """The places of a named point; InputError when there is none of that name."""
    known = {point.name for point in model.structure.points} | set(model.points)
    if name not in known:
        raise InputError(where, got=f"'{name}'", expected=f"a point: {some_of(sorted(known)) or 'there is none'}")
    return model.places(name)


def plate_of(where: str, name: str, model: Model) -> PlateMesh:
    """The plate of that name; InputError when there is none."""
    if name not in model.plates:
        raise InputError(where, got=f"'{name}'", expected=f"a plate: {some_of(model.plates) or 'there is none'}")
    return model.plates[name]


def listed(where: str, directions: object) -> list[int]:
    """Numbers of the components out of x y z rx ry rz; InputError for any other."""
    if not isinstance(directions, tuple) or not set(directions) <= set(DIRECTIONS):
        raise InputError(where, got=f"{directions}", expected=f"directions out of {', '.join(DIRECTIONS)}")
    return [DIRECTIONS.index(direction) for direction in directions]


def point_rows(point: Point, arm: Floats, model: Model) -> csr_array:
    """Six rows of the motion at the end of a rigid arm from a point: u + r x arm."""
    six = len(DIRECTIONS)
    motion = np.eye(six)
    x, y, z = arm
    motion[0, 4], motion[0, 5], motion[1, 3], motion[1, 5], motion[2, 3], motion[2, 4] = z, -y, -z, x, y, -x
    columns = point.nodes * N_COMPONENTS + point.components
    weights = motion @ point.weights
    entries = (weights.ravel(), (np.repeat(np.arange(six), len(columns)), np.tile(columns, six)))
    return csr_array(entries, shape=(six, model.mesh.n_nodes * N_COMPONENTS))


def region_points(where: str, plate: PlateMesh, region: Region, tolerance: float) -> tuple[Floats, Floats]:
    """Gauss points [p, 2] of a region in the plate's coordinates [m] and their weights [p] (m^2 or m)."""
    box = region_box(where, plate.part.name, plate.part.size, region, tolerance)
    return _points(plate.x, plate.y, region, box, tolerance)


def layer_points(
    layer: Layer, region: Region, parts: tuple[str, ...], model: Model, tolerance: float
) -> tuple[Floats, Floats]:
    """Gauss points [p, 2] of a layer in its coordinates [m] and weights [p]: between the grid lines of all its parts,
    where the motions of all are polynomials."""
    grids = [_lines_across(layer, direction, parts, model, tolerance) for direction in (0, 1)]
    return _points(grids[0], grids[1], region, layer.box, tolerance)


def motion_at(name: str, places: Floats, directions: Floats, model: Model, tolerance: float) -> csr_array:
    """Rows [p * d, n_nodes * 7] of the displacements along directions [d, 3] of places [p, 3] that move with a plate or
    a block; off the mid-surface of a plate they stand on its normals."""
    if name in model.blocks:
        nodes, rows = block_rows(model.blocks[name], places)
    else:
        plate = model.plates[name]
        local = to_plate(plate.part, plate.axes, places)
        on_grid = np.stack(
            [_snapped(local[:, i], grid, tolerance) for i, grid in enumerate((plate.x, plate.y))], axis=1
        )
        nodes, rows = plate_rows(plate, on_grid)
        height = float(local[:, 2].mean())
        if abs(height) > tolerance:
            rows = carried(rows, height * plate.axes[2])
    return sparse_rows(nodes, np.einsum("ij,pjkc->pikc", directions, rows[:, :3]), model.mesh.n_nodes)


def _points(
    x: Floats, y: Floats, region: Region, box: tuple[float, float, float, float], tolerance: float
) -> tuple[Floats, Floats]:
    if region.kind in ("whole", "rectangle"):
        return area_points(x, y, box, tolerance, ORDER)
    pieces = [line_points(x, y, ends, tolerance, ORDER) for ends in region_lines(region, box)]
    return np.concatenate([points for points, _ in pieces]), np.concatenate([weights for _, weights in pieces])


def _lines_across(layer: Layer, direction: int, parts: tuple[str, ...], model: Model, tolerance: float) -> Floats:
    """Ascending coordinates of the grid lines of all plates of a layer inside its region, and of the region's ends."""
    low, high = layer.box[2 * direction : 2 * direction + 2]
    along = layer.axes[direction]
    lines = [np.array([low, high])]
    for name in parts:
        if name in model.plates:
            plate = model.plates[name]
            sign = plate.axes[:2] @ along
            grid = (plate.x, plate.y)[int(np.argmax(np.abs(sign)))]
            start = float((np.asarray(plate.part.origin) - layer.origin) @ along)
            lines.append(start + np.sign(sign[np.argmax(np.abs(sign))]) * grid)
    found = np.sort(np.concatenate(lines))
    found = found[(found >= low) & (found <= high)]
    return np.array([low, *(b for a, b in pairwise(found) if b - a > tolerance)])


def _snapped(values: Floats, grid: Floats, tolerance: float) -> Floats:
    """The values, those within the tolerance of a grid line on it."""
    index = np.clip(np.searchsorted(grid, values), 1, len(grid) - 1)
    left, right = grid[index - 1], grid[index]
    near = np.where(values - left < right - values, left, right)
    return np.where(np.abs(near - values) <= tolerance, near, values)
