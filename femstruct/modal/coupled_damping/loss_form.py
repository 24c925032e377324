"""What free motion of oscillators loses from now on, from the damping matrix alone."""

from __future__ import annotations

from typing import Final

import numpy as np

from femstruct.arrays import Floats

LOSSLESS: Final = 1e-18  # of the squares of both frequencies: a pair that loses nothing that could be integrated


def loss_form(omega: Floats, damping: Floats, speeds: Floats, matrix: Floats, energy: Floats) -> Floats:
    """The symmetric form S of the state y = [z, v] of oscillators: free motion loses y . S y / 2 from now on.

    omega, damping [k] : w, c of z'' + c z' + w^2 z = 0. speeds [m, 2 k] : q' = speeds y; matrix [m, m] : damping, which
    takes q' . matrix q'. energy [2 k, 2 k] : taken in place of it for pairs that lose nothing.

    Notes: S is the integral of exp(B t)^T W exp(B t) over all times, W = 2 speeds^T matrix speeds, and the solution of
    B^T S + S B = -W: for each two oscillators four equations, solved here by hand. The determinant is
    (u^2 - w^2)^2 + (c + g)(c u^2 + g w^2), a sum of positive terms. Masses and stiffnesses do not enter: that S is
    the energy is what an energy balance can be checked by.

    An oscillator of unit mass loses all of its energy:

    >>> S = loss_form(np.array([3.0]), np.array([0.5]), np.array([[0.0, 1.0]]), np.array([[0.5]]), np.zeros((2, 2)))
    >>> S.round(12).tolist()
    [[9.0, 0.0], [0.0, 1.0]]
    """
    k = len(omega)
    taken = 2.0 * (speeds.T @ (matrix @ speeds))
    w00, w01, w10, w11 = taken[:k, :k], taken[:k, k:], taken[k:, :k], taken[k:, k:]
    w, u = omega[:, None] ** 2, omega[None, :] ** 2
    c, g = damping[:, None], damping[None, :]
    apart, both = u - w, c + g
    size = apart**2 + both * (c * u + g * w)
    lossy = size > LOSSLESS * (w + u) ** 2
    size = np.where(lossy, size, 1.0)
    first, second = w00 + w * w11, w01 - w10 - c * w11
    e = (both * first - apart * second) / size
    b = ((apart + c * both) * first + w * both * second) / size
    a = w * e + g * b - w01
    d = both * e - b - w11
    form = np.block([[a, b], [d, e]])
    form = np.where(np.block([[lossy, lossy], [lossy, lossy]]), form, energy)
    symmetric: Floats = 0.5 * (form + form.T)
    return symmetric
