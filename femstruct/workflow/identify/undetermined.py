"""Combinations of parameters that the data do not distinguish, in words."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from femstruct.arrays import Floats
from femstruct.workflow.identify.intervals import INVOLVED, Fit, Values

TRIED: Final = 0.2  # of a parameter: far enough to tell a sum from a product
STEPPED: Final = 0.1  # of the first parameter, in words
ALIKE: Final = 0.03  # of an exponent or a weight, that is one
HARDLY: Final = 0.5  # half an interval along a combination, as relative changes: not even the first digit is known
SHARED: Final = 0.3  # share of a parameter in such a combination, from which on it is named
_LARGEST: Final = 10.0


class Kept(NamedTuple):
    """What the data determine of parameters that they do not distinguish: in words ("the ratio"), as a formula, its
    value in the units of the parameters, and half its interval as a share of it."""

    words: str
    formula: str
    value: float
    half: float

    @property
    def told(self) -> str:
        """The formula with its value and interval."""
        return f"{self.formula} = {self.value:.4g} +-{100 * self.half:.2g} %"


@dataclass(frozen=True)
class Combination:
    """Parameters that the data do not distinguish. names : of those involved. changes : relative ones that the data do
    not see, the first +10 %. kept : what they determine instead. half_along : half the interval along the changes, as a
    share; infinite where the data see nothing of them at all."""

    names: tuple[str, ...]
    changes: tuple[float, ...]
    kept: tuple[Kept, ...]
    half_along: float

    @property
    def sentence(self) -> str:
        """The combination in words."""
        moved = [f"{100 * one:+.3g} % of {name}" for name, one in zip(self.names, self.changes, strict=True)]
        listed = " and ".join((", ".join(self.names[:-1]), self.names[-1]))
        together = " with ".join((moved[0], " and ".join(moved[1:])))
        if np.isinf(self.half_along):
            told = f"{listed}: the data cannot distinguish them: {together} changes nothing"
        else:
            along = 100 * min(self.half_along, _LARGEST)
            told = f"{listed}: the data hardly distinguish them: {together} changes little (+-{along:.0f} % along it)"
        determined = "is well determined" if np.isfinite(self.half_along) else "is determined"
        what = self.kept[0].words if len(self.kept) == 1 else "what does not change with it"
        return f"{told}. Only {what} {determined}: {', '.join(one.told for one in self.kept)}"


def combinations(fit: Fit, units: Mapping[str, str], residuals: Callable[[Values], Floats]) -> tuple[Combination, ...]:
    """What the data do not distinguish: combinations that change nothing, then those that change little.

    units : of the parameters. residuals : at any values; tells a sum from a product.
    """
    found = [_combination(fit, units, residuals, row, np.inf) for row in fit.open]
    relative = [i for i, name in enumerate(fit.values) if name not in (*fit.shifts, *fit.at_zero, *fit.at_bound)]
    if not len(fit.open) and len(relative) > 1:
        variance, turned = np.linalg.eigh(fit.determined[np.ix_(relative, relative)])
        along = fit.reach * np.sqrt(variance.clip(0.0))
        for half, column in zip(along.tolist(), turned.T, strict=True):
            row = np.zeros(len(fit.values))
            row[relative] = column
            if half > HARDLY and int((np.abs(row) > SHARED * np.abs(row).max()).sum()) > 1:
                found.append(_combination(fit, units, residuals, row, half))
    return tuple(one for one in found if len(one.names) > 1)


def _combination(
    fit: Fit, units: Mapping[str, str], residuals: Callable[[Values], Floats], row: Floats, along: float
) -> Combination:
    share = INVOLVED if np.isinf(along) else SHARED
    inside = np.flatnonzero(np.abs(row) > share * np.abs(row).max())
    names = [*fit.values]
    last = int(inside[-1])
    kept = [_power(fit, names, int(i), last, float(row[last] / row[i])) for i in inside[:-1]]
    if len(inside) == 2 and row[inside].prod() < 0.0 and units.get(names[inside[0]]) == units.get(names[last]):
        kept = [_sum(fit, residuals, names, (int(inside[0]), last), float(row[last] / row[inside[0]])) or kept[0]]
    changes = STEPPED * row[inside] / row[inside[0]]
    return Combination(tuple(names[i] for i in inside), tuple(changes.tolist()), tuple(kept), along)


def _power(fit: Fit, names: Sequence[str], one: int, other: int, slope: float) -> Kept:
    """The product of powers of two parameters that does not change where dlog(other) = slope dlog(one)."""
    a, b = names[one], names[other]
    power = -1.0 / slope
    plain = abs(abs(power) - 1.0) < ALIKE
    raised = b if plain else f"{b}^{abs(power):.3g}"
    words = ("the ratio" if power < 0.0 else "the product") + ("" if plain else " of powers")
    power = float(np.sign(power)) if plain else power
    value = fit.values[a] * fit.values[b] ** power
    return Kept(words, f"{a} {'/' if power < 0.0 else '*'} {raised}", value, _half(fit, {one: 1.0, other: power}))


def _sum(
    fit: Fit, residuals: Callable[[Values], Floats], names: Sequence[str], pair: tuple[int, int], slope: float
) -> Kept | None:
    """The weighted sum of two parameters that does not change there, if the data keep it better than the product."""
    first, second = (names[i] for i in pair)
    a, b = fit.values[first], fit.values[second]
    weight = -slope * b / a
    weight = 1.0 if abs(weight - 1.0) < ALIKE else weight
    here, up = residuals(fit.values), a * (1.0 + TRIED)
    if not b * (b - weight * a * TRIED) > 0.0:
        return None
    product = residuals({**fit.values, first: up, second: b * (1.0 + TRIED) ** slope}) - here
    added = residuals({**fit.values, first: up, second: b - weight * a * TRIED}) - here
    if not np.linalg.norm(added) < np.linalg.norm(product):
        return None
    value = weight * a + b
    half = _half(fit, {pair[0]: weight * a / value, pair[1]: b / value})
    words = "the sum" if weight == 1.0 else "the sum with weights"
    return Kept(words, f"{first if weight == 1.0 else f'{weight:.3g} {first}'} + {second}", value, half)


def _half(fit: Fit, weights: Mapping[int, float]) -> float:
    """Half the interval of a sum of relative changes."""
    row = np.zeros(len(fit.values))
    row[[*weights]] = [*weights.values()]
    return fit.reach * math.sqrt(max(float(row @ fit.determined @ row), 0.0))
