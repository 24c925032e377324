"""Finer points between the nodes, moved by the elements' own shape functions: for smooth pictures and files."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array, vstack

from femstruct.arrays import Floats, Integers, freeze, frozen, frozen_integers
from femstruct.errors import InputError
from femstruct.model.geometry import from_plate
from femstruct.model.interpolation import block_rows, frame_rows, plate_rows, sparse_rows
from femstruct.model.model import BlockMesh, FrameMesh, Model, PlateMesh


@dataclass(frozen=True, eq=False)
class Refined:
    """A subdivided model.

    points [p, 3] : [m]. quads [q, 4] : corners of pieces of plates and faces of blocks, in turn.
    lines [l, 2] : ends of pieces of bars.
    rows [3 p, n_nodes * 7] : x, y, z displacements of the points from the nodal components. parts : names of the parts;
    part_of_point [p] : the part of each point, as a place in `parts`.
    """

    points: Floats
    quads: Integers
    lines: Integers
    rows: csr_array
    parts: tuple[str, ...]
    part_of_point: Integers

    def __post_init__(self) -> None:
        points = frozen("Refined points", self.points, (None, 3))
        freeze(
            self,
            points=points,
            quads=frozen_integers("Refined quads", self.quads, (None, 4)),
            lines=frozen_integers("Refined lines", self.lines, (None, 2)),
            part_of_point=frozen_integers("Refined part_of_point", self.part_of_point, (len(points),)),
        )

    def displacement(self, shapes: Floats) -> Floats:
        """Displacements [p, 3, k] of the points in nodal shapes [n_nodes, 7, k]."""
        count = shapes.shape[2]
        moved: Floats = self.rows @ shapes.reshape(shapes.shape[0] * shapes.shape[1], count)  # -1 fails without nodes
        return moved.reshape(len(self.points), 3, count)


def refined(model: Model, divisions: int = 4, along: int | None = None) -> Refined:
    """The model with every cell side and every bar divided into equal pieces; blocks are boxes.

    divisions : pieces a side. along : pieces of a bar, as many if nothing is said. Raises InputError when there is not
    at least one.
    """
    if divisions < 1:
        raise InputError("divisions", got=f"{divisions}", expected="at least 1")
    points: list[Floats] = []
    rows: list[csr_array] = []
    owners: list[Integers] = []
    quads = [np.empty((0, 4), np.int64)]
    lines = [np.empty((0, 2), np.int64)]
    parts = tuple(model.mesh.nodes)
    first = 0
    for number, name in enumerate(parts):
        if name in model.plates:
            places, motion, cells = _of_plate(model.plates[name], divisions, model.mesh.n_nodes)
            quads.append(first + cells)
        elif name in model.blocks:
            places, motion, cells = _of_block(model.blocks[name], model.mesh.n_nodes)
            quads.append(first + cells)
        else:
            places, motion, cells = _of_frame(model.frames[name], along or divisions, model.mesh.n_nodes)
            lines.append(first + cells)
        points.append(places)
        rows.append(motion)
        owners.append(np.full(len(places), number))
        first += len(places)
    return Refined(
        np.concatenate(points),
        np.concatenate(quads),
        np.concatenate(lines),
        csr_array(vstack(rows)),
        parts,
        np.concatenate(owners),
    )


def _of_plate(plate: PlateMesh, divisions: int, n_nodes: int) -> tuple[Floats, csr_array, Integers]:
    x, y = _divided(plate.x, divisions), _divided(plate.y, divisions)
    local = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    nodes, rows = plate_rows(plate, local)
    n = np.arange(len(local)).reshape(len(x), len(y))
    cells = np.stack([n[:-1, :-1], n[1:, :-1], n[1:, 1:], n[:-1, 1:]], axis=-1).reshape(-1, 4)
    return from_plate(plate.part, plate.axes, local), sparse_rows(nodes, rows[:, :3], n_nodes), cells


def _of_frame(frame: FrameMesh, divisions: int, n_nodes: int) -> tuple[Floats, csr_array, Integers]:
    bars = np.repeat(np.arange(len(frame.bars)), divisions + 1)
    share = np.tile(np.linspace(0.0, 1.0, divisions + 1), len(frame.bars))
    nodes, rows = frame_rows(frame, bars, share)
    places = (1.0 - share)[:, None] * frame.start[bars] + share[:, None] * frame.end[bars]
    n = np.arange(len(bars)).reshape(len(frame.bars), divisions + 1)
    pieces = np.stack([n[:, :-1], n[:, 1:]], axis=-1).reshape(-1, 2)
    return places, sparse_rows(nodes, rows[:, :3], n_nodes), pieces


def _of_block(block: BlockMesh, n_nodes: int) -> tuple[Floats, csr_array, Integers]:
    """The six faces, each with corners of its own, so that every face has edges."""
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    faces = [np.insert(square, axis, side, axis=1) for axis in range(3) for side in (0, 1)]
    low, high = block.corners
    places = low + np.concatenate(faces) * (high - low)
    nodes, rows = block_rows(block, places)
    return places, sparse_rows(nodes, rows[:, :3], n_nodes), np.arange(len(places)).reshape(-1, 4)


def _divided(grid: Floats, divisions: int) -> Floats:
    steps = np.arange(divisions) / divisions
    between = grid[:-1, None] + np.diff(grid)[:, None] * steps
    return np.append(between.ravel(), grid[-1])
