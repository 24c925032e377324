"""Makes l_room.msh: an L-shaped living room of 5 x 4 m with a wing of 2.5 x 3 m, 2.5 m high, of hexahedra.

    python meshes/l_room.py [SIZE OF A CELL in m]

Named walls: ceiling, floor, wing (its two outer walls and its end), walls (all others). Cells of at most 0.5 m carry
sound to 114 Hz, six to a wave.
"""

from __future__ import annotations

import sys
from pathlib import Path

import meshio
import numpy as np

from acoustics import CavityMesh, box_mesh

MAIN, WING, HEIGHT = (5.0, 4.0), (2.5, 3.0), 2.5


def main(cell: float = 0.45) -> CavityMesh:
    """The mesh: the main room from the origin, the wing beyond x = 5 m, along y from 0 to 3 m."""
    x = np.concatenate([np.linspace(0, MAIN[0], 1 + round(MAIN[0] / cell)), MAIN[0] + graded(WING[0], cell)[1:]])
    y = np.concatenate([graded(WING[1], cell), WING[1] + graded(MAIN[1] - WING[1], cell)[1:]])
    z = graded(HEIGHT, cell)
    grid = box_mesh([1, 1, 1], [len(x) - 1, len(y) - 1, len(z) - 1])
    index = np.rint(grid.points * [len(x) - 1, len(y) - 1, len(z) - 1]).astype(int)
    points = np.column_stack([x[index[:, 0]], y[index[:, 1]], z[index[:, 2]]])
    middle = points[grid.cells].mean(axis=1)
    cells = grid.cells[(middle[:, 0] < MAIN[0]) | (middle[:, 1] < WING[1])]
    used, numbers = np.unique(cells, return_inverse=True)
    room = CavityMesh(points[used], numbers.reshape(cells.shape), {})
    faces = room.basis.mesh
    outer = faces.facets[:, faces.boundary_facets()].T
    around = np.argsort(turn(room.points[outer]), axis=1)
    outer = np.take_along_axis(outer, around, axis=1)
    middle = room.points[outer].mean(axis=1)
    ceiling, floor = np.isclose(middle[:, 2], HEIGHT), np.isclose(middle[:, 2], 0.0)
    wing = (middle[:, 0] > MAIN[0] + 1e-9) & ~ceiling & ~floor
    named = {"ceiling": ceiling, "floor": floor, "wing": wing, "walls": ~(ceiling | floor | wing)}
    return CavityMesh(room.points, room.cells, {name: outer[own] for name, own in named.items()})


def graded(length: float, cell: float) -> np.ndarray:
    return np.linspace(0, length, 1 + max(1, round(length / cell)))


def turn(corners: np.ndarray) -> np.ndarray:
    """Angles of the corners [f, 4, 3] of facets about their middles."""
    away = corners - corners.mean(axis=1, keepdims=True)
    normal = np.cross(away[:, 0], away[:, 1])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    first = away[:, 0] / np.linalg.norm(away[:, 0], axis=1, keepdims=True)
    second = np.cross(normal, first)
    return np.arctan2(np.einsum("fcx,fx->fc", away, second), np.einsum("fcx,fx->fc", away, first))


def write(room: CavityMesh, path: Path) -> None:
    """As Gmsh writes it, format 2.2, with a physical group for every wall."""
    quads = np.concatenate(list(room.walls.values()))
    tags = np.repeat(np.arange(1, 1 + len(room.walls)), [len(own) for own in room.walls.values()])
    air = np.full(len(room.cells), 1 + len(room.walls))
    names = {name: np.array([tag, 2]) for tag, name in enumerate(room.walls, 1)} | {"air": np.array([air[0], 3])}
    mesh = meshio.Mesh(
        room.points.round(9),
        [("quad", quads), ("hexahedron", room.cells)],
        cell_data={"gmsh:physical": [tags, air], "gmsh:geometrical": [tags, air]},
        field_data=names,
    )
    mesh.write(path, file_format="gmsh22", binary=False)


if __name__ == "__main__":
    write(main(*map(float, sys.argv[1:])), Path(__file__).with_suffix(".msh"))
