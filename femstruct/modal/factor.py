"""Symmetric factors of K - sigma M: solving with them, and counting eigenvalues below sigma."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array, diags_array
from scipy.sparse.linalg import SuperLU, splu

from femstruct.arrays import Floats
from femstruct.errors import SingularSystem

# Diagonal pivots in a symmetric order. Without SymmetricMode this ordering is a hundred times slower.
_SYMMETRIC = {"SymmetricMode": True}
# Reciprocal condition (rows and columns scaled by the diagonal) under which a matrix is looked at for a null vector.
# Sound structures reach about 1e-11 on meshes of 200 x 200; the look itself does not refuse anything.
_SUSPICIOUS = 1e-12
# A massless mechanism strains and weighs nothing but rounding: real modes have 1e-3 and more in one of the two.
_NOTHING = 1e-10
# |sigma| x^T M x of a shape of x^T diag(A) x = 1: |sigma| / omega_max^2, 1e-14 and more, if it has any mass at all.
_MASSLESS = 1e-20


@dataclass(frozen=True, eq=False)
class Factor:
    """The factor of K - sigma M, sigma [rad^2/s^2] below the spectrum: `solve` takes [n] or [n, m]."""

    sigma: float
    solve: Callable[[Floats], Floats]


def factorise(K: csc_array, M: csc_array, sigma: float, labels: Sequence[str] = ()) -> Factor:
    """Factor of K - sigma M for sigma < 0, positive definite unless K and M share a null vector.

    Raises SingularSystem when they do, naming the degree of freedom that moves most (its number without `labels`).
    """
    A = csc_array(K - sigma * M)
    diagonal = A.diagonal()
    if not (diagonal > 0).all():
        raise _singular(int(np.argmin(diagonal)), labels)
    try:
        factor = _symmetric_factor(A)
    except RuntimeError:  # SuperLU met an exactly zero pivot
        factor = None
    if factor is None or _reciprocal_condition(factor, diagonal) < _SUSPICIOUS:
        _refuse_null_vector(A, K, M, sigma, labels)
    if factor is None:
        factor = _symmetric_factor(csc_array(A + diags_array(_NOTHING * 1e-5 * diagonal)))
    return Factor(sigma, factor.solve)


def count_below(K: csc_array, M: csc_array, mu: float) -> int | None:
    """Number of eigenvalues omega^2 of (K, M) below mu: the negative pivots of L D L^T = K - mu M.

    None when the count cannot be trusted: a pivot moved off the diagonal or lost all its digits. Move mu then.

    Source: Sylvester's law of inertia; B. N. Parlett, The Symmetric Eigenvalue Problem, section 3.3.
    """
    try:
        factor = _symmetric_factor(csc_array(K - mu * M))
    except RuntimeError:
        return None
    if not np.array_equal(factor.perm_r, factor.perm_c):
        return None
    pivots = factor.U.diagonal()
    scale = (np.abs(K.diagonal()) + abs(mu) * np.abs(M.diagonal()))[np.argsort(factor.perm_c)]
    # 1e-11: a pivot that cancelled to fewer than about five digits may have either sign.
    if (np.abs(pivots) < 1e-11 * scale).any():
        return None
    return int(np.count_nonzero(pivots < 0))


def _symmetric_factor(A: csc_array) -> SuperLU:
    return splu(A, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=_SYMMETRIC)


def _reciprocal_condition(factor: SuperLU, diagonal: Floats) -> float:
    """Upper estimate of the smallest eigenvalue of the matrix scaled to unit diagonal [1]."""
    root = np.sqrt(diagonal)
    start = np.random.default_rng(1).standard_normal(len(root))
    answer = root * factor.solve(root * start)
    size = float(np.linalg.norm(answer))
    return float(np.linalg.norm(start)) / size if np.isfinite(size) else 0.0


def _refuse_null_vector(A: csc_array, K: csc_array, M: csc_array, sigma: float, labels: Sequence[str]) -> None:
    """Raise SingularSystem if the softest shape of A has neither stiffness nor mass."""
    diagonal = A.diagonal()
    nudged = _symmetric_factor(csc_array(A + diags_array(1e-13 * diagonal)))
    shape = np.random.default_rng(2).standard_normal(len(diagonal)) / np.sqrt(diagonal)
    for _ in range(3):  # inverse iteration: each step gains the ratio of the null vector to the next shape
        shape = nudged.solve(diagonal * shape)
        shape /= np.sqrt(shape @ (diagonal * shape))
    weighs = float(np.abs(shape) @ (abs(M) @ np.abs(shape)))
    massless = weighs < _MASSLESS / abs(sigma) or relative_energy(M, shape[:, None])[0] < _NOTHING
    if massless and relative_energy(K, shape[:, None])[0] < _NOTHING:
        raise _singular(int(np.argmax(np.abs(shape) * np.sqrt(diagonal))), labels)


def relative_energy(A: csc_array, shapes: Floats) -> Floats:
    """x^T A x / |x|^T |A| |x| of each column [m]: how much is left of the terms of its sum, eps if all cancel."""
    size = np.abs(shapes)
    total: Floats = (size * (abs(A) @ size)).sum(axis=0)
    energy: Floats = np.abs((shapes * (A @ shapes)).sum(axis=0))
    return np.divide(energy, total, out=np.zeros_like(energy), where=total > 0)


def _singular(index: int, labels: Sequence[str]) -> SingularSystem:
    return SingularSystem(
        labels[index] if labels else f"degree of freedom {index}",
        got="neither stiffness nor mass in a motion led by it",
        expected="an element, a spring or a mass that holds it",
        do="support it, join it, or give it a mass",
    )
