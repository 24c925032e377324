"""Parts whose nodes are given, by a mesh or with matrices: no grid is laid out for them."""

from __future__ import annotations

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.conventions import N_COMPONENTS
from femstruct.model.grid.layout import Layout
from femstruct.model.meshed import Drawn
from femstruct.model.part import Part
from femstruct.model.rows import sparse_rows


class GivenNodes(Part):
    """A part whose nodes are where they are given; the base of such kinds."""

    def lay_out(self, layout: Layout) -> None:
        layout.given.add(self.name)


def drawn_nodes(places: Floats, nodes: Integers, quads: Integers, lines: Integers, n_nodes: int) -> Drawn:
    """Cells and lines between nodes [n] at places [n, 3] [m], straight as they are, for pictures.

    quads [q, 4], lines [l, 2] : rows of the nodes.
    """
    rows = np.zeros((len(nodes), 3, 1, N_COMPONENTS))
    rows[:, :, 0, :3] = np.eye(3)
    return Drawn(places, sparse_rows(nodes[:, None], rows, n_nodes), quads, lines)
