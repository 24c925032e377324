"""What drawn samples tell of a number: how far it scatters, and what it follows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import nan
from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.study.asked import SETTLED
from femstruct.study.campaign.swept import Swept, independent

LEVELS: Final = (0.05, 0.5, 0.95)  # of the quantiles that are told
ROUNDING: Final = 1e-9  # of a number: differences below are none
FEWEST: Final = 8  # samples, below which nothing is said of a distribution
_HUGE: Final = 1e300  # in place of infinity, of which quantiles have none
_INFINITE: Final = 1e250  # what a quantile beside it is above


@dataclass(frozen=True)
class Spread:
    """How a number scatters over the samples that are to be trusted.

    above : the case whose own number is taken off, sample by sample, "" for none. count of samples; left_out : because
    of findings that forbid trust, or without a number. longer : how many of the count have no time to rest, since the
    window ends before; they are longer than all others. mean, deviation : of the samples, nan where some are longer.
    quantiles : 5, 50 and 95 %, nan where it is one of those. follows : rank correlation with each path that varies
    (Spearman), nan for words and for what is constant.
    """

    name: str
    unit: str
    case: str
    above: str
    count: int
    left_out: int
    longer: int
    mean: float
    deviation: float
    quantiles: tuple[float, float, float]
    follows: tuple[float, ...]


def spread(rows: Swept, name: str, case: str = "", above: str = "") -> Spread | None:
    """How a number of a case scatters, or what it is above that of another case, sample by sample.

    above : the other case; a difference of two cases has a scatter of its own, often much smaller than that of either.

    Returns None for fewer than 8 samples that are to be trusted, and for a difference of times to rest of which some
    are not seen. Raises InputError for unknown names.

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
    sound = sound & independent(rows)
    longer = sound & np.isnan(values) & (name == SETTLED)
    known = sound & (np.isfinite(values) | longer)
    own = np.where(longer, _HUGE, values)[known]
    many = bool(longer.any())
    if len(own) < FEWEST or (many and (above or longer[known].all())):
        return None
    low, middle, high = quantiles_of(own, LEVELS)
    return Spread(
        name=name,
        unit=rows.unit_of(name),
        case=case,
        above=above,
        count=len(own),
        left_out=int((rows.done & independent(rows)).sum()) - len(own),
        longer=int(longer.sum()),
        mean=nan if many else float(own.mean()),
        deviation=nan if many else float(own.std(ddof=1)),
        quantiles=(low, middle, high),
        follows=tuple(_rank_correlation(column[known], own) for column in rows.values.T),
    )


def quantiles_of(values: Floats, shares: Sequence[float]) -> tuple[float, ...]:
    """Quantiles of values [n], of which some may be infinite; nan for those that are.

    >>> quantiles_of(np.array([1.0, 2.0, 3.0, np.inf, np.inf]), (0.5, 0.9))
    (3.0, nan)
    """
    found = np.quantile(np.minimum(values, _HUGE), shares)
    return tuple(float(one) if one < _INFINITE else nan for one in found)


def _rank_correlation(x: Floats, y: Floats) -> float:
    from scipy.stats import spearmanr

    if not np.isfinite(x).all() or np.ptp(x) == 0.0 or np.ptp(y) <= ROUNDING * np.abs(y).max():
        return nan
    return float(spearmanr(x, y).statistic)
