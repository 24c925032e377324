"""What holds parts: supports, and joints between parts, as equations on nodal components."""

from __future__ import annotations

import numpy as np
import scipy
from scipy.sparse import csr_array, vstack

from femstruct.arrays import Floats, Integers
from femstruct.conventions import DIRECTIONS, N_COMPONENTS, TWIST
from femstruct.errors import InputError, some_of
from femstruct.model.anchors import listed, places_of, plate_of, point_rows
from femstruct.model.interpolation import node_rows
from femstruct.model.model import Elastic, Model, PlateMesh, Tie
from femstruct.model.parts import Joint, Region, Support
from femstruct.model.regions import region_box
from femstruct.model.touching import block_pairs

_TRANSLATIONS = 3
_SIX = 6


def support(item: Support, model: Model, tolerance: float) -> Tie:
    """Held displacements of the nodes of an edge, a line, a point or a whole part."""
    where = f"supports.{item.name}"
    if item.at is not None:
        points = places_of(f"{where}.at", item.at, model)
        held = listed(where, {"simple": DIRECTIONS[:3], "clamped": DIRECTIONS}.get(str(item.fix), item.fix))
        rows = csr_array(vstack([point_rows(point, np.zeros(3), model)[held] for point in points]))
        return Tie(item.name, rows, np.tile(_AXES[held], (len(points), 1)), grounded=True)
    name = item.on or ""
    n_nodes = model.mesh.n_nodes
    if item.edge is None and item.line is None:
        if name not in model.mesh.nodes:
            raise InputError(f"{where}.on", got=f"'{name}'", expected=f"a part: {some_of(model.mesh.nodes)}")
        named = {"simple": DIRECTIONS[:3], "clamped": DIRECTIONS}.get(str(item.fix), item.fix)
        components = np.eye(N_COMPONENTS)[listed(where, named)]
        if item.fix == "clamped" and name in model.plates:
            components = np.eye(N_COMPONENTS)
        return _held(item.name, model.mesh.nodes[name], components, n_nodes)
    plate = plate_of(f"{where}.on", name, model)
    pieces = []
    for nodes, along in _edges(where, item, plate, tolerance):
        if isinstance(item.fix, tuple):
            components = np.eye(N_COMPONENTS)[listed(where, item.fix)]
        else:
            components = np.zeros((_SIX + 1, N_COMPONENTS))
            components[:3, :3] = plate.axes
            components[3:6, 3:6] = plate.axes
            components[6, TWIST] = 1.0
            # The slope along an edge parallel to x is w_x = -RY, along one parallel to y it is w_y = RX.
            if item.fix == "simple":
                components = components[[0, 1, 2, 4 if along == 0 else 3]]
        pieces.append(_held(item.name, nodes, components, n_nodes))
    return Tie(
        item.name,
        csr_array(vstack([piece.rows for piece in pieces])),
        np.concatenate([piece.directions for piece in pieces]),
        grounded=True,
    )


def joint(item: Joint, model: Model, tolerance: float) -> tuple[Tie | None, Elastic | None]:
    """Equations, and springs where a stiffness is given, between the coincident nodes of two parts.

    A block takes along the nodes of the other part that lie in it. A rigid joint of two bfs16 plates along a line also
    makes the slope across the line continuous between nodes; where one lies on a block it cannot twist.
    """
    where = f"joints.{item.name}"
    blocks = [name for name in (item.a, item.b) if name in model.blocks]
    pairs = block_pairs(item, model, tolerance) if blocks else _pairs(item, model, tolerance)
    springy = listed(where, tuple(item.stiffness))
    values = np.array([item.stiffness[DIRECTIONS[number]] for number in springy])
    if not (values >= 0).all():
        raise InputError(f"{where}.stiffness", got=f"{values.min():g}", expected="values >= 0")
    stiff = [number for number in range(_SIX if item.kind == "rigid" else _TRANSLATIONS) if number not in springy]
    # Equations along the axes of a plate couple fewer unknowns than along global axes.
    axes = next((model.plates[name].axes for name in (item.a, item.b) if name in model.plates), np.eye(3))
    components = np.eye(N_COMPONENTS)[stiff]
    if not springy:
        components = np.zeros((_SIX, N_COMPONENTS))
        components[:3, :3] = components[3:, 3:6] = axes
        components = components[: len(stiff)]
    # Where the second node is; a block's is far from what touches it, so then where the other part's is.
    at = model.mesh.points[pairs[:, 0 if item.b in model.blocks and item.a not in model.blocks else 1]]
    tie = _relative(item.name, pairs, at, components, model) if stiff else None
    if tie is not None and item.kind == "rigid" and not springy:
        twist = _flat_rows(item, model, pairs) if blocks else _twist_rows(item, model, pairs)
        rows = csr_array(vstack([tie.rows, twist]))
        tie = Tie(item.name, rows, np.concatenate([tie.directions, np.zeros((twist.shape[0], 3))]), grounded=False)
    if not springy:
        return tie, None
    relative = _relative(item.name, pairs, at, np.eye(N_COMPONENTS)[springy], model)
    stiffness = np.tile(values, len(pairs))
    elastic = Elastic(
        item.name, relative.rows, stiffness, np.zeros(stiffness.size), relative.directions, grounded=False
    )
    return tie, elastic


_AXES = np.concatenate([np.eye(3), np.zeros((3, 3))])


def _held(name: str, nodes: Integers, components: Floats, n_nodes: int) -> Tie:
    rows = node_rows(np.repeat(nodes, len(components)), np.tile(components, (len(nodes), 1)), n_nodes)
    return Tie(name, rows, np.tile(components[:, :3], (len(nodes), 1)), grounded=True)


def _relative(name: str, pairs: Integers, at: Floats, components: Floats, model: Model) -> Tie:
    """Motion of the first node less that of the second at the places `at` [m, 3]: nodes apart from them have rigid
    arms, so that a rigid motion of both violates nothing."""
    sides = []
    for nodes in pairs.T:
        moved = np.tile(components, (len(pairs), 1, 1))
        moved[..., 3:_SIX] += np.cross((at - model.mesh.points[nodes])[:, None], components[None, :, :3])
        sides.append(node_rows(np.repeat(nodes, len(components)), moved.reshape(-1, N_COMPONENTS), model.mesh.n_nodes))
    directions = np.tile(components[:, :3], (len(pairs), 1))
    return Tie(name, csr_array(sides[0] - sides[1]), directions, grounded=False)


def _flat_rows(item: Joint, model: Model, pairs: Integers) -> csr_array:
    """No twist of a bfs16 plate where several of its nodes follow a block: it is flat there, and so are its edges."""
    n_nodes = model.mesh.n_nodes
    for name, nodes in zip((item.a, item.b), pairs.T, strict=True):
        if name in model.plates and model.plates[name].part.element == "bfs16" and len(nodes) > 1:
            return _held(item.name, nodes, np.eye(N_COMPONENTS)[[TWIST]], n_nodes).rows
    return csr_array((0, n_nodes * N_COMPONENTS))


def _twist_rows(item: Joint, model: Model, pairs: Integers) -> csr_array:
    """Equal twist where two bfs16 plates meet: the rate of turning about the common line s is +TWIST for a plate with s
    along its x, -TWIST along its y."""
    n_nodes = model.mesh.n_nodes
    none = csr_array((0, n_nodes * N_COMPONENTS))
    if not all(name in model.plates and model.plates[name].part.element == "bfs16" for name in (item.a, item.b)):
        return none
    if len(pairs) < 2:
        return none
    line = model.mesh.points[pairs[-1, 0]] - model.mesh.points[pairs[0, 0]]
    first, second = (
        1.0 if abs(axes[0] @ line) > abs(axes[1] @ line) else -1.0
        for axes in (model.plates[item.a].axes, model.plates[item.b].axes)
    )
    unit = np.eye(N_COMPONENTS)[[TWIST]]
    one, other = (_held(item.name, nodes, unit, n_nodes).rows for nodes in pairs.T)
    return csr_array(first * one - second * other)


def _pairs(item: Joint, model: Model, tolerance: float) -> Integers:
    """Coincident nodes of the two parts [m, 2]."""
    first, second = (model.mesh.nodes[name] for name in (item.a, item.b))
    reach = 4.0 * tolerance
    distances, nearest = scipy.spatial.KDTree(model.mesh.points[second]).query(
        model.mesh.points[first], distance_upper_bound=reach
    )
    met = np.isfinite(distances)
    if not met.any():
        raise InputError(f"joints.{item.name}", got=f"{item.a} and {item.b} without a common node", expected="a touch")
    return np.stack([first[met], second[np.asarray(nearest)[met]]], axis=1)


def _edges(where: str, item: Support, plate: PlateMesh, tolerance: float) -> list[tuple[Integers, int]]:
    """Nodes of each held edge or line, and the plate axis it runs along."""
    if item.line is not None:
        region = Region("line", line=item.line)
        box = region_box(f"{where}.line", plate.part.name, plate.part.size, region, tolerance)
        in_x = np.flatnonzero((plate.x >= box[0] - tolerance) & (plate.x <= box[1] + tolerance))
        in_y = np.flatnonzero((plate.y >= box[2] - tolerance) & (plate.y <= box[3] + tolerance))
        return [(plate.nodes[np.ix_(in_x, in_y)].ravel(), 0 if len(in_x) > 1 else 1)]
    edges = {
        "x0": (plate.nodes[0], 1),
        "x1": (plate.nodes[-1], 1),
        "y0": (plate.nodes[:, 0], 0),
        "y1": (plate.nodes[:, -1], 0),
    }
    return list(edges.values()) if item.edge == "all" else [edges[str(item.edge)]]
