"""Rotations of surfaces whose nodes have none: of the rigid motions that fit nodes around places best."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array

from femstruct.arrays import Floats, Integers
from femstruct.conventions import N_COMPONENTS


def best_turns(places: Floats, counted: Floats) -> Floats:
    """Rows [p, 3, k, 3] of the rotation of the rigid motion that fits k places [p, k, 3] best, from their
    displacements; counted [p, k] : 1 for those that count, 0 for others.

    >>> square = np.array([[[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]])
    >>> turned = np.cross([0.1, 0.2, 0.3], square[0])
    >>> np.einsum("rkc,kc->r", best_turns(square, np.ones((1, 4)))[0], turned).round(9)
    array([0.1, 0.2, 0.3])
    """
    middle = np.einsum("pk,pkc->pc", counted, places) / counted.sum(axis=1)[:, None]
    off = (places - middle[:, None]) * counted[:, :, None]
    x, y, z = np.moveaxis(off, 2, 0)
    zero = np.zeros_like(x)
    cross = np.stack([np.stack([zero, -z, y], -1), np.stack([z, zero, -x], -1), np.stack([-y, x, zero], -1)], 1)
    inertia = np.einsum("pkc,pkc->p", off, off)[:, None, None] * np.eye(3) - np.einsum("pki,pkj->pij", off, off)
    found: Floats = np.einsum("pij,pjkc->pikc", np.linalg.pinv(inertia, hermitian=True), cross)
    return found


def around(corners: Integers, nodes: Integers, count: int) -> csr_array:
    """Which of `count` nodes have a facet in common with each of some nodes [m]: themselves and those around them, as
    entries of [m, count], in ascending order; none in the row of a node without a facet.

    corners [f, 4] : of the facets; of triangles the last one is there twice.

    >>> around(np.array([[0, 1, 2, 3], [2, 3, 4, 4]]), np.array([4, 0, 5]), 6).indices.tolist()
    [2, 3, 4, 0, 1, 2, 3]
    """
    facet = np.repeat(np.arange(len(corners)), corners.shape[1])
    has = csr_array((np.ones(corners.size), (corners.ravel(), facet)), shape=(count, len(corners)))
    found = csr_array(has[nodes] @ has.T)
    found.sort_indices()
    return found


def turns_around(places: Floats, near: csr_array) -> tuple[Integers, Floats]:
    """Rotations of the rigid motions that fit the nodes around each of some nodes best: nodes [m, k] and rows
    [m, 3, k, 7] of them, zero where there are fewer than k.

    places [n, 3] : of all nodes [m]. near : as `around` gives it, with entries in every row.
    """
    counts = np.diff(near.indptr)
    nodes = np.zeros((len(counts), int(counts.max(initial=0))), np.int64)
    rows = np.zeros((len(counts), 3, nodes.shape[1], N_COMPONENTS))
    for count in np.unique(counts):  # of one count at a time: rows are as if each were fitted alone
        own = np.flatnonzero(counts == count)
        nodes[own, :count] = near.indices[near.indptr[own][:, None] + np.arange(count)]
        rows[own, :, :count, :3] = best_turns(places[nodes[own, :count]], np.ones((len(own), count)))
    return nodes, rows
