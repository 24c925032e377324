"""Modes that damping couples, as oscillators that do not know each other: each pair of complex modes is one.

q'' + C q' + Omega^2 q = u has 2 k eigenvalues lambda with shapes phi. Any two of them, a complex pair or two real ones,
are the roots of an oscillator z'' + c z' + w^2 z, c = -(lambda + mu), w^2 = lambda mu. With its two numbers z and v

    z' = v + kick . u,    v' = -w^2 z - c v + drive . u,    q = places z + tilts v,    q' = q's derivative,

so that what moves one mode exactly moves the structure exactly, overdamped or not, at the cost of modes that nothing
couples. A double root needs nothing special, as long as it is in one pair. Where eigenvalues of several pairs coincide
and their shapes with them (a defective matrix), a part of 1e-12 to 1e-8 of the damping is added, other for each mode:
the matrix is diagonalisable then, and its motion differs by that part.

References: F. Tisseur, K. Meerbergen, SIAM Review 43 (2001) 235-286, doi:10.1137/S0036144500381988, for the eigenvalue
problem. E. B. Davies, SIAM J. Matrix Anal. Appl. 29 (2007) 1051-1064, doi:10.1137/060659909, for the added part.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, eig
from scipy.optimize import linear_sum_assignment
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from femstruct.arrays import Floats, Integers
from femstruct.errors import NotConverged
from femstruct.modal.coupled_damping.loss_form import loss_form
from femstruct.modal.coupled_damping.refinement import refined

Complex = NDArray[np.complex128]
APART: Final = 1e-14  # of the root of both their own damping: what couples two modes less than that is rounding
REAL: Final = 1e-12  # of an eigenvalue: what is imaginary of one that is real
PROVEN: Final = 1e-9  # residual of the oscillators in the equation of motion: a thousandth of what a ledger may miss
ADDED: Final = (0.0, 1e-12, 1e-10, 1e-9, 1e-8)  # shares of the damping that are added, until the residual is proven
PARTS_AT_MOST: Final = 1e-7  # by which the loss form may differ from the energy: a tenth of what a ledger may miss


@dataclass(frozen=True, eq=False)
class Oscillators:
    """Oscillators in place of k modes that damping couples; rates are in rad/s.

    omega, damping [k] : w and c of each. places, tilts [k, k] : q = places z + tilts v; swings, rates [k, k] : q' =
    swings z + rates v. kicks, drives [k, k] : z' = v + kicks u, v' = -w^2 z - c v + drives u under modal forces u.
    energy [2 k, 2 k] : rows of root-energies, E = |energy y|^2 / 2 for y = [z, v]. losses [2 k, 2 k] : symmetric, by
    the damping alone: free motion loses y . losses y / 2 from now on.
    residual : of the equation of motion, relative to its terms [1]. added : share of the damping that was added [1].
    """

    omega: Floats
    damping: Floats
    places: Floats
    tilts: Floats
    swings: Floats
    rates: Floats
    kicks: Floats
    drives: Floats
    energy: Floats
    losses: Floats
    residual: float
    added: float


def oscillators(omega: Floats, damping: Floats) -> Oscillators:
    """The oscillators of modes of these circular frequencies [k] [rad/s] and this damping matrix [k, k] [rad/s].

    Modes that the matrix does not couple stay what they are, in their places.

    Raises NotConverged where no pairs are found whose residual is below 1e-9.

    Two modes of one dashpot, which stops both before they swing once:

    >>> pair = oscillators(np.array([10.0, 20.0]), np.array([[60.0, 30.0], [30.0, 60.0]]))
    >>> bool(pair.residual < 1e-12), bool((pair.damping > 2.0 * pair.omega).all())
    (True, True)
    """
    k = len(omega)
    root = np.sqrt(np.abs(np.diag(damping)))
    linked = np.abs(damping) > APART * np.outer(root, root)
    np.fill_diagonal(linked, False)
    count, group = connected_components(csr_array(linked), directed=False)
    groups = [np.flatnonzero(group == number) for number in range(count)]
    coupled = [one for one in groups if len(one) > 1]
    own = np.setdiff1d(np.arange(k), np.concatenate(coupled) if coupled else np.array([], dtype=np.int64))
    w, c = omega.copy(), np.diag(damping).copy()
    places, tilts, kicks, drives = (np.zeros((k, k)) for _ in range(4))
    places[own, own] = drives[own, own] = 1.0
    residual, added = 0.0, 0.0
    whole = np.where(linked, damping, 0.0) + np.diag(c)
    for some in coupled:
        here = np.ix_(some, some)
        for share in ADDED:
            lossy = whole[here] + _more(whole[here], share)
            found = _of_group(omega[some], lossy)
            if found is not None:
                break
        else:
            raise NotConverged(
                "modes coupled by damping",
                got=f"no complex modes of {len(some)} modes from {omega[some].min() / 2 / np.pi:.4g} Hz on",
                expected=f"a residual below {PROVEN:g}",
                do="check the damping of these modes",
            )
        whole[here] = lossy
        w[some], c[some] = found.omega, found.damping
        places[here], tilts[here], kicks[here], drives[here] = found.places, found.tilts, found.kicks, found.drives
        residual, added = max(residual, found.residual), max(added, share)
    swings, rates = -tilts * w**2, places - tilts * c
    energy = np.block([[omega[:, None] * places, omega[:, None] * tilts], [swings, rates]])
    losses = loss_form(w, c, np.hstack([swings, rates]), whole, energy.T @ energy)
    return Oscillators(w, c, places, tilts, swings, rates, kicks, drives, energy, losses, residual, added)


@dataclass(frozen=True, eq=False)
class _Group:
    omega: Floats
    damping: Floats
    places: Floats
    tilts: Floats
    kicks: Floats
    drives: Floats
    residual: float


def _more(damping: Floats, share: float) -> Floats:
    """What is added to a damping matrix: positive, on the diagonal, other for each mode and always the same."""
    size = np.abs(np.diag(damping))
    spread = np.random.default_rng(3).uniform(0.5, 1.5, len(size))
    more: Floats = np.diag(share * spread * np.maximum(size, size.mean()))
    return more


def _of_group(omega: Floats, damping: Floats) -> _Group | None:
    """Oscillators of modes that are coupled; None where they do not satisfy the equation of motion."""
    k = len(omega)
    scale = np.where(omega > 0.0, omega, max(float(omega.max(initial=0.0)), float(np.abs(damping).max())))
    state = np.block([[np.zeros((k, k)), np.diag(scale)], [-np.diag(omega**2 / scale), -damping]])
    try:
        values, vectors = refined(*eig(state, check_finite=False), scale, omega, damping)
        shapes = vectors[:k] / scale[:, None]
        first, second = _pairs(values, shapes)
        w, c, places, tilts = _oscillators_of(values, shapes, first, second)
        swings, rates = -tilts * w**2, places - tilts * c
        widths = np.concatenate([1.0 / np.maximum(w, 1e-3 * scale.min()), np.ones(k)])
        motion = np.block([[scale[:, None] * places, scale[:, None] * tilts], [swings, rates]]) * widths
        inputs = widths[:, None] * np.linalg.solve(motion, np.vstack([np.zeros((k, k)), np.eye(k)]))
    except (LinAlgError, np.linalg.LinAlgError):
        return None
    kicks, drives = inputs[:k], inputs[k:]
    miss = _residual(omega, damping, (w, c, places, tilts, swings, rates), kicks, drives, scale)
    if not miss < PROVEN:
        return None
    return _Group(w, c, places, tilts, kicks, drives, miss)


def _pairs(values: Complex, shapes: Complex) -> tuple[Integers, Integers]:
    """Numbers of the eigenvalues of each pair, ascending by the product: complex ones with their conjugates, slow real
    ones with the fast ones whose shape is most like theirs."""
    real = np.abs(values.imag) <= REAL * np.abs(values)
    upper = np.flatnonzero(~real & (values.imag > 0.0))
    lower = np.flatnonzero(~real & (values.imag < 0.0))
    lower = lower[np.lexsort((values[lower].real, -values[lower].imag))]
    upper = upper[np.lexsort((values[upper].real, values[upper].imag))]
    alone = np.flatnonzero(real)
    alone = alone[np.argsort(np.abs(values[alone]), kind="stable")]
    if len(alone) % 2 or len(upper) != len(lower):
        raise LinAlgError("eigenvalues without partners")
    slow, fast = alone[: len(alone) // 2], alone[len(alone) // 2 :]
    unit = [part / np.linalg.norm(part, axis=0) for part in (shapes[:, slow].real, shapes[:, fast].real)]
    slow_at, fast_at = linear_sum_assignment(-np.abs(unit[0].T @ unit[1]))
    first = np.concatenate([upper, slow[slow_at]])
    second = np.concatenate([lower, fast[fast_at]])
    order = np.argsort(np.abs(values[first] * values[second]), kind="stable")
    return first[order], second[order]


def _oscillators_of(
    values: Complex, shapes: Complex, first: Integers, second: Integers
) -> tuple[Floats, Floats, Floats, Floats]:
    """(w, c, places, tilts) of pairs of eigenvalues. With kappa = (lambda - mu)^-1/2 a mode that nothing couples has
    its own shape as its place and no tilt."""
    one, two = values[first], values[second]
    conjugate = np.abs(one.imag) > REAL * np.abs(one)
    w = np.where(conjugate, np.abs(one), np.sqrt(np.abs(one.real * two.real)))
    c = np.where(conjugate, -2.0 * one.real, -(one.real + two.real))
    c = np.where(np.abs(c) <= REAL * w, np.maximum(c, 0.0), c)
    size = np.maximum(np.abs(one), np.abs(two))
    turned = _in_phase(shapes[:, first])
    partner = np.where(conjugate, turned.conj(), shapes[:, second].real)
    like = np.sign((turned.real * partner.real).sum(axis=0))
    length = np.linalg.norm(partner, axis=0)
    partner = partner * np.where(conjugate, 1.0, np.where(like == 0.0, 1.0, like) / length)
    apart = np.where(np.abs(one - two) > np.finfo(float).tiny, one - two, size)
    tilts = ((turned - partner) / apart).real
    places = ((one * partner - two * turned) / apart).real
    return w, c, places, tilts


def _in_phase(shapes: Complex) -> Complex:
    """Shapes of length 1 whose parts move in step as far as they can: the real part is as large as it can be."""
    squared = (shapes**2).sum(axis=0)
    turn = np.where(np.abs(squared) > 0.0, np.sqrt(np.conj(squared)), 1.0)
    turned = shapes * (turn / np.abs(turn))
    unit: Complex = turned / np.linalg.norm(turned, axis=0)
    return unit


def _residual(
    omega: Floats,
    damping: Floats,
    moves: tuple[Floats, Floats, Floats, Floats, Floats, Floats],
    kicks: Floats,
    drives: Floats,
    scale: Floats,
) -> float:
    """What the oscillators miss: of the equation of motion in free vibration, and of what a force does at once."""
    w, c, places, tilts, swings, rates = moves
    worst = 0.0
    for acceleration, speed, place in ((-rates * w**2, swings, places), (swings - rates * c, rates, tilts)):
        terms = (acceleration, damping @ speed, omega[:, None] ** 2 * place)
        size = sum(np.linalg.norm(term, axis=0) for term in terms)
        left = np.linalg.norm(sum(terms), axis=0)
        worst = max(worst, float(np.divide(left, size, out=np.zeros_like(left), where=size > 0.0).max()))
    stays = scale[:, None] * (places @ kicks + tilts @ drives)
    starts = swings @ kicks + rates @ drives - np.eye(len(omega))
    return max(worst, float(np.abs(stays).max()), float(np.abs(starts).max()))
