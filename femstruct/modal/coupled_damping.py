"""Harmonic motion of modes that damping couples: one factorisation of their matrix serves the lines around it.

At each line (Omega^2 - w^2 + j (w C + D)) q = f. Around a line w0 the solution, as a function of w - w0, is
followed by the second-order Krylov space of the matrix there; the best motion in that space, and in those of the
nearest lines on either side, is taken wherever it satisfies the equation itself. Where it does not, the lines that
are left are split at their middle, down to single ones, which are solved as they are. Nothing is interpolated
without a check.

Reference: Z. Bai, Y. Su, SIAM J. Sci. Comput. 26 (2005) 1692-1709, doi:10.1137/040605552, for the space.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray
from scipy.linalg import lapack

from femstruct.arrays import Floats, Integers
from femstruct.errors import NotConverged
from femstruct.modal.basis import ModalBasis
from femstruct.modal.oscillators import Complex, Oscillators, oscillators_of

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


# ----------------------------------------------------------------------------------------------------------------------
# Modes of a basis whose damping couples them: what rings, how fast and how long.
# ----------------------------------------------------------------------------------------------------------------------


class DampedModes(NamedTuple):
    """Modes that swing: |eigenvalue| / 2 pi [m] [Hz], damping ratios [m], below 1, and effective masses [3, m] [kg]
    along x, y, z, as far as places move in step."""

    frequency_hz: Floats
    damping_ratio: Floats
    modal_mass: Floats


def damped_modes(basis: ModalBasis) -> DampedModes | None:
    """The modes of structure, air and wool together that swing, ascending, up to where no mode is missing; None where
    damping couples no modes.

    Wool couples modes so strongly that the diagonal of the damping matrix is not the damping of any motion: a ceiling
    over wool rings with some per cent where its diagonal is above 100 %. What creeps back without swinging is left out.

    >>> from femstruct.modal.closed_form import given_modes
    >>> basis, _ = given_modes([20.0, 50.0], [0.02, 0.03], {"P": [0.5, -0.4]})
    >>> damped_modes(basis) is None
    True
    """
    found = oscillators_of(basis)
    if found is None:
        return None
    swings = (found.damping < 2.0 * found.omega) & (found.omega <= 2.0 * np.pi * basis.complete_below_hz)
    numbers = np.flatnonzero(swings)
    numbers = numbers[np.argsort(found.omega[numbers], kind="stable")]
    omega = found.omega[numbers]
    taken = (basis.momentum @ found.places)[:, numbers] * (found.drives @ basis.momentum.T).T[:, numbers]
    return DampedModes(omega / (2.0 * np.pi), found.damping[numbers] / (2.0 * omega), taken)


# ----------------------------------------------------------------------------------------------------------------------
# Energies of modes that damping couples, of many states at once, from where their oscillators are.
# ----------------------------------------------------------------------------------------------------------------------

AT_ONCE: Final = 32  # states, one after the other: those that have about as many oscillators in motion
SEEN: Final = 1e-15  # of the root of an energy: an oscillator that has less of it is lost in rounding
ALIKE: Final = 1e4  # times an energy: where oscillators have more, against each other, it is summed by its roots


def energies_of_states(found: Oscillators, z: Floats, v: Floats, scale: float) -> tuple[Floats, Floats]:
    """Energy of states z, v [s, k] of oscillators, and by how much more than that free motion would lose, or would at
    most [s] [J].

    Parameters
    ----------
    scale : float
        An energy that none of the states exceeds by far; what is lost in its rounding is left out [J].

    Notes
    -----
    Oscillators are in the order of how long they ring: some time after a blow the first few have all of the energy.
    A form of the state loses what large motions against each other cancel, as of oscillators of almost one shape:
    there the energy is the sum of its squares.

    Examples
    --------
    >>> from femstruct.modal.oscillators import oscillators
    >>> found = oscillators(np.array([10.0, 20.0]), np.array([[60.0, 30.0], [30.0, 60.0]]))
    >>> z, v = found.kicks @ [[0.6], [0.8]], found.drives @ [[0.6], [0.8]]
    >>> held, surplus = energies_of_states(found, z.T, v.T, 0.5)
    >>> round(float(held[0]), 12), bool(abs(surplus[0]) < 1e-12)
    (0.5, True)
    """
    k, size = z.shape[1], np.sqrt(np.diag(found.gram))
    held, surplus, doubtful = np.zeros(len(z)), np.zeros(len(z)), np.zeros(len(z), dtype=bool)
    for first in range(0, len(z), AT_ONCE):
        some = slice(first, first + AT_ONCE)
        parts = size[:k] * np.abs(z[some]).max(axis=0) + size[k:] * np.abs(v[some]).max(axis=0)
        ring = parts[: found.ringing]
        left = np.cumsum(ring[::-1])[::-1]  # what an oscillator that rings and those behind it have at most
        m = int((left > SEEN * np.sqrt(2.0 * scale)).sum())
        moving = [slice(at, at + size) for at, size in ((0, m), (found.ringing, k - found.ringing)) if size]
        moving = [slice(one.start + at, one.stop + at) for at in (0, k) for one in moving]
        states = np.hstack([z[some], v[some]])
        held[some] = _half(found.gram, states, moving)
        if found.surplus.size:
            surplus[some] = _half(found.surplus, states, moving)
        else:
            surplus[some] = 0.5 * (states**2 @ found.misses**2)
        doubtful[some] = parts.sum() ** 2 > ALIKE * scale
    if doubtful.any():
        x, y = z[doubtful].T, v[doubtful].T
        stored = (found.modes[:, None] * (found.places @ x + found.tilts @ y)) ** 2
        held[doubtful] = 0.5 * (stored + (found.swings @ x + found.rates @ y) ** 2).sum(axis=0)
    return held, surplus


def _half(form: Floats, states: Floats, moving: list[slice]) -> Floats:
    """y . form y / 2 of states y [s, 2 k], of which only these parts move; form [2 k, 2 k], symmetric."""
    total = np.zeros(len(states))
    for number, one in enumerate(moving):
        pushed = states[:, one] @ form[one, one]
        for other in moving[number + 1 :]:
            pushed += 2.0 * (states[:, other] @ form[other, one])
        total += (states[:, one] * pushed).sum(axis=1)
    return 0.5 * total
