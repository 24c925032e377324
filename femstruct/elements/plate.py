"""Rectangular Kirchhoff plate elements of three kinds, with one interface.

==========  ===================================================================  =========================
kind        shape functions                                                      converges to
==========  ===================================================================  =========================
hermite12   products of cubic Hermite polynomials without the twist DOF          a plate too stiff in twist
acm12       Adini-Clough-Melosh, the incomplete quartic with 12 terms            the plate, O(h^2)
bfs16       Bogner-Fox-Schmit, the full bicubic with the twist as fourth DOF     the plate, O(h^4)
==========  ===================================================================  =========================

A cell is a x b with its corners in the order 1 (0, 0), 2 (0, b), 3 (a, b), 4 (a, 0); at each corner the DOFs are, in
the plate's own axes, w, RX = +dw/dy, RY = -dw/dx and, for bfs16 only, TWIST = d2w/dxdy.

hermite12 is the element of the source dissertation (appendix A.1), kept to reproduce its results. Without the cross
derivative it cannot represent w = x y and converges, under refinement, to an orthotropic plate whose twist stiffness is
`1 + twist_excess` times too large: +14 % for square cells and nu = 0.3, which raises the first frequency of a free
square plate by 6.3 % however fine the mesh. Doubly symmetric modes are nearly immune.

The shape functions live on the unit square and the DOFs are scaled by the sizes of the cell afterwards: polynomials
fitted in global coordinates lose digits as the mesh gets finer. All integrals are exact.

References: F. K. Bogner, R. L. Fox, L. A. Schmit, Proc. Conf. Matrix Methods in Structural Mechanics, AFFDL-TR-66-80
(1965) 397-443. A. Adini, R. W. Clough, report to the National Science Foundation G 7337 (1961); R. J. Melosh, AIAA
Journal 1 (1963) 1631-1637.
"""

from __future__ import annotations

from functools import cache
from typing import Final, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from femstruct.arrays import Floats
from femstruct.elements.polynomials import (
    DENOMINATOR,
    HERMITE_SLOPE,
    HERMITE_VALUE,
    LINEAR,
    TERMS,
    derivative,
    moment_numerators,
    positive,
    powers,
)
from femstruct.errors import InputError

PlateElement = Literal["hermite12", "acm12", "bfs16"]
KINDS: Final = get_args(PlateElement)
CORNERS: Final = ((0, 0), (0, 1), (1, 1), (1, 0))
"""Corner of each node as (xi, eta)."""


def dofs_per_node(kind: str) -> int:
    """Number of DOFs at a node: 3, or 4 with the twist.

    >>> dofs_per_node("bfs16")
    4
    """
    if kind not in KINDS:
        raise InputError("element", got=repr(kind), expected=" or ".join(KINDS))
    return 4 if kind == "bfs16" else 3


def rigidity(E: float, nu: float, thickness: float) -> Floats:
    """Bending rigidity D [3, 3] in N m of an isotropic plate: (Mx, My, Mxy) = -D (w_xx, w_yy, 2 w_xy).

    Parameters
    ----------
    E : float
        Young's modulus [Pa].
    nu : float
        Poisson's ratio, between -1 and 0.5; thickness [m].

    Raises
    ------
    InputError
        For values without a positive definite rigidity.

    Examples
    --------
    >>> rigidity(12.0, 0.0, 1.0).diagonal()
    array([1. , 1. , 0.5])
    """
    positive("E", E)
    positive("thickness", thickness)
    if not -1.0 < nu < 1.0:
        raise InputError("nu", got=str(nu), expected="a value between -1 and 0.5")
    matrix = np.array([[1.0, nu, 0.0], [nu, 1.0, 0.0], [0.0, 0.0, (1.0 - nu) / 2.0]])
    return E * thickness**3 / (12.0 * (1.0 - nu**2)) * matrix


def stiffness(kind: str, a: ArrayLike, b: ArrayLike, D: ArrayLike) -> Floats:
    """Stiffness matrices of plate cells, exactly integrated.

    Parameters
    ----------
    kind : str
        One of KINDS.
    a, b : ArrayLike [n]
        Sizes along the plate's x and y [m].
    D : ArrayLike [3, 3] or [n, 3, 3]
        Rigidity [N m].

    Returns
    -------
    Floats
        [n, nd, nd], nd = 12 or 16, exactly symmetric.

    Raises
    ------
    InputError
        For an unknown kind, sizes that are not positive, or a D that is not symmetric.

    Notes
    -----
    The moments follow from the same D (`moments`). hermite12 is too stiff in twist at any mesh size.

    Examples
    --------
    >>> K = stiffness("bfs16", [0.1, 0.2], [0.1, 0.1], rigidity(5.9e9, 0.35, 0.005))
    >>> K.shape
    (2, 16, 16)
    """
    a, b = _sizes(a, b)
    rigidities = _rigidities(D)
    coefficients = rigidities[..., *_PAIRS] * a[:, None] ** _POWERS_OF_A * b[:, None] ** _POWERS_OF_B
    return _combined(kind, coefficients, _curvature_integrals(kind), a, b)


def mass(kind: str, a: ArrayLike, b: ArrayLike, mass_per_area: ArrayLike) -> Floats:
    """Consistent mass matrices of plate cells, exactly integrated.

    Parameters
    ----------
    kind : str
        One of KINDS.
    a, b : ArrayLike [n]
        Sizes [m]; mass_per_area [n] or one value [kg/m^2], zero allowed.

    Returns
    -------
    Floats
        [n, nd, nd], exactly symmetric.

    Notes
    -----
    Inertia of the translation w only. The rotary inertia of the cross-section, of relative size
    (pi t / wavelength)^2 / 3, is left out, as in Kirchhoff's theory.

    Examples
    --------
    >>> M = mass("acm12", [0.1], [0.2], 10.0)
    >>> translation = np.tile([1.0, 0.0, 0.0], 4)
    >>> round(float(translation @ M[0] @ translation), 12)
    0.2
    """
    a, b = _sizes(a, b)
    coefficients = (np.asarray(mass_per_area, dtype=np.float64) * a * b)[:, None]
    return _combined(kind, coefficients, _value_integrals(kind), a, b)


def interpolate(kind: str, a: ArrayLike, b: ArrayLike, xi: ArrayLike, eta: ArrayLike) -> Floats:
    """Rows that give w, RX, RY and TWIST at points of cells from the DOFs of the cells.

    Parameters
    ----------
    kind : str
        One of KINDS.
    a, b : ArrayLike [m]
        Sizes of the cell of each point [m].
    xi, eta : ArrayLike [m]
        Place in it, 0 to 1.

    Returns
    -------
    Floats
        [m, 4, nd]: w, RX = +dw/dy, RY = -dw/dx, TWIST = d2w/dxdy.

    Examples
    --------
    >>> rows = interpolate("hermite12", [0.1], [0.2], [0.0], [1.0])
    >>> rows[0, 1].nonzero()[0]
    array([4])
    """
    a, b = _sizes(a, b)
    one = np.ones_like(a)
    signs = np.stack([one, 1.0 / b, -1.0 / a, 1.0 / (a * b)], axis=1)
    rows = _evaluate(kind, ((0, 0), (0, 1), (1, 0), (1, 1)), xi, eta)
    return rows * signs[:, :, None] * _dof_scale(kind, a, b)[:, None, :]


def moments(kind: str, a: ArrayLike, b: ArrayLike, xi: ArrayLike, eta: ArrayLike, D: ArrayLike) -> Floats:
    """Rows that give the moments (Mx, My, Mxy) per length [N] at points of cells from the DOFs of the cells.

    Arguments as `interpolate`.

    Parameters
    ----------
    D : ArrayLike [3, 3] or [m, 3, 3]
        The rigidity the stiffness was made with [N m].

    Returns
    -------
    Floats
        [m, 3, nd]: M = -D (w_xx, w_yy, 2 w_xy), so a positive Mx stretches the side of positive z.
    """
    a, b = _sizes(a, b)
    scale = np.stack([1.0 / a**2, 1.0 / b**2, 2.0 / (a * b)], axis=1)
    curvatures = _evaluate(kind, _CURVATURES, xi, eta) * scale[:, :, None] * _dof_scale(kind, a, b)[:, None, :]
    result: Floats = -_rigidities(D) @ curvatures
    return result


def twist_excess(beta: ArrayLike, nu: ArrayLike) -> Floats:
    """Relative excess eps of the twist stiffness of hermite12 cells: D66 = (1 + eps) D (1 - nu) / 2.

    Parameters
    ----------
    beta : ArrayLike
        B / a of the cell.
    nu : ArrayLike
        Poisson's ratio. Exact for the energy of w = x y in one cell, and the limit under refinement: eps = ((beta^2 +
        beta^-2) / 35 + 1 / 25) / (1 - nu).

    Examples
    --------
    >>> round(float(twist_excess(1.0, 0.3)), 4)
    0.1388
    """
    squared = positive("beta", beta) ** 2
    return ((squared + 1.0 / squared) / 35.0 + 1.0 / 25.0) / (1.0 - np.asarray(nu, dtype=np.float64))


_CURVATURES: Final = ((2, 0), (0, 2), (1, 1))
# Entries of the symmetric D, with the powers of a and b that multiply each in the energy of a unit cell's curvatures.
_PAIRS: Final = ([0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2])
_POWERS_OF_A: Final = np.array([-3.0, 1.0, -1.0, -1.0, -2.0, 0.0])
_POWERS_OF_B: Final = np.array([1.0, -3.0, -1.0, -1.0, 0.0, -2.0])
_FACTORS: Final = np.array([1.0, 1.0, 4.0, 2.0, 4.0, 4.0])  # 2 w_xy, and off-diagonal entries of D count twice


def _product(x: Floats, y: Floats) -> Floats:
    result: Floats = np.multiply.outer(x, y)
    return result


@cache
def _shapes(kind: str) -> Floats:
    """Coefficients [nd, 4, 4] of xi^i eta^j of the shape functions for the DOFs w, w_eta, w_xi (and w_xieta)."""
    value, slope, linear = HERMITE_VALUE, HERMITE_SLOPE, LINEAR
    per_node = dofs_per_node(kind)
    shapes = []
    for i, j in CORNERS:
        if kind == "acm12":
            corner = [
                _product(value[i], linear[j]) + _product(linear[i], value[j]) - _product(linear[i], linear[j]),
                _product(linear[i], slope[j]),
                _product(slope[i], linear[j]),
            ]
        else:
            corner = [
                _product(value[i], value[j]),
                _product(value[i], slope[j]),
                _product(slope[i], value[j]),
                _product(slope[i], slope[j]),
            ]
        shapes += corner[:per_node]
    return np.array(shapes)


def _derivative_of_shapes(kind: str, order: tuple[int, int]) -> Floats:
    coefficients = _shapes(kind)
    for axis, times in zip((1, 2), order, strict=True):
        for _ in range(times):
            coefficients = derivative(coefficients, axis)
    return coefficients


@cache
def _derivatives(kind: str, orders: tuple[tuple[int, int], ...]) -> Floats:
    """Coefficients [len(orders), nd, 4, 4] of derivatives of the shape functions."""
    return np.array([_derivative_of_shapes(kind, order) for order in orders])


def _integral(left: Floats, right: Floats) -> Floats:
    """Integrals over the unit square of all products of two families, exact but for one division."""
    numerators = np.kron(moment_numerators(), moment_numerators())
    product: Floats = left.reshape(-1, TERMS**2) @ numerators @ right.reshape(-1, TERMS**2).T
    return product / DENOMINATOR**2


@cache
def _value_integrals(kind: str) -> Floats:
    """[1, nd, nd]: the integral of N N^T over the unit square."""
    return _integral(_shapes(kind), _shapes(kind))[None]


@cache
def _curvature_integrals(kind: str) -> Floats:
    """[6, nd, nd]: for each entry of D, the symmetric integral of the two curvatures it joins."""
    curvatures = [_derivative_of_shapes(kind, order) for order in _CURVATURES]
    products = np.array([_integral(curvatures[p], curvatures[q]) for p, q in zip(*_PAIRS, strict=True)])
    symmetric: Floats = (products + products.transpose(0, 2, 1)) / 2.0
    return _FACTORS[:, None, None] * symmetric


def _combined(kind: str, coefficients: Floats, integrals: Floats, a: Floats, b: Floats) -> Floats:
    """Sum of reference integrals by one matrix product, then the scaling of the DOFs on both sides."""
    n_dofs = integrals.shape[-1]
    matrices = (coefficients @ integrals.reshape(len(integrals), -1)).reshape(-1, n_dofs, n_dofs)
    scale = _dof_scale(kind, a, b)
    matrices *= scale[:, :, None] * scale[:, None, :]
    return matrices


def _dof_scale(kind: str, a: Floats, b: Floats) -> Floats:
    """[n, nd]: w_eta = b RX, w_xi = -a RY, w_xieta = a b TWIST."""
    per_node = np.stack([np.ones_like(a), b, -a, a * b], axis=1)[:, : dofs_per_node(kind)]
    return np.tile(per_node, (1, len(CORNERS)))


def _evaluate(kind: str, orders: tuple[tuple[int, int], ...], xi: ArrayLike, eta: ArrayLike) -> Floats:
    """[m, len(orders), nd]: derivatives of the shape functions of the unit square at the points."""
    result: Floats = np.einsum("rkij,mi,mj->mrk", _derivatives(kind, orders), powers(xi), powers(eta), optimize=True)
    return result


def _sizes(a: ArrayLike, b: ArrayLike) -> tuple[Floats, Floats]:
    along_x, along_y = np.broadcast_arrays(np.atleast_1d(positive("a", a)), np.atleast_1d(positive("b", b)))
    return along_x, along_y


def _rigidities(D: ArrayLike) -> Floats:
    rigidities = np.asarray(D, dtype=np.float64)
    if rigidities.shape[-2:] != (3, 3):
        raise InputError("D", got=f"shape {rigidities.shape}", expected="shape (3, 3) or (n, 3, 3)")
    rounding = 1e-12 * np.abs(rigidities).max(initial=0.0)
    if np.abs(rigidities - np.swapaxes(rigidities, -1, -2)).max(initial=0.0) > rounding:
        raise InputError("D", got="an asymmetric matrix", expected="a symmetric rigidity")
    return rigidities
