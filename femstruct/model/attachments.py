"""What is fastened to plates and bars, as rows on nodal components: foundations, springs, masses, supports, joints."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array, vstack
from scipy.spatial import KDTree

from femstruct.arrays import Floats, Integers
from femstruct.conventions import DIRECTIONS, N_COMPONENTS, TWIST
from femstruct.elements.quadrature import gauss_interval
from femstruct.errors import InputError
from femstruct.model.interpolation import frame_rows, node_rows, plate_rows, sparse_rows
from femstruct.model.model import Elastic, Inert, Model, PlateMesh, Tie
from femstruct.model.parts import Foundation, Joint, Mass, Region, Spring, Support
from femstruct.model.probe import Point
from femstruct.model.regions import area_points, line_points, region_box, region_lines

ORDER = 4
"""Gauss points a direction: exact for products of two cubic deflections."""

_TRANSLATIONS = 3
_SIX = 6


def foundation(part: Foundation, model: Model, tolerance: float) -> Elastic:
    """A Winkler foundation at Gauss points: along the normal, and along both axes of the plate in shear."""
    where = f"parts.{part.name}"
    if not (part.normal >= 0 and part.shear >= 0 and part.normal + part.shear > 0):
        raise InputError(
            f"{where}.stiffness", got=f"{part.normal:g}, {part.shear:g}", expected="values >= 0, one above"
        )
    plate = _plate(f"{where}.on", part.on, model)
    local, weights = _region_points(f"{where}.region", plate, part.region, tolerance)
    nodes, rows = plate_rows(plate, local)
    own = np.einsum("ij,pjkc->pikc", plate.axes, rows[:, :3])
    kept = np.array([part.shear, part.shear, part.normal]) > 0
    stiffness = weights[:, None] * np.array([part.shear, part.shear, part.normal])[kept]
    return Elastic(
        part.name,
        sparse_rows(nodes, own[:, kept], model.mesh.n_nodes),
        stiffness.ravel(),
        np.zeros(stiffness.size),
        np.tile(plate.axes[kept], (len(local), 1)),
        grounded=True,
        loss_factor=part.loss_factor,
    )


def springs(part: Spring, model: Model) -> Elastic:
    """Springs between places, one for each pair, or one for each place to the ground.

    Two places apart from each other act in the middle between them, each through a rigid arm of its own rotation, so
    that a rigid motion of both strains nothing.
    """
    where = f"parts.{part.name}"
    values = np.array([part.stiffness, part.damping], dtype=np.float64)
    if not (np.isfinite(values) & (values >= 0)).all() or not values.any():
        raise InputError(
            where, got="stiffness and damping without one positive value", expected="values >= 0, one above"
        )
    kept = np.flatnonzero(values.any(axis=0))
    first = _places(f"{where}.between", part.a, model)
    if part.b is None:
        matrices = [_point_rows(point, np.zeros(3), model)[kept] for point in first]
    else:
        second = _places(f"{where}.between", part.b, model)
        if len(first) != len(second) and min(len(first), len(second)) != 1:
            raise InputError(
                f"{where}.between", got=f"{len(first)} and {len(second)} places", expected="as many, or one of either"
            )
        count = max(len(first), len(second))
        matrices = []
        for one, other in zip(first * (count // len(first)), second * (count // len(second)), strict=True):
            half = (other.position - one.position) / 2.0
            matrices.append((_point_rows(one, half, model) - _point_rows(other, -half, model))[kept])
    count = len(matrices)
    directions = np.zeros((_SIX, 3))
    directions[:3] = np.eye(3)
    return Elastic(
        part.name,
        csr_array(vstack(matrices)),
        np.tile(values[0, kept], count),
        np.tile(values[1, kept], count),
        np.tile(directions[kept], (count, 1)),
        grounded=part.b is None,
    )


def lumped_mass(part: Mass, model: Model) -> Inert:
    """A particle at every place of a point; the mass is that of each."""
    where = f"parts.{part.name}"
    if part.per != "total":
        raise InputError(f"{where}.mass", got=f"a mass per {part.per} at a point", expected="a mass in kg")
    _positive_mass(part)
    points = _places(f"{where}.at", part.at or "", model)
    rows = csr_array(vstack([_point_rows(point, np.zeros(3), model)[:3] for point in points]))
    return Inert(part.name, rows, np.full(rows.shape[0], part.mass))


def spread_mass(part: Mass, model: Model, tolerance: float) -> Inert:
    """Mass over an area or along lines of a plate, or along a frame; it follows the mid-surface or the axis."""
    where = f"parts.{part.name}"
    _positive_mass(part)
    region = part.region or Region("whole")
    frame = model.frames.get(part.on or "")
    if frame is not None and region.kind != "whole":
        raise InputError(f"{where}.region", got=f"a {region.kind} of a frame", expected="all of the frame")
    spread = "area" if region.kind in ("whole", "rectangle") and frame is None else "length"
    if part.per not in ("total", spread):
        raise InputError(
            f"{where}.mass",
            got=f"a mass per {part.per} over a {region.kind if frame is None else 'frame'}",
            expected=f"kg or per {spread}",
        )
    if frame is not None:
        places, shares = gauss_interval(ORDER)
        bars = np.repeat(np.arange(len(frame.bars)), ORDER)
        weights = frame.lengths[bars] * np.tile(shares, len(frame.bars))
        nodes, rows = frame_rows(frame, bars, np.tile(places, len(frame.bars)))
    else:
        plate = _plate(f"{where}.on", part.on or "", model)
        local, weights = _region_points(f"{where}.region", plate, region, tolerance)
        nodes, rows = plate_rows(plate, local)
    mass = part.mass * weights / (weights.sum() if part.per == "total" else 1.0)
    return Inert(part.name, sparse_rows(nodes, rows[:, :3], model.mesh.n_nodes), np.repeat(mass, 3))


def support(item: Support, model: Model, tolerance: float) -> Tie:
    """Held displacements of the nodes of an edge, a line, a point or a whole part."""
    where = f"supports.{item.name}"
    if item.at is not None:
        points = _places(f"{where}.at", item.at, model)
        held = _listed(where, {"simple": DIRECTIONS[:3], "clamped": DIRECTIONS}.get(str(item.fix), item.fix))
        rows = csr_array(vstack([_point_rows(point, np.zeros(3), model)[held] for point in points]))
        return Tie(item.name, rows, np.tile(_AXES[held], (len(points), 1)), grounded=True)
    name = item.on or ""
    n_nodes = model.mesh.n_nodes
    if item.edge is None and item.line is None:
        if name not in model.mesh.nodes:
            raise InputError(f"{where}.on", got=f"'{name}'", expected=f"a part: {', '.join(model.mesh.nodes)}")
        listed = {"simple": DIRECTIONS[:3], "clamped": DIRECTIONS}.get(str(item.fix), item.fix)
        components = np.eye(N_COMPONENTS)[_listed(where, listed)]
        if item.fix == "clamped" and name in model.plates:
            components = np.eye(N_COMPONENTS)
        return _held(item.name, model.mesh.nodes[name], components, n_nodes)
    plate = _plate(f"{where}.on", name, model)
    pieces = []
    for nodes, along in _edges(where, item, plate, tolerance):
        if isinstance(item.fix, tuple):
            components = np.eye(N_COMPONENTS)[_listed(where, item.fix)]
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

    A rigid joint of two bfs16 plates along a line also makes the slope across the line continuous between nodes.
    """
    where = f"joints.{item.name}"
    pairs = _pairs(item, model, tolerance)
    springy = _listed(where, tuple(item.stiffness))
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
    tie = _relative(item.name, pairs, components, model) if stiff else None
    if tie is not None and item.kind == "rigid" and not springy:
        twist = _twist_rows(item, model, pairs)
        rows = csr_array(vstack([tie.rows, twist]))
        tie = Tie(item.name, rows, np.concatenate([tie.directions, np.zeros((twist.shape[0], 3))]), grounded=False)
    if not springy:
        return tie, None
    relative = _relative(item.name, pairs, np.eye(N_COMPONENTS)[springy], model)
    stiffness = np.tile(values, len(pairs))
    elastic = Elastic(
        item.name, relative.rows, stiffness, np.zeros(stiffness.size), relative.directions, grounded=False
    )
    return tie, elastic


_AXES = np.concatenate([np.eye(3), np.zeros((3, 3))])


def _held(name: str, nodes: Integers, components: Floats, n_nodes: int) -> Tie:
    rows = node_rows(np.repeat(nodes, len(components)), np.tile(components, (len(nodes), 1)), n_nodes)
    return Tie(name, rows, np.tile(components[:, :3], (len(nodes), 1)), grounded=True)


def _relative(name: str, pairs: Integers, components: Floats, model: Model) -> Tie:
    """Motion of the first node less that of the second, where the second is: nodes that meet within the tolerance are
    joined by the small arm between them, so that a rigid motion of both violates nothing."""
    n_nodes = model.mesh.n_nodes
    arms = model.mesh.points[pairs[:, 1]] - model.mesh.points[pairs[:, 0]]
    carried = np.tile(components, (len(pairs), 1, 1))
    carried[..., 3:_SIX] += np.cross(arms[:, None], components[None, :, :3])
    one = node_rows(np.repeat(pairs[:, 0], len(components)), carried.reshape(-1, N_COMPONENTS), n_nodes)
    other = _held(name, pairs[:, 1], components, n_nodes)
    return Tie(name, csr_array(one - other.rows), other.directions, grounded=False)


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
    distances, nearest = KDTree(model.mesh.points[second]).query(model.mesh.points[first], distance_upper_bound=reach)
    met = np.isfinite(distances)
    if not met.any():
        raise InputError(f"joints.{item.name}", got=f"{item.a} and {item.b} without a common node", expected="a touch")
    return np.stack([first[met], second[np.asarray(nearest)[met]]], axis=1)


def _edges(where: str, item: Support, plate: PlateMesh, tolerance: float) -> list[tuple[Integers, int]]:
    """Nodes of each held edge or line, and the plate axis it runs along."""
    if item.line is not None:
        box = region_box(f"{where}.line", plate.part, Region("line", line=item.line), tolerance)
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


def _region_points(where: str, plate: PlateMesh, region: Region, tolerance: float) -> tuple[Floats, Floats]:
    box = region_box(where, plate.part, region, tolerance)
    if region.kind in ("whole", "rectangle"):
        return area_points(plate.x, plate.y, box, tolerance, ORDER)
    pieces = [line_points(plate.x, plate.y, ends, tolerance, ORDER) for ends in region_lines(region, box)]
    return np.concatenate([points for points, _ in pieces]), np.concatenate([weights for _, weights in pieces])


def _point_rows(point: Point, arm: Floats, model: Model) -> csr_array:
    """Six rows of the motion at the end of a rigid arm from a point: u + r x arm."""
    motion = np.eye(_SIX)
    x, y, z = arm
    motion[0, 4], motion[0, 5], motion[1, 3], motion[1, 5], motion[2, 3], motion[2, 4] = z, -y, -z, x, y, -x
    columns = point.nodes * N_COMPONENTS + point.components
    weights = motion @ point.weights
    entries = (weights.ravel(), (np.repeat(np.arange(_SIX), len(columns)), np.tile(columns, _SIX)))
    return csr_array(entries, shape=(_SIX, model.mesh.n_nodes * N_COMPONENTS))


def _places(where: str, name: str, model: Model) -> tuple[Point, ...]:
    known = {point.name for point in model.structure.points} | set(model.points)
    if name not in known:
        raise InputError(where, got=f"'{name}'", expected=f"a point: {', '.join(sorted(known)) or 'there is none'}")
    return model.places(name)


def _plate(where: str, name: str, model: Model) -> PlateMesh:
    if name not in model.plates:
        raise InputError(where, got=f"'{name}'", expected=f"a plate: {', '.join(model.plates) or 'there is none'}")
    return model.plates[name]


def _listed(where: str, directions: object) -> list[int]:
    if not isinstance(directions, tuple) or not set(directions) <= set(DIRECTIONS):
        raise InputError(where, got=f"{directions}", expected=f"directions out of {', '.join(DIRECTIONS)}")
    return [DIRECTIONS.index(direction) for direction in directions]


def _positive_mass(part: Mass) -> None:
    if not part.mass > 0:
        raise InputError(f"parts.{part.name}.mass", got=f"{part.mass:g}", expected="a positive mass")
