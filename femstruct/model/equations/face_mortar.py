"""Motion across flat faces of solids that meet with different nodes: integrals over the pieces that two faces share."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array, diags_array, eye_array
from scipy.spatial import KDTree

from femstruct.arrays import Floats, Integers
from femstruct.model.imported.cell_kinds import KINDS

NEGLIGIBLE: Final = 1e-12  # of a piece over the face it is of, and of a factor: rounding
SHARE: Final = 0.2  # of the function of a middle, to each of the two corners beside it
_WHOLE: Final = 1e-6  # of a face: less of it beside the other side is rounding of places
_IN_LINE: Final = 1e-3  # of the extent of faces: nodes that are less off a line hold nothing about it
_DEGREE: Final = 10  # of products of shape functions: 6 for parallel sides; of other sides the rest is 1e-12
_STEPS: Final = 8  # of Newton's method from the middle of a convex quadrilateral, whose error squares each time
_LINEAR: Final = ((0, 0), (1, 0), (0, 1))
_POWERS: Final[Mapping[str, tuple[tuple[int, int], ...]]] = {
    "tri3": _LINEAR,
    "tri6": (*_LINEAR, (2, 0), (1, 1), (0, 2)),
    "quad4": (*_LINEAR, (1, 1)),
    "quad8": (*_LINEAR, (1, 1), (2, 0), (0, 2), (2, 1), (1, 2)),
    "quad9": (*_LINEAR, (1, 1), (2, 0), (0, 2), (2, 1), (1, 2), (2, 2)),
}


class Faces(NamedTuple):
    """Flat faces on one side: nodes [m, k] by kind, counted from 0 on, and places of the nodes in the plane [n, 2]."""

    nodes: Mapping[str, Integers]
    places: Floats


class Crossing(NamedTuple):
    """factors [m, n] : motion of the m nodes of the first side from that of the n of the second. covered : share of the
    area of the first that has some of the second against it [1]."""

    factors: csr_array
    covered: float


def across_faces(first: Faces, second: Faces) -> Crossing:
    """How nodes of one side follow those of the other, so that the difference of both motions, weighted with the dual
    functions of the first, vanishes.

    Each face of one side is cut by each of the other that it meets, and products of functions are summed over the
    triangles of the pieces. A dual function of a node has no integral with the functions of the other nodes of its
    face, so each node follows those of a few faces alone. Motions that are linear over the plane go across exactly, and
    so does a constant pressure. Functions of corners of quadratic faces have no positive integral; they take a share of
    those of the middles beside them.

    Source: M. A. Puso, A 3D mortar method for solid mechanics, Int. J. Numer. Methods Eng. 59 (2004) 315-336,
    doi:10.1002/nme.865; A. Popp, B. I. Wohlmuth, M. W. Gee, W. A. Wall, Dual quadratic mortar finite element methods
    for 3D finite deformation contact, SIAM J. Sci. Comput. 34 (2012) B421-B446, doi:10.1137/110848190.

    One square beside two rectangles:

    >>> one = Faces({"quad4": np.array([[0, 1, 2, 3]])}, np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]]))
    >>> halves = Faces(
    ...     {"quad4": np.array([[0, 1, 4, 3], [1, 2, 5, 4]])},
    ...     np.array([[0.0, 0], [0.5, 0], [1, 0], [0, 1], [0.5, 1], [1, 1]]),
    ... )
    >>> found = across_faces(halves, one)
    >>> round(found.covered, 12), found.factors.toarray()[1].round(12).tolist()  # the middle of a side
    (1.0, [0.5, 0.5, 0.0, 0.0])
    """
    n, total, area = len(first.places), 0.0, 0.0
    belongs, other = np.zeros(n), csr_array((n, len(second.places)))
    for kind, nodes in first.nodes.items():
        corners = first.places[nodes[:, : KINDS[kind].corners]]
        total += float(np.abs(_areas(corners)).sum())
        overlaps = [_overlap(kind, corners, against, facing, second.places) for against, facing in second.nodes.items()]
        dual, own = _dual(overlaps, len(nodes))
        np.add.at(belongs, nodes, own)
        for one in overlaps:
            area += float(one.weights.sum())
            functions = np.einsum("tij,tqj->tqi", dual[one.face], one.shapes)
            blocks = np.einsum("tqk,tq,tql->tkl", functions, one.weights, one.facing, optimize=True)
            rows, columns = np.broadcast_arrays(nodes[one.face][:, :, None], one.against[:, None, :])
            added = coo_array((blocks.ravel(), (rows.ravel(), columns.ravel())), shape=other.shape)
            other = csr_array(other + csr_array(added))
    scale = np.divide(1.0, belongs, out=np.zeros(n), where=belongs > 0.0)
    factors = csr_array(changed(first) @ (diags_array(scale) @ other))
    factors.data[np.abs(factors.data) < NEGLIGIBLE] = 0.0
    factors.eliminate_zeros()
    return Crossing(factors, area / total)


class Means(NamedTuple):
    """Integrals over the area that two sides share, of the functions of rows times the motion of each side.

    own [r, n], other [r, n'] : of the rows, the first n of which belong to the nodes of the first side, the others to
    faces that none of these nodes belongs to. areas [r] : of the functions [m^2], zero for rows without any.
    whole : area of the faces all of which is shared [m^2].
    """

    own: csr_array
    other: csr_array
    areas: Floats
    whole: float


def means_over(first: Faces, second: Faces, counted: NDArray[np.bool_]) -> Means:
    """Means of the motions of two sides over the area that they share, as `across_faces`, of faces that may reach
    beyond it.

    counted [n] : nodes of the first side that lie on the second, each of which has a function. Those of a face beside
    the other side's rim are its shape functions, to which those of its other nodes are added evenly, so that all add to
    one; a face without such a node has one function, that is 1. Where they lie on one line at most, three functions,
    linear over all that is shared, hold what could turn about it.
    """
    n, faces = len(first.places), sum(len(nodes) for nodes in first.nodes.values())
    start, whole, size = n, 0.0, n + faces + len(_LINEAR)
    own, other, areas = csr_array((size, n)), csr_array((size, len(second.places))), np.zeros(size)
    used = np.unique(np.concatenate([nodes.ravel() for nodes in first.nodes.values()]))
    low, high = first.places[used].min(axis=0), first.places[used].max(axis=0)
    in_line = _in_line(first.places[used[counted[used]]] / (high - low))
    for kind, nodes in first.nodes.items():
        corners = first.places[nodes[:, : KINDS[kind].corners]]
        overlaps = [_overlap(kind, corners, against, facing, second.places) for against, facing in second.nodes.items()]
        functions, inside = _functions(overlaps, corners, counted[nodes])
        whole += float(np.abs(_areas(corners[inside])).sum())
        rows = np.column_stack([nodes, start + np.arange(len(nodes))])
        start += len(nodes)
        for one in overlaps:
            plain = one.shapes @ np.linalg.inv(_shares(kind))
            weighed = np.einsum("tij,tqj,tq->tqi", functions[one.face], one.shapes, one.weights, optimize=True)
            at = rows[one.face]
            if in_line:
                share = (plain @ first.places[nodes[one.face]] - low) / (high - low)
                linear = np.concatenate([np.ones_like(share[..., :1]), share], axis=2) * one.weights[..., None]
                weighed = np.concatenate([weighed, linear], axis=2)
                at = np.hstack([at, np.tile(n + faces + np.arange(len(_LINEAR)), (len(at), 1))])
            areas += np.bincount(at.ravel(), weighed.sum(axis=1).ravel(), minlength=size)
            own = own + _scattered(at, nodes[one.face], weighed, plain, own.shape)
            other = other + _scattered(at, one.against, weighed, one.facing, other.shape)
    return Means(csr_array(own), csr_array(other), areas, whole)


def _in_line(places: Floats) -> bool:
    """Whether places [n, 2], in shares of an extent, lie on one line."""
    return len(places) < 3 or float(np.linalg.svd(places - places.mean(axis=0), compute_uv=False)[1]) < _IN_LINE


def _functions(overlaps: list[_Overlap], corners: Floats, on: NDArray[np.bool_]) -> tuple[Floats, NDArray[np.bool_]]:
    """Functions of the nodes of faces and of the faces themselves [m, k + 1, k], from those that take a share, and
    which faces are shared all over [m]. on [m, k] : nodes that count."""
    shared = np.sum([np.bincount(one.face, one.weights.sum(axis=1), minlength=len(on)) for one in overlaps], axis=0)
    inside = on.all(axis=1) & (shared > (1.0 - _WHOLE) * np.abs(_areas(corners)))
    dual = _dual(overlaps, len(on), ~inside)[0]
    spread = ~on / np.maximum(on.sum(axis=1), 1)[:, None]
    beside = on[:, :, None] * (np.eye(on.shape[1]) + spread[:, None, :])
    lone = np.broadcast_to(np.where(on.any(axis=1), 0.0, 1.0)[:, None, None], beside[:, :1].shape)
    return np.concatenate([np.where(inside[:, None, None], dual, beside), lone], axis=1), inside


def _scattered(rows: Integers, columns: Integers, weighed: Floats, shapes: Floats, shape: tuple[int, int]) -> csr_array:
    blocks = np.einsum("tqk,tql->tkl", weighed, shapes)
    at = np.broadcast_arrays(rows[:, :, None], columns[:, None, :])
    return csr_array(coo_array((blocks.ravel(), (at[0].ravel(), at[1].ravel())), shape=shape))


class _Overlap(NamedTuple):
    """Triangles [t] of what faces share with others. face [t] : whose; shapes, facing [t, q, k] : functions of both at
    places of integration, of the first those that take a share; weights [t, q]; against [t, l] : nodes of the other."""

    face: Integers
    shapes: Floats
    weights: Floats
    facing: Floats
    against: Integers


def _overlap(kind: str, corners: Floats, against: str, facing: Integers, places: Floats) -> _Overlap:
    opposite = places[facing[:, : KINDS[against].corners]]
    one, two = _near(corners, opposite)
    pieces, pair = _shared(corners[one], opposite[two])
    at, weights = _points(pieces)
    face, other = one[pair], two[pair]
    shapes = _shapes(kind, _inside(corners[face], at)) @ _shares(kind)
    return _Overlap(face, shapes, weights, _shapes(against, _inside(opposite[other], at)), facing[other])


def _dual(overlaps: list[_Overlap], count: int, without: NDArray[np.bool_] | None = None) -> tuple[Floats, Floats]:
    """Dual functions of each face from its own [m, k, k], and what belongs to each of its nodes [m, k] [m^2]. without
    [m] : faces that need none."""
    k = overlaps[0].shapes.shape[-1]
    products, own = np.zeros((count, k, k)), np.zeros((count, k))
    for one in overlaps:
        np.add.at(products, one.face, np.einsum("tqk,tq,tql->tkl", one.shapes, one.weights, one.shapes, optimize=True))
        np.add.at(own, one.face, np.einsum("tq,tqk->tk", one.weights, one.shapes))
    lone = own.sum(axis=1) <= 0.0  # faces with nothing against them
    products[lone if without is None else lone | without] = np.eye(k)
    return own[:, :, None] * np.linalg.inv(products), own


@cache
def _shares(kind: str) -> Floats:
    """Functions that take a share, from the shape functions [k, k]; the motion of the nodes from their coefficients."""
    cell = KINDS[kind]
    found = np.eye(cell.nodes)
    for number, edge in enumerate(cell.edges if kind in ("tri6", "quad8") else ()):
        middle = cell.corners + number
        found[middle, list(edge)], found[middle, middle] = SHARE, 1.0 - 2.0 * SHARE
    return found


def changed(side: Faces) -> csr_array:
    """Motion of the nodes of a side [n, n] from the coefficients of the functions that take a share."""
    whole = eye_array(len(side.places), format="lil")
    for kind, nodes in side.nodes.items():
        shares = _shares(kind)
        for middle in np.flatnonzero(np.diagonal(shares) < 1.0):
            ends = np.flatnonzero(shares[middle] == SHARE)
            whole[nodes[:, middle], nodes[:, middle]] = 1.0 - 2.0 * SHARE
            for end in ends:
                whole[nodes[:, middle], nodes[:, end]] = SHARE
    return csr_array(whole)


def _areas(corners: Floats) -> Floats:
    """Signed areas of polygons [m, k, 2]."""
    x, y = corners[..., 0], corners[..., 1]
    areas: Floats = 0.5 * (x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum(axis=1)
    return areas


def _near(one: Floats, other: Floats) -> tuple[Integers, Integers]:
    """Pairs of polygons whose circles about the means of their corners meet."""
    middles = one.mean(axis=1), other.mean(axis=1)
    radii = [np.linalg.norm(of - at[:, None], axis=2).max() for of, at in zip((one, other), middles, strict=True)]
    found = KDTree(middles[0]).query_ball_tree(KDTree(middles[1]), float(sum(radii)))
    counts = [len(some) for some in found]
    return np.repeat(np.arange(len(one)), counts), np.concatenate([np.asarray(some, dtype=np.int64) for some in found])


def _shared(polygons: Floats, clippers: Floats) -> tuple[Floats, Integers]:
    """The convex polygons that pairs of convex ones [p, k, 2] and [p, l, 2] share, as triangles [t, 3, 2], and the pair
    of each; a polygon is cut by the sides of the other one after the other (Sutherland and Hodgman)."""
    clippers = np.where((_areas(clippers) > 0.0)[:, None, None], clippers, clippers[:, ::-1])
    count = np.full(len(polygons), polygons.shape[1])
    for side in range(clippers.shape[1]):
        start, end = clippers[:, side], clippers[:, (side + 1) % clippers.shape[1]]
        polygons, count = _cut(polygons, count, start, end - start)
    first, middle = polygons[:, :1], np.stack([polygons[:, 1:-1], polygons[:, 2:]], axis=2)
    triangles = np.concatenate([np.broadcast_to(first[:, None], (*middle.shape[:2], 1, 2)), middle], axis=2)
    used = np.arange(middle.shape[1]) < (count - 2)[:, None]
    pair = np.nonzero(used)[0]
    found = triangles[used]
    kept = np.abs(_areas(found)) > NEGLIGIBLE * np.abs(_areas(clippers))[pair]
    return found[kept], pair[kept]


def _cut(polygons: Floats, count: Integers, start: Floats, along: Floats) -> tuple[Floats, Integers]:
    """What of polygons [p, k, 2], of which the first `count` corners count, lies left of lines."""
    p, k = polygons.shape[:2]
    number = np.arange(k)
    following = np.where(number + 1 < count[:, None], number + 1, 0)
    off = polygons - start[:, None]
    height = along[:, None, 0] * off[..., 1] - along[:, None, 1] * off[..., 0]
    after, height_after = (
        np.take_along_axis(polygons, following[..., None], 1),
        np.take_along_axis(height, following, 1),
    )
    valid = number < count[:, None]
    kept = valid & (height >= 0.0)
    crossed = valid & ((height >= 0.0) != (height_after >= 0.0))
    share = np.divide(height, height - height_after, out=np.zeros_like(height), where=crossed)
    both = np.stack([polygons, polygons + share[..., None] * (after - polygons)], axis=2).reshape(p, 2 * k, 2)
    taken = np.stack([kept, crossed], axis=2).reshape(p, 2 * k)
    order = np.argsort(~taken, axis=1, kind="stable")
    left = taken.sum(axis=1)
    most = max(int(left.max(initial=0)), 3)
    return np.take_along_axis(both, order[..., None], 1)[:, :most], left


def _points(triangles: Floats) -> tuple[Floats, Floats]:
    """Places [t, q, 2] and weights [t, q] of integration over triangles."""
    at, weights = _triangle()
    corners = triangles[:, :1] + at @ (triangles[:, 1:] - triangles[:, :1])
    return corners, 2.0 * np.abs(_areas(triangles))[:, None] * weights


@cache
def _triangle() -> tuple[Floats, Floats]:
    """Places [q, 2] and weights [q] in the triangle (0,0) (1,0) (0,1), whose area is 1/2."""
    from skfem.quadrature import get_quadrature
    from skfem.refdom import RefTri

    at, weights = get_quadrature(RefTri, _DEGREE)
    return np.asarray(at.T), np.asarray(weights)


def _inside(corners: Floats, at: Floats) -> Floats:
    """Where places [p, q, 2] are in their triangles or quadrilaterals [p, k, 2], in the reference cell."""
    one, last = corners[:, 1] - corners[:, 0], corners[:, -1] - corners[:, 0]
    twist = corners[:, 0] - corners[:, 1] + corners[:, 2] - corners[:, -1] if corners.shape[1] == 4 else 0.0 * one
    one, last, twist, off = one[:, None], last[:, None], twist[:, None], at - corners[:, :1]
    found = np.full(at.shape, 0.5)
    for _ in range(_STEPS):
        xi, eta = found[..., :1], found[..., 1:]
        missing = off - xi * one - eta * last - xi * eta * twist
        by_xi, by_eta = one + eta * twist, last + xi * twist
        determinant = by_xi[..., 0] * by_eta[..., 1] - by_xi[..., 1] * by_eta[..., 0]
        step = [
            (missing[..., 0] * by_eta[..., 1] - missing[..., 1] * by_eta[..., 0]) / determinant,
            (by_xi[..., 0] * missing[..., 1] - by_xi[..., 1] * missing[..., 0]) / determinant,
        ]
        found = found + np.stack(step, axis=-1)
    return found


def _shapes(kind: str, at: Floats) -> Floats:
    """Shape functions [.., k] of a kind of face at places [.., 2] of its reference cell."""
    powers = np.array(_POWERS[kind])
    terms = at[..., None, 0] ** powers[:, 0] * at[..., None, 1] ** powers[:, 1]
    product: Floats = terms @ _coefficients(kind)
    return product


@cache
def _coefficients(kind: str) -> Floats:
    """Of powers of the places in the shape functions [k, k]: 1 at their own node, 0 at the others."""
    cell = KINDS[kind]
    corners = np.array(
        [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]] if cell.corners == 3 else [[0.0, 0], [1, 0], [1, 1], [0, 1]]
    )
    middles = [corners[list(edge)].mean(axis=0) for edge in cell.edges]
    nodes = np.array([*corners, *middles, corners.mean(axis=0)])[: cell.nodes]
    powers = np.array(_POWERS[kind])
    return np.linalg.inv(nodes[:, None, 0] ** powers[:, 0] * nodes[:, None, 1] ** powers[:, 1])
