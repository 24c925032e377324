"""Seams: two meshes with different nodes that meet along a line or on a flat face, joined by a mortar."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array, diags_array, eye_array, kron
from scipy.spatial import KDTree

from femstruct.arrays import Floats, Integers
from femstruct.conventions import DIRECTIONS, N_COMPONENTS
from femstruct.declared import checked
from femstruct.errors import InputError, list_some
from femstruct.model.imported_mesh import KINDS
from femstruct.model.model import Model, component_numbers, some_component_numbers
from femstruct.model.part import Meshed, Tie
from femstruct.model.regions import Region
from femstruct.model.structure import Constraint
from femstruct.tags import stored_as

# ----------------------------------------------------------------------------------------------------------------------
# Motion across flat faces of solids that meet with different nodes: integrals over the pieces that two faces share.
# ----------------------------------------------------------------------------------------------------------------------

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

    Parameters
    ----------
    counted : NDArray[np.bool_] [n]
        Nodes of the first side that lie on the second, each of which has a function. Those of a face beside the other
        side's rim are its shape functions, to which those of its other nodes are added evenly, so that all add to one;
        a face without such a node has one function, that is 1. Where they lie on one line at most, three functions,
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
    which faces are shared all over [m].

    Parameters
    ----------
    on : NDArray[np.bool_] [m, k]
        Nodes that count.
    """
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
    """Dual functions of each face from its own [m, k, k], and what belongs to each of its nodes [m, k] [m^2].

    Parameters
    ----------
    without : NDArray[np.bool_] | None [m]
        Faces that need none.
    """
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


# ----------------------------------------------------------------------------------------------------------------------
# Seams: two meshes with different nodes that meet along a line or, solids, in a plane.
# ----------------------------------------------------------------------------------------------------------------------

_FORCES = np.concatenate([np.eye(3), np.zeros((3, 3))])
_GAUSS: Final = 0.5 + np.array([-0.5, 0.5]) / np.sqrt(3.0)  # exact for the product of two linear functions
_ONE: Final = 1e-9  # of the length of a seam: nodes closer than this are at one place
APART: Final = 1e-3  # of the length of a seam: nodes farther off its line are not on it


@stored_as("seam/1")
@dataclass(frozen=True)
@checked("constraints")
class Seam(Constraint):
    """Two meshes that have different nodes where they meet: shells or solids along a straight line, or flat faces of
    solids.

    on, of : the part with the finer mesh there, and the set or box of it with the nodes or faces. onto, there : those
    of the other. directions : out of x y z rx ry rz, global, that go across; rotations where both parts have
    them. The force recorded is the one on the second part.

    A fine mesh beside a hole, welded into a coarse one:

    >>> weld = Seam("weld", "insert", Region("set", named="edge"), "wall", Region("set", named="opening"))
    >>> weld.directions[:3]
    ('x', 'y', 'z')

    Notes
    -----
    Mortar method: the difference of the two motions, linear between nodes, vanishes in the mean over the line with the
    dual functions of the finer side, whose integrals with its shape functions are diagonal. So each of its nodes
    follows the nodes of the other by factors that add to one. Motions that are linear along the line, and so rigid
    ones, constant strains, bending across it and twist, go across exactly, and forces balance; bending along the line
    goes across as well as shape functions of degree one can. Flat faces of solids: `across_faces`; a constant pressure
    goes across exactly.

    Source: B. I. Wohlmuth, A mortar finite element method using dual spaces for the Lagrange multiplier, SIAM J. Numer.
    Anal. 38 (2000) 989-1012, doi:10.1137/S0036142999350929.
    """

    name: str
    on: str
    of: Region
    onto: str
    there: Region
    directions: tuple[str, ...] = DIRECTIONS

    def __post_init__(self) -> None:
        where = f"constraints.{self.name}"
        some_component_numbers(f"{where}.directions", self.directions)
        if (self.on, self.of) == (self.onto, self.there):
            raise InputError(f"{where}.onto", got="the same nodes twice", expected="those of another part or set")

    def holds(self) -> Mapping[str, tuple[str, ...]]:
        return {}

    def tie(self, model: Model, tolerance: float) -> Tie:
        where = f"constraints.{self.name}"
        fine, first = _nodes(f"{where}.seam", self.on, self.of, model, tolerance)
        coarse, second = _nodes(f"{where}.onto", self.onto, self.there, model, tolerance)
        held = component_numbers(f"{where}.directions", self.directions)
        if not (fine.has_rotations and coarse.has_rotations):
            held = [number for number in held if number < 3]
        if not held:
            got = f"rotations of {self.on} and {self.onto}, one of which has none"
            raise InputError(f"{where}.directions", got=got, expected="x, y or z")
        if _off_line(model.mesh.points[first]) > APART:
            sides = [
                part.faces_at(f"{where}.{key}", region, tolerance)
                for key, part, region in (("seam", fine, self.of), ("onto", coarse, self.there))
            ]
            first, second, factors = _in_plane(where, sides[0], sides[1], model.mesh.points)
        else:
            first, second, s, t = _along(where, first, second, model.mesh.points)
            factors = csr_array(mortar(s, t))
        shape = (len(first), model.mesh.n_nodes)
        own = csr_array((np.ones(len(first)), (np.arange(len(first)), first)), shape=shape)
        at = factors.tocoo()
        following = csr_array((at.data, (at.row, second[at.col])), shape=shape)
        rows = csr_array(kron(csr_array(own - following), np.eye(N_COMPONENTS)[held]))
        return Tie(self.name, rows, np.tile(_FORCES[held], (len(first), 1)), grounded=False)


def mortar(s: Floats, t: Floats) -> Floats:
    """Motion of nodes at places s [m] of a line from that of nodes at t [k], both ascending: factors [m, k].

    >>> mortar(np.array([0.0, 0.5, 1.0]), np.array([0.0, 1.0])).round(12)
    array([[1. , 0. ],
           [0.5, 0.5],
           [0. , 1. ]])
    """
    inside = t[(t > s[0]) & (t < s[-1])]
    cuts = np.unique(np.concatenate([s, inside]))
    lengths = np.diff(cuts)
    at = (cuts[:-1, None] + lengths[:, None] * _GAUSS).ravel()
    weights = np.repeat(lengths / 2.0, 2)
    one, other = _line_shapes(s, at), _line_shapes(t, at)
    own = weights @ one  # of each node: the length that belongs to it
    piece = np.clip(np.searchsorted(s, at, side="right") - 1, 0, len(s) - 2)
    rows = np.arange(len(at))
    dual = 2.0 * one
    dual[rows, piece] -= one[rows, piece + 1]
    dual[rows, piece + 1] -= one[rows, piece]
    found: Floats = (dual * weights[:, None]).T @ other / own[:, None]
    found[np.abs(found) < 1e-14] = 0.0
    return found


def _line_shapes(nodes: Floats, at: Floats) -> Floats:
    """Linear shape functions of nodes [n] on a line at places [p]: [p, n]."""
    piece = np.clip(np.searchsorted(nodes, at, side="right") - 1, 0, len(nodes) - 2)
    share = np.clip((at - nodes[piece]) / (nodes[piece + 1] - nodes[piece]), 0.0, 1.0)
    found = np.zeros((len(at), len(nodes)))
    found[np.arange(len(at)), piece] = 1.0 - share
    found[np.arange(len(at)), piece + 1] = share
    return found


def _nodes(where: str, name: str, region: Region, model: Model, tolerance: float) -> tuple[Meshed, Integers]:
    part = model.parts.get(name)
    if part is None:
        raise InputError(f"{where}.on", got=f"'{name}'", expected=f"a part: {list_some(model.parts)}")
    return part, part.within(where, region, tolerance)


def _off_line(places: Floats) -> float:
    """How far places [n, 3] are off the straight line through them, over their extent along it [1]."""
    sizes = np.linalg.svd(places - places.mean(axis=0), compute_uv=False)
    return float(sizes[1] / sizes[0]) if len(places) > 1 and sizes[0] > 0.0 else 0.0


def _in_plane(
    where: str, first: Mapping[str, Integers], second: Mapping[str, Integers], points: Floats
) -> tuple[Integers, Integers, csr_array]:
    """The nodes of the faces of both sides, and the factors by which those of the first follow."""
    for key, faces in (("seam", first), ("onto", second)):
        if not faces:
            got, expected = (
                "nodes that are on no line and on no face of a solid",
                "nodes on one line, or faces of a solid",
            )
            raise InputError(f"{where}.{key}", got=got, expected=expected, do="write a seam for each straight piece")
        for kind, nodes in faces.items():
            cell = KINDS[kind]
            for number, edge in enumerate(cell.edges if cell.quadratic else ()):
                ends = points[nodes[:, list(edge)]]
                off = np.linalg.norm(points[nodes[:, cell.corners + number]] - ends.mean(axis=1), axis=1)
                if (off > APART * np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)).any():
                    got = f"curved sides of faces, up to {off.max():.4g} m off their middle"
                    raise InputError(f"{where}.{key}", got=got, expected="faces with straight sides")
    used = [np.unique(np.concatenate([nodes.ravel() for nodes in faces.values()])) for faces in (first, second)]
    places = points[np.concatenate(used)]
    middle, size = places.mean(axis=0), float(np.linalg.norm(np.ptp(places, axis=0)))
    axes = np.linalg.svd(places - middle, full_matrices=False)[2]
    off = float(np.abs((places - middle) @ axes[2]).max())
    if off > APART * size:
        got = f"faces up to {off:.4g} m off one plane"
        raise InputError(where, got=got, expected="faces of both parts in one plane", do="write a seam for each plane")
    sides = [
        Faces({kind: np.searchsorted(own, nodes) for kind, nodes in faces.items()}, (points[own] - middle) @ axes[:2].T)
        for own, faces in zip(used, (first, second), strict=True)
    ]
    found = across_faces(*sides)
    if found.covered < 1.0 - APART:
        got = f"faces of which {100.0 * (1.0 - found.covered):.3g} % have none of the second part against them"
        raise InputError(f"{where}.seam", got=got, expected="faces within those of the second part", do="swap the two")
    return used[0], used[1], found.factors


def _along(where: str, first: Integers, second: Integers, points: Floats) -> tuple[Integers, Integers, Floats, Floats]:
    """The nodes of both sides in their order along the line, and where on it they are [m]."""
    for key, nodes in (("seam", first), ("onto", second)):
        if len(nodes) < 2:
            raise InputError(f"{where}.{key}", got="one node", expected="two or more along a line")
    places = points[np.concatenate([first, second])]
    middle = places.mean(axis=0)
    direction = np.linalg.svd(places - middle, full_matrices=False)[2][0]
    along = (places - middle) @ direction
    off = np.linalg.norm(places - middle - along[:, None] * direction, axis=1)
    length = float(np.ptp(along))
    if off.max() > APART * length:
        got = f"nodes {off.max():.4g} m off the straight line through all of them"
        raise InputError(where, got=got, expected="nodes on one line", do="write a seam for each straight piece")
    s, t = along[: len(first)], along[len(first) :]
    beyond = max(t.min() - s.min(), s.max() - t.max())
    if beyond > APART * length:
        got = f"nodes that reach {beyond:.4g} m beyond those of the second part"
        raise InputError(f"{where}.seam", got=got, expected="a line within that of the second part", do="swap the two")
    order, other = np.argsort(s), np.argsort(t)
    for key, at in (("seam", s[order]), ("onto", t[other])):
        if np.diff(at).min() < _ONE * length:
            raise InputError(
                f"{where}.{key}", got="two nodes at one place", expected="one", do="merge the mesh's nodes"
            )
    return first[order], second[other], s[order], t[other]
