"""Least squares with confidence intervals: which parameters make a computed history match a measured one."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from femstruct.arrays import Floats, freeze, frozen
from femstruct.errors import InputError, NotConverged

STEP = 1e-3  # of a parameter, for its derivative: truncation 1e-6, and an engine that errs by 1e-8 adds 1e-5
SMALLEST = 0.1  # of its start: the least a parameter counts for in that step
MIN_SENSITIVITY = 1e-6  # change of the history over the history itself, for a change by the whole parameter
MIN_SINGULAR_VALUE = (
    1e-4  # smallest singular value of the derivatives, each of length 1: above the error of the derivatives
)
INVOLVED = 0.1  # share of a parameter in a combination that the data leave open, from which on it is named
AT_BOUND = 0.01  # of its standard deviation: a parameter that small is at its bound
MOST_ITERATIONS = 100
History = Callable[[Mapping[str, float]], Floats]


@dataclass(frozen=True, eq=False)
class Fit:
    """Values with intervals, from N measured samples.

    values, deviations : estimates and their standard deviations, by name. low, high : their confidence intervals.
    shifts : names of those that have no size of their own. at_zero : names of those that ended at their bound.
    correlation [p, p] : of the estimates, in their order. noise : standard deviation of the residuals. explained :
    share of the sum of squares of the measured history. residuals [N] : computed less measured. runs : how often the
    history was computed.
    """

    values: Mapping[str, float]
    deviations: Mapping[str, float]
    low: Mapping[str, float]
    high: Mapping[str, float]
    shifts: tuple[str, ...]
    at_zero: tuple[str, ...]
    confidence: float
    correlation: Floats
    noise: float
    explained: float
    residuals: Floats
    runs: int

    def __post_init__(self) -> None:
        p = len(self.values)
        freeze(
            self,
            correlation=frozen("fit correlation", self.correlation, (p, p)),
            residuals=frozen("fit residuals", self.residuals, (None,)),
        )


def fit(
    history: History,
    measured: Floats,
    start: Mapping[str, float],
    shifts: Mapping[str, float] | None = None,
    confidence: float = 0.95,
) -> Fit:
    """Parameters with which a history comes closest to a measured one, by the sum of squares.

    history : the computed history [N], at the measured times, for values of the parameters by name.
    start : values to start from, not zero; a parameter keeps the sign of its start, and may end at zero.
    shifts : parameters that start at zero and may have either sign, with a change of each that counts as 1.

    Raises InputError when the data cannot determine a parameter, by name, and for too few samples or a start of zero;
    NotConverged after 100 iterations.

    Notes
    -----
    Intervals are p +- t s sqrt(diag (J^T J)^-1), t of Student's distribution for N - p degrees of freedom, s^2 the
    residual variance, J from central differences. They assume that the model is right, that its history is nearly
    linear in the parameters over the interval, and that the noise is normal, the same at all samples, and independent
    from one sample to the next; `femstruct.workflow.identify.fit_findings` says where that is not so. Of a parameter at
    zero only the upper end means something.

    References
    ----------
    Seber and Wild, Nonlinear Regression (1989), sections 2.1.2 and 5.1.

    >>> t = np.linspace(0.0, 3.0, 50)
    >>> found = fit(lambda p: p["a"] * np.exp(-p["b"] * t), 2.0 * np.exp(-0.5 * t), {"a": 1.0, "b": 1.0})
    >>> {name: round(value, 6) for name, value in found.values.items()}
    {'a': 2.0, 'b': 0.5}
    """
    shifts = shifts or {}
    for name, value in start.items():
        if not value or not np.isfinite(value):
            raise InputError(f"fit {name}", got=f"a start of {value:g}", expected="a finite start other than 0")
    names, bounded = [*start, *shifts], np.arange(len(start) + len(shifts)) < len(start)
    scale, lowest = np.array([*start.values(), *shifts.values()]), np.where(bounded, 0.0, -np.inf)
    n, p = len(measured), len(names)
    if n <= p:
        raise InputError("measured", got=f"{n} samples", expected=f"more than {p}, one for each parameter")
    runs = 0

    def residuals(x: Floats) -> Floats:
        nonlocal runs
        runs += 1
        return history(dict(zip(names, (scale * x).tolist(), strict=True))) - measured

    def derivatives(x: Floats) -> Floats:
        columns = []
        for i, step in enumerate(STEP * np.maximum(np.abs(x), SMALLEST)):
            up, down = x.copy(), x.copy()
            up[i], down[i] = x[i] + step, max(x[i] - step, lowest[i])
            columns.append((residuals(up) - residuals(down)) / (up[i] - down[i]))
        return np.stack(columns, axis=1)

    begin = np.where(bounded, 1.0, 0.0)
    size = float(np.linalg.norm(measured))
    refuse_undetermined(names, derivatives(begin), size)
    # x only: what is fitted exactly has no sum of squares left whose change could be judged
    found = scipy.optimize.least_squares(
        residuals, begin, derivatives, (lowest, np.inf), x_scale="jac", max_nfev=MOST_ITERATIONS, xtol=1e-9, gtol=1e-14
    )
    if found.status <= 0:
        raise NotConverged(
            "fit", got=f"{MOST_ITERATIONS} iterations", expected="a minimum", do="give starts nearer to the minimum"
        )
    left, jacobian = found.fun, derivatives(found.x)
    refuse_undetermined(names, jacobian, size)
    squares = float(left @ left)
    inverse = np.linalg.inv(jacobian.T @ jacobian)
    spread = np.sqrt(np.diag(inverse))
    noise = float(np.sqrt(squares / (n - p)))
    values, deviations = scale * found.x, noise * spread * np.abs(scale)
    at_zero = bounded & (found.x < np.maximum(AT_BOUND * noise * spread, STEP**2))  # the method keeps inside its bounds
    wide = float(scipy.special.stdtrit(n - p, 0.5 + 0.5 * confidence)) * deviations

    def by_name(column: Floats) -> dict[str, float]:
        return dict(zip(names, column.tolist(), strict=True))

    return Fit(
        values=by_name(values),
        deviations=by_name(deviations),
        low=by_name(values - wide),
        high=by_name(values + wide),
        shifts=tuple(shifts),
        at_zero=tuple(name for name, near in zip(names, at_zero, strict=True) if near),
        confidence=confidence,
        correlation=inverse / np.outer(spread, spread) * np.outer(np.sign(scale), np.sign(scale)),
        noise=noise,
        explained=1.0 - squares / size**2,
        residuals=left,
        runs=runs,
    )


def refuse_undetermined(names: Sequence[str], derivatives: Floats, size: float) -> None:
    """Raise InputError where a history of norm `size` does not tell all parameters: derivatives [N, p] by the scaled
    ones, of which one is zero or which depend on each other; it names those that do."""
    lengths = np.linalg.norm(derivatives, axis=0)
    deaf = [name for name, length in zip(names, lengths, strict=True) if length <= MIN_SENSITIVITY * size]
    if deaf:
        raise InputError(
            "fit " + " and ".join(deaf),
            got="a history that does not depend on it",
            expected="a parameter that changes it",
            do="remove it, or measure another quantity",
        )
    _, singular, directions = np.linalg.svd(derivatives / lengths, full_matrices=False)
    if singular[-1] < MIN_SINGULAR_VALUE:
        mixed = [name for name, share in zip(names, directions[-1], strict=True) if abs(share) > INVOLVED]
        raise InputError(
            "fit " + " and ".join(mixed),
            got=f"the same change of the history with each of them (singular value {singular[-1]:.1g})",
            expected="parameters whose effects differ",
            do="fix one of them at a known value",
        )
