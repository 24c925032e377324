"""Eigenvalues and vectors of a damped system to the rounding of its equations, not only to that of its largest number."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from femstruct.arrays import Floats

Complex = NDArray[np.complex128]
NEAR: Final = 1e-6  # of an eigenvalue: those that are nearer to each other are left as they were found


def refined(values: Complex, vectors: Complex, scale: Floats, omega: Floats, damping: Floats) -> tuple[Complex, Complex]:
    """One step of Newton's method for all pairs at once.

    values [2 k], vectors [2 k, 2 k] : of [[0, D], [-Omega^2 / D, -C]], D = diag(scale).

    Notes: the residual A V - V Lambda is evaluated row by row as the equations stand, so that a rate of 1e7 1/s in one
    of them is no error in another. To first order the eigenvalues change by the diagonal of V^-1 (A V - V Lambda), the
    vectors by what is beside it over the differences of the eigenvalues.
    """
    k = len(omega)
    place, rate = vectors[:k], vectors[k:]
    left = np.vstack(
        [
            scale[:, None] * rate - place * values,
            -(omega**2 / scale)[:, None] * place - _times(damping, rate) - rate * values,
        ]
    )
    change = np.linalg.solve(vectors, left)
    apart = values - values[:, None]
    far = np.abs(apart) > NEAR * np.maximum(np.abs(values), np.abs(values)[:, None])
    turn = np.divide(change, apart, out=np.zeros_like(change), where=far)
    return values + np.diag(change), vectors + vectors @ turn


def _times(matrix: Floats, vectors: Complex) -> Complex:
    """A real matrix times complex vectors."""
    return np.asarray(matrix @ vectors.real + 1j * (matrix @ vectors.imag), dtype=np.complex128)
