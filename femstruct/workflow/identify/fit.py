"""Least squares with confidence intervals: which parameters make what is computed match what was measured."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final

import numpy as np
import scipy

from femstruct.arrays import Floats
from femstruct.errors import InputError, NotConverged
from femstruct.workflow.identify.intervals import Fit, Parameter, Values, inverse, judged, unseen

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

    history : the computed history [N], at the measured times, for values of the parameters by name.
    start : values to start from, not zero; a parameter keeps the sign of its start, and may end at zero.
    shifts : parameters that start at zero and may have either sign, with a change of each that counts as 1.

    Raises InputError for a parameter of which the data do not depend, by name, and for too few samples or a start of
    zero; NotConverged after 100 iterations.

    Notes
    -----
    Intervals are p +- t s sqrt(diag (J^T J)^-1), t of Student's distribution for N - p degrees of freedom, s^2 the
    residual variance, J from central differences. They assume that the model is right, that its history is nearly
    linear in the parameters over the interval, and that the noise is normal, the same at all samples, and independent
    from one sample to the next; `femstruct.workflow.identify.fit_findings` says where that is not so. Of a parameter at
    zero only the upper end means something. Combinations that the data leave open stay where they start: `Fit.open`.

    References
    ----------
    Seber and Wild, Nonlinear Regression (1989), sections 2.1.2 and 5.1.

    >>> t = np.linspace(0.0, 3.0, 50)
    >>> found = fit(lambda p: p["a"] * np.exp(-p["b"] * t), 2.0 * np.exp(-0.5 * t), {"a": 1.0, "b": 1.0})
    >>> {name: round(value, 6) for name, value in found.values.items()}
    {'a': 2.0, 'b': 0.5}
    """
    parameters = [parameter(name, value) for name, value in start.items()]
    parameters += [Parameter(name, 0.0, -np.inf, np.inf, size) for name, size in (shifts or {}).items()]

    def residuals(values: Values) -> Floats:
        return history(values) - measured

    return fitted(residuals, parameters, float(np.linalg.norm(measured)), confidence=confidence)


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


def fitted(
    residuals: History,
    parameters: Sequence[Parameter],
    size: float,
    jacobian: Callable[[Values], Floats] | None = None,
    known: bool = False,
    confidence: float = 0.95,
    count: Callable[[Values], int] | None = None,
) -> Fit:
    """Parameters with the least sum of squares of residuals [N], between their bounds.

    residuals : computed less measured, over its scatter. size : norm of what was measured, over its scatter.
    jacobian : derivatives [N, p] of the residuals by the parameters; central differences without it. known : whether
    the scatter was stated for all data: intervals are then those of the normal distribution, unless the residuals
    exceed it. count : how many independent numbers the residuals are; N without it.

    Raises as `fit`.
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
    refuse_unseen(names, first, size)
    if len(unseen(first)):
        x, rest = _truncated(left, derivatives, begin, (lowest, highest))
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
        x, rest = found.x, found.fun
    there = derivatives(x)
    refuse_unseen(names, there, size)
    return judged(parameters, x, rest, there, size, known, confidence, runs, numbers(x))


def _truncated(
    left: Callable[[Floats], Floats], derivatives: Callable[[Floats], Floats], x: Floats, ends: tuple[Floats, Floats]
) -> tuple[Floats, Floats]:
    """The minimum and the residuals there by shortest steps of Gauss and Newton: along combinations that the data leave
    open there are none."""
    rest = left(x)
    for _ in range(MOST_ITERATIONS):
        jacobian = derivatives(x)
        step = -inverse(jacobian, unseen(jacobian)) @ (jacobian.T @ rest)
        for _ in range(HALVINGS):
            tried = x + step.clip(0.5 * (ends[0] - x), 0.5 * (ends[1] - x))  # never beyond half the way to a bound
            new = left(tried)
            if float(new @ new) <= (1.0 + SQUARES) * float(rest @ rest):
                break
            step = 0.5 * step
        else:
            return x, rest
        moved, x, rest = float(np.abs(tried - x).max()), tried, new
        if moved <= SETTLED * float(np.abs(x).max()):
            return x, rest
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


def refuse_unseen(names: Sequence[str], derivatives: Floats, size: float) -> None:
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
