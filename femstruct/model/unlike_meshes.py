"""Joints of bars, shells and solids whose meshes do not match where they touch: both move together all over it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import block_diag, csr_array, diags_array, eye_array, vstack
from scipy.spatial import KDTree

from femstruct.arrays import Floats, Integers
from femstruct.conventions import N_COMPONENTS
from femstruct.model.imported_mesh import KINDS
from femstruct.model.model import Model
from femstruct.model.part import Elastic, Meshed, Tie
from femstruct.model.plates_and_bars import across_lines, pieces_of, refuse_lengths, touching_face
from femstruct.model.regions import Region, carry_along_arms, node_rows, sparse_rows
from femstruct.model.seams import NEGLIGIBLE, Faces, Means, changed, means_over
from femstruct.model.structure import Joint

# ----------------------------------------------------------------------------------------------------------------------
# Bars on a slab or shell whose nodes are elsewhere: oblique ribs, ribs between lines of cells, posts inside of cells.
#
# The ends of bars move with the places of the cells that they lie on; deflections between nodes are what the cells make
# of the rotations, so that a rib does not follow the kinks of straight lines between nodes. What moves together is what
# does so on a plate (`femstruct.model.plates_and_bars`).
# ----------------------------------------------------------------------------------------------------------------------

_SIX = 6
_SLIGHT = 1e-6  # sine of an angle: less is rounding


class _Feet(NamedTuple):
    """Nodes of bars [p], places of cells where they are [p, 3] [m], and the motion of the bars less that of the cells
    there, shifts and rotations along global axes [6 p, n_nodes * 7]."""

    nodes: Integers
    places: Floats
    rows: csr_array

    def relative(self, which: Integers, components: Floats) -> csr_array:
        """Of some of them [r] along components [r, 6]: [r, n_nodes * 7]."""
        row = np.repeat(np.arange(len(which)), _SIX)
        column = (_SIX * which[:, None] + np.arange(_SIX)).ravel()
        chosen = csr_array((components.ravel(), (row, column)), shape=(len(which), self.rows.shape[0]))
        chosen.eliminate_zeros()
        return csr_array(chosen @ self.rows)


def feet_beside_nodes(bars: Meshed, cells: Meshed, nodes: Integers, there: Integers, off: float) -> Integers:
    """Nodes of bars that are joined to cells, where ends of bars lie on cells [m] off at most, and some of them beside
    the nodes there; none where all ends that do are at nodes.

    Parameters
    ----------
    nodes, there : Integers
        Those of both parts that a joint is about.
    """
    ends = np.intersect1d(bars.lines.ravel(), nodes)
    if not len(ends) or not len(there) or cells.edges_of_cells is None:
        return ends[:0]
    on = ends[cells.off_cells(bars.places[ends - bars.first]) <= off]
    apart = np.asarray(KDTree(cells.places[there - cells.first]).query(bars.places[nodes - bars.first])[0])
    at_nodes = nodes[apart <= off]
    return np.union1d(on, at_nodes) if len(np.setdiff1d(on, at_nodes)) else ends[:0]


def bars_on_cells(
    item: Joint, parts: tuple[Meshed, Meshed], nodes: Integers, springs: tuple[list[int], Floats], model: Model
) -> tuple[Tie | None, Elastic | None]:
    """Equations and springs of a joint of bars with the cells they lie on.

    Parameters
    ----------
    parts : tuple[Meshed, Meshed]
        The bars and what has the cells.
    nodes : Integers [p]
        Of the bars, from `feet_beside_nodes`.
    springs : tuple[list[int], Floats]
        Directions that are sprung, out of six, and their stiffnesses.
    """
    bars, cells = parts
    springy, values = springs
    cells = cells.around(np.unique(cells.motion_on_cells(model.mesh.points[nodes])[0]))
    feet = _feet(bars, cells, nodes, model)
    axes = np.eye(3) if cells.own_axes is None else cells.own_axes
    sign = 1.0 if item.a == bars.name else -1.0
    all_of = np.arange(len(nodes))
    held = np.eye(3)[[axis for axis in range(3) if axis not in springy]] if set(springy) & {0, 1, 2} else axes
    which, shifts = np.repeat(all_of, len(held)), np.tile(held, (len(nodes), 1))
    along, directions, lengths = pieces_of(bars, np.column_stack([nodes, all_of]))
    if item.kind == "sliding":
        which, shifts = across_lines(len(nodes), along[:, 1], directions, axes)
    turns = _turning(feet, (bars, cells), along, directions, springy) if item.kind != "pinned" else []
    rows = [feet.relative(which, np.hstack([shifts, np.zeros_like(shifts)])), *turns]
    count = sum(one.shape[0] for one in turns)
    tie = Tie(item.name, csr_array(sign * vstack(rows)), np.concatenate([shifts, np.zeros((count, 3))]), grounded=False)
    none = tie if tie.rows.shape[0] else None
    if item.kind == "sliding":
        slides = feet.relative(along[:, 1], np.hstack([directions, np.zeros_like(directions)]))
        stiffness = item.slip * lengths
    elif springy:
        each, shares = all_of, np.ones(len(nodes))
        if item.per == "length":
            each, shares = along[:, 1], lengths
            refuse_lengths(item, not len(each))
        free = np.tile(np.eye(_SIX)[springy], (len(each), 1))
        slides, directions = feet.relative(np.repeat(each, len(springy)), free), free[:, :3]
        stiffness = np.outer(shares, values).ravel()
    else:
        return none, None
    zero = np.zeros(len(stiffness))
    return none, Elastic(item.name, csr_array(sign * slides), stiffness, zero, directions, grounded=False)


def _feet(bars: Meshed, cells: Meshed, nodes: Integers, model: Model) -> _Feet:
    n_nodes, places = model.mesh.n_nodes, model.mesh.points[nodes]
    at = places
    if cells.drilling is not None:
        at = touching_face(nodes, places, bars, cells)
    own = np.zeros((len(nodes), _SIX, 1, N_COMPONENTS))
    own[:, :, 0, :_SIX] = np.eye(_SIX)
    there, motion = cells.motion_on_cells(places)
    rows = sparse_rows(nodes[:, None], carry_along_arms(own, at - places), n_nodes)
    facing = sparse_rows(there, carry_along_arms(motion, at - places), n_nodes)
    facing.data[np.abs(facing.data) < 1e-14] = 0.0  # rounding of places in cells
    facing.eliminate_zeros()
    return _Feet(nodes, places, csr_array(rows - facing))


def _turning(
    feet: _Feet, parts: tuple[Meshed, Meshed], along: Integers, directions: Floats, springy: list[int]
) -> list[csr_array]:
    """Rotations held: of ribs about their axis, of what stands on the cells all; as `plates_and_bars.turning_rows`."""
    bars, cells = parts
    free = np.eye(3)[[number - 3 for number in springy if number >= 3]]
    everywhere, normal = np.arange(len(feet.nodes)), cells.drilling
    standing = np.setdiff1d(everywhere, along[:, 1]) if normal is not None else everywhere
    rows_and_axes = [] if normal is None else [(along[:, 1], directions)]
    axes = np.eye(3) if cells.own_axes is None else cells.own_axes
    rows_and_axes += [(standing, np.tile(axis, (len(standing), 1))) for axis in axes[: 3 if normal is None else 2]]
    found = []
    for which, about in rows_and_axes:
        turn = about - about @ free.T @ free
        kept = np.flatnonzero(np.linalg.norm(turn, axis=1) > _SLIGHT)
        found.append(feet.relative(which[kept], np.hstack([np.zeros((len(kept), 3)), turn[kept]])))
    if normal is not None and len(standing) and not (np.abs(free @ normal) > _SLIGHT).any():
        n_nodes = feet.rows.shape[1] // N_COMPONENTS
        turn = np.zeros((len(standing), N_COMPONENTS))
        turn[:, 3:_SIX] = normal
        patches = cells.turning_at(feet.places[standing], bars.girth, n_nodes)
        found.append(csr_array(node_rows(feet.nodes[standing], turn, n_nodes) - patches))
    return found


# ----------------------------------------------------------------------------------------------------------------------
# Joints of shells whose meshes do not match along the lines on which they touch: both move together all along them.
#
# A line is the edges of cells of one part that lie on cells of the other, on their edges or across their insides.
# ----------------------------------------------------------------------------------------------------------------------

_ORDER: Final = 4  # Gauss points of a piece: exact for the products of motions of degree 3 and dual functions
_SHORT: Final = 1e-9  # of an edge: pieces that are shorter are rounding
_CURVED: Final = np.deg2rad(46.0)  # chords that turn by more at a node are a corner: an octagon is a curve
_ROUNDED: Final = 1.1  # a margin on bows, of chords of unequal lengths
_BESIDE: Final = 0.05  # of the diagonal of a part: chords of an octagon are less off its circle
_EQUAL_LENGTHS: Final = 1e-6  # of a length: lines that differ by less are as long


class Line(NamedTuple):
    """Nodes of one part [m] that follow another part along a line.

    rows [6 m, n_nodes * 7] : their motion less that of the other, in the mean over what belongs to each: shifts and
    rotations along global axes. lengths [m] : what belongs to each [m]. along [m, 3] : the line there. first : whether
    they are of the first part. places [6 g, n_nodes * 7] : the same motion at Gauss points of the line, and their
    weights [g] [m].
    """

    nodes: Integers
    rows: csr_array
    lengths: Floats
    along: Floats
    first: bool
    places: csr_array
    weights: Floats


class _Touch(NamedTuple):
    """Pieces of edges [p] of a part that lie on another: edge ends [p, 2], Gauss points [p, q, 3] and weights [p, q]
    [m], shape functions of both ends [p, q, 2], whether each end has a multiplier [p, 2]."""

    ends: Integers
    at: Floats
    weights: Floats
    shapes: Floats
    counts: Floats

    @property
    def length(self) -> float:
        return float(self.weights.sum())


def unlike_line(
    parts: tuple[Meshed, Meshed], nodes: tuple[Integers, Integers], tolerance: float, points: Floats
) -> Line | None:
    """The line along which two shells are joined whose nodes there do not coincide; None where they do, where they
    touch along no line, and where one lies flat on the other.

    The difference of the two motions, deflections between nodes being what the cells make of the rotations, vanishes in
    the mean with dual functions of the edges that lie wholly on the other part, or of the finer ones. These add to one,
    so that forces balance, and constant strains, curvatures and twist go across exactly. Free edges that are chords of
    a curve follow what is as near as chords are to their curve, on rigid arms.

    Source: B. I. Wohlmuth, A mortar finite element method using dual spaces for the Lagrange multiplier, SIAM J. Numer.
    Anal. 38 (2000) 989-1012, doi:10.1137/S0036142999350929.

    Parameters
    ----------
    nodes : tuple[Integers, Integers]
        Of each part, those that a joint is about.
    points : Floats
        Of all nodes [m].
    """
    if any(part.edges_of_cells is None for part in parts):
        return None
    found = [_touch(parts[i], parts[1 - i], nodes[i], nodes[1 - i], tolerance, points) for i in (0, 1)]
    lengths = [0.0 if one is None else one.length for one in found]
    if max(lengths) <= 0.0 or not any(
        one is not None and _has_unmatched_nodes(one, nodes[1 - i], tolerance, points) for i, one in enumerate(found)
    ):
        return None
    alike = abs(lengths[0] - lengths[1]) <= _EQUAL_LENGTHS * max(lengths)
    counts = [0 if one is None else len(np.unique(one.ends, axis=0)) for one in found]
    side = int(counts[1] > counts[0]) if alike else int(lengths[1] > lengths[0])
    touch = found[side]
    assert touch is not None
    return _line(touch, parts[side], parts[1 - side], len(points), side == 0)


def _touch(
    part: Meshed, other: Meshed, own: Integers, there: Integers, tolerance: float, points: Floats
) -> _Touch | None:
    """Pieces of edges of a part that lie on cells of the other; None where none do, or whole cells."""
    edges, facing = part.edges_of_cells, other.edges_of_cells
    assert edges is not None
    assert facing is not None
    on, off = np.zeros(len(points), dtype=bool), off_near(other, points[own])
    on[own] = off <= tolerance
    if on[part.quads].all(axis=1).any():
        return None
    named, named_there = (np.zeros(len(points), dtype=bool) for _ in range(2))
    named[own], named_there[there] = True, True
    bow = bow_between((part, other), (own, there), off, tolerance, points)
    rim = rim_of(part)
    free = np.isin(edges @ [len(points), 1], rim @ [len(points), 1])
    on[np.intersect1d(own[off <= tolerance + bow], rim)] = True
    within = np.where(free, tolerance + bow, tolerance)
    chosen = on[edges].any(axis=1) & named[edges].all(axis=1)
    edges, within = edges[chosen], within[chosen]
    if not len(edges):
        return None
    facing = _near(facing[named_there[facing].any(axis=1)], edges, points)
    edge, low, high = _pieces(points[edges], points[facing], within)
    gauss, weights = np.polynomial.legendre.leggauss(_ORDER)
    share = low[:, None] + (high - low)[:, None] * (gauss + 1.0) / 2.0
    start, end = np.moveaxis(points[edges[edge]], 1, 0)
    at = start[:, None] + share[..., None] * (end - start)[:, None]
    touching = (other.off_cells(at.reshape(-1, 3)).reshape(share.shape) <= within[edge][:, None]).all(axis=1)
    if not np.any(touching):
        return None
    long = np.linalg.norm(end - start, axis=1) * (high - low) / 2.0
    shapes = np.stack([1.0 - share, share], axis=2)
    ends = edges[edge]
    on_it = np.flatnonzero(touching)
    counts = on[ends].astype(np.float64)
    return _Touch(ends[on_it], at[on_it], (long[:, None] * weights)[on_it], shapes[on_it], counts[on_it])


def rim_of(part: Meshed) -> Integers:
    """Edges of cells of a part that are of one cell alone [e, 2], lower number first."""
    sides = np.stack([part.quads, np.roll(part.quads, -1, axis=1)], axis=2).reshape(-1, 2)
    edges, times = np.unique(np.sort(sides[sides[:, 0] != sides[:, 1]], axis=1), axis=0, return_counts=True)
    return np.asarray(edges[times == 1])


def off_near(part: Meshed, places: Floats) -> Floats:
    """How far places [p, 3] are off cells of a part [p] [m], infinite for those that are far beside all of it."""
    low, high = part.places.min(axis=0), part.places.max(axis=0)
    beside = _BESIDE * float(np.linalg.norm(high - low))
    near = np.flatnonzero(((places >= low - beside) & (places <= high + beside)).all(axis=1))
    found = np.full(len(places), np.inf)
    if len(near):
        found[near] = part.off_cells(places[near])
    return found


def bow_between(
    parts: tuple[Meshed, Meshed], nodes: tuple[Integers, Integers], off: Floats, tolerance: float, points: Floats
) -> float:
    """How far chords of a curve lie off it [m] where a part is near another; 0 where both are straight there.

    Parameters
    ----------
    off : Floats
        How far the nodes of the first are off the cells of the second [m].
    """
    bows = [_bows(part, points) for part in parts]
    most = max(float(one.max(initial=0.0)) for one in bows)
    if most <= tolerance:
        return 0.0
    near = nodes[0][off <= tolerance + most]
    if not len(near):
        return 0.0
    apart = np.asarray(KDTree(points[near]).query(points[nodes[1]])[0])
    edges = points[rim_of(parts[0])]
    reach = most + float(np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1).max(initial=0.0))
    return max(float(bows[0][near].max()), float(bows[1][nodes[1][apart <= reach]].max(initial=0.0)))


def _bows(part: Meshed, points: Floats) -> Floats:
    """How far chords lie off their curve at the nodes of a rim, and cells off theirs at all nodes, by how much
    neighbours turn there [n_nodes] [m]; corners turn by more than curves do."""
    found = np.zeros(len(points))
    rim = rim_of(part)
    ends, steps = np.concatenate([rim, rim[:, ::-1]]), points[rim[:, 1]] - points[rim[:, 0]]
    order = np.argsort(ends[:, 0], kind="stable")
    ends, steps = ends[order], np.concatenate([steps, -steps])[order]
    node, start, count = np.unique(ends[:, 0], return_index=True, return_counts=True)
    two = np.flatnonzero(count == 2)
    first, second = steps[start[two]], steps[start[two] + 1]
    found[node[two]] = _turned_by(-first, second)
    sides = np.sort(np.stack([part.quads, np.roll(part.quads, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    cell = np.repeat(np.arange(len(part.quads)), 4)
    order = np.lexsort((sides[:, 1], sides[:, 0]))
    sides, cell = sides[order], cell[order]
    twice = np.flatnonzero((sides[1:] == sides[:-1]).all(axis=1) & (sides[1:, 0] != sides[1:, 1]))
    middles = points[part.quads].mean(axis=1)
    one, other = cell[twice], cell[twice + 1]
    hinge = points[sides[twice]]
    away = [middles[some] - hinge.mean(axis=1) for some in (one, other)]
    along = hinge[:, 1] - hinge[:, 0]
    along = along / np.linalg.norm(along, axis=1)[:, None]
    across = [some - (some * along).sum(axis=1)[:, None] * along for some in away]
    bows = _turned_by(-2.0 * across[0], 2.0 * across[1])
    for end in (0, 1):
        np.maximum.at(found, sides[twice, end], bows)
    return found


def _turned_by(first: Floats, second: Floats) -> Floats:
    """Bow of the longer one of chords [m, 3] that follow on each other [m]; 0 where they turn by more than a curve."""
    lengths = np.linalg.norm(first, axis=1), np.linalg.norm(second, axis=1)
    turn = np.arctan2(np.linalg.norm(np.cross(first, second), axis=1), (first * second).sum(axis=1))
    bows: Floats = np.where(turn <= _CURVED, _ROUNDED * np.maximum(*lengths) * np.tan(turn / 4.0) / 2.0, 0.0)
    return bows


def _near(facing: Integers, edges: Integers, points: Floats) -> Integers:
    """Those of the facing edges whose boxes meet the box around the edges."""
    low, high = points[edges].min(axis=(0, 1)), points[edges].max(axis=(0, 1))
    small = _EQUAL_LENGTHS * float(np.linalg.norm(high - low))
    ends = points[facing]
    meets = ((ends.max(axis=1) >= low - small) & (ends.min(axis=1) <= high + small)).all(axis=1)
    return facing[np.flatnonzero(meets)]


def _pieces(edges: Floats, facing: Floats, tolerance: Floats) -> tuple[Integers, Floats, Floats]:
    """Edges [e, 2, 3] cut where facing ones [f, 2, 3] cross or end on them: edge [p], and its shares from, to [p].

    Parameters
    ----------
    tolerance : Floats [e]
        How far off each these may be [m].
    """
    steps = edges[:, 1] - edges[:, 0]
    square = (steps**2).sum(axis=1)
    number, cut = [np.repeat(np.arange(len(edges)), 2)], [np.tile([0.0, 1.0], len(edges))]
    for end in (0, 1):  # where they end on an edge
        away = facing[None, :, end] - edges[:, None, 0]
        share = (away * steps[:, None]).sum(axis=2) / square[:, None]
        off = np.linalg.norm(away - share[..., None] * steps[:, None], axis=2)
        which, _ = hit = np.nonzero((off <= tolerance[:, None]) & (share > 0.0) & (share < 1.0))
        number.append(which)
        cut.append(share[hit])
    other = facing[:, 1] - facing[:, 0]
    away = edges[:, None, 0] - facing[None, :, 0]
    aa, bb = square[:, None], (other**2).sum(axis=1)[None]
    ab = steps @ other.T
    a, b = (away * steps[:, None]).sum(axis=2), (away * other[None]).sum(axis=2)
    area = aa * bb - ab**2
    oblique = area > _EQUAL_LENGTHS * aa * bb
    scale = np.where(oblique, area, 1.0)
    s, t = (ab * b - bb * a) / scale, (aa * b - ab * a) / scale
    off = np.linalg.norm(away + s[..., None] * steps[:, None] - t[..., None] * other[None], axis=2)
    crossed = oblique & (off <= tolerance[:, None]) & (s > 0.0) & (s < 1.0) & (t >= 0.0) & (t <= 1.0)
    number.append(np.nonzero(crossed)[0])
    cut.append(s[crossed])
    which, share = np.concatenate(number), np.concatenate(cut)
    order = np.lexsort((share, which))
    which, share = which[order], share[order]
    real = (which[1:] == which[:-1]) & (share[1:] - share[:-1] > _SHORT)
    return which[:-1][real], share[:-1][real], share[1:][real]


def _has_unmatched_nodes(touch: _Touch, there: Integers, tolerance: float, points: Floats) -> bool:
    """Whether nodes of a part on another have none of its nodes at their place."""
    nodes = np.unique(touch.ends[touch.counts > 0.0])
    apart = np.asarray(KDTree(points[there]).query(points[nodes])[0])
    return bool((apart > tolerance).any())


def _line(touch: _Touch, part: Meshed, other: Meshed, n_nodes: int, first: bool) -> Line:
    edges, which = np.unique(touch.ends, axis=0, return_inverse=True)
    which = which.ravel()
    products, own = np.zeros((len(edges), 2, 2)), np.zeros((len(edges), 2))
    np.add.at(products, which, np.einsum("pqk,pq,pql->pkl", touch.shapes, touch.weights, touch.shapes))
    np.add.at(own, which, np.einsum("pqk,pq->pk", touch.shapes, touch.weights))
    dual = np.einsum("pkl,pql->pqk", (own[:, :, None] * np.linalg.inv(products))[which], touch.shapes)
    # An edge that ends beside the other part has one multiplier, of the node on it, that is 1.
    dual = np.where(touch.counts.min(axis=1)[:, None, None] > 0.0, dual, touch.counts[:, None, :])
    nodes = np.unique(touch.ends[touch.counts > 0.0])
    owner = np.searchsorted(nodes, touch.ends).clip(max=len(nodes) - 1)
    pushes = dual * touch.weights[..., None]  # [p, q, 2]
    p, q = touch.weights.shape
    matter = np.flatnonzero(np.broadcast_to(touch.counts[:, None, :], (p, q, 2)))
    row = np.broadcast_to(owner[:, None, :], (p, q, 2)).ravel()[matter]
    column = np.repeat(np.arange(p * q), 2)[matter]
    lengths = np.bincount(row, pushes.ravel()[matter], minlength=len(nodes)).astype(np.float64)
    value = pushes.ravel()[matter] / lengths[row]
    six = np.arange(6)
    mean = csr_array(
        (
            np.repeat(value, 6),
            ((6 * row[:, None] + six).ravel(), (6 * column[:, None] + six).ravel()),
        ),
        shape=(6 * len(nodes), 6 * p * q),
    )
    at = touch.at.reshape(-1, 3)
    motions = [sparse_rows(*one.motion_on_cells(at), n_nodes) for one in (part, other)]
    apart = csr_array(motions[0] - motions[1]) if first else csr_array(motions[1] - motions[0])
    rows = csr_array(mean @ apart)
    rows.data[np.abs(rows.data) < 1e-14] = 0.0  # rounding of factors, which are about 1
    rows.eliminate_zeros()
    ends = part.places[touch.ends - part.first]
    step = ends[:, 1] - ends[:, 0]
    along = np.zeros((len(nodes), 3))
    largest = step[np.arange(p), np.abs(step).argmax(axis=1)]
    step = step * (np.sign(largest) / np.linalg.norm(step, axis=1))[:, None]
    for end in (0, 1):
        np.add.at(along, owner[touch.counts[:, end] > 0.0, end], step[touch.counts[:, end] > 0.0])
    along /= np.linalg.norm(along, axis=1)[:, None]
    return Line(nodes, rows, lengths, along, first, apart, touch.weights.ravel())


def in_components(rows: csr_array, components: Floats) -> csr_array:
    """Relative motion [6 m, n_nodes * 7] of a line in components [c, 7] or [m, c, 7]: [m * c, n_nodes * 7]."""
    m = rows.shape[0] // 6
    each = np.broadcast_to(components, (m, *components.shape[-2:]))[..., :6]
    count = each.shape[1]
    row = np.repeat(np.arange(m * count), 6)
    column = np.tile(6 * np.arange(m)[:, None, None] + np.arange(6), (1, count, 1)).ravel()
    chosen = csr_array((each.ravel(), (row, column)), shape=(m * count, 6 * m))
    chosen.eliminate_zeros()
    return csr_array(chosen @ rows)


# ----------------------------------------------------------------------------------------------------------------------
# Joints of solids whose meshes do not match on the flat faces that touch: both move together all over them.
# ----------------------------------------------------------------------------------------------------------------------

APART: Final = 1e-3  # of a side of a face: a middle that is farther off makes it curved
_EQUAL_AREAS: Final = 1e-6  # of an area: sides that differ by less are as large

_ByKind = Mapping[str, Integers]


class _Plane(NamedTuple):
    """Faces of both parts in one plane, and places of all nodes in it [n_nodes, 2]."""

    sides: tuple[_ByKind, _ByKind]
    places: Floats


def unlike_area(
    parts: tuple[Meshed, Meshed], nodes: tuple[Integers, Integers], tolerance: float, points: Floats
) -> csr_array | None:
    """Motion of the first of two solids less that of the second [m, n_nodes], in means over the flat area over which
    they are joined, where their nodes do not coincide there; None where they do, and where they share no flat area.
    Nodes beside it that coincide, as on curved faces, have a row each.

    The difference of the two motions vanishes in the mean, as `femstruct.model.seams` says, with the
    functions of the side whose faces lie on the other, or of the finer one; one sum for all planes, so that an edge
    between two of them has one function.

    Parameters
    ----------
    nodes : tuple[Integers, Integers]
        Of each part, those that a joint is about.
    points : Floats
        Of all nodes [m].
    """
    outer = [
        _near_faces(part, other, own, tolerance, points)
        for part, other, own in zip(parts, parts[::-1], nodes, strict=True)
    ]
    if not all(outer):
        return None
    on = [np.zeros(len(points), dtype=bool) for _ in parts]
    for i, faces in enumerate(outer):
        of = np.unique(np.concatenate([some.ravel() for some in faces.values()]))
        on[i][of] = parts[1 - i].off_cells(points[of]) <= tolerance
    if (on[0].any() or on[1].any()) and not any(
        _has_unmatched_face_nodes(on[i], nodes[1 - i], tolerance, points) for i in (0, 1)
    ):
        return None
    planes = _planes(outer[0], outer[1], points, tolerance)
    if not planes:
        return None
    found = [_summed(planes, side, on[side]) for side in (0, 1)]
    if float(found[0].means.areas.sum()) <= 0.0:
        return None
    whole, count = [one.means.whole for one in found], [int(one.sum()) for one in on]
    alike = abs(whole[0] - whole[1]) <= _EQUAL_AREAS * max(whole)
    side = int(count[1] > count[0]) if alike else int(whole[1] > whole[0])
    rows = _area(found[side], side, len(points))
    return csr_array(vstack([rows, _at_nodes(rows, on, tolerance, points)]))


def _at_nodes(rows: csr_array, on: list[NDArray[np.bool_]], tolerance: float, points: Floats) -> csr_array:
    """Motion of nodes of the first part less that of nodes of the second at their place, where rows have neither."""
    first, second = (np.setdiff1d(np.flatnonzero(some), rows.indices) for some in on)
    n = len(points)
    if not len(first) or not len(second):
        return csr_array((0, n))
    apart, nearest = KDTree(points[second]).query(points[first])
    met = np.flatnonzero(np.asarray(apart) <= tolerance)
    row, pairs = np.arange(len(met)), (first[met], second[np.asarray(nearest)[met]])
    values = np.repeat([1.0, -1.0], len(met))
    return csr_array((values, (np.concatenate([row, row]), np.concatenate(pairs))), shape=(len(met), n))


def _near_faces(part: Meshed, other: Meshed, own: Integers, tolerance: float, points: Floats) -> _ByKind:
    """Faces of a solid, all of whose nodes are named, with boxes that meet the box of another part."""
    low, high = other.places.min(axis=0) - tolerance, other.places.max(axis=0) + tolerance
    found = {}
    for kind, faces in part.faces_at(f"parts.{part.name}", Region("whole"), tolerance).items():
        at = points[faces]
        kept = np.isin(faces, own).all(axis=1) & (at.max(axis=1) >= low).all(axis=1) & (at.min(axis=1) <= high).all(1)
        if kept.any():
            found[kind] = faces[kept]
    return found


def _has_unmatched_face_nodes(on: NDArray[np.bool_], there: Integers, tolerance: float, points: Floats) -> bool:
    """Whether nodes of a part on another have none of its nodes at their place."""
    apart = np.asarray(KDTree(points[there]).query(points[on])[0])
    return bool((apart > tolerance).any())


def _planes(first: _ByKind, second: _ByKind, points: Floats, tolerance: float) -> list[_Plane]:
    """The planes in which both parts have faces; curved faces are in none."""
    found = []
    left = {kind: np.ones(len(faces), dtype=bool) for kind, faces in first.items()}
    while (kind := next((one for one, some in left.items() if some.any()), None)) is not None:
        face = int(np.flatnonzero(left[kind])[0])
        left[kind][face] = False
        corners = points[first[kind][face, : KINDS[kind].corners]]
        middle = corners.mean(axis=0)
        axes = np.linalg.svd(corners - middle)[2]
        flat = np.abs((points - middle) @ axes[2]) <= tolerance
        within = [
            {name: flat[faces].all(axis=1) & _straight(name, points[faces]) for name, faces in side.items()}
            for side in (first, second)
        ]
        sides = [
            {name: faces[chosen[name]] for name, faces in side.items() if chosen[name].any()}
            for side, chosen in zip((first, second), within, strict=True)
        ]
        for name, inside in within[0].items():
            left[name] &= ~inside
        if all(sides):
            found.append(_Plane((sides[0], sides[1]), (points - middle) @ axes[:2].T))
    return found


def _straight(kind: str, places: Floats) -> NDArray[np.bool_]:
    """Which faces [m, k, 3] have the middles of their sides in the middle between their ends."""
    cell, found = KINDS[kind], np.ones(len(places), dtype=bool)
    for number, (one, other) in enumerate(cell.edges if cell.quadratic else ()):
        ends, middle = places[:, [one, other]], places[:, cell.corners + number]
        off = np.linalg.norm(middle - ends.mean(axis=1), axis=1)
        found &= off <= APART * np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    return found


class _Sums(NamedTuple):
    """Means over all planes. used : nodes of the side that follows and of the other, which the columns are; nodes :
    faces of the first among them, by kind; means : the rows of its nodes, and one for each face after them."""

    used: tuple[Integers, Integers]
    nodes: _ByKind
    means: Means


def _summed(planes: list[_Plane], side: int, on: NDArray[np.bool_]) -> _Sums:
    own, other = (_together([plane.sides[i] for plane in planes]) for i in (side, 1 - side))
    used = [np.unique(np.concatenate([some.ravel() for some in faces.values()])) for faces in (own, other)]
    found = []
    for plane in planes:
        first, second = (
            Faces({kind: np.searchsorted(of, some) for kind, some in plane.sides[i].items()}, plane.places[of])
            for i, of in zip((side, 1 - side), used, strict=True)
        )
        found.append(means_over(first, second, on[used[0]]))
    n = len(used[0])
    rows = [_stacked(of, n) for of in ([one.own for one in found], [one.other for one in found])]
    areas = np.concatenate([np.sum([one.areas[:n] for one in found], axis=0), *(one.areas[n:] for one in found)])
    numbered = {kind: np.searchsorted(used[0], some) for kind, some in own.items()}
    return _Sums((used[0], used[1]), numbered, Means(rows[0], rows[1], areas, sum(one.whole for one in found)))


def _stacked(of: list[csr_array], n: int) -> csr_array:
    """Sums of the first n rows of each, and below them the others of each."""
    first = of[0][:n]
    for more in of[1:]:
        first = csr_array(first + more[:n])
    return csr_array(vstack([first, *(one[n:] for one in of)]))


def _together(sides: list[_ByKind]) -> _ByKind:
    kinds = {kind for side in sides for kind in side}
    return {kind: np.concatenate([side[kind] for side in sides if kind in side]) for kind in sorted(kinds)}


def _area(found: _Sums, side: int, n_nodes: int) -> csr_array:
    """Rows of the first part less the second, over the areas of their functions, those of corners and middles of one
    side so combined that each has one node that follows alone."""
    (own, other), means, n = found.used, found.means, len(found.used[0])
    kept = np.flatnonzero(means.areas > NEGLIGIBLE * means.areas.max())
    of_nodes = kept[kept < n]
    combined = changed(Faces(found.nodes, np.zeros((n, 2))))[of_nodes][:, of_nodes]
    combined = csr_array(block_diag([combined, eye_array(len(kept) - len(of_nodes))]))
    scaled = csr_array(combined @ diags_array(1.0 / means.areas[kept]))
    at = [_placed(csr_array(scaled @ rows[kept]), of, n_nodes) for rows, of in ((means.own, own), (means.other, other))]
    rows = csr_array(at[0] - at[1])
    rows.data[np.abs(rows.data) < NEGLIGIBLE] = 0.0
    rows.eliminate_zeros()
    return rows if side == 0 else csr_array(-rows)


def _placed(rows: csr_array, nodes: Integers, n_nodes: int) -> csr_array:
    """Rows [m, k] on some nodes [k] as rows on all."""
    at = rows.tocoo()
    return csr_array((at.data, (at.row, nodes[at.col])), shape=(rows.shape[0], n_nodes))
