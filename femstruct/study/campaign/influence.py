"""Who makes a number scatter: the share of each path that varies in its variance, alone and with the others."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.study.campaign.swept import Swept
from femstruct.study.campaign.varied import INDICES

FEWEST: Final = 8  # samples of each table
DRAWN_AGAIN: Final = 500  # times, for the intervals
SHARE: Final = 0.95  # of the intervals


@dataclass(frozen=True)
class Influence:
    """Sobol' indices of a path: the share of the variance that goes with it if it alone were known, and the share that
    is left if all others were known; each with the low and high end of its 95 % interval (bootstrap)."""

    path: str
    alone: tuple[float, float, float]
    total: tuple[float, float, float]


def influences(rows: Swept, name: str, case: str = "") -> tuple[Influence, ...]:
    """The indices of all paths, of samples for indices; none of others, or of a number that hardly varies.

    A sample of which one row is not to be trusted, or has no number, is left out with all rows that belong to it.

    Raises InputError for unknown names.

    Notes
    -----
    S_j = mean(f(B) (f(AB_j) - f(A))) / V, T_j = mean((f(A) - f(AB_j))^2) / (2 V), V the variance of f(A) and f(B);
    their errors fall with the root of the number of samples.

    References
    ----------
    Saltelli et al., Comput. Phys. Commun. 181 (2010) 259, doi:10.1016/j.cpc.2009.09.018, table 2 (b) and (f).

    The Ishigami function is in tests/unit/test_influence.py.
    """
    if rows.method != INDICES:
        return ()
    p = len(rows.paths)
    values, sound = rows.of(name, case).reshape(p + 2, -1), rows.trusted(case).reshape(p + 2, -1)
    values = values[:, (sound & np.isfinite(values)).all(axis=0)]
    if values.shape[1] < FEWEST or np.ptp(values) <= 1e-12 * np.abs(values).max():
        return ()
    alone, total = _indices(values[:, None, :])
    again = np.random.default_rng(1).integers(values.shape[1], size=(DRAWN_AGAIN, values.shape[1]))
    ends = [np.quantile(one, (0.5 - 0.5 * SHARE, 0.5 + 0.5 * SHARE), axis=1) for one in _indices(values[:, again])]
    return tuple(
        Influence(
            path,
            (float(alone[j, 0]), float(ends[0][0, j]), float(ends[0][1, j])),
            (float(total[j, 0]), float(ends[1][0, j]), float(ends[1][1, j])),
        )
        for j, path in enumerate(rows.paths)
    )


def _indices(values: Floats) -> tuple[Floats, Floats]:
    """First-order and total indices [p, r] of tables A, B, AB_1 .. AB_p [p + 2, r, n]."""
    a, b, mixed = values[0], values[1], values[2:]
    variance = np.concatenate([a, b], axis=-1).var(axis=-1)
    centred = b - np.concatenate([a, b], axis=-1).mean(axis=-1)[..., None]  # the mean adds noise, and nothing else
    alone = (centred * (mixed - a)).mean(axis=-1) / variance
    total = 0.5 * ((a - mixed) ** 2).mean(axis=-1) / variance
    return alone, total
