"""What the matrices of all straight members share: checked arrays of properties, and where their DOFs stand."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from femstruct.arrays import Floats
from femstruct.elements.polynomials import positive
from femstruct.errors import InputError


def property_arrays(**values: ArrayLike) -> list[Floats]:
    """Positive properties as arrays of one length; InputError names the one that is not."""
    return list(np.broadcast_arrays(*(np.atleast_1d(positive(name, value)) for name, value in values.items())))


def densities(rho: ArrayLike, like: Floats) -> Floats:
    """Densities [n] [kg/m^3], zero allowed; InputError for others."""
    density: Floats = np.broadcast_to(np.asarray(rho, dtype=np.float64), like.shape)
    if not (np.isfinite(density) & (density >= 0)).all():
        raise InputError("rho", got=str(density.min()), expected="finite values, zero or above")
    return density


def block(dofs: list[int]) -> tuple[slice, list[list[int]], list[int]]:
    """Index of the rows and columns of some DOFs in matrices [n, nd, nd]."""
    return slice(None), [[dof] for dof in dofs], dofs


def outer(scale: Floats) -> Floats:
    """Products [n, k, k] of the factors [n, k] of each element."""
    return scale[:, :, None] * scale[:, None, :]


# ----------------------------------------------------------------------------------------------------------------------
# Where a frame element stands: its local axes, their rotation to global ones, and rigid arms at its nodes.
# ----------------------------------------------------------------------------------------------------------------------

PER_NODE: Final = 6
VERTICAL: Final = 1e-3
"""Sine of the angle to global z below which a member counts as vertical for the default orientation."""
PARALLEL: Final = 1e-6
"""Sine of the angle below which an orientation vector counts as parallel to the axis."""


def directions(start: ArrayLike, end: ArrayLike, orientation: ArrayLike | None = None) -> Floats:
    """Local axes of members from their ends.

    Parameters
    ----------
    start, end : ArrayLike [n, 3]
        [m].
    orientation : ArrayLike | None [n, 3] or [3]
        A vector the local z axis comes as near to as it can, standing at a right angle to the member; None means global
        z, or global x for members within `VERTICAL` of vertical.

    Returns
    -------
    Floats
        R [n, 3, 3]: rows are local x (from start to end), y and z in global components, a right-handed set.

    Raises
    ------
    InputError
        For a member without length and for an orientation parallel to its member.

    Examples
    --------
    >>> R = directions([[0, 0, 0]], [[0, 2, 0]])
    >>> bool(np.allclose(R, [[0, 1, 0], [-1, 0, 0], [0, 0, 1]]))
    True
    """
    axis = np.atleast_2d(np.asarray(end, dtype=np.float64) - np.asarray(start, dtype=np.float64))
    length = np.linalg.norm(axis, axis=1, keepdims=True)
    if not (np.isfinite(length) & (length > 0)).all():
        raise InputError("frame line", got="two ends in one place", expected="a length above zero")
    x = axis / length
    if orientation is None:
        vertical = np.hypot(x[:, 0], x[:, 1]) < VERTICAL
        reference = np.where(vertical[:, None], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0])
    else:
        reference = np.broadcast_to(np.asarray(orientation, dtype=np.float64), x.shape)
        size = np.linalg.norm(reference, axis=1, keepdims=True)
        if not (np.isfinite(size) & (size > 0)).all():
            raise InputError("orientation", got="a zero vector", expected="a direction across the member")
        reference = reference / size
    y = np.cross(reference, x)
    sine = np.linalg.norm(y, axis=1, keepdims=True)
    if (sine < PARALLEL).any():
        raise InputError("orientation", got="a vector parallel to the member", expected="a direction across the member")
    y /= sine
    return np.stack([x, y, np.cross(x, y)], axis=1)


def rotation(R: ArrayLike, nodes: int = 2) -> Floats:
    """diag(R, R, ...), R twice for every node: global DOFs of an element -> local ones; [n, 3, 3] -> [n, 12, 12]."""
    axes = np.asarray(R, dtype=np.float64)
    count = PER_NODE * nodes
    turn = np.zeros((*axes.shape[:-2], count, count))
    for first in range(0, count, 3):
        turn[..., first : first + 3, first : first + 3] = axes
    return turn


def to_global(matrix: ArrayLike, R: ArrayLike) -> Floats:
    """Element matrices [n, nd, nd] from local axes (rows of R [n, 3, 3]) to global ones: T^T matrix T.

    >>> K = to_global(np.eye(12)[None], directions([[0, 0, 0]], [[1, 2, 3]]))
    >>> bool(np.allclose(K, np.eye(12)))
    True
    """
    return _congruent(matrix, rotation(R, np.shape(matrix)[-1] // PER_NODE))


def rigid_arms(*arms: ArrayLike) -> Floats:
    """Motion of the flexible part of an element from that of its nodes: [n, 12, 12] for two, [n, 18, 18] for three.

    The end of an arm moves by u + r x arm and turns with the node.

    Parameters
    ----------
    arms : ArrayLike
        For every node in turn the rigid arm from it to the flexible part [n, 3] [m], global axes.

    Examples
    --------
    >>> rigid_arms([[0, 2.0, 3.0]], [[0, 0, 0]])[0, 0, :6]
    array([ 1.,  0.,  0.,  0.,  3., -2.])
    """
    stacked = np.stack(np.broadcast_arrays(*(np.atleast_2d(np.asarray(arm, dtype=np.float64)) for arm in arms)))
    motion = np.tile(np.eye(PER_NODE * len(stacked)), (stacked.shape[1], 1, 1))
    for node, (x, y, z) in enumerate(np.moveaxis(stacked, 2, 1)):
        first = PER_NODE * node
        motion[:, first, first + 4], motion[:, first, first + 5] = z, -y
        motion[:, first + 1, first + 3], motion[:, first + 1, first + 5] = -z, x
        motion[:, first + 2, first + 3], motion[:, first + 2, first + 4] = y, -x
    return motion


def with_offsets(matrix: ArrayLike, *arms: ArrayLike) -> Floats:
    """Element matrices [n, nd, nd] in global axes, carried from the flexible part to nodes at the foot of rigid arms.

    Parameters
    ----------
    arms : ArrayLike
        For every node in turn the arm from it to the flexible part [n, 3] [m], global axes.

    Notes
    -----
    The arms have no mass and no flexibility; the mass of the flexible part follows exactly.
    """
    return _congruent(matrix, rigid_arms(*arms))


def _congruent(matrix: ArrayLike, motion: Floats) -> Floats:
    product = np.swapaxes(motion, -1, -2) @ np.asarray(matrix, dtype=np.float64) @ motion
    # The two matrix products round differently above and below the diagonal.
    result: Floats = (product + np.swapaxes(product, -1, -2)) / 2.0
    return result
