"""Findings on joints: pieces that nothing holds together, what is open, springs as many as the mesh has nodes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from math import gcd
from typing import Final, NamedTuple

import numpy as np
import scipy
from scipy.sparse import coo_array, csr_array, vstack
from scipy.sparse.csgraph import connected_components

from femstruct.arrays import Floats, Integers, freeze, frozen, frozen_integers
from femstruct.conventions import DIRECTIONS, N_COMPONENTS
from femstruct.errors import Finding
from femstruct.model.flat_cells import area_vectors
from femstruct.model.model import Model, places_of
from femstruct.model.part import Meshed
from femstruct.model.plates_and_bars import coincident_pairs, joined_nodes
from femstruct.model.regions import distance_to_rectangle, distance_to_segments, to_rectangle
from femstruct.model.structure import Joint
from femstruct.model.supports_and_joints import SharedNodes, shared_nodes
from femstruct.model.unlike_meshes import bow_between, off_near, rim_of
from femstruct.parts.foundation import Foundation
from femstruct.parts.plate import plates_of
from femstruct.parts.shell import ShellMesh
from femstruct.parts.spring import Spring

# ----------------------------------------------------------------------------------------------------------------------
# What holds together and what is held: the pieces of a structure that nothing joins, and how each can still move.
# ----------------------------------------------------------------------------------------------------------------------

FREE = 1e-6  # of what the supports resist most: a rigid motion they resist by less is free
TOUCHING = 1e-6  # of the structure's size
MOST_ROWS = 1000
STIFFER_NOTABLE, STIFFER_SEVERE = 1e-2, 5e-2  # of a frequency
_CLAMPED = (3.926602 / np.pi) ** 2 - 1.0  # of a frequency: a clamp in place of one of two hinges


@dataclass(frozen=True, eq=False)
class Piece:
    """A part of a structure, or several, that joints, layers or springs hold together.

    parts : their names, in order. nodes [n] : of the mesh. mass [kg].
    free [f, 6] : its rigid motions that no support resists, in terms of six: shifts along x, y, z, and rotations about
    the middle of the structure, scaled to move what is as far away as it is large by one. weight [6] : mass times rise
    in each of the six [kg].
    """

    parts: tuple[str, ...]
    nodes: Integers
    mass: float
    free: Floats
    weight: Floats

    def __post_init__(self) -> None:
        freeze(
            self,
            nodes=frozen_integers("Piece nodes", self.nodes, (None,)),
            free=frozen("Piece free", self.free, (None, 6)),
            weight=frozen("Piece weight", self.weight, (6,)),
        )

    @property
    def falls(self) -> bool:
        """Whether its own weight sets it in motion, since the supports cannot balance it."""
        return bool(np.linalg.norm(self.free @ self.weight) > FREE * np.linalg.norm(self.weight))


def pieces(model: Model, joined: Iterable[tuple[str, str]] = ()) -> tuple[Piece, ...]:
    """The pieces of a model, the heaviest first.

    Parameters
    ----------
    joined : Iterable[tuple[str, str]]
        Pairs of points by name that something else holds together, as contacts and links of a study do.

    Examples
    --------
    >>> from femstruct.model.materials import Material
    >>> from femstruct.model.mesher import mesh_structure
    >>> from femstruct.model.structure import Structure, Support
    >>> from femstruct.parts.plate import Plate
    >>> steel = Material("steel", E=210e9, nu=0.3, rho=8000.0)
    >>> one = Plate("one", steel, 0.003, origin=(0.0, 0.0, 0.0), size=(0.5, 0.4), mesh=(2, 2))
    >>> two = Plate("two", steel, 0.002, origin=(0.0, 0.0, 0.3), size=(0.5, 0.4), mesh=(2, 2))
    >>> held = Support("edge", "clamped", on="one", edge="x0")
    >>> model = mesh_structure(Structure("two", (one, two), supports=(held,)))
    >>> [(piece.parts, len(piece.free)) for piece in pieces(model)]
    [(('one',), 0), (('two',), 6)]
    """
    n_nodes = model.mesh.n_nodes
    labels = _labels(model, joined)
    motion = _rigid_motions(model)
    resisted = [tie.rows for tie in model.ties if tie.grounded]
    resisted += [
        _some(spring.rows[np.flatnonzero(spring.stiffness > 0)]) for spring in model.elastics if spring.grounded
    ]
    held = csr_array(vstack([csr_array((0, n_nodes * N_COMPONENTS)), *resisted]))
    held.eliminate_zeros()
    held = held[np.flatnonzero(np.diff(held.indptr))]
    owner = labels[held.indices[held.indptr[:-1]] // N_COMPONENTS]
    directions = held @ motion
    weights = _weights(model, motion)
    found = []
    for label in range(int(labels.max()) + 1):
        nodes = np.flatnonzero(labels == label)
        parts = tuple(name for name, numbers in model.mesh.nodes.items() if (labels[numbers] == label).any())
        weight = np.array(weights[nodes].sum(axis=0))
        found.append(Piece(parts, nodes, float(weight[2]), _null(directions[owner == label]), weight))
    return tuple(sorted(found, key=lambda piece: -piece.mass))


def place_of_touch(model: Model, one: Piece, other: Piece) -> Floats | None:
    """A place [3] where nodes of one of two pieces lie on the other; None where none do."""
    within = TOUCHING * _size(model)
    for here, there in ((one, other), (other, one)):
        places = model.mesh.points[here.nodes]
        distances = np.asarray(scipy.spatial.KDTree(model.mesh.points[there.nodes]).query(places)[0])
        for plate in (plate for plate in plates_of(model) if plate.name in there.parts):
            local = to_rectangle(plate.part, plate.axes, places)
            distances = np.minimum(distances, distance_to_rectangle(local, plate.part.size))
        if distances.min() <= within:
            nearest: Floats = places[int(np.argmin(distances))]
            return nearest
    return None


def held_directions(model: Model) -> Floats:
    """Sum of d d^T over the unit directions d in which supports hold each node [n_nodes, 3, 3]."""
    found = np.zeros((model.mesh.n_nodes, 3, 3))
    for tie in model.ties:
        if not tie.grounded:
            continue
        rows = _nonzero(tie.rows)
        node, component = np.divmod(rows.col, N_COMPONENTS)
        turning = np.zeros(tie.rows.shape[0], dtype=bool)
        turning[rows.row[component >= 3]] = True
        first = np.full(tie.rows.shape[0], -1)
        first[rows.row] = node
        several = np.zeros(tie.rows.shape[0], dtype=bool)
        several[rows.row[first[rows.row] != node]] = True
        kept = ~(turning | several) & (first >= 0)
        directions = np.zeros((tie.rows.shape[0], 3))
        straight = component < 3
        directions[rows.row[straight], component[straight]] = rows.data[straight]
        directions = directions[kept]
        np.add.at(found, first[kept], directions[:, :, None] * directions[:, None, :])
    return found


def held_with_joined(model: Model) -> Floats:
    """Directions in which supports hold each node [n_nodes, 3, 3]; nodes in one place, as joined ones, share them."""
    held = held_directions(model)
    size = float(np.ptp(model.mesh.points, axis=0).max())
    pairs = scipy.spatial.KDTree(model.mesh.points).query_pairs(TOUCHING * size, output_type="ndarray")
    shared = held.copy()
    for first, second in (pairs.T, pairs.T[::-1]):
        np.add.at(shared, first, held[second])
    return shared


def _labels(model: Model, joined: Iterable[tuple[str, str]]) -> Integers:
    """The piece of every node [n_nodes], from a graph of the nodes and of all that has a part in several of them."""
    n_nodes = model.mesh.n_nodes
    groups = [group for part in model.parts.values() for group in part.held_together]
    groups += [np.concatenate([place.nodes for name in pair for place in model.places(name)]) for pair in joined]
    layers = {part.name: part for part in model.structure.parts if isinstance(part, Foundation)}
    groups += [
        np.concatenate([model.mesh.nodes[name][:1] for name in (layer.on, layer.to) if name is not None])
        for layer in layers.values()
    ]
    numbers = np.repeat(np.arange(len(groups)), [len(group) for group in groups])
    nodes = np.concatenate([np.zeros(0, np.int64), *groups])
    springs = [elastic.rows for elastic in model.elastics if elastic.name not in layers]
    for rows in (*(tie.rows for tie in model.ties), *springs):
        entries = _nonzero(rows)
        first = int(numbers[-1]) + 1 if len(numbers) else 0
        numbers = np.concatenate([numbers, first + entries.row])
        nodes = np.concatenate([nodes, entries.col // N_COMPONENTS])
    size = n_nodes + (int(numbers.max()) + 1 if len(numbers) else 0)
    graph = coo_array((np.ones(len(nodes), dtype=np.int8), (nodes, n_nodes + numbers)), shape=(size, size))
    labels = connected_components(graph, directed=False)[1][:n_nodes]
    _, found = np.unique(labels, return_inverse=True)
    return found.astype(np.int64)


def _some(rows: csr_array) -> csr_array:
    """A thousand or so of the rows of a layer, spread over all of it: they resist the same rigid motions."""
    step = max(1, rows.shape[0] // MOST_ROWS)
    while gcd(step, 6) > 1:  # a place has one to three rows, of different directions: all of them have their turn
        step += 1
    return csr_array(rows[::step])


def _nonzero(rows: csr_array) -> coo_array:
    """The entries of a matrix that are not zero; zeros may be stored in it."""
    entries = coo_array(rows)
    used = entries.data != 0.0
    return coo_array((entries.data[used], (entries.row[used], entries.col[used])), shape=rows.shape)


def _size(model: Model) -> float:
    corners = [model.mesh.points, *(part.bounds for part in model.parts.values())]
    return float(np.ptp(np.concatenate(corners), axis=0).max())


def _rigid_motions(model: Model) -> Floats:
    """Six rigid motions of all nodal components [n_nodes * 7, 6]; a rotation moves what is a size away by one."""
    points, size = model.mesh.points, _size(model) or 1.0
    arms = (points - (points.min(axis=0) + points.max(axis=0)) / 2.0) / size
    motion = np.zeros((len(points), N_COMPONENTS, 6))
    for axis, unit in enumerate(np.eye(3)):
        motion[:, axis, axis] = 1.0
        motion[:, :3, 3 + axis] = np.cross(unit, arms)
        motion[:, 3 + axis, 3 + axis] = 1.0 / size
    return motion.reshape(-1, 6)


def _weights(model: Model, motion: Floats) -> Floats:
    """Mass times the rise of every rigid motion, at the nodes [n_nodes, 6] [kg]."""
    lumps = np.zeros(model.mesh.n_nodes)
    for part in model.parts.values():
        lumps[part.nodes] = part.lumps
    weights = lumps[:, None] * motion.reshape(-1, N_COMPONENTS, 6)[:, 2]
    for inert in model.inerts:
        rises = slice(2, 3 * inert.n_places, 3)
        upwards = csr_array(inert.rows[rises])
        upwards.eliminate_zeros()
        some = np.flatnonzero(np.diff(upwards.indptr))
        at = upwards.indices[upwards.indptr[some]] // N_COMPONENTS
        np.add.at(weights, at, inert.mass[rises][some, None] * (upwards @ motion)[some])
    return weights


def _null(directions: Floats) -> Floats:
    """Orthonormal motions [f, 6] that the rows [m, 6] do not feel."""
    sizes = np.linalg.norm(directions, axis=1)
    rows = directions[sizes > 0.0]
    if not len(rows):
        return np.eye(6)
    _, values, vectors = np.linalg.svd(rows, full_matrices=True)
    rank = int((values > FREE * values[0]).sum())
    return vectors[rank:]


# ----------------------------------------------------------------------------------------------------------------------
# Joints of meshes: springs that are as many as the mesh has nodes, what is open, what shared nodes join; long springs.
#
# A joint with a stiffness has one spring at every pair of joined nodes. At the ends of bars that is what is meant.
# Where neighbouring nodes are joined, as along an edge or over a face, a finer mesh has more springs, and the joint is
# stiffer.
# ----------------------------------------------------------------------------------------------------------------------

_TOUCHING = 4e-6  # of the size of the structure: places of two parts that are nearer are one, as in joints
_PLACES: Final = 8  # along a side of a cell, to see how much of it lies on another part
FAR = 0.2  # of the size of the structure, across the direction of a stiffness: hangers and isolators are shorter


def joint_spring_findings(model: Model) -> tuple[Finding, ...]:
    """Joints with a stiffness that join neighbouring nodes of a part: those of one bar, or two corners of one cell."""
    found = []
    for joint in model.structure.joints:
        values = {axis: joint.stiffness[axis] for axis in DIRECTIONS if joint.stiffness.get(axis)}
        springs = [one for one in model.elastics if one.name == joint.name]
        if not values or not springs or joint.per == "length":
            continue
        joined = np.unique(springs[0].rows.indices // N_COMPONENTS).astype(np.int64)
        parts = [model.parts[name] for name in (joint.a, joint.b)]
        if not all(_neighbours(part, joined) for part in parts if not part.rigid):
            continue
        count = len(springs[0].stiffness) // len(values)
        total = ", ".join(
            f"{axis} {count * value:.4g} {'N/m' if len(axis) == 1 else 'N m/rad'}" for axis, value in values.items()
        )
        found.append(
            Finding(
                "joint-springs-by-node",
                f"{joint.name}: the joint of {joint.a} and {joint.b} has a spring at each of {count} pairs of nodes, "
                f"together {total}. With another mesh it has more or fewer, and another stiffness. "
                "Write it per length of the line",
                {"springs": count},
            )
        )
    return tuple(found)


def joint_open_findings(model: Model) -> tuple[Finding, ...]:
    """Joints that leave nodes of one part free that lie on cells of the other, and joints with rigid arms there."""
    found = []
    for joint, joined in _nodes_of_joints(model):
        found += _at_a_point(joint, model, joined)
        for one, other in _that_can_lie(joint, model):
            found += _armed(joint, model, one, other) if joint.reach else _open(joint, model, one, other, joined)
            found += [] if joint.reach else _inside_cells(joint, model, one, other)
    return tuple(found)


class Joined(NamedTuple):
    """What a joint holds together: `size` in `unit`, m of edges and bars or m^2 of cells, `of` what touches in all;
    None where parts meet at nodes alone."""

    a: str
    b: str
    nodes: int
    size: float | None
    of: float | None
    unit: str


def joined_over(model: Model) -> dict[str, Joined]:
    """Each joint of parts with nodes, by its name, and over which length or area it holds them together."""
    found = {}
    for joint, joined in _nodes_of_joints(model):
        best = Joined(joint.a, joint.b, len(joined), None, None, "")
        for one, other in () if joint.reach else _that_can_lie(joint, model):
            touch = _touching(joint, model, one, other, joined)
            lying = _lying(one, other, touch.on, touch.free, model, touch.within)
            if lying.all > (best.of or 0.0):
                best = best._replace(size=lying.all - lying.open, of=lying.all, unit=lying.unit)
        found[joint.name] = best
    return found


def _nodes_of_joints(model: Model) -> Iterator[tuple[Joint, Integers]]:
    """Joints of parts that are no blocks, and all nodes that each ties or springs."""
    for joint in model.structure.joints:
        rows = [tie.rows for tie in model.ties if tie.name == joint.name]
        rows += [spring.rows for spring in model.elastics if spring.name == joint.name]
        if rows and all(model.parts[name].box is None for name in (joint.a, joint.b)):
            indices = np.concatenate([one.indices for one in rows]) // N_COMPONENTS
            yield joint, np.unique(indices).astype(np.int64)


def _that_can_lie(joint: Joint, model: Model) -> Iterator[tuple[Meshed, Meshed]]:
    """Parts of a joint, the second with cells, the first with cells or bars that can lie on these."""
    parts = model.parts[joint.a], model.parts[joint.b]
    for one, other in (parts, parts[::-1]):
        if other.has_cells and (one.has_cells or len(one.lines)):
            yield one, other


def _at_a_point(joint: Joint, model: Model, joined: Integers) -> list[Finding]:
    """Plates, shells or solids that a rigid joint holds together at one place of both alone."""
    parts = model.parts[joint.a], model.parts[joint.b]
    if joint.stiffness or not all(part.has_cells for part in parts):
        return []
    places = model.mesh.points[joined]
    if np.ptp(places, axis=0).max() > _TOUCHING * _size_of_model(model):
        return []
    at = ", ".join(f"{value:.4g}" for value in places[0])
    message = (
        f"{joint.name}: {joint.a} and {joint.b} touch at one point alone, ({at}) m: a joint there gets softer "
        "without limit as the mesh gets finer"
    )
    return [Finding("joint-at-a-point", message, {"places": 1}, severe=True)]


def _armed(joint: Joint, model: Model, one: Meshed, other: Meshed) -> list[Finding]:
    """Rigid arms from nodes of one part that lie on cells of the other to the nodes of these."""
    within = _TOUCHING * _size_of_model(model)
    pairs = coincident_pairs(joint, model, within)
    pairs = pairs if one.name == joint.a else pairs[:, ::-1]
    places = model.mesh.points[pairs]
    arms = np.asarray(np.linalg.norm(places[:, 1] - places[:, 0], axis=1))
    arms = arms[(other.off_cells(places[:, 0]) <= within) & (arms > within)]
    if not len(arms):
        return []
    message = (
        f"{joint.name}: {len(arms)} nodes of {one.name} that lie on {other.name} are joined to nodes beside them by "
        f"rigid arms of up to {1e3 * arms.max():.3g} mm, which make it too stiff"
    )
    return [Finding("joint-rigid-arms", message, {"arms": len(arms), "arm_m": float(arms.max())})]


class _Touch(NamedTuple):
    """Nodes of a part that lie on cells of another, those of them that a joint leaves free, how near is near, and by
    how much curves bow away from their chords."""

    on: Integers
    free: Integers
    within: float
    curved: float


def _touching(joint: Joint, model: Model, one: Meshed, other: Meshed, joined: Integers) -> _Touch:
    within = _TOUCHING * _size_of_model(model)
    own = joined_nodes(joint, one.name, model, within)
    nodes = np.intersect1d(one.lines.ravel(), own) if len(one.lines) else own
    off = off_near(other, model.mesh.points[nodes])
    there = joined_nodes(joint, other.name, model, within)
    curved = bow_between((one, other), (nodes, there), off, within, model.mesh.points) if len(one.quads) else 0.0
    on = nodes[off <= within + curved]
    return _Touch(on, np.setdiff1d(on, joined), within + curved, curved)


def _open(joint: Joint, model: Model, one: Meshed, other: Meshed, joined: Integers) -> list[Finding]:
    """Nodes of one part that lie on cells of the other, and that a joint leaves free."""
    on, free, within, curved = _touching(joint, model, one, other, joined)
    if not len(free):
        return []
    lying = _lying(one, other, on, free, model, within)
    share = (
        f"{lying.open:.3g} of the {lying.all:.3g} {lying.unit} over which" if lying.all > 0.0 else "the places where"
    )
    message = (
        f"{joint.name}: {share} {one.name} lies on {other.name} found no partner, at {len(free)} of {len(on)} nodes "
        f"of it: {other.name} has no nodes at their places. The joint is open there"
        + (f". Curves whose chords are up to {1e3 * curved:.3g} mm apart count as touching" if curved > 0.0 else "")
    )
    values: dict[str, float] = {"free": len(free), "touching": len(on)}
    if lying.all > 0.0:
        unit = lying.unit.replace("^", "")
        values |= {f"open_{unit}": lying.open, f"touching_{unit}": lying.all}
    return [Finding("joint-open", message, values, severe=True)]


class _Beside(NamedTuple):
    """Of a part at places of a line [e]: the width of its cell across the line [m], the share of it on one side, the
    rotation per moment that the cell leaves out there [1/N], and the rotational stiffness per length of the part about
    the line, clamped at its far ends [N]."""

    width: Floats
    share: Floats
    compliance: Floats
    stiffness: Floats


def _beside_line(part: ShellMesh, middles: Floats, along: Floats, points: Floats) -> _Beside:
    """A part at places of a line, by the mean of its rigidities in both directions.

    Parameters
    ----------
    middles, along : Floats [e, 3]
        Places [m], and the unit direction of the line there.
    points : Floats [n_nodes, 3]
        Of the whole structure [m].
    """
    corners = points[part.motion_on_cells(middles)[0]]
    away = corners - middles[:, None]
    away -= np.einsum("ekd,ed->ek", away, along)[..., None] * along[:, None]
    across = away[np.arange(len(middles)), np.linalg.norm(away, axis=2).argmax(axis=1)]
    across /= np.linalg.norm(across, axis=1)[:, None]
    sides = np.einsum("ekd,ed->ek", away, across)
    width, share = np.ptp(sides, axis=1), -sides.min(axis=1) / np.ptp(sides, axis=1)
    reach = np.einsum("nd,ed->en", part.places, across) - (middles * across).sum(axis=1)[:, None]
    spans = np.abs(np.stack([reach.min(axis=1), reach.max(axis=1)]))
    there = spans > TOUCHING * np.ptp(part.places, axis=0).max()
    spans = spans.clip(min=width)  # what is nearer than a cell is no span of its own
    rigidity = float(part.sections.D[:, [0, 1], [0, 1]].mean())
    stiffness = 4.0 * rigidity * (there / spans).sum(axis=0)
    return _Beside(width, share, width * share * (1.0 - share) / rigidity, stiffness)


def _loosened(holds: Floats, held: Floats, compliance: Floats) -> Floats:
    """How much less a span is clamped where what holds it does so through a compliance [1/N]; both by their rotational
    stiffness per length [N]. The fixity is k / (k + k of the span): 0 of a hinge, 1 of a clamp."""
    softer = holds / (1.0 + compliance * holds)
    return np.asarray(holds / (holds + held) - softer / (softer + held))


def _inside_cells(joint: Joint, model: Model, one: Meshed, other: Meshed) -> list[Finding]:
    """Edges of shells that stand on cells of another between the lines of these.

    Notes
    -----
    Rotations are linear across a cell of width h. Those of a plate that gets a moment M per length at a line in it have
    a kink there, and with the shares s and 1 - s of the width on both sides it turns by M h s (1 - s) / D more than its
    nodes say. Without that compliance plate and wall clamp each other too well. A span on a hinge at its far end has
    1.56 times the frequency where it is clamped at the line of what it has on a hinge there; between them frequencies
    go about as the fixity does. Frequencies of the slabs and strips in the tests are too high by a fourth of what is
    said to all of it.
    """
    if joint.kind != "rigid" or set(joint.stiffness) & {"rx", "ry", "rz"}:
        return []
    if not isinstance(one, ShellMesh) or not isinstance(other, ShellMesh):
        return []
    points, on = model.mesh.points, np.zeros(len(model.mesh.points), dtype=bool)
    touch = _touching(joint, model, one, other, np.zeros(0, dtype=np.int64))
    on[touch.on] = True
    if on[one.quads].all(axis=1).any():
        return []
    ends, rim = points[one.edges_of_cells[on[one.edges_of_cells].all(axis=1)]], points[rim_of(other)]
    beside = [distance_to_segments(at, rim[:, 0], rim[:, 1])[0].min(initial=np.inf) for at in ends.mean(axis=1)]
    ends = ends[np.array(beside) > touch.within]  # along a rim chords of curves lie beside each other
    if not len(ends):
        return []
    middles, along = ends.mean(axis=1), ends[:, 1] - ends[:, 0]
    along /= np.linalg.norm(along, axis=1)[:, None]
    wall, plate = (_beside_line(part, middles, along, points) for part in (one, other))
    pairs = (wall.stiffness, plate.stiffness), (plate.stiffness, wall.stiffness)
    stiffer = _CLAMPED * np.max([_loosened(*pair, plate.compliance) for pair in pairs], axis=0)
    worst = int(stiffer.argmax())
    if stiffer[worst] <= STIFFER_NOTABLE:
        return []
    share, width, too_high = (float(of[worst]) for of in (plate.share, plate.width, stiffer))
    message = (
        f"{joint.name}: {one.name} stands on {other.name} inside its cells, at {share:.2g} of a width of "
        f"{1e3 * width:.3g} mm. The joint is too stiff there, and frequencies can be up to about {100 * too_high:.2g} "
        "% too high"
    )
    values = {"share_of_width": share, "width_m": width, "too_high": too_high}
    return [Finding("joint-inside-cells", message, values, severe=too_high > STIFFER_SEVERE)]


class _Lying(NamedTuple):
    """How much of a part lies on another, and how much of that has free nodes, in m^2 of its cells or m of their edges
    or of its bars."""

    open: float
    all: float
    unit: str


def _lying(one: Meshed, other: Meshed, on: Integers, free: Integers, model: Model, within: float) -> _Lying:
    points, corners = model.mesh.points, one.quads
    cells = corners[np.isin(corners, on).any(axis=1)]
    share = (np.arange(_PLACES) + 0.5) / _PLACES
    x, y = (some.ravel() for some in np.meshgrid(share, share, indexing="ij"))
    functions = np.stack([(1 - x) * (1 - y), x * (1 - y), x * y, (1 - x) * y], axis=1)
    areas = np.linalg.norm(area_vectors(points, cells), axis=1) * _covered(functions, cells, other, points, within)
    if areas.sum() > 0.0:
        return _Lying(float(areas[np.isin(cells, free).any(axis=1)].sum()), float(areas.sum()), "m^2")
    sides = np.concatenate([cells[:, [i, (i + 1) % 4]] for i in range(4)])
    lines = np.unique(np.sort(one.lines if len(one.lines) else sides, axis=1), axis=0)
    lines = lines[np.isin(lines, on).any(axis=1) & (lines[:, 0] != lines[:, 1])]
    functions = np.stack([1.0 - share, share], axis=1)
    lengths = np.linalg.norm(points[lines[:, 1]] - points[lines[:, 0]], axis=1)
    lengths = lengths * _covered(functions, lines, other, points, within)
    return _Lying(float(lengths[np.isin(lines, free).any(axis=1)].sum()), float(lengths.sum()), "m")


def _covered(functions: Floats, cells: Integers, other: Meshed, points: Floats, within: float) -> Floats:
    """Share of places of cells or lines [m, k] that lie on another part [m].

    Parameters
    ----------
    functions : Floats [q, k]
        Of the places.
    """
    at = np.einsum("qk,mkd->mqd", functions, points[cells])
    found = other.off_cells(at.reshape(-1, 3)).reshape(at.shape[:2]) <= within
    return np.asarray(found.mean(axis=1), dtype=np.float64)


def _neighbours(part: Meshed, joined: Integers) -> bool:
    """Whether two ends of one bar, or two corners of one cell of a part are among nodes."""
    return any(bool((np.isin(cells, joined).sum(axis=1) > 1).any()) for cells in (part.lines, part.quads) if len(cells))


def shared_node_findings(model: Model) -> tuple[Finding, ...]:
    """What the nodes of a file join, in one remark; and each shell that they join to a solid by forces alone."""
    found = shared_nodes(model)
    if not found:
        return ()
    names = ", ".join(f"{one.name} (at {len(one.pairs)})" for one in found)
    findings = [
        Finding(
            "parts-share-nodes",
            f"Parts of one mesh file are joined at the nodes that they share there: {names}. A joint or a seam of two "
            "of them takes the place of that",
            {"pairs": len(found), "nodes": sum(len(one.pairs) for one in found)},
        )
    ]
    return (*findings, *(hinge for one in found for hinge in _hinge(one, model)))


def _hinge(shared: SharedNodes, model: Model) -> list[Finding]:
    """A shell whose nodes on a solid are of no cell that lies on it: it turns there."""
    parts = model.parts[shared.a], model.parts[shared.b]
    turning = [part.has_rotations for part in parts]
    if turning[0] == turning[1]:
        return []
    shell, solid = parts if turning[0] else parts[::-1]
    nodes = shared.pairs[:, 0 if turning[0] else 1]
    lone, length = _nodes_of_no_cell(shell, nodes, model.mesh.points)
    if not lone:
        return []
    where = f"along {length:.3g} m" if length > 0.0 else f"at {lone} nodes"
    message = (
        f"{shell.name} and {solid.name} share nodes of their mesh file {where}, where no cell of {shell.name} lies on "
        f"{solid.name}: forces go across and no moments, so that {shell.name} turns there as on a hinge. Write a joint "
        "of both, which holds the rotations, or one of 'kind: pinned' if it is a hinge"
    )
    return [Finding("shared-nodes-hinge", message, {"length_m": length, "nodes": lone}, severe=True)]


def _nodes_of_no_cell(shell: Meshed, nodes: Integers, points: Floats) -> tuple[int, float]:
    """How many of some nodes of a shell are of no cell all of whose nodes are among them, and the length of the edges
    between nodes that have such a one [m]."""
    cells = shell.quads
    whole = np.unique(cells[np.isin(cells, nodes).all(axis=1)])
    lone = np.setdiff1d(nodes, whole)
    sides = np.unique(np.sort(np.concatenate([cells[:, [i, (i + 1) % 4]] for i in range(4)]), axis=1), axis=0)
    along = sides[np.isin(sides, nodes).all(axis=1) & np.isin(sides, lone).any(axis=1)]
    return len(lone), float(np.linalg.norm(points[along[:, 1]] - points[along[:, 0]], axis=1).sum())


def far_spring_findings(model: Model) -> tuple[Finding, ...]:
    """Springs whose two places lie far from each other across a direction in which they have stiffness.

    Along its direction a spring may be as long as it likes: a prop, or a tie.
    """
    size = _size_of_model(model)
    found = []
    for part in model.structure.parts:
        if not isinstance(part, Spring) or part.b is None:
            continue
        first, second = (places_of(f"parts.{part.name}.between", end, model) for end in (part.a, part.b))
        a, b = (np.stack([point.position for point in places]) for places in (first, second))
        arms = _arms(np.asarray(part.stiffness[:3]) + np.asarray(part.damping[:3]), b - a)
        longest = float(arms.max(initial=0.0))
        if longest <= FAR * size:
            continue
        several = max(len(a), len(b))
        one = part.b if len(b) < len(a) else part.a if len(a) < len(b) else ""
        found.append(
            Finding(
                "spring-with-long-arms",
                f"{part.name}: its ends '{part.a}' and '{part.b}' are up to {longest:.3g} m apart beside each other, "
                "and rigid arms join each to the middle between them"
                + (f"; all {several} springs act on the one place '{one}'" if one and several > 1 else "")
                + ". Give each place its own opposite, or leave out the second end for a spring to the ground",
                {"arm_m": longest, "size_m": size, "allowed": FAR},
            )
        )
    return tuple(found)


def _arms(stiffness: Floats, apart: Floats) -> Floats:
    """How far ends [n, 3] are apart across the directions that have stiffness, the largest of each [n] [m]."""
    squared = (apart**2).sum(axis=1)[:, None] - apart**2
    across: Floats = np.sqrt(np.maximum(squared[:, stiffness > 0.0], 0.0)).max(axis=1, initial=0.0)
    return across


def _size_of_model(model: Model) -> float:
    sizes = [float(np.ptp(part.bounds, axis=0).max()) for part in model.parts.values() if part.rigid]
    return max([float(np.ptp(model.mesh.points, axis=0).max(initial=0.0)), *sizes])
