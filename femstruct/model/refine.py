"""Finer points between the nodes, moved by the elements' own shape functions: for smooth pictures and files."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array, vstack

from femstruct.arrays import Floats, Integers, freeze, frozen, frozen_integers
from femstruct.errors import InputError
from femstruct.model.model import Model


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
    first = 0
    for number, part in enumerate(model.parts.values()):
        drawn = part.drawn(divisions, along or divisions, model.mesh.n_nodes)
        points.append(drawn.points)
        rows.append(drawn.rows)
        quads.append(first + drawn.quads)
        lines.append(first + drawn.lines)
        owners.append(np.full(len(drawn.points), number))
        first += len(drawn.points)
    return Refined(
        np.concatenate(points),
        np.concatenate(quads),
        np.concatenate(lines),
        csr_array(vstack(rows)),
        tuple(model.parts),
        np.concatenate(owners),
    )
