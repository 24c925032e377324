"""Parts whose nodes are given, by a mesh or with matrices: no grid is laid out for them."""

from __future__ import annotations

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.conventions import DIRECTIONS, N_COMPONENTS
from femstruct.errors import InputError
from femstruct.model.grid.layout import Layout
from femstruct.model.meshed import Drawn, Meshed, refuse_not_global, refuse_patch
from femstruct.model.part import Part
from femstruct.model.probe import Point
from femstruct.model.rows import sparse_rows
from femstruct.model.structure import PlaceOn


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


def node_point(name: str, place: PlaceOn, at: Floats, part: Meshed, expected: str, tolerance: float) -> Point:
    """A point at a node of a part whose motion is known at its nodes alone. expected : what such a node is, for the
    message. Raises InputError for a set, a patch, and a place that is farther from every node than the tolerance."""
    where = f"points.{name}"
    refuse_patch(name, place)
    if place.named is not None:
        raise InputError(f"{where}.set", got=f"a set of {part.name}", expected="at: [x, y, z]")
    refuse_not_global(name, at)
    off = np.linalg.norm(part.places - at, axis=1)
    node = int(off.argmin())
    if off[node] > tolerance:
        x, y, z = part.places[node]
        raise InputError(
            f"{where}.at",
            got=f"({at[0]:g}, {at[1]:g}, {at[2]:g}) m, {off[node]:.4g} m from the nearest node of {part.name}",
            expected=f"{expected}; the nearest is at ({x:.6g}, {y:.6g}, {z:.6g}) m",
        )
    up = np.array([0.0, 0.0, 1.0 if place.side == "above" else -1.0])
    six = len(DIRECTIONS)
    return Point(name, at, np.full(six, part.first + node), np.arange(six), np.eye(six), normal=up)
