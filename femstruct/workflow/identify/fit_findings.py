"""When not to trust a fit: a law that does not match, noise unlike what the intervals assume, open parameters."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from femstruct.errors import Finding
from femstruct.workflow.identify.fit import Fit

POOR, WRONG = 0.05, 0.2  # residuals over the measured history, root mean squares: told, and not to be trusted
STRAY = 4.0  # standard deviations of the correlation of white noise
RESIDUAL_ROUNDING = 1e-5  # residuals over the history that are no noise but rounding
OPEN = 0.5  # half width of an interval over its value


def fit_findings(fit: Fit) -> tuple[Finding, ...]:
    """Reasons not to trust a fit, with their numbers."""
    return (*_left_over(fit), *_at_zero(fit), *_open(fit))


def _left_over(fit: Fit) -> Iterator[Finding]:
    """Neighbouring residuals of white noise have a correlation of 0 +- 1 / sqrt(N); those of a wrong law have more."""
    share = float(np.sqrt(max(1.0 - fit.explained, 0.0)))
    if share < RESIDUAL_ROUNDING:
        return
    left = fit.residuals
    together, spread = float(left[1:] @ left[:-1] / (left @ left)), 1.0 / np.sqrt(len(left))
    coloured = together > STRAY * spread
    if share > POOR:
        why = "Try another law, a delay, or a start nearer to the minimum" if coloured else "It is probably noise"
        yield Finding(
            "poor-fit",
            f"The residuals of the best fit have {100 * share:.0f} % of the rms of the measured history. {why}",
            {"left_over": share, "expected": POOR},
            severe=coloured and share > WRONG,
        )
    if coloured:
        wider = float(np.sqrt((1.0 + together) / (1.0 - together)))
        yield Finding(
            "residuals-not-noise",
            f"Neighbouring residuals are correlated ({together:.2f}; noise has up to {STRAY * spread:.2f}): the law "
            "is not "
            f"exact, or the data were filtered. The intervals should be about {wider:.1f} times as wide; with a wrong "
            "law the error may be larger",
            {"correlation": together, "expected": STRAY * spread, "wider": wider},
        )


def _at_zero(fit: Fit) -> Iterator[Finding]:
    for name in fit.at_zero:
        yield Finding(
            "fitted-zero",
            f"{name}: the best value is 0, the end of its range; at most {max(abs(fit.low[name]), fit.high[name]):.3g} "
            "is compatible with the data",
            {"value": fit.values[name], "most": max(abs(fit.low[name]), fit.high[name])},
        )


def _open(fit: Fit) -> Iterator[Finding]:
    for name, value in fit.values.items():
        half = 0.5 * (fit.high[name] - fit.low[name])
        if name not in (*fit.at_zero, *fit.shifts) and half > OPEN * abs(value):
            yield Finding(
                "parameter-open",
                f"{name}: {value:.3g} +- {half:.2g}: the data do not determine it",
                {"value": value, "half_width": half},
            )
