"""Stresses of a plate at its faces and those of its layers, node by node."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array

from femstruct.arrays import Floats, Integers
from femstruct.conventions import N_COMPONENTS, TWIST
from femstruct.elements import membrane, plate
from femstruct.model.rows import sparse_rows

SQRT3 = float(np.sqrt(3.0))


def face_rows(
    kind: plate.PlateElement,
    axes: Floats,
    sizes: tuple[Floats, Floats],
    quads: Integers,
    rigidities: tuple[Floats, Floats | None],
    of_resultants: Floats,
    n_nodes: int,
) -> csr_array:
    """Rows [q * 4 * s * 3, n_nodes * 7] of the stresses xx yy xy [Pa] at the corners of cells, at each on s faces, from
    the components of all nodes of a structure.

    axes [3, 3] : rows are the plate's x, y and normal. sizes [q] : sides of the cells along x and y [m]. quads [q, 4] :
    their corners. rigidities : D [3, 3] of bending [N m], and A [3, 3] in the plane [N/m], None where the plate is
    rigid there. of_resultants [s, 3, 6] : stresses of membrane forces and moments per length [1/m, 1/m^2].
    """
    D, A = rigidities
    xi, eta = np.tile(np.array(plate.CORNERS, dtype=np.float64), (len(quads), 1)).T
    a, b = (np.repeat(size, 4) for size in sizes)
    moments = plate.moments(kind, a, b, xi, eta, D).reshape(len(xi), 3, 4, -1)
    rows = np.zeros((len(xi), 6, 4, N_COMPONENTS))
    rows[:, 3:, :, :3] = moments[..., :1] * axes[2]
    rows[:, 3:, :, 3:6] = moments[..., 1:2] * axes[0] + moments[..., 2:3] * axes[1]
    rows[:, 3:, :, TWIST] = moments[..., 3] if moments.shape[-1] > 3 else 0.0
    if A is not None:
        rows[:, :3] = _membrane_rows(axes, sizes, A).reshape(-1, 3, 4, N_COMPONENTS)
    stresses = np.einsum("fsr,prkc->pfskc", of_resultants, rows)
    return sparse_rows(np.repeat(quads, 4, axis=0), stresses.reshape(len(xi), -1, 4, N_COMPONENTS), n_nodes)


def _membrane_rows(axes: Floats, sizes: tuple[Floats, Floats], A: Floats) -> Floats:
    """Rows [q, 4, 3, 4, 7] of the membrane forces [N/m] at the corners of cells, from the components of their corners:
    continued bilinearly from the 2 x 2 Gauss points, where they are one order better than at the corners."""
    a, b = sizes
    unit = np.array(plate.CORNERS, dtype=np.float64)
    xi, eta = np.tile(0.5 + (unit - 0.5) / SQRT3, (len(a), 1)).T
    corners = np.repeat(membrane.rectangle(a, b), 4, axis=0)
    forces = membrane.resultants(corners, xi, eta, A).reshape(len(a), 4, 3, 4, 3)
    x, y = (0.5 + (unit - 0.5) * SQRT3).T  # of the corners, in the square of the Gauss points
    shares = np.stack([(x if i else 1.0 - x) * (y if j else 1.0 - y) for i, j in plate.CORNERS], axis=1)
    forces = np.einsum("cg,qgrnk->qcrnk", shares, forces)
    rows = np.zeros((*forces.shape[:4], N_COMPONENTS))
    rows[..., :3] = forces[..., :1] * axes[0] + forces[..., 1:2] * axes[1]
    rows[..., 3:6] = forces[..., 2:] * axes[2]
    return rows
