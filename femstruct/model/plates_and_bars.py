"""How bars and plates are joined on our own meshes: what plates do in their planes, ribs, posts, joints that slide."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
import scipy
from scipy.sparse import csr_array, vstack

from femstruct.arrays import Floats, Integers
from femstruct.conventions import N_COMPONENTS
from femstruct.errors import InputError
from femstruct.model.layout import Layout, stretch_inside
from femstruct.model.model import Model
from femstruct.model.part import Elastic, Meshed, Tie
from femstruct.model.regions import Region, node_rows, to_rectangle
from femstruct.model.structure import SIMPLE, Joint, Structure, Support

# ----------------------------------------------------------------------------------------------------------------------
# What happens in the planes of plates: which of them have to stretch, and how simple supports hold those that do.
#
# A plate that lies alone, or is joined only to what lies in its plane, bends and stretches independently of each other:
# nothing that pushes it out of its plane stretches it. Any other part that is joined to it may: a plate at an angle, a
# rib beside it, a post, a block.
#
# A simple support carries a plate and keeps it in its place, but must not keep it from stretching: a ribbed floor held
# lengthways at both ends would be an arch. So in the plane of a plate that stretches, the simple supports of it
# together hold only what would be a rigid motion otherwise: the mean shifts and the mean rotation of all the edges and
# lines that they hold, as far as no other support of it does. Plates in one plane that are joined count as one. The
# force is that of the first of these supports.
# ----------------------------------------------------------------------------------------------------------------------

_PARALLEL = 1e-6  # sine of an angle: less is rounding
_FREE = 1e-6  # of what supports resist most: a rigid motion they resist by less is free


def membrane_plates(structure: Structure, layout: Layout) -> frozenset[str]:
    """Names of the plates that what is joined to them can stretch."""
    found: set[str] = set()
    for group in _groups([(joint.a, joint.b) for joint in structure.joints]):
        rectangles = group & layout.rectangles.keys()
        if rectangles and (rectangles & layout.pulled or not _in_one_plane(group, layout)):
            found |= rectangles
    return frozenset(found | layout.pulled)


def steadied(ties: Mapping[str, Tie], model: Model, tolerance: float) -> list[Tie]:
    """Supports by name, the first simple one of every plane with what holds its plates in it."""
    held = csr_array(vstack([csr_array((0, model.mesh.n_nodes * N_COMPONENTS)), *(tie.rows for tie in ties.values())]))
    found = dict(ties)
    for plane in planes_of(model, tolerance):
        supports = [item for item in model.structure.supports if item.on in plane and _is_simple(item)]
        if supports:
            first = found[supports[0].name]
            rows = _mean_rows(supports, plane, held, model, tolerance)
            means = np.stack([rows[:, axis::N_COMPONENTS].sum(axis=1) for axis in range(3)], axis=1)
            directions = np.concatenate([first.directions, means])
            found[first.name] = Tie(first.name, csr_array(vstack([first.rows, rows])), directions, grounded=True)
    return list(found.values())


def planes_of(model: Model, tolerance: float) -> list[frozenset[str]]:
    """Names of the plates that stretch, those together that lie in one plane and are joined."""
    joined = [(joint.a, joint.b) for joint in model.structure.joints if _is_one_plane(joint, model, tolerance)]
    return _groups(joined, [name for name, part in model.parts.items() if part.drilling is not None])


def _groups(pairs: Sequence[tuple[str, str]], alone: Sequence[str] = ()) -> list[frozenset[str]]:
    """Names that pairs connect, and those that none does."""
    owner = {name: name for name in (*alone, *(name for pair in pairs for name in pair))}

    def root(name: str) -> str:
        while owner[name] != name:
            name = owner[name]
        return name

    for a, b in pairs:
        owner[root(a)] = root(b)
    return [frozenset(name for name in owner if root(name) == one) for one in owner if root(one) == one]


def _in_one_plane(group: frozenset[str], layout: Layout) -> bool:
    """Whether parts lie in one plane: rectangles, and bars whose axes and nodes do."""
    if not group <= layout.rectangles.keys() | layout.segments.keys():
        return False
    name = min(group & layout.rectangles.keys())
    plate, axes = layout.rectangles[name], layout.axes_of[name]
    places = []
    for other in group & layout.segments.keys():
        places += [layout.vertices[other], *(np.stack([one.start, one.end]) for one in layout.segments[other])]
    for other in group & layout.rectangles.keys():
        if np.linalg.norm(np.cross(layout.axes_of[other][2], axes[2])) > _PARALLEL:
            return False
        places.append(np.asarray(layout.rectangles[other].origin, dtype=np.float64)[None])
    heights = to_rectangle(plate, axes, np.concatenate(places))[:, 2]
    return bool(np.abs(heights).max() <= layout.tolerance)


def _is_one_plane(joint: Joint, model: Model, tolerance: float) -> bool:
    one, other = model.parts.get(joint.a), model.parts.get(joint.b)
    if (
        one is None
        or other is None
        or one.drilling is None
        or other.drilling is None
        or joint.stiffness
        or joint.kind == "sliding"
    ):
        return False
    apart = float(abs((other.places[0] - one.places[0]) @ one.drilling))
    return bool(np.linalg.norm(np.cross(one.drilling, other.drilling)) < _PARALLEL and apart <= tolerance)


def _is_simple(item: Support) -> bool:
    return item.fix in SIMPLE and (item.edge is not None or item.line is not None)


def _mean_rows(
    supports: Sequence[Support], plane: frozenset[str], held: csr_array, model: Model, tolerance: float
) -> csr_array:
    """Mean rigid motions [f, n_nodes * 7] in a plane of all that its simple supports hold, of which supports leave the
    plates free.

    Parameters
    ----------
    held : csr_array [m, n_nodes * 7]
        What they hold in all.
    """
    lines = [line for item in supports for line, _ in model.parts[str(item.on)].edges(item, tolerance)]
    nodes, weights = np.concatenate(lines), np.concatenate([_lengths(model.mesh.points[line]) for line in lines])
    weights /= weights.sum()
    part = model.parts[str(supports[0].on)]
    assert part.own_axes is not None
    axes, points = part.own_axes, model.mesh.points
    middle = weights @ points[nodes]
    size = float(np.linalg.norm(points[nodes] - middle, axis=1).max())
    of_all = np.concatenate([model.parts[name].nodes for name in sorted(plane)])
    motion = np.zeros((model.mesh.n_nodes, N_COMPONENTS, 3))
    motion[of_all, :3, :2] = axes[:2].T
    motion[of_all, :3, 2] = np.cross(axes[2], points[of_all] - middle) / size
    motion[of_all, 3:6, 2] = axes[2] / size
    felt = held @ motion.reshape(-1, 3)
    # An oblique deflection that is held feels rigid motions in the plane by the rounding of its axes.
    sizes = np.sqrt(np.asarray(held.multiply(held).sum(axis=1), dtype=np.float64))
    free = _null(felt[np.linalg.norm(felt, axis=1) > _FREE * sizes])
    rows = np.zeros((len(free), model.mesh.n_nodes, N_COMPONENTS))
    pushes = np.einsum("nci,fi->fnc", motion[nodes, :3], free)
    for row, push in zip(rows, weights[:, None] * pushes, strict=True):
        np.add.at(row[:, :3], nodes, push)
    return csr_array(rows.reshape(len(free), model.mesh.n_nodes * N_COMPONENTS))


def _lengths(places: Floats) -> Floats:
    """Length of a line that belongs to each of its points [n] [m]."""
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
    lengths: Floats = (np.append(steps, 0.0) + np.append(0.0, steps)) / 2.0
    return lengths


def _null(rows: Floats) -> Floats:
    """Orthonormal motions [f, 3] that the rows [m, 3] do not feel."""
    if not len(rows):
        return np.eye(3)
    _, values, vectors = np.linalg.svd(rows.T @ rows)
    found: Floats = vectors[int((values > _FREE**2 * values[0]).sum()) :]
    return found


# ----------------------------------------------------------------------------------------------------------------------
# How bars are joined to a plate that stretches: ribs that run along it, posts that stand on it.
#
# A rib is tied to the plate where both touch, on its face: the three displacements there, and the rotation about its
# own axis. Its other two rotations are its own.
#
# - About the plate's normal: as the plate twists along the rib, the rib's section turns about that normal. Tied to the
#   plate, whose drilling rotation follows it only as far as the mesh is coarse, the rib would shear sideways: a false
#   torsional stiffness, up to k G A e^2, thirty times the true one.
# - About the axis across the rib: a thin plate has no shear deformation, so that a rib with its rotation could not
#   shear, either.
#
# The end of a bar that stands on the plate is tied in all three rotations. That about the normal is the rotation of a
# patch as wide as the bar's section: the rotation of a plate at a point under a torque grows without limit as the mesh
# is refined, and free, the bar could spin about its axis.
#
# A rib touches the plate along a line here. In three-dimensional solids a weld 10 mm wide on a plate of 0.8 m makes
# frequencies up to 0.6 % higher, and the edges of boards swing about the flanks of a joist: modes of edges 0.3 m from
# the middle of joists of 45 mm are 5 to 6 % higher. (A board kept flat over that width was as much too stiff.)
# ----------------------------------------------------------------------------------------------------------------------

_SLIGHT = 1e-6  # sine of an angle: less is rounding
_TURN = slice(3, 6)


def contact(pairs: Integers, bars: Meshed, plate: Meshed, points: Floats) -> Floats:
    """Where bars touch a plate [p, 3] [m]: ribs beside it on its face, bars in it and posts in the mid-surface.

    Parameters
    ----------
    pairs : Integers [p, 2]
        Nodes of the bars and of the plate.
    points : Floats
        Of all nodes [m].
    """
    return touching_face(pairs[:, 0], points[pairs[:, 1]], bars, plate)


def touching_face(nodes: Integers, foot: Floats, bars: Meshed, plate: Meshed) -> Floats:
    """Where bars touch a plate [p, 3] [m], of nodes of theirs [p] at places in its mid-surface [p, 3] [m]."""
    depth = float(np.linalg.norm(plate.across))
    normal = plate.across / depth
    heights = np.clip((bars.places[nodes - bars.first] + bars.beside(nodes) - foot) @ normal, -depth, depth)
    along = np.isin(nodes, _within(bars, nodes))
    found: Floats = foot + np.outer(np.where(along, heights, 0.0), normal)
    return found


def turning_rows(pairs: Integers, bars: Meshed, plate: Meshed, springy: list[int], n_nodes: int) -> list[csr_array]:
    """Rotations of bars less those of a plate that a rigid joint holds at zero, each [m, n_nodes * 7].

    Parameters
    ----------
    pairs : Integers [p, 2]
        Nodes of the bars and of the plate.
    springy : list[int]
        Numbers of the directions that are springs, and so not held.

    Raises
    ------
    InputError
        For bars of a file that does not say how thick they are.
    """
    if not bars.girth:
        raise InputError(
            f"parts.{bars.name}.file",
            got=f"bars on {plate.name}, and a file that has neither their section nor their axis",
            expected="a file that has both",
            do="write it again with 'femstruct reduce'",
        )
    normal, axes = plate.drilling, plate.own_axes
    assert normal is not None
    assert axes is not None
    free = np.eye(3)[[number - 3 for number in springy if number >= 3]]
    along, directions, _ = pieces_of(bars, pairs)
    standing = pairs[~np.isin(pairs[:, 0], along[:, 0])]
    found = [
        _relative(along, directions, free, n_nodes),
        *(_relative(standing, np.tile(axis, (len(standing), 1)), free, n_nodes) for axis in axes[:2]),
    ]
    if not (np.abs(free @ normal) > _SLIGHT).any():
        turn = np.zeros((len(standing), N_COMPONENTS))
        turn[:, _TURN] = normal
        patches = plate.turning(standing[:, 1], bars.girth, n_nodes)
        found.append(csr_array(node_rows(standing[:, 0], turn, n_nodes) - patches))
    return found


def pieces_of(bars: Meshed, pairs: Integers) -> tuple[Integers, Floats, Floats]:
    """Where bars run along what they are joined to.

    Parameters
    ----------
    pairs : Integers [p, 2]
        Nodes of the bars and of the other part.

    Returns
    -------
    tuple[Integers, Floats, Floats]
        The pairs [m, 2] at ends of bars both of whose ends are joined, the directions of the bars there [m, 3] and the
        lengths that belong to them [m] [m]; a straight line is there once, a corner with both its directions.
    """
    ends = _within(bars, pairs[:, 0])
    steps = bars.places[ends[:, 1] - bars.first] - bars.places[ends[:, 0] - bars.first]
    lengths = np.linalg.norm(steps, axis=1)
    far = lengths > 0.0  # bars between offsets of one node run along nothing
    ends, steps, lengths = ends[far], steps[far], lengths[far]
    along = steps / lengths[:, None]
    largest = along[np.arange(len(along)), np.abs(along).argmax(axis=1)]
    along = np.repeat(along * np.sign(largest)[:, None], 2, axis=0)
    keys = np.column_stack([ends.ravel(), np.round(along / _SLIGHT).astype(np.int64)])
    _, first, which = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(pairs[:, 0])
    nodes = ends.ravel()[first]
    partner = pairs[order[np.searchsorted(pairs[order, 0], nodes)], 1]
    shares: Floats = np.bincount(which.ravel(), np.repeat(lengths / 2.0, 2)).astype(np.float64)
    return np.column_stack([nodes, partner]), along[first], shares


def _within(bars: Meshed, nodes: Integers) -> Integers:
    """End nodes of the bars [b, 2] both of which are among the nodes."""
    return bars.lines[np.isin(bars.lines, nodes).all(axis=1)]


def _relative(pairs: Integers, axes: Floats, free: Floats, n_nodes: int) -> csr_array:
    """Relative rotation of pairs of nodes [m, 2] about axes [m, 3] less their share of free directions [f, 3]."""
    turn = np.zeros((len(pairs), N_COMPONENTS))
    turn[:, _TURN] = axes - axes @ free.T @ free
    held = np.flatnonzero(np.linalg.norm(turn, axis=1) > _SLIGHT)
    first, second = (node_rows(pairs[held, side], turn[held], n_nodes) for side in (0, 1))
    return csr_array(first - second)


# ----------------------------------------------------------------------------------------------------------------------
# Ribs that are drawn at their true height, beside the mid-surface that they are joined to: what to write instead.
# ----------------------------------------------------------------------------------------------------------------------

_SMALL: Final = 1e-6  # of the extent of bars: a height that varies by less is the same


def offsets_to_write(names: tuple[str, str], feet: Floats, arms: Floats, corner: Floats, normal: Floats) -> str | None:
    """What moves lines of bars into a plane and leaves the bars where they are; None where they are not at one height
    over it, or have several offsets.

    Parameters
    ----------
    names : tuple[str, str]
        Of the bars and of what lies in the plane.
    feet, arms : Floats [n, 3]
        Places of their lines, and from there to their axes [m].
    corner, normal : Floats [3]
        Of the plane.

    Examples
    --------
    >>> feet = np.array([[0.1, 0.6, -0.07], [1.9, 0.6, -0.07]])
    >>> text = offsets_to_write(("rib", "slab"), feet, 0.0 * feet, np.zeros(3), np.array([0.0, 0.0, 1.0]))
    >>> print(*text.split(" and "), sep="\\n")
    if rib is a rib of slab, move its lines by [0, 0, 70 mm] into the mid-surface of slab
    write 'offsets: {start: [0, 0, -70 mm], end: [0, 0, -70 mm]}'
    """
    heights = (feet - corner) @ normal
    small = _SMALL * float(np.ptp(feet, axis=0).max(initial=0.0))
    height = float(heights.mean())
    if np.ptp(heights) > small or np.ptp(arms, axis=0).max() > small or abs(height) <= small:
        return None
    offset = written(height * normal + arms[0])
    return (
        f"if {names[0]} is a rib of {names[1]}, move its lines by {written(-height * normal)} into the mid-surface of "
        f"{names[1]} and write 'offsets: {{start: {offset}, end: {offset}}}'"
    )


def offsets_of(one: Meshed, other: Meshed) -> str | None:
    """The same, of two parts one of which has bars and the other lies in one plane."""
    for bars, flat in ((one, other), (other, one)):
        ends, axes = np.unique(bars.lines), flat.own_axes
        if len(ends) and not len(flat.lines) and axes is not None:
            feet = bars.places[ends - bars.first]
            return offsets_to_write((bars.name, flat.name), feet, bars.beside(ends), flat.places[0], axes[2])
    return None


def written(vector: Floats) -> str:
    """Lengths along x, y, z [m] as a model file has them."""
    size = float(np.abs(vector).max())
    return "[" + ", ".join("0" if abs(one) < _SMALL * size else f"{1e3 * one:.6g} mm" for one in vector) + "]"


# ----------------------------------------------------------------------------------------------------------------------
# Which nodes of two joined parts move together.
# ----------------------------------------------------------------------------------------------------------------------


def coincident_pairs(item: Joint, model: Model, tolerance: float) -> Integers:
    """Coincident nodes of the two parts, or nodes within reach of each other [m, 2]: of each node of the first part, or
    of a set alone that is named, the nearest of the other."""
    first, second = (joined_nodes(item, name, model, tolerance) for name in (item.a, item.b))
    turned = set(item.sets) == {item.b}
    if turned:
        first, second = second, first
    reach = 4.0 * tolerance if item.reach is None else item.reach
    distances, nearest = scipy.spatial.KDTree(model.mesh.points[second]).query(
        model.mesh.points[first], distance_upper_bound=reach
    )
    met = np.isfinite(distances)
    if not met.any():
        apart = np.min(scipy.spatial.KDTree(model.mesh.points[second]).query(model.mesh.points[first])[0])
        arms = f"write 'reach: {1e3 * apart:.3g} mm' for rigid arms between them"
        offsets = offsets_of(model.parts[item.a], model.parts[item.b])
        raise InputError(
            f"joints.{item.name}",
            got=f"{item.a} and {item.b} without a common node; the nearest two are {apart:.4g} m apart",
            expected="a touch" if item.reach is None else f"nodes at most {item.reach:g} m apart",
            do=arms if offsets is None else f"{offsets}; if not, {arms}",
        )
    pairs = np.stack([first[met], second[np.asarray(nearest)[met]]], axis=1)
    return pairs[:, ::-1] if turned else pairs


def joined_nodes(item: Joint, name: str, model: Model, tolerance: float) -> Integers:
    """Nodes of a part that a joint is about: those of a set, where it names one."""
    if name not in item.sets:
        return model.parts[name].joinable
    return model.parts[name].within(f"joints.{item.name}.sets", Region("set", named=item.sets[name]), tolerance)


def box_pairs(item: Joint, model: Model, tolerance: float) -> Integers:
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
    nodes = joined_nodes(item, other.name, model, tolerance)
    places = other.places[nodes - other.first]
    first, last = stretch_inside(places, other.across, low - tolerance, high + tolerance)
    met = nodes[first <= last]
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


# ----------------------------------------------------------------------------------------------------------------------
# Joints that slide along the line on which two parts touch: screws, nails, soft glue.
#
# A rib under a board and the board share the bending according to the slip between them: partial composite action.
# Across the line, and in rotation, the joint is rigid; along it a spring of a stiffness per length resists, the slip
# modulus of the fasteners over their spacing. Where a line turns a corner, both its directions slide.
# ----------------------------------------------------------------------------------------------------------------------

_TURNED = 1e-3  # square of the sine of an angle: a line that turns by less is straight


def sliding(
    item: Joint, parts: tuple[Meshed, Meshed], pairs: Integers, at: Floats, model: Model
) -> tuple[Tie, Elastic]:
    """Shifts across the line of a joint, which are held, and those along it, which are sprung.

    Parameters
    ----------
    pairs : Integers [p, 2]
        Nodes of both parts that are joined.
    at : Floats [p, 3]
        Where they touch [m].

    Raises
    ------
    InputError
        Where the parts do not touch along a line.
    """
    axes = next((part.own_axes for part in parts if part.own_axes is not None), np.eye(3))
    which, along, lengths = _lines(pairs, parts, model.mesh.points)
    if not len(which):
        raise InputError(
            f"joints.{item.name}.kind",
            got=f"sliding, and {item.a} and {item.b} that touch at single places",
            expected="parts that touch along a line",
        )
    held, across = across_lines(len(pairs), which, along, axes)
    tie = Tie(item.name, _relative_motion(pairs[held], at[held], across, model), across, grounded=False)
    rows = _relative_motion(pairs[which], at[which], along, model)
    nothing = np.zeros(len(lengths))
    return tie, Elastic(item.name, rows, item.slip * lengths, nothing, along, grounded=False)


def _lines(pairs: Integers, parts: tuple[Meshed, Meshed], points: Floats) -> tuple[Integers, Floats, Floats]:
    """Numbers of pairs [m] on lines, directions of these [m, 3], and the lengths that belong to them [m] [m]."""
    for side, part in enumerate(parts):
        if len(part.lines):
            found, along, lengths = pieces_of(part, pairs if side == 0 else pairs[:, ::-1])
            order = np.argsort(pairs[:, side])
            return order[np.searchsorted(pairs[order, side], found[:, 0])], along, lengths
    places = points[pairs[:, 0]]
    spread = np.linalg.svd(places - places.mean(axis=0), full_matrices=False)
    if len(pairs) < 2 or spread[1][1] > np.sqrt(_TURNED) * spread[1][0]:
        return np.zeros(0, np.int64), np.zeros((0, 3)), np.zeros(0)
    order = np.argsort(places @ spread[2][0])
    steps = np.linalg.norm(np.diff(places[order], axis=0), axis=1)
    lengths = (np.append(steps, 0.0) + np.append(0.0, steps)) / 2.0
    return order, np.tile(spread[2][0], (len(order), 1)), lengths


def lengths_of(item: Joint, pairs: Integers, parts: tuple[Meshed, Meshed], points: Floats) -> tuple[Integers, Floats]:
    """Which pairs [m] of a joint are on lines on which both parts run, and the lengths that belong to them [m] [m].

    Raises InputError where the parts touch at single places, or over an area.
    """
    numbers, lengths = np.zeros(0, np.int64), np.zeros(0)
    for side, part in sorted(enumerate(parts), key=lambda one: not len(one[1].lines)):
        cells, nodes = part.quads, pairs[:, side]
        if len(part.lines):
            ends = part.lines
        else:
            refuse_lengths(item, bool(np.isin(cells, nodes).all(axis=1).any()))
            ends = np.concatenate([cells[:, [i, (i + 1) % 4]] for i in range(4)]).reshape(-1, 2)
        ends = np.unique(np.sort(ends[np.isin(ends, nodes).all(axis=1)], axis=1), axis=0)
        halves = np.linalg.norm(points[ends[:, 1]] - points[ends[:, 0]], axis=1) / 2.0
        if halves.sum() > lengths.sum() and not len(numbers):
            order = np.argsort(nodes)
            found, which = np.unique(ends, return_inverse=True)
            lengths = np.bincount(which.ravel(), np.repeat(halves, 2)).astype(np.float64)
            numbers = order[np.searchsorted(nodes[order], found)]
    refuse_lengths(item, not len(numbers))
    return numbers, lengths


def refuse_lengths(item: Joint, wrong: bool) -> None:
    """Raise InputError for springs per length of a joint that has no line."""
    if wrong:
        raise InputError(
            f"joints.{item.name}.stiffness",
            got=f"springs per length, and {item.a} and {item.b} that do not touch along lines",
            expected="a stiffness of the springs at each pair of nodes",
            do="write N/m, and N*m/rad for rotations",
        )


def across_lines(count: int, which: Integers, along: Floats, axes: Floats) -> tuple[Integers, Floats]:
    """What is held of `count` pairs: numbers of pairs [r] and directions [r, 3], across those that slide.

    Along the axes of a plate, as far as they are across: equations along them couple fewest unknowns.
    """
    slides = np.zeros((count, 3, 3))
    np.add.at(slides, which, along[:, :, None] * along[:, None, :])
    values, vectors = np.linalg.eigh(slides)
    straight = values < _TURNED
    onto = np.einsum("pik,pk,pjk->pij", vectors, straight.astype(np.float64), vectors)
    across = np.einsum("pij,kj->pki", onto, axes)
    rank = np.argsort(np.argsort(-np.linalg.norm(across, axis=2), axis=1), axis=1)
    pair, axis = np.nonzero(rank < straight.sum(axis=1)[:, None])
    found: Floats = across[pair, axis]
    return pair, found / np.linalg.norm(found, axis=1)[:, None]


def _relative_motion(pairs: Integers, at: Floats, along: Floats, model: Model) -> csr_array:
    """Shift of the first node of each pair less that of the second along a direction [p, 3], at places that move with
    both [p, 3] [m]: [p, n_nodes * 7]."""
    sides = []
    for nodes in pairs.T:
        rows = np.zeros((len(pairs), N_COMPONENTS))
        rows[:, :3], rows[:, 3:6] = along, np.cross(at - model.mesh.points[nodes], along)
        sides.append(node_rows(nodes, rows, model.mesh.n_nodes))
    return csr_array(sides[0] - sides[1])
