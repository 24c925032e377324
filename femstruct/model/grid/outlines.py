"""Grids over outlines of right angles with rectangular openings: lines through all corners, cells of what is inside."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.errors import InputError
from femstruct.model.grid.cell_sides import MOST_CELLS
from femstruct.model.region import Pair

Hole = tuple[Pair, Pair]
"""Sides along x and y, and the middle [m]."""
SAME = 1e-9  # of the size of an outline: coordinates nearer to each other are one


class Gridded(NamedTuple):
    """Nodes [n, 2] [m], cells [m, 4] with corners in turn about +z, and the nodes of named lines."""

    places: Floats
    cells: Integers
    lines: dict[str, Integers]


def gridded(
    where: str, outline: tuple[Pair, ...], holes: tuple[Hole, ...], through: tuple[Pair, ...], largest: float
) -> Gridded:
    """Cells with sides of at most `largest` [m] over an outline less its holes, with nodes at the places `through`.

    Lines are "rim", "side 1" (from the first corner to the second), .., "hole 1", ...

    Raises InputError for an outline without right angles along the axes or that crosses itself, for a hole that is not
    inside, and for places that are not on it.

    An L of three squares, in cells of half a side:

    >>> corners = ((0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0))
    >>> grid = gridded("parts.l", corners, (), (), 0.5)
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
