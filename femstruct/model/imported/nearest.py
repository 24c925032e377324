"""The places of flat cells that are nearest to places in space, and how crosses around some of them turn."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.conventions import N_COMPONENTS
from femstruct.model.imported.flat_cells import FlatCells
from femstruct.model.imported.shell_cells import mapped, rows_at

OFF: Final = 1e-6  # of the reach of a patch: what is farther from the cells is not on them
_NEWTON: Final = 20  # steps to the place in a quadrilateral; four are enough in one that is not nearly a triangle
_AT_ONCE: Final = 2_000_000  # pairs of places and cells whose distance is looked at together: 50 MB


class Nearest(NamedTuple):
    """Places of cells that are nearest to others: cells [p], xi and eta there [p] [1], where they are [p, 3] [m]."""

    cells: Integers
    xi: Floats
    eta: Floats
    positions: Floats


def nearest_places(cells: FlatCells, at: Floats) -> Nearest:
    """The places of the cells nearest to places in space [p, 3]; of warped quadrilaterals on their two triangles.

    Only those cells are looked at whose spheres can be as near as the nearest.

    >>> square = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
    >>> from femstruct.model.imported.flat_cells import flat_cells
    >>> from femstruct.model.imported.imported_mesh import ImportedMesh
    >>> cells = {"quad4": np.array([[0, 1, 2, 3]])}
    >>> mesh = ImportedMesh("plate", square, np.arange(4), cells, {"quad4": np.array([1])})
    >>> nearest_places(flat_cells(mesh, None), np.array([[0.5, 0.5, 3.0], [9.0, 0.5, 0.0]])).positions.tolist()
    [[0.5, 0.5, 0.0], [2.0, 0.5, 0.0]]
    """
    places = np.asarray(at, dtype=np.float64).reshape(-1, 3)
    corners = cells.points[cells.corners]
    middles = corners.mean(axis=1)
    radii = np.sqrt(((corners - middles[:, None]) ** 2).sum(axis=2).max(axis=1))
    chunk = max(1, _AT_ONCE // len(middles))
    found = [_of_some(cells, places[k : k + chunk], middles, radii) for k in range(0, max(len(places), 1), chunk)]
    which, feet = (np.concatenate(pair) for pair in zip(*found, strict=True))
    xi, eta = _inside(cells, which, feet)
    return Nearest(which, xi, eta, mapped(cells, which, xi, eta)[0])


def cross_turning(cells: FlatCells, centers: Floats, reach: float, axes: Floats) -> tuple[Integers, Floats]:
    """Rotation about the normal of patches that reach so far [m] around places [m, 3] of flat cells.

    axes [3, 3] : two directions in the cells, and the normal. The ends of a cross, as far as they lie on the cells, and
    its middle move as the cells do; the rotation is that of the rigid motion that fits them best.

    Returns nodes [m, 20] and rows [m, 1, 20, 7].
    """
    arms = reach * np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    ends = centers[:, None] + arms @ axes[:2]
    found = nearest_places(cells, ends.reshape(-1, 3))
    places = found.positions.reshape(ends.shape)
    on_it = np.linalg.norm(places - ends, axis=2) <= OFF * reach
    middles = (places * on_it[..., None]).sum(axis=1) / on_it.sum(axis=1)[:, None]
    off = (places - middles[:, None]) @ axes[:2].T * on_it[..., None]
    pulls = (off[..., :1] * axes[1] - off[..., 1:] * axes[0]) / (off**2).sum(axis=(1, 2))[:, None, None]
    nodes, motion = rows_at(cells, found.cells, found.xi, found.eta)
    rows = np.einsum("pi,pikc->pkc", pulls.reshape(-1, 3), motion[:, :3])
    return nodes.reshape(-1, 20), rows.reshape(-1, 1, 20, N_COMPONENTS)


def _of_some(cells: FlatCells, at: Floats, middles: Floats, radii: Floats) -> tuple[Integers, Floats]:
    """Nearest cells [p] and the places there [p, 3]."""
    away = np.linalg.norm(middles - at[:, None], axis=2)
    place, cell = np.nonzero(away - radii <= (away + radii).min(axis=1)[:, None])
    four = cell < len(cells.quads)
    quads, triangles = cells.quads[cell[four]], cells.triangles[cell[~four] - len(cells.quads)]
    corners = cells.points[np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]], triangles])]
    place, cell = (np.concatenate([both[four], both[four], both[~four]]) for both in (place, cell))
    feet = _on_triangles(corners, at[place])
    order = np.lexsort((((feet - at[place]) ** 2).sum(axis=1), place))
    best = order[np.searchsorted(place[order], np.arange(len(at)))]
    return cell[best], feet[best]


def _on_triangles(corners: Floats, at: Floats) -> Floats:
    """The place of each triangle [n, 3, 3] nearest to a place [n, 3]: in it, or on one of its sides."""
    a, b, c = np.moveaxis(corners, 1, 0)
    normal = np.cross(b - a, c - a)
    square = np.maximum((normal**2).sum(axis=1), np.finfo(float).tiny)
    foot = at - ((at - a) * normal).sum(axis=1)[:, None] / square[:, None] * normal
    inside = np.ones(len(a), dtype=bool)
    candidates = []
    for start, end in ((a, b), (b, c), (c, a)):
        side = end - start
        inside &= (np.cross(side, foot - start) * normal).sum(axis=1) >= 0.0
        share = np.clip(((at - start) * side).sum(axis=1) / (side**2).sum(axis=1), 0.0, 1.0)
        candidates.append(start + share[:, None] * side)
    sides = np.stack(candidates, axis=1)
    nearest = np.argmin(((sides - at[:, None]) ** 2).sum(axis=2), axis=1)
    found: Floats = np.where(inside[:, None], foot, sides[np.arange(len(a)), nearest])
    return found


def _inside(cells: FlatCells, which: Integers, positions: Floats) -> tuple[Floats, Floats]:
    """xi and eta [p] of places [p, 3] in cells [p], from 0 to 1."""
    p0, p1, p2, p3 = np.moveaxis(cells.points[cells.corners[which]], 1, 0)
    four = (which < len(cells.quads))[:, None]
    along, across = np.where(four, p3 - p0, p1 - p0), np.where(four, p1 - p0, p2 - p0)
    twist = np.where(four, p0 - p1 + p2 - p3, 0.0)
    place = np.full((len(which), 2), 0.5)
    for _ in range(_NEWTON if four.any() else 1):
        x, y = place[:, :1], place[:, 1:]
        off = positions - (p0 + x * along + y * across + x * y * twist)
        slopes = np.stack([along + y * twist, across + x * twist], axis=2)
        place = np.clip(place + (np.linalg.pinv(slopes) @ off[:, :, None])[:, :, 0], 0.0, 1.0)
    return place[:, 0], place[:, 1]
