"""Edges on springs and edges with walls: what resists along an edge of a plate, slab or shell, per length of it."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array, vstack

from femstruct.arrays import Floats
from femstruct.conventions import DIRECTIONS
from femstruct.errors import InputError, some_of
from femstruct.model.fastened import Elastic
from femstruct.model.materials.edge_wall import WALLS_AT
from femstruct.model.meshed import EdgePoints
from femstruct.model.model import Model
from femstruct.model.rows import sparse_rows
from femstruct.model.structure import ABOUT, ACROSS, Support

_ALONG = 1.0 - 1e-9  # of a normal within the directions that are held
SPRINGS, WALLS = "springs", "walls"  # beside the name of a support that holds the edge, too: a part of their own


def elastic_edges(item: Support, model: Model, tolerance: float) -> tuple[Elastic, ...]:
    """Springs along the edges or the line of a support, at Gauss points: across the part, and about the edge.

    A support that only has springs gives them its name; beside what it holds they are "NAME springs" or "NAME walls".
    Raises InputError for a part without edges, for a set or box without a free edge, and for springs across the part
    where the support holds it along its normal.
    """
    if not item.stiffness and not item.walls:
        return ()
    name = item.on or ""
    if name not in model.parts:
        expected = f"a part with nodes: {some_of(model.parts)}"
        raise InputError(f"supports.{item.name}.on", got=f"'{name}'", expected=expected)
    points = model.parts[name].edge_points(item, tolerance)
    n_nodes = model.mesh.n_nodes
    if item.walls:
        about = sum(wall.stiffness(WALLS_AT) for wall in item.walls)
        lost = sum(wall.stiffness(WALLS_AT) * wall.loss_factor for wall in item.walls)
        rows, stiffness, directions = _turning(points, about, n_nodes)
        none = np.zeros(stiffness.size)
        own = f"{item.name} {WALLS}"
        return (Elastic(own, rows, stiffness, none, directions, True, lost / about, grows_from=WALLS_AT),)
    found = []
    if ACROSS in item.stiffness:
        _refuse_held(item, points.across)
        moved = np.einsum("pi,pikc->pkc", points.across, points.rows[:, :3])[:, None]
        found.append(
            (sparse_rows(points.nodes, moved, n_nodes), item.stiffness[ACROSS] * points.weights, points.across)
        )
    if ABOUT in item.stiffness:
        found.append(_turning(points, item.stiffness[ABOUT], n_nodes))
    rows = csr_array(vstack([one[0] for one in found]))
    stiffness, directions = (np.concatenate([one[i] for one in found]) for i in (1, 2))
    own = f"{item.name} {SPRINGS}" if item.fix else item.name
    return (Elastic(own, rows, stiffness, np.zeros(stiffness.size), directions, True, item.loss_factor),)


def _refuse_held(item: Support, across: Floats) -> None:
    """Raise InputError where the directions that a support holds include the normal [p, 3] of its part."""
    held = [DIRECTIONS.index(one) for one in item.fix if one in DIRECTIONS[:3]]
    if held and np.linalg.norm(across[:, held], axis=1).max() > _ALONG:
        raise InputError(
            f"supports.{item.name}.stiffness.{ACROSS}",
            got=f"a stiffness beside fix: [{', '.join(item.fix)}], which holds {item.on} along its normal",
            expected="one of them",
            do="remove the direction: the springs carry the edge",
        )


def _turning(points: EdgePoints, stiffness: float, n_nodes: int) -> tuple[csr_array, Floats, Floats]:
    """Rows of the rotation about the edge at points along it, its stiffness at each, and no force."""
    turned = np.einsum("pi,pikc->pkc", points.along, points.rows[:, 3:6])[:, None]
    return sparse_rows(points.nodes, turned, n_nodes), stiffness * points.weights, np.zeros((len(points.weights), 3))
