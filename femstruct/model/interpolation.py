"""Displacements and rotations anywhere on plates and bars, as rows on the nodal components."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import csr_array

from femstruct.arrays import Floats, Integers
from femstruct.conventions import N_COMPONENTS, TWIST
from femstruct.elements import frame, placement, plate
from femstruct.model.model import BlockMesh, FrameMesh, PlateMesh


def plate_rows(mesh: PlateMesh, places: Floats) -> tuple[Integers, Floats]:
    """Motion of places of a plate from the components of the corner nodes of their cells.

    places [p, 2] : in the plate's coordinates [m], inside it.

    Returns nodes [p, 4] and rows [p, 6, 4, 7]: three displacements and three rotations, global axes. The deflection
    follows the element's shape functions; motion in the plane, where the plate is rigid, is bilinear, which is exact.
    """
    column, xi, a = _cells_of(mesh.x, places[:, 0])
    row, eta, b = _cells_of(mesh.y, places[:, 1])
    kind = mesh.part.element
    shapes = plate.interpolate(kind, a, b, xi, eta).reshape(len(places), 4, 4, plate.dofs_per_node(kind))
    linear = np.stack([(1 - xi) * (1 - eta), (1 - xi) * eta, xi * eta, xi * (1 - eta)], axis=1)
    local = np.zeros((len(places), 6, 4, N_COMPONENTS))
    for component in (0, 1, 5):
        local[:, component, :, component] = linear
    local[:, 2:5, :, 2:5] = shapes[:, :3, :, :3]
    if plate.dofs_per_node(kind) > 3:
        local[:, 2:5, :, TWIST] = shapes[:, :3, :, 3]
    rows = np.empty_like(local)
    rows[..., :3], rows[..., 3:6], rows[..., TWIST] = (
        local[..., :3] @ mesh.axes,
        local[..., 3:6] @ mesh.axes,
        local[..., 6],
    )
    turned = np.einsum("ji,pgjnc->pginc", mesh.axes, rows.reshape(len(places), 2, 3, 4, N_COMPONENTS))
    corners = np.stack(
        [
            mesh.nodes[column, row],
            mesh.nodes[column, row + 1],
            mesh.nodes[column + 1, row + 1],
            mesh.nodes[column + 1, row],
        ],
        axis=1,
    )
    return corners, turned.reshape(rows.shape)


def frame_rows(mesh: FrameMesh, bars: Integers, places: Floats) -> tuple[Integers, Floats]:
    """Motion of places along bars from the components of their nodes.

    bars [p] : which; places [p] : from 0 at the start to 1 at the end of the flexible part.

    Returns nodes [p, k] and rows [p, 6, k, 7], k nodes a bar: three displacements and three rotations, global axes.
    """
    part, material, section = mesh.part, mesh.part.material, mesh.part.section
    local = frame.interpolate(
        part.element,
        mesh.lengths[bars],
        places,
        material.E,
        material.G,
        section.A,
        section.Iy,
        section.Iz,
        section.ky,
        section.kz,
    )
    k = mesh.bars.shape[1]
    turn = placement.rotation(mesh.axes[bars], k)
    arms = placement.rigid_arms(*np.moveaxis(mesh.arms[bars], 1, 0))
    rows = np.swapaxes(turn[:, :6, :6], -1, -2) @ local @ turn @ arms
    padded = np.zeros((len(bars), 6, k, N_COMPONENTS))
    padded[..., :6] = rows.reshape(len(bars), 6, k, 6)
    return mesh.bars[bars], padded


def block_rows(mesh: BlockMesh, places: Floats) -> tuple[Integers, Floats]:
    """Motion of places that move with a block: nodes [p, 1] and rows [p, 6, 1, 7]; places [p, 3] are global [m]."""
    rows = np.zeros((len(places), 6, 1, N_COMPONENTS))
    rows[:, :, 0, :6] = np.eye(6)
    return np.full((len(places), 1), mesh.node), carried(rows, places - mesh.center)


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


def _cells_of(grid: Floats, places: Floats) -> tuple[Integers, Floats, Floats]:
    """Interval of each place, where it lies in it from 0 to 1, and the length of the interval."""
    index = np.clip(np.searchsorted(grid, places, side="right") - 1, 0, len(grid) - 2)
    size = grid[index + 1] - grid[index]
    return index, np.clip((places - grid[index]) / size, 0.0, 1.0), size
