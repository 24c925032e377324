"""Axes of flat elements in space: each element's own frame, rigidities turned into it, matrices turned out of it."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from femstruct.arrays import Floats
from femstruct.elements import laminate
from femstruct.errors import InputError

_OF_SHIFTS: Final = [3, 4, 0]  # u, v, w among own DOFs
PARALLEL: Final = 1e-3
"""Sine of the angle to the normal below which a direction has no place in the plane of an element."""


def frames(corners: ArrayLike) -> Floats:
    """Own axes of flat elements: x and y in the plane, z the normal, about which the corners go counterclockwise.

    corners [n, 3, 3] or [n, 4, 3] : corners of triangles or quadrilaterals in space [m].

    Returns R [n, 3, 3]: rows are x, y and z in global components, as of `femstruct.elements.placement.directions`.

    Raises InputError for an element without area.

    Notes
    -----
    x of a quadrilateral lies as near as can be to two of its sides, so that it depends on the corner to start with by
    quarter turns alone; x of a triangle lies along its first side. Rigidities that depend on direction are given in
    these axes: `turned` brings them here.

    >>> bool(np.allclose(frames([[[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]]])[0], np.eye(3)))
    True
    """
    points = np.asarray(corners, dtype=np.float64)
    if points.ndim != 3 or points.shape[1] not in (3, 4) or points.shape[2] != 3:
        raise InputError("corners", got=f"shape {points.shape}", expected="shape (n, 3, 3) or (n, 4, 3)")
    if points.shape[1] == 3:
        along, other = points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]
        normal = _unit(np.cross(along, other))
        x = _unit(along)
    else:
        first, second = points[:, 2] - points[:, 0], points[:, 3] - points[:, 1]
        normal = _unit(np.cross(first, second))
        r, s = _unit(first - second), _unit(first + second)
        x = _unit(_unit(r + s) + _unit(r - s))
    return np.stack([x, np.cross(normal, x), normal], axis=1)


def flattened(corners: Floats, R: Floats) -> tuple[Floats, Floats]:
    """Corners in the plane of each element and their heights above it: [n, k, 2] and [n, k] [m], about the centre."""
    own = (corners - corners.mean(axis=1, keepdims=True)) @ R.swapaxes(1, 2)
    return own[..., :2], own[..., 2]


def angles(R: ArrayLike, direction: ArrayLike) -> Floats:
    """Angles [n] [rad] about z from the x axes of frames R [n, 3, 3] to a direction in space, laid into each plane.

    direction [3] or [n, 3]. Raises InputError for a direction along the normal of an element.

    >>> round(float(angles(np.eye(3)[None], [1.0, 1.0, 5.0])[0] / np.pi), 12)
    0.25
    """
    axes = np.asarray(R, dtype=np.float64)
    wanted = np.broadcast_to(np.asarray(direction, dtype=np.float64), (len(axes), 3))
    along, across, _ = np.einsum("nij,nj->in", axes, wanted)
    lost = ~(np.hypot(along, across) > PARALLEL * np.linalg.norm(wanted, axis=1))
    if lost.any():
        where = f"orientation at cell {np.flatnonzero(lost)[0]}"
        raise InputError(where, got="the direction of its normal", expected="a direction along the surface")
    result: Floats = np.arctan2(across, along)
    return result


def turned(rigidity: ArrayLike, angle: ArrayLike) -> Floats:
    """Rigidities in the axes of elements from those in the axes of the material.

    rigidity [3, 3] or [n, 3, 3] : A, B or D for (xx, yy, 2 xy); [2, 2] or [n, 2, 2] : As for the shear strains of x and
    y; angle [n] : from x of the element to x of the material about z [rad], of `angles`.

    Returns [n, 3, 3] or [n, 2, 2].

    >>> turned(np.diag([4.0, 1.0, 0.5]), [np.pi / 2])[0].round(12).diagonal()
    array([1. , 4. , 0.5])
    """
    matrix = np.asarray(rigidity, dtype=np.float64)
    return laminate.turned_shear(matrix, angle) if matrix.shape[-1] == 2 else laminate.turned(matrix, angle)


def turned_resultants(rows: ArrayLike, angle: ArrayLike) -> Floats:
    """Rows of (Nx Ny Nxy Mx My Mxy Qx Qy) in axes turned by angles about z: [m, 8, k], [m] [rad] -> [m, 8, k].

    >>> turned_resultants(np.eye(8)[None, :, :1], [np.pi / 2])[0, :, 0].round(12)
    array([ 0.,  1., -0.,  0.,  0.,  0.,  0.,  0.])
    """
    forces, turn = np.asarray(rows, dtype=np.float64), np.asarray(angle, dtype=np.float64)
    stress_turn = laminate.strain_turn(-turn).swapaxes(1, 2)
    parts = [
        stress_turn @ forces[:, :3],
        stress_turn @ forces[:, 3:6],
        laminate.shear_strain_turn(turn) @ forces[:, 6:],
    ]
    return np.concatenate(parts, axis=1)


def own_motion(R: Floats, heights: Floats) -> Floats:
    """Motion of the corners of a mean plane from that of the nodes: T [n, 6 k, 6 k].

    R [n, 3, 3] : axes of the elements; heights [n, k] : of the nodes above the mean plane [m], to which arms along the
    normal join them: u = u_node - z RY, v = v_node + z RX.

    Columns: UX UY UZ RX RY RZ of every node in global axes. Rows, in own axes: all w, all beta_x, all beta_y, all u,
    all v, all RZ, with beta_x = RY and beta_y = -RX the lean of the fibres across the plate: shear (w, beta), bending
    (beta) and stretching (u, v, RZ) each have DOFs side by side, and beta bends as u and v stretch.
    """
    count, nodes = heights.shape
    T = np.zeros((count, 6, nodes, nodes, 2, 3))
    shift, turn = 0, 1
    for node in range(nodes):
        T[:, _OF_SHIFTS, node, node, shift] = R
        T[:, 1, node, node, turn], T[:, 2, node, node, turn] = R[:, 1], -R[:, 0]
        T[:, 5, node, node, turn] = R[:, 2]
        T[:, 3, node, node, turn] = -heights[:, node, None] * R[:, 1]
        T[:, 4, node, node, turn] = heights[:, node, None] * R[:, 0]
    return T.reshape(count, 6 * nodes, 6 * nodes)


def out_of_own_axes(rows: Floats, R: Floats) -> Floats:
    """Rows [m, 6, k] that give shifts and rotations in axes R [m, 3, 3], made to give them in global ones."""
    parts = rows.reshape(len(rows), 2, 3, -1)
    result: Floats = (R.swapaxes(1, 2)[:, None] @ parts).reshape(rows.shape)
    return result


def congruent(matrices: Floats, T: Floats) -> Floats:
    """T' matrices T, exactly symmetric."""
    return symmetric(T.swapaxes(1, 2) @ (matrices @ T))


def symmetric(matrices: Floats) -> Floats:
    """The symmetric part: products of matrices round differently above and below the diagonal."""
    result: Floats = matrices + matrices.swapaxes(-1, -2)
    result *= 0.5
    return result


def _unit(vectors: Floats) -> Floats:
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    if not (length > 0).all():
        where = f"cell {np.flatnonzero(~(length[..., 0] > 0))[0]}"
        raise InputError(
            where, got="corners without an area between them", expected="corners of a flat element in turn"
        )
    result: Floats = vectors / length
    return result
