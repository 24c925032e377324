"""Joints of solids whose meshes do not match on the flat faces that touch: both move together all over them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import block_diag, csr_array, diags_array, eye_array, vstack
from scipy.spatial import KDTree

from femstruct.arrays import Floats, Integers
from femstruct.model.equations.face_mortar import NEGLIGIBLE, Faces, Means, changed, means_over
from femstruct.model.imported.cell_kinds import KINDS
from femstruct.model.meshed import Meshed
from femstruct.model.region import Region

APART: Final = 1e-3  # of a side of a face: a middle that is farther off makes it curved
_EQUAL: Final = 1e-6  # of an area: sides that differ by less are as large

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

    nodes : of each part, those that a joint is about. points : of all nodes [m].

    The difference of the two motions vanishes in the mean, as `femstruct.model.equations.face_mortar` says, with the
    functions of the side whose faces lie on the other, or of the finer one; one sum for all planes, so that an edge
    between two of them has one function.
    """
    outer = [
        _near(part, other, own, tolerance, points) for part, other, own in zip(parts, parts[::-1], nodes, strict=True)
    ]
    if not all(outer):
        return None
    on = [np.zeros(len(points), dtype=bool) for _ in parts]
    for i, faces in enumerate(outer):
        of = np.unique(np.concatenate([some.ravel() for some in faces.values()]))
        on[i][of] = parts[1 - i].off_cells(points[of]) <= tolerance
    if (on[0].any() or on[1].any()) and not any(_lone(on[i], nodes[1 - i], tolerance, points) for i in (0, 1)):
        return None
    planes = _planes(outer[0], outer[1], points, tolerance)
    if not planes:
        return None
    found = [_summed(planes, side, on[side]) for side in (0, 1)]
    if float(found[0].means.areas.sum()) <= 0.0:
        return None
    whole, count = [one.means.whole for one in found], [int(one.sum()) for one in on]
    alike = abs(whole[0] - whole[1]) <= _EQUAL * max(whole)
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


def _near(part: Meshed, other: Meshed, own: Integers, tolerance: float, points: Floats) -> _ByKind:
    """Faces of a solid, all of whose nodes are named, with boxes that meet the box of another part."""
    low, high = other.places.min(axis=0) - tolerance, other.places.max(axis=0) + tolerance
    found = {}
    for kind, faces in part.faces_at(f"parts.{part.name}", Region("whole"), tolerance).items():
        at = points[faces]
        kept = np.isin(faces, own).all(axis=1) & (at.max(axis=1) >= low).all(axis=1) & (at.min(axis=1) <= high).all(1)
        if kept.any():
            found[kind] = faces[kept]
    return found


def _lone(on: NDArray[np.bool_], there: Integers, tolerance: float, points: Floats) -> bool:
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
