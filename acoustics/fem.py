"""Rooms of any shape: modes of a closed cavity by finite elements, and how they couple to what moves its boundary.

Second-order elements (10-node tetrahedra, 27-node hexahedra) on straight-sided cells, by scikit-fem. The cavity has
rigid walls; absorption acts on its modes (`acoustics.walls`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Any, Final

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import csc_array
from scipy.sparse.linalg import LinearOperator, eigsh, splu
from scipy.spatial import cKDTree

from acoustics.arrays import Floats, Integers, freeze, frozen, positive
from acoustics.errors import AcousticsError

_HEX_OF_MESHIO: Final = (0, 4, 3, 1, 7, 5, 2, 6)  # scikit-fem's corner i is meshio's corner _HEX_OF_MESHIO[i]
_EXACT: Final = 5  # order of quadrature: products of two functions on parallelepipeds and straight tetrahedra
_SHRINK: Final = 1e-7  # share of the way to its cell's middle that a point is moved, so that it is inside
OFF_WALL: Final = 1e-3  # distance from the boundary over the cell size at which a point is no longer on it
_INDEPENDENT: Final = 1e-9  # of the largest vector's square, below which a vector says nothing new
CELLS_PER_WAVE: Final = 3.0  # of second-order cells: 0.1 % in frequency


@dataclass(frozen=True, eq=False)
class CavityMesh:
    """The cells of a room, tetrahedra or hexahedra, and the named parts of its boundary.

    points : [n, 3] [m]. cells : [m, 4] or [m, 8], corner numbers in the order of VTK and meshio.
    walls : {name: [f, 3] or [f, 4]}, corner numbers of boundary facets, in any order.

    Raises AcousticsError: cells of another kind, corner numbers that do not exist, a cell without volume, a wall facet
    that is not on the boundary.

    >>> mesh = box_mesh([1, 1, 2], [2, 2, 4])
    >>> mesh.cells.shape, sorted(mesh.walls), round(mesh.volume, 12)
    ((16, 8), ['x0', 'x1', 'y0', 'y1', 'z0', 'z1'], 2.0)
    """

    points: Floats
    cells: Integers
    walls: Mapping[str, Integers]

    def __post_init__(self) -> None:
        points = frozen("cavity.points", self.points, (None, 3))
        cells = np.array(self.cells, dtype=np.int64)
        if cells.ndim != 2 or cells.shape[1] not in (4, 8) or not len(cells):
            raise AcousticsError(
                "cavity.cells", got=f"shape {cells.shape}", expected="tetrahedra [m, 4] or hexahedra [m, 8]"
            )
        if cells.min() < 0 or cells.max() >= len(points):
            raise AcousticsError(
                "cavity.cells", got=f"corner {cells.max()}", expected=f"corners 0 to {len(points) - 1}"
            )
        cells.flags.writeable = False
        walls = {name: np.array(facets, dtype=np.int64) for name, facets in self.walls.items()}
        freeze(self, points=points, cells=cells, walls=MappingProxyType(walls))
        corners = points[cells]
        ahead = [1, 2, 3] if cells.shape[1] == 4 else [1, 3, 4]
        sizes = np.linalg.det(corners[:, ahead] - corners[:, :1])
        if not sizes.min() > 0:
            raise AcousticsError(
                "cavity.cells",
                got=f"a volume of {sizes.min():.3g} m^3 at the first corner of cell {sizes.argmin()}",
                expected="cells with volume, corners in the order of VTK",
            )
        for name in walls:
            self.facets(name)

    @cached_property
    def basis(self) -> Any:
        """scikit-fem's basis of second order on the cells."""
        from skfem import Basis, ElementHex2, ElementTetP2, MeshHex, MeshTet

        if self.cells.shape[1] == 4:
            return Basis(MeshTet(self.points.T, self.cells.T), ElementTetP2(), intorder=_EXACT)
        return Basis(MeshHex(self.points.T, self.cells[:, _HEX_OF_MESHIO].T), ElementHex2(), intorder=_EXACT)

    @property
    def volume(self) -> float:
        """Volume of all cells [m^3]."""
        return float(self.basis.dx.sum())

    @property
    def largest_cell(self) -> float:
        """Largest extent of a cell along an axis [m]."""
        corners = self.points[self.cells]
        return float(np.ptp(corners, axis=1).max())

    def facets(self, wall: str) -> Integers:
        """Numbers of a wall's facets in scikit-fem's mesh.

        Raises AcousticsError: no such wall, a facet that is not on the boundary.
        """
        if wall not in self.walls:
            raise AcousticsError("cavity.walls", got=f"'{wall}'", expected=", ".join(self.walls) or "a named wall")
        mesh = self.basis.mesh
        outer = mesh.boundary_facets()
        known = {
            tuple(sorted(corners)): int(number)
            for number, corners in zip(outer, mesh.facets[:, outer].T.tolist(), strict=True)
        }
        try:
            return np.array([known[tuple(sorted(corners))] for corners in self.walls[wall].tolist()], dtype=np.int64)
        except KeyError as error:
            raise AcousticsError(
                f"cavity.walls.{wall}", got=f"a facet with corners {error}", expected="facets of the boundary"
            ) from None


def box_mesh(size: tuple[float, float, float] | list[float], cells: tuple[int, int, int] | list[int]) -> CavityMesh:
    """A box [0, Lx] x [0, Ly] x [0, Lz] of `cells` hexahedra in each direction; its walls are x0, x1, y0, ..., z1."""
    axes = [np.linspace(0, length, n + 1) for length, n in zip(size, cells, strict=True)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    number: Integers = np.arange(grid.size // 3, dtype=np.int64).reshape(*grid.shape[:3])
    base = [
        number[i : i - 1 or None, j : j - 1 or None, k : k - 1 or None]
        for k in (0, 1)
        for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))
    ]
    walls = {}
    for axis, name in enumerate("xyz"):
        for side in (0, 1):
            face: Integers = np.take(number, -side, axis=axis)
            corners = [face[:-1, :-1], face[1:, :-1], face[1:, 1:], face[:-1, 1:]]
            walls[f"{name}{side}"] = np.stack([corner.ravel() for corner in corners], axis=1)
    return CavityMesh(grid.reshape(-1, 3), np.stack([corner.ravel() for corner in base], axis=1), walls)


@dataclass(frozen=True, eq=False)
class CavityModes:
    """Modes of a closed cavity with rigid walls, the uniform one first.

    mesh : the cells. wavenumber : [n] [1/m], ascending, the first 0. shapes : [dofs, n], normalised so that the mean
    square over the volume is 1: the uniform mode is 1. complete_below : no mode is missing below it [1/m].
    shift : of the factor behind them [1/m^2].
    """

    mesh: CavityMesh
    wavenumber: Floats
    shapes: Floats
    complete_below: float
    shift: float

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

    >>> modes = cavity_modes(box_mesh([0.58, 0.47, 0.1], [6, 5, 1]), up_to=2 * np.pi * 500 / 340)
    >>> (modes.wavenumber * 340 / (2 * np.pi)).round(1).tolist()
    [0.0, 293.1, 361.7, 465.6]
    """
    limit = positive("up_to", up_to, "1/m") ** 2
    K, M = _matrices(mesh)
    wanted = _count_below(K, M, limit)
    shift = -limit / (wanted + 1)
    factor = _factor(K - shift * M)
    n = K.shape[0]
    if wanted + 2 >= n:
        raise AcousticsError("up_to", got=f"{wanted} modes of {n} unknowns", expected="a finer mesh")
    inverse = LinearOperator((n, n), matvec=factor.solve, dtype=np.float64)
    rng = np.random.default_rng(0)
    squared, shapes = eigsh(
        K, wanted + 1, M=M, sigma=shift, OPinv=inverse, v0=rng.standard_normal(n), tol=1e-10, rng=rng
    )
    order = np.argsort(squared)
    squared, shapes = squared[order], shapes[:, order]
    found = int(np.count_nonzero(squared < limit))
    if found != wanted:
        raise AcousticsError("cavity modes", got=f"{found} modes", expected=f"{wanted} by the count", do="change up_to")
    squared[0] = 0.0
    largest = shapes[np.abs(shapes).argmax(axis=0), np.arange(shapes.shape[1])]
    shapes = shapes * np.sign(largest) * np.sqrt(mesh.volume)
    return CavityModes(mesh, np.sqrt(squared[:wanted]), shapes[:, :wanted], np.sqrt(limit), shift)


def drive(modes: CavityModes, points: Floats, weights: Floats, shapes: Floats) -> Floats:
    """Integrals over the moving boundary of a unit source at each node times the structure's shapes [dofs, k].

    points [p, 3], weights [p], shapes [p, k] : quadrature of the moving surface, normal displacement into the room.

    Notes
    -----
    The surface's own quadrature is used, so its mesh need not match the cells; volume is conserved exactly, because
    the elements' functions sum to one at every point.

    Raises AcousticsError: a point that is not on the boundary.
    """
    mesh = modes.mesh.basis.mesh
    outer = mesh.facets[:, mesh.boundary_facets()]
    corners = modes.mesh.points[outer.T]
    middles, normals = corners.mean(axis=1), np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    reach = np.linalg.norm(corners - middles[:, None], axis=2).max(axis=1)
    _, near = cKDTree(middles).query(points, k=min(24, len(middles)))
    near = near.reshape(len(points), -1)
    away = points[:, None] - middles[near]
    off = np.abs(np.einsum("pfx,pfx->pf", away, normals[near]))
    off = np.where(np.linalg.norm(away, axis=2) <= 1.01 * reach[near], off, np.inf).min(axis=1)
    if off.max() > OFF_WALL * reach.max():
        raise AcousticsError(
            "surface.points", got=f"{points[off.argmax()].tolist()} m", expected="a point on the boundary of the cavity"
        )
    loads: Floats = probe(modes.mesh, points).T @ (weights[:, None] * shapes)
    return loads


def wall_integrals(modes: CavityModes, wall: str) -> Floats:
    """Integrals of products of modes over a named wall [n, n] [m^2]."""
    product: Floats = modes.shapes.T @ (_wall_matrix(modes.mesh, wall) @ modes.shapes)
    return product


def wall_forces(modes: CavityModes, wall: str) -> Floats:
    """What each mode's pressure does to the nodes of a named wall that gives way to it [dofs, n]."""
    forces: Floats = _wall_matrix(modes.mesh, wall) @ modes.shapes
    return forces


def with_answers(modes: CavityModes, loads: Floats) -> CavityModes:
    """The modes and, behind them, pseudo-modes: the answers at rest to loads [dofs, m], made orthogonal to all before.

    Notes
    -----
    Modes of rigid walls have no slope at a wall, and sums of them approach what moves there only as 1 / n; the answers
    at rest have it, so that what is left out falls with the square of frequency. `complete_below` ignores them.
    """
    K, M = _matrices(modes.mesh)
    scale = np.linalg.norm(loads, axis=0)
    vectors = _factor(K - modes.shift * M).solve(loads / np.where(scale > 0, scale, 1.0))
    for _ in range(2):
        vectors -= modes.shapes @ (modes.shapes.T @ (M @ vectors)) / modes.mesh.volume
    gram = vectors.T @ (M @ vectors)
    size, turn = eigh(0.5 * (gram + gram.T))
    large = size > _INDEPENDENT * size[-1]
    vectors = vectors @ (turn[:, large] / np.sqrt(size[large]))
    squared, turn = eigh(vectors.T @ (K @ vectors), vectors.T @ (M @ vectors))
    shapes = np.hstack([modes.shapes, vectors @ turn * np.sqrt(modes.mesh.volume)])
    wavenumber = np.concatenate([modes.wavenumber, np.sqrt(squared)])
    return CavityModes(modes.mesh, wavenumber, shapes, modes.complete_below, modes.shift)


def _wall_matrix(mesh: CavityMesh, wall: str) -> csc_array:
    from skfem import BilinearForm, FacetBasis

    basis = mesh.basis
    element = type(basis.elem)()  # scikit-fem keeps values in an element, which go stale in another basis
    facets = FacetBasis(basis.mesh, element, facets=mesh.facets(wall), intorder=_EXACT)
    return csc_array(BilinearForm(lambda u, v, _: u * v).assemble(facets))


def probe(mesh: CavityMesh, points: Floats) -> Any:
    """Sparse [p, dofs]: values at points from those at the nodes.

    Raises AcousticsError: a point outside the room.
    """
    basis = mesh.basis
    middles = mesh.points[mesh.cells].mean(axis=1)
    tree = cKDTree(middles)
    _, near = tree.query(points)
    try:
        return basis.probes((points + _SHRINK * (middles[near] - points)).T).tocsr()
    except ValueError as error:
        low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
        raise AcousticsError(
            "points",
            got="a point outside the cavity",
            expected=f"points inside, within {low.tolist()} to {high.tolist()} m",
        ) from error


def _matrices(mesh: CavityMesh) -> tuple[csc_array, csc_array]:
    from skfem import BilinearForm
    from skfem.helpers import dot, grad

    basis = mesh.basis
    stiffness = BilinearForm(lambda u, v, _: dot(grad(u), grad(v))).assemble(basis)
    mass = BilinearForm(lambda u, v, _: u * v).assemble(basis)
    return csc_array(stiffness), csc_array(mass)


def _factor(matrix: csc_array) -> Any:
    return splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})


def _count_below(K: csc_array, M: csc_array, limit: float) -> int:
    """Number of eigenvalues below `limit`, by the signs of the pivots; a little above it where it is one of them."""
    for step in (0.0, 1e-9, 1e-6, 1e-4):
        factor = _factor(K - limit * (1 + step) * M)
        pivots = factor.U.diagonal()
        if (factor.perm_r == factor.perm_c).all() and np.abs(pivots).min() > 1e-12 * np.abs(pivots).max():
            return int(np.count_nonzero(pivots < 0))
    raise AcousticsError("up_to", got="a frequency at which the pivots cannot be counted", do="move it a little")
