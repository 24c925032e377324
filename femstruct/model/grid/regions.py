"""Regions of a plate: the grid lines they need, and quadrature points over them."""

from __future__ import annotations

import numpy as np

from femstruct.arrays import Floats
from femstruct.elements.quadrature import gauss_interval
from femstruct.errors import InputError
from femstruct.model.region import Pair, Region

Box = tuple[float, float, float, float]


def region_box(where: str, name: str, size: Pair, region: Region, tolerance: float) -> Box:
    """Bounds x0, x1, y0, y1 of a region in its part's coordinates [m], snapped to the part's edges.

    name, size : of a plate, or of a block and the face the region is on.

    Raises InputError for a region that reaches beyond the part, saying by how much, and for a line that does not run
    along the part's own axes.
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
