"""Joints of shells whose meshes do not match along the lines on which they touch: both move together all along them.

A line is the edges of cells of one part that lie on cells of the other, on their edges or across their insides.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
from scipy.sparse import csr_array
from scipy.spatial import KDTree

from femstruct.arrays import Floats, Integers
from femstruct.model.meshed import Meshed
from femstruct.model.rows import sparse_rows

_ORDER: Final = 4  # Gauss points of a piece: exact for the products of motions of degree 3 and dual functions
_SHORT: Final = 1e-9  # of an edge: pieces that are shorter are rounding
_CURVED: Final = np.deg2rad(46.0)  # chords that turn by more at a node are a corner: an octagon is a curve
_ROUNDED: Final = 1.1  # a margin on bows, of chords of unequal lengths
_BESIDE: Final = 0.05  # of the diagonal of a part: chords of an octagon are less off its circle
_EQUAL: Final = 1e-6  # of a length: lines that differ by less are as long


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

    nodes : of each part, those that a joint is about. points : of all nodes [m].

    The difference of the two motions, deflections between nodes being what the cells make of the rotations, vanishes in
    the mean with dual functions of the edges that lie wholly on the other part, or of the finer ones. These add to one,
    so that forces balance, and constant strains, curvatures and twist go across exactly. Free edges that are chords of
    a curve follow what is as near as chords are to their curve, on rigid arms.

    Source: B. I. Wohlmuth, A mortar finite element method using dual spaces for the Lagrange multiplier, SIAM J. Numer.
    Anal. 38 (2000) 989-1012, doi:10.1137/S0036142999350929.
    """
    if any(part.edges_of_cells is None for part in parts):
        return None
    found = [_touch(parts[i], parts[1 - i], nodes[i], nodes[1 - i], tolerance, points) for i in (0, 1)]
    lengths = [0.0 if one is None else one.length for one in found]
    if max(lengths) <= 0.0 or not any(
        one is not None and _lone(one, nodes[1 - i], tolerance, points) for i, one in enumerate(found)
    ):
        return None
    alike = abs(lengths[0] - lengths[1]) <= _EQUAL * max(lengths)
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

    off : how far the nodes of the first are off the cells of the second [m].
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
    small = _EQUAL * float(np.linalg.norm(high - low))
    ends = points[facing]
    meets = ((ends.max(axis=1) >= low - small) & (ends.min(axis=1) <= high + small)).all(axis=1)
    return facing[np.flatnonzero(meets)]


def _pieces(edges: Floats, facing: Floats, tolerance: Floats) -> tuple[Integers, Floats, Floats]:
    """Edges [e, 2, 3] cut where facing ones [f, 2, 3] cross or end on them: edge [p], and its shares from, to [p].

    tolerance [e] : how far off each these may be [m].
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
    oblique = area > _EQUAL * aa * bb
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


def _lone(touch: _Touch, there: Integers, tolerance: float, points: Floats) -> bool:
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
