"""What a fit found: values, intervals, and combinations that the data leave open."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import scipy

from femstruct.arrays import Floats, freeze, frozen, frozen_with_gaps

MIN_SINGULAR_VALUE = (
    1e-4  # smallest singular value of the derivatives, each of length 1: above the error of the derivatives
)
INVOLVED = 0.01  # share of a parameter in a combination that is open, from which on: 1 % of it for all of another
AT_BOUND = 0.01  # of its standard deviation: a parameter that near is at its bound
ROUNDED: Final = 1e-6  # of its start, likewise
EXCEEDED: Final = 4.0  # standard deviations of chi^2: residuals are then larger than the stated scatter
Values = Mapping[str, float]


@dataclass(frozen=True)
class Parameter:
    """A number to find: where it starts and between what it is sought. scale : the change of it that counts as one."""

    name: str
    start: float
    low: float
    high: float
    scale: float


@dataclass(frozen=True, eq=False)
class Fit:
    """Values with intervals, from N measured numbers.

    values, deviations : estimates and their standard deviations, by name; infinite where the data leave a parameter
    open. low, high : their confidence intervals. shifts : names of those that have no size of their own. at_zero,
    at_bound : names of those that ended at zero, which they cannot cross, and at bounds that were given. correlation
    [p, p] : of the estimates, in their order; nan with one that is open. noise : standard deviation of the residuals.
    explained : share of the sum of squares of the measured history. residuals [N] : computed less measured, over their
    scatter. numbers : how many independent ones these are. runs : how often the data were computed. open [q, p] :
    combinations of relative changes of the parameters that the data do not determine, of length one. determined [p, p]
    : covariance of relative changes without them. known : whether the scatter is as stated; else it is that of the
    residuals. reach : half an interval over its deviation.
    """

    values: Mapping[str, float]
    deviations: Mapping[str, float]
    low: Mapping[str, float]
    high: Mapping[str, float]
    shifts: tuple[str, ...]
    at_zero: tuple[str, ...]
    at_bound: tuple[str, ...]
    confidence: float
    correlation: Floats
    noise: float
    explained: float
    residuals: Floats
    numbers: int
    runs: int
    open: Floats
    determined: Floats
    known: bool = False
    reach: float = 1.96

    def __post_init__(self) -> None:
        p = len(self.values)
        freeze(
            self,
            correlation=frozen_with_gaps("fit correlation", self.correlation, (p, p)),
            residuals=frozen("fit residuals", self.residuals, (None,)),
            open=frozen("fit open", self.open, (None, p)),
            determined=frozen("fit determined", self.determined, (p, p)),
        )


def judged(
    parameters: Sequence[Parameter],
    x: Floats,
    left: Floats,
    jacobian: Floats,
    size: float,
    known: bool,
    confidence: float,
    runs: int,
    numbers: int,
) -> Fit:
    """The fit with its intervals. x [p], jacobian [N, p] : of the scaled parameters. numbers : independent ones among
    what is left."""
    scale = np.array([one.scale for one in parameters])
    open_ = unseen(jacobian)
    covariance = inverse(jacobian, open_)
    spread = np.sqrt(np.diag(covariance))
    loose = (np.abs(open_) > INVOLVED * np.abs(open_).max(axis=1, initial=0.0, keepdims=True)).any(axis=0)
    squares, free = float(left @ left), numbers - len(parameters) + len(open_)
    noise = float(np.sqrt(squares / free)) if free > 0 else 0.0
    exceeded = known and free > 0 and squares > free + EXCEEDED * np.sqrt(2.0 * free)
    t = float(scipy.special.stdtrit(free, 0.5 + 0.5 * confidence)) if not known or exceeded else 0.0
    wide = t * noise if t else float(scipy.special.ndtri(0.5 + 0.5 * confidence))
    unit = noise if t else 1.0
    values, deviations = scale * x, unit * spread * np.abs(scale)
    own = np.where(
        [bool(one.start) and value != 0.0 for one, value in zip(parameters, x.tolist(), strict=True)], x, 1.0
    )
    deviations[loose] = np.inf
    half = np.where(loose, np.inf, wide * spread * np.abs(scale))
    near = np.maximum(AT_BOUND * unit * spread * np.abs(scale), ROUNDED * np.abs(scale))
    names = [one.name for one in parameters]
    ended = [
        (one.name, end == 0.0)
        for one, value, reach in zip(parameters, values.tolist(), near.tolist(), strict=True)
        for end in (one.low, one.high)
        if abs(value - end) < reach
    ]
    with np.errstate(invalid="ignore", divide="ignore"):
        correlation = covariance / np.outer(spread, spread) * np.outer(np.sign(scale), np.sign(scale))
    correlation[loose, :] = correlation[:, loose] = np.nan

    def by_name(column: Floats) -> dict[str, float]:
        return dict(zip(names, column.tolist(), strict=True))

    return Fit(
        values=by_name(values),
        deviations=by_name(deviations),
        low=by_name(values - half),
        high=by_name(values + half),
        shifts=tuple(one.name for one in parameters if not one.start),
        at_zero=tuple(name for name, zero in ended if zero),
        at_bound=tuple(name for name, zero in ended if not zero),
        confidence=confidence,
        correlation=correlation,
        noise=noise,
        explained=1.0 - squares / size**2,
        residuals=left,
        numbers=numbers,
        runs=runs,
        open=_of_length_one(open_ / own),
        determined=(unit * unit) * covariance / np.outer(own, own),
        known=known and not exceeded,
        reach=t or wide,
    )


def unseen(derivatives: Floats) -> Floats:
    """Combinations [q, p] of the scaled parameters, of length one, which change nothing: derivatives [N, p].

    >>> unseen(np.array([[1.0, -1.0], [2.0, -2.0]])).round(3).tolist()
    [[0.707, 0.707]]
    """
    lengths = np.linalg.norm(derivatives, axis=0)
    turned: Floats
    _, singular, turned = np.linalg.svd(derivatives / lengths)
    padded = np.zeros(len(lengths))
    padded[: len(singular)] = singular
    return _of_length_one(turned[padded < MIN_SINGULAR_VALUE] / lengths)


def _of_length_one(rows: Floats) -> Floats:
    """Rows [q, p] scaled to length one, the largest entry of each positive."""
    signs = np.sign(rows[np.arange(len(rows)), np.abs(rows).argmax(axis=1)])
    scaled: Floats = rows * (signs / np.linalg.norm(rows, axis=1))[:, None]
    return scaled


def inverse(derivatives: Floats, open_: Floats) -> Floats:
    """(J^T J)^-1 [p, p] on what is not open; the whole where nothing is."""
    if not len(open_):
        return np.asarray(np.linalg.inv(derivatives.T @ derivatives))
    inside = scipy.linalg.null_space(open_)
    part = derivatives @ inside
    return inside @ np.linalg.inv(part.T @ part) @ inside.T
