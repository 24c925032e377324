"""Rows on nodal components: motion at the tips of rigid arms, and sparse matrices of rows."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import csr_array

from femstruct.arrays import Floats, Integers
from femstruct.conventions import N_COMPONENTS


def carried(rows: Floats, arms: Floats) -> Floats:
    """Motion at the tips of rigid arms [p, 3] or [3] from that at their feet, rows [p, 6, ...]: u + r x arm."""
    x, y, z = np.moveaxis(np.broadcast_to(arms, (len(rows), 3)), 1, 0).reshape(3, -1, *(1,) * (rows.ndim - 2))
    rx, ry, rz = rows[:, 3], rows[:, 4], rows[:, 5]
    tips = rows.copy()
    tips[:, 0] += ry * z - rz * y
    tips[:, 1] += rz * x - rx * z
    tips[:, 2] += rx * y - ry * x
    return tips


def sparse_rows(nodes: Integers, rows: Floats, n_nodes: int) -> csr_array:
    """Rows [p, r, k, 7] on the components of nodes [p, k] as one sparse matrix [p * r, n_nodes * 7]."""
    p, r = rows.shape[:2]
    columns = np.broadcast_to((nodes[:, :, None] * N_COMPONENTS + np.arange(N_COMPONENTS))[:, None], rows.shape)
    owners = np.broadcast_to(np.arange(p * r).reshape(p, r, 1, 1), rows.shape)
    used = rows != 0.0
    return csr_array((rows[used], (owners[used], columns[used])), shape=(p * r, n_nodes * N_COMPONENTS))


def node_rows(nodes: ArrayLike, components: Floats, n_nodes: int) -> csr_array:
    """Rows [m, n_nodes * 7] that combine the seven components [m, 7] of one node each."""
    numbers = np.asarray(nodes, dtype=np.int64)
    return sparse_rows(numbers[:, None], components[:, None, None, :], n_nodes)


def flat_rows(nodes: Integers, rows: Floats, shares: Floats) -> tuple[Integers, Integers, Floats]:
    """The sum of motions, each by its share [p]: nodes [m], components [m] and weights [6, m] of those that matter.

    nodes [p, k], rows [p, 6, k, 7].
    """
    used, owner = np.unique(nodes, return_inverse=True)
    weights = np.zeros((len(used), 6, N_COMPONENTS))
    np.add.at(weights, owner.reshape(nodes.shape), np.moveaxis(rows, 2, 1) * shares[:, None, None, None])
    flat = np.moveaxis(weights, 1, 0).reshape(6, -1)
    matter = np.flatnonzero((flat != 0.0).any(axis=0))
    return used[matter // N_COMPONENTS], matter % N_COMPONENTS, flat[:, matter]


def mean_of_cells(meets: Integers, components: int) -> csr_array:
    """What takes the mean of values [m * c] at the places [m] that they belong to: [p * c, m * c].

    Across lines of the grid curvatures jump; the mean of the cells errs by one order less than each of them.
    """
    share = 1.0 / np.bincount(meets)[meets]
    component = np.arange(components)
    row = (meets[:, None] * components + component).ravel()
    column = (np.arange(len(meets))[:, None] * components + component).ravel()
    return csr_array((np.repeat(share, components), (row, column)))
