"""Stresses of a shell at the faces of its nodes: of the cells that meet there as one smooth surface, their mean."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import connected_components

from femstruct.arrays import Floats, Integers
from femstruct.conventions import N_COMPONENTS
from femstruct.elements import quad_shell, triangle_shell
from femstruct.elements.facets.axes import angles, frames, turned_resultants
from femstruct.elements.placement import rigid_arms
from femstruct.elements.plate import CORNERS
from femstruct.model.imported.flat_cells import FlatCells, area_vectors
from femstruct.model.imported.shell_cells import Sections
from femstruct.model.rows import sparse_rows

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

    of : the sections of the cells. made : number [q + t] of the section of each cell, and by section the stresses
    [n, s, 3, 6] on s faces of membrane forces and moments per length. numbers : of the first node, and of all nodes.
    offset : as of `cell_matrices`. x [3] : of the axes that stresses are given in, laid into each cell; None for that
    of one of the cells at each place.

    Membrane forces are those at 2 x 2 points of quadrilaterals, where they are best, continued bilinearly, and the mean
    of the cells that meet at a place. Moments are those in the middle of cells: a linear field is fitted to them around
    each place, over the cells that meet there or, where the piece ends, over those around these, too, since moments of
    linear cells do not vary towards an edge.
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
        turned = turned_resultants(all_rows, angles(R[cell], directions[place]))[:, :6]
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
    meeting = csr_array((np.ones(len(places)), (places, corners)), shape=(count, n_cells))
    has = csr_array((np.ones(len(nodes)), (corners, nodes)), shape=(n_cells, n_nodes))
    edges = np.sort(np.stack([cells.corners, np.roll(cells.corners, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    different, times = np.unique(edges[edges[:, 0] != edges[:, 1]], axis=0, return_counts=True)
    ends = np.bincount(nodes[first_of], minlength=n_nodes) > 1  # a fold, or another thickness
    ends[different[times != 2]] = True
    widened = ends[nodes[first_of]].astype(float)
    wide = csr_array((widened, (np.arange(count), np.arange(count)))) @ (meeting @ has @ has.T)
    pairs = csr_array(meeting + wide).tocoo()
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

    corners : cells of the corners [k]. Returns places [k], and the first corner of each place.
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
