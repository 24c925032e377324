"""What the cells of a shell do: their matrices, motion at places in them, places on them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Final, NamedTuple

import numpy as np
from scipy.sparse import csr_array

from femstruct.arrays import Floats, Integers
from femstruct.conventions import N_COMPONENTS
from femstruct.elements import quad_shell, triangle_shell
from femstruct.elements.facets.axes import angles, frames, turned
from femstruct.elements.placement import with_offsets
from femstruct.elements.quadrature import gauss_interval
from femstruct.model.grid.scatter import scattered
from femstruct.model.imported.flat_cells import FlatCells
from femstruct.model.materials.plate_section import PlateSection, SectionShare

SAME_SHAPE: Final = 11  # digits to which cells agree that are one shape: the rounding of coordinates of a grid
EDGE_ORDER: Final = 3  # Gauss points an edge: exact for products of two quadratic motions
_QUAD_CORNERS: Final = np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]])  # xi, eta of the corners
_TRIANGLE_CORNERS: Final = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 1.0]])


class Places(NamedTuple):
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
    """Rigidities and masses of each cell in its own axes. which [q + t] : number of the section of each. x_direction
    [3] : of the x of the sections, laid into each cell; None where they have none."""
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
    return [turned(matrix, angle) for matrix in stiff]


def _kinds(cells: FlatCells) -> tuple[Integers, Integers]:
    return cells.quads, cells.triangles


def cell_matrices(cells: FlatCells, of: Sections, offset: float) -> tuple[csr_array, csr_array]:
    """Stiffness and mass [6 n, 6 n] of all cells. of : the sections of all. offset : from the mesh to the middle of the
    thickness, along the normals [m]; nodes carry it on rigid arms."""
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
    """Sums of matrices of cells; of : all that they depend on beside the corners, one entry a cell. matrices : of a
    kind of cell, from the corners of some and their numbers."""
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
            scattered(each[at], each[min(at + 1, len(each) - 1)], numbers, count, copies)
            for at in range(0, len(each), 2)
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


def cell_points(cells: FlatCells, which: Integers, order: int) -> Places:
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
        places, areas = mapped(cells, many, xs, ys)
        found.append(Places(many, xs, ys, places, np.tile(w, len(own)) * areas))
    return Places(*(np.concatenate(pair) for pair in zip(*found, strict=True)))


def edge_gauss(cells: FlatCells, which: Integers, corner: Integers) -> tuple[Integers, Floats, Floats, Floats, Floats]:
    """Gauss points along edges of cells: cells [p], xi, eta [p], weights [p] [m] and unit vectors along [p, 3].

    which, corner [e] : the cell of each edge and the corner that it runs from.
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


def mapped(cells: FlatCells, which: Integers, xi: Floats, eta: Floats) -> tuple[Floats, Floats]:
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
