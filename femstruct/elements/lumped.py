"""Springs between two nodes and masses at one."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from femstruct.arrays import Floats
from femstruct.errors import InputError

_SIX = 6


def spring(stiffness: ArrayLike, R: ArrayLike | None = None) -> Floats:
    """Matrices of two-node springs, or of dashpots when given damping coefficients.

    stiffness [n, 6] : along and about the axes of the spring, [N/m] and [N m/rad]; R [n, 3, 3] or [3, 3] : rows are
    these axes in global components, None for global axes.

    Returns [n, 12, 12] for UX UY UZ RX RY RZ of the first node, then of the second; a spring to ground is the first
    6 x 6 block.

    Raises InputError for a negative or infinite value.

    Notes: the ends are taken as coincident. Where they lie apart, a sideways force would need the moment of the arm
    for balance; put both ends in one place through rigid arms (`frame.rigid_arms`).

    >>> spring([[2.0, 0, 0, 0, 0, 0]])[0, 0, [0, 6]]
    array([ 2., -2.])
    """
    values = np.asarray(stiffness, dtype=np.float64)
    if values.ndim != 2 or values.shape[1] != _SIX:
        raise InputError("stiffness", got=f"shape {values.shape}", expected="shape (n, 6)")
    if not (np.isfinite(values) & (values >= 0)).all():
        raise InputError("stiffness", got=str(values.min()), expected="finite values, zero or above")
    block = np.zeros((len(values), _SIX, _SIX))
    block[:, range(_SIX), range(_SIX)] = values
    if R is not None:
        turn = _turn(np.asarray(R, dtype=np.float64))
        block = np.swapaxes(turn, -1, -2) @ block @ turn
    return np.concatenate([np.concatenate([block, -block], axis=2), np.concatenate([-block, block], axis=2)], axis=1)


def point_mass(mass: ArrayLike, inertia: ArrayLike) -> Floats:
    """Mass matrices of rigid bodies whose centre of mass is the node.

    mass [n] : [kg]; inertia [n, 3, 3] : tensor about the centre of mass in global axes [kg m^2], with the sign
    convention of Newton's law (products of inertia negative); zeros for a particle.

    Returns [n, 6, 6] for UX UY UZ RX RY RZ. Raises InputError for a negative mass or an asymmetric tensor.

    Notes: small motion, no gyroscopic terms.

    >>> point_mass([3.0], np.zeros((1, 3, 3)))[0].diagonal()
    array([3., 3., 3., 0., 0., 0.])
    """
    masses = np.asarray(mass, dtype=np.float64)
    tensors = np.asarray(inertia, dtype=np.float64)
    if not (np.isfinite(masses) & (masses >= 0)).all():
        raise InputError("mass", got=str(masses.min()), expected="finite values, zero or above")
    rounding = 1e-12 * np.abs(tensors).max(initial=0.0)
    if np.abs(tensors - np.swapaxes(tensors, -1, -2)).max(initial=0.0) > rounding:
        raise InputError("inertia", got="an asymmetric tensor", expected="a symmetric one")
    matrices = np.zeros((len(masses), _SIX, _SIX))
    matrices[:, range(3), range(3)] = masses[:, None]
    matrices[:, 3:, 3:] = tensors
    return matrices


def _turn(R: Floats) -> Floats:
    """diag(R, R): [..., 3, 3] -> [..., 6, 6]."""
    turn = np.zeros((*R.shape[:-2], _SIX, _SIX))
    turn[..., :3, :3] = turn[..., 3:, 3:] = R
    return turn
