"""What a fit found: values, intervals, and combinations that the data leave open."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

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
    open, nan where it ended at a given bound: the other ones are then those that belong to it. low, high : their
    confidence intervals. shifts : names of those that have no size of their own. at_zero, at_bound : names of those
    that ended at zero, which they cannot cross, and at bounds that were given. correlation [p, p] : of the estimates,
    in their order; nan with one that is open or at a bound. noise : standard deviation of the residuals. explained :
    share of the sum of squares of the measured history. residuals [N] : computed less measured, over their scatter.
    numbers : how many independent ones these are. runs : how often the data were computed. open [q, p] : combinations
    of relative changes of the parameters that the data do not determine, of length one. determined [p, p] : covariance
    of relative changes without them. known : whether the scatter is as stated; else it is that of the residuals. reach
    : half an interval over its deviation.
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

    def why_no_interval(self, name: str) -> str:
        """Why there is no interval of a parameter, "" where there is one."""
        if np.isfinite(self.deviations[name]):
            return ""
        return "at its bound" if name in self.at_bound else "not determined by these data"

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
    names, scale = [one.name for one in parameters], np.array([one.scale for one in parameters])
    values, size_of = scale * x, np.abs(scale)
    open_, covariance = _seen(jacobian, np.ones(len(x), dtype=bool))
    scatter = _scatter(left, numbers - len(x) + len(open_), known, confidence)
    near = np.maximum(AT_BOUND * scatter.unit * np.sqrt(np.diag(covariance)), ROUNDED) * size_of
    ends = np.array([[one.low, one.high] for one in parameters])
    ended = np.abs(values[:, None] - ends) < near[:, None]
    at_zero, held = (ended & (ends == 0.0)).any(axis=1), (ended & (ends != 0.0)).any(axis=1)
    if held.any():  # what ends at a bound is no longer free: the others are those that belong to it
        open_, covariance = _seen(jacobian, ~held)
        scatter = _scatter(left, numbers - int((~held).sum()) + len(open_), known, confidence)
    spread = np.sqrt(np.diag(covariance))
    loose = (np.abs(open_) > INVOLVED * np.abs(open_).max(axis=1, initial=0.0, keepdims=True)).any(axis=0)
    blank = np.where(held, np.nan, np.where(loose, np.inf, 0.0))
    deviations = scatter.unit * spread * size_of + blank
    half = scatter.reach * scatter.unit * spread * size_of + blank
    own = np.where((values != 0.0) & [bool(one.start) for one in parameters], x, 1.0)
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
        at_zero=tuple(np.array(names)[at_zero].tolist()),
        at_bound=tuple(np.array(names)[held].tolist()),
        confidence=confidence,
        correlation=correlation,
        noise=scatter.noise,
        explained=1.0 - float(left @ left) / size**2,
        residuals=left,
        numbers=numbers,
        runs=runs,
        open=_of_length_one(open_ / own),
        determined=scatter.unit**2 * covariance / np.outer(own, own),
        known=scatter.known,
        reach=scatter.reach,
    )


def _seen(jacobian: Floats, free: NDArray[np.bool_]) -> tuple[Floats, Floats]:
    """Combinations of the free parameters that are open [q, p], and the covariance of the rest of them [p, p]."""
    p = len(free)
    own = unseen(jacobian[:, free]) if free.any() else np.zeros((0, 0))
    open_, covariance = np.zeros((len(own), p)), np.zeros((p, p))
    open_[:, free], covariance[np.ix_(free, free)] = own, inverse(jacobian[:, free], own)
    return open_, covariance


class _Scatter(NamedTuple):
    """Standard deviation of the residuals, that of the data in the intervals, half an interval over it, and whether the
    scatter is as stated."""

    noise: float
    unit: float
    reach: float
    known: bool


def _scatter(left: Floats, free: int, known: bool, confidence: float) -> _Scatter:
    """free : degrees of freedom of the residuals. They replace a stated scatter that they exceed."""
    squares = float(left @ left)
    noise = float(np.sqrt(squares / free)) if free > 0 else 0.0
    exceeded = known and free > 0 and squares > free + EXCEEDED * np.sqrt(2.0 * free)
    end = 0.5 + 0.5 * confidence
    if known and not exceeded:
        return _Scatter(noise, 1.0, float(scipy.special.ndtri(end)), True)
    return _Scatter(noise, noise, float(scipy.special.stdtrit(free, end)), False)


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
