"""Findings on a run as a whole, and on numbers identified from a measurement."""

from __future__ import annotations

from typing import Final

from femstruct.findings.entry import CHOSEN, FORBIDS, LIMITS, REMARK, Entry, Limit

STUDY: Final = (
    Entry(
        "interrupted",
        "The run was interrupted, so cases are missing.",
        FORBIDS,
        "Ctrl-C or a signal ended the run after the baseline; exit code 130",
        "Run again.",
    ),
    Entry(
        "poor-fit",
        "The best fit leaves a large part of the measured history unexplained.",
        LIMITS,
        "the rms of the residuals is more than the threshold share of that of the measured history",
        "Try another contact law, '--delay', or a start nearer to the minimum.",
        (
            Limit(0.05, "% of the measured rms", "a good fit leaves less", CHOSEN, "fit_findings.POOR"),
            Limit(
                0.2,
                "% of it, if correlated",
                "the law is another one",
                CHOSEN,
                "fit_findings.WRONG",
                forbids=True,
            ),
        ),
        forbids="residuals of more than 20 % are correlated, so that they are no noise",
    ),
    Entry(
        "residuals-not-noise",
        "The residuals of the fit are correlated, so the confidence intervals are too narrow.",
        LIMITS,
        "the correlation of neighbouring residuals is more than that of white noise",
        "Widen the intervals by the stated factor, or try another contact law.",
        (
            Limit(
                4.0,
                "standard deviations of the correlation of white noise",
                "chance exceeds it once in 31 000",
                "normal distribution",
                "fit_findings.STRAY",
            ),
        ),
    ),
    Entry(
        "fitted-zero",
        "The best value of a parameter is zero, the end of its range.",
        REMARK,
        "the fit ends at 0",
        "Remove the parameter, or quote its upper bound.",
    ),
    Entry(
        "parameter-open",
        "The measurement does not determine the parameter.",
        LIMITS,
        "half the confidence interval is more than the threshold share of the value",
        "Fix the parameter, or measure a quantity that depends on it.",
        (Limit(0.5, "% of the value", "not even the first digit is known", CHOSEN, "fit_findings.OPEN"),),
    ),
)
