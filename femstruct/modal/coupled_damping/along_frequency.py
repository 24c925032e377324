"""Harmonic motion of modes that damping couples: one factorisation of their matrix serves the lines around it.

At each line (Omega^2 - w^2 + j (w C + D)) q = f. Around a line w0 the solution, as a function of w - w0, is followed by
the second-order Krylov space of the matrix there; the best motion in that space, and in those of the nearest lines on
either side, is taken wherever it satisfies the equation itself. Where it does not, the lines that are left are split at
their middle, down to single ones, which are solved as they are. Nothing is interpolated without a check.

Reference: Z. Bai, Y. Su, SIAM J. Sci. Comput. 26 (2005) 1692-1709, doi:10.1137/040605552, for the space.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
import scipy
from numpy.typing import NDArray
from scipy.linalg import lapack

from femstruct.arrays import Floats, Integers
from femstruct.errors import NotConverged
from femstruct.modal.coupled_damping.eigenpairs import Complex

FEWEST, MOST, EACH = 16, 60, 40  # vectors of a factorisation: one for 40 modes was the fastest from 260 to 2,400
PROVEN: Final = 1e-12  # of the force, that the equation of a line may miss: a direct solution misses 1e-14
DEPENDENT: Final = 1e-13  # of the largest of some vectors, beside which one is the sum of the others
_CHUNK: Final = 2**20  # complex numbers held at once: 16 MB


@dataclass(frozen=True, eq=False)
class CoupledModes:
    """Modes with squares of circular frequencies [k] and matrices of damping [k, k] that couple them."""

    squared: Floats
    viscous: Floats
    hysteretic: Floats

    def along(self, forces: Floats, omega: Floats) -> Iterator[tuple[Integers, Complex]]:
        """Modal coordinates under modal forces [k], the same at each omega [nf]: numbers of some lines, and theirs
        [lines, k], until all have been.

        Raises NotConverged at a line at which something without damping resonates.

        Two modes of one dashpot, of which only the first is pushed:

        >>> pair = CoupledModes(np.array([1.0, 4.0]), np.array([[0.5, 0.5], [0.5, 0.5]]), np.zeros((2, 2)))
        >>> [(lines, q)] = pair.along(np.array([1.0, 0.0]), np.array([1.0]))
        >>> bool(abs(q[0] @ [0.5j, 0.5j] - 1.0) < 1e-14), bool(abs(q[0] @ [0.5j, 3.0 + 0.5j]) < 1e-14)
        (True, True)
        """
        none = np.empty((len(self.squared), 0), dtype=np.complex128)
        todo = [(np.argsort(omega, kind="stable"), none, none)] if len(omega) else []
        if not forces.any():
            yield np.arange(len(omega)), np.zeros((len(omega), len(forces)), dtype=np.complex128)
            return
        while todo:
            lines, below, above = todo.pop()
            middle = float(omega[lines[len(lines) // 2]])
            first, around = self._around(middle, forces, omega[lines])
            here = omega[lines] == middle
            left = []
            for some, q, right in self._tried(np.hstack([around, below, above]), forces, omega, lines[~here]):
                yield some[right], q[right]
                left.append(some[~right])
            yield lines[here], np.tile(first, (int(here.sum()), 1))
            rest = np.concatenate([*left, lines[:0]])
            lower = omega[rest] < middle
            for part, outer in ((rest[~lower], (around, above)), (rest[lower], (below, around))):
                if len(part):
                    todo.append((part, *outer))

    def _around(self, middle: float, forces: Floats, lines: Floats) -> tuple[Complex, Complex]:
        """The solution [k] at a line, and the space [k, n] that follows it around there.

        Vectors are made by the recurrence of the pairs (r_j, r_j-1) of the derivatives, orthonormal as pairs.
        """
        factor, pivots, singular = lapack.zgetrf(self._matrix(middle), overwrite_a=True)
        if singular:
            raise NotConverged(
                "frequency response",
                got=f"a singular matrix at {middle / (2 * np.pi):.4g} Hz",
                do="something without damping resonates there: add damping, or move the lines",
            )
        first = lapack.zgetrs(factor, pivots, forces.astype(np.complex128))[0]
        k, reach = len(forces), max(float(np.abs(lines - middle).max()), np.finfo(float).tiny)
        space = min(max(FEWEST, k // EACH), MOST, len(lines))
        pairs = np.zeros((space, 2 * k), dtype=np.complex128)
        pairs[0, :k] = first / max(float(np.linalg.norm(first)), np.finfo(float).tiny)
        for number in range(1, len(pairs)):
            newest, before = pairs[number - 1, :k], pairs[number - 1, k:]
            slope = 1j * _times(self.viscous, newest[:, None])[:, 0] - 2.0 * middle * newest
            pushed = reach**2 * before - reach * slope
            pair = np.concatenate([lapack.zgetrs(factor, pivots, pushed)[0], newest])
            known = pairs[:number]
            for _ in range(2):  # the second time takes out what rounding left
                pair = pair - (known.conj() @ pair) @ known
            length = float(np.linalg.norm(pair))
            if not length > 0.0:
                return first, pairs[:number, :k].T
            pairs[number] = pair / length
        return first, pairs[:, :k].T

    def _matrix(self, omega: float) -> Complex:
        """That of a line [k, k]."""
        k = len(self.squared)
        whole: Complex = np.empty((k, k), dtype=np.complex128, order="F")
        whole.real, whole.imag = 0.0, omega * self.viscous + self.hysteretic
        whole[np.diag_indices(k)] += self.squared - omega**2
        return whole

    def _tried(
        self, vectors: Complex, forces: Floats, omega: Floats, lines: Integers
    ) -> Iterator[tuple[Integers, Complex, NDArray[np.bool_]]]:
        """The best motion in a space at some lines, and whether it satisfies the equation there."""
        space = _orthonormal(vectors)
        lossless = self.squared[:, None] * space + 1j * _times(self.hysteretic, space)
        slopes = 1j * _times(self.viscous, space)
        count, turned = space.shape[1], space.conj().T
        small, small_slopes, pushed = turned @ lossless, turned @ slopes, turned @ forces
        along = np.hstack([lossless, slopes, space]).T
        step = max(1, _CHUNK // max(len(forces), count**2))
        for start in range(0, len(lines), step):
            some = lines[start : start + step]
            w = omega[some][:, None]
            whole = small + w[:, :, None] * small_slopes - w[:, :, None] ** 2 * np.eye(count)
            c = np.linalg.solve(whole, np.broadcast_to(pushed[:, None], (len(some), count, 1)))[:, :, 0]
            missed = np.linalg.norm(np.hstack([c, w * c, -(w**2) * c]) @ along - forces, axis=1)
            yield some, c @ space.T, missed <= PROVEN * np.linalg.norm(forces)


def _times(matrix: Floats, columns: Complex) -> Complex:
    """The product of a real matrix, of which no complex copy is made."""
    return np.asarray(matrix @ columns.real + 1j * (matrix @ columns.imag), dtype=np.complex128)


def _orthonormal(vectors: Complex) -> Complex:
    """Orthonormal columns [k, n] with the span of some."""
    length = np.linalg.norm(vectors, axis=0)
    columns, size, _ = scipy.linalg.qr(
        vectors[:, length > 0.0] / length[length > 0.0], mode="economic", pivoting=True, check_finite=False
    )
    own = np.abs(np.diag(size))
    kept: Complex = columns[:, own > DEPENDENT * own[0]]
    return kept
