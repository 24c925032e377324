"""Which way surfaces of imported meshes face, and the rectangle round them."""

from __future__ import annotations

from typing import Final

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.model.region import Facing

STEEP: Final = float(np.cos(np.radians(45.0)))  # from there on neither side is above or below
LEVEL: Final = 1e-9  # sine of the angle to the horizontal
STRAIGHT: Final = 1e-9  # sine of the angle between two edges of one straight line


def outwards(normal: Floats, side: Facing) -> Floats:
    """Unit normal out of the named side: above is up along global z; where neither side is up, that of the cells' own
    normals; x, -x, y and -y is the side that faces that way."""
    length = float(np.linalg.norm(normal))
    unit = normal / length if length > 0 else np.array([0.0, 0.0, 1.0])
    if side not in ("above", "below"):
        return np.asarray(unit * np.sign(unit @ towards(side)))
    up = 1.0 if unit[2] > 0 or abs(unit[2]) < STEEP - 1e-12 else -1.0
    return np.asarray(unit * (up if side == "above" else -up))


def towards(side: Facing) -> Floats:
    """The global direction [3] of a side that is named by one.

    >>> towards("-y").tolist()
    [0.0, -1.0, 0.0]
    """
    direction = np.zeros(3)
    direction["xyz".index(side[-1])] = -1.0 if side.startswith("-") else 1.0
    return direction


def faces_towards(normal: Floats, side: Facing) -> bool:
    """Whether a side of something with that normal is within 45 degrees of the direction that names it; always, of
    above and below."""
    length = float(np.linalg.norm(normal))
    return side in ("above", "below") or abs(float(normal @ towards(side))) >= STEEP * length - 1e-12


def frame_across(normal: Floats, places: Floats) -> tuple[Floats, Floats]:
    """Two directions [2, 3] across a normal, and the corners [4, 3] of the rectangle along them round places."""
    x = np.eye(3)[0] if abs(normal[0]) < STEEP else np.eye(3)[1]
    x = x - (x @ normal) * normal
    x /= np.linalg.norm(x)
    along = np.stack([x, np.cross(normal, x)])
    return along, rectangle_round(along, places)


def upwards(normal: Floats) -> Floats:
    """The normal, or its opposite, so that it does not point down: x and y under a surface are those above it."""
    return normal if normal[2] >= -LEVEL * float(np.linalg.norm(normal)) else -normal


def rectangle_round(along: Floats, places: Floats) -> Floats:
    """Corners [4, 3] of the rectangle along two directions [2, 3] round places [n, 3] [m]."""
    flat = (places - places.mean(axis=0)) @ along.T
    low, high = flat.min(axis=0), flat.max(axis=0)
    corners = np.array([[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]])
    return np.asarray(places.mean(axis=0) + corners @ along)


def outer_line(points: Floats, cells: Integers) -> Floats | None:
    """Corners [n, 3] in turn of the longest closed line round cells [m, 4] [m]; None where there is none, as round a
    closed surface, or where lines touch.

    points [.., 3] : of the nodes. Triangles have their last corner twice.

    >>> grid = np.array([[x, y, 0.0] for x in (0, 1, 2) for y in (0, 1, 2)])
    >>> cells = np.array([[0, 3, 4, 1], [3, 6, 7, 4], [1, 4, 5, 2]])  # an L
    >>> outer_line(grid, cells)[:, :2].tolist()
    [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]
    """
    edges = np.stack([cells, np.roll(cells, -1, axis=1)], axis=-1).reshape(-1, 2)
    edges = edges[edges[:, 0] != edges[:, 1]]
    _, place, times = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True, return_counts=True)
    open_edges = edges[times[place.ravel()] == 1]
    ahead = dict(open_edges.tolist())
    if not len(ahead) or len(ahead) < len(open_edges) or set(ahead) != set(ahead.values()):
        return None
    loops, left = [], dict(ahead)
    while left:
        start, node = next(iter(left.items()))
        loop = [start]
        del left[start]
        while node != start:
            loop.append(node)
            node = left.pop(node)
        loops.append(points[loop])
    line = max(loops, key=lambda loop: float(np.linalg.norm(np.roll(loop, -1, axis=0) - loop, axis=1).sum()))
    steps = np.roll(line, -1, axis=0) - line
    turn = np.linalg.norm(np.cross(np.roll(steps, 1, axis=0), steps), axis=1)
    sizes = np.linalg.norm(steps, axis=1)
    return np.asarray(line[turn > STRAIGHT * sizes * np.roll(sizes, 1)])
