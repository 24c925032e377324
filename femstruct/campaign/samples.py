"""The samples of a campaign: a value of every path that varies, for each of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from femstruct.arrays import Floats
from femstruct.language.study.campaign.vary import written
from femstruct.study.campaign.varied import INDICES, Campaign, Listed, Scattered


@dataclass(frozen=True, eq=False)
class Samples:
    """n samples of p paths.

    texts : the values as a file writes them, [n][p]. numbers [n, p] : the same in SI units, nan for words and lists.
    """

    paths: tuple[str, ...]
    units: tuple[str, ...]
    texts: tuple[tuple[str, ...], ...]
    numbers: Floats

    def changes(self, i: int) -> tuple[str, ...]:
        """Sample i as texts ``PATH=VALUE``."""
        return tuple(f"{path}={text}" for path, text in zip(self.paths, self.texts[i], strict=True))


def samples_of(campaign: Campaign) -> Samples:
    """The samples that a campaign asks for: of a grid the last path varies fastest.

    Notes
    -----
    Latin hypercube and scrambled Sobol sequence are those of scipy.stats.qmc. A point u of the unit interval takes the
    quantile of a distribution, or the listed value of number floor(u n). The numbers depend on the seed alone, not on
    the machine. For indices the samples are two tables A and B, then A with one column after the other from B.

    >>> two = Listed("a", ("1", "2"), (1.0, 2.0), "1"), Listed("b", ("x", "y"))
    >>> samples_of(Campaign("s.yaml", two)).texts
    (('1', 'x'), ('1', 'y'), ('2', 'x'), ('2', 'y'))
    """
    varied, sampling = campaign.varied, campaign.sampling
    if sampling.method == "grid":
        listed = [one for one in varied if isinstance(one, Listed)]
        rows = list(product(*(range(len(one.texts)) for one in listed)))
        columns = [_chosen(one, [row[j] for row in rows]) for j, one in enumerate(listed)]
    else:
        assert sampling.count is not None
        unit = _points(sampling.method, sampling.count, len(varied), sampling.seed)
        columns = [at(one, unit[:, j]) for j, one in enumerate(varied)]
    texts = tuple(zip(*(column[0] for column in columns), strict=True))
    numbers = np.column_stack([column[1] for column in columns])
    return Samples(tuple(one.path for one in varied), tuple(one.unit for one in varied), texts, numbers)


def _points(method: str, count: int, dimension: int, seed: int) -> Floats:
    """Points of the unit cube [count, dimension]."""
    from scipy.stats import qmc

    if method == INDICES:
        both = qmc.Sobol(2 * dimension, rng=np.random.default_rng(seed)).random(count)
        a, b = both[:, :dimension], both[:, dimension:]
        mixed = [np.where(np.arange(dimension) == j, b, a) for j in range(dimension)]
        return np.concatenate([a, b, *mixed])
    kind: Any = qmc.LatinHypercube if method == "latin hypercube" else qmc.Sobol
    engine = kind(dimension, rng=np.random.default_rng(seed))
    # Sobol points are balanced in powers of two: of these the first are taken
    whole = count if method == "latin hypercube" else 1 << (count - 1).bit_length()
    points: Floats = engine.random(whole)[:count]
    return points


def at(one: Listed | Scattered, u: Floats) -> tuple[Sequence[str], Floats]:
    """Texts [n] and numbers [n] of a path at points of the unit interval [n]."""
    if isinstance(one, Listed):
        return _chosen(one, np.minimum((u * len(one.texts)).astype(int), len(one.texts) - 1).tolist())
    numbers = quantile(one, u)
    return [written(float(value), one.unit) for value in numbers], numbers


def quantile(one: Scattered, u: Floats) -> Floats:
    """The numbers of a distribution that are exceeded with probability 1 - u.

    >>> quantile(Scattered("a", "log-uniform", 1.0, 100.0), np.array([0.0, 0.5])).round(12).tolist()
    [1.0, 10.0]
    """
    from scipy.special import ndtri

    if one.law == "normal":
        found: Floats = one.first + one.second * ndtri(np.clip(u, 1e-12, 1.0 - 1e-12))  # a Sobol point may be 0
        return found
    if one.law == "log-uniform":
        return np.asarray(one.first * (one.second / one.first) ** u)
    return np.asarray(one.first + (one.second - one.first) * u)


def _chosen(one: Listed, numbers: Sequence[int]) -> tuple[Sequence[str], Floats]:
    values = np.array(one.numbers or (np.nan,) * len(one.texts))
    return [one.texts[i] for i in numbers], values[list(numbers)]
