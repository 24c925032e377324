"""Straight frame elements in space: Euler-Bernoulli or Timoshenko bending, St-Venant torsion.

The DOFs are UX UY UZ RX RY RZ at end i, then at end j, then in the middle for the kind that has a node there; local x
runs from i to j. Bending in the x-y plane has EIz and RZ = +dv/dx, bending in the x-z plane EIy and RY = -dw/dx.

"euler" and "timoshenko" have two nodes and one set of polynomials: with the shear parameter
phi = 12 E I / (k G A L^2), the shape functions are exact for a Timoshenko beam loaded at its ends, and phi = 0 gives
the cubic Hermite polynomials of the Euler beam. Frequencies of bending converge with h^4 for "euler"; for
"timoshenko" with h^2 where shear and rotary inertia matter, since its shear strain is constant in an element; those of
stretch and torsion with h^2 for both. "timoshenko18" has three nodes (`femstruct.elements.linked`): all with h^4.

The section is symmetric about local y and z with its shear centre at the centroid; torsion is St-Venant's with free
warping, J the torsion constant (the polar moment for circles only).

References: J. S. Przemieniecki, Theory of Matrix Structural Analysis (McGraw-Hill 1968), sections 5.6 and 11.
Z. Friedman, J. B. Kosmatka, Computers & Structures 47 (1993) 473-481, doi:10.1016/0045-7949(93)90243-7.
"""

from __future__ import annotations

from functools import cache
from typing import Final, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from femstruct.arrays import Floats
from femstruct.elements import linked
from femstruct.elements.members import block, densities, outer, property_arrays
from femstruct.elements.polynomials import HERMITE_SLOPE, HERMITE_VALUE, LINEAR, derivative, integral, powers
from femstruct.errors import InputError

FrameElement = Literal["euler", "timoshenko", "timoshenko18"]
KINDS: Final = get_args(FrameElement)
N_DOFS: Final = 12  # of the kinds with two nodes

_AXIAL: Final = [0, 6]
_TORSION: Final = [3, 9]
_BENDING_Y: Final = [1, 5, 7, 11]  # v and RZ
_BENDING_Z: Final = [2, 4, 8, 10]  # w and RY = -dw/dx


def nodes_per_bar(kind: str) -> int:
    """Number of nodes of a bar: two, or three with one in the middle; InputError for an unknown kind.

    >>> nodes_per_bar("euler"), nodes_per_bar("timoshenko18")
    (2, 3)
    """
    if kind not in KINDS:
        raise InputError("element", got=repr(kind), expected=" or ".join(KINDS))
    return 3 if kind == "timoshenko18" else 2


def stiffness(
    kind: str,
    length: ArrayLike,
    E: ArrayLike,
    G: ArrayLike,
    A: ArrayLike,
    Iy: ArrayLike,
    Iz: ArrayLike,
    J: ArrayLike,
    ky: ArrayLike,
    kz: ArrayLike,
) -> Floats:
    """Stiffness matrices of frame elements in local axes.

    Parameters
    ----------
    kind : str
        "euler", "timoshenko" or "timoshenko18"; each of the others [n] or one value: length [m]; E, G moduli [Pa]; A
        area [m^2]; Iy, Iz second moments about local y and z [m^4]; J torsion constant [m^4]; ky, kz shear
        coefficients, the shear areas along y and z being ky A and kz A (not used by "euler").

    Returns
    -------
    Floats
        [n, 12, 12] or [n, 18, 18], exactly symmetric, exact for loads at the nodes.

    Raises
    ------
    InputError
        For an unknown kind or a value that is not positive.

    Examples
    --------
    >>> K = stiffness("euler", 2.0, 200e9, 77e9, 1e-4, 1e-9, 1e-9, 2e-9, 1.0, 1.0)
    >>> round(float(K[0, 0, 0] / 200e9 / 1e-4), 12)
    0.5
    """
    if nodes_per_bar(kind) == 3:
        return linked.stiffness(*property_arrays(length=length, E=E, G=G, A=A, Iy=Iy, Iz=Iz, J=J, ky=ky, kz=kz))
    length, E, G, A, Iy, Iz, J = property_arrays(length=length, E=E, G=G, A=A, Iy=Iy, Iz=Iz, J=J)
    phi_y, phi_z = shear_parameters(kind, length, E=E, G=G, A=A, Iy=Iy, Iz=Iz, ky=ky, kz=kz)
    matrices = np.zeros((len(length), N_DOFS, N_DOFS))
    rod = np.array([[1.0, -1.0], [-1.0, 1.0]])
    matrices[block(_AXIAL)] = (E * A / length)[:, None, None] * rod
    matrices[block(_TORSION)] = (G * J / length)[:, None, None] * rod
    bend, shear = _energy_integrals()
    for dofs, sign, inertia, phi in ((_BENDING_Y, 1.0, Iz, phi_y), (_BENDING_Z, -1.0, Iy, phi_z)):
        # The shear strain is phi times a constant, so its energy 12 EI / (phi L^3) gamma^2 has no division by phi.
        terms = np.stack([np.ones_like(phi), phi, phi**2], axis=1) @ bend.reshape(3, -1)
        terms += 12.0 * phi[:, None] * shear.reshape(1, -1)
        terms *= (E * inertia / length**3 / (1.0 + phi) ** 2)[:, None]
        matrices[block(dofs)] = terms.reshape(-1, 4, 4) * outer(_dof_scale(length, sign))
    return matrices


def mass(
    kind: str,
    length: ArrayLike,
    rho: ArrayLike,
    A: ArrayLike,
    Iy: ArrayLike,
    Iz: ArrayLike,
    ky: ArrayLike,
    kz: ArrayLike,
    E: ArrayLike,
    G: ArrayLike,
) -> Floats:
    """Consistent mass matrices of frame elements in local axes.

    Arguments as `stiffness`, with rho the density [kg/m^3], zero allowed.

    Returns [n, 12, 12] or [n, 18, 18], exactly symmetric.

    Notes
    -----
    Translation, and torsion with rho (Iy + Iz), whatever J is. The Timoshenko kinds add the rotary inertia rho I of
    bending and use the shape functions their stiffness has; "euler" leaves rotary inertia in bending out, so a rigid
    rotation of an Euler element about local y or z has the inertia of a line of mass.

    >>> M = mass("euler", 2.0, 1000.0, 1e-2, 1e-5, 1e-5, 1.0, 1.0, 1e9, 4e8)
    >>> round(float(M[0, [0, 6]][:, [0, 6]].sum()), 12)
    20.0
    """
    length, A, Iy, Iz, E, G = property_arrays(length=length, A=A, Iy=Iy, Iz=Iz, E=E, G=G)
    density = densities(rho, length)
    if nodes_per_bar(kind) == 3:
        return linked.mass(length, density, A, Iy, Iz)
    phi_y, phi_z = shear_parameters(kind, length, E=E, G=G, A=A, Iy=Iy, Iz=Iz, ky=ky, kz=kz)
    matrices = np.zeros((len(length), N_DOFS, N_DOFS))
    rod = integral(LINEAR, LINEAR)
    matrices[block(_AXIAL)] = (density * A * length)[:, None, None] * rod
    matrices[block(_TORSION)] = (density * (Iy + Iz) * length)[:, None, None] * rod
    translation, rotation = _inertia_integrals()
    for dofs, sign, inertia, phi in ((_BENDING_Y, 1.0, Iz, phi_y), (_BENDING_Z, -1.0, Iy, phi_z)):
        in_phi = np.stack([np.ones_like(phi), phi, phi**2], axis=1) / (1.0 + phi[:, None]) ** 2
        terms = (density * A * length)[:, None] * (in_phi @ translation.reshape(3, -1))
        if kind == "timoshenko":
            terms += (density * inertia / length)[:, None] * (in_phi @ rotation.reshape(3, -1))
        matrices[block(dofs)] = terms.reshape(-1, 4, 4) * outer(_dof_scale(length, sign))
    return matrices


def interpolate(
    kind: str,
    length: ArrayLike,
    xi: ArrayLike,
    E: ArrayLike,
    G: ArrayLike,
    A: ArrayLike,
    Iy: ArrayLike,
    Iz: ArrayLike,
    ky: ArrayLike,
    kz: ArrayLike,
) -> Floats:
    """Rows that give UX UY UZ RX RY RZ (local axes) along elements from their local DOFs.

    Parameters
    ----------
    xi : ArrayLike [m]
        Place from 0 at end i to 1 at end j; the others as `stiffness`, [m] or one value.

    Returns
    -------
    Floats
        [m, 6, 12] or [m, 6, 18]: displacement of the axis and rotation of the cross-section, which for the Timoshenko
        kinds is not the slope of the axis.

    Examples
    --------
    >>> rows = interpolate("euler", 2.0, [0.5], 1e9, 4e8, 1e-2, 1e-5, 1e-5, 1.0, 1.0)
    >>> rows[0, 1, [1, 5, 7, 11]]
    array([ 0.5 ,  0.25,  0.5 , -0.25])
    """
    place, length, E, G, A, Iy, Iz = np.broadcast_arrays(
        np.atleast_1d(np.asarray(xi, dtype=np.float64)), *property_arrays(length=length, E=E, G=G, A=A, Iy=Iy, Iz=Iz)
    )
    if nodes_per_bar(kind) == 3:
        return linked.interpolate(length, place)
    phi_y, phi_z = shear_parameters(kind, length, E=E, G=G, A=A, Iy=Iy, Iz=Iz, ky=ky, kz=kz)
    rows = np.zeros((len(place), 6, N_DOFS))
    s = powers(place)
    linear = s @ LINEAR.T
    rows[:, 0, _AXIAL] = rows[:, 3, _TORSION] = linear
    for dofs, sign, move, turn, phi in ((_BENDING_Y, 1.0, 1, 5, phi_y), (_BENDING_Z, -1.0, 2, 4, phi_z)):
        share = (1.0 / (1.0 + phi))[:, None]
        hermite, sheared, slope, section = (s @ family.T for family in _families())
        scale = _dof_scale(length, sign)
        rows[:, move, dofs] = share * (hermite + phi[:, None] * sheared) * scale
        rows[:, turn, dofs] = share * (slope + phi[:, None] * section) * scale * (sign / length)[:, None]
    return rows


def resultants(
    kind: str,
    length: ArrayLike,
    xi: ArrayLike,
    E: ArrayLike,
    G: ArrayLike,
    A: ArrayLike,
    Iy: ArrayLike,
    Iz: ArrayLike,
    J: ArrayLike,
    ky: ArrayLike,
    kz: ArrayLike,
) -> Floats:
    """Rows that give the section forces N Vy Vz [N] and moments T My Mz [N m] along elements from their local DOFs.

    Parameters
    ----------
    xi : ArrayLike [m]
        Place from 0 at end i to 1 at end j; the others as `stiffness`, [m] or one value.

    Returns
    -------
    Floats
        [m, 6, 12] or [m, 6, 18]: what acts on the part of the bar before the place, along the local axes: tension is
        positive, My = E Iy dRY/dx stretches the side of positive z, Mz = E Iz dRZ/dx that of negative y.

    Notes
    -----
    From the strains, with the moduli of the stiffness. Loads at the ends give the exact forces all along; with inertia
    along the bar moments converge with h^2, forces of two-node bars are constant in an element.

    Examples
    --------
    >>> rows = resultants("euler", 2.0, [0.0], 3.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0)
    >>> tip = np.zeros(12); tip[7] = 1.0  # a cantilever's end moved by 1 and held from turning: 12 EI / L^3
    >>> (rows[0] @ tip)[[1, 5]]
    array([4.5, 4.5])
    """
    place, length, E, G, A, Iy, Iz, J = np.broadcast_arrays(
        np.atleast_1d(np.asarray(xi, dtype=np.float64)),
        *property_arrays(length=length, E=E, G=G, A=A, Iy=Iy, Iz=Iz, J=J),
    )
    if nodes_per_bar(kind) == 3:
        ky, kz = (np.broadcast_to(np.asarray(k, dtype=np.float64), place.shape) for k in (ky, kz))
        return linked.resultants(length, place, E=E, G=G, A=A, Iy=Iy, Iz=Iz, J=J, ky=ky, kz=kz)
    phi_y, phi_z = shear_parameters(kind, length, E=E, G=G, A=A, Iy=Iy, Iz=Iz, ky=ky, kz=kz)
    rows = np.zeros((len(place), 6, N_DOFS))
    rod = np.array([-1.0, 1.0])
    rows[:, 0, _AXIAL] = (E * A / length)[:, None] * rod
    rows[:, 3, _TORSION] = (G * J / length)[:, None] * rod
    s = powers(place)
    _, _, slope, section = _families()
    for dofs, sign, force, moment, inertia, phi in (
        (_BENDING_Y, 1.0, 1, 5, Iz, phi_y),
        (_BENDING_Z, -1.0, 2, 4, Iy, phi_z),
    ):
        scale = _dof_scale(length, sign) * (E * inertia / length**2 / (1.0 + phi))[:, None]
        bent = s @ derivative(slope).T + phi[:, None] * (s @ derivative(section).T)
        steeper = s @ derivative(derivative(slope)).T + phi[:, None] * (s @ derivative(derivative(section)).T)
        rows[:, moment, dofs] = sign * bent * scale
        rows[:, force, dofs] = -steeper * scale / length[:, None]
    return rows


def shear_parameters(
    kind: str,
    length: ArrayLike,
    E: ArrayLike,
    G: ArrayLike,
    A: ArrayLike,
    Iy: ArrayLike,
    Iz: ArrayLike,
    ky: ArrayLike,
    kz: ArrayLike,
) -> tuple[Floats, Floats]:
    """Shear parameters phi = 12 E I / (k G A L^2) of bending in x-y and in x-z; zeros for "euler".

    >>> shear_parameters("timoshenko", 1.0, 2.0, 1.0, 1.0, 0.5, 0.25, 1.0, 1.0)
    (array([6.]), array([12.]))
    """
    length, E, G, A, Iy, Iz, ky, kz = property_arrays(length=length, E=E, G=G, A=A, Iy=Iy, Iz=Iz, ky=ky, kz=kz)
    if kind == "euler":
        return np.zeros_like(length), np.zeros_like(length)
    per_inertia = 12.0 * E / (G * A * length**2)
    return per_inertia * Iz / ky, per_inertia * Iy / kz


def _dof_scale(length: Floats, sign: float) -> Floats:
    """[n, 4]: unit-interval DOFs are v and dv/ds = L theta; in the x-z plane theta = -RY."""
    one = np.ones_like(length)
    return np.stack([one, sign * length, one, sign * length], axis=1)


def _family(value: Floats, slope: Floats) -> Floats:
    return np.stack([value[0], slope[0], value[1], slope[1]])


@cache
def _families() -> tuple[Floats, Floats, Floats, Floats]:
    """Deflection v = (A + phi B) / (1 + phi) and L times rotation (C + phi D) / (1 + phi): A, B, C, D [4, 4]."""
    half = np.array([0.0, 0.5, -0.5, 0.0])
    hermite = _family(HERMITE_VALUE, HERMITE_SLOPE)
    sheared = _family(LINEAR, np.stack([half, -half]))
    section = _family(np.zeros_like(LINEAR), LINEAR)
    return hermite, sheared, derivative(hermite), section


def _in_phi(first: Floats, second: Floats) -> Floats:
    """[3, 4, 4]: coefficients of 1, phi, phi^2 in the integral of (first + phi second)(first + phi second)^T."""
    mixed = integral(first, second)
    return np.stack([integral(first, first), mixed + mixed.T, integral(second, second)])


@cache
def _energy_integrals() -> tuple[Floats, Floats]:
    """Bending [3, 4, 4] and shear [4, 4]; the slope of A is C, so the shear strain is phi (B' - D) / (1 + phi)."""
    _, sheared, slope, section = _families()
    strain = derivative(sheared) - section
    return _in_phi(derivative(slope), derivative(section)), integral(strain, strain)


@cache
def _inertia_integrals() -> tuple[Floats, Floats]:
    """Translation and rotation, each [3, 4, 4]."""
    hermite, sheared, slope, section = _families()
    return _in_phi(hermite, sheared), _in_phi(slope, section)
