"""Convex quadrilaterals as images of the unit square: shape functions, gradients, integrals.

Corner n of a cell stands at `femstruct.elements.plate.CORNERS[n]` of the unit square, so xi runs from corner 0 to
corner 3 and eta from corner 0 to corner 1. The corners may go round the cell either way.
"""

from __future__ import annotations

from functools import cache
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from femstruct.arrays import Floats
from femstruct.elements.plate import CORNERS
from femstruct.elements.polynomials import LINEAR, QUADRATIC, derivative, powers
from femstruct.elements.quadrature import gauss_interval
from femstruct.errors import InputError

N_CORNERS: Final = 4
N_SHAPES: Final = 9
"""Values at the corners, at the middles of the sides, and the bubble: the shape functions in this order."""


def cells(xy: ArrayLike) -> Floats:
    """Corners [n, 4, 2] as float64; InputError for another shape and for a cell that is not convex.

    >>> cells([[0, 0], [1, 0], [1, 1], [0, 1]]).shape
    (1, 4, 2)
    """
    corners = np.asarray(xy, dtype=np.float64)
    corners = corners[None] if corners.ndim == 2 else corners
    if corners.shape[1:] != (N_CORNERS, 2):
        raise InputError("corners of cells", got=f"shape {corners.shape}", expected="shape (n, 4, 2)")
    to_next = np.roll(corners, -1, axis=1) - corners
    turns = cross(to_next, np.roll(to_next, -1, axis=1))
    bad = ~((turns > 0).all(axis=1) | (turns < 0).all(axis=1))
    if bad.any():
        where = np.flatnonzero(bad)[0]
        got = ", ".join(f"({x:g}, {y:g})" for x, y in corners[where])
        raise InputError(f"cell {where}", got=got, expected="the corners of a convex quadrilateral in turn")
    return corners


def cross(a: Floats, b: Floats) -> Floats:
    """z component of the products of vectors in the plane."""
    product: Floats = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return product


@cache
def shapes() -> Floats:
    """Coefficients [9, 4, 4] of xi^i eta^j of the shape functions; those of sides and bubble are 1 in the middle."""
    middle = QUADRATIC[2]
    corner = [np.outer(LINEAR[i], LINEAR[j]) for i, j in CORNERS]
    side = [np.outer(LINEAR[0], middle), np.outer(middle, LINEAR[1])]
    side += [np.outer(LINEAR[1], middle), np.outer(middle, LINEAR[0])]
    return np.array([*corner, *side, np.outer(middle, middle)])


def values(xi: ArrayLike, eta: ArrayLike) -> Floats:
    """Shape functions at places: [m] -> [m, 9].

    >>> values([0.0], [0.5])[0]
    array([0.5, 0.5, 0. , 0. , 1. , 0. , 0. , 0. , 0. ])
    """
    result: Floats = np.einsum("kij,...i,...j->...k", shapes(), powers(xi), powers(eta), optimize=True)
    return result


def slopes(xi: ArrayLike, eta: ArrayLike) -> Floats:
    """Derivatives of the shape functions by xi and by eta at places: [m] -> [2, m, 9]."""
    by_xi, by_eta = derivative(shapes(), 1), derivative(shapes(), 2)
    return np.stack(
        [np.einsum("kij,...i,...j->...k", of, powers(xi), powers(eta), optimize=True) for of in (by_xi, by_eta)]
    )


def gradients(
    corners: Floats, xi: Floats, eta: Floats, of: Floats | tuple[Floats, Floats]
) -> tuple[Floats, Floats, Floats]:
    """Derivatives of functions by x and by y at places of cells, and the areas that a unit of the square has there.

    corners [n, 4, 2]; xi, eta : places, broadcast to [n, g]; of [2, .., k] : derivatives of the functions by xi and by
    eta there, broadcast to [2, n, g, k].

    Returns two arrays [n, g, k], and [n, g], positive whichever way the corners go round.
    """
    along_xi, along_eta, twist = (part[:, None] for part in edges(corners))
    by_xi = along_xi + np.asarray(eta)[..., None] * twist
    by_eta = along_eta + np.asarray(xi)[..., None] * twist
    determinant = cross(by_xi, by_eta)
    by_xi, by_eta = by_xi / determinant[..., None], by_eta / determinant[..., None]
    by_x = by_eta[..., 1:] * of[0] - by_xi[..., 1:] * of[1]
    by_y = by_xi[..., :1] * of[1] - by_eta[..., :1] * of[0]
    return by_x, by_y, np.abs(determinant)


def edges(corners: Floats) -> tuple[Floats, Floats, Floats]:
    """Coefficients of xi, eta and xi eta in the place: each [n, 2] or, for corners in space, [n, 3]."""
    p0, p1, p2, p3 = np.moveaxis(corners, 1, 0)
    return p3 - p0, p1 - p0, p0 - p1 + p2 - p3


@cache
def square_points(n: int) -> tuple[Floats, Floats, Floats]:
    """n x n Gauss points of the unit square: xi, eta, weights [n n]; exact to the degree 2 n - 1 in either."""
    points, weights = gauss_interval(n)
    return np.repeat(points, n), np.tile(points, n), np.outer(weights, weights).ravel()


@cache
def _value_integrals() -> Floats:
    """[3, 8, 8]: integrals of products of the functions of corners and sides times 1, xi, eta; exact."""
    xi, eta, weights = square_points(3)
    each = values(xi, eta)[:, :8]
    factors = weights * np.stack([np.ones_like(xi), xi, eta])
    result: Floats = np.einsum("fg,gk,gl->fkl", factors, each, each, optimize=True)
    return result


def value_products(corners: Floats) -> Floats:
    """Integrals over cells of all products of the shape functions of corners and sides: [n, 8, 8] [m^2], exact."""
    along_xi, along_eta, twist = edges(corners)
    area = np.stack([cross(along_xi, along_eta), cross(along_xi, twist), cross(twist, along_eta)], axis=1)
    area *= np.sign(area[:, :1] * 2 + area[:, 1:2] + area[:, 2:])
    return (area @ _value_integrals().reshape(3, -1)).reshape(-1, 8, 8)
