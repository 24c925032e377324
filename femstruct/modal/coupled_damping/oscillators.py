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
import scipy
from scipy.sparse import csr_array

from femstruct.arrays import Floats, Integers
from femstruct.errors import NotConverged
from femstruct.modal.coupled_damping.eigenpairs import Complex, eigenpairs
from femstruct.modal.coupled_damping.oscillator_set import Oscillators, in_order

APART: Final = 1e-14  # of the root of both their own damping: what couples two modes less than that is rounding
FREE: Final = 1e-13  # of the largest damping of modes without stiffness: one that is held by less is free
UNDAMPED: Final = 1e-12  # of a frequency: a rate below zero that is rounding
PROVEN: Final = 1e-9  # of what the oscillators miss of damping and stiffness: a thousandth of what a ledger may miss
ADDED: Final = (0.0, 1e-12, 1e-10, 1e-9, 1e-8)  # shares of the damping that are added, until the residual is proven


def oscillators(omega: Floats, damping: Floats, resting: bool = True) -> Oscillators:
    """The oscillators of modes of these circular frequencies [k] [rad/s] and this damping matrix [k, k] [rad/s].

    Modes that the matrix does not couple stay what they are. resting : whether anybody asks where modes without
    stiffness are. Where nobody does there is an oscillator less for every two of them, and they are told from where
    they come to rest in the end.

    Raises NotConverged where no pairs are found whose residual is below 1e-9.

    Two modes of one dashpot: it stops what it moves at once, and lets both ring together without it.

    >>> pair = oscillators(np.array([10.0, 20.0]), np.array([[60.0, 30.0], [30.0, 60.0]]))
    >>> bool(pair.residual < 1e-12), (pair.damping > 2.0 * pair.omega).tolist()
    (True, [True, False])
    """
    still = np.flatnonzero(omega == 0.0)
    turn, whole = _apart(still, damping)
    k, size = len(omega), np.sqrt(np.abs(np.diag(whole)))
    linked = np.abs(whole) > APART * np.outer(size, size)
    np.fill_diagonal(linked, False)
    count, group = scipy.sparse.csgraph.connected_components(csr_array(linked.astype(np.int8)), directed=False)
    groups = [np.flatnonzero(group == number) for number in range(count)]
    coupled = [one for one in groups if len(one) > 1]
    own = np.array([one[0] for one in groups if len(one) == 1], dtype=np.int64)
    whole = np.where(linked, whole, 0.0) + np.diag(np.diag(whole))
    w, c = [omega[own]], [np.diag(whole)[own]]
    places, tilts, kicks, drives = (np.zeros((k, k)) for _ in range(4))
    m, residual, added = len(own), 0.0, 0.0
    places[own, np.arange(m)] = drives[np.arange(m), own] = 1.0
    for some in coupled:
        here = np.ix_(some, some)
        found, lossy, share = _proven(omega[some], whole[here], resting)
        whole[here] = lossy
        w, c = [*w, found.omega], [*c, found.damping]
        theirs = np.arange(m, m + len(found.omega))
        m += len(theirs)
        places[np.ix_(some, theirs)], tilts[np.ix_(some, theirs)] = found.places, found.tilts
        kicks[np.ix_(theirs, some)], drives[np.ix_(theirs, some)] = found.kicks, found.drives
        residual, added = max(residual, found.residual), max(added, share)
    places, tilts = turn @ places[:, :m], turn @ tilts[:, :m]
    kicks, drives, whole = kicks[:m] @ turn.T, drives[:m] @ turn.T, turn @ whole @ turn.T
    return in_order(omega, np.concatenate(w), np.concatenate(c), (places, tilts, kicks, drives), whole, residual, added)


def _apart(still: Integers, damping: Floats) -> tuple[Floats, Floats]:
    """Modes without stiffness turned so that their damping couples none of them to another; and the damping so turned.

    One that no damping holds then stands by itself: it would be a double root of zero.
    """
    turn = np.eye(len(damping))
    if not still.size or not (damping[still] - np.diag(np.diag(damping))[still]).any():
        return turn, damping
    rates, turn[np.ix_(still, still)] = np.linalg.eigh(damping[np.ix_(still, still)])
    whole = turn.T @ damping @ turn
    whole[np.ix_(still, still)] = np.diag(rates)
    free = still[rates <= FREE * max(float(rates.max()), 0.0)]
    whole[free, :] = whole[:, free] = 0.0
    return turn, whole


def _proven(omega: Floats, damping: Floats, resting: bool) -> tuple[_Group, Floats, float]:
    """Oscillators of modes that are all coupled, with the least that must be added to their damping; the damping they
    have, and the share that was added."""
    for share in ADDED:
        lossy = damping + _more(damping, share)
        found = _of_group(omega, lossy, resting)
        if found is not None:
            return found, lossy, share
    raise NotConverged(
        "modes coupled by damping",
        got=f"no complex modes of {len(omega)} modes from {omega.min() / 2 / np.pi:.4g} Hz on",
        expected=f"a residual below {PROVEN:g}",
        do="check the damping of these modes",
    )


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


def _of_group(omega: Floats, damping: Floats, resting: bool) -> _Group | None:
    """Oscillators of modes that are coupled; None where they do not satisfy the equation of motion.

    Where nobody asks where modes without stiffness rest, an even number of these displacements is left out, with the
    eigenvalues zero whose shapes they are by themselves: nothing else depends on them.
    """
    still = np.flatnonzero(omega == 0.0)
    out = 0 if resting else len(still) - len(still) % 2
    told = np.delete(np.arange(len(omega)), still[:out])
    k, largest = len(omega), max(float(omega.max(initial=0.0)), float(np.abs(damping).max()))
    scale = np.where(omega > 0.0, omega, largest)
    try:
        values, shapes = eigenpairs(omega, damping)
        values, shapes = values[out:], shapes[:, out:]
        first, second = _pairs(values, shapes, damping, alike=out == 0)
        w, c, places, tilts = _oscillators_of(values, shapes, first, second)
        swings, rates = -tilts * w**2, places - tilts * c
        widths = np.concatenate([1.0 / np.where(w > 0.0, w, largest), np.ones(len(w))])
        still_told = np.hstack([scale[told, None] * places[told], scale[told, None] * tilts[told]])
        motion = np.vstack([still_told, np.hstack([swings, rates])]) * widths
        inverse = widths[:, None] * np.linalg.inv(motion)
    except np.linalg.LinAlgError:
        return None
    m, n = len(w), len(told)
    kicks, drives = inverse[:m, n:], inverse[m:, n:]
    moved = np.hstack([-rates * w**2, swings - rates * c])  # accelerations of free motion
    missed = moved @ inverse
    missed[:, n:] += damping
    missed[told, np.arange(n)] += omega[told] ** 2 / scale[told]
    paces = np.sqrt(omega + np.maximum(np.diag(damping), 0.0))
    miss = np.abs(missed) / np.outer(paces, np.concatenate([paces[told], paces]))
    stays = scale[told, None] * (places[told] @ kicks + tilts[told] @ drives)
    starts = swings @ kicks + rates @ drives - np.eye(k)
    worst = float(max(miss.max(), np.abs(stays).max(), np.abs(starts).max()))
    return _Group(w, c, places, tilts, kicks, drives, worst) if worst < PROVEN else None


def _pairs(values: Complex, shapes: Complex, damping: Floats, alike: bool) -> tuple[Integers, Integers]:
    """Numbers of the eigenvalues of each pair, ascending by the product: complex ones with their conjugates; of real
    ones those with phi (2 lambda + C) phi > 0, the slow root of a mode by itself, with the same number of those below
    zero, with which they have most of their shape in common. Not `alike`: the slower half of them with the faster, so
    that those of a pair are far apart."""
    real = values.imag == 0.0
    upper, lower = np.flatnonzero(values.imag > 0.0), np.flatnonzero(values.imag < 0.0)
    upper = upper[np.lexsort((values[upper].real, values[upper].imag))]
    lower = lower[np.lexsort((values[lower].real, -values[lower].imag))]
    alone = np.flatnonzero(real)
    if len(alone) % 2 or len(upper) != len(lower):
        raise np.linalg.LinAlgError("eigenvalues without partners")
    half = len(alone) // 2
    if not alike:
        alone = alone[np.argsort(-values[alone].real, kind="stable")]
        return _ascending(values, np.append(upper, alone[:half]), np.append(lower, alone[half:]))
    own = shapes[:, alone].real
    own = own / np.linalg.norm(own, axis=0)
    kind = 2.0 * values[alone].real + (own * (damping @ own)).sum(axis=0)
    order = np.argsort(-kind, kind="stable")
    slow, fast = order[:half], order[half:]
    slow_at, fast_at = scipy.optimize.linear_sum_assignment(-np.abs(own[:, slow].T @ own[:, fast]))
    return _ascending(values, np.append(upper, alone[slow[slow_at]]), np.append(lower, alone[fast[fast_at]]))


def _ascending(values: Complex, first: Integers, second: Integers) -> tuple[Integers, Integers]:
    """Pairs of eigenvalues by their product."""
    order = np.argsort(np.abs(values[first] * values[second]), kind="stable")
    return first[order], second[order]


def _oscillators_of(
    values: Complex, shapes: Complex, first: Integers, second: Integers
) -> tuple[Floats, Floats, Floats, Floats]:
    """(w, c, places, tilts) of pairs of eigenvalues. With kappa = (lambda - mu)^-1/2 a mode that nothing couples has
    its own shape as its place and no tilt."""
    one, two = values[first], values[second]
    conjugate = one.imag != 0.0
    w = np.where(conjugate, np.abs(one), np.sqrt(np.abs(one.real * two.real)))
    c = np.where(conjugate, -2.0 * one.real, -(one.real + two.real))
    c = np.where(np.abs(c) <= UNDAMPED * w, np.maximum(c, 0.0), c)
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
