"""Modes that damping couples, as oscillators that do not know each other: each pair of complex modes is one.

q'' + C q' + Omega^2 q = u has 2 k eigenvalues lambda with shapes phi. Any two of them, a complex pair or two real
ones, are the roots of an oscillator z'' + c z' + w^2 z, c = -(lambda + mu), w^2 = lambda mu. With its two numbers z
and v

    z' = v + kick . u,    v' = -w^2 z - c v + drive . u,    q = places z + tilts v,    q' = q's derivative,

so that what moves one mode exactly moves the structure exactly, overdamped or not, at the cost of modes that
nothing couples. A double root needs nothing special, as long as it is in one pair. Where eigenvalues of several
pairs coincide and their shapes with them (a defective matrix), a part of 1e-12 to 1e-8 of the damping is added,
other for each mode: the matrix is diagonalisable then, and its motion differs by that part.

References: F. Tisseur, K. Meerbergen, SIAM Review 43 (2001) 235-286, doi:10.1137/S0036144500381988, for the
eigenvalue problem. E. B. Davies, SIAM J. Matrix Anal. Appl. 29 (2007) 1051-1064, doi:10.1137/060659909, for the
added part.
"""

from __future__ import annotations

import hashlib
from collections import OrderedDict
from dataclasses import dataclass, replace
from threading import Lock
from typing import Final
from weakref import WeakKeyDictionary

import numpy as np
import scipy
from numpy.typing import NDArray
from scipy.sparse import csr_array

from femstruct.arrays import Floats, Integers
from femstruct.errors import NotConverged
from femstruct.modal.basis import ModalBasis

# ----------------------------------------------------------------------------------------------------------------------
# Eigenvalues and shapes of q'' + C q' + Omega^2 q = 0, to the rounding of each equation.
# ----------------------------------------------------------------------------------------------------------------------

Complex = NDArray[np.complex128]
NEAR: Final = 1e-3  # a first-order change of a vector by more than that is none: its eigenvalue is a multiple one
REAL: Final = 1e-13  # of an eigenvalue: what is imaginary of one that is real


def eigenpairs(omega: Floats, damping: Floats) -> tuple[Complex, Complex]:
    """All eigenvalues [2 k] [1/s] and shapes [k, 2 k] of modes with this damping; complex ones are exact conjugates.

    Parameters
    ----------
    omega : Floats [k]
        Circular frequencies [rad/s]. Those that are zero must have damping of their own: their displacements act on
        nothing, and are the shapes of as many eigenvalues zero, exactly.
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

    Parameters
    ----------
    omega : Floats [k]
        Circular frequencies [rad/s], m of them not zero.
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


# ----------------------------------------------------------------------------------------------------------------------
# What free motion of oscillators loses from now on, from the damping matrix alone.
# ----------------------------------------------------------------------------------------------------------------------

LOSSLESS: Final = 1e-18  # of the squares of both frequencies: a pair that loses nothing that could be integrated
ROUNDING: Final = 2e-16  # of the terms that a number is summed from
KNOWN: Final = 1e-10  # of the energies of a pair: what rounding may leave unknown of what it loses


def loss_form(omega: Floats, damping: Floats, taken: Floats) -> tuple[Floats, Floats]:
    """The form S of the state y = [z, v] of oscillators, free motion loses y . S y / 2 from now on; and its rounding.

    Parameters
    ----------
    omega, damping : Floats [k]
        W, c of z'' + c z' + w^2 z = 0.
    taken : Floats [2 k, 2 k]
        W, the power y . W y / 2 of all damping. The rounding [2 k, 2 k] is infinite for pairs that lose nothing.

    Notes
    -----
    S is the integral of exp(B t)^T W exp(B t) over all times, and the solution of B^T S + S B = -W: for each two
    oscillators four equations, solved here by hand. The determinant is (u^2 - w^2)^2 + (c + g)(c u^2 + g w^2), a sum of
    positive terms. Masses and stiffnesses do not enter: that S is the energy is what a balance can be checked by.

    Examples
    --------
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

    Zero where it is lost in rounding: for a rate of 1e9 1/s beside one of 1 1/s, and for oscillators of almost one
    shape, which carry large motions against each other.

    Parameters
    ----------
    speeds : Floats [m, 2 k]
        Q' = speeds y.
    matrix : Floats [m, m]
        Damping, which takes q' . matrix q'.
    gram : Floats [2 k, 2 k]
        The energy is y . gram y / 2.
    reach : Floats [k]
        How much larger the energy of an oscillator may be than that of all of them.
    """
    k = len(omega)
    form, noise = loss_form(omega, damping, 2.0 * (speeds.T @ (matrix @ speeds)))
    root = np.sqrt(np.diag(gram)) / np.tile(np.maximum(reach, 1.0), 2)
    known = (noise <= KNOWN * np.outer(root, root)).reshape(2, k, 2, k).all(axis=(0, 2))
    surplus = np.where(np.tile(known, (2, 2)), form - gram, 0.0)
    symmetric: Floats = 0.5 * (surplus + surplus.T)
    return symmetric


# ----------------------------------------------------------------------------------------------------------------------
# What creeps back without swinging, under given forces: many exponentials as sums of few.
#
# Wool has hundreds of real eigenvalues, many of them almost equal. Under one force each of them is an exponential, and
# any exponential whose rate is in some range is a sum of a dozen or two with fixed rates there, to 1e-11: they stand
# for hundreds, once for every force. The weights are fitted so that values and derivatives agree at all times.
# ----------------------------------------------------------------------------------------------------------------------

RATES_APART: Final = 4.0  # ratio of two rates, one after the other, from which they are of different clusters
CRITICAL: Final = 1e-2  # of a rate: an oscillator whose two are closer is left as it is
FITTED: Final = 1e-11  # of an exponential, and of its derivative over the fastest rate: what the sum may miss
MOST: Final = 36  # exponentials of a cluster
SPAN: Final = 20.0  # ratio of the rates of a cluster, at most: wider sums would be badly conditioned
WORTH: Final = 3  # exponentials that one must stand for
WIDER: Final = 1.25  # rates of the sum reach beyond those of the cluster: they must not be equal
TIMES: Final = 160  # at which exponentials are compared


@dataclass(frozen=True, eq=False)
class Relaxing:
    """Oscillators that creep, and sums of exponentials for them.

    number : the last so many oscillators are meant. rates [2, n] : of their slower and faster parts, below zero.
    nodes [p] : rates of the sums, below zero; an even number. weights [2, n, p] : exp(rate t) = weights . exp(nodes t).
    """

    number: int
    rates: Floats
    nodes: Floats
    weights: Floats


def relaxing_of(omega: Floats, damping: Floats) -> tuple[Integers, Relaxing | None]:
    """Which oscillators creep and are so many that few exponentials stand for them, and those; None without any."""
    half = 0.5 * damping
    swing = np.sqrt(np.maximum(half**2 - omega**2, 0.0))
    some = np.flatnonzero((omega > 0.0) & (swing > CRITICAL * half))
    fast = half[some] + swing[some]
    rates = np.concatenate([omega[some] ** 2 / fast, fast])
    order = np.argsort(rates, kind="stable")
    cuts = np.flatnonzero(rates[order][1:] > RATES_APART * rates[order][:-1]) + 1
    merged = np.zeros(len(rates), dtype=bool)
    fits = []
    for cluster in (part for whole in np.split(order, cuts) for part in _narrow(rates, whole)):
        fit = _fit(rates[cluster])
        if fit is not None:
            merged[cluster] = True
            fits.append((cluster, *fit))
    both = merged.reshape(2, -1).all(axis=0)
    if not both.any():
        return some[:0], None
    nodes = np.concatenate([one for _, one, _ in fits])
    weights = np.zeros((len(rates), len(nodes)))
    at = 0
    for cluster, own, sums in fits:
        weights[cluster, at : at + len(own)] = sums
        at += len(own)
    rising = np.argsort(nodes, kind="stable")
    weights = weights.reshape(2, len(some), -1)[:, both][:, :, rising]
    return some[both], Relaxing(int(both.sum()), -rates.reshape(2, -1)[:, both], -nodes[rising], weights)


def _narrow(rates: Floats, cluster: Integers) -> list[Integers]:
    """A cluster, ascending, in parts of a bounded span."""
    if not len(cluster):
        return []
    low, high = rates[cluster[[0, -1]]]
    count = int(np.ceil(np.log(high / low) / np.log(SPAN))) or 1
    return np.split(cluster, np.searchsorted(rates[cluster], low * (high / low) ** (np.arange(1, count) / count)))


def _fit(rates: Floats) -> tuple[Floats, Floats] | None:
    """Rates [p] of a sum of exponentials and its weights [n, p] for each of these [n] [1/s]; None where that takes more
    of them than it is worth."""
    if len(rates) < 2 * WORTH:
        return None
    low, high = rates.min() / WIDER, rates.max() * WIDER
    t = np.append(0.0, np.geomspace(1e-3 / high, 40.0 / low, TIMES))
    truth = np.exp(-t[:, None] * rates)
    truth = np.vstack([truth, truth * (rates / high)])
    for count in range(4, min(MOST, len(rates) // WORTH) + 1, 2):
        places = np.cos(np.pi * (np.arange(count) + 0.5) / count)
        nodes = np.sqrt(low * high) * (high / low) ** (0.5 * places)
        sums = np.exp(-t[:, None] * nodes)
        sums = np.vstack([sums, sums * (nodes / high)])
        weights = np.linalg.lstsq(sums, truth, rcond=1e-15)[0]
        if np.abs(sums @ weights - truth).max() <= FITTED:
            return nodes, weights.T
    return None


# ----------------------------------------------------------------------------------------------------------------------
# The noun of modes that damping couples: oscillators in their place, and what their motion is worth.
# ----------------------------------------------------------------------------------------------------------------------

LOSSES_ALIKE: Final = 1e-9  # of an energy: losses that differ from it by less are not told state by state


@dataclass(frozen=True, eq=False)
class Oscillators:
    """Oscillators in place of K modes that damping couples; rates are in rad/s.

    omega, damping [k] : w and c of each. modes [K] : circular frequencies of the modes. turn [4, K, k] : places, tilts,
    swings and rates; q = places z + tilts v and q' = swings z + rates v. kicks, drives [k, K] : z' = v + kicks u,
    v' = -w^2 z - c v + drives u under modal forces u. gram [2 k, 2 k] : the energy is y . gram y / 2 for y = [z, v].
    surplus : by the damping alone free motion loses that and y . surplus y / 2 from now on: [2 k, 2 k], symmetric, or
    [0, 0] where it is below |misses y|^2 / 2 and 1e-9 of the energies of all y; misses [2 k]. Both are zero but for
    errors of the oscillators.
    residual : what they miss of damping and stiffness, over the rates of the modes [1]. added : share of the damping
    that was added [1]. largest : eigenvalue of the damping matrix [rad/s]. relaxing : sums of few exponentials for many
    of them, None where there are none. ringing : the number of the others, which are first, the longest ringing ahead.
    """

    omega: Floats
    damping: Floats
    modes: Floats
    turn: Floats
    kicks: Floats
    drives: Floats
    gram: Floats
    surplus: Floats
    misses: Floats
    residual: float
    added: float
    largest: float
    relaxing: Relaxing | None
    ringing: int

    @property
    def places(self) -> Floats:
        """What displacements are of z."""
        places: Floats = self.turn[0]
        return places

    @property
    def tilts(self) -> Floats:
        """What displacements are of v."""
        tilts: Floats = self.turn[1]
        return tilts

    @property
    def swings(self) -> Floats:
        """What velocities are of z."""
        swings: Floats = self.turn[2]
        return swings

    @property
    def rates(self) -> Floats:
        """What velocities are of v."""
        rates: Floats = self.turn[3]
        return rates


def in_order(
    modes: Floats,
    w: Floats,
    c: Floats,
    parts: tuple[Floats, Floats, Floats, Floats],
    damping: Floats,
    residual: float,
    added: float,
) -> Oscillators:
    """Oscillators w, c [k] with these places, tilts [K, k], kicks and drives [k, K] of modes with this damping [K, K],
    the longest ringing first."""
    order, k = np.argsort(_slowest(w, c), kind="stable"), len(w)
    creeping, relaxing = relaxing_of(w[order], c[order])
    order = np.append(np.delete(order, creeping), order[creeping])
    w, c = w[order], c[order]
    places, tilts, kicks, drives = parts[0][:, order], parts[1][:, order], parts[2][order], parts[3][order]
    turn = np.array([places, tilts, -tilts * w**2, places - tilts * c], order="C")
    speeds = np.hstack([turn[2], turn[3]])
    gram = speeds.T @ speeds
    held = modes[:, None] * np.hstack([places, tilts])
    gram += held.T @ held
    size = np.sqrt(np.diag(gram))
    reach = np.maximum(np.linalg.norm(kicks, axis=1) * size[:k], np.linalg.norm(drives, axis=1) * size[k:])
    surplus = loss_surplus(w, c, speeds, damping, gram, reach)
    scale = np.where(size > 0.0, size, 1.0)
    shares = np.abs(surplus) / np.outer(scale, scale)
    missed = min(float(shares.sum(axis=1).max(initial=0.0)), float(np.linalg.norm(shares)))  # of a symmetric matrix
    return Oscillators(
        omega=w,
        damping=c,
        modes=modes,
        turn=turn,
        kicks=kicks,
        drives=drives,
        gram=gram,
        surplus=surplus if missed > LOSSES_ALIKE else np.zeros((0, 0)),
        misses=np.sqrt(missed) * size,
        residual=residual,
        added=added,
        largest=float(np.abs(np.linalg.eigvalsh(damping)).max()),
        relaxing=relaxing,
        ringing=k - len(creeping),
    )


def _slowest(omega: Floats, damping: Floats) -> Floats:
    """The rate at which the slower part of an oscillator dies away; of one that nothing holds, that of its speed."""
    half = 0.5 * damping
    fast = half + np.sqrt(np.maximum(half**2 - omega**2, 0.0))
    creeps = np.divide(omega**2, fast, out=np.zeros_like(fast), where=fast > 0.0)
    slow: Floats = np.where(omega == 0.0, damping, np.where(half > omega, creeps, half))
    return slow


# ----------------------------------------------------------------------------------------------------------------------
# Modes that damping couples, as oscillators that do not know each other.
# ----------------------------------------------------------------------------------------------------------------------

APART: Final = 1e-14  # of the root of both their own damping: what couples two modes less than that is rounding
FREE: Final = 1e-13  # of the largest damping of modes without stiffness: one that is held by less is free
UNDAMPED: Final = 1e-12  # of a frequency: a rate below zero that is rounding
PROVEN: Final = 1e-9  # of what the oscillators miss of damping and stiffness: a thousandth of what a ledger may miss
ADDED: Final = (0.0, 1e-12, 1e-10, 1e-9, 1e-8)  # shares of the damping that are added, until the residual is proven


def oscillators(omega: Floats, damping: Floats, resting: bool = True) -> Oscillators:
    """The oscillators of modes of these circular frequencies [k] [rad/s] and this damping matrix [k, k] [rad/s].

    Modes that the matrix does not couple stay what they are.

    Two modes of one dashpot: it stops what it moves at once, and lets both ring together without it.

    Parameters
    ----------
    resting : bool
        Whether anybody asks where modes without stiffness are. Where nobody does there is an oscillator less for every
        two of them, and they are told from where they come to rest in the end.

    Raises
    ------
    NotConverged
        Where no pairs are found whose residual is below 1e-9.

    Examples
    --------
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
    moving = np.delete(np.arange(len(omega)), still[:out])
    k, largest = len(omega), max(float(omega.max(initial=0.0)), float(np.abs(damping).max()))
    scale = np.where(omega > 0.0, omega, largest)
    try:
        values, shapes = eigenpairs(omega, damping)
        values, shapes = values[out:], shapes[:, out:]
        first, second = _pairs(values, shapes, damping, alike=out == 0)
        w, c, places, tilts = _oscillators_of(values, shapes, first, second)
        swings, rates = -tilts * w**2, places - tilts * c
        widths = np.concatenate([1.0 / np.where(w > 0.0, w, largest), np.ones(len(w))])
        still_told = np.hstack([scale[moving, None] * places[moving], scale[moving, None] * tilts[moving]])
        motion = np.vstack([still_told, np.hstack([swings, rates])]) * widths
        inverse = widths[:, None] * np.linalg.inv(motion)
    except np.linalg.LinAlgError:
        return None
    m, n = len(w), len(moving)
    kicks, drives = inverse[:m, n:], inverse[m:, n:]
    moved = np.hstack([-rates * w**2, swings - rates * c])  # accelerations of free motion
    missed = moved @ inverse
    missed[:, n:] += damping
    missed[moving, np.arange(n)] += omega[moving] ** 2 / scale[moving]
    paces = np.sqrt(omega + np.maximum(np.diag(damping), 0.0))
    miss = np.abs(missed) / np.outer(paces, np.concatenate([paces[moving], paces]))
    stays = scale[moving, None] * (places[moving] @ kicks + tilts[moving] @ drives)
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


# ----------------------------------------------------------------------------------------------------------------------
# As few oscillators as move what a few given forces move.
# ----------------------------------------------------------------------------------------------------------------------

DEPENDENT: Final = 1e-12  # of a unit force: what is left of one beside the others


def under_forces(found: Oscillators, forces: Floats) -> Oscillators:
    """Oscillators that move as these do under modal forces along some rows [r, K], from rest; kicks and drives of other
    forces mean nothing. The same ones where fewer would not do.

    Forty equal modes on dashpots, all overdamped, under one force: sums of sixteen exponentials.

    >>> from femstruct.modal.oscillators import oscillators
    >>> whole = oscillators(np.full(40, 10.0), np.diag(np.linspace(400.0, 500.0, 40)))
    >>> few = under_forces(whole, np.ones((1, 40)))
    >>> len(whole.omega), len(few.omega) < 20
    (40, True)
    """
    creep = found.relaxing
    inputs = _spanning(forces)
    if creep is None or not len(inputs) or len(inputs) * len(creep.nodes) >= creep.number:
        return found
    first = len(found.omega) - creep.number
    half = len(creep.nodes) // 2
    one, two = creep.nodes[:half], creep.nodes[half:]  # each pair is an oscillator
    to_z, to_v = _expanded(found, inputs, creep, first)
    omega, damping = np.tile(np.sqrt(one * two), len(inputs)), np.tile(-(one + two), len(inputs))
    sets, count = found.turn[0].shape[0], first + len(omega)
    turn = np.empty((4, sets, count))
    turn[:, :, :first] = found.turn[:, :, :first]
    both = np.hstack([found.places[:, first:], found.tilts[:, first:]]) @ np.vstack([to_z, to_v])
    turn[0, :, first:], turn[1, :, first:] = both[:, : len(omega)], both[:, len(omega) :]
    turn[2, :, first:] = -turn[1, :, first:] * omega**2
    turn[3, :, first:] = turn[0, :, first:] - turn[1, :, first:] * damping
    k, own, missed = len(found.omega), found.misses, found.misses[:, None] ** 2
    squares = (missed[first:k] * to_z**2 + missed[k + first :] * to_v**2).sum(axis=0)
    new = np.sqrt(2 * len(omega) * squares)  # a square of a sum is at most as many times the sum of the squares
    return replace(
        found,
        omega=np.append(found.omega[:first], omega),
        damping=np.append(found.damping[:first], damping),
        turn=turn,
        kicks=np.vstack([found.kicks[:first], np.repeat(2.0 * inputs, half, axis=0)]),
        drives=np.vstack([found.drives[:first], np.repeat(inputs, half, axis=0) * -damping[:, None]]),
        gram=_projected(found.gram, to_z, to_v, first),
        surplus=_projected(found.surplus, to_z, to_v, first) if found.surplus.size else found.surplus,
        misses=np.concatenate([own[:first], new[: len(omega)], own[k : k + first], new[len(omega) :]]),
        relaxing=None,
    )


def _spanning(forces: Floats) -> Floats:
    """Orthonormal rows with the span of those given [n, K]."""
    if not forces.any():
        return forces[:0]
    length = np.linalg.norm(forces, axis=1)
    _, size, rows = np.linalg.svd(forces[length > 0.0] / length[length > 0.0, None], full_matrices=False)
    spanning: Floats = rows[size > DEPENDENT]
    return spanning


def _expanded(found: Oscillators, inputs: Floats, creep: Relaxing, first: int) -> tuple[Floats, Floats]:
    """z and v of the oscillators that creep in terms of those in their place, [z; v] of all inputs [n, 2 p]."""
    (slow, fast), half = creep.rates, len(creep.nodes) // 2
    one, two = creep.nodes[:half], creep.nodes[half:]
    z_of: list[tuple[Floats, Floats]] = []
    v_of: list[tuple[Floats, Floats]] = []
    for force in inputs:
        kick, drive = found.kicks[first:] @ force, found.drives[first:] @ force
        of_slow, of_fast = (drive - fast * kick) / (slow - fast), (slow * kick - drive) / (slow - fast)
        sums = [of_slow[:, None] * creep.weights[0], of_fast[:, None] * creep.weights[1]]
        for gathered, part in (
            (z_of, sums[0] + sums[1]),
            (v_of, slow[:, None] * sums[0] + fast[:, None] * sums[1]),
        ):
            early, late = part[:, :half], part[:, half:]
            gathered.append(((one * late - two * early) / (one - two), (early - late) / (one - two)))
    to_z, to_v = (np.hstack([*(a for a, _ in parts), *(b for _, b in parts)]) for parts in (z_of, v_of))
    return to_z, to_v


def _projected(form: Floats, to_z: Floats, to_v: Floats, first: int) -> Floats:
    """A form of [z, v] of all oscillators in terms of those that are left."""
    k, new = len(form) // 2, to_z.shape[1] // 2
    halves = form[:, first:k] @ to_z + form[:, k + first :] @ to_v  # [2 k, 2 new]
    corner = to_z.T @ halves[first:k] + to_v.T @ halves[k + first :]
    m = first + new
    out = np.empty((2 * m, 2 * m))
    added = np.append(np.arange(first, m), np.arange(m + first, 2 * m))
    for at, rows in ((0, slice(0, first)), (m, slice(k, k + first))):
        here = slice(at, at + first)
        out[here, :first], out[here, m : m + first] = form[rows, :first], form[rows, k : k + first]
        out[here, first:m], out[here, m + first :] = halves[rows, :new], halves[rows, new:]
        out[first:m, here], out[m + first :, here] = halves[rows, :new].T, halves[rows, new:].T
    out[np.ix_(added, added)] = corner
    return out


# ----------------------------------------------------------------------------------------------------------------------
# Oscillators of the last few bases that were asked for, by the value of their damping: making them takes a second.
# ----------------------------------------------------------------------------------------------------------------------

KEPT: Final = 4  # bases of a study that are worked on at a time; 600 modes take 35 MB
_found: OrderedDict[bytes, Oscillators] = OrderedDict()
_asked: WeakKeyDictionary[ModalBasis, bytes | None] = WeakKeyDictionary()
_lock: Final = Lock()


def oscillators_of(basis: ModalBasis) -> Oscillators | None:
    """The `oscillators` of a basis, or None where its damping couples no modes; the same value for the same numbers.

    >>> from femstruct.modal.closed_form import given_modes
    >>> oscillators_of(given_modes([10.0, 20.0], [0.01, 0.02], {})[0]) is None
    True
    """
    with _lock:  # threads that ask for the same wait for it
        if basis not in _asked:
            _asked[basis] = _key(basis)
        key = _asked[basis]
        if key is None:
            return None
        if key not in _found:
            _found[key] = oscillators(basis.omega, basis.time_damping, _rests(basis))
            while len(_found) > KEPT:
                _found.popitem(last=False)
        _found.move_to_end(key)
        return _found[key]


def _key(basis: ModalBasis) -> bytes | None:
    """What oscillators depend on; None where no modes are coupled."""
    damping = basis.time_damping
    if not (damping - np.diag(np.diag(damping))).any():
        return None
    digest = hashlib.blake2b(np.ascontiguousarray(basis.omega).tobytes() + damping.tobytes())
    digest.update(bytes([_rests(basis)]))
    return digest.digest()


def _rests(basis: ModalBasis) -> bool:
    """Whether anything is read of where modes without stiffness are: nothing is of frames of wool, and of air that
    slides over it."""
    still = basis.omega == 0.0
    rows = [basis.momentum, *basis.volumes.values(), *(row.stiffness for row in basis.outputs.values())]
    return bool(basis.shapes[..., still].any() or any(row[..., still].any() for row in rows))
