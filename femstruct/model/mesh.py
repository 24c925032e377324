"""Mesh: nodes, cells and which part they belong to."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from femstruct.arrays import Floats, Integers, freeze, frozen, frozen_integers
from femstruct.errors import FemstructError
from femstruct.tags import stored_as


@stored_as("mesh/1")
@dataclass(frozen=True, eq=False)
class Mesh:
    """Nodes and cells of all parts; every part has nodes of its own, joints are equations between them.

    points [n, 3] : coordinates of the nodes [m].
    quads [q, 4] : corner nodes of plate cells, in the order (0, 0) (0, b) (a, b) (a, 0) along the plate's own axes.
    bars [b, 2] : end nodes of bars.
    nodes : by part.
    """

    points: Floats
    quads: Integers
    bars: Integers
    nodes: Mapping[str, Integers]

    def __post_init__(self) -> None:
        points = frozen("Mesh points", self.points, (None, 3))
        freeze(
            self,
            points=points,
            quads=frozen_integers("Mesh quads", self.quads, (None, 4)),
            bars=frozen_integers("Mesh bars", self.bars, (None, 2)),
            nodes={name: frozen_integers(f"Mesh nodes of {name}", rows, (None,)) for name, rows in self.nodes.items()},
        )
        for name, cells in (("quads", self.quads), ("bars", self.bars)):
            if cells.size and not (cells.min() >= 0 and cells.max() < len(points)):
                raise FemstructError(f"Mesh {name}", got="a node that is not there", expected=f"0..{len(points) - 1}")

    @property
    def n_nodes(self) -> int:
        """Number of nodes."""
        return len(self.points)
