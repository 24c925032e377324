"""Parts of one mesh file that its nodes join, and shells that turn on solids where they share a line of nodes alone."""

from __future__ import annotations

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.errors import Finding
from femstruct.model.equations.shared_nodes import Shared, shared_nodes
from femstruct.model.meshed import Meshed
from femstruct.model.model import Model


def shared_node_findings(model: Model) -> tuple[Finding, ...]:
    """What the nodes of a file join, in one remark; and each shell that they join to a solid by forces alone."""
    found = shared_nodes(model)
    if not found:
        return ()
    names = ", ".join(f"{one.name} (at {len(one.pairs)})" for one in found)
    told = [
        Finding(
            "parts-share-nodes",
            f"Parts of one mesh file are joined at the nodes that they share there: {names}. A joint or a seam of two "
            "of them takes the place of that",
            {"pairs": len(found), "nodes": sum(len(one.pairs) for one in found)},
        )
    ]
    return (*told, *(hinge for one in found for hinge in _hinge(one, model)))


def _hinge(shared: Shared, model: Model) -> list[Finding]:
    """A shell whose nodes on a solid are of no cell that lies on it: it turns there."""
    parts = model.parts[shared.a], model.parts[shared.b]
    turning = [part.has_rotations for part in parts]
    if turning[0] == turning[1]:
        return []
    shell, solid = parts if turning[0] else parts[::-1]
    nodes = shared.pairs[:, 0 if turning[0] else 1]
    lone, length = _lone_nodes(shell, nodes, model.mesh.points)
    if not lone:
        return []
    where = f"along {length:.3g} m" if length > 0.0 else f"at {lone} nodes"
    message = (
        f"{shell.name} and {solid.name} share nodes of their mesh file {where}, where no cell of {shell.name} lies on "
        f"{solid.name}: forces go across and no moments, so that {shell.name} turns there as on a hinge. Write a joint "
        "of both, which holds the rotations, or one of 'kind: pinned' if it is a hinge"
    )
    return [Finding("shared-nodes-hinge", message, {"length_m": length, "nodes": lone}, severe=True)]


def _lone_nodes(shell: Meshed, nodes: Integers, points: Floats) -> tuple[int, float]:
    """How many of some nodes of a shell are of no cell all of whose nodes are among them, and the length of the edges
    between nodes that have such a one [m]."""
    cells = shell.quads
    whole = np.unique(cells[np.isin(cells, nodes).all(axis=1)])
    lone = np.setdiff1d(nodes, whole)
    sides = np.unique(np.sort(np.concatenate([cells[:, [i, (i + 1) % 4]] for i in range(4)]), axis=1), axis=0)
    along = sides[np.isin(sides, nodes).all(axis=1) & np.isin(sides, lone).any(axis=1)]
    return len(lone), float(np.linalg.norm(points[along[:, 1]] - points[along[:, 0]], axis=1).sum())
