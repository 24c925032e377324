"""When not to believe a fit: a law that does not match, noise unlike what the intervals assume, open parameters."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from femstruct.errors import Finding
from femstruct.workflow.fit import Fit

POOR, WRONG = 0.98, 0.8  # explained share of the measured history: told, and not to be trusted
STRAY = 4.0  # standard deviations of the correlation of white noise
ROUNDING = 1e-10  # share of the history left over that is no noise but rounding
OPEN = 0.5  # half width of an interval over its value


def fit_findings(fit: Fit) -> tuple[Finding, ...]:
    """Reasons not to believe a fit, with their numbers."""
    return (*_poor(fit), *_coloured(fit), *_at_zero(fit), *_open(fit))


def _poor(fit: Fit) -> Iterator[Finding]:
    if fit.explained < POOR:
        yield Finding(
            "poor-fit",
            f"The best fit explains {100 * fit.explained:.1f} % of the measured sum of squares: another law, a delay, "
            "or a start nearer to the minimum; the intervals say nothing of that",
            {"explained": fit.explained, "expected": POOR},
            severe=fit.explained < WRONG,
        )


def _coloured(fit: Fit) -> Iterator[Finding]:
    """Neighbouring residuals of white noise have the correlation 0 +- 1 / sqrt(N)."""
    left = fit.residuals
    squares = float(left @ left)
    if 1.0 - fit.explained < ROUNDING:
        return
    together, spread = float(left[1:] @ left[:-1]) / squares, 1.0 / np.sqrt(len(left))
    if together > STRAY * spread:
        wider = float(np.sqrt((1.0 + together) / (1.0 - together)))
        yield Finding(
            "residuals-not-noise",
            f"Neighbouring residuals go together (correlation {together:.2f}, noise has up to {STRAY * spread:.2f}): "
            f"the law is not quite right, or the data were filtered; the intervals should be about {wider:.1f} times "
            "as wide, and a wrong law may be off by more",
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
                f"{name}: {value:.3g} +- {half:.2g}: the data hardly determine it",
                {"value": value, "half_width": half},
            )
