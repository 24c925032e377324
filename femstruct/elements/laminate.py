"""Rigidities of layered plates by first-order shear deformation theory, and the stresses in their layers.

Layers are counted from the lower face (negative z) upwards, z from the mid-surface. Membrane strains are (eps_x, eps_y,
gamma_xy), curvatures (beta_x,x, beta_y,y, beta_x,y + beta_y,x), transverse shear strains (gamma_xz, gamma_yz), beta the
turning of the normal towards x and y. Resultants follow them: (N, M) = [[A, B], [B, D]] (eps, kappa), V = As gamma.

The transverse shear stiffness As is that of the energy of the shear stresses which equilibrium asks for, not the
integral of shear moduli times a factor. Under V_x = M_x,x = 1 strains and curvatures change along x by the fourth
column of the inverse of [[A, B], [B, D]], under V_y along y by the fifth, and the stresses of the layers with them:

    tau(z) = -integral from the lower face to z of (sigma_x,x, tau_xy,x) or (tau_xy,y, sigma_y,y) dz
    V . As^-1 V = integral of tau . G^-1 tau dz

with both components of tau, so that As is a full [2, 2] where layers are turned. A homogeneous plate gets 5/6 G h
exactly, boards glued crosswise 1/6 to 1/3, soft cores far less. The two bendings are cylindrical, so As depends a
little on the axes they are about. Those of the lowest layer serve best: against three-dimensional waves of eight
thicknesses in seven lay-ups, E1 / E2 40, frequencies are 4.5 % low to 1.6 % high (1.7 % low for CLT in any direction);
about axes at 45 degrees to it they are up to 5.6 % high (`tests/analytic/test_laminates.py`).

References: R. Rolfes, K. Rohwer, Int. J. Numer. Methods Eng. 40 (1997) 51-60; J. N. Reddy, Mechanics of Laminated
Composite Plates and Shells, 2nd ed. (2004), chapter 3.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from femstruct.arrays import Floats, Integers
from femstruct.elements.polynomials import gauss_interval
from femstruct.errors import InputError

GAUSS_POINTS = 3
"""A layer's shear stress is a parabola in z; its square is of degree 4."""
TINY = 1e-30
"""Of a modulus: a step into the imaginary, whose derivative has no rounding."""
ROUNDING = 1e-14
"""Of A times the height of a face: what is left of B in a lay-up that is the same from above and below."""
_DERIVED = np.array(
    [[0, 2], [2, 1]]
)  # rows of (sigma_x, sigma_y, tau_xy) that act on x and y, differentiated along x, y


def plane_stress(E1: ArrayLike, E2: ArrayLike, nu12: ArrayLike, G12: ArrayLike) -> Floats:
    """Stiffness Q [n, 3, 3] in Pa of layers in plane stress, in their own axes.

    Parameters
    ----------
    E1, E2 : ArrayLike [n]
        Young's moduli [Pa].
    nu12 : ArrayLike [n]
        Contraction along 2 under stress along 1 [1].
    G12 : ArrayLike [n]
        Shear modulus [Pa].

    Raises
    ------
    InputError
        Where nu12^2 >= E1 / E2: it would store a negative energy.

    Examples
    --------
    >>> plane_stress(12.0, 3.0, 0.4, 1.0)[0].round(9).tolist()
    [[12.5, 1.25, 0.0], [1.25, 3.125, 0.0], [0.0, 0.0, 1.0]]
    """
    first, second, nu, shear = np.broadcast_arrays(*(np.atleast_1d(np.asarray(v, float)) for v in (E1, E2, nu12, G12)))
    if not (nu**2 * second < first).all():
        worst = int(np.argmax(nu**2 * second / first))
        limit = np.sqrt(first[worst] / second[worst])
        raise InputError("nu12", got=f"{nu[worst]:g}", expected=f"less than sqrt(E1 / E2) = {limit:.4g}")
    Q = np.zeros((len(nu), 3, 3))
    free = 1.0 - nu**2 * second / first
    Q[:, 0, 0], Q[:, 1, 1], Q[:, 2, 2] = first / free, second / free, shear
    Q[:, 0, 1] = Q[:, 1, 0] = nu * second / free
    return Q


def rotate_stiffness(Q: ArrayLike, angle: ArrayLike) -> Floats:
    """In-plane stiffnesses Q, A, B or D [..., 3, 3] of something whose axis 1 is turned by an angle from x.

    Parameters
    ----------
    angle : ArrayLike [...]
        From x to axis 1 about +z [rad].

    Examples
    --------
    >>> rotate_stiffness(np.diag([8.0, 2.0, 1.0]), np.pi / 2).round(9).diagonal()
    array([2., 8., 1.])
    """
    strains = strain_turn(angle)
    result: Floats = np.swapaxes(strains, -1, -2) @ _numbers(Q) @ strains
    return np.asarray((result + np.swapaxes(result, -1, -2)) / 2.0)


def strain_turn(angle: ArrayLike) -> Floats:
    """Strains (xx, yy, 2 xy) along axes turned by an angle about +z [rad], from those along x and y: [..., 3, 3].

    >>> strain_turn(np.pi / 2).round(9) @ [1.0, 2.0, 3.0]
    array([ 2.,  1., -3.])
    """
    c, s = np.cos(np.asarray(angle, float)), np.sin(np.asarray(angle, float))
    return np.stack(
        [
            np.stack([c**2, s**2, c * s], axis=-1),
            np.stack([s**2, c**2, -c * s], axis=-1),
            np.stack([-2.0 * c * s, 2.0 * c * s, c**2 - s**2], axis=-1),
        ],
        axis=-2,
    )


def rotate_shear(G: ArrayLike, angle: ArrayLike) -> Floats:
    """Transverse shear stiffnesses G or As [..., 2, 2] of something whose axis 1 is turned by an angle from x [rad].

    >>> rotate_shear(np.diag([8.0, 2.0]), np.pi / 2).round(9).diagonal()
    array([2., 8.])
    """
    strains = shear_strain_turn(angle)
    result: Floats = np.swapaxes(strains, -1, -2) @ _numbers(G) @ strains
    return np.asarray((result + np.swapaxes(result, -1, -2)) / 2.0)


def shear_strain_turn(angle: ArrayLike) -> Floats:
    """Components of vectors along axes turned by an angle about +z [rad], from those along x and y: [..., 2, 2].

    >>> shear_strain_turn(np.pi / 2).round(9) @ [1.0, 2.0]
    array([ 2., -1.])
    """
    c, s = np.cos(np.asarray(angle, float)), np.sin(np.asarray(angle, float))
    return np.stack([np.stack([c, s], axis=-1), np.stack([-s, c], axis=-1)], axis=-2)


def bounds(thickness: ArrayLike) -> Floats:
    """Heights [n + 1] of the lower face, of what lies between layers, and of the upper face above the mid-surface [m].

    >>> bounds([2.0, 1.0, 1.0])
    array([-2.,  0.,  1.,  2.])
    """
    layers = np.atleast_1d(np.asarray(thickness, float))
    if not (np.isfinite(layers).all() and (layers > 0.0).all() and len(layers)):
        raise InputError("layers", got=f"thicknesses {layers.tolist()} m", expected="one positive thickness a layer")
    return np.asarray(np.concatenate([[0.0], np.cumsum(layers)]) - layers.sum() / 2.0)


def stiffness(Q: ArrayLike, z: ArrayLike) -> tuple[Floats, Floats, Floats]:
    """Rigidities A [N/m], B [N], D [N m], each [3, 3], about z = 0.

    Parameters
    ----------
    Q : ArrayLike [n, 3, 3]
        Of the layers along the plate's axes [Pa].
    z : ArrayLike [n + 1]
        Heights of their faces [m].

    Examples
    --------
    >>> A, B, D = stiffness(np.eye(3)[None], [-1.0, 1.0])
    >>> [round(float(matrix[0, 0]), 9) for matrix in (A, B, D)]
    [2.0, 0.0, 0.666666667]
    """
    _, low, high = _faces(Q, z)
    A, B, D = (of.sum(axis=0) for of in layer_stiffness(Q, z))
    rounding = float(np.abs(A).max(initial=0.0) * np.abs(np.concatenate([low, high])).max(initial=0.0)) * ROUNDING
    return A, np.where(np.abs(B) > rounding, B, 0.0), D


def layer_stiffness(Q: ArrayLike, z: ArrayLike) -> tuple[Floats, Floats, Floats]:
    """Shares [n, 3, 3] of the layers in the rigidities A [N/m], B [N], D [N m] about z = 0; arguments as `stiffness`.

    >>> A, B, D = layer_stiffness(np.array([np.eye(3)] * 2), [-1.0, 0.0, 1.0])
    >>> [matrix[:, 0, 0].round(9).tolist() for matrix in (A, B, D)]
    [[1.0, 1.0], [-0.5, 0.5], [0.333333333, 0.333333333]]
    """
    layers, low, high = _faces(Q, z)
    middle, thick = (low + high) / 2.0, high - low
    weights = np.stack([thick, thick * middle, thick * (middle**2 + thick**2 / 12.0)])
    first, second, third = weights[:, :, None, None] * layers
    return first, second, third


def inertia(rho: ArrayLike, z: ArrayLike) -> tuple[float, float, float]:
    """Mass per area m0 [kg/m^2] and its moments m1 [kg/m], m2 [kg] about z = 0 of layers with densities [n] [kg/m^3].

    >>> inertia([2.0, 1.0], [-1.0, 0.0, 1.0])
    (3.0, -0.5, 1.0)
    """
    low, high = np.asarray(z, float)[:-1], np.asarray(z, float)[1:]
    each, middle, thick = np.asarray(rho, float), (low + high) / 2.0, high - low
    squared = middle**2 + thick**2 / 12.0
    return float((each * thick).sum()), float((each * thick * middle).sum()), float((each * thick * squared).sum())


def shear_stiffness(Q: ArrayLike, G: ArrayLike, z: ArrayLike, axis: float = 0.0) -> Floats:
    """Transverse shear stiffness As [2, 2] in N/m along the plate's axes, by the energy of the shear stresses.

    Parameters
    ----------
    Q, G : ArrayLike [n, 3, 3], ArrayLike [n, 2, 2]
        Of the layers along the plate's axes [Pa].
    z : ArrayLike [n + 1]
        Heights of their faces [m].
    axis : float
        Direction of the two bendings, the angle of the lowest layer [rad].

    Examples
    --------
    >>> one = plane_stress(12.0, 12.0, 0.0, 6.0)
    >>> shear_stiffness(one, [6.0 * np.eye(2)], [-1.0, 1.0]).round(9).diagonal()  # 5/6 G h
    array([10., 10.])
    """
    return rotate_shear(np.linalg.inv(_shear_compliances(Q, G, z, axis).sum(axis=0)), axis)


def layer_shear_stiffness(Q: ArrayLike, G: ArrayLike, z: ArrayLike, axis: float, of: Integers) -> Floats:
    """Shares [m, 2, 2] of groups of layers in As [N/m], which sum to it: how it grows with all moduli of a group.

    Parameters
    ----------
    of : Integers [n]
        The group of every layer, from 0 on; the rest as `shear_stiffness`.

    Notes
    -----
    With complex moduli this is the imaginary part of As for a loss factor of one in the group, to the first order. It
    is not the energy of the shear stresses there: where layers shear, bending goes from some to others, and with that
    the losses of waves are those of three dimensions (`tests/analytic/test_laminates.py`). Alone it may be negative, of
    skins that bend the less the more they shear; that is left out and the rest reduced to As, so that no motion of
    any wavelength is driven.

    Examples
    --------
    >>> one = plane_stress([12.0] * 2, [12.0] * 2, [0.0] * 2, [6.0] * 2)
    >>> shares = layer_shear_stiffness(one, [6.0 * np.eye(2)] * 2, [-1.0, 0.0, 1.0], 0.0, np.arange(2))
    >>> shares[:, 0, 0].round(9)  # of 5/6 G h = 10
    array([5., 5.])
    """
    root = np.linalg.cholesky(np.linalg.inv(_shear_compliances(Q, G, z, axis).sum(axis=0)))
    unit = np.linalg.inv(root)
    parts = []
    for own in of == np.arange(of.max() + 1)[:, None]:
        lossy = (1.0 + 1j * TINY * own)[:, None, None]
        growing = np.linalg.inv(_shear_compliances(Q * lossy, G * lossy, z, axis).sum(axis=0)).imag / TINY
        values, vectors = np.linalg.eigh(unit @ ((growing + growing.T) / 2.0) @ unit.T)
        parts.append(vectors * values.clip(0.0) @ vectors.T)
    values, vectors = np.linalg.eigh(np.sum(parts, axis=0))
    reduced = root @ (vectors / np.sqrt(values)) @ vectors.T
    return rotate_shear(reduced @ np.stack(parts) @ reduced.T, axis)


def shear_shares(Q: ArrayLike, G: ArrayLike, z: ArrayLike, axis: float = 0.0) -> Floats:
    """Share [n] of every layer in the energy of transverse shear, the mean over both directions; they sum to 1.

    Arguments as `shear_stiffness`.

    >>> skin, core = np.eye(3), 1e-9 * np.eye(3)
    >>> soft = [np.eye(2), 1e-3 * np.eye(2), np.eye(2)]
    >>> shear_shares([skin, core, skin], soft, [-1.1, -1.0, 1.0, 1.1]).round(3)
    array([0., 1., 0.])
    """
    each = _shear_compliances(Q, G, z, axis)
    return np.asarray(np.trace(np.linalg.solve(each.sum(axis=0), each), axis1=1, axis2=2) / 2.0)


def layer_stresses(Q: ArrayLike, z: ArrayLike, N: ArrayLike, M: ArrayLike) -> Floats:
    """Stresses (sigma_x, sigma_y, tau_xy) [m, n, 2, 3] in Pa at the lower and upper face of every layer.

    Parameters
    ----------
    Q : ArrayLike [n, 3, 3]
        Of the layers along the plate's axes [Pa].
    z : ArrayLike [n + 1]
        Heights of their faces [m].
    N, M : ArrayLike [m, 3]
        Membrane forces [N/m] and moments [N] per length at m places.

    Examples
    --------
    >>> layer_stresses(np.eye(3)[None], [-1.0, 1.0], [[0.0, 0.0, 0.0]], [[2.0, 0.0, 0.0]])[0, 0, :, 0].round(9)
    array([-3.,  3.])
    """
    layers, low, high = _faces(Q, z)
    resultants = np.concatenate([np.atleast_2d(np.asarray(N, float)), np.atleast_2d(np.asarray(M, float))], axis=1)
    strains = resultants @ _flexibility(layers, low, high).T
    faces = np.stack([low, high], axis=1)
    there = strains[:, None, None, :3] + faces[None, :, :, None] * strains[:, None, None, 3:]
    return np.asarray(np.einsum("nij,mnfj->mnfi", layers, there))


def shear_stresses(Q: ArrayLike, z: ArrayLike, V: ArrayLike, share: ArrayLike) -> Floats:
    """Transverse shear stresses (tau_xz, tau_yz) [m, n, k, 2] in Pa that equilibrium asks for.

    Q, z as `layer_stresses`.

    Parameters
    ----------
    V : ArrayLike [m, 2]
        Shear forces per length [N/m].
    share : ArrayLike [k]
        Heights in every layer, 0 for its lower face to 1 for its upper one.

    Examples
    --------
    >>> shear_stresses(np.eye(3)[None], [-1.0, 1.0], [[4.0, 0.0]], [0.0, 0.5, 1.0])[0, 0, :, 0].round(9) + 0.0
    array([0., 3., 0.])
    """
    layers, low, high = _faces(Q, z)
    at = low[:, None] + (high - low)[:, None] * np.atleast_1d(np.asarray(share, float))
    forces = np.atleast_2d(np.asarray(V, float))
    return np.asarray(np.einsum("nksi,mi->mnks", _shear_of_forces(layers, low, high, at), forces))


def free_to_stretch(A: ArrayLike, B: ArrayLike, D: ArrayLike) -> Floats:
    """Bending rigidity D - B A^-1 B [3, 3] in N m of a plate that no membrane force holds: about its neutral surface.

    >>> free_to_stretch(2.0 * np.eye(3), np.eye(3), np.eye(3)).diagonal()
    array([0.5, 0.5, 0.5])
    """
    coupling = np.asarray(B, float)
    left: Floats = np.asarray(D, float) - coupling @ np.linalg.solve(np.asarray(A, float), coupling)
    return (left + left.T) / 2.0


def with_slip(Q: ArrayLike, z: ArrayLike, bond: float) -> tuple[Floats, Floats, Floats]:
    """Rigidities B [N], D [N m], each [3, 3], of layers that slip on each other, and the share [n] of every layer in
    the energy of bending; each layer bends about its own middle.

    Parameters
    ----------
    bond : float
        Share of the way to layers without slip [1].

    Examples
    --------
    >>> _, D, _ = with_slip(np.array([12.0 * np.eye(3)] * 2), [-1.0, 0.0, 1.0], 0.0)
    >>> float(D[0, 0]), float(with_slip(np.array([12.0 * np.eye(3)] * 2), [-1.0, 0.0, 1.0], 1.0)[1][0, 0])  # 2 D, 8 D
    (2.0, 8.0)
    """
    layers, _, _ = _faces(Q, z)
    alone = bending_alone(layers, z)
    A, B, D = stiffness(layers, z)
    mixed: Floats = bond * D + (1.0 - bond) * alone.sum(axis=0)
    free = free_to_stretch(A, bond * B, mixed)
    loose = (1.0 - bond) * np.trace(np.linalg.solve(free, alone), axis1=1, axis2=2) / 3.0
    return bond * B, mixed, np.asarray(loose + (1.0 - loose.sum()) * bending_shares(layers, z))


def bending_alone(Q: ArrayLike, z: ArrayLike) -> Floats:
    """Bending rigidities [n, 3, 3] of the layers, each about its own middle [N m]; arguments as `stiffness`."""
    layers, low, high = _faces(Q, z)
    return np.asarray(layers * ((high - low) ** 3 / 12.0)[:, None, None])


def bending_shares(Q: ArrayLike, z: ArrayLike) -> Floats:
    """Share [n] of every layer in the energy of bending, of a plate that nothing holds in its plane; they sum to 1.

    The mean over all curvatures, tr(D*^-1 D_k) / 3 with D_k of a layer and D* of all about the neutral surface. It is
    the same in any axes, and exact where the rigidities of the layers differ by a factor.

    >>> bending_shares(np.array([np.eye(3)] * 3), [-1.5, -0.5, 0.5, 1.5]).round(9)  # 13, 1 and 13 of 27
    array([0.48148148, 0.03703704, 0.48148148])
    """
    layers, low, high = _faces(Q, z)
    A, B, D = stiffness(layers, z)
    stretch = -np.linalg.solve(A, B)
    middle, thick = ((low + high) / 2.0)[:, None, None], (high - low)[:, None, None]
    first, second = layers * thick * middle, layers * thick * (middle**2 + thick**2 / 12.0)
    each = stretch.T @ (layers * thick) @ stretch + stretch.T @ first + first @ stretch + second
    return np.asarray(np.trace(np.linalg.solve(free_to_stretch(A, B, D), each), axis1=1, axis2=2) / 3.0)


def _numbers(matrices: ArrayLike) -> Floats:
    """As float64; complex ones, of layers that lose, as they are."""
    given = np.asarray(matrices)
    return given if np.iscomplexobj(given) else np.asarray(given, float)


def _faces(Q: ArrayLike, z: ArrayLike) -> tuple[Floats, Floats, Floats]:
    layers, heights = _numbers(Q), np.asarray(z, float)
    if layers.shape != (len(heights) - 1, 3, 3):
        raise InputError("layers", got=f"Q of shape {layers.shape}", expected=f"shape {(len(heights) - 1, 3, 3)}")
    return layers, heights[:-1], heights[1:]


def _flexibility(layers: Floats, low: Floats, high: Floats) -> Floats:
    """Strains and curvatures of membrane forces and moments [6, 6]; lengths in units of the thickness inside, since
    A and D differ by its square."""
    h = float(high[-1] - low[0])
    A, B, D = (of.sum(axis=0) for of in layer_stiffness(layers, np.append(low, high[-1]) / h))
    unit = np.linalg.inv(np.block([[A, B], [B, D]]))
    scale = np.repeat([1.0, 1.0 / h], 3)
    result: Floats = unit * np.outer(scale, scale) / h
    return result


def _shear_of_forces(layers: Floats, low: Floats, high: Floats, at: Floats) -> Floats:
    """Shear stresses [n, k, 2, 2] at heights [n, k] of layers: component (xz, yz) of unit shear forces (V_x, V_y)."""
    flexible = _flexibility(layers, low, high)
    columns = flexible[:, 3:5]
    constant = np.einsum(
        "nij,jf->nif", layers, columns[:3]
    )  # change of the stresses along x under V_x, along y under V_y
    linear = np.einsum("nij,jf->nif", layers, columns[3:])
    constant, linear = (np.stack([part[:, _DERIVED[:, f], f] for f in (0, 1)], axis=-1) for part in (constant, linear))
    whole = constant * (high - low)[:, None, None] + linear * ((high**2 - low**2) / 2.0)[:, None, None]
    below = np.cumsum(whole, axis=0) - whole
    within = (
        constant[:, None] * (at - low[:, None])[..., None, None]
        + linear[:, None] * ((at**2 - low[:, None] ** 2) / 2.0)[..., None, None]
    )
    result: Floats = -(below[:, None] + within)
    return result


def _shear_compliances(Q: ArrayLike, G: ArrayLike, z: ArrayLike, axis: float) -> Floats:
    """Compliances [n, 2, 2] of the layers under unit shear forces, along `axis` and across."""
    layers, low, high = _faces(rotate_stiffness(Q, -axis), z)
    places, weights = gauss_interval(GAUSS_POINTS)
    at = low[:, None] + (high - low)[:, None] * places
    stresses = _shear_of_forces(layers, low, high, at)
    soft = np.linalg.inv(rotate_shear(G, -axis))
    return np.asarray(np.einsum("ngsi,nst,ngtj,g,n->nij", stresses, soft, stresses, weights, high - low))
