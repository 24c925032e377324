"""Quadrilaterals of shells, flat or warped: membrane with drilling rotation, bending and transverse shear.

Membrane action is that of `femstruct.elements.membrane` (Ibrahimbegovic, Taylor, Wilson), bending and shear that of
MITC4 by Mindlin's theory, for thin and thick shells. Frequencies and deflections converge with h^2: bending waves
of wave number k are (k h)^2 / 24 too high along the sides of the elements (2.6 % with 8 of them to a wave, 1 % with
13) and about (k h)^2 / 36 too low along their diagonals. Curved shells are made of flat elements. The corners of a
warped element stand off its mean plane and are joined to it by rigid arms along the normal; a twisted beam of 12 x
2 elements is within 1 %.

The DOFs at each corner are UX UY UZ RX RY RZ in global axes. Corner n stands at
`femstruct.elements.plate.CORNERS[n]` of the unit square: xi runs from corner 0 to corner 3, eta from corner 0 to
corner 1. The element's own axes are those of `femstruct.elements.flat_elements.frames`: z is the normal, about
which the corners go counterclockwise. Rigidities are given in these axes, one for all elements or one each::

    (Nx, Ny, Nxy)' = A eps + B kappa     eps = (u_x, v_y, u_y + v_x)
    (Mx, My, Mxy)' = B' eps + D kappa    kappa = (RY_x, -RX_y, RY_y - RX_x)
    (Qx, Qy)'      = As gamma            gamma = (w_x + RY, w_y - RX)

A positive M stretches the side of positive z, where u = u0 + z RY. Rigidities of other directions are brought there
by `turned` and `angles` of the same module.

References: see `femstruct.elements.membrane` and, for MITC4, below; R. H. MacNeal, R. L. Harder,
Finite Elements in Analysis and Design 1 (1985) 3-20, doi:10.1016/0168-874X(85)90003-4.
"""

from __future__ import annotations

from functools import partial
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from femstruct.arrays import Floats
from femstruct.elements import flat_elements, membrane
from femstruct.elements.flat_elements import (
    Rigidities,
    cells,
    congruence,
    flatten,
    frames,
    gradients,
    masses,
    matrices_by_kind,
    out_of_own_axes,
    own_motion,
    section,
    side_shears,
    square_points,
    value_products,
    values,
)

# ----------------------------------------------------------------------------------------------------------------------
# Transverse shear of flat quadrilaterals by Mindlin's theory, with the shear strains of MITC4.
#
# The fibres across the plate lean by beta_x = RY and beta_y = -RX, bilinear in the cell as w is. Shear strains are (w_x
# + beta_x, w_y + beta_y); that along each side is taken in its middle alone and carried linearly into the cell, which
# is what keeps thin plates from locking.
#
# Reference: K. J. Bathe, E. N. Dvorkin, Int. J. Numer. Methods Eng. 21 (1985) 367-383, doi:10.1002/nme.1620210213.
# ----------------------------------------------------------------------------------------------------------------------

N_SHEAR: Final = 12


def shear_rows(corners: Floats, xi: Floats, eta: Floats) -> tuple[Floats, Floats]:
    """Rows of the shear strains from all w, all beta_x, all beta_y, and areas: [n, g, 2, 12] and [n, g].

    corners [n, 4, 2].

    Parameters
    ----------
    xi, eta : Floats
        Places as `femstruct.elements.flat_elements.gradients` takes them.
    """
    xi, eta = np.asarray(xi)[..., None], np.asarray(eta)[..., None]
    first, second, third, last = np.moveaxis(side_shears(corners), 1, 0)[:, :, None]
    along_xi = second * eta - last * (1.0 - eta)
    along_eta = first * (1.0 - xi) - third * xi
    rows = np.empty((*along_xi.shape[:2], 2, N_SHEAR))
    rows[:, :, 0], rows[:, :, 1], areas = gradients(corners, xi[..., 0], eta[..., 0], (along_xi, along_eta))
    return rows, areas


# ----------------------------------------------------------------------------------------------------------------------
# Quadrilaterals of shells, flat or warped.
# ----------------------------------------------------------------------------------------------------------------------

N_DOFS: Final = 24
# Of DOFs in own axes, in the order of `own_motion`.
_SHEAR, _BENDING, _IN_PLANE, _MEMBRANE = slice(0, 12), slice(4, 12), slice(4, 24), slice(12, 24)
_ROTATION_ROWS: Final = slice(0, 8)  # strain rows of u and v are curvature rows of beta_x and beta_y


def stiffness(
    corners: ArrayLike,
    A: ArrayLike,
    B: ArrayLike,
    D: ArrayLike,
    As: ArrayLike,
    drilling: float = 1.0,
    share: Rigidities | None = None,
) -> Floats:
    """Stiffness matrices of shell elements in global axes.

    Parameters
    ----------
    corners : ArrayLike [n, 4, 3]
        Places of the nodes [m].
    A, B, D : ArrayLike [3, 3] or [n, 3, 3]
        Membrane [N/m], coupling [N] and bending [N m] rigidity.
    As : ArrayLike [2, 2] or [n, 2, 2]
        Transverse shear rigidity [N/m], its shear correction included; all in the axes of each element.
    drilling : float
        Factor on the stiffness A66 that ties RZ to the rotation of the displacements.
    share : Rigidities | None
        A part (A, B, D, As) of the rigidities, as of some layers, whose part of the energy is wanted.

    Returns
    -------
    Floats
        [n, 24, 24], exactly symmetric.

    Raises
    ------
    InputError
        For a cell that is not convex and for rigidities that are not symmetric or not finite.

    Examples
    --------
    >>> t, A = 0.1, np.array([[1.0, 0.3, 0.0], [0.3, 1.0, 0.0], [0.0, 0.0, 0.35]])
    >>> square = [[[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]]
    >>> K = stiffness(square, t * A, 0 * A, t**3 / 12 * A, 5 / 6 * t * 0.35 * np.eye(2))
    >>> K.shape, int((np.linalg.eigvalsh(K[0]) < 1e-12).sum())  # six rigid motions
    ((1, 24, 24), 6)
    """
    R, xy, heights = _placed(corners)
    given = [*section(len(xy), A, B, D, As), *(section(len(xy), *share) if share is not None else ())]
    return matrices_by_kind(N_DOFS, partial(_stiffness, drilling), R, xy, heights, *given)


def mass(corners: ArrayLike, m0: ArrayLike, m1: ArrayLike, m2: ArrayLike) -> Floats:
    """Consistent mass matrices of shell elements in global axes, exactly integrated.

    Parameters
    ----------
    corners : ArrayLike [n, 4, 3]
        Places of the nodes [m]; m0, m1, m2 [n] or one value : integrals of rho, rho z and rho z^2 over the thickness
        [kg/m^2, kg/m, kg]; for one material rho t, 0 and rho t^3 / 12.

    Returns
    -------
    Floats
        [n, 24, 24], exactly symmetric. u, v and w bow along the sides with the rotations at their ends; m2 acts on RX,
        RY and RZ.

    Examples
    --------
    >>> M = mass([[[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]]], 10.0, 0.0, 0.0)
    >>> along_z = np.tile([0, 0, 1.0, 0, 0, 0], 4)
    >>> round(float(along_z @ M[0] @ along_z), 12)
    20.0
    """
    R, xy, heights = _placed(corners)
    return matrices_by_kind(N_DOFS, _mass, R, xy, heights, *masses(len(xy), m0, m1, m2))


def interpolate(corners: ArrayLike, xi: ArrayLike, eta: ArrayLike) -> Floats:
    """Rows that give UX UY UZ RX RY RZ at places of elements from their DOFs, all in global axes.

    Parameters
    ----------
    corners : ArrayLike [m, 4, 3]
        Nodes of the element of each place [m].
    xi, eta : ArrayLike [m]
        Place in it, 0 to 1.

    Returns
    -------
    Floats
        [m, 6, 24]: the motion of the surface through the nodes.

    Examples
    --------
    >>> rows = interpolate([[[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]]], [1.0], [0.0])
    >>> rows[0].nonzero()[1].tolist()  # corner 3
    [18, 19, 20, 21, 22, 23]
    """
    R, xy, heights = _placed(corners)
    own = flat_elements.rows(values(xi, eta)[:, :8], heights, flat_elements.side_displacements(xy))
    return out_of_own_axes(own @ own_motion(R, heights), R)


def resultants(
    corners: ArrayLike, xi: ArrayLike, eta: ArrayLike, A: ArrayLike, B: ArrayLike, D: ArrayLike, As: ArrayLike
) -> Floats:
    """Rows that give (Nx Ny Nxy Mx My Mxy Qx Qy) per length at places of elements from their DOFs in global axes.

    Arguments as `interpolate` and `stiffness`, the rigidities [..] or [m, ..].

    Returns [m, 8, 24], in the axes of each element: N and Q [N/m], M [N]. `rotate_resultants` of
    `femstruct.elements.flat_elements` gives them in other directions.
    """
    R, xy, heights = _placed(corners)
    stretch, coupling, bend, shear = section(len(xy), A, B, D, As)
    bubble = membrane.elimination(_in_plane_energy(xy, stretch, coupling, bend, 0.0))
    there = membrane.strains_at(xy, xi, eta)
    along, across = (np.asarray(place, dtype=np.float64)[:, None] for place in (xi, eta))
    strain, curvature, gamma = (np.zeros((len(xy), size, N_DOFS)) for size in (3, 3, 2))
    strain[..., _MEMBRANE] = there[..., : membrane.N_DOFS]
    strain[..., _IN_PLANE] -= there[..., membrane.N_DOFS :] @ bubble
    curvature[..., _BENDING] = there[..., _ROTATION_ROWS]
    gamma[..., _SHEAR] = shear_rows(xy, along, across)[0][:, 0]
    forces = [stretch @ strain + coupling @ curvature, coupling.swapaxes(1, 2) @ strain + bend @ curvature]
    product: Floats = np.concatenate([*forces, shear @ gamma], axis=1) @ own_motion(R, heights)
    return product


def _placed(corners: ArrayLike) -> tuple[Floats, Floats, Floats]:
    """Own axes [n, 3, 3], checked corners in the mean plane [n, 4, 2], heights of the nodes above it [n, 4]."""
    points = np.asarray(corners, dtype=np.float64)
    R = frames(points)
    xy, heights = flatten(points, R)
    return R, cells(xy), heights


def _stiffness(drilling: float, R: Floats, xy: Floats, heights: Floats, *rigidities: Floats) -> Floats:
    """rigidities : A, B, D and As of the cells, and of a share of them."""
    own = np.zeros((len(xy), N_DOFS, N_DOFS))
    stretch, coupling, bend, _, *share = rigidities
    whole = _in_plane_energy(xy, stretch, coupling, bend, drilling)
    if share:
        part = _in_plane_energy(xy, share[0], share[1], share[2], drilling)
        own[:, _IN_PLANE, _IN_PLANE] = membrane.condensed_share(whole, part)
    else:
        own[:, _IN_PLANE, _IN_PLANE] = membrane.condense(whole)
    xi, eta, weights = square_points(2)
    rows, areas = shear_rows(xy, xi, eta)
    own[:, _SHEAR, _SHEAR] += membrane.strain_energy(rows, rigidities[-1], rows, areas * weights)
    return congruence(own, own_motion(R, heights))


def _mass(R: Floats, xy: Floats, heights: Floats, m0: Floats, m1: Floats, m2: Floats) -> Floats:
    own = flat_elements.inertia(value_products(xy), flat_elements.side_displacements(xy), m0, m1, m2)
    return congruence(own, own_motion(R, heights))


def _in_plane_energy(xy: Floats, A: Floats, B: Floats, D: Floats, drilling: float) -> Floats:
    """Twice the energy of bending and stretching and of their coupling: [n, 22, 22], the bubble last."""
    strains = membrane.strains(xy)
    curvatures = strains.rows[..., _ROTATION_ROWS]
    energy = np.zeros((len(xy), 22, 22))
    energy[:, :8, :8] = membrane.strain_energy(curvatures, D, curvatures, strains.areas)
    energy[:, 8:, 8:] = strains.energy(A)
    energy[:, 8:20, 8:20] += membrane.drilling_stiffness(xy, drilling * A[:, 2, 2])
    if B.any():
        mixed = membrane.strain_energy(strains.rows, B, curvatures, strains.areas)
        energy[:, 8:, :8], energy[:, :8, 8:] = mixed, mixed.swapaxes(1, 2)
    return energy
