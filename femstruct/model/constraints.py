"""What holds parts: supports, and joints between parts, as equations on nodal components."""

from __future__ import annotations

import numpy as np
import scipy
from scipy.sparse import csr_array, vstack

from femstruct.arrays import Floats, Integers
from femstruct.conventions import DIRECTIONS, N_COMPONENTS
from femstruct.errors import InputError, some_of
from femstruct.model.anchors import listed, places_of, point_rows
from femstruct.model.fastened import Elastic, Tie
from femstruct.model.grid.touching import stretch_inside
from femstruct.model.model import Model
from femstruct.model.rows import node_rows
from femstruct.model.structure import Joint, Support

_TRANSLATIONS = 3
_SIX = 6
_AXES = np.concatenate([np.eye(3), np.zeros((3, 3))])


def support(item: Support, model: Model, tolerance: float) -> Tie:
    """Held displacements of the nodes of an edge, a line, a point or a whole part."""
    where = f"supports.{item.name}"
    if item.at is not None:
        points = places_of(f"{where}.at", item.at, model)
        held = listed(where, _named(item))
        rows = csr_array(vstack([point_rows(point, np.zeros(3), model)[held] for point in points]))
        return Tie(item.name, rows, np.tile(_AXES[held], (len(points), 1)), grounded=True)
    name, n_nodes = item.on or "", model.mesh.n_nodes
    if name not in model.parts:
        raise InputError(f"{where}.on", got=f"'{name}'", expected=f"a part with nodes: {some_of(model.parts)}")
    part = model.parts[name]
    if item.edge is None and item.line is None:
        components = part.clamped if item.fix == "clamped" else np.eye(N_COMPONENTS)[listed(where, _named(item))]
        return _held(item.name, part.nodes, components, n_nodes)
    pieces = []
    for nodes, clamped, simple in part.edges(item, tolerance):
        if isinstance(item.fix, tuple):
            components = np.eye(N_COMPONENTS)[listed(where, item.fix)]
        else:
            components = simple if item.fix == "simple" else clamped
        pieces.append(_held(item.name, nodes, components, n_nodes))
    return Tie(
        item.name,
        csr_array(vstack([piece.rows for piece in pieces])),
        np.concatenate([piece.directions for piece in pieces]),
        grounded=True,
    )


def _named(item: Support) -> object:
    """Directions held at a point or of a whole part."""
    return {"simple": DIRECTIONS[:3], "clamped": DIRECTIONS}.get(str(item.fix), item.fix)


def joint(item: Joint, model: Model, tolerance: float) -> tuple[Tie | None, Elastic | None]:
    """Equations, and springs where a stiffness is given, between the coincident nodes of two parts.

    A block takes along the nodes of the other part that lie in it. A rigid joint of two parts along a line also
    equates what both have there beside their motion (`Meshed.along`); what lies on a block is flat (`Meshed.flat`).
    """
    where = f"joints.{item.name}"
    for end in (item.a, item.b):
        if end not in model.parts:
            raise InputError(where, got=f"'{end}'", expected=f"a part with nodes: {some_of(model.parts)}")
    one, other = model.parts[item.a], model.parts[item.b]
    for part in (one, other):
        if item.kind == "rigid" and not part.has_rotations:
            raise InputError(where, got=f"rigid, and nodes of {part.name} that have no rotations", expected="pinned")
    boxes = [part for part in (one, other) if part.box is not None]
    pairs = _box_pairs(item, model, tolerance) if boxes else _pairs(item, model, tolerance)
    springy = listed(where, tuple(item.stiffness))
    values = np.array([item.stiffness[DIRECTIONS[number]] for number in springy])
    if not (values >= 0).all():
        raise InputError(f"{where}.stiffness", got=f"{values.min():g}", expected="values >= 0")
    stiff = [number for number in range(_SIX if item.kind == "rigid" else _TRANSLATIONS) if number not in springy]
    # Equations along the axes of a plate couple fewer unknowns than along global axes.
    axes = next((part.own_axes for part in (one, other) if part.own_axes is not None), np.eye(3))
    components = np.eye(N_COMPONENTS)[stiff]
    if not springy:
        components = np.zeros((_SIX, N_COMPONENTS))
        components[:3, :3] = components[3:, 3:6] = axes
        components = components[: len(stiff)]
    # Where the second node is; a block's is far from what touches it, so then where the other part's is.
    at = model.mesh.points[pairs[:, 0 if other.box is not None and one.box is None else 1]]
    tie = _relative(item.name, pairs, at, components, model) if stiff else None
    if tie is not None and item.kind == "rigid" and not springy:
        beside = _flat_rows(item, model, pairs) if boxes else _common_rows(item, model, pairs)
        rows = csr_array(vstack([tie.rows, beside]))
        tie = Tie(item.name, rows, np.concatenate([tie.directions, np.zeros((beside.shape[0], 3))]), grounded=False)
    if not springy:
        return tie, None
    relative = _relative(item.name, pairs, at, np.eye(N_COMPONENTS)[springy], model)
    stiffness = np.tile(values, len(pairs))
    elastic = Elastic(
        item.name, relative.rows, stiffness, np.zeros(stiffness.size), relative.directions, grounded=False
    )
    return tie, elastic


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
    """What vanishes of a part several nodes of which follow a block."""
    n_nodes = model.mesh.n_nodes
    for name, nodes in zip((item.a, item.b), pairs.T, strict=True):
        if len(flat := model.parts[name].flat) and len(nodes) > 1:
            return _held(item.name, nodes, flat, n_nodes).rows
    return csr_array((0, n_nodes * N_COMPONENTS))


def _common_rows(item: Joint, model: Model, pairs: Integers) -> csr_array:
    """What two parts have in common along the line of their nodes, where both have it."""
    n_nodes = model.mesh.n_nodes
    line = model.mesh.points[pairs[-1, 0]] - model.mesh.points[pairs[0, 0]]
    sides = [model.parts[name].along(line) for name in (item.a, item.b)]
    if len(pairs) < 2 or len(sides[0]) != len(sides[1]):
        return csr_array((0, n_nodes * N_COMPONENTS))
    one, other = (_held(item.name, nodes, side, n_nodes).rows for nodes, side in zip(pairs.T, sides, strict=True))
    return csr_array(one - other)


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


def _box_pairs(item: Joint, model: Model, tolerance: float) -> Integers:
    """Nodes of the two parts of a joint that move together [m, 2]; at least one of the parts is a block.

    Of a plate all nodes whose thickness reaches the block, of a frame all nodes in it, of another block its only one.

    Raises InputError when nothing touches.
    """
    turned = model.parts[item.a].box is None
    part, other = (model.parts[name] for name in ((item.b, item.a) if turned else (item.a, item.b)))
    assert part.box is not None
    low, high = part.box
    if other.box is not None:
        if item.kind != "rigid" or item.stiffness:
            raise InputError(
                f"joints.{item.name}",
                got="a joint of two blocks that is not rigid",
                expected="kind: rigid",
                do="put a foundation or springs between them",
            )
        apart = float(np.linalg.norm(np.maximum(np.maximum(other.box[0] - high, low - other.box[1]), 0.0)))
        if apart > tolerance:
            raise _no_touch(item, f"{apart:.4g} m apart")
        return np.array([[part.first, other.first]])
    first, last = stretch_inside(other.places, other.across, low - tolerance, high + tolerance)
    met = other.nodes[first <= last]
    if not len(met):
        raise _no_touch(item, "without a common place")
    pairs = np.stack([np.full(len(met), part.first), met], axis=1)
    return pairs[:, ::-1] if turned else pairs


def _no_touch(item: Joint, how: str) -> InputError:
    return InputError(
        f"joints.{item.name}",
        got=f"{item.a} and {item.b} {how}",
        expected="a part that touches the block",
        do="move one of them, or put a foundation or springs between",
    )
