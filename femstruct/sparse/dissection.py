"""Nested dissection: the unknowns of a sparse symmetric matrix as a tree of separators and the parts between them.

The graph is cut by straight lines through coordinates it is given: distances in it from a few vertices far apart from
each other. On the mesh of a plate or a solid they are nearly the coordinates of the nodes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, csr_array

from femstruct.arrays import Floats, Integers
from femstruct.sparse.patterns import Pattern

LEAF = 200
"""Unknowns of a part that is not cut any further."""
_LANDMARKS = 6
_DENSE = 10.0  # times the root of the number of vertices: with more neighbours than this a vertex is of no part


@dataclass(frozen=True, eq=False)
class Front:
    """Unknowns eliminated together, after those of the children; all other neighbours come later.

    children : places in the list of fronts.
    """

    unknowns: Integers
    children: tuple[int, ...]


def dissect(pattern: Pattern) -> list[Front]:
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
    return [Front(members[_ranges(first[part], weight[part])], children) for part, children in parts]


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
