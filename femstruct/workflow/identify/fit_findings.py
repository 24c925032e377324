"""When not to trust a fit: a law that does not match, noise unlike what the intervals assume, open parameters."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import Finding
from femstruct.workflow.identify.intervals import EXCEEDED, Fit
from femstruct.workflow.identify.undetermined import Combination

POOR, WRONG = 0.05, 0.2  # residuals over the measured history, root mean squares: told, and not to be trusted
STRAY = 4.0  # standard deviations of the correlation of white noise
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
    """Reasons not to trust a fit, with their numbers. sets : of data; without them they are one history."""
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
    coloured = together > STRAY * spread and left.shape[1] >= FEWEST and not quiet
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
            f"{where}Neighbouring residuals are correlated ({together:.2f}; noise has up to {STRAY * spread:.2f}): the "
            f"law is not exact, or the data were filtered. The intervals should be about {wider:.1f} times as wide; "
            "with a wrong law the error may be larger",
            {"correlation": together, "expected": STRAY * spread, "wider": wider},
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
        told = ". Their values are those nearest to the starts; fix one of them, or measure what distinguishes them"
        yield Finding(
            "parameters-not-distinguished",
            one.sentence + (told if np.isinf(one.half_along) else ""),
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
