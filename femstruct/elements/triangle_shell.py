"""Flat triangles of shells: membrane with drilling rotation, bending and transverse shear; the fillers beside quads.

Membrane action is Felippa's optimal triangle (OPT), bending and shear Katili's DKMT, for thin and thick shells; both
converge with h^2. Use quadrilaterals
where it can be: thin twisted or doubly curved shells of triangles are far too stiff on coarse meshes (a strip
twisted by 90 degrees, 12 x 2, moves a twentieth of what it should), since flat triangles cannot bend there without
stretching. Their moments converge with h alone, and their shear forces in thin plates stay a tenth off.

The DOFs at each corner are UX UY UZ RX RY RZ in global axes. A place is corner 0 + xi (corner 1 - corner 0) + eta
(corner 2 - corner 0). Own axes are those of `femstruct.elements.flat_elements.frames`, rigidities and resultants
those of `femstruct.elements.quad_shell`.
"""

from __future__ import annotations

from functools import cache
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from femstruct.arrays import Floats
from femstruct.elements import flat_elements
from femstruct.elements.flat_elements import (
    Rigidities,
    congruence,
    cross,
    flatten,
    frames,
    masses,
    matrices_by_kind,
    out_of_own_axes,
    own_motion,
    section,
    side_shears,
)
from femstruct.elements.membrane import strain_energy
from femstruct.errors import InputError

# ----------------------------------------------------------------------------------------------------------------------
# Membrane strains of triangles with drilling rotations: Felippa's optimal member of the ANDES family (OPT).
#
# The strain is a mean, that of a triangle whose sides move as parabolas, and a part linear in the cell without a mean,
# assumed from the rotations of the corners beside that of the whole. Bending in its plane is exact for one aspect of
# rectangles cut in two, in any direction; no tie of RZ to the displacements is needed, and there is no parameter.
#
# Reference: C. A. Felippa, Comput. Methods Appl. Mech. Eng. 192 (2003) 2125-2168, doi:10.1016/S0045-7825(03)00253-6.
# ----------------------------------------------------------------------------------------------------------------------

N_MEMBRANE: Final = 9
SMALLEST: Final = 0.01
"""Of the factor (1 - 4 nu^2) / 2 of the linear strains: Felippa's bound, with which the stiffness keeps its rank."""
_SHARE: Final = 1.5  # of the rotations in the mean strain: alpha_b
_BETA: Final = np.array([[1.0, 2.0, 1.0], [0.0, 1.0, -1.0], [-1.0, -1.0, -2.0]])
_TURNED: Final = [2, 0, 1]


def strain_rows(corners: Floats, areas: Floats, A: Floats, at: Floats) -> Floats:
    """Rows of (u_x, v_y, u_y + v_x) at places from all u, all v, all RZ: [n, g, 3, 9].

    Parameters
    ----------
    corners : Floats [n, 3, 2]
        Counterclockwise; areas [n].
    A : Floats [3, 3] or [n, 3, 3]
        Membrane stiffness, whose Poisson's ratio sets the size of the linear part.
    at : Floats [n, g, 3]
        Shares of the corners.
    """
    shares = np.sqrt(2.25 * linear_factor(A))
    linear = np.einsum("ngc,ncij->ngij", at, _natural(corners, areas)) * np.reshape(shares, (-1, 1, 1, 1))
    into_xy = _from_natural(corners) * (2.0 * areas / 3.0)[:, None, None]
    parts = into_xy[:, None] @ linear @ _beside_the_whole(corners, areas)[:, None]
    rows: Floats = _mean(corners, areas)[:, None] + parts
    return rows


def linear_factor(A: Floats) -> Floats:
    """(1 - 4 nu^2) / 2 but at least 0.01; nu of a laminate is that of its mean over all directions.

    >>> round(float(linear_factor(np.array([[1.0, 0.3, 0.0], [0.3, 1.0, 0.0], [0.0, 0.0, 0.35]]))), 12)
    0.32
    """
    straight = 3.0 * (A[..., 0, 0] + A[..., 1, 1]) + 2.0 * A[..., 0, 1] + 4.0 * A[..., 2, 2]
    across = A[..., 0, 0] + A[..., 1, 1] + 6.0 * A[..., 0, 1] - 4.0 * A[..., 2, 2]
    factor: Floats = np.maximum((1.0 - 4.0 * (across / straight) ** 2) / 2.0, SMALLEST)
    return factor


def _around(corners: Floats) -> tuple[Floats, Floats, Floats]:
    """Vectors [n, 3, 2] of each corner i with the next j and the one before k: k - j, i - k, j - i."""
    following, before = np.roll(corners, -1, axis=1), np.roll(corners, 1, axis=1)
    return before - following, corners - before, following - corners


def _mean(corners: Floats, areas: Floats) -> Floats:
    """Rows [n, 3, 9] of the mean strain: forces of a constant stress on the sides, shared with the rotations."""
    opposite, towards, away = _around(corners)
    (x_kj, y_kj), (x_ik, y_ik), (x_ji, y_ji) = (np.moveaxis(of, -1, 0) for of in (opposite, towards, away))
    rows = np.zeros((len(corners), 3, 3, 3))
    rows[:, 0, 0] = rows[:, 2, 1] = -y_kj
    rows[:, 1, 1] = rows[:, 2, 0] = x_kj
    rows[:, 0, 2] = -y_kj * (y_ik - y_ji) * _SHARE / 6.0
    rows[:, 1, 2] = -x_kj * (x_ik - x_ji) * _SHARE / 6.0
    rows[:, 2, 2] = (x_ji * y_ji - x_ik * y_ik) * _SHARE / 3.0
    return rows.reshape(-1, 3, N_MEMBRANE) / (2.0 * areas)[:, None, None]


def _beside_the_whole(corners: Floats, areas: Floats) -> Floats:
    """Rows [n, 3, 9] of RZ at the corners less the rotation of the triangle as a whole."""
    opposite, _, _ = _around(corners)
    rows = np.zeros((len(corners), 3, 3, 3))
    rows[:, :, 0] = opposite[:, None, :, 0] / (4.0 * areas)[:, None, None]
    rows[:, :, 1] = opposite[:, None, :, 1] / (4.0 * areas)[:, None, None]
    rows[:, :, 2] = np.eye(3)
    return rows.reshape(-1, 3, N_MEMBRANE)


def _natural(corners: Floats, areas: Floats) -> Floats:
    """Strains along the sides at each corner from the rotations of `_beside_the_whole`, over 2 A / 3: [n, 3, 3, 3]."""
    squares = (_around(corners)[2] ** 2).sum(axis=-1)
    at_corners = [_BETA]
    for _ in range(2):  # the same seen from the next corner
        at_corners.append(at_corners[-1][_TURNED][:, _TURNED])
    strains: Floats = np.array(at_corners)[None] / squares[:, None, :, None]
    return strains


def _from_natural(corners: Floats) -> Floats:
    """Strains (xx, yy, 2 xy) from those along the three sides: [n, 3, 3]."""
    sides = _around(corners)[2]
    x, y = np.moveaxis(sides / np.linalg.norm(sides, axis=-1, keepdims=True), -1, 0)
    into_xy: Floats = np.linalg.inv(np.stack([x * x, y * y, x * y], axis=-1))
    return into_xy


# ----------------------------------------------------------------------------------------------------------------------
# Bending and transverse shear of triangles: the discrete Kirchhoff-Mindlin triangle (DKMT) of Katili.
#
# The lean of the fibres (beta_x = RY, beta_y = -RX) is linear but for a parabola along each side, whose size follows
# from the moment and shear balance of the side as a beam; the shear strain that belongs to it is constant along the
# side and carried linearly into the cell. Thin plates are those of Kirchhoff along the sides, thick ones those of
# Mindlin.
#
# Reference: I. Katili, Int. J. Numer. Methods Eng. 36 (1993) 1859-1883, doi:10.1002/nme.1620361106.
# ----------------------------------------------------------------------------------------------------------------------

N_BENDING: Final = 9


def bending_rows(corners: Floats, areas: Floats, D: Floats, As: Floats, at: Floats) -> tuple[Floats, Floats]:
    """Rows of the curvatures [n, g, 3, 9] and of the shear strains [n, g, 2, 9] at places, from all w, beta_x, beta_y.

    Parameters
    ----------
    corners : Floats [n, 3, 2]
        Counterclockwise; areas [n].
    D, As : Floats [3, 3] or [n, 3, 3], Floats [2, 2] or [n, 2, 2]
        Bending and shear rigidities, whose ratio says how much of a side's motion is shear.
    at : Floats [n, g, 3]
        Shares of the corners.
    """
    sides = np.roll(corners, -1, axis=1) - corners
    length = np.linalg.norm(sides, axis=2)
    c, s = np.moveaxis(sides / length[..., None], -1, 0)
    share = _shear_share(c, s, length, D, As)
    lean = side_shears(corners) * (-1.5 / (length * (1.0 + share)))[..., None]
    by_x, by_y = _gradients(corners, areas)
    curvatures = np.zeros((*at.shape[:2], 3, N_BENDING))
    curvatures[:, :, 0, 3:6] = curvatures[:, :, 2, 6:] = by_x[:, None]
    curvatures[:, :, 1, 6:] = curvatures[:, :, 2, 3:6] = by_y[:, None]
    following = np.roll(at, -1, axis=2)
    bent_x, bent_y = (4.0 * (at * np.roll(of, -1, axis=1)[:, None] + following * of[:, None]) for of in (by_x, by_y))
    c, s = c[:, None], s[:, None]
    curvatures += np.stack([bent_x * c, bent_y * s, bent_y * c + bent_x * s], axis=2) @ lean[:, None]
    return curvatures, _carried(c, s, at) @ (lean * (-share / 1.5)[..., None])[:, None]


def _shear_share(c: Floats, s: Floats, length: Floats, D: Floats, As: Floats) -> Floats:
    """12 D / (As L^2) of each side [n, 3], with the rigidities along it."""
    bent = np.stack([c * c, s * s, 2.0 * c * s], axis=2)
    sheared = np.stack([c, s], axis=2)
    ratio: Floats = ((bent @ D) * bent).sum(axis=2) / ((sheared @ As) * sheared).sum(axis=2)
    return 12.0 * ratio / length**2


def _gradients(corners: Floats, areas: Floats) -> tuple[Floats, Floats]:
    """Derivatives by x and y of the shares of the corners: [n, 3] each."""
    opposite = np.roll(corners, 1, axis=1) - np.roll(corners, -1, axis=1)
    twice = 2.0 * areas[:, None]
    return -opposite[..., 1] / twice, opposite[..., 0] / twice


def _carried(c: Floats, s: Floats, at: Floats) -> Floats:
    """Shear strain at places from that along sides, at a corner that of its two sides, then linear: [n, g, 2, 3]."""
    c_before, s_before = np.roll(c, 1, axis=2), np.roll(s, 1, axis=2)
    share = at / (c_before * s - s_before * c)
    own, before = (
        np.stack([-s_before, c_before], axis=2) * share[:, :, None],
        np.stack([s, -c], axis=2) * share[:, :, None],
    )
    result: Floats = own + np.roll(before, -1, axis=3)
    return result


# ----------------------------------------------------------------------------------------------------------------------
# Flat triangles of shells.
# ----------------------------------------------------------------------------------------------------------------------

N_DOFS: Final = 18
MIDDLES: Final = np.array([[0.5, 0.5, 0.0], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5]])
"""Points of integration, the middles of the sides with a third of the area each, as shares of the corners."""
_PLATE, _MEMBRANE = slice(0, 9), slice(9, 18)


def stiffness(
    corners: ArrayLike, A: ArrayLike, B: ArrayLike, D: ArrayLike, As: ArrayLike, share: Rigidities | None = None
) -> Floats:
    """Stiffness matrices of triangular shell elements in global axes.

    Parameters
    ----------
    corners : ArrayLike [n, 3, 3]
        Places of the nodes [m].
    A, B, D : ArrayLike [3, 3] or [n, 3, 3]
        Membrane [N/m], coupling [N] and bending [N m] rigidity.
    As : ArrayLike [2, 2] or [n, 2, 2]
        Transverse shear rigidity [N/m], its shear correction included; all in the axes of each element.
    share : Rigidities | None
        A part (A, B, D, As) of the rigidities, as of some layers, whose part of the energy is wanted.

    Returns
    -------
    Floats
        [n, 18, 18], exactly symmetric.

    Raises
    ------
    InputError
        For elements without area and for rigidities that are not symmetric or not finite.

    Notes
    -----
    The strains that OPT assumes, a mean and a part linear in the cell, give its stiffness when their energy is summed
    at the middles of the sides; B couples them there to the curvatures.

    Examples
    --------
    >>> t, A = 0.1, np.array([[1.0, 0.3, 0.0], [0.3, 1.0, 0.0], [0.0, 0.0, 0.35]])
    >>> K = stiffness([[[0, 0, 0], [1, 0, 0], [0, 1, 0]]], t * A, 0 * A, t**3 / 12 * A, 5 / 6 * t * 0.35 * np.eye(2))
    >>> K.shape, int((np.linalg.eigvalsh(K[0]) < 1e-12).sum())  # six rigid motions
    ((1, 18, 18), 6)
    """
    R, xy = _placed(corners)
    given = [*section(len(xy), A, B, D, As), *(section(len(xy), *share) if share is not None else ())]
    return matrices_by_kind(N_DOFS, _stiffness, R, xy, *given)


def mass(corners: ArrayLike, m0: ArrayLike, m1: ArrayLike, m2: ArrayLike) -> Floats:
    """Consistent mass matrices of triangular shell elements in global axes, exactly integrated.

    Parameters
    ----------
    corners : ArrayLike [n, 3, 3]
        Places of the nodes [m]; m0, m1, m2 [n] or one value : integrals of rho, rho z and rho z^2 over the thickness
        [kg/m^2, kg/m, kg].

    Returns
    -------
    Floats
        [n, 18, 18], exactly symmetric. u, v and w bow along the sides with the rotations at their ends, which are
        linear; m2 acts on RX, RY and RZ.

    Examples
    --------
    >>> M = mass([[[0, 0, 0], [2, 0, 0], [0, 1, 0]]], 10.0, 0.0, 0.0)
    >>> along_x = np.tile([1.0, 0, 0, 0, 0, 0], 3)
    >>> round(float(along_x @ M[0] @ along_x), 12)
    10.0
    """
    R, xy = _placed(corners)
    return matrices_by_kind(N_DOFS, _mass, R, xy, *masses(len(xy), m0, m1, m2))


def interpolate(corners: ArrayLike, xi: ArrayLike, eta: ArrayLike) -> Floats:
    """Rows that give UX UY UZ RX RY RZ at places of elements from their DOFs, all in global axes.

    Parameters
    ----------
    corners : ArrayLike [m, 3, 3]
        Nodes of the element of each place [m].
    xi, eta : ArrayLike [m]
        Place in it, 0 to 1, xi + eta at most 1.

    Returns
    -------
    Floats
        [m, 6, 18].

    Examples
    --------
    >>> interpolate([[[0, 0, 0], [2, 0, 0], [0, 1, 0]]], [0.0], [1.0])[0].nonzero()[1].tolist()  # corner 2
    [12, 13, 14, 15, 16, 17]
    """
    R, xy = _placed(corners)
    in_plane = np.zeros((len(xy), 3))
    own = flat_elements.rows(_values(_shares(xi, eta)), in_plane, flat_elements.side_displacements(xy))
    return out_of_own_axes(own @ own_motion(R, in_plane), R)


def resultants(
    corners: ArrayLike, xi: ArrayLike, eta: ArrayLike, A: ArrayLike, B: ArrayLike, D: ArrayLike, As: ArrayLike
) -> Floats:
    """Rows that give (Nx Ny Nxy Mx My Mxy Qx Qy) per length at places of elements from their DOFs in global axes.

    Arguments as `interpolate` and `stiffness`, the rigidities [..] or [m, ..].

    Returns [m, 8, 18], in the axes of each element: N and Q [N/m], M [N]. `rotate_resultants` of
    `femstruct.elements.flat_elements` gives them in other directions.
    """
    R, xy = _placed(corners)
    stretch, coupling, bend, shear = section(len(xy), A, B, D, As)
    areas, at = _areas(xy), _shares(xi, eta)[:, None]
    own = np.zeros((len(xy), 8, N_DOFS))
    strains = strain_rows(xy, areas, stretch, at)[:, 0]
    curvatures, shears = (rows[:, 0] for rows in bending_rows(xy, areas, bend, shear, at))
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
    strains = strain_rows(xy, areas, stretch, at)
    curvatures, shears = bending_rows(xy, areas, bend, shear, at)
    own[:, _MEMBRANE, _MEMBRANE] = strain_energy(strains, A, strains, each)
    own[:, _PLATE, _PLATE] = strain_energy(curvatures, D, curvatures, each) + strain_energy(shears, As, shears, each)
    if B.any():
        own[:, _MEMBRANE, _PLATE] = strain_energy(strains, B, curvatures, each)
        own[:, _PLATE, _MEMBRANE] = own[:, _MEMBRANE, _PLATE].swapaxes(1, 2)
    return congruence(own, own_motion(R, np.zeros((len(xy), 3))))


def _mass(R: Floats, xy: Floats, m0: Floats, m1: Floats, m2: Floats) -> Floats:
    own = flat_elements.inertia(
        _areas(xy)[:, None, None] * _value_integrals(), flat_elements.side_displacements(xy), m0, m1, m2
    )
    return congruence(own, own_motion(R, np.zeros((len(xy), 3))))


def _placed(corners: ArrayLike) -> tuple[Floats, Floats]:
    """Own axes [n, 3, 3] and corners in the plane [n, 3, 2]."""
    points = np.asarray(corners, dtype=np.float64)
    R = frames(points)
    if points.shape[1] != 3:
        raise InputError("corners", got=f"shape {points.shape}", expected="shape (n, 3, 3)")
    return R, flatten(points, R)[0]


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
