"""The cells of a room of any shape: tetrahedra or hexahedra, and the named parts of its boundary."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Any, Final

import numpy as np
import scipy
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_array
from scipy.sparse.csgraph import connected_components

from acoustics.arrays import Floats, Integers, freeze, frozen
from acoustics.errors import AcousticsError
from acoustics.tags import stored_as

HEX_OF_MESHIO: Final = (0, 4, 3, 1, 7, 5, 2, 6)  # scikit-fem's corner i is meshio's corner HEX_OF_MESHIO[i]
_SIX: Final = np.array([[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]])
NEAR: Final = 48  # cells next to a point that it is looked for in
_EDGE: Final = 1e-9  # share of a cell by which a point on its side may be outside
_BENT: Final = 0.94  # cosine of 20 degrees
EXACT: Final = 5  # order of quadrature: products of two functions on parallelepipeds and straight tetrahedra


@stored_as("cavity mesh/1")
@dataclass(frozen=True, eq=False)
class CavityMesh:
    """The cells of a room, tetrahedra or hexahedra, and the named parts of its boundary.

    points : [n, 3] [m]. cells : [m, 4] or [m, 8], corner numbers in the order of VTK and meshio.
    walls : {name: [f, 3] or [f, 4]}, corner numbers of boundary facets, in any order.

    Raises AcousticsError: cells of another kind, corner numbers that do not exist, a cell without volume, a wall facet
    that is not on the boundary, cells that fall apart.

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
                expected="cells with a positive volume, corners in the order of VTK",
            )
        for name in walls:
            self.facets(name)
        rooms = _apart(cells)
        if rooms > 1:
            raise AcousticsError(
                "cavity.cells",
                got=f"{rooms} separate volumes of air",
                expected="one room",
                do="join their points, or give each a mesh of its own",
            )

    @cached_property
    def skfem_mesh(self) -> Any:
        """scikit-fem's mesh of the cells."""
        from skfem import MeshHex, MeshTet

        points = np.ascontiguousarray(self.points.T)
        if self.cells.shape[1] == 4:
            return MeshTet(points, np.ascontiguousarray(self.cells.T))
        return MeshHex(points, np.ascontiguousarray(self.cells[:, HEX_OF_MESHIO].T))

    @cached_property
    def basis(self) -> Any:
        """scikit-fem's basis of second order on the cells; what only looks at cells and walls does without it."""
        from skfem import Basis, ElementHex2, ElementTetP2

        element = ElementTetP2() if self.cells.shape[1] == 4 else ElementHex2()
        return Basis(self.skfem_mesh, element, intorder=EXACT)

    @cached_property
    def matrices(self) -> tuple[csc_array, csc_array]:
        """Integrals of the products of the elements' gradients, and of the elements' functions [dofs, dofs]."""
        from skfem import BilinearForm
        from skfem.helpers import dot, grad

        basis = self.basis
        stiffness = BilinearForm(lambda u, v, _: dot(grad(u), grad(v))).assemble(basis)
        mass = BilinearForm(lambda u, v, _: u * v).assemble(basis)
        return csc_array(stiffness), csc_array(mass)

    def wall_matrix(self, wall: str) -> csc_array:
        """Integrals of the products of the elements' functions over a named wall [dofs, dofs], kept for its next use.

        Raises AcousticsError: no such wall.
        """
        from skfem import BilinearForm, FacetBasis

        if wall not in self._of_walls:
            element = type(self.basis.elem)()  # scikit-fem keeps values in one, which go stale in another basis
            facets = FacetBasis(self.skfem_mesh, element, facets=self.facets(wall), intorder=EXACT)
            self._of_walls[wall] = csc_array(BilinearForm(lambda u, v, _: u * v).assemble(facets))
        return self._of_walls[wall]

    @cached_property
    def _of_walls(self) -> dict[str, csc_array]:
        """Matrices of walls that were asked for."""
        return {}

    @cached_property
    def edges(self) -> Floats:
        """Ends [m, 2, 3] of the boundary's edges where it bends by more than 20 degrees [m]."""
        cells = self.skfem_mesh
        corners = cells.facets[:, cells.boundary_facets()].T  # in order round the facet
        away = self.points[corners[:, 1:3]] - self.points[corners[:, :1]]
        normals = np.cross(away[:, 0], away[:, 1])
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        pairs = np.sort(np.stack([corners, np.roll(corners, -1, axis=1)], axis=-1), axis=-1).reshape(-1, 2)
        ends, number = np.unique(pairs, axis=0, return_inverse=True)
        facet = np.argsort(number.ravel(), kind="stable").reshape(-1, 2) // corners.shape[1]  # each edge has two
        bent = np.abs(np.einsum("ex,ex->e", normals[facet[:, 0]], normals[facet[:, 1]])) < _BENT
        found: Floats = self.points[ends[bent]]
        return found

    @property
    def volume(self) -> float:
        """Volume of all cells [m^3]."""
        return float(self.basis.dx.sum())

    @property
    def largest_cell(self) -> float:
        """Largest extent of a cell along an axis [m]."""
        corners = self.points[self.cells]
        return float(np.ptp(corners, axis=1).max())

    def contains(self, points: Floats) -> NDArray[np.bool_]:
        """Whether points [p, 3] lie in one of the cells next to them, with straight sides [p]."""
        return self.cell_of(points) >= 0

    def cell_of(self, points: Floats, near: int = NEAR) -> Integers:
        """The cell that each of points [p, 3] lies in, of the `near` next to it, sides taken as straight [p]; or -1."""
        own = self.cells if self.cells.shape[1] == 4 else self.cells[:, _SIX].reshape(-1, 4)
        corners = self.points[own].reshape(len(self.cells), -1, 4, 3)
        inverse = np.linalg.inv(corners[:, :, 1:] - corners[:, :, :1])
        _, next_to = scipy.spatial.cKDTree(self.points[self.cells].mean(axis=1)).query(
            points, k=min(near, len(self.cells))
        )
        found = np.full(len(points), -1)
        left = np.arange(len(points))
        for candidates in next_to.reshape(len(points), -1).T:
            cells = candidates[left]
            away = points[left, None] - corners[cells, :, 0]
            share = np.einsum("pti,ptij->ptj", away, inverse[cells])
            inside = ((share.min(axis=2) > -_EDGE) & (share.sum(axis=2) < 1 + _EDGE)).any(axis=1)
            found[left[inside]] = cells[inside]
            left = left[~inside]
        return found

    def wall_area(self, wall: str) -> float:
        """Area of a named wall of flat facets [m^2].

        >>> round(box_mesh([4, 3, 2], [2, 2, 2]).wall_area("x0"), 12)
        6.0
        """
        corners = self.points[self.walls[wall]]
        if corners.shape[1] == 3:
            pairs = [(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])]
        else:  # in any order: of the three pairs of lines the diagonals span most
            turns = ((0, 1, 2, 3), (0, 2, 1, 3), (0, 3, 1, 2))
            pairs = [(corners[:, b] - corners[:, a], corners[:, d] - corners[:, c]) for a, b, c, d in turns]
        spans = np.stack([np.linalg.norm(np.cross(*pair), axis=1) for pair in pairs])
        return 0.5 * float(spans.max(axis=0).sum())

    @cached_property
    def _outer(self) -> dict[tuple[int, ...], int]:
        """Number of each facet of the boundary, by its corners in rising order."""
        mesh = self.skfem_mesh
        outer = mesh.boundary_facets()
        corners = np.sort(mesh.facets[:, outer], axis=0).T.tolist()
        return {tuple(own): number for own, number in zip(corners, outer.tolist(), strict=True)}

    def facets(self, wall: str) -> Integers:
        """Numbers of a wall's facets in scikit-fem's mesh.

        Raises AcousticsError: no such wall, a facet that is not on the boundary.
        """
        if wall not in self.walls:
            raise AcousticsError("cavity.walls", got=f"'{wall}'", expected=", ".join(self.walls) or "a named wall")
        try:
            return np.array([self._outer[tuple(sorted(one))] for one in self.walls[wall].tolist()], dtype=np.int64)
        except KeyError as error:
            raise AcousticsError(
                f"cavity.walls.{wall}", got=f"a facet with corners {error}", expected="facets of the boundary"
            ) from None


def _apart(cells: Integers) -> int:
    """Number of bodies of cells that share no corner."""
    n = int(cells.max()) + 1
    pairs = np.column_stack([np.repeat(cells[:, 0], cells.shape[1]), cells.ravel()])
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(n, n))
    _, label = connected_components(graph, directed=False)
    return len(np.unique(label[np.unique(cells)]))


def box_mesh(size: tuple[float, float, float] | list[float], cells: tuple[int, int, int] | list[int]) -> CavityMesh:
    """A box [0, Lx] x [0, Ly] x [0, Lz] of `cells` hexahedra in each direction; its walls are x0, x1, y0, ..., z1."""
    grid, number = _lattice(size, cells)
    walls = {}
    for axis, name in enumerate("xyz"):
        for side in (0, 1):
            face: Integers = np.take(number, -side, axis=axis)
            corners = [face[:-1, :-1], face[1:, :-1], face[1:, 1:], face[:-1, 1:]]
            walls[f"{name}{side}"] = np.stack([corner.ravel() for corner in corners], axis=1)
    return CavityMesh(grid, _hexahedra(number), walls)


def box_cells(size: Sequence[float], counts: Sequence[int]) -> tuple[Floats, Integers]:
    """Points [n, 3] [m] and cells [m, 8] of `box_mesh`, which need nothing else.

    >>> [part.shape for part in box_cells([1, 1, 2], [2, 2, 4])]
    [(45, 3), (16, 8)]
    """
    grid, number = _lattice(size, counts)
    return grid, _hexahedra(number)


def _lattice(size: Sequence[float], counts: Sequence[int]) -> tuple[Floats, Integers]:
    """Points [n, 3] of a box's cells, and their numbers along its three axes."""
    axes = [np.linspace(0, length, n + 1) for length, n in zip(size, counts, strict=True)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    return grid.reshape(-1, 3), np.arange(grid.size // 3, dtype=np.int64).reshape(*grid.shape[:3])


def _hexahedra(number: Integers) -> Integers:
    """Corners [m, 8] of the cells between points that are numbered along three axes, in the order of VTK."""
    base = [
        number[i : i - 1 or None, j : j - 1 or None, k : k - 1 or None]
        for k in (0, 1)
        for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))
    ]
    return np.stack([corner.ravel() for corner in base], axis=1)
