"""Symmetric factors of K - sigma M: solving with them, and counting eigenvalues below sigma."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array

from femstruct.arrays import Floats
from femstruct.errors import SingularSystem
from femstruct.sparse.patterns import Pattern, Values, aligned
from femstruct.sparse.solvers import FASTEST, SOLVERS, Analysis, Factored, ZeroPivot

# Reciprocal condition (rows and columns scaled by the diagonal) under which a matrix is looked at for a null vector.
# Sound structures reach about 1e-11 on meshes of 200 x 200; the look itself does not refuse anything.
_SUSPICIOUS = 1e-12
# A massless mechanism strains and weighs nothing but rounding: real modes have 1e-3 and more in one of the two.
_NO_ENERGY = 1e-10
# |sigma| x^T M x of a shape of x^T diag(A) x = 1: |sigma| / omega_max^2, 1e-14 and more, if it has any mass at all.
_MASSLESS = 1e-20


@dataclass(frozen=True, eq=False)
class Factor:
    """The factor of K - sigma M, sigma [rad^2/s^2] below the spectrum: `solve` takes [n] or [n, m]."""

    sigma: float
    solve: Callable[[Floats], Floats]


@dataclass(frozen=True, eq=False)
class Pencil:
    """K and M on one pattern, which is analysed once for all shifts.

    stiffness, mass [nnz] : their values on the pattern.
    """

    K: csc_array
    M: csc_array
    pattern: Pattern
    stiffness: Values
    mass: Values
    analysis: Analysis

    @classmethod
    def of(cls, K: csc_array, M: csc_array, solver: str = FASTEST) -> Pencil:
        """The pencil of K and M, with one of the SOLVERS."""
        pattern, (stiffness, mass) = aligned([K, M])
        return cls(K, M, pattern, stiffness, mass, SOLVERS[solver](pattern))

    def shifted(self, sigma: float) -> Values:
        """Values of K - sigma M on the pattern."""
        values: Values = self.stiffness - sigma * self.mass
        return values

    def count_below(self, mu: float) -> int | None:
        """Number of eigenvalues omega^2 of (K, M) below mu: the negative ones of K - mu M.

        None when the count cannot be trusted, mu being too close to an eigenvalue. Move mu then.
        """
        terms = np.abs(self.stiffness[self.pattern.diagonal]) + np.abs(mu * self.mass[self.pattern.diagonal])
        if not (terms > 0).all():
            return None
        return self.analysis.negative(self.shifted(mu), terms)


def count_below(K: csc_array, M: csc_array, mu: float, solver: str = FASTEST) -> int | None:
    """The same for two matrices."""
    return Pencil.of(K, M, solver).count_below(mu)


def factorise(pencil: Pencil, sigma: float, labels: Sequence[str] = ()) -> Factor:
    """Factor of K - sigma M for sigma < 0, positive definite unless K and M share a null vector.

    Raises SingularSystem when they do, naming the degree of freedom that moves most (its number without `labels`).
    """
    values = pencil.shifted(sigma)
    diagonal: Floats = values[pencil.pattern.diagonal]
    if not (diagonal > 0).all():
        raise _singular(int(np.argmin(diagonal)), labels)
    try:
        factor = pencil.analysis.factor(values)
    except ZeroPivot:
        _refuse_null_vector(pencil, sigma, values, labels)
        factor = pencil.analysis.factor(_nudged(pencil.pattern, values, _NO_ENERGY * 1e-5))
    else:
        if _reciprocal_condition(factor, diagonal) < _SUSPICIOUS:
            _refuse_null_vector(pencil, sigma, values, labels)
    return Factor(sigma, factor.solve)


def _nudged(pattern: Pattern, values: Values, share: float) -> Values:
    """The values with a diagonal larger by a share of itself."""
    nudged = values.copy()
    nudged[pattern.diagonal] *= 1.0 + share
    return nudged


def _reciprocal_condition(factor: Factored, diagonal: Floats) -> float:
    """Upper estimate of the smallest eigenvalue of the matrix scaled to unit diagonal [1]."""
    root = np.sqrt(diagonal)
    start = np.random.default_rng(1).standard_normal(len(root))
    answer = root * factor.solve(root * start)
    size = float(np.linalg.norm(answer))
    return float(np.linalg.norm(start)) / size if np.isfinite(size) else 0.0


def _refuse_null_vector(pencil: Pencil, sigma: float, values: Values, labels: Sequence[str]) -> None:
    """Raise SingularSystem if the softest shape of K - sigma M has neither stiffness nor mass."""
    K, M, diagonal = pencil.K, pencil.M, values[pencil.pattern.diagonal]
    nudged = pencil.analysis.factor(_nudged(pencil.pattern, values, 1e-13))
    shape = np.random.default_rng(2).standard_normal(len(diagonal)) / np.sqrt(diagonal)
    for _ in range(3):  # inverse iteration: each step gains the ratio of the null vector to the next shape
        shape = nudged.solve(diagonal * shape)
        shape /= np.sqrt(shape @ (diagonal * shape))
    weighs = float(np.abs(shape) @ (abs(M) @ np.abs(shape)))
    massless = weighs < _MASSLESS / abs(sigma) or relative_energy(M, shape[:, None])[0] < _NO_ENERGY
    if massless and relative_energy(K, shape[:, None])[0] < _NO_ENERGY:
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
