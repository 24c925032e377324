"""The Timoshenko bar of three nodes: quadratic rotation, cubic deflection linked to it, linear shear strain.

The rotation of the cross-section is the parabola through its values at both ends and in the middle. The deflection is
the parabola through its own three values, plus the one cubic that makes the shear strain a straight line:

    w = L0 w0 + L1 w1 + Lm wm + (L / 3) s (1 - s) (1 - 2 s) (theta0 + theta1 - 2 thetam)

Curvature and shear strain are then both linear and independent of each other, so that their energies have errors of
h^4 and frequencies converge with h^4, as those of the Euler bar do. With no shear strain it is that bar's cubic: a
slender one does not lock. Stretch and torsion are parabolas, too, which makes axial and torsional frequencies
converge with h^4; those of the bars of two nodes converge with h^2.

References: A. Tessler, S. B. Dong, Computers & Structures 14 (1981) 335-344. G. Jelenic, E. Papa, Archive of Applied
Mechanics 81 (2011) 171-183, doi:10.1007/s00419-009-0403-1 (linked interpolation of any order).
"""

from __future__ import annotations

from functools import cache
from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.elements.members import block, outer
from femstruct.elements.polynomials import QUADRATIC, derivative, integral, powers

N_DOFS: Final = 18
_AXIAL: Final = [0, 6, 12]
_TORSION: Final = [3, 9, 15]
_BENDING_Y: Final = [1, 5, 7, 11, 13, 17]  # v and RZ at end i, at end j, in the middle
_BENDING_Z: Final = [2, 4, 8, 10, 14, 16]  # w and RY = -dw/dx


def stiffness(
    length: Floats,
    E: Floats,
    G: Floats,
    A: Floats,
    Iy: Floats,
    Iz: Floats,
    J: Floats,
    ky: Floats,
    kz: Floats,
) -> Floats:
    """Stiffness matrices [n, 18, 18] in local axes; arguments [n] as those of `femstruct.elements.frame.stiffness`."""
    matrices = np.zeros((len(length), N_DOFS, N_DOFS))
    slope = derivative(QUADRATIC)
    rod = integral(slope, slope)
    matrices[block(_AXIAL)] = (E * A / length)[:, None, None] * rod
    matrices[block(_TORSION)] = (G * J / length)[:, None, None] * rod
    bend, shear, _, _ = _integrals()
    for dofs, sign, inertia, k in ((_BENDING_Y, 1.0, Iz, ky), (_BENDING_Z, -1.0, Iy, kz)):
        terms = (E * inertia / length**3)[:, None, None] * bend + (k * G * A / length)[:, None, None] * shear
        matrices[block(dofs)] = terms * outer(_dof_scale(length, sign))
    return matrices


def mass(length: Floats, density: Floats, A: Floats, Iy: Floats, Iz: Floats) -> Floats:
    """Consistent mass matrices [n, 18, 18] in local axes, with the rotary inertia of bending."""
    matrices = np.zeros((len(length), N_DOFS, N_DOFS))
    rod = integral(QUADRATIC, QUADRATIC)
    matrices[block(_AXIAL)] = (density * A * length)[:, None, None] * rod
    matrices[block(_TORSION)] = (density * (Iy + Iz) * length)[:, None, None] * rod
    _, _, translation, rotation = _integrals()
    for dofs, sign, inertia in ((_BENDING_Y, 1.0, Iz), (_BENDING_Z, -1.0, Iy)):
        terms = (density * A * length)[:, None, None] * translation
        terms += (density * inertia / length)[:, None, None] * rotation
        matrices[block(dofs)] = terms * outer(_dof_scale(length, sign))
    return matrices


def interpolate(length: Floats, place: Floats) -> Floats:
    """Rows [m, 6, 18] of displacements and rotations at places from 0 to 1 of bars of these lengths [m]."""
    rows = np.zeros((len(place), 6, N_DOFS))
    s = powers(place)
    rows[:, 0, _AXIAL] = rows[:, 3, _TORSION] = s @ QUADRATIC.T
    deflection, turned = (s @ family.T for family in _families())
    for dofs, sign, move, turn in ((_BENDING_Y, 1.0, 1, 5), (_BENDING_Z, -1.0, 2, 4)):
        scale = _dof_scale(length, sign)
        rows[:, move, dofs] = deflection * scale
        rows[:, turn, dofs] = turned * scale * (sign / length)[:, None]
    return rows


def resultants(
    length: Floats,
    place: Floats,
    E: Floats,
    G: Floats,
    A: Floats,
    Iy: Floats,
    Iz: Floats,
    J: Floats,
    ky: Floats,
    kz: Floats,
) -> Floats:
    """Rows [m, 6, 18] of N Vy Vz T My Mz, as `femstruct.elements.frame.resultants`; shear from the shear strain."""
    rows = np.zeros((len(place), 6, N_DOFS))
    s = powers(place)
    rod = s @ derivative(QUADRATIC).T
    rows[:, 0, _AXIAL] = (E * A / length)[:, None] * rod
    rows[:, 3, _TORSION] = (G * J / length)[:, None] * rod
    deflection, turned = _families()
    strain, curvature = (s @ family.T for family in (derivative(deflection) - turned, derivative(turned)))
    for dofs, sign, force, moment, inertia, k in (
        (_BENDING_Y, 1.0, 1, 5, Iz, ky),
        (_BENDING_Z, -1.0, 2, 4, Iy, kz),
    ):
        scale = _dof_scale(length, sign)
        rows[:, moment, dofs] = sign * curvature * scale * (E * inertia / length**2)[:, None]
        rows[:, force, dofs] = strain * scale * (k * G * A / length)[:, None]
    return rows


def _dof_scale(length: Floats, sign: float) -> Floats:
    """[n, 6]: the unit interval's DOFs are w and L theta / 3, which leaves whole coefficients; theta = -RY in x-z."""
    one, turn = np.ones_like(length), sign * length / 3.0
    return np.stack([one, turn, one, turn, one, turn], axis=1)


@cache
def _families() -> tuple[Floats, Floats]:
    """Deflection and L times rotation [6, 4] of w0, L theta0 / 3, w1, L theta1 / 3, wm, L thetam / 3."""
    none = np.zeros(4)
    link = np.array([0.0, 1.0, -3.0, 2.0])  # s (1 - s) (1 - 2 s)
    first, last, middle = QUADRATIC
    deflection = np.stack([first, link, last, link, middle, -2.0 * link])
    return deflection, 3.0 * np.stack([none, first, none, last, none, middle])


@cache
def _integrals() -> tuple[Floats, Floats, Floats, Floats]:
    """Bending, shear, translation and rotation [6, 6] on the unit interval."""
    deflection, turned = _families()
    strain = derivative(deflection) - turned
    curvature = derivative(turned)
    return (
        integral(curvature, curvature),
        integral(strain, strain),
        integral(deflection, deflection),
        integral(turned, turned),
    )
