"""What free motion of oscillators loses from now on, from the damping matrix alone."""

from __future__ import annotations

from typing import Final

import numpy as np

from femstruct.arrays import Floats

LOSSLESS: Final = 1e-18  # of the squares of both frequencies: a pair that loses nothing that could be integrated
ROUNDING: Final = 2e-16  # of the terms that a number is summed from
KNOWN: Final = 1e-10  # of the energies of a pair: what rounding may leave unknown of what it loses


def loss_form(omega: Floats, damping: Floats, taken: Floats) -> tuple[Floats, Floats]:
    """The form S of the state y = [z, v] of oscillators, free motion loses y . S y / 2 from now on; and its rounding.

    omega, damping [k] : w, c of z'' + c z' + w^2 z = 0. taken [2 k, 2 k] : W, the power y . W y / 2 of all damping.
    The rounding [2 k, 2 k] is infinite for pairs that lose nothing.

    Notes: S is the integral of exp(B t)^T W exp(B t) over all times, and the solution of B^T S + S B = -W: for each two
    oscillators four equations, solved here by hand. The determinant is (u^2 - w^2)^2 + (c + g)(c u^2 + g w^2), a sum of
    positive terms. Masses and stiffnesses do not enter: that S is the energy is what a balance can be checked by.

    An oscillator of unit mass and a dashpot of 0.5 1/s, which takes 0.5 v^2, loses all of its energy:

    >>> S, _ = loss_form(np.array([3.0]), np.array([0.5]), np.array([[0.0, 0.0], [0.0, 1.0]]))
    >>> S.round(12).tolist()
    [[9.0, 0.0], [0.0, 1.0]]
    """
    k = len(omega)
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
    form = np.block([[w * e + g * b - w01, b], [both * e - b - w11, e]])
    first, second = np.abs(first), np.abs(second)
    in_e = (both * first + np.abs(apart) * second) / size
    in_b = ((np.abs(apart) + c * both) * first + w * both * second) / size
    noise = np.block([[w * in_e + g * in_b + np.abs(w01), in_b], [both * in_e + in_b + np.abs(w11), in_e]])
    return form, np.where(np.tile(lossy, (2, 2)), ROUNDING * (noise + np.abs(form)), np.inf)


def loss_surplus(omega: Floats, damping: Floats, speeds: Floats, matrix: Floats, gram: Floats, reach: Floats) -> Floats:
    """What free motion loses from now on, as a form of its state, less the energy [2 k, 2 k].

    speeds [m, 2 k] : q' = speeds y; matrix [m, m] : damping, which takes q' . matrix q'. gram [2 k, 2 k] : the energy
    is y . gram y / 2. reach [k] : how much larger the energy of an oscillator may be than that of all of them.

    Zero where it is lost in rounding: for a rate of 1e9 1/s beside one of 1 1/s, and for oscillators of almost one
    shape, which carry large motions against each other.
    """
    k = len(omega)
    form, noise = loss_form(omega, damping, 2.0 * (speeds.T @ (matrix @ speeds)))
    root = np.sqrt(np.diag(gram)) / np.tile(np.maximum(reach, 1.0), 2)
    known = (noise <= KNOWN * np.outer(root, root)).reshape(2, k, 2, k).all(axis=(0, 2))
    surplus = np.where(np.tile(known, (2, 2)), form - gram, 0.0)
    symmetric: Floats = 0.5 * (surplus + surplus.T)
    return symmetric
