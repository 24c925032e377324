"""Sparse symmetric systems: patterns, nested dissection, dense fronts, and the one interface to solvers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from importlib import import_module
from importlib.util import find_spec
from typing import Any, Final, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, lapack
from scipy.linalg.blas import dsyrk, dtrsm
from scipy.sparse import csc_array, csr_array, eye_array
from scipy.sparse.linalg import splu

from femstruct.arrays import Floats, Integers

# ----------------------------------------------------------------------------------------------------------------------
# Symmetric sparse matrices brought to one pattern, so that sums of them need one analysis.
# ----------------------------------------------------------------------------------------------------------------------

Values = NDArray[Any]
"""Numbers on a pattern, real or complex [nnz]."""


@dataclass(frozen=True, eq=False)
class Pattern:
    """Where symmetric matrices may have entries, the whole diagonal among them: columns, with rows in ascending order.

    indptr [n + 1], indices [nnz], as in a csc_array. diagonal [n] : which entries are on it.
    """

    indptr: NDArray[np.int32]
    indices: NDArray[np.int32]
    diagonal: NDArray[np.int64]

    @property
    def size(self) -> int:
        """Number of rows."""
        return len(self.indptr) - 1

    @property
    def owner(self) -> NDArray[np.int32]:
        """Column of every entry [nnz]."""
        return _owner(self.indptr)

    def matrix(self, values: Values) -> csc_array:
        """The matrix of these values."""
        return csc_array((values, self.indices, self.indptr), shape=(self.size, self.size))


def aligned(matrices: Sequence[csc_array]) -> tuple[Pattern, tuple[Values, ...]]:
    """The union of the patterns and of the diagonal, and the values of each matrix on it.

    >>> first, second = csc_array(np.diag([1.0, 2.0])), csc_array(np.array([[0.0, 3.0], [3.0, 0.0]]))
    >>> pattern, values = aligned([first, second])
    >>> pattern.matrix(values[0] + values[1]).toarray()
    array([[1., 3.],
           [3., 2.]])
    """
    sums = [_canonical(matrix) for matrix in matrices]
    union = sums[0]
    different = [union, *(one for one in sums[1:] if not _alike(one, union))]
    if len(different) > 1 or not _has_diagonal(union):
        union = csc_array(eye_array(union.shape[0], format="csc"))
        for one in different:
            union = csc_array(union + _ones(one))
        union = _canonical(union)
    indptr, indices = union.indptr.astype(np.int32, copy=False), union.indices.astype(np.int32, copy=False)
    pattern = Pattern(_fixed(indptr), _fixed(indices), np.flatnonzero(indices == _owner(indptr)))
    return pattern, tuple(_spread(one, union) for one in sums)


def _canonical(matrix: csc_array) -> csc_array:
    if matrix.has_canonical_format:
        return matrix
    matrix = matrix.copy()
    matrix.sum_duplicates()
    return matrix


def _has_diagonal(matrix: csc_array) -> bool:
    return int(np.count_nonzero(matrix.indices == _owner(matrix.indptr))) == matrix.shape[0]


def _owner(indptr: NDArray[Any]) -> NDArray[np.int32]:
    """Column of every entry [nnz]."""
    return np.repeat(np.arange(len(indptr) - 1, dtype=np.int32), np.diff(indptr))


def _fixed(places: NDArray[np.int32]) -> NDArray[np.int32]:
    """A read-only view: matrices made of a pattern share it."""
    view = places.view()
    view.flags.writeable = False
    return view


def _alike(one: csc_array, other: csc_array) -> bool:
    """Whether two matrices have entries at the same places."""
    return np.array_equal(one.indptr, other.indptr) and np.array_equal(one.indices, other.indices)


def _ones(matrix: csc_array) -> csc_array:
    return csc_array((np.ones(matrix.nnz), matrix.indices, matrix.indptr), shape=matrix.shape)


def _spread(matrix: csc_array, union: csc_array) -> Values:
    """Values of a matrix at the entries of a union that contains its pattern; zero at the others."""
    if matrix.nnz == union.nnz:
        return matrix.data
    n = matrix.shape[0]
    at, all_at = (
        np.repeat(np.arange(n, dtype=np.int64), np.diff(one.indptr)) * n + one.indices for one in (matrix, union)
    )
    values: Values = np.zeros(union.nnz, dtype=matrix.dtype)
    values[np.searchsorted(all_at, at)] = matrix.data
    return values


# ----------------------------------------------------------------------------------------------------------------------
# Nested dissection: the unknowns of a sparse symmetric matrix as a tree of separators and the parts between them.
#
# The graph is cut by straight lines through coordinates it is given: distances in it from a few vertices far apart from
# each other. On the mesh of a plate or a solid they are nearly the coordinates of the nodes.
# ----------------------------------------------------------------------------------------------------------------------

LEAF = 200
"""Unknowns of a part that is not cut any further."""
_LANDMARKS = 6
_DENSE = 10.0  # times the root of the number of vertices: with more neighbours than this a vertex is of no part


@dataclass(frozen=True, eq=False)
class EliminationFront:
    """Unknowns eliminated together, after those of the children; all other neighbours come later.

    children : places in the list of fronts.
    """

    unknowns: Integers
    children: tuple[int, ...]


def dissect(pattern: Pattern) -> list[EliminationFront]:
    """Fronts of all unknowns, children before their parents; the last is the root.

    Source: A. George, SIAM J. Numer. Anal. 10 (1973) 345-363; distances as coordinates after D. Harel, Y. Koren, Graph
    Drawing by High-Dimensional Embedding, J. Graph Algorithms Appl. 8 (2004) 195-214.
    """
    group, graph = _compressed(pattern)
    weight = np.bincount(group)
    degree = np.diff(graph.indptr)
    dense = degree > max(_DENSE * np.sqrt(len(weight)), 40.0)
    parts = _Cutter(graph, weight, dense).fronts()
    members = np.argsort(group, kind="stable")
    first = np.concatenate([[0], np.cumsum(weight)])
    return [EliminationFront(members[_ranges(first[part], weight[part])], children) for part, children in parts]


def _compressed(pattern: Pattern) -> tuple[Integers, csr_array]:
    """Unknowns with the same neighbours as one vertex: (vertex of each unknown, graph of the vertices)."""
    marks = np.random.default_rng(0).random((pattern.size, 2))
    ones = pattern.matrix(np.ones(len(pattern.indices)))
    _, first, group = np.unique(ones.T @ marks, axis=0, return_index=True, return_inverse=True)
    group = group.ravel().astype(np.int64)
    gathered = csr_array((np.ones(len(group)), (group, np.arange(len(group)))), shape=(len(first), len(group)))
    return group, csr_array(csc_array(gathered @ ones[:, first]))


class _Cutter:
    """Cuts a graph in two until the parts are small."""

    def __init__(self, graph: csr_array, weight: Integers, dense: NDArray[np.bool_]) -> None:
        self._indptr, self._indices = graph.indptr.astype(np.int64), graph.indices.astype(np.int64)
        self._weight, self._dense = weight, dense
        self._side = np.zeros(len(weight), dtype=np.int8)
        self._parts: list[tuple[Integers, tuple[int, ...]]] = []

    def fronts(self) -> list[tuple[Integers, tuple[int, ...]]]:
        """(vertices, children) of every front."""
        self._places = self._embedded()
        children = self._cut(np.flatnonzero(~self._dense))
        self._parts.append((np.flatnonzero(self._dense), children))
        return self._parts

    def _cut(self, vertices: Integers) -> tuple[int, ...]:
        """Fronts of a set of vertices; returns the place of the topmost, if there is any."""
        if not len(vertices):
            return ()
        weight = self._weight[vertices]
        if weight.sum() <= LEAF or len(vertices) < 4:
            self._parts.append((vertices, ()))
            return (len(self._parts) - 1,)
        lower, separator = self._best_line(vertices, weight)
        self._side[separator] = 1
        off = self._side[vertices] == 0
        self._side[separator] = 0
        children = self._cut(vertices[lower & off]) + self._cut(vertices[~lower & off])
        self._parts.append((separator, children))
        return (len(self._parts) - 1,)

    def _best_line(self, vertices: Integers, weight: Integers) -> tuple[NDArray[np.bool_], Integers]:
        """Half of the vertices, and the lighter of the two rims of the cut; the best of four directions."""
        centred = self._places[vertices] - self._places[vertices].mean(axis=0)
        axes = np.linalg.eigh(centred.T @ centred)[1]
        long, wide = axes[:, -1], axes[:, -2] if axes.shape[1] > 1 else axes[:, -1]
        owner, near = _neighbours(self._indptr, self._indices, vertices)
        best: tuple[int, NDArray[np.bool_], Integers] | None = None
        for direction in (long, wide, long + wide, long - wide):
            order = np.argsort(centred @ direction, kind="stable")
            running = np.cumsum(weight[order])
            half = min(int(np.searchsorted(running, 0.5 * running[-1])) + 1, len(vertices) - 1)
            lower = np.zeros(len(vertices), dtype=bool)
            lower[order[:half]] = True
            self._side[vertices] = np.where(lower, 1, 2)
            crossing = lower[owner] & (self._side[near] == 2)
            self._side[vertices] = 0
            for rim in (np.unique(vertices[owner[crossing]]), np.unique(near[crossing])):
                size = int(self._weight[rim].sum())
                if best is None or size < best[0]:
                    best = size, lower, rim
        assert best is not None
        return best[1], best[2]

    def _embedded(self) -> Floats:
        """Coordinates of the vertices [n, 3]: principal directions of the distances from landmarks."""
        nearest = self._distances(0)
        far = np.iinfo(np.int64).max
        start = int(np.argmax(np.where(nearest < far, nearest, -1)))
        nearest[:] = far
        columns = []
        for _ in range(_LANDMARKS):
            distance = self._distances(start)
            reached = distance < far
            # What is not joined lies apart: a cut between the two costs nothing.
            columns.append(np.where(reached, distance, 2 * distance[reached].max(initial=0) + 1).astype(np.float64))
            nearest = np.minimum(nearest, distance)
            nearest[self._dense] = 0
            start = int(np.argmax(nearest))
        centred = np.stack(columns, axis=1)
        centred -= centred.mean(axis=0)
        axes = np.linalg.eigh(centred.T @ centred)[1]
        places: Floats = centred @ axes[:, -3:]
        return places

    def _distances(self, start: int) -> Integers:
        """Steps from a vertex to every other, over no dense vertex; the largest integer where there is no way."""
        distance = np.full(len(self._weight), np.iinfo(np.int64).max)
        front, steps = np.array([start]), 0
        distance[front] = 0
        while len(front):
            steps += 1
            near = _neighbours(self._indptr, self._indices, front)[1]
            front = np.unique(near[(distance[near] > steps) & ~self._dense[near]])
            distance[front] = steps
        return distance


def _neighbours(indptr: Integers, indices: Integers, vertices: Integers) -> tuple[Integers, Integers]:
    """(place in `vertices`, neighbour) of every edge from the vertices."""
    count = indptr[vertices + 1] - indptr[vertices]
    return np.repeat(np.arange(len(vertices)), count), indices[_ranges(indptr[vertices], count)]


def _ranges(first: Integers, count: Sequence[int] | Integers) -> Integers:
    """first[0], first[0] + 1, .. (count[0] of them), then first[1] and so on."""
    count = np.asarray(count)
    ends = np.cumsum(count)
    places: Integers = np.arange(ends[-1] if len(ends) else 0) + np.repeat(first - (ends - count), count)
    return places


# ----------------------------------------------------------------------------------------------------------------------
# Factors of real sparse symmetric matrices by dense fronts: kept to solve with, or only their negative pivots counted.
#
# Source: I. S. Duff, J. K. Reid, The multifrontal solution of indefinite sparse symmetric linear equations, ACM Trans.
# Math. Softw. 9 (1983) 302-325.
# ----------------------------------------------------------------------------------------------------------------------

# A pivot that cancelled to fewer than about five digits may have either sign.
_LOST = 1e-11


@dataclass(frozen=True, eq=False)
class _Front:
    """Unknowns `mine`, places in the order of elimination, and the places `later` of what they touch.

    entries : of the pattern that belong here. at : of each in the flat matrix of all of them.
    into : by child, places of what it left in that matrix.
    """

    mine: slice
    later: Integers
    entries: Integers
    at: Integers
    into: tuple[tuple[int, Integers], ...]


@dataclass(frozen=True, eq=False)
class _Cholesky:
    """Pivots of a positive definite head L L^T: root L, across = (what lies below the head) L^-T."""

    root: Floats
    across: Floats

    def negative(self, scale: Floats) -> int | None:
        """Number of negative pivots, 0; None where one is rounding of terms of size `scale`."""
        return None if (np.diag(self.root) ** 2 < _LOST * scale).any() else 0

    def forward(self, mine: Floats) -> Floats:
        """Solve for the unknowns of the head in place; returns what their neighbours lose."""
        dtrsm(1.0, self.root, mine.T, side=1, lower=1, trans_a=1, overwrite_b=1)
        lost: Floats = self.across @ mine
        return lost

    def backward(self, mine: Floats, later: Floats) -> None:
        """The same on the way back, with the answers of the neighbours."""
        mine -= self.across.T @ later
        dtrsm(1.0, self.root, mine.T, side=1, lower=1, overwrite_b=1)


@dataclass(frozen=True, eq=False)
class _BunchKaufman:
    """Pivots of an indefinite head, and what lies below it."""

    head: Floats
    swaps: NDArray[np.int32]
    below: Floats

    def negative(self, scale: Floats) -> int | None:
        """Number of negative pivots; None where one is rounding. A pair of rows has one of each sign."""
        scale, negative, row = scale.copy(), 0, 0
        while row < len(self.swaps):
            paired = self.swaps[row] < 0
            moved, partner = row + paired, abs(self.swaps[row]) - 1
            scale[[moved, partner]] = scale[[partner, moved]]
            pivot = self.head[moved, row]
            if abs(pivot) < _LOST * np.sqrt(scale[row] * scale[moved]):
                return None
            negative += int(paired or pivot < 0)
            row += 1 + int(paired)
        return negative

    def forward(self, mine: Floats) -> Floats:
        """Solve for the unknowns of the head in place; returns what their neighbours lose."""
        mine[:] = self.inverse(mine)
        lost: Floats = self.below @ mine
        return lost

    def backward(self, mine: Floats, later: Floats) -> None:
        """The same on the way back, with the answers of the neighbours."""
        mine -= self.inverse(self.below.T @ later)

    def inverse(self, load: Floats) -> Floats:
        """The inverse of the head times a load [n, m]."""
        answer: Floats = lapack.dsytrs(self.head, self.swaps, load, lower=1)[0]
        return answer


_Pivots = _Cholesky | _BunchKaufman


@dataclass(frozen=True, eq=False)
class FrontFactor:
    """A factor that is kept: the pivots of each front, and the order [n] in which the unknowns are eliminated."""

    order: Integers
    steps: tuple[tuple[_Front, _Pivots], ...]

    def solve(self, load: Floats) -> Floats:
        """A^-1 load, of [n] or [n, m]."""
        x = np.array(load.reshape((len(self.order), -1))[self.order], dtype=np.float64, order="C")
        for front, pivots in self.steps:
            x[front.later] -= pivots.forward(x[front.mine])
        for front, pivots in reversed(self.steps):
            pivots.backward(x[front.mine], x[front.later])
        answer = np.empty_like(x)
        answer[self.order] = x
        return answer.reshape(load.shape)


class Fronts:
    """The analysis of a pattern for factors of many matrices on it."""

    def __init__(self, pattern: Pattern) -> None:
        tree = dissect(pattern)
        self._order = np.concatenate([part.unknowns for part in tree])
        rank = np.empty(pattern.size, dtype=np.int64)
        rank[self._order] = np.arange(pattern.size)
        rows, columns = rank[pattern.indices], rank[pattern.owner]
        # Entries by the front that eliminates their column, the lower triangle in the order of elimination.
        lower = np.flatnonzero(rows >= columns)
        lower = lower[np.argsort(columns[lower], kind="stable")]
        rows, columns = rows[lower], columns[lower]
        start = np.concatenate([[0], np.cumsum([len(part.unknowns) for part in tree])])
        edge = np.searchsorted(columns, start)
        self._fronts: list[_Front] = []
        for i, part in enumerate(tree):
            first, end, own = int(start[i]), int(start[i + 1]), slice(edge[i], edge[i + 1])
            touched = np.concatenate([rows[own], *(self._fronts[child].later for child in part.children)])
            later = np.unique(touched[touched >= end])
            all_rows = np.concatenate([np.arange(first, end), later])
            at = np.searchsorted(all_rows, rows[own]) + np.searchsorted(all_rows, columns[own]) * len(all_rows)
            into = tuple((child, np.searchsorted(all_rows, self._fronts[child].later)) for child in part.children)
            self._fronts.append(_Front(slice(first, end), later, lower[own], at, into))

    def factor(self, values: Floats) -> FrontFactor:
        """Factor of the matrix of these values; raises LinAlgError where a front is singular."""
        return FrontFactor(self._order, tuple(self._eliminated(values)))

    def negative(self, values: Floats, scale: Floats) -> int | None:
        """Number of negative eigenvalues of the matrix of these values.

        Parameters
        ----------
        scale : Floats [n]
            Size of the terms each diagonal entry is summed from. None when a pivot has lost all its digits.
        """
        total, scale = 0, scale[self._order]
        try:
            for front, pivots in self._eliminated(values):
                negative = pivots.negative(scale[front.mine])
                if negative is None:
                    return None
                total += negative
        except LinAlgError:
            return None
        return total

    def _eliminated(self, values: Floats) -> Iterator[tuple[_Front, _Pivots]]:
        """The pivots of one front after the other; of what they leave, only what is still needed is held."""
        rests: dict[int, Floats] = {}
        for i, front in enumerate(self._fronts):
            count = front.mine.stop - front.mine.start
            size = count + len(front.later)
            full = np.zeros(size * size)
            full[front.at] = values[front.entries]
            matrix = full.reshape((size, size), order="F")
            for child, at in front.into:
                matrix[np.ix_(at, at)] += rests.pop(child)
            if not count:
                rests[i] = matrix
                continue
            pivots, rests[i] = _eliminated(matrix, count)
            yield front, pivots


def _eliminated(matrix: Floats, count: int) -> tuple[_Pivots, Floats]:
    """(pivots, what is left [m, m]) of the first unknowns of a matrix given by its lower triangle."""
    head, below, rest = matrix[:count, :count], matrix[count:, :count], matrix[count:, count:]
    root, failed = lapack.dpotrf(head, lower=1, clean=0)
    if not failed:
        across = dtrsm(1.0, root, below, side=1, lower=1, trans_a=1) if below.size else np.asfortranarray(below)
        left = dsyrk(-1.0, across, beta=1.0, c=rest, lower=1) if below.size else np.asfortranarray(rest)
        return _Cholesky(root, across), left
    factored, swaps, failed = lapack.dsytrf(head, lower=1, lwork=64 * count)
    if failed:
        raise LinAlgError("a front without an inverse")
    pivots = _BunchKaufman(factored, swaps, np.array(below, order="F"))
    return pivots, np.asfortranarray(rest - below @ pivots.inverse(below.T)) if below.size else np.asfortranarray(rest)


# ----------------------------------------------------------------------------------------------------------------------
# The one interface to solvers of sparse symmetric systems: analysed once by pattern, factored for any values on it.
#
# Dense fronts by LAPACK serve where nothing else is installed, SuperLU of SciPy where the matrix is complex. rslab (the
# `fast` extra) is taken where it is installed. Of all of them the analysis serves every factor and every count.
# ----------------------------------------------------------------------------------------------------------------------

# Diagonal pivots in a symmetric order. Without SymmetricMode this ordering is a hundred times slower.
_SYMMETRIC = {"SymmetricMode": True}
# Nearly diagonal pivots keep the sparsity; off-diagonal ones are taken where three digits are lost.
_COMPLEX_PIVOT = 1e-3
# Least eigenvalue, of a matrix scaled to a diagonal of terms of size 1, under which its sign may be rounding: that of a
# free frame has been seen to be wrong at 2e-17. Inside the spectrum of a plate of 200 x 200 it is 1e-9.
_LEAST_PIVOT = 1e-13


class ZeroPivot(Exception):
    """The matrix is singular to working precision."""


class Factored(Protocol):
    """A factor of a symmetric matrix A."""

    def solve(self, load: Values, /) -> Any:
        """A^-1 load, of [n] or [n, m], real or complex as A is."""


class Analysis(Protocol):
    """A pattern analysed: factors of matrices on it, and counts of their negative eigenvalues."""

    def factor(self, values: Values) -> Factored:
        """Factor of the matrix of these values, real symmetric or complex symmetric; raises ZeroPivot."""

    def negative(self, values: Floats, scale: Floats) -> int | None:
        """Number of negative eigenvalues; None where rounding may have decided one.

        Source: Sylvester's law of inertia; B. N. Parlett, The Symmetric Eigenvalue Problem, section 3.3.

        Parameters
        ----------
        scale : Floats [n]
            Size of the terms each diagonal entry is summed from.
        """


class Solver(Protocol):
    """What analyses a pattern."""

    def __call__(self, pattern: Pattern, /) -> Analysis: ...


class LapackFronts:
    """Nested dissection and dense fronts of what is real; SuperLU, with minimum degree, of what is complex."""

    def __init__(self, pattern: Pattern) -> None:
        self._pattern = pattern

    def factor(self, values: Values) -> Factored:
        try:
            if not np.iscomplexobj(values):
                return self._fronts.factor(values)
            A = self._pattern.matrix(values)
            return splu(A, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=_COMPLEX_PIVOT, options=_SYMMETRIC)
        except (LinAlgError, RuntimeError) as error:
            raise ZeroPivot(str(error)) from error

    def negative(self, values: Floats, scale: Floats) -> int | None:
        return self._fronts.negative(values, scale)

    @cached_property
    def _fronts(self) -> Fronts:
        return Fronts(self._pattern)


class Rslab:
    """Approximate minimum degree and Bunch-Kaufman pivots within supernodes."""

    def __init__(self, pattern: Pattern) -> None:
        self._pattern, self._size = pattern, pattern.size
        kept = np.flatnonzero(self._lower).astype(np.int32)
        parts = (np.ones(len(kept)), pattern.indices[kept], np.searchsorted(kept, pattern.indptr))
        lower = csc_array(parts, shape=(pattern.size, pattern.size))
        # Its default races several orderings, which costs four times the factor.
        self._analysis = import_module("rslab").analyze(lower, path="ldlt", ordering="amd", threads=1)

    def factor(self, values: Values) -> Factored:
        return self._factored(values)

    def negative(self, values: Floats, scale: Floats) -> int | None:
        try:
            factored = self._factored(values)
        except ZeroPivot:
            return None
        root = np.sqrt(scale)
        shape = np.random.default_rng(1).standard_normal(self._size)
        shape = root * factored.solve(root * shape)  # twice: towards the shape of the least eigenvalue
        least = float(np.linalg.norm(shape)) / float(np.linalg.norm(root * factored.solve(root * shape)))
        return factored.negative if least > _LEAST_PIVOT else None

    @property
    def _lower(self) -> NDArray[np.bool_]:
        """Which entries are on and below the diagonal; found again for each factor, in a hundredth of its time."""
        return np.asarray(self._pattern.indices >= self._pattern.owner)

    def _factored(self, values: Values) -> _RslabFactor:
        try:
            return _RslabFactor(self._analysis.factor(values[self._lower]))
        except RuntimeError as error:
            raise ZeroPivot(str(error)) from error


class _RslabFactor:
    def __init__(self, factor: Any) -> None:
        self._factor = factor

    @property
    def negative(self) -> int:
        """Negative eigenvalues by the pivots."""
        return int(self._factor.inertia[1])

    def solve(self, load: Values) -> Values:
        answer: Values
        if load.ndim == 1:
            answer = self._factor.solve(np.ascontiguousarray(load))
        else:
            answer = self._factor.solve_many(np.ascontiguousarray(load))
        return answer


SOLVERS: Final[dict[str, Solver]] = {"LAPACK fronts": LapackFronts} | ({"rslab": Rslab} if find_spec("rslab") else {})
"""Those at hand, by name; the fastest last."""
FASTEST: Final[str] = list(SOLVERS)[-1]
