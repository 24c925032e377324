"""What the cells of a shell do: their matrices, motion at places in them, places on them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Final, NamedTuple

import numpy as np
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import connected_components

from femstruct.arrays import Floats, Integers
from femstruct.conventions import N_COMPONENTS
from femstruct.elements import quad_shell, triangle_shell
from femstruct.elements.flat_elements import angles, frames, rotate_resultants, rotate_rigidities
from femstruct.elements.members import rigid_arms, with_offsets
from femstruct.elements.plate import CORNERS
from femstruct.elements.polynomials import gauss_interval
from femstruct.model.flat_cells import FlatCells, area_vectors
from femstruct.model.lay_ups import PlateSection, SectionShare
from femstruct.model.regions import sparse_rows
from femstruct.model.scatter import scatter

SAME_SHAPE: Final = 11  # digits to which cells agree that are one shape: the rounding of coordinates of a grid
EDGE_ORDER: Final = 3  # Gauss points an edge: exact for products of two quadratic motions
_QUAD_CORNERS: Final = np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]])  # xi, eta of the corners
_TRIANGLE_CORNERS: Final = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 1.0]])


class CellPlaces(NamedTuple):
    """Places in cells: cells [p], xi, eta [p] there, places [p, 3] [m], weights [p] [m^2]."""

    cells: Integers
    xi: Floats
    eta: Floats
    places: Floats
    weights: Floats


class Sections(NamedTuple):
    """Rigidities A, B, D [m, 3, 3], As [m, 2, 2] and masses m0, m1, m2 [m] of cells, in their own axes."""

    A: Floats
    B: Floats
    D: Floats
    As: Floats
    m0: Floats
    m1: Floats
    m2: Floats


class Rigidities(NamedTuple):
    """A part of A, B, D [m, 3, 3], As [m, 2, 2] of cells, in their own axes."""

    A: Floats
    B: Floats
    D: Floats
    As: Floats


def cell_sections(
    cells: FlatCells, sections: list[PlateSection], which: Integers, x_direction: Floats | None
) -> Sections:
    """Rigidities and masses of each cell in its own axes.

    Parameters
    ----------
    which : Integers [q + t]
        Number of the section of each.
    x_direction : Floats | None [3]
        Of the x of the sections, laid into each cell; None where they have none.
    """
    A, B, D, As = _in_own_axes(cells, sections, which, x_direction)
    B = B * np.array([one.coupled for one in sections])[which, None, None]  # else it is rounding
    masses = (np.array([getattr(one, name) for one in sections])[which] for name in ("m0", "m1", "m2"))
    return Sections(A, B, D, As, *masses)


def cell_shares(
    cells: FlatCells, sections: list[PlateSection], which: Integers, x_direction: Floats | None
) -> list[Rigidities]:
    """What layers of each loss factor have of the rigidities of each cell, as `cell_sections`; none where all lose
    alike."""
    return [
        Rigidities(*_in_own_axes(cells, list(each), which, x_direction))
        for each in zip(*(one.shares for one in sections), strict=True)
    ]


def _in_own_axes(
    cells: FlatCells, of: Sequence[PlateSection | SectionShare], which: Integers, x_direction: Floats | None
) -> list[Floats]:
    stiff = [np.stack([getattr(one, name) for one in of])[which] for name in ("A", "B", "D", "As")]
    if x_direction is None:
        return stiff
    angle = np.concatenate([angles(frames(cells.points[own]), x_direction) for own in _kinds(cells) if len(own)])
    return [rotate_rigidities(matrix, angle) for matrix in stiff]


def _kinds(cells: FlatCells) -> tuple[Integers, Integers]:
    return cells.quads, cells.triangles


def cell_matrices(cells: FlatCells, of: Sections, offset: float) -> tuple[csr_array, csr_array]:
    """Stiffness and mass [6 n, 6 n] of all cells.

    Parameters
    ----------
    of : Sections
        The sections of all.
    offset : float
        From the mesh to the middle of the thickness, along the normals [m]; nodes carry it on rigid arms.
    """
    K, M = _put_together(
        cells,
        of,
        offset,
        lambda kind, corners, one: (
            kind.stiffness(corners, *(part[one] for part in of[:4])),
            kind.mass(corners, *(part[one] for part in of[4:])),
        ),
    )
    return K, M


def share_matrices(cells: FlatCells, of: Sections, shares: Sequence[Rigidities], offset: float) -> list[csr_array]:
    """Stiffness [6 n, 6 n] of shares of the rigidities of all cells: the part of the energy in any motion that is
    theirs. They add up to the stiffness of `cell_matrices`, whose arguments these are."""
    everything = (*of[:4], *(part for share in shares for part in share))
    return _put_together(
        cells,
        everything,
        offset,
        lambda kind, corners, one: tuple(
            kind.stiffness(corners, *(part[one] for part in of[:4]), share=tuple(part[one] for part in share))
            for share in shares
        ),
    )


def _put_together(
    cells: FlatCells,
    of: Sequence[Floats],
    offset: float,
    matrices: Callable[[Any, Floats, Integers], Sequence[Floats]],
) -> list[csr_array]:
    """Sums of matrices of cells.

    Parameters
    ----------
    of : Sequence[Floats]
        All that they depend on beside the corners, one entry a cell.
    matrices : Callable[[Any, Floats, Integers], Sequence[Floats]]
        Of a kind of cell, from the corners of some and their numbers.
    """
    n_quads, count = len(cells.quads), 6 * len(cells.points)
    found: list[list[csr_array]] = []
    for kind, nodes, first in ((quad_shell, cells.quads, 0), (triangle_shell, cells.triangles, n_quads)):
        if not len(nodes):
            continue
        one, copies = _alike(cells.points[nodes], [part[first : first + len(nodes)] for part in of])
        each = matrices(kind, cells.points[nodes[one]], first + one)
        if offset:
            arms = [offset * cells.normals[first + one]] * nodes.shape[1]
            each = [with_offsets(matrix, *arms) for matrix in each]
        numbers = (6 * nodes[:, :, None] + np.arange(6)).reshape(len(nodes), -1)
        pairs = [
            scatter(each[at], each[min(at + 1, len(each) - 1)], numbers, count, copies) for at in range(0, len(each), 2)
        ]
        found.append([matrix for pair in pairs for matrix in pair][: len(each)])
    if len(found) == 1:
        return found[0]
    return [csr_array(four + three) for four, three in zip(*found, strict=True)]


def _alike(corners: Floats, of: Sequence[Floats]) -> tuple[Integers, Integers]:
    """One cell of each shape, place and section aside, and which of them each cell is: matrices are computed once."""
    away = corners[:, 1:] - corners[:, :1]
    size = np.abs(away).max(axis=(1, 2))
    shapes = np.round(np.column_stack([away.reshape(len(corners), -1) / size[:, None], np.log(size)]), SAME_SHAPE)
    keys = np.column_stack([shapes, *(part.reshape(len(corners), -1) for part in of)]) + 0.0  # no -0
    rows = np.ascontiguousarray(keys).view(np.dtype((np.void, keys.itemsize * keys.shape[1]))).ravel()
    _, one, which = np.unique(rows, return_index=True, return_inverse=True)
    return one, which


def rows_at(cells: FlatCells, which: Integers, xi: Floats, eta: Floats) -> tuple[Integers, Floats]:
    """Motion at places in cells [p]: nodes [p, 4], counted in the part, and rows [p, 6, 4, 7], global axes."""
    rows = np.zeros((len(which), 6, 4, N_COMPONENTS))
    four = which < len(cells.quads)
    for of, own, count in ((quad_shell, four, 4), (triangle_shell, ~four, 3)):
        if own.any():
            corners = cells.points[cells.corners[which[own], :count]]
            motion = of.interpolate(corners, xi[own], eta[own])
            rows[own, :, :count, :6] = motion.reshape(-1, 6, count, 6)
    return cells.corners[which], rows


def cell_points(cells: FlatCells, which: Integers, order: int) -> CellPlaces:
    """Gauss points of cells; over a quadrilateral order x order, over a triangle those of one folded together."""
    points, shares = gauss_interval(order)
    xi, eta = np.repeat(points, order), np.tile(points, order)
    weights = np.outer(shares, shares).ravel()
    four = which < len(cells.quads)
    # A square folded onto a triangle: (xi, eta (1 - xi)), with the area 1 - xi.
    at = [(which[four], xi, eta, weights), (which[~four], xi, eta * (1.0 - xi), weights * (1.0 - xi))]
    found = []
    for own, x, y, w in at:
        many = np.repeat(own, len(x))
        xs, ys = np.tile(x, len(own)), np.tile(y, len(own))
        places, areas = map_places(cells, many, xs, ys)
        found.append(CellPlaces(many, xs, ys, places, np.tile(w, len(own)) * areas))
    return CellPlaces(*(np.concatenate(pair) for pair in zip(*found, strict=True)))


def edge_gauss(cells: FlatCells, which: Integers, corner: Integers) -> tuple[Integers, Floats, Floats, Floats, Floats]:
    """Gauss points along edges of cells: cells [p], xi, eta [p], weights [p] [m] and unit vectors along [p, 3].

    Parameters
    ----------
    which, corner : Integers [e]
        The cell of each edge and the corner that it runs from.
    """
    points, shares = gauss_interval(EDGE_ORDER)
    count = np.where(which < len(cells.quads), 4, 3)
    places = np.where((count == 4)[:, None, None], _QUAD_CORNERS, _TRIANGLE_CORNERS)
    number, after = np.arange(len(which)), (corner + 1) % count
    start, end = places[number, corner], places[number, after]
    at = start[:, None] + points[:, None] * (end - start)[:, None]
    nodes = cells.corners[which]
    sides = cells.points[nodes[number, after]] - cells.points[nodes[number, corner]]
    lengths = np.linalg.norm(sides, axis=1)
    along = np.repeat(sides / lengths[:, None], len(points), axis=0)
    weights = (lengths[:, None] * shares).ravel()
    return np.repeat(which, len(points)), at[:, :, 0].ravel(), at[:, :, 1].ravel(), weights, along


def map_places(cells: FlatCells, which: Integers, xi: Floats, eta: Floats) -> tuple[Floats, Floats]:
    """Where places in cells are [p, 3] [m], and the area of a unit of xi and eta there, in the mean plane [p] [m^2]."""
    p0, p1, p2, p3 = np.moveaxis(cells.points[cells.corners[which]], 1, 0)
    x, y = xi[:, None], eta[:, None]
    four = (which < len(cells.quads))[:, None]
    twist = p0 - p1 + p2 - p3
    places = np.where(four, p0 + x * (p3 - p0) + y * (p1 - p0) + x * y * twist, p0 + x * (p1 - p0) + y * (p2 - p0))
    along = np.where(four, p3 - p0 + y * twist, p1 - p0)
    across = np.where(four, p1 - p0 + x * twist, p2 - p0)
    areas = np.einsum("pi,pi->p", np.cross(along, across), cells.normals[which])
    return places, np.abs(areas)


# ----------------------------------------------------------------------------------------------------------------------
# The places of flat cells that are nearest to places in space, and how crosses around some of them turn.
# ----------------------------------------------------------------------------------------------------------------------

OFF: Final = 1e-6  # of the reach of a patch: what is farther from the cells is not on them
_NEWTON: Final = 20  # steps to the place in a quadrilateral; four are enough in one that is not nearly a triangle
_AT_ONCE: Final = 2_000_000  # pairs of places and cells whose distance is looked at together: 50 MB


class Nearest(NamedTuple):
    """Places of cells that are nearest to others: cells [p], xi and eta there [p] [1], where they are [p, 3] [m]."""

    cells: Integers
    xi: Floats
    eta: Floats
    positions: Floats


def nearest_places(cells: FlatCells, at: Floats) -> Nearest:
    """The places of the cells nearest to places in space [p, 3]; of warped quadrilaterals on their two triangles.

    Only those cells are looked at whose spheres can be as near as the nearest.

    >>> square = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
    >>> from femstruct.model.flat_cells import flat_cells
    >>> from femstruct.model.imported_mesh import ImportedMesh
    >>> cells = {"quad4": np.array([[0, 1, 2, 3]])}
    >>> mesh = ImportedMesh("plate", square, np.arange(4), cells, {"quad4": np.array([1])})
    >>> nearest_places(flat_cells(mesh, None), np.array([[0.5, 0.5, 3.0], [9.0, 0.5, 0.0]])).positions.tolist()
    [[0.5, 0.5, 0.0], [2.0, 0.5, 0.0]]
    """
    places = np.asarray(at, dtype=np.float64).reshape(-1, 3)
    corners = cells.points[cells.corners]
    middles = corners.mean(axis=1)
    radii = np.sqrt(((corners - middles[:, None]) ** 2).sum(axis=2).max(axis=1))
    chunk = max(1, _AT_ONCE // len(middles))
    found = [_of_some(cells, places[k : k + chunk], middles, radii) for k in range(0, max(len(places), 1), chunk)]
    which, feet = (np.concatenate(pair) for pair in zip(*found, strict=True))
    xi, eta = _inside(cells, which, feet)
    return Nearest(which, xi, eta, map_places(cells, which, xi, eta)[0])


def cross_turning(cells: FlatCells, centers: Floats, reach: float, axes: Floats) -> tuple[Integers, Floats]:
    """Rotation about the normal of patches that reach so far [m] around places [m, 3] of flat cells.

    Parameters
    ----------
    axes : Floats [3, 3]
        Two directions in the cells, and the normal. The ends of a cross, as far as they lie on the cells, and its
        middle move as the cells do; the rotation is that of the rigid motion that fits them best.

    Returns
    -------
    tuple[Integers, Floats]
        Nodes [m, 20] and rows [m, 1, 20, 7].
    """
    arms = reach * np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    ends = centers[:, None] + arms @ axes[:2]
    found = nearest_places(cells, ends.reshape(-1, 3))
    places = found.positions.reshape(ends.shape)
    on_it = np.linalg.norm(places - ends, axis=2) <= OFF * reach
    middles = (places * on_it[..., None]).sum(axis=1) / on_it.sum(axis=1)[:, None]
    off = (places - middles[:, None]) @ axes[:2].T * on_it[..., None]
    pulls = (off[..., :1] * axes[1] - off[..., 1:] * axes[0]) / (off**2).sum(axis=(1, 2))[:, None, None]
    nodes, motion = rows_at(cells, found.cells, found.xi, found.eta)
    rows = np.einsum("pi,pikc->pkc", pulls.reshape(-1, 3), motion[:, :3])
    return nodes.reshape(-1, 20), rows.reshape(-1, 1, 20, N_COMPONENTS)


def _of_some(cells: FlatCells, at: Floats, middles: Floats, radii: Floats) -> tuple[Integers, Floats]:
    """Nearest cells [p] and the places there [p, 3]."""
    away = np.linalg.norm(middles - at[:, None], axis=2)
    place, cell = np.nonzero(away - radii <= (away + radii).min(axis=1)[:, None])
    four = cell < len(cells.quads)
    quads, triangles = cells.quads[cell[four]], cells.triangles[cell[~four] - len(cells.quads)]
    corners = cells.points[np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]], triangles])]
    place, cell = (np.concatenate([both[four], both[four], both[~four]]) for both in (place, cell))
    feet = _on_triangles(corners, at[place])
    order = np.lexsort((((feet - at[place]) ** 2).sum(axis=1), place))
    best = order[np.searchsorted(place[order], np.arange(len(at)))]
    return cell[best], feet[best]


def _on_triangles(corners: Floats, at: Floats) -> Floats:
    """The place of each triangle [n, 3, 3] nearest to a place [n, 3]: in it, or on one of its sides."""
    a, b, c = np.moveaxis(corners, 1, 0)
    normal = np.cross(b - a, c - a)
    square = np.maximum((normal**2).sum(axis=1), np.finfo(float).tiny)
    foot = at - ((at - a) * normal).sum(axis=1)[:, None] / square[:, None] * normal
    inside = np.ones(len(a), dtype=bool)
    candidates = []
    for start, end in ((a, b), (b, c), (c, a)):
        side = end - start
        inside &= (np.cross(side, foot - start) * normal).sum(axis=1) >= 0.0
        share = np.clip(((at - start) * side).sum(axis=1) / (side**2).sum(axis=1), 0.0, 1.0)
        candidates.append(start + share[:, None] * side)
    sides = np.stack(candidates, axis=1)
    nearest = np.argmin(((sides - at[:, None]) ** 2).sum(axis=2), axis=1)
    found: Floats = np.where(inside[:, None], foot, sides[np.arange(len(a)), nearest])
    return found


def _inside(cells: FlatCells, which: Integers, positions: Floats) -> tuple[Floats, Floats]:
    """xi and eta [p] of places [p, 3] in cells [p], from 0 to 1."""
    p0, p1, p2, p3 = np.moveaxis(cells.points[cells.corners[which]], 1, 0)
    four = (which < len(cells.quads))[:, None]
    along, across = np.where(four, p3 - p0, p1 - p0), np.where(four, p1 - p0, p2 - p0)
    twist = np.where(four, p0 - p1 + p2 - p3, 0.0)
    place = np.full((len(which), 2), 0.5)
    for _ in range(_NEWTON if four.any() else 1):
        x, y = place[:, :1], place[:, 1:]
        off = positions - (p0 + x * along + y * across + x * y * twist)
        slopes = np.stack([along + y * twist, across + x * twist], axis=2)
        place = np.clip(place + (np.linalg.pinv(slopes) @ off[:, :, None])[:, :, 0], 0.0, 1.0)
    return place[:, 0], place[:, 1]


# ----------------------------------------------------------------------------------------------------------------------
# Stresses of a shell at the faces of its nodes: of the cells that meet there as one smooth surface, their mean.
# ----------------------------------------------------------------------------------------------------------------------

FLAT: Final = 1e-6  # eigenvalue of a fit below which samples do not tell a slope
FOLD: Final = float(np.cos(np.radians(30.0)))  # cells that meet at a larger angle have stresses of their own there
_SQRT3: Final = float(np.sqrt(3.0))
_UNIT: Final = np.array(CORNERS, dtype=np.float64)


class FaceStresses(NamedTuple):
    """Stresses xx, yy, xy [Pa] at the nodes of a shell, on s faces, from the components of all nodes of a structure.

    nodes [p], cells [p] : the node of each place, and one of its cells; axes [p, 3, 3] : rows are the directions of xx
    and yy, and its normal. rows [p * s * 3, n_nodes * 7]. places [k] : the place of each corner of a cell;
    of_cells [k * s * 3, n_nodes * 7] : the stresses of that cell alone.
    """

    nodes: Integers
    cells: Integers
    axes: Floats
    rows: csr_array
    places: Integers
    of_cells: csr_array


def face_stresses(
    cells: FlatCells,
    of: Sections,
    made: tuple[Integers, Floats],
    offset: float,
    x: Floats | None,
    numbers: tuple[int, int],
) -> FaceStresses:
    """Stresses at all nodes, of each smooth piece of surface that meets there.

    Membrane forces are those at 2 x 2 points of quadrilaterals, where they are best, continued bilinearly, and the mean
    of the cells that meet at a place. Moments are those in the middle of cells: a linear field is fitted to them around
    each place, over the cells that meet there or, where the piece ends, over those around these, too, since moments of
    linear cells do not vary towards an edge.

    Parameters
    ----------
    of : Sections
        The sections of the cells.
    made : tuple[Integers, Floats]
        Number [q + t] of the section of each cell, and by section the stresses [n, s, 3, 6] on s faces of membrane
        forces and moments per length.
    offset : float
        As of `cell_matrices`.
    x : Floats | None [3]
        Of the axes that stresses are given in, laid into each cell; None for that of one of the cells at each place.
    numbers : tuple[int, int]
        Of the first node, and of all nodes.
    """
    kinds, of_resultants = made
    corners, nodes = _corners(cells)
    places, first_of = _smooth(cells, corners, nodes, kinds)
    R = np.concatenate([frames(cells.points[own]) for own in (cells.quads, cells.triangles) if len(own)])
    forces, moments = _resultants(cells, of, offset)
    directions = np.tile(x, (len(first_of), 1)) if x is not None else R[corners[first_of], 0]
    count = 3 * of_resultants.shape[1]

    def stressed(place: Integers, cell: Integers, rows: Floats, first: int) -> csr_array:
        """Stresses of cells, of resultants [m, 3, 24] from the first on, in the axes of places [m * s * 3, ...]."""
        all_rows = np.zeros((len(cell), 8, 24))
        all_rows[:, first : first + 3] = rows
        turned = rotate_resultants(all_rows, angles(R[cell], directions[place]))[:, :6]
        stresses = of_resultants[kinds[cell]] @ turned[:, None]
        padded = np.zeros((len(cell), count, 4, N_COMPONENTS))
        padded[..., :6] = stresses.reshape(len(cell), count, 4, 6)
        return sparse_rows(numbers[0] + cells.corners[cell], padded, numbers[1])

    stretched = stressed(places, corners, forces[corners, _number(corners)], 0)
    place, cell = _around(cells, corners, nodes, places, kinds)
    middles = np.where(np.arange(len(cells.cells))[:, None] < len(cells.quads), *_middles(cells))
    shares = _fitted(cells.points[nodes[first_of]], R[corners[first_of]], middles, place, cell)
    means = 1.0 / np.bincount(places)[places]
    return FaceStresses(
        nodes[first_of],
        corners[first_of],
        _axes(R[corners[first_of]], directions),
        csr_array(
            _gathering(places, means, count) @ stretched
            + _gathering(place, shares, count) @ stressed(place, cell, moments[cell], 3)
        ),
        places,
        csr_array(stretched + stressed(places, corners, moments[corners], 3)),
    )


def _axes(R: Floats, directions: Floats) -> Floats:
    """Axes [p, 3, 3] of cells at R, their first one turned in the plane to the directions [p, 3]."""
    turn = angles(R, directions)
    c, s = np.cos(turn)[:, None], np.sin(turn)[:, None]
    return np.stack([c * R[:, 0] + s * R[:, 1], c * R[:, 1] - s * R[:, 0], R[:, 2]], axis=1)


def _corners(cells: FlatCells) -> tuple[Integers, Integers]:
    """Cell and node of every corner; of triangles the last one counts once."""
    owner, nodes = np.repeat(np.arange(len(cells.cells)), 4), cells.corners.ravel()
    real = np.ones(len(nodes), dtype=bool)
    real[4 * len(cells.quads) + 3 :: 4] = False
    return owner[real], nodes[real]


def _number(corners: Integers) -> Integers:
    """Which corner of its cell each one is."""
    return np.arange(len(corners)) - np.searchsorted(corners, corners)


def _middles(cells: FlatCells) -> tuple[Floats, Floats]:
    """Middles of all cells [q + t, 3], as if they were quadrilaterals, and as if triangles."""
    p = cells.points[cells.corners]
    return p.mean(axis=1), p[:, :3].mean(axis=1)


def _resultants(cells: FlatCells, of: Sections, offset: float) -> tuple[Floats, Floats]:
    """Rows of membrane forces at the corners of cells [q + t, 4, 3, 24] and of moments in the middle [q + t, 3, 24]."""
    forces, moments = np.zeros((len(cells.cells), 4, 3, 24)), np.zeros((len(cells.cells), 3, 24))
    n_quads = len(cells.quads)
    x, y = (0.5 + (_UNIT - 0.5) * _SQRT3).T
    bilinear = np.stack([(x if i else 1.0 - x) * (y if j else 1.0 - y) for i, j in CORNERS], axis=1)
    for kind, nodes, own, places, continued, middle in (
        (quad_shell, cells.quads, slice(0, n_quads), 0.5 + (_UNIT - 0.5) / _SQRT3, bilinear, 0.5),
        (triangle_shell, cells.triangles, slice(n_quads, None), np.full((1, 2), 1.0 / 3.0), np.ones((4, 1)), 1.0 / 3.0),
    ):
        if not len(nodes):
            continue
        arms = rigid_arms(*[offset * cells.normals[own]] * nodes.shape[1])
        rigidities, width = (of.A[own], of.B[own], of.D[own], of.As[own]), 6 * nodes.shape[1]
        where = np.array([*places, (middle, middle)])[:, :, None] * np.ones(len(nodes))
        rows = np.stack([kind.resultants(cells.points[nodes], *at, *rigidities) @ arms for at in where])
        forces[own, :, :, :width] = np.einsum("cg,gmij->mcij", continued, rows[:-1, :, :3])
        moments[own, :, :width] = rows[-1, :, 3:6]
    return forces, moments


def _around(
    cells: FlatCells, corners: Integers, nodes: Integers, places: Integers, kinds: Integers
) -> tuple[Integers, Integers]:
    """Pairs of places and cells: those that meet at a place; where a piece of surface ends, those around these, too."""
    first_of = np.unique(places, return_index=True)[1]
    count, n_cells, n_nodes = len(first_of), len(cells.cells), len(cells.points)
    incidence = csr_array((np.ones(len(places)), (places, corners)), shape=(count, n_cells))
    has = csr_array((np.ones(len(nodes)), (corners, nodes)), shape=(n_cells, n_nodes))
    edges = np.sort(np.stack([cells.corners, np.roll(cells.corners, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    different, times = np.unique(edges[edges[:, 0] != edges[:, 1]], axis=0, return_counts=True)
    ends = np.bincount(nodes[first_of], minlength=n_nodes) > 1  # a fold, or another thickness
    ends[different[times != 2]] = True
    widened = ends[nodes[first_of]].astype(float)
    wide = csr_array((widened, (np.arange(count), np.arange(count)))) @ (incidence @ has @ has.T)
    pairs = csr_array(incidence + wide).tocoo()
    reference = corners[first_of][pairs.row]
    alike = (cells.patches[pairs.col] == cells.patches[reference]) & (kinds[pairs.col] == kinds[reference])
    alike &= np.einsum("ki,ki->k", cells.normals[pairs.col], cells.normals[reference]) >= FOLD
    return pairs.row[alike].astype(np.int64), pairs.col[alike].astype(np.int64)


def _fitted(at: Floats, axes: Floats, middles: Floats, place: Integers, cell: Integers) -> Floats:
    """Share of each cell in the value at its place of the linear field that fits all cells of the place best; of those
    with the least slope, where they do not tell."""
    local = np.einsum("kij,kj->ki", axes[place, :2], middles[cell] - at[place])
    size = np.sqrt(np.bincount(place, (local**2).sum(axis=1)) / np.bincount(place))[place]
    basis = np.column_stack([np.ones(len(place)), local / size[:, None]])
    squares = np.zeros((len(at), 3, 3))
    np.add.at(squares, place, basis[:, :, None] * basis[:, None, :])
    inverse = np.linalg.pinv(squares, rcond=FLAT, hermitian=True)
    return np.asarray(np.einsum("ki,ki->k", inverse[place, 0], basis))


def _gathering(place: Integers, shares: Floats, count: int) -> csr_array:
    """What adds up values [m * count] by their places and shares."""
    inner = np.arange(count)
    rows, columns = (place[:, None] * count + inner).ravel(), (np.arange(len(place))[:, None] * count + inner).ravel()
    return csr_array((np.repeat(shares, count), (rows, columns)))


def _smooth(cells: FlatCells, corners: Integers, nodes: Integers, kinds: Integers) -> tuple[Integers, Integers]:
    """The place of each corner: those of one node whose cells meet without a fold and alike are one place.

    Parameters
    ----------
    corners : Integers
        Cells of the corners [k].

    Returns
    -------
    tuple[Integers, Integers]
        Places [k], and the first corner of each place.
    """
    vectors = area_vectors(cells.points, cells.corners)
    normals = vectors / np.linalg.norm(vectors, axis=1)[:, None]
    order = np.argsort(nodes, kind="stable")
    starts = np.flatnonzero(np.r_[True, np.diff(nodes[order]) > 0])
    links: list[tuple[Integers, Integers]] = []
    for step in range(1, int(np.diff(np.r_[starts, len(nodes)]).max(initial=1))):  # pairs of corners of one node
        one, other = order[:-step], order[step:]
        near = nodes[one] == nodes[other]
        a, b = corners[one[near]], corners[other[near]]
        alike = (cells.patches[a] == cells.patches[b]) & (kinds[a] == kinds[b])
        alike &= np.einsum("ki,ki->k", normals[a], normals[b]) >= FOLD
        links.append((one[near][alike], other[near][alike]))
    first, second = (np.concatenate([np.zeros(0, np.int64), *(pair[side] for pair in links)]) for side in (0, 1))
    graph = coo_array((np.ones(len(first)), (first, second)), shape=(len(nodes), len(nodes)))
    places = connected_components(graph, directed=False)[1].astype(np.int64)
    return places, np.unique(places, return_index=True)[1]
