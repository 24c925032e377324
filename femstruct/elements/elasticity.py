"""Hooke's law of isotropic and orthotropic solids, in the order xx yy zz xy yz zx of `femstruct.elements.solid`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from femstruct.arrays import Floats
from femstruct.elements.polynomials import positive
from femstruct.errors import InputError


def isotropic(E: float, nu: float) -> Floats:
    """Stresses [6, 6] in Pa of unit strains of an isotropic solid; shear strains twice the tensor's.

    E : Young's modulus [Pa]; nu : Poisson's ratio, between -1 and 0.5. Raises InputError for others.

    >>> isotropic(2.0, 0.0).diagonal()
    array([2., 2., 2., 1., 1., 1.])
    """
    positive("E", E)
    if not -1.0 < nu < 0.5:
        raise InputError("nu", got=str(nu), expected="a value between -1 and 0.5")
    shear = E / (2.0 * (1.0 + nu))
    lame = E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))
    C = np.diag([shear] * 6)
    C[:3, :3] = lame + 2.0 * shear * np.eye(3)
    return C


def compliance(E: Sequence[float], G: Sequence[float], nu: Sequence[float]) -> Floats:
    """Strains [6, 6] in 1/Pa of unit stresses, shear strains twice the tensor's.

    E : (Ex, Ey, Ez) [Pa]. G : (Gxy, Gyz, Gzx) [Pa]. nu : (nuxy, nuyz, nuzx) [1], nuij being the contraction along j
    under stress along i; nuij / Ei = nuji / Ej.

    >>> compliance((2.0, 1.0, 1.0), (1.0, 1.0, 4.0), (0.5, 0.0, 0.0))[:2, :2].tolist()
    [[0.5, -0.25], [-0.25, 1.0]]
    """
    S = np.diag(1.0 / np.array([*E, *G], dtype=np.float64))
    for i, (j, value) in enumerate(zip((1, 2, 0), nu, strict=True)):
        S[i, j] = S[j, i] = -value / E[i]
    return S


def stiffness(E: Sequence[float], G: Sequence[float], nu: Sequence[float]) -> Floats:
    """Stresses [6, 6] in Pa of unit strains; arguments as `compliance`.

    Raises InputError, with the numbers, for constants with which a solid could give energy without having got any.

    >>> stiffness((1.0,) * 3, (0.5,) * 3, (0.0,) * 3).diagonal()
    array([1. , 1. , 1. , 0.5, 0.5, 0.5])
    """
    pairs = (("xy", 0, 1), ("yz", 1, 2), ("zx", 2, 0))
    for (pair, i, j), value in zip(pairs, nu, strict=True):
        limit = float(np.sqrt(E[i] / E[j]))
        if not abs(value) < limit:
            first, second = pair[0], pair[1]
            other = value * E[i] / E[j] if abs(value) < 1.0 else 0.0
            hint = f"; if {value:g} is nu{second}{first}, write {other:.4g}" if 0.0 < other < limit else ""
            raise InputError(
                "nu",
                got=f"nu{pair} = {value:g} with E{first} = {E[i]:g} Pa and E{second} = {E[j]:g} Pa",
                expected=f"less than sqrt(E{first} / E{second}) = {limit:.4g}",
                do=f"nu{pair} is the contraction along {second} under stress along {first}{hint}",
            )
    S = compliance(E, G, nu)
    left = float(np.linalg.det(S[:3, :3]) * np.prod(E))
    if not left > 0.0:
        raise InputError(
            "nu",
            got=f"1 - nuxy nuyx - nuyz nuzy - nuzx nuxz - 2 nuxy nuyz nuzx = {left:.4g} with "
            f"nuxy, nuyz, nuzx = {', '.join(f'{value:g}' for value in nu)}",
            expected="a sum above 0",
            do="lower the ratios, the largest first",
        )
    C = np.linalg.inv(S)
    return np.asarray((C + C.T) / 2.0)


def turned(C: ArrayLike, axes: ArrayLike) -> Floats:
    """Elasticity [6, 6] [Pa] along global axes of a material whose own x, y, z are the rows of axes [3, 3].

    >>> quarter = [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    >>> turned(np.diag([3.0, 2.0, 1.0, 1.0, 1.0, 1.0]), quarter).diagonal().round(9)
    array([2., 3., 1., 1., 1., 1.])
    """
    R = np.asarray(axes, dtype=np.float64)
    i, j = [0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]
    # Strains along the own axes from those along the global ones; shear strains are twice the tensor's.
    halves = np.array([1.0, 1.0, 1.0, 0.5, 0.5, 0.5])
    both = R[i][:, i] * R[j][:, j] + R[i][:, j] * R[j][:, i]
    strains = both * halves / halves[:, None]
    strains[:, :3] /= 2.0
    result = strains.T @ np.asarray(C, dtype=np.float64) @ strains
    return np.asarray((result + result.T) / 2.0)
