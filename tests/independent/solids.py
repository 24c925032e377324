"""Boxes of any elastic material by Ritz: products of polynomials; its faces at 0 slide along walls.

Lekhnitskii, Theory of Elasticity of an Anisotropic Body (1963), chapter 1: Hooke's law by a tensor of fourth order,
turned with its axes. Strains are of small displacements along x, y, z.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product

import numpy as np

from tests.independent.linear import Floats, Linear

_PAIRS = ((0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1))


def isotropic(E: float, nu: float) -> Floats:
    """Hooke's tensor [3, 3, 3, 3]."""
    G, lame = E / 2 / (1 + nu), E * nu / (1 + nu) / (1 - 2 * nu)
    I = np.eye(3)  # noqa: E741
    shear = np.einsum("ik,jl->ijkl", I, I) + np.einsum("il,jk->ijkl", I, I)
    return np.asarray(lame * np.einsum("ij,kl->ijkl", I, I) + G * shear)


def orthotropic(E: Sequence[float], G: Sequence[float], nu: Sequence[float]) -> Floats:
    """Hooke's tensor of moduli along 1, 2, 3, shear moduli G12, G23, G31, and ratios nu12, nu23, nu31: contraction
    along the second of stretch along the first."""
    S = np.diag([1 / one for one in E])
    for (i, j), one in zip(((0, 1), (1, 2), (2, 0)), nu, strict=True):
        S[i, j] = S[j, i] = -one / E[i]
    stiff, C = np.linalg.inv(S), np.zeros((3, 3, 3, 3))
    for i, j in product(range(3), repeat=2):
        C[i, i, j, j] = stiff[i, j]
    for (i, j), one in zip(((0, 1), (1, 2), (2, 0)), G, strict=True):
        for k, m in ((i, j), (j, i)):
            C[i, j, k, m] = C[j, i, k, m] = one
    return C


def turned(C: Floats, axes: Floats) -> Floats:
    """Of a material whose axes are the rows."""
    return np.asarray(np.einsum("ai,bj,ck,dl,abcd->ijkl", axes, axes, axes, axes, C, optimize=True))


class Box:
    """A box from the origin whose faces x = 0, y = 0 and z = 0 do not move across themselves. order : how many
    polynomials along x, y, z. loss : of the material."""

    def __init__(self, sides: Floats, C: Floats, rho: float, loss: float, order: Sequence[int] = (6, 6, 6)) -> None:
        self.sides, self.order = np.asarray(sides, float), order
        g, w = np.polynomial.legendre.leggauss(max(order) + 2)
        places = np.stack(np.meshgrid(*[(g + 1) / 2 * one for one in self.sides], indexing="ij"), -1).reshape(-1, 3)
        weights = np.einsum("i,j,k->ijk", w, w, w).ravel() * self.sides.prod() / 8
        slopes = np.array([[self.values(places, of, along) for along in range(3)] for of in range(3)])
        n = slopes.shape[-1]
        self.K, self.M = np.zeros((3 * n, 3 * n)), np.zeros((3 * n, 3 * n))
        self.rides = np.zeros((3, 3 * n))
        own = [slice(of * n, (of + 1) * n) for of in range(3)]
        for i, k in product(range(3), repeat=2):  # of displacements i and k, their slopes along j and l
            self.K[own[i], own[k]] = sum(
                C[i, j, k, m] * (slopes[i, j].T * weights) @ slopes[k, m] for j, m in product(range(3), repeat=2)
            )
        for i in range(3):
            values = self.values(places, i)
            self.M[own[i], own[i]] = rho * (values.T * weights) @ values
            self.rides[i, own[i]] = rho * weights @ values
        self.H = loss * self.K

    def values(self, places: Floats, of: int, along: int | None = None) -> Floats:
        """Products for a displacement at places [n, 3], or their slopes along an axis: [n, products]."""
        each = []
        for axis, count in enumerate(self.order):
            x, length = places[:, axis], self.sides[axis]
            base = [np.polynomial.legendre.Legendre.basis(i, domain=[0, length]) for i in range(count)]
            plain = np.stack([one(x) for one in base], axis=1)
            slope = np.stack([one.deriv()(x) for one in base], axis=1)
            if axis == of:  # zero at the wall
                plain, slope = plain * (x / length)[:, None], slope * (x / length)[:, None] + plain / length
            each.append(slope if axis == along else plain)
        return np.einsum("pi,pj,pk->pijk", *each).reshape(len(places), -1)

    def linear(self, points: Mapping[str, Floats]) -> Linear:
        """With motions of points, but for turns."""
        rows = {}
        for name, at in points.items():
            for k, one in enumerate("xyz"):
                rows[name, one] = np.kron(np.eye(3)[k], self.values(np.asarray(at, float)[None], k)[0])
        return Linear(self.K, self.M, np.zeros_like(self.K), self.H, rows, self.rides)
