"""Eigenvalues and shapes of q'' + C q' + Omega^2 q = 0, to the rounding of each equation."""

from __future__ import annotations

from typing import Final

import numpy as np
import scipy
from numpy.typing import NDArray

from femstruct.arrays import Floats

Complex = NDArray[np.complex128]
NEAR: Final = 1e-3  # a first-order change of a vector by more than that is none: its eigenvalue is a multiple one
REAL: Final = 1e-13  # of an eigenvalue: what is imaginary of one that is real


def eigenpairs(omega: Floats, damping: Floats) -> tuple[Complex, Complex]:
    """All eigenvalues [2 k] [1/s] and shapes [k, 2 k] of modes with this damping; complex ones are exact conjugates.

    omega [k] : circular frequencies [rad/s]. Those that are zero must have damping of their own: their displacements
    act on nothing, and are the shapes of as many eigenvalues zero, exactly.
    """
    k = len(omega)
    moved = np.flatnonzero(omega > 0.0)
    still = np.flatnonzero(omega == 0.0)
    values, vectors = _refined(omega[moved], moved, damping)
    rates = vectors[len(moved) :]
    values = np.where(np.abs(values.imag) <= REAL * np.abs(values), values.real, values)
    shapes = np.divide(rates, values, out=np.zeros_like(rates), where=values != 0.0)
    shapes[moved] = vectors[: len(moved)] / omega[moved, None]
    upper = np.flatnonzero(values.imag > 0.0)
    single = np.flatnonzero(values.imag == 0.0)
    rigid = np.zeros((k, len(still)), dtype=np.complex128)
    rigid[still, np.arange(len(still))] = 1.0
    return (
        np.concatenate([np.zeros(len(still)), values[single], values[upper], values[upper].conj()]),
        np.hstack([rigid, _real(shapes[:, single]), shapes[:, upper], shapes[:, upper].conj()]),
    )


def eigenvalues(omega: Floats, damping: Floats) -> Complex:
    """The eigenvalues alone [m + k] [1/s], as a library rounds them; those of motions without any force are left out.

    omega [k] : circular frequencies [rad/s], m of them not zero.
    """
    moved = np.flatnonzero(omega > 0.0)
    return np.asarray(scipy.linalg.eigvals(_state(omega[moved], moved, damping), check_finite=False))


def _state(omega: Floats, moved: NDArray[np.int64], damping: Floats) -> Floats:
    """The matrix of [Omega q of what moves on springs; q'] [m + k, m + k] [rad/s]."""
    m, k = len(moved), len(damping)
    state = np.zeros((m + k, m + k))
    state[np.arange(m), m + moved] = omega
    state[m + moved, np.arange(m)] = -omega
    state[m:, m:] = -damping
    return state


def _refined(omega: Floats, moved: NDArray[np.int64], damping: Floats) -> tuple[Complex, Complex]:
    """Eigenvalues and vectors [Omega q of what moves on springs; q'] with one step of Newton's method for all at once.

    Notes: the residual A V - V Lambda is evaluated row by row as the equations stand, so that a rate of 1e7 1/s in one
    of them is no error in another. To first order the eigenvalues change by the diagonal of V^-1 (A V - V Lambda), the
    vectors by what is beside it over the differences of the eigenvalues.
    """
    m = len(moved)
    values, vectors = scipy.linalg.eig(_state(omega, moved, damping), check_finite=False)
    place, rate = vectors[:m], vectors[m:]
    pulled = np.zeros_like(rate)
    pulled[moved] = -omega[:, None] * place
    left = np.vstack([omega[:, None] * rate[moved] - place * values, pulled - _times(damping, rate) - rate * values])
    change = np.linalg.solve(vectors, left)
    apart = values - values[:, None]
    far = NEAR * np.abs(apart) > np.abs(change)
    turn = np.divide(change, apart, out=np.zeros_like(change), where=far)
    return values + np.diag(change), vectors + vectors @ turn


def _times(matrix: Floats, vectors: Complex) -> Complex:
    """A real matrix times complex vectors."""
    return np.asarray(matrix @ vectors.real + 1j * (matrix @ vectors.imag), dtype=np.complex128)


def _real(shapes: Complex) -> Complex:
    """Shapes of real eigenvalues as they are, real but for a factor."""
    largest = shapes[np.argmax(np.abs(shapes), axis=0), np.arange(shapes.shape[1])]
    return np.asarray((shapes / np.where(largest == 0.0, 1.0, largest)).real, dtype=np.complex128)
