"""What holds parts: supports, and joints between parts, as equations on nodal components."""

from __future__ import annotations

from itertools import combinations
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_array, kron, vstack

from femstruct.arrays import Floats, Integers
from femstruct.conventions import DIRECTIONS, N_COMPONENTS
from femstruct.errors import InputError, list_some
from femstruct.model.attached import same_file
from femstruct.model.materials import WALLS_AT
from femstruct.model.model import Model, component_numbers, places_of, point_rows
from femstruct.model.part import EdgePoints, Elastic, Meshed, Tie
from femstruct.model.plates_and_bars import (
    box_pairs,
    coincident_pairs,
    contact,
    joined_nodes,
    lengths_of,
    refuse_lengths,
    sliding,
    turning_rows,
)
from femstruct.model.regions import node_rows, sparse_rows
from femstruct.model.seams import Seam
from femstruct.model.structure import ABOUT, ACROSS, HARD, SIMPLE, Joint, Support
from femstruct.model.unlike_meshes import (
    Line,
    bars_on_cells,
    feet_beside_nodes,
    in_components,
    unlike_area,
    unlike_line,
)

# ----------------------------------------------------------------------------------------------------------------------
# Edges on springs and edges with walls: what resists along an edge of a plate, slab or shell, per length of it.
# ----------------------------------------------------------------------------------------------------------------------

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
        expected = f"a part with nodes: {list_some(model.parts)}"
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


# ----------------------------------------------------------------------------------------------------------------------
# Parts of one mesh file that share nodes there: they are joined by that, as in the program that wrote the file.
# ----------------------------------------------------------------------------------------------------------------------


class SharedNodes(NamedTuple):
    """Two parts of one file and the nodes they share there, as numbers of both [m, 2]."""

    a: str
    b: str
    pairs: Integers

    @property
    def name(self) -> str:
        """What the force between them is called."""
        return f"{self.a} and {self.b}"


def shared_nodes(model: Model) -> tuple[SharedNodes, ...]:
    """All pairs of parts of a mesh file that share nodes and that no joint or seam of the model joins."""
    joined = {frozenset((joint.a, joint.b)) for joint in model.structure.joints}
    joined |= {frozenset((one.on, one.onto)) for one in model.structure.constraints if isinstance(one, Seam)}
    found = []
    own = {name: of for name, part in model.parts.items() if len(part.quads) and (of := part.of_file) is not None}
    for a, b in combinations(own, 2):
        if frozenset((a, b)) in joined or not same_file(own[a][0], own[b][0]):
            continue
        rows, first, second = np.intersect1d(own[a][1], own[b][1], return_indices=True)
        pairs = np.stack([model.parts[a].nodes[first], model.parts[b].nodes[second]], axis=1)
        free = np.isin(pairs[:, 0], model.parts[a].joinable) & np.isin(pairs[:, 1], model.parts[b].joinable)
        if (kept := free & (rows >= 0)).any():
            found.append(SharedNodes(a, b, pairs[kept]))
    return tuple(found)


def shared_tie(shared: SharedNodes, model: Model) -> Tie:
    """Displacements of shared nodes are the same, and their rotations where both parts have them."""
    turns = model.parts[shared.a].has_rotations and model.parts[shared.b].has_rotations
    components = np.eye(6 if turns else 3, N_COMPONENTS)
    one, other = (
        node_rows(np.repeat(nodes, len(components)), np.tile(components, (len(nodes), 1)), model.mesh.n_nodes)
        for nodes in shared.pairs.T
    )
    directions = np.tile(components[:, :3], (len(shared.pairs), 1))
    return Tie(shared.name, csr_array(one - other), directions, grounded=False)


# ----------------------------------------------------------------------------------------------------------------------
# What holds parts.
# ----------------------------------------------------------------------------------------------------------------------

_SIX = 6
TOUCH = 4.0  # tolerances: places of two parts that are nearer touch, as in `coincident_pairs`
CARRIED = 3  # nodes of a solid that hold the rotation of the one they follow
_SHIFTS, _ROTATIONS = [0, 1, 2], [3, 4, 5]
_AXES = np.concatenate([np.eye(3), np.zeros((3, 3))])


def support(item: Support, model: Model, tolerance: float) -> Tie:
    """Held displacements of the nodes of an edge, a line, a point or a whole part."""
    where = f"supports.{item.name}"
    if item.at is not None:
        points = places_of(f"{where}.at", item.at, model)
        held = component_numbers(where, _named(item))
        rows = csr_array(vstack([point_rows(point, np.zeros(3), model)[held] for point in points]))
        return Tie(item.name, rows, np.tile(_AXES[held], (len(points), 1)), grounded=True)
    name, n_nodes = item.on or "", model.mesh.n_nodes
    if name not in model.parts:
        raise InputError(f"{where}.on", got=f"'{name}'", expected=f"a part with nodes: {list_some(model.parts)}")
    part = model.parts[name]
    _refuse_turns(item, part)
    if item.region is not None:
        held = component_numbers(where, _named(item))
        nodes = part.within(f"{where}.{item.region.kind}", item.region, tolerance)
        tie = _held(item.name, nodes, np.eye(N_COMPONENTS)[held], n_nodes)
        if item.fix != HARD:
            return tie
        turned, about = part.hard_edges(item, tolerance)
        rows = csr_array(vstack([tie.rows, node_rows(turned, about, n_nodes)]))
        return Tie(item.name, rows, np.concatenate([tie.directions, np.zeros((len(turned), 3))]), grounded=True)
    if item.edge is None and item.line is None:
        components = (
            part.clamped if item.fix == "clamped" else np.eye(N_COMPONENTS)[component_numbers(where, _named(item))]
        )
        return _held(item.name, part.nodes, components, n_nodes)
    pieces = []
    for nodes, components in part.edges(item, tolerance):
        if isinstance(item.fix, tuple):
            components = np.eye(N_COMPONENTS)[component_numbers(where, item.fix)]
        pieces.append(_held(item.name, nodes, components, n_nodes))
    return Tie(
        item.name,
        csr_array(vstack([piece.rows for piece in pieces])),
        np.concatenate([piece.directions for piece in pieces]),
        grounded=True,
    )


def _refuse_turns(item: Support, part: Meshed) -> None:
    """Raise InputError for rotations that are held of nodes that have none: nothing would be held."""
    turns = [one for one in item.fix if one in DIRECTIONS[3:]] if isinstance(item.fix, tuple) else []
    if turns and not part.has_rotations:
        raise InputError(
            f"supports.{item.name}.fix",
            got=f"{', '.join(turns)} of {part.name}, whose nodes have no rotations",
            expected="directions out of x, y, z, which are all that nodes of solids have",
            do="write [x, y, z]: held at nodes apart, it cannot turn",
        )


def _named(item: Support) -> object:
    """Directions held at a point or of a whole part."""
    if item.fix == "roller":
        where = f"supports.{item.name}.fix"
        raise InputError(where, got="a roller that is no edge or line", expected="directions", do="write [z]")
    if item.fix == HARD and item.region is None:
        where = f"supports.{item.name}.fix"
        raise InputError(where, got="simple hard that is no edge", expected="a set or a box of a slab or shell")
    return {**dict.fromkeys(SIMPLE, DIRECTIONS[:3]), "clamped": DIRECTIONS}.get(str(item.fix), item.fix)


Joined = tuple[Tie | None, Elastic | None]  # what a joint holds at zero, and what it springs


def joint(item: Joint, model: Model, tolerance: float) -> Joined:
    """Equations, and springs where a stiffness is given, between the coincident nodes of two parts.

    A block takes along the nodes of the other part that lie in it. A rigid joint of two parts along a line also
    equates what both have there beside their motion (`Meshed.along`); what lies on a block is flat (`Meshed.flat`).

    Bars on a plate that stretches are tied to it as `femstruct.model.plates_and_bars` says.
    """
    parts = _joined_parts(item, model)
    springs = _springs_of(item)
    unlike = _across_unlike_meshes(item, parts, springs, model, tolerance)
    return _at_nodes(item, parts, springs, model, tolerance) if unlike is None else unlike


def _joined_parts(item: Joint, model: Model) -> tuple[Meshed, Meshed]:
    """The two parts of a joint. Raises InputError for one that is unknown, and for nodes without rotations in a joint
    that holds these: only the surface of one solid resists the rotation of what is joined to it."""
    where = f"joints.{item.name}"
    for end in (item.a, item.b):
        if end not in model.parts:
            raise InputError(where, got=f"'{end}'", expected=f"a part with nodes: {list_some(model.parts)}")
    parts = model.parts[item.a], model.parts[item.b]
    hinged = [part for part in parts if not part.has_rotations]
    if item.kind != "pinned" and (len(hinged) > 1 or not all(part.has_surface for part in hinged)):
        names = " and ".join(part.name for part in hinged)
        raise InputError(where, got=f"{item.kind}, and nodes of {names} that have no rotations", expected="pinned")
    return parts


def _springs_of(item: Joint) -> tuple[list[int], Floats]:
    """Directions in which a joint is a spring, out of six, and the stiffness of each."""
    where = f"joints.{item.name}"
    springy = component_numbers(where, tuple(item.stiffness))
    values = np.array([item.stiffness[DIRECTIONS[number]] for number in springy])
    if not (values >= 0).all():
        raise InputError(f"{where}.stiffness", got=f"{values.min():g}", expected="values >= 0")
    return springy, values


def _across_unlike_meshes(
    item: Joint, parts: tuple[Meshed, Meshed], springs: tuple[list[int], Floats], model: Model, tolerance: float
) -> Joined | None:
    """The joint where the meshes do not match: along a line of plates and frames, of bars on cells between their nodes,
    over an area of two solids. None where nodes coincide, or are joined by rigid arms (`reach`)."""
    rotate = [part.has_rotations for part in parts]
    solids = not any(rotate) and all(part.has_surface for part in parts)
    if item.reach is not None or not (all(rotate) or solids):
        return None
    nodes = joined_nodes(item, item.a, model, tolerance), joined_nodes(item, item.b, model, tolerance)
    if solids:
        area = unlike_area(parts, nodes, TOUCH * tolerance, model.mesh.points)
        return None if area is None else _over_area(item, area, springs)
    line = unlike_line(parts, nodes, TOUCH * tolerance, model.mesh.points)
    if line is not None:
        return _along_line(item, line, parts, springs)
    for side in (0, 1):
        both = parts[side], parts[1 - side]
        feet = feet_beside_nodes(*both, nodes[side], nodes[1 - side], TOUCH * tolerance)
        if len(feet):
            return bars_on_cells(item, both, feet, springs, model)
    return None


def _at_nodes(
    item: Joint, parts: tuple[Meshed, Meshed], springs: tuple[list[int], Floats], model: Model, tolerance: float
) -> Joined:
    """The joint of nodes that coincide, lie in a block or are within reach of each other."""
    blocks = any(part.box is not None for part in parts)
    pairs = box_pairs(item, model, tolerance) if blocks else coincident_pairs(item, model, tolerance)
    parts = parts[0].around(pairs[:, 0]), parts[1].around(pairs[:, 1])
    at = _touched_places(parts, pairs, model.mesh.points)
    springy, values = springs
    ties = _equal_motion(item, parts, pairs, at, springy, model)
    if item.kind == "sliding":
        across, along = sliding(item, parts, pairs, at, model)
        return _together(item.name, [across, *ties]), along
    tie = _together(item.name, ties)
    held = tie if len(tie.directions) else None
    if not springy:
        return held, None
    which, shares = np.arange(len(pairs)), np.ones(len(pairs))
    if item.per == "length":
        which, shares = lengths_of(item, pairs, parts, model.mesh.points)
    sprung = _relative(item.name, pairs[which], at[which], np.eye(N_COMPONENTS)[springy], model)
    stiffness = np.outer(shares, values).ravel()
    nothing = np.zeros(stiffness.size)
    return held, Elastic(item.name, sprung.rows, stiffness, nothing, sprung.directions, grounded=False)


def _touched_places(parts: tuple[Meshed, Meshed], pairs: Integers, points: Floats) -> Floats:
    """Where two parts move alike [m, 3] [m]; their nodes have rigid arms to there."""
    solid, bars = _side_of_solid(parts), _side_of_bars(parts)
    if solid is not None:
        return points[pairs[:, solid]]  # its nodes cannot turn, so they carry no arm
    if bars is not None:
        return contact(_led_by(bars, pairs), parts[bars], parts[1 - bars], points)
    # Where the second node is; a block's is far from what touches it, so then where the other part's is.
    return points[pairs[:, 0 if parts[1].box is not None and parts[0].box is None else 1]]


def _equal_motion(
    item: Joint, parts: tuple[Meshed, Meshed], pairs: Integers, at: Floats, springy: list[int], model: Model
) -> list[Tie]:
    """Shifts that pinned and rigid joints hold at zero, and what rigid and sliding ones hold of the rotations."""
    # Equations along the axes of a plate couple fewer unknowns than along global axes.
    axes = next((part.own_axes for part in parts if part.own_axes is not None), np.eye(3))
    tied = [np.zeros((0, N_COMPONENTS)), *([_tied(_SHIFTS, springy, axes)] if item.kind != "sliding" else [])]
    solid, bars, n_nodes = _side_of_solid(parts), _side_of_bars(parts), model.mesh.n_nodes
    rows: list[csr_array]
    if item.kind == "pinned":
        rows = []
    elif solid is not None:
        rows = [_turned_rows(_led_by(1 - solid, pairs), parts[solid], springy, n_nodes)]
    elif bars is not None:
        rows = turning_rows(_led_by(bars, pairs), parts[bars], parts[1 - bars], springy, n_nodes)
    else:
        tied.append(_tied(_ROTATIONS, springy, axes))
        beside = _flat_rows if any(part.box is not None for part in parts) else _common_rows
        rows = [] if springy else [beside(item, model, pairs)]
    ties = [_relative(item.name, pairs, at, np.concatenate(tied), model)]
    return ties + [Tie(item.name, turns, np.zeros((turns.shape[0], 3)), grounded=False) for turns in rows]


def _side_of_solid(parts: tuple[Meshed, Meshed]) -> int | None:
    """Which of two parts is a solid, whose nodes have no rotations; of two solids the first."""
    return next((side for side in (0, 1) if not parts[side].has_rotations), None)


def _side_of_bars(parts: tuple[Meshed, Meshed]) -> int | None:
    """Which of two parts has bars, where the other is a plate that stretches."""
    return next((side for side in (0, 1) if len(parts[side].lines) and parts[1 - side].drilling is not None), None)


def _led_by(side: int, pairs: Integers) -> Integers:
    """Pairs of nodes with those of one part first."""
    return pairs if side == 0 else pairs[:, ::-1]


def _along_line(item: Joint, line: Line, parts: tuple[Meshed, Meshed], springs: tuple[list[int], Floats]) -> Joined:
    """A joint along a line on which the meshes of two parts do not match: every node of one follows the other."""
    springy, values = springs
    count = len(line.nodes)
    axes = next((part.own_axes for part in parts if part.own_axes is not None), np.eye(3))
    tied = np.zeros((count, 0, N_COMPONENTS))
    if item.kind == "sliding":
        across = np.zeros((count, 2, N_COMPONENTS))
        across[..., :3] = np.linalg.svd(line.along[:, None])[2][:, 1:]
        tied = across
    else:
        shifts = _tied(_SHIFTS, springy, axes)
        tied = np.broadcast_to(shifts, (count, *shifts.shape))
    if item.kind != "pinned":
        turns = _tied(_ROTATIONS, springy, axes)
        tied = np.concatenate([tied, np.broadcast_to(turns, (count, *turns.shape))], axis=1)
    held = (
        Tie(item.name, in_components(line.rows, tied), tied[..., :3].reshape(-1, 3), grounded=False)
        if tied.size
        else None
    )
    if item.kind == "sliding":
        slides = np.zeros((count, 1, N_COMPONENTS))
        slides[:, 0, :3] = line.along
        stiffness = item.slip * line.lengths
        nothing = np.zeros(count)
        return held, Elastic(
            item.name, in_components(line.rows, slides), stiffness, nothing, line.along, grounded=False
        )
    if not springy:
        return held, None
    free = np.eye(N_COMPONENTS)[springy]
    rows, shares = (line.places, line.weights) if item.per == "length" else (line.rows, np.ones(count))
    stiffness = np.outer(shares, values).ravel()
    directions = np.tile(free[:, :3], (len(shares), 1))
    sprung = in_components(rows, free)
    return held, Elastic(item.name, sprung, stiffness, np.zeros(stiffness.size), directions, grounded=False)


def _over_area(item: Joint, area: csr_array, springs: tuple[list[int], Floats]) -> Joined:
    """A joint over an area on which the meshes of two solids do not match: every node of one follows the other."""
    refuse_lengths(item, item.per == "length")
    springy, values = springs
    count = area.shape[0]
    held, free = (np.eye(N_COMPONENTS)[some] for some in ([one for one in _SHIFTS if one not in springy], springy))
    rows = [csr_array(kron(area, components)) for components in (held, free)]
    directions = [np.tile(components[:, :3], (count, 1)) for components in (held, free)]
    tie = Tie(item.name, rows[0], directions[0], grounded=False) if len(held) else None
    if not springy:
        return tie, None
    stiffness = np.tile(values, count)
    nothing = np.zeros(stiffness.size)
    return tie, Elastic(item.name, rows[1], stiffness, nothing, directions[1], grounded=False)


def _together(name: str, ties: list[Tie]) -> Tie:
    directions = np.concatenate([tie.directions for tie in ties])
    return Tie(name, csr_array(vstack([tie.rows for tie in ties])), directions, grounded=False)


def _turned_rows(pairs: Integers, solid: Meshed, springy: list[int], n_nodes: int) -> csr_array:
    """Rotations of nodes less those of the surface of a solid around the nodes they are joined to [m, n_nodes * 7].

    A node that carries three nodes of the solid or more turns with them already.
    """
    joined, times = np.unique(pairs[:, 0], return_counts=True)
    pairs = pairs[np.isin(pairs[:, 0], joined[times < CARRIED])]
    if not len(pairs):
        return csr_array((0, n_nodes * N_COMPONENTS))
    held = [number for number in _ROTATIONS if number not in springy]
    each = 3 * np.arange(len(pairs))[:, None] + np.array(held, dtype=np.int64) - 3
    own = node_rows(np.repeat(pairs[:, 0], len(held)), np.tile(np.eye(N_COMPONENTS)[held], (len(pairs), 1)), n_nodes)
    return csr_array(own - solid.turned(pairs[:, 1], n_nodes)[each.ravel()])


def _tied(kind: list[int], springy: list[int], axes: Floats) -> Floats:
    """Components [m, 7] of shifts or rotations that a joint holds at zero: along the axes, or, where there are springs
    in some of them, along the global axes of the others."""
    rows = np.zeros((3, N_COMPONENTS))
    rows[:, kind] = np.eye(3) if set(springy) & set(kind) else axes
    return rows[[number not in springy for number in kind]]


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
