"""What drawn samples tell of a number: how far it scatters, what it follows, how likely it is within its limit."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan, sqrt
from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.study.campaign.swept import Flags, Swept
from femstruct.study.campaign.varied import INDICES

LEVELS: Final = (0.05, 0.5, 0.95)  # of the quantiles that are told
ROUNDING: Final = 1e-9  # of a number: differences below are none
FEWEST: Final = 8  # samples, below which nothing is said of a distribution
SURE: Final = 1.959963984540054  # standard deviations of a 95 % interval


@dataclass(frozen=True)
class Spread:
    """How a number scatters over the samples that are to be trusted.

    above : the case whose own number is taken off, sample by sample, "" for none. count of samples; left_out : because
    of findings that forbid trust, or without a number. mean, deviation : of the samples. quantiles : 5, 50 and 95 %.
    follows : rank correlation with each path that varies (Spearman), nan for words and for what is constant. limit :
    what it should not exceed, None without; held : share of the samples that do not, with low and high end of its 95 %
    interval (Wilson).
    """

    name: str
    unit: str
    case: str
    above: str
    count: int
    left_out: int
    mean: float
    deviation: float
    quantiles: tuple[float, float, float]
    follows: tuple[float, ...]
    limit: float | None = None
    held: tuple[float, float, float] | None = None


def spread(rows: Swept, name: str, case: str = "", above: str = "") -> Spread | None:
    """How a number of a case scatters, or what it is above that of another case, sample by sample.

    above : the other case; a difference of two cases has a scatter of its own, often much smaller than that of either.

    Returns None for fewer than 8 samples that are to be trusted. Raises InputError for unknown names.

    References
    ----------
    Wilson, J. Am. Stat. Assoc. 22 (1927) 209, doi:10.1080/01621459.1927.10502953.

    The velocity of a mass that a ball of uncertain mass hits:

    >>> import tempfile
    >>> from pathlib import Path
    >>> import femstruct as fs
    >>> model = "structure: {type: oscillator, mass: 1 kg, stiffness: 100 N/m}\\npoints: {m: {}}"
    >>> study = '''
    ... model: model.yaml
    ... bodies: {ball: {mass: 1 kg, above: m, speed: 1 m/s, contact: {type: linear, stiffness: 1 MN/m}}}
    ... record: {m.z: velocity}
    ... time: {duration: 10 ms, sampling: 10 kHz}
    ... vary: {bodies.ball.mass: {normal: {mean: 1 kg, sd: 10 %}}}
    ... samples: {count: 16}
    ... '''
    >>> with tempfile.TemporaryDirectory() as place:
    ...     _ = Path(place, "model.yaml").write_text(model, encoding="utf-8")
    ...     _ = Path(place, "hit.study.yaml").write_text(study, encoding="utf-8")
    ...     rows = fs.sweep(fs.read_campaign(Path(place, "hit.study.yaml")), workers=1)
    >>> found = spread(rows, "m.z velocity")
    >>> round(found.mean, 2), round(found.deviation, 2), round(found.follows[0], 3)
    (1.0, 0.05, 1.0)
    """
    case = case or rows.baseline
    values, sound = rows.of(name, case), rows.trusted(case)
    if above:
        values, sound = values - rows.of(name, above), sound & rows.trusted(above)
    known = sound & np.isfinite(values) & independent(rows)
    own = values[known]
    if len(own) < FEWEST:
        return None
    low, middle, high = (float(one) for one in np.quantile(own, LEVELS))
    limit = None if above else rows.limits.get(name)
    return Spread(
        name=name,
        unit=rows.unit_of(name),
        case=case,
        above=above,
        count=len(own),
        left_out=int((rows.done & independent(rows)).sum()) - len(own),
        mean=float(own.mean()),
        deviation=float(own.std(ddof=1)),
        quantiles=(low, middle, high),
        follows=tuple(_rank_correlation(column[known], own) for column in rows.values.T),
        limit=limit,
        held=None if limit is None else wilson(int((own <= limit).sum()), len(own)),
    )


def independent(rows: Swept) -> Flags:
    """The samples that are independent of each other [n]: of those for indices the first two tables."""
    n = len(rows.texts)
    return np.arange(n) < (2 * n // (len(rows.paths) + 2) if rows.method == INDICES else n)


def wilson(held: int, of: int) -> tuple[float, float, float]:
    """A share and its 95 % interval, which stays within 0 and 1 where all are held.

    >>> [round(one, 3) for one in wilson(10, 10)]
    [1.0, 0.722, 1.0]
    """
    share, square = held / of, SURE**2 / of
    middle = (share + 0.5 * square) / (1.0 + square)
    half = sqrt(share * (1.0 - share) * square + 0.25 * square**2) / (1.0 + square)
    return share, max(middle - half, 0.0), min(middle + half, 1.0)


def _rank_correlation(x: Floats, y: Floats) -> float:
    from scipy.stats import spearmanr

    if not np.isfinite(x).all() or np.ptp(x) == 0.0 or np.ptp(y) <= ROUNDING * np.abs(y).max():
        return nan
    return float(spearmanr(x, y).statistic)
