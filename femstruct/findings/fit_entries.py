"""Findings on numbers that are fitted to what was measured."""

from __future__ import annotations

from typing import Final

from femstruct.findings.entry import CHOSEN, LIMITS, REMARK, Entry, Limit

FITS: Final = (
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
        "Remove the parameter, or quote the value that the message states with 'at most'.",
    ),
    Entry(
        "parameter-open",
        "The measurement does not determine the parameter.",
        LIMITS,
        "half the confidence interval is more than the threshold share of the value",
        "Fix the parameter, or measure a quantity that depends on it.",
        (Limit(0.5, "% of the value", "not even the first digit is known", CHOSEN, "fit_findings.OPEN"),),
    ),
    Entry(
        "fit-beyond-scatter",
        "The residuals of a set of data are larger than its scatter.",
        LIMITS,
        "their sum of squares, over the scatter, is more than chance makes it",
        "State a scatter that holds mounting and repetition, too; remove data of another state; free what is wrong in "
        "the model; give frequencies a column 'mode', as one may be missing among them.",
        (
            Limit(
                4.0,
                "standard deviations of chi-squared",
                "chance hardly exceeds it",
                "normal distribution",
                "intervals.EXCEEDED",
            ),
            Limit(5.0, "times the scatter", "the model is another one", CHOSEN, "fit_findings.FAR", forbids=True),
        ),
        forbids="the residuals are more than 5 times the scatter",
    ),
    Entry(
        "parameters-not-distinguished",
        "The data do not distinguish some parameters: they determine only a combination of them.",
        LIMITS,
        "a combination of changes alters nothing in the data, or so little that half its interval is more than the "
        "threshold",
        "Use what is determined, fix one of the parameters at a known value, or measure what distinguishes them: the "
        "mass, another mode, a force.",
        (
            Limit(
                0.5,
                "% along the combination",
                "not even the first digit is known",
                CHOSEN,
                "undetermined.HARDLY",
            ),
        ),
    ),
    Entry(
        "parameter-at-bound",
        "The best value of a parameter is at a bound that was given.",
        LIMITS,
        "the fit ends at a bound of --fit",
        "Widen the bound, or find what else in the model asks for a value beyond it.",
    ),
    Entry(
        "mode-pair-lost",
        "A measured mode has no mode of the model of its shape.",
        LIMITS,
        "the largest MAC, among near-equal frequencies that with their space, is less than the threshold",
        "Start nearer to the data, look at 'femstruct mac', or remove the mode from the file.",
        (Limit(0.6, "MAC", "the same mode shares more than half of its motion", CHOSEN, "modes.LIKE"),),
    ),
    Entry(
        "mode-pair-swapped",
        "A measured mode has another partner at the end of the fit than at its start.",
        REMARK,
        "the number of the mode that is most alike changed on the way",
        "Check the pairs that the table shows; they follow the shapes, not the order.",
    ),
    Entry(
        "pairs-by-order",
        "Measured frequencies without shapes are compared with the modes of the model in their order.",
        LIMITS,
        "a table of frequencies has no column of mode numbers",
        "Add a column 'mode' with the numbers that 'femstruct modes' prints, or measure shapes.",
    ),
)
