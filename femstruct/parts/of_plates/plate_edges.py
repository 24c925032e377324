"""Edges of plates: the nodes that a support of one names, and what it holds of them."""

from __future__ import annotations

from typing import Literal

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.conventions import N_COMPONENTS, TWIST
from femstruct.model.grid.regions import line_points, region_box, region_lines
from femstruct.model.region import Pair, Region
from femstruct.model.structure import SIMPLE, Support

STEEP = float(np.cos(np.radians(45.0)))  # of the normal to the vertical: from there on a plate stands
ORDER = 4  # Gauss points a side of a cell
Axis = Literal[0, 1]


def edge_nodes(
    item: Support, plate: str, size: Pair, lines: tuple[Floats, Floats], grid: Integers, tolerance: float
) -> list[tuple[Integers, Axis]]:
    """Nodes of each edge or line that a support names, in their order, and which of the plate's axes it is along.

    plate : name of the plate. size : its sides [m]. lines : its grid along x and y [m]. grid [nx + 1, ny + 1] : numbers
    of its nodes. Raises InputError for a line that is not on the plate.
    """
    if item.line is not None:
        region = Region("line", line=item.line)
        x0, x1, y0, y1 = region_box(f"supports.{item.name}.line", plate, size, region, tolerance)
        in_x = np.flatnonzero((lines[0] >= x0 - tolerance) & (lines[0] <= x1 + tolerance))
        in_y = np.flatnonzero((lines[1] >= y0 - tolerance) & (lines[1] <= y1 + tolerance))
        return [(grid[np.ix_(in_x, in_y)].ravel(), 0 if len(in_x) > 1 else 1)]
    sides: dict[str, tuple[Integers, Axis]] = {
        "x0": (grid[0], 1),
        "x1": (grid[-1], 1),
        "y0": (grid[:, 0], 0),
        "y1": (grid[:, -1], 0),
    }
    return list(sides.values()) if item.edge == "all" else [sides[str(item.edge)]]


def edge_gauss(
    item: Support, plate: str, size: Pair, lines: tuple[Floats, Floats], tolerance: float
) -> tuple[Floats, Floats, Integers]:
    """Gauss points along the edges or the line that a support names: places [p, 2] [m], weights [p] [m], and which of
    the plate's axes each of them is along [p]. Exact for products of two cubic deflections."""
    x, y = size
    sides = {
        "x0": ((0.0, 0.0), (0.0, y)),
        "x1": ((x, 0.0), (x, y)),
        "y0": ((0.0, 0.0), (x, 0.0)),
        "y1": ((0.0, y), (x, y)),
    }
    if item.line is not None:
        region = Region("line", line=item.line)
        ends = region_lines(region, region_box(f"supports.{item.name}.line", plate, size, region, tolerance))
    else:
        ends = list(sides.values()) if item.edge == "all" else [sides[str(item.edge)]]
    found = [line_points(*lines, one, tolerance, ORDER) for one in ends]
    axis = [0 if abs(b[0] - a[0]) > abs(b[1] - a[1]) else 1 for a, b in ends]
    places, weights = (np.concatenate(part) for part in zip(*found, strict=True))
    return places, weights, np.repeat(axis, [len(one[1]) for one in found])


def edge_components(fix: object, axes: Floats, along: Axis, rigid_in_plane: bool) -> Floats:
    """Components [m, 7] that simple (hard, as thin plates are), roller or clamped holds of the nodes of an edge along
    an axis of a plate.

    All but `clamped` hold the deflection and the slope along the edge: w_x = -RY where it is parallel to x, w_y = RX
    where to y. `simple` carries, in addition, a plate that stands; one that is rigid in its plane it holds.

    axes [3, 3] : rows are the plate's x, y and normal.
    """
    clamped = np.zeros((7, N_COMPONENTS))
    clamped[:3, :3] = clamped[3:6, 3:6] = axes
    clamped[6, TWIST] = 1.0
    if fix == "clamped":
        return clamped
    in_plane = clamped[:0]
    if fix in SIMPLE:
        in_plane = clamped[:2] if rigid_in_plane else _carried(axes)
    return np.concatenate([in_plane, clamped[[2, 4 if along == 0 else 3]]])


def _carried(axes: Floats) -> Floats:
    """The direction in its plane nearest to the vertical, of a plate that stands, as components [1, 7]; none of one
    that lies."""
    up = np.eye(3)[2] - axes[2, 2] * axes[2]
    rows = np.zeros((int(abs(axes[2, 2]) < STEEP - 1e-12), N_COMPONENTS))
    rows[:, :3] = up / (np.linalg.norm(up) or 1.0)
    return rows
