"""How a plate moves: its degrees of freedom, and the motion between its nodes.

It bends. In its plane it either is rigid, with three degrees of freedom for all its nodes together, or stretches, with
three at every node: the shifts along its axes and the rotation about its normal, the drilling rotation.
"""

from __future__ import annotations

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.conventions import N_COMPONENTS, TWIST
from femstruct.elements import membrane, plate
from femstruct.model.grid.lines import interval_of
from femstruct.model.meshed import OwnDofs
from femstruct.model.region import Pair

OUT_OF_PLANE = ("deflection", "rotation about x", "rotation about y", "twist")
MEMBRANE = ("shift along x", "shift along y", "rotation about the normal")
STRETCHING = len(MEMBRANE)  # degrees of freedom of a node
IN_PLANE = tuple(f"{what}, in its plane" for what in MEMBRANE)
_U, _V, _TURN = 0, 1, 5


def plate_dofs(kind: plate.PlateElement, axes: Floats, local: Floats, size: Pair) -> OwnDofs:
    """w, the two rotations about its own axes and, for bfs16, the twist of every node; in its plane it is rigid:
    u, v and the rotation about the normal of its centroid belong to the whole plate.

    axes [3, 3] : rows are its x, y and normal. local [n, 2] : its nodes in its own coordinates [m].
    """
    labels = OUT_OF_PLANE[: plate.dofs_per_node(kind)]
    count, per_node = len(local), len(labels)
    base = np.arange(count) * N_COMPONENTS
    numbers = np.arange(count * per_node).reshape(count, per_node)
    u, v, turn = count * per_node + np.arange(3)
    x, y = (local - np.asarray(size) / 2.0).T
    move = base[:, None] + np.arange(3)
    rows: list[Integers] = []
    columns: list[Integers] = []
    values: list[Floats] = []

    def add(row: Integers, column: Integers | np.int64, value: Floats) -> None:
        shape = np.broadcast_shapes(row.shape, np.shape(column), value.shape)
        rows.append(np.broadcast_to(row, shape).ravel())
        columns.append(np.broadcast_to(column, shape).ravel())
        values.append(np.broadcast_to(value, shape).ravel())

    add(move, numbers[:, :1], axes[2])
    add(move, u, axes[0])
    add(move, v, axes[1])
    add(move, turn, np.outer(x, axes[1]) - np.outer(y, axes[0]))
    add(move + 3, numbers[:, 1:2], axes[0])
    add(move + 3, numbers[:, 2:3], axes[1])
    add(move + 3, turn, axes[2])
    if per_node > 3:
        add(base + TWIST, numbers[:, 3], np.ones(count))
    translations = np.zeros((count * per_node + 3, 3))
    translations[numbers[:, 0]] = axes[2]
    translations[[u, v]] = axes[:2]
    at = np.concatenate(rows), np.concatenate(columns)
    return OwnDofs(labels, IN_PLANE, *at, np.concatenate(values), translations)


def stretching_dofs(kind: plate.PlateElement, axes: Floats, count: int) -> OwnDofs:
    """Those of bending and, after them, three of every node in the plane; count : of nodes, axes as `plate_dofs`."""
    labels = (*OUT_OF_PLANE[: plate.dofs_per_node(kind)], *MEMBRANE)
    bending, per_node = len(labels) - len(MEMBRANE), len(labels)
    motion = np.zeros((N_COMPONENTS, per_node))
    motion[:3, 0] = motion[3:6, per_node - 1] = axes[2]
    motion[:3, bending : bending + 2] = motion[3:6, 1:3] = axes[:2].T
    if bending > 3:
        motion[TWIST, 3] = 1.0
    component, dof = np.nonzero(motion)
    node = np.arange(count)[:, None]
    rows, columns = node * N_COMPONENTS + component, node * per_node + dof
    values = np.tile(motion[component, dof], count)
    return OwnDofs(labels, (), rows.ravel(), columns.ravel(), values, np.tile(motion[:3].T, (count, 1)))


def plate_rows(
    kind: plate.PlateElement,
    axes: Floats,
    lines: tuple[Floats, Floats],
    grid: Integers,
    local: Floats,
    stretches: bool,
) -> tuple[Integers, Floats]:
    """Motion of places of a plate from the components of the corner nodes of their cells.

    axes [3, 3] : rows are its x, y and normal. lines : of its grid, along x and y [m]; grid [nx + 1, ny + 1] : numbers
    of its nodes. local [p, 2] : in the plate's coordinates [m], inside it. stretches : whether it does in its plane.

    Returns nodes [p, 4] and rows [p, 6, 4, 7]: three displacements and three rotations, global axes. The deflection
    follows the element's shape functions, motion in the plane those of the membrane; bilinear, which is exact, where
    the plate is rigid there.
    """
    column, xi, a = interval_of(lines[0], local[:, 0])
    row, eta, b = interval_of(lines[1], local[:, 1])
    shapes = plate.interpolate(kind, a, b, xi, eta).reshape(len(local), 4, 4, plate.dofs_per_node(kind))
    own = np.zeros((len(local), 6, 4, N_COMPONENTS))
    if stretches:
        flat = membrane.interpolate(membrane.rectangle(a, b), xi, eta).reshape(len(local), 3, 4, 3)
        own[np.ix_(range(len(local)), (_U, _V, _TURN), range(4), (_U, _V, _TURN))] = flat
    else:
        linear = np.stack([(1 - xi) * (1 - eta), (1 - xi) * eta, xi * eta, xi * (1 - eta)], axis=1)
        for component in (_U, _V, _TURN):
            own[:, component, :, component] = linear
    own[:, 2:5, :, 2:5] = shapes[:, :3, :, :3]
    if plate.dofs_per_node(kind) > 3:
        own[:, 2:5, :, TWIST] = shapes[:, :3, :, 3]
    rows = np.empty_like(own)
    rows[..., :3], rows[..., 3:6], rows[..., TWIST] = (
        own[..., :3] @ axes,
        own[..., 3:6] @ axes,
        own[..., 6],
    )
    turned = np.einsum("ji,pgjnc->pginc", axes, rows.reshape(len(local), 2, 3, 4, N_COMPONENTS))
    corners = np.stack(
        [
            grid[column, row],
            grid[column, row + 1],
            grid[column + 1, row + 1],
            grid[column + 1, row],
        ],
        axis=1,
    )
    return corners, turned.reshape(rows.shape)
