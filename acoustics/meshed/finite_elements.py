"""Rooms of any shape: modes of a closed cavity by finite elements, and how they couple to what moves its boundary.

Second-order elements (10-node tetrahedra, 27-node hexahedra) on straight-sided cells, by scikit-fem. The cavity has
rigid walls; absorption acts on its modes (`acoustics.meshed.walls`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import scipy
from scipy.linalg import eigh
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import LinearOperator, eigsh, splu

from acoustics.air import Air
from acoustics.arrays import Floats, freeze, frozen, positive
from acoustics.errors import AcousticsError
from acoustics.meshed.cavity_mesh import CavityMesh, box_mesh
from acoustics.source import SurfaceShapes

_SHRINK: Final = 1e-7  # share of the way to its cell's middle that a point is moved, so that it is inside
OFF_WALL: Final = 1e-3  # distance from the boundary over the cell size at which a point is no longer on it
_STEPS: Final = 6  # towards answers at rest
_INDEPENDENT: Final = 1e-9  # of the largest vector's square, below which a vector says nothing new
_TRACE: Final = 1e-6  # of the largest trace's square: below it cells differ, not traces
CELLS_PER_WAVE: Final = 6.0  # of second-order cells: 0.1 % in frequency for waves along the cells (0.08 %, measured)


@dataclass(frozen=True, eq=False)
class CavityModes:
    """Modes of a closed cavity with rigid walls, the uniform one first.

    mesh : the cells. wavenumber : [n] [1/m], ascending, the first 0. shapes : [dofs, n], normalised so that the mean
    square over the volume is 1: the uniform mode is 1. complete_below : no mode is missing below it [1/m].
    shift : of the factor behind them [1/m^2]. factor : of K - shift M.
    """

    mesh: CavityMesh
    wavenumber: Floats
    shapes: Floats
    complete_below: float
    shift: float
    factor: Any

    def __post_init__(self) -> None:
        wavenumber = frozen("modes.wavenumber", self.wavenumber, (None,))
        freeze(self, wavenumber=wavenumber, shapes=frozen("modes.shapes", self.shapes, (None, len(wavenumber))))

    def at(self, points: Floats) -> Floats:
        """Values of the modes at points of the room [p, n]."""
        values: Floats = probe(self.mesh, points) @ self.shapes
        return values


def cavity_modes(mesh: CavityMesh, up_to: float) -> CavityModes:
    """Modes of the closed cavity up to the wavenumber `up_to` [1/m], 2 pi f / c.

    Notes
    -----
    Shift-invert Lanczos about a negative shift, so that the uniform mode is no special case; the count of negative
    pivots of K - mu M proves that none is missing.

    >>> from acoustics.meshed.cavity_mesh import box_mesh
    >>> modes = cavity_modes(box_mesh([0.58, 0.47, 0.1], [6, 5, 1]), up_to=2 * np.pi * 500 / 340)
    >>> (modes.wavenumber * 340 / (2 * np.pi)).round(1).tolist()
    [0.0, 293.1, 361.7, 465.6]
    """
    limit = positive("up_to", up_to, "1/m") ** 2
    K, M = mesh.matrices
    mode_count = _count_below(K, M, limit)
    shift = -limit / (mode_count + 1)
    factor = _factor(K - shift * M)
    n = K.shape[0]
    if mode_count + 2 >= n:
        raise AcousticsError("up_to", got=f"{mode_count} modes of {n} unknowns", expected="a finer mesh")
    inverse = LinearOperator((n, n), matvec=factor.solve, dtype=np.float64)
    for spare in (12, 40, 120):  # Lanczos may need more vectors before it sees all modes of one frequency
        rng = np.random.default_rng(0)
        count = min(mode_count + spare, n - 1)
        start = rng.standard_normal(n)
        squared, shapes = eigsh(K, count, M=M, sigma=shift, OPinv=inverse, v0=start, tol=1e-10)
        order = np.argsort(squared)
        squared, shapes = squared[order], shapes[:, order]
        found = int(np.count_nonzero(squared < limit))
        if found == mode_count:
            break
    else:
        raise AcousticsError(
            "cavity modes", got=f"{found} modes", expected=f"{mode_count} by the inertia count", do="change up_to"
        )
    squared[0] = 0.0
    largest = shapes[np.abs(shapes).argmax(axis=0), np.arange(shapes.shape[1])]
    shapes = shapes * np.sign(largest) * np.sqrt(mesh.volume)
    shapes[:, 1:] -= (M.sum(axis=0) @ shapes[:, 1:]) / mesh.volume
    shapes[:, 0] = 1.0  # which it is; Lanczos has it to 1e-7
    return CavityModes(mesh, np.sqrt(squared[:mode_count]), shapes[:, :mode_count], np.sqrt(limit), shift, factor)


def drive(modes: CavityModes, surface: SurfaceShapes) -> Floats:
    """Integrals over the moving boundary of a unit source at each node times the structure's shapes [dofs, k].

    Notes
    -----
    The surface's own quadrature is used, so its mesh need not match the cells; volume is conserved exactly, because
    the elements' functions sum to one at every point.

    Raises AcousticsError: a point that is not on the boundary.
    """
    points = surface.points
    away, reach = boundary_distances(modes.mesh, points)
    if away.max() > OFF_WALL * reach:
        raise AcousticsError(
            "surface.points",
            got=f"{points[away.argmax()].tolist()} m",
            expected="a point on the boundary of the cavity",
        )
    loads: Floats = probe(modes.mesh, points).T @ (surface.weights[:, None] * surface.shapes)
    return loads


def boundary_distances(mesh: CavityMesh, points: Floats, wall: str | None = None) -> tuple[Floats, float]:
    """Distances [p] of points from the boundary, or from a named wall of it, and the largest reach of a facet [m].

    Infinite for points beyond the edges of all facets near them.
    """
    cells = mesh.skfem_mesh
    corners = mesh.points[cells.facets[:, cells.boundary_facets() if wall is None else mesh.facets(wall)].T]
    middles, normals = corners.mean(axis=1), np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    reach = np.linalg.norm(corners - middles[:, None], axis=2).max(axis=1)
    _, near = scipy.spatial.cKDTree(middles).query(points, k=min(24, len(middles)))
    near = near.reshape(len(points), -1)
    away = points[:, None] - middles[near]
    off = np.abs(np.einsum("pfx,pfx->pf", away, normals[near]))
    beside = np.linalg.norm(away, axis=2) > 1.01 * reach[near]
    nearest: Floats = np.where(beside, np.inf, off).min(axis=1)
    return nearest, float(reach.max())


def wall_integrals(modes: CavityModes, wall: str) -> Floats:
    """Integrals of products of modes over a named wall [n, n] [m^2]."""
    product: Floats = modes.shapes.T @ (modes.mesh.wall_matrix(wall) @ modes.shapes)
    return product


def wall_forces(modes: CavityModes, wall: str) -> Floats:
    """What each mode's pressure does to the nodes of a named wall that gives way to it [dofs, n]."""
    forces: Floats = modes.mesh.wall_matrix(wall) @ modes.shapes
    return forces


def wall_traces(modes: CavityModes, wall: str) -> Floats:
    """What displaces a named wall in orthonormal shapes does to its nodes [dofs, r], as of `drive`.

    The shapes span all that the modes are on the wall; the integral of the square of each over it is 1.
    """
    forces = wall_forces(modes, wall)
    gram = modes.shapes.T @ forces
    size, turn = eigh(0.5 * (gram + gram.T))
    large = size > _TRACE * size[-1]
    traces: Floats = forces @ (turn[:, large] / np.sqrt(size[large]))
    return traces


def with_answers(modes: CavityModes, loads: Floats) -> CavityModes:
    """The modes and, behind them, pseudo-modes that answer loads [dofs, m] for the modes left out.

    Notes
    -----
    Modes of rigid walls have no slope at a wall, and sums of them approach what moves there only as 1 / n. The answers
    at rest and the first correction for frequency, (K - shift M)^-1 M of them, have it: what is left out falls with
    the fourth power of frequency. All are made orthogonal to all before; `complete_below` ignores them.
    """
    K, M = modes.mesh.matrices
    volume = modes.mesh.volume
    scale = np.linalg.norm(loads, axis=0)
    free = loads / np.where(scale > 0, scale, 1.0)
    known, vectors = modes.shapes / np.sqrt(volume), np.zeros((len(loads), 0))
    for _ in range(2):
        answers = modes.factor.solve(free)
        for _ in range(2):
            for before in (known, vectors):
                answers -= before @ (before.T @ (M @ answers))
        gram = answers.T @ (M @ answers)
        size, turn = eigh(0.5 * (gram + gram.T))
        large = size > _INDEPENDENT * size[-1]
        answers = answers @ (turn[:, large] / np.sqrt(size[large]))
        vectors = np.hstack([vectors, answers])
        free = M @ answers
    squared, turn = eigh(vectors.T @ (K @ vectors), vectors.T @ (M @ vectors))
    shapes = np.hstack([modes.shapes, vectors @ turn * np.sqrt(volume)])
    wavenumber = np.concatenate([modes.wavenumber, np.sqrt(squared)])
    return CavityModes(modes.mesh, wavenumber, shapes, modes.complete_below, modes.shift, modes.factor)


def left_out(modes: CavityModes, loads: Floats) -> Floats:
    """Answers at rest [dofs, m] of all the modes that are not among these, to loads [dofs, m].

    Notes
    -----
    (K - shift M) x = loads - shift M x, what the known modes hold taken out at every step. The next mode lies above
    `complete_below`, far from the shift: each step gains at least two digits.
    """
    _, M = modes.mesh.matrices
    shapes, volume = modes.shapes, modes.mesh.volume
    free = loads - M @ (shapes @ (shapes.T @ loads)) / volume
    answers = np.zeros_like(loads)
    for _ in range(_STEPS):
        answers = modes.factor.solve(free - modes.shift * (M @ answers))
        answers -= shapes @ (shapes.T @ (M @ answers)) / volume
    return answers


def probe(mesh: CavityMesh, points: Floats) -> Any:
    """Sparse [p, dofs]: values at points from those at the nodes.

    Raises AcousticsError: a point outside the room.
    """
    basis = mesh.basis
    middles = mesh.points[mesh.cells].mean(axis=1)
    _, near = scipy.spatial.cKDTree(middles).query(points)
    inward = points + _SHRINK * (middles[near] - points)
    cells = mesh.cell_of(inward)
    if (far := np.flatnonzero(cells < 0)).size:  # in cells of very unequal sizes, or outside
        cells[far] = mesh.cell_of(inward[far], near=len(mesh.cells))
    if (cells < 0).any():
        low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
        raise AcousticsError(
            "points",
            got="a point outside the cavity",
            expected=f"points inside, within {low.tolist()} to {high.tolist()} m",
        )
    # as scikit-fem's Basis.probes, which looks for every point in every cell that is near to any
    local = basis.mapping.invF(inward.T[:, :, None], tind=cells)
    values = [basis.elem.gbasis(basis.mapping, local, k, tind=cells)[0][:, 0] for k in range(basis.Nbfun)]
    rows = np.tile(np.arange(len(points)), basis.Nbfun)
    columns = basis.element_dofs[:, cells].ravel()
    return coo_array((np.concatenate(values), (rows, columns)), shape=(len(points), basis.N)).tocsr()


def _factor(matrix: csc_array) -> Any:
    return splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})


def _count_below(K: csc_array, M: csc_array, limit: float) -> int:
    """Number of eigenvalues below `limit`, by the signs of the pivots; a little above it where it is one of them."""
    for step in (0.0, 1e-9, 1e-6, 1e-4):
        factor = _factor(K - limit * (1 + step) * M)
        pivots = factor.U.diagonal()
        if (factor.perm_r == factor.perm_c).all() and np.abs(pivots).min() > 1e-12 * np.abs(pivots).max():
            return int(np.count_nonzero(pivots < 0))
    raise AcousticsError("up_to", got="a frequency at which the pivots cannot be counted", do="change it slightly")


# ----------------------------------------------------------------------------------------------------------------------
# A box that is cut into cells: what a rectangular room with walls of its own is meshed with.
# ----------------------------------------------------------------------------------------------------------------------

MOST_CELLS: Final = 5000  # of a box that is cut for somebody: its modes take a minute then


def cut_box(size: Floats, up_to_hz: float, air: Air) -> CavityMesh:
    """A box [0, size] cut into cells, six to a wave at a frequency; its walls are x0, x1, y0, y1, floor and ceiling.

    Raises AcousticsError: more than 5000 cells.

    >>> cut_box(np.array([4.0, 3.0, 2.5]), 100.0, Air()).cells.shape
    (210, 8)
    """
    cells = [int(n) for n in np.ceil(size * CELLS_PER_WAVE * positive("up_to_hz", up_to_hz, "Hz") / air.c - 1e-9)]
    if np.prod(cells) > MOST_CELLS:
        share = (MOST_CELLS / np.prod(cells)) ** (1 / 3)
        raise AcousticsError(
            "up_to_hz",
            got=f"{up_to_hz:g} Hz, for which the room is cut into {np.prod(cells)} cells",
            expected=f"about {0.95 * share * up_to_hz:.0f} Hz or less, for {MOST_CELLS} cells at most",
        )
    mesh = box_mesh([float(side) for side in size], cells)
    names = {"z0": "floor", "z1": "ceiling"}
    return CavityMesh(mesh.points, mesh.cells, {names.get(wall, wall): at for wall, at in mesh.walls.items()})
