"""A structure as it looks between its nodes: points, faces and lines that move with the elements' shape functions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array, vstack

from femstruct.arrays import Floats, Integers
from femstruct.conventions import N_COMPONENTS
from femstruct.modal.basis import ModalBasis
from femstruct.model.interpolation import frame_rows, node_rows, plate_rows, sparse_rows
from femstruct.model.model import FrameMesh, Model, PlateMesh


@dataclass(frozen=True, eq=False)
class Skin:
    """What is drawn of a structure.

    points [m, 3] : at rest [m]. quads [c, 4] : faces of the plates, corners in turn. lines [l, 2] : pieces of bars.
    parts : names; part_of_quads [c] and part_of_lines [l] : their index. rows [3 m, n_nodes * 7] : displacements.
    """

    points: Floats
    quads: Integers
    lines: Integers
    parts: tuple[str, ...]
    part_of_quads: Integers
    part_of_lines: Integers
    rows: csr_array

    def displacements(self, shapes: Floats) -> Floats:
        """Displacements [m, 3, k] of the points in nodal shapes [n_nodes, 7, k]."""
        moved: Floats = self.rows @ shapes.reshape(-1, shapes.shape[2])
        return moved.reshape(len(self.points), 3, -1)


def skin(model: Model, divisions: int = 3) -> Skin:
    """The skin of a meshed model, every cell and bar cut into `divisions` along each side.

    Notes: a quadrilateral between the points is flat; with 3 divisions of a mesh that resolves the mode, a cubic is
    missed by some 2 % of its rise within the cell.
    """
    n_nodes = model.mesh.n_nodes
    points, quads, lines, quad_parts, line_parts, rows = [], [], [], [], [], []
    names = (*model.plates, *model.frames)
    start = 0
    for number, name in enumerate(names):
        if name in model.plates:
            places, cells, moved = _plate(model.plates[name], divisions, n_nodes)
            quads.append(cells + start)
            quad_parts.append(np.full(len(cells), number))
        else:
            places, cells, moved = _frame(model.frames[name], divisions, n_nodes)
            lines.append(cells + start)
            line_parts.append(np.full(len(cells), number))
        points.append(places)
        rows.append(moved)
        start += len(places)
    return Skin(
        np.concatenate([np.empty((0, 3)), *points]),
        np.concatenate([np.empty((0, 4), dtype=np.int64), *quads]),
        np.concatenate([np.empty((0, 2), dtype=np.int64), *lines]),
        names,
        np.concatenate([np.empty(0, dtype=np.int64), *quad_parts]),
        np.concatenate([np.empty(0, dtype=np.int64), *line_parts]),
        csr_array(vstack(rows)) if rows else csr_array((0, n_nodes * N_COMPONENTS)),
    )


def bare_skin(basis: ModalBasis) -> Skin:
    """The nodes alone, for a basis in closed form, which has no elements."""
    count = len(basis.points)
    components = np.tile(np.eye(3, N_COMPONENTS), (count, 1))
    none = np.empty(0, dtype=np.int64)
    return Skin(
        basis.points,
        none.reshape(0, 4),
        none.reshape(0, 2),
        (),
        none,
        none,
        node_rows(np.repeat(np.arange(count), 3), components, count),
    )


def _plate(mesh: PlateMesh, divisions: int, n_nodes: int) -> tuple[Floats, Integers, csr_array]:
    x, y = _divided(mesh.x, divisions), _divided(mesh.y, divisions)
    places = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    number = np.arange(len(places)).reshape(len(x), len(y))
    corners = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1).reshape(-1, 4)
    nodes, rows = plate_rows(mesh, places)
    return mesh.part.origin + places @ mesh.axes[:2], corners, sparse_rows(nodes, rows[:, :3], n_nodes)


def _frame(mesh: FrameMesh, divisions: int, n_nodes: int) -> tuple[Floats, Integers, csr_array]:
    along = np.linspace(0.0, 1.0, divisions + 1)
    bars = np.repeat(np.arange(len(mesh.bars)), divisions + 1)
    places = np.tile(along, len(mesh.bars))
    number = np.arange(len(bars)).reshape(-1, divisions + 1)
    pieces = np.stack([number[:, :-1], number[:, 1:]], axis=-1).reshape(-1, 2)
    points = mesh.start[bars] + places[:, None] * (mesh.end - mesh.start)[bars]
    nodes, rows = frame_rows(mesh, bars, places)
    return points, pieces, sparse_rows(nodes, rows[:, :3], n_nodes)


def _divided(grid: Floats, divisions: int) -> Floats:
    fractions = np.arange(divisions) / divisions
    inner = grid[:-1, None] + fractions * np.diff(grid)[:, None]
    return np.append(inner, grid[-1])
