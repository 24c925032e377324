"""Multipoles of a rigid sphere that moves along the normal of a rigid plane: what the plane sends back is in them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np
import scipy
from numpy.polynomial.legendre import leggauss, legvander

from acoustics.arrays import Complexes, Floats

APART: Final = 10.0  # radii above the plane from which what it sends back to the sphere, at most 10 %, is left out
ORDERS: Final = 10  # of multipoles beside those that ka needs: the far field is then right to about 1e-5
STEP: Final = 0.1  # of ka, over the height in radii, between frequencies at which multipoles are solved for
_BLOCK: Final = 64  # frequencies solved for at once


def strengths(highest: float, height: float) -> Callable[[Floats], Complexes]:
    """Multipoles c_n [orders, nf] by frequency, omega a / c up to `highest`: splines between those at equal steps."""
    if height >= APART:
        return _free
    nodes = np.linspace(0.0, highest, max(8, int(np.ceil(highest * height / STEP))) + 1)
    orders = int(np.ceil(highest)) + ORDERS
    x: Complexes = np.asarray(1j * nodes, dtype=np.complex128)
    solved = np.concatenate([_solved(x[i : i + _BLOCK], height, orders) for i in range(0, len(x), _BLOCK)])
    # Beyond 0 they are the conjugates: without them splines are at their worst at 0, where sphere and image cancel.
    nodes = np.concatenate([-nodes[:0:-1], nodes])
    spline = scipy.interpolate.CubicSpline(nodes, np.concatenate([solved[:0:-1].conj(), solved]))
    return lambda ka: np.asarray(spline(ka).T)


def _free(ka: Floats) -> Complexes:
    """Multipoles of a sphere in free air: the dipole -k_1(x) / (x k_1'(x))."""
    x = 1j * ka
    return np.asarray([0 * x, 1.0 / (2 + x * x / (1 + x))])


def _solved(x: Complexes, height: float, orders: int) -> Complexes:
    """Multipoles [nf, orders] that move the air with the sphere: dp/dr a / (rho s u a) = -cos all over it.

    x [nf] = s a / c. height : of the centre over the plane, in radii. By projection on the Legendre polynomials.
    """
    cos, weights = leggauss(max(64, 4 * orders))
    n = np.arange(orders)
    up, out = 2 * height + cos, np.sqrt(1 - cos * cos)  # from the image's centre to the sphere, in radii
    r2 = np.hypot(up, out)
    cos2 = up / r2
    legendre = legvander(cos2, orders).T
    sloped = (n[:, None] * (np.vstack([0 * cos2, legendre[: orders - 1]]) - cos2 * legendre[:orders])) / (out / r2) ** 2
    along = (out * out + cos * up) / r2  # slope of the image's radius along the sphere's normal, and of its cosine
    turned = cos / r2 - up / r2**2 * along
    values, slopes = outward(x[:, None], r2, orders), _outward_slope(x[:, None], r2, orders)
    image = np.where(n % 2, -1.0, 1.0)[:, None, None] * (
        slopes * (along * legendre[:orders])[:, None] + values * (turned * sloped)[:, None]
    )
    project = (n[:, None] + 0.5) * weights * legvander(cos, orders - 1).T
    matrix = np.einsum("mq,nfq->fmn", project, image, optimize=True)
    matrix[:, n, n] += _outward_slope(x[:, None], np.ones(1), orders)[:, :, 0].T
    given = np.zeros((len(x), orders, 1), dtype=np.complex128)
    given[:, 1] = -1.0
    return np.asarray(np.linalg.solve(matrix, given)[:, :, 0])


def outward(x: Complexes, q: Floats, orders: int) -> Complexes:
    """k_n(x q) / k_n(x) for n = 0 .. orders - 1 [orders, nf, nq], x [nf, 1], q [nq]."""
    n = np.arange(orders)[:, None, None]
    return np.asarray(q ** -(n + 1.0) * _polynomials(x * q, orders) / _polynomials(x, orders) * np.exp(x * (1 - q)))


def _outward_slope(x: Complexes, q: Floats, orders: int) -> Complexes:
    """Its derivative along q: k_n' = -k_(n-1) - (n + 1) k_n / x, and k_(-1) = k_0."""
    n = np.arange(orders)[:, None, None]
    below = np.empty((orders, *np.broadcast_shapes(x.shape, q.shape)), dtype=np.complex128)
    below[0] = x / q
    below[1:] = x * x * q ** -n[1:].astype(float) * _polynomials(x * q, orders)[:-1] / _polynomials(x, orders)[1:]
    return np.asarray(-below * np.exp(x * (1 - q)) - (n + 1) / q * outward(x, q, orders))


def _polynomials(z: Complexes, orders: int) -> Complexes:
    """Reverse Bessel polynomials theta_n(z), n = 0 .. orders - 1: k_n(z) = exp(-z) theta_n(z) / z^(n + 1)."""
    made = np.empty((max(2, orders), *z.shape), dtype=np.complex128)
    made[0], made[1] = 1.0, z + 1.0
    for n in range(2, orders):
        made[n] = (2 * n - 1) * made[n - 1] + z * z * made[n - 2]
    return made[:orders]
