"""What creeps back without swinging, under given forces: many exponentials as sums of few.

Wool has hundreds of real eigenvalues, many of them almost equal. Under one force each of them is an exponential, and
any exponential whose rate is in some range is a sum of a dozen or two with fixed rates there, to 1e-11: they stand for
hundreds, once for every force. The weights are fitted so that values and derivatives agree at all times.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from femstruct.arrays import Floats, Integers

APART: Final = 4.0  # ratio of two rates, one after the other, from which they are of different clusters
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
    cuts = np.flatnonzero(rates[order][1:] > APART * rates[order][:-1]) + 1
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
