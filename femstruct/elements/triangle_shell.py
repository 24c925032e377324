"""Flat triangles of shells: membrane with drilling rotation, bending and transverse shear; the fillers beside quads.

Membrane action is Felippa's optimal triangle (OPT, `femstruct.elements.facets.andes`), bending and shear Katili's DKMT
(`femstruct.elements.facets.dkmt`), for thin and thick shells; both converge with h^2. Use quadrilaterals where it can
be: thin twisted or doubly curved shells of triangles are far too stiff on coarse meshes (a strip twisted by 90 degrees,
12 x 2, moves a twentieth of what it should), since flat triangles cannot bend there without stretching. Their moments
converge with h alone, and their shear forces in thin plates stay a tenth off.

The DOFs at each corner are UX UY UZ RX RY RZ in global axes. A place is corner 0 + xi (corner 1 - corner 0) + eta
(corner 2 - corner 0). Own axes are those of `femstruct.elements.facets.axes.frames`, rigidities and resultants those of
`femstruct.elements.quad_shell`.
"""

from __future__ import annotations

from functools import cache
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from femstruct.arrays import Floats
from femstruct.elements.facets import andes, dkmt, motion
from femstruct.elements.facets.axes import congruent, flattened, frames, out_of_own_axes, own_motion
from femstruct.elements.facets.congruent import each_once
from femstruct.elements.facets.quadrilateral import cross
from femstruct.elements.facets.rigidity import Rigidities, masses, section
from femstruct.elements.membrane import strain_energy
from femstruct.errors import InputError

N_DOFS: Final = 18
MIDDLES: Final = np.array([[0.5, 0.5, 0.0], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5]])
"""Points of integration, the middles of the sides with a third of the area each, as shares of the corners."""
_PLATE, _MEMBRANE = slice(0, 9), slice(9, 18)


def stiffness(
    corners: ArrayLike, A: ArrayLike, B: ArrayLike, D: ArrayLike, As: ArrayLike, share: Rigidities | None = None
) -> Floats:
    """Stiffness matrices of triangular shell elements in global axes.

    corners [n, 3, 3] : places of the nodes [m]; A, B, D [3, 3] or [n, 3, 3] : membrane [N/m], coupling [N] and bending
    [N m] rigidity; As [2, 2] or [n, 2, 2] : transverse shear rigidity [N/m], its shear correction included; all in the
    axes of each element. share : a part (A, B, D, As) of the rigidities, as of some layers, whose part of the energy is
    wanted.

    Returns [n, 18, 18], exactly symmetric. Raises InputError for elements without area and for rigidities that are not
    symmetric or not finite.

    Notes
    -----
    The strains that OPT assumes, a mean and a part linear in the cell, give its stiffness when their energy is summed
    at the middles of the sides; B couples them there to the curvatures.

    >>> t, A = 0.1, np.array([[1.0, 0.3, 0.0], [0.3, 1.0, 0.0], [0.0, 0.0, 0.35]])
    >>> K = stiffness([[[0, 0, 0], [1, 0, 0], [0, 1, 0]]], t * A, 0 * A, t**3 / 12 * A, 5 / 6 * t * 0.35 * np.eye(2))
    >>> K.shape, int((np.linalg.eigvalsh(K[0]) < 1e-12).sum())  # six rigid motions
    ((1, 18, 18), 6)
    """
    R, xy = _placed(corners)
    given = [*section(len(xy), A, B, D, As), *(section(len(xy), *share) if share is not None else ())]
    return each_once(N_DOFS, _stiffness, R, xy, *given)


def mass(corners: ArrayLike, m0: ArrayLike, m1: ArrayLike, m2: ArrayLike) -> Floats:
    """Consistent mass matrices of triangular shell elements in global axes, exactly integrated.

    corners [n, 3, 3] : places of the nodes [m]; m0, m1, m2 [n] or one value : integrals of rho, rho z and rho z^2 over
    the thickness [kg/m^2, kg/m, kg].

    Returns [n, 18, 18], exactly symmetric. u, v and w bow along the sides with the rotations at their ends, which are
    linear; m2 acts on RX, RY and RZ.

    >>> M = mass([[[0, 0, 0], [2, 0, 0], [0, 1, 0]]], 10.0, 0.0, 0.0)
    >>> along_x = np.tile([1.0, 0, 0, 0, 0, 0], 3)
    >>> round(float(along_x @ M[0] @ along_x), 12)
    10.0
    """
    R, xy = _placed(corners)
    return each_once(N_DOFS, _mass, R, xy, *masses(len(xy), m0, m1, m2))


def interpolate(corners: ArrayLike, xi: ArrayLike, eta: ArrayLike) -> Floats:
    """Rows that give UX UY UZ RX RY RZ at places of elements from their DOFs, all in global axes.

    corners [m, 3, 3] : nodes of the element of each place [m]; xi, eta [m] : place in it, 0 to 1, xi + eta at most 1.

    Returns [m, 6, 18].

    >>> interpolate([[[0, 0, 0], [2, 0, 0], [0, 1, 0]]], [0.0], [1.0])[0].nonzero()[1].tolist()  # corner 2
    [12, 13, 14, 15, 16, 17]
    """
    R, xy = _placed(corners)
    in_plane = np.zeros((len(xy), 3))
    own = motion.rows(_values(_shares(xi, eta)), in_plane, motion.side_displacements(xy))
    return out_of_own_axes(own @ own_motion(R, in_plane), R)


def resultants(
    corners: ArrayLike, xi: ArrayLike, eta: ArrayLike, A: ArrayLike, B: ArrayLike, D: ArrayLike, As: ArrayLike
) -> Floats:
    """Rows that give (Nx Ny Nxy Mx My Mxy Qx Qy) per length at places of elements from their DOFs in global axes.

    Arguments as `interpolate` and `stiffness`, the rigidities [..] or [m, ..].

    Returns [m, 8, 18], in the axes of each element: N and Q [N/m], M [N]. `turned_resultants` of
    `femstruct.elements.facets.axes` gives them in other directions.
    """
    R, xy = _placed(corners)
    stretch, coupling, bend, shear = section(len(xy), A, B, D, As)
    areas, at = _areas(xy), _shares(xi, eta)[:, None]
    own = np.zeros((len(xy), 8, N_DOFS))
    strains = andes.strain_rows(xy, areas, stretch, at)[:, 0]
    curvatures, shears = (rows[:, 0] for rows in dkmt.bending_rows(xy, areas, bend, shear, at))
    own[:, :3, _MEMBRANE], own[:, :3, _PLATE] = stretch @ strains, coupling @ curvatures
    own[:, 3:6, _MEMBRANE], own[:, 3:6, _PLATE] = coupling.swapaxes(1, 2) @ strains, bend @ curvatures
    own[:, 6:, _PLATE] = shear @ shears
    product: Floats = own @ own_motion(R, np.zeros((len(xy), 3)))
    return product


def _stiffness(R: Floats, xy: Floats, *rigidities: Floats) -> Floats:
    """rigidities : A, B, D and As of the cells, from which the strains follow, and of a share of them."""
    (stretch, _, bend, shear), (A, B, D, As) = rigidities[:4], rigidities[-4:]
    areas, at = _areas(xy), np.broadcast_to(MIDDLES, (len(xy), 3, 3))
    each = np.repeat(areas[:, None] / 3.0, 3, axis=1)
    own = np.zeros((len(xy), N_DOFS, N_DOFS))
    strains = andes.strain_rows(xy, areas, stretch, at)
    curvatures, shears = dkmt.bending_rows(xy, areas, bend, shear, at)
    own[:, _MEMBRANE, _MEMBRANE] = strain_energy(strains, A, strains, each)
    own[:, _PLATE, _PLATE] = strain_energy(curvatures, D, curvatures, each) + strain_energy(shears, As, shears, each)
    if B.any():
        own[:, _MEMBRANE, _PLATE] = strain_energy(strains, B, curvatures, each)
        own[:, _PLATE, _MEMBRANE] = own[:, _MEMBRANE, _PLATE].swapaxes(1, 2)
    return congruent(own, own_motion(R, np.zeros((len(xy), 3))))


def _mass(R: Floats, xy: Floats, m0: Floats, m1: Floats, m2: Floats) -> Floats:
    own = motion.inertia(_areas(xy)[:, None, None] * _value_integrals(), motion.side_displacements(xy), m0, m1, m2)
    return congruent(own, own_motion(R, np.zeros((len(xy), 3))))


def _placed(corners: ArrayLike) -> tuple[Floats, Floats]:
    """Own axes [n, 3, 3] and corners in the plane [n, 3, 2]."""
    points = np.asarray(corners, dtype=np.float64)
    R = frames(points)
    if points.shape[1] != 3:
        raise InputError("corners", got=f"shape {points.shape}", expected="shape (n, 3, 3)")
    return R, flattened(points, R)[0]


def _areas(xy: Floats) -> Floats:
    return cross(xy[:, 1] - xy[:, 0], xy[:, 2] - xy[:, 0]) / 2.0


def _shares(xi: ArrayLike, eta: ArrayLike) -> Floats:
    """Shares [m, 3] of the corners in places."""
    along, across = np.asarray(xi, dtype=np.float64), np.asarray(eta, dtype=np.float64)
    return np.stack([1.0 - along - across, along, across], axis=-1)


def _values(shares: Floats) -> Floats:
    """Shape functions of the corners and of the sides, 1 in the middle of each: [.., 6]."""
    return np.concatenate([shares, 4.0 * shares * np.roll(shares, -1, axis=-1)], axis=-1)


@cache
def _value_integrals() -> Floats:
    """[6, 6]: integrals of products of `_values` over a triangle of unit area, exact."""
    corner, side = (np.eye(3) + 1.0) / 12.0, (np.eye(3) + 1.0) * 4.0 / 45.0
    mixed = np.array([[2.0, 1.0, 2.0], [2.0, 2.0, 1.0], [1.0, 2.0, 2.0]]) / 15.0
    return np.block([[corner, mixed], [mixed.T, side]])
