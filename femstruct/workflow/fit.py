"""Least squares with confidence intervals, what the data do not distinguish, and when not to trust a fit."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from femstruct.arrays import Floats, freeze, frozen, frozen_with_gaps
from femstruct.errors import Finding, InputError, NotConverged

# ----------------------------------------------------------------------------------------------------------------------
# What a fit found: values, intervals, and combinations that the data leave open.
# ----------------------------------------------------------------------------------------------------------------------

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


def fit_with_intervals(
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
    """The fit with its intervals.

    Parameters
    ----------
    x, jacobian : Floats [p], Floats [N, p]
        Of the scaled parameters.
    numbers : int
        Independent ones among what is left.
    """
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
    own = unidentifiable(jacobian[:, free]) if free.any() else np.zeros((0, 0))
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


def unidentifiable(derivatives: Floats) -> Floats:
    """Combinations [q, p] of the scaled parameters, of length one, which change nothing: derivatives [N, p].

    >>> unidentifiable(np.array([[1.0, -1.0], [2.0, -2.0]])).round(3).tolist()
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


# ----------------------------------------------------------------------------------------------------------------------
# Combinations of parameters that the data do not distinguish, in words.
# ----------------------------------------------------------------------------------------------------------------------

TRIED: Final = 0.2  # of a parameter: far enough to tell a sum from a product
STEPPED: Final = 0.1  # of the first parameter, in words
ALIKE: Final = 0.03  # of an exponent or a weight, that is one
HARDLY: Final = 0.5  # half an interval along a combination, as relative changes: not even the first digit is known
SHARED: Final = 0.3  # share of a parameter in such a combination, from which on it is named
_LARGEST: Final = 10.0


class Determined(NamedTuple):
    """What the data determine of parameters that they do not distinguish: in words ("the ratio"), as a formula, its
    value in the units of the parameters, and half its interval as a share of it."""

    words: str
    formula: str
    value: float
    half: float

    @property
    def text(self) -> str:
        """The formula with its value and interval."""
        return f"{self.formula} = {self.value:.4g} +-{100 * self.half:.2g} %"


@dataclass(frozen=True)
class Combination:
    """Parameters that the data do not distinguish. names : of those involved. changes : relative ones that the data do
    not see, the first +10 %. kept : what they determine instead. half_along : half the interval along the changes, as a
    share; infinite where the data see nothing of them at all."""

    names: tuple[str, ...]
    changes: tuple[float, ...]
    kept: tuple[Determined, ...]
    half_along: float

    @property
    def sentence(self) -> str:
        """The combination in words."""
        moved = [f"{100 * one:+.3g} % of {name}" for name, one in zip(self.names, self.changes, strict=True)]
        listed = " and ".join((", ".join(self.names[:-1]), self.names[-1]))
        together = " with ".join((moved[0], " and ".join(moved[1:])))
        if np.isinf(self.half_along):
            sentence = f"{listed}: the data cannot distinguish them: {together} changes nothing"
        else:
            along = 100 * min(self.half_along, _LARGEST)
            sentence = (
                f"{listed}: the data hardly distinguish them: {together} changes little (+-{along:.0f} % along it)"
            )
        determined = "is well determined" if np.isfinite(self.half_along) else "is determined"
        what = self.kept[0].words if len(self.kept) == 1 else "what does not change with it"
        return f"{sentence}. Only {what} {determined}: {', '.join(one.text for one in self.kept)}"


def combinations(fit: Fit, units: Mapping[str, str], residuals: Callable[[Values], Floats]) -> tuple[Combination, ...]:
    """What the data do not distinguish: combinations that change nothing, then those that change little.

    Parameters
    ----------
    units : Mapping[str, str]
        Of the parameters.
    residuals : Callable[[Values], Floats]
        At any values; tells a sum from a product.
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


def _power(fit: Fit, names: Sequence[str], one: int, other: int, slope: float) -> Determined:
    """The product of powers of two parameters that does not change where dlog(other) = slope dlog(one)."""
    a, b = names[one], names[other]
    power = -1.0 / slope
    plain = abs(abs(power) - 1.0) < ALIKE
    raised = b if plain else f"{b}^{abs(power):.3g}"
    words = ("the ratio" if power < 0.0 else "the product") + ("" if plain else " of powers")
    power = float(np.sign(power)) if plain else power
    value = fit.values[a] * fit.values[b] ** power
    return Determined(words, f"{a} {'/' if power < 0.0 else '*'} {raised}", value, _half(fit, {one: 1.0, other: power}))


def _sum(
    fit: Fit, residuals: Callable[[Values], Floats], names: Sequence[str], pair: tuple[int, int], slope: float
) -> Determined | None:
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
    return Determined(words, f"{first if weight == 1.0 else f'{weight:.3g} {first}'} + {second}", value, half)


def _half(fit: Fit, weights: Mapping[int, float]) -> float:
    """Half the interval of a sum of relative changes."""
    row = np.zeros(len(fit.values))
    row[[*weights]] = [*weights.values()]
    return fit.reach * math.sqrt(max(float(row @ fit.determined @ row), 0.0))


# ----------------------------------------------------------------------------------------------------------------------
# Least squares with confidence intervals: which parameters make what is computed match what was measured.
# ----------------------------------------------------------------------------------------------------------------------

STEP = 1e-3  # of a parameter, for its derivative: truncation 1e-6, and an engine that errs by 1e-8 adds 1e-5
SMALLEST = 0.1  # of its start: the least a parameter counts for in that step
MIN_SENSITIVITY = 1e-6  # change of the data over the data themselves, for a change by the whole parameter
SETTLED: Final = 1e-9  # of the parameters: the last step
SQUARES: Final = 1e-12  # of the sum of squares: rounding
HALVINGS: Final = 30
MOST_ITERATIONS = 100
History = Callable[[Values], Floats]


def fit(
    history: History,
    measured: Floats,
    start: Values,
    shifts: Values | None = None,
    confidence: float = 0.95,
) -> Fit:
    """Parameters with which a history comes closest to a measured one, by the sum of squares.

    Parameters
    ----------
    history : History
        The computed history [N], at the measured times, for values of the parameters by name.
    start : Values
        Values to start from, not zero; a parameter keeps the sign of its start, and may end at zero.
    shifts : Values | None
        Parameters that start at zero and may have either sign, with a change of each that counts as 1.

    Raises
    ------
    InputError
        For a parameter of which the data do not depend, by name, and for too few samples or a start of zero;
        NotConverged after 100 iterations.

    Notes
    -----
    Intervals are p +- t s sqrt(diag (J^T J)^-1), t of Student's distribution for N - p degrees of freedom, s^2 the
    residual variance, J from central differences. They assume that the model is right, that its history is nearly
    linear in the parameters over the interval, and that the noise is normal, the same at all samples, and independent
    from one sample to the next; `fit_findings` says where that is not so. Of a parameter at
    zero only the upper end means something. Combinations that the data leave open stay where they start: `Fit.open`.

    References
    ----------
    Seber and Wild, Nonlinear Regression (1989), sections 2.1.2 and 5.1.

    Examples
    --------
    >>> t = np.linspace(0.0, 3.0, 50)
    >>> found = fit(lambda p: p["a"] * np.exp(-p["b"] * t), 2.0 * np.exp(-0.5 * t), {"a": 1.0, "b": 1.0})
    >>> {name: round(value, 6) for name, value in found.values.items()}
    {'a': 2.0, 'b': 0.5}
    """
    parameters = [parameter(name, value) for name, value in start.items()]
    parameters += [Parameter(name, 0.0, -np.inf, np.inf, size) for name, size in (shifts or {}).items()]

    def residuals(values: Values) -> Floats:
        return history(values) - measured

    return fit_parameters(residuals, parameters, float(np.linalg.norm(measured)), confidence=confidence)


def parameter(name: str, start: float, low: float | None = None, high: float | None = None) -> Parameter:
    """A parameter that keeps the sign of its start, or stays between bounds.

    Raises InputError for a start that is zero or infinite, and for bounds that do not hold it between them.
    """
    if not start or not np.isfinite(start):
        raise InputError(f"fit {name}", got=f"a start of {start:g}", expected="a finite start other than 0")
    least = low if low is not None else 0.0 if start > 0 else -np.inf
    most = high if high is not None else 0.0 if start < 0 else np.inf
    if not (least <= start <= most and least < most):
        got = f"a start of {start:g} and bounds of {least:g} and {most:g}"
        raise InputError(f"fit {name}", got=got, expected="a start between two bounds, the lower one first")
    return Parameter(name, start, least, most, start)


def fit_parameters(
    residuals: History,
    parameters: Sequence[Parameter],
    size: float,
    jacobian: Callable[[Values], Floats] | None = None,
    known: bool = False,
    confidence: float = 0.95,
    count: Callable[[Values], int] | None = None,
) -> Fit:
    """Parameters with the least sum of squares of residuals [N], between their bounds.

    Raises as `fit`.

    Parameters
    ----------
    residuals : History
        Computed less measured, over its scatter.
    size : float
        Norm of what was measured, over its scatter.
    jacobian : Callable[[Values], Floats] | None
        Derivatives [N, p] of the residuals by the parameters; central differences without it.
    known : bool
        Whether the scatter was stated for all data: intervals are then those of the normal distribution, unless the
        residuals exceed it.
    count : Callable[[Values], int] | None
        How many independent numbers the residuals are; N without it.
    """
    names, scale = [one.name for one in parameters], np.array([one.scale for one in parameters])
    ends = np.array([[one.low, one.high] for one in parameters]).reshape(-1, 2) / scale[:, None]
    lowest, highest = ends.min(axis=1), ends.max(axis=1)
    begin = np.array([one.start for one in parameters]) / scale
    runs = 0

    def at(x: Floats) -> dict[str, float]:
        return dict(zip(names, (scale * x).tolist(), strict=True))

    def left(x: Floats) -> Floats:
        nonlocal runs
        runs += 1
        return residuals(at(x))

    known_at: list[tuple[bytes, Floats]] = []

    def derivatives(x: Floats) -> Floats:
        """Those of the last point are kept: the search and the judgement ask for them again."""
        if not known_at or known_at[0][0] != x.tobytes():
            known_at[:] = [(x.tobytes(), anew(x))]
        return known_at[0][1]

    def anew(x: Floats) -> Floats:
        if jacobian is not None:
            exact: Floats = jacobian(at(x)) * scale
            return exact
        columns: Floats = scale * differences(
            lambda values: left(np.array([values[name] for name in names]) / scale), parameters, at(x)
        )
        return columns

    def numbers(x: Floats) -> int:
        """How many there are; more than parameters, where the scatter is that of the residuals."""
        n, p = len(first) if count is None else count(at(x)), len(names)
        if n <= p and not known:
            expected, do = f"more than {p}, one for each parameter", "or state the scatter of all data"
            raise InputError("measured", got=f"{n} samples", expected=expected, do=do)
        return n

    first = derivatives(begin)
    numbers(begin)
    refuse_unidentifiable(names, first, size)
    if len(unidentifiable(first)):
        x, final_residuals = _truncated(left, derivatives, begin, (lowest, highest))
    else:
        # x only: what is fitted exactly has no sum of squares left whose change could be judged
        found = scipy.optimize.least_squares(
            left,
            begin,
            derivatives,
            (lowest, highest),
            x_scale="jac",
            max_nfev=MOST_ITERATIONS,
            xtol=SETTLED,
            gtol=1e-14,
        )
        if found.status <= 0:
            raise _endless()
        x, final_residuals = found.x, found.fun
    there = derivatives(x)
    refuse_unidentifiable(names, there, size)
    return fit_with_intervals(
        parameters, x, final_residuals, there, size, known, confidence=confidence, runs=runs, numbers=numbers(x)
    )


def _truncated(
    left: Callable[[Floats], Floats], derivatives: Callable[[Floats], Floats], x: Floats, ends: tuple[Floats, Floats]
) -> tuple[Floats, Floats]:
    """The minimum and the residuals there by shortest steps of Gauss and Newton: along combinations that the data leave
    open there are none."""
    residuals = left(x)
    for _ in range(MOST_ITERATIONS):
        jacobian = derivatives(x)
        step = -inverse(jacobian, unidentifiable(jacobian)) @ (jacobian.T @ residuals)
        for _ in range(HALVINGS):
            tried = x + step.clip(0.5 * (ends[0] - x), 0.5 * (ends[1] - x))  # never beyond half the way to a bound
            new = left(tried)
            if float(new @ new) <= (1.0 + SQUARES) * float(residuals @ residuals):
                break
            step = 0.5 * step
        else:
            return x, residuals
        moved, x, residuals = float(np.abs(tried - x).max()), tried, new
        if moved <= SETTLED * float(np.abs(x).max()):
            return x, residuals
    raise _endless()


def _endless() -> NotConverged:
    do = "give starts nearer to the minimum"
    return NotConverged("fit", got=f"{MOST_ITERATIONS} iterations", expected="a minimum", do=do)


def differences(
    function: History, parameters: Sequence[Parameter], values: Values, names: Sequence[str] | None = None
) -> Floats:
    """Derivatives [N, p] of a function of the parameters by some of them, all without `names`, by central differences
    within their bounds."""
    columns = []
    for one in parameters:
        if names is not None and one.name not in names:
            continue
        step = abs(one.scale) * STEP * max(abs(values[one.name] / one.scale), SMALLEST)
        up, down = min(values[one.name] + step, one.high), max(values[one.name] - step, one.low)
        change = function({**values, one.name: up}) - function({**values, one.name: down})
        columns.append(change / (up - down))
    return np.stack(columns, axis=1)


def refuse_unidentifiable(names: Sequence[str], derivatives: Floats, size: float) -> None:
    """Raise InputError for parameters on which data of norm `size` do not depend: derivatives [N, p] by the scaled
    ones, of which one is zero."""
    lengths = np.linalg.norm(derivatives, axis=0)
    deaf = [name for name, length in zip(names, lengths, strict=True) if length <= MIN_SENSITIVITY * size]
    if deaf:
        raise InputError(
            "fit " + " and ".join(deaf),
            got="data that do not depend on it",
            expected="a parameter that changes them",
            do="remove it, or measure another quantity",
        )


# ----------------------------------------------------------------------------------------------------------------------
# When not to trust a fit: a law that does not match, noise unlike what the intervals assume, open parameters.
# ----------------------------------------------------------------------------------------------------------------------

POOR, WRONG = 0.05, 0.2  # residuals over the measured history, root mean squares: told, and not to be trusted
WHITE = 4.0  # standard deviations of the correlation of white noise
FEWEST = 20  # residuals of a series, from which on their correlation means something
QUIET = 0.5  # rms of residuals over the scatter, below which it does not matter whether they are noise
RESIDUAL_ROUNDING = 1e-5  # residuals over the history that are no noise but rounding
OPEN = 0.5  # half width of an interval over its value
FAR = 5.0  # times the scatter: the model is another one


class Left(NamedTuple):
    """What a fit leaves of one set of data: residuals over their scatter, in how many series, whether the scatter was
    stated, the norm of what was measured, 0 of what is judged by its scatter alone, how many independent numbers
    they are, and what may be wrong with the data themselves."""

    name: str
    residuals: Floats
    tracks: int
    known: bool
    size: float
    numbers: int
    doubt: str = ""

    @property
    def rms(self) -> float:
        """Root mean square of the residuals; 0 of none, as of shapes at as many places as there are partners."""
        return float(np.sqrt((self.residuals**2).sum() / max(self.numbers, 1)))


def fit_findings(
    fit: Fit, sets: Sequence[Left] | None = None, combinations: Sequence[Combination] = ()
) -> tuple[Finding, ...]:
    """Reasons not to trust a fit, with their numbers.

    Parameters
    ----------
    sets : Sequence[Left] | None
        Of data; without them they are one history.
    """
    if sets is None:
        size = float(np.linalg.norm(fit.residuals)) / np.sqrt(max(1.0 - fit.explained, 1e-300))
        sets = (Left("measured history", fit.residuals, 1, False, float(size), len(fit.residuals)),)
    return (
        *(finding for one in sets for finding in _left_over(one)),
        *(finding for one in sets for finding in _beyond_scatter(one)),
        *_at_zero(fit),
        *_at_bound(fit),
        *_not_distinguished(combinations),
        *_open(fit),
    )


def _left_over(one: Left) -> Iterator[Finding]:
    """Neighbouring residuals of white noise have a correlation of 0 +- 1 / sqrt(N); those of a wrong law have more."""
    size = one.size or float(np.sqrt(len(one.residuals)))
    share = float(np.linalg.norm(one.residuals)) / size
    if not one.tracks or share < RESIDUAL_ROUNDING:
        return
    left = one.residuals.reshape(one.tracks, -1)
    pairs = left[:, 1:].size
    together, spread = float((left[:, 1:] * left[:, :-1]).sum() / (left**2).sum()), 1.0 / np.sqrt(max(pairs, 1))
    quiet = not one.size and share < QUIET
    coloured = together > WHITE * spread and left.shape[1] >= FEWEST and not quiet
    if one.size and share > POOR:
        why = "Try another law, a delay, or a start nearer to the minimum" if coloured else "It is probably noise"
        yield Finding(
            "poor-fit",
            f"The residuals of the best fit have {100 * share:.0f} % of the rms of the measured history. {why}",
            {"left_over": share, "expected": POOR},
            severe=coloured and share > WRONG,
        )
    if coloured:
        wider = float(np.sqrt((1.0 + together) / (1.0 - together)))
        where = "" if one.size else f"{one.name}: "
        yield Finding(
            "residuals-not-noise",
            f"{where}Neighbouring residuals are correlated ({together:.2f}; noise has up to {WHITE * spread:.2f}): the "
            f"law is not exact, or the data were filtered. The intervals should be about {wider:.1f} times as wide; "
            "with a wrong law the error may be larger",
            {"correlation": together, "expected": WHITE * spread, "wider": wider},
        )


def _beyond_scatter(one: Left) -> Iterator[Finding]:
    count, rms = one.numbers, one.rms
    if one.size or count * rms**2 <= count + EXCEEDED * np.sqrt(2.0 * count):
        return
    taken = "stated" if one.known else "usual"
    yield Finding(
        "fit-beyond-scatter",
        f"{one.name}: the residuals have {rms:.2g} times the {taken} scatter. The intervals follow the residuals; of a "
        f"model that is not right the error may be larger{one.doubt and f'. {one.doubt}'}",
        {"times": rms, "numbers": float(count)},
        severe=rms > FAR,
    )


def _at_zero(fit: Fit) -> Iterator[Finding]:
    for name in fit.at_zero:
        yield Finding(
            "fitted-zero",
            f"{name}: the best value is 0, the end of its range; at most {max(abs(fit.low[name]), fit.high[name]):.3g} "
            "is compatible with the data",
            {"value": fit.values[name], "most": max(abs(fit.low[name]), fit.high[name])},
        )


def _at_bound(fit: Fit) -> Iterator[Finding]:
    for name in fit.at_bound:
        yield Finding(
            "parameter-at-bound",
            f"{name}: the best value, {fit.values[name]:.5g}, is at the bound that was given: the data ask for one "
            "beyond it. It has no interval. The other parameters, and their intervals, are those that belong to the "
            "bound",
            {"value": fit.values[name]},
        )


def _not_distinguished(combinations: Sequence[Combination]) -> Iterator[Finding]:
    for one in combinations:
        ending = ". Their values are those nearest to the starts; fix one of them, or measure what distinguishes them"
        yield Finding(
            "parameters-not-distinguished",
            one.sentence + (ending if np.isinf(one.half_along) else ""),
            {f"change_{i}": change for i, change in enumerate(one.changes, 1)},
        )


def _open(fit: Fit) -> Iterator[Finding]:
    for name, value in fit.values.items():
        half = 0.5 * (fit.high[name] - fit.low[name])
        if name not in (*fit.at_zero, *fit.shifts) and np.isfinite(half) and half > OPEN * abs(value):
            yield Finding(
                "parameter-open",
                f"{name}: {value:.3g} +- {half:.2g}: the data do not determine it",
                {"value": value, "half_width": half},
            )
