"""Boxes of any elastic material by Ritz: products of polynomials; free, or with faces that slide along walls.

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
    """A box from the origin. loss : of the material. held : its faces x = 0, y = 0 and z = 0 do not move across
    themselves. order : how many polynomials along x, y, z."""

    def __init__(
        self, sides: Floats, C: Floats, rho: float, loss: float, held: bool, order: Sequence[int] = (7, 7, 7)
    ) -> None:
        self.sides, self.held, self.order = np.asarray(sides, float), held, order
        n = int(np.prod(order))
        self.K, self.M = np.zeros((3 * n, 3 * n)), np.zeros((3 * n, 3 * n))
        own = [slice(of * n, (of + 1) * n) for of in range(3)]
        for i, k in product(range(3), repeat=2):  # of displacements i and k, their slopes along j and l
            self.K[own[i], own[k]] = sum(
                C[i, j, k, m] * self._inner((i, j), (k, m)) for j, m in product(range(3), repeat=2) if C[i, j, k, m]
            )
        for i in range(3):
            self.M[own[i], own[i]] = rho * self._inner((i, None), (i, None))
        each = [self._sums(axis) for axis in range(3)]
        self.rides = np.zeros((3, 3 * n))
        for i in range(3):
            self.rides[i, own[i]] = rho * np.einsum("i,j,k->ijk", *(one[int(self.held and axis == i)] for axis, one in
                                                                    enumerate(each))).ravel()  # fmt: skip
        self.H = loss * self.K

    def _line(self, axis: int, x: Floats, walled: bool) -> tuple[Floats, Floats]:
        """Polynomials along an axis [x, order], and their slopes; zero at a wall."""
        length = self.sides[axis]
        base = [np.polynomial.legendre.Legendre.basis(i, domain=[0, length]) for i in range(self.order[axis])]
        plain, slope = (np.stack([one.deriv(k)(x) for one in base], axis=1) for k in (0, 1))
        if not walled:
            return plain, slope
        share = (x / length)[:, None]
        return plain * share, slope * share + plain / length

    def _gauss(self, axis: int) -> tuple[Floats, Floats]:
        g, w = np.polynomial.legendre.leggauss(self.order[axis] + 2)
        return (g + 1) / 2 * self.sides[axis], w * self.sides[axis] / 2

    def _sums(self, axis: int) -> tuple[Floats, Floats]:
        """Integrals of polynomials along an axis, without a wall and with one."""
        x, w = self._gauss(axis)
        return w @ self._line(axis, x, False)[0], w @ self._line(axis, x, True)[0]

    def _inner(self, one: tuple[int, int | None], other: tuple[int, int | None]) -> Floats:
        """Integrals of the products of two displacements, or of their slopes along an axis: of lines, axis by axis."""
        found = np.ones((1, 1))
        for axis in range(3):
            x, w = self._gauss(axis)
            a, b = (self._line(axis, x, self.held and axis == of)[int(axis == along)] for of, along in (one, other))
            found = np.kron(found, (a.T * w) @ b)
        return found

    def values(self, places: Floats, of: int) -> Floats:
        """Products for a displacement at places [n, 3]: [n, products]."""
        each = [self._line(axis, places[:, axis], self.held and axis == of)[0] for axis in range(3)]
        return np.einsum("pi,pj,pk->pijk", *each).reshape(len(places), -1)

    def linear(self, points: Mapping[str, Floats]) -> Linear:
        """With motions of points, but for turns."""
        rows = {}
        for name, at in points.items():
            for k, one in enumerate("xyz"):
                rows[name, one] = np.kron(np.eye(3)[k], self.values(np.asarray(at, float)[None], k)[0])
        return Linear(self.K, self.M, np.zeros_like(self.K), self.H, rows, self.rides)
