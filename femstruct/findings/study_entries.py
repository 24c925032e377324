"""Findings on a run as a whole, and on what is asked of recorded histories."""

from __future__ import annotations

from typing import Final

from femstruct.findings.entry import CHOSEN, FORBIDS, LIMITS, Entry, Limit

STUDY: Final = (
    Entry(
        "interrupted",
        "The run was interrupted, so cases are missing.",
        FORBIDS,
        "Ctrl-C or a signal ended the run after the baseline; exit code 130",
        "Run again.",
    ),
    Entry(
        "spectrum-beyond-modes",
        "A shock response spectrum is asked for beyond the modes.",
        LIMITS,
        "the modes are complete below the end of the band of a shock response spectrum only",
        "Compute modes up to the end of the band, or do not quote the spectrum above the last mode.",
    ),
    Entry(
        "evaluation-not-converged",
        "A shock response spectrum or a weighted vibration depends on the modes that are left out.",
        LIMITS,
        "residual vectors change a number of it by more than the threshold, or it is at a frequency beyond the modes; "
        "where contacts reach beyond the modes, also what half of the residual vectors change, and twice the threshold "
        "what all change, in the contact forces too, and what the rebound of a force with force-beyond-modes changes",
        "Do not quote the numbers with '?'. Compute more modes.",
        (Limit(0.05, "% of the number", "more changes a figure that is quoted", CHOSEN, "peaks.CONVERGED"),),
    ),
    Entry(
        "perception-beyond-modes",
        "The modes end below the highest frequency at which people feel vibration.",
        LIMITS,
        "the modes are complete below the threshold only; vibration above them is missing in what is weighted",
        "Compute modes up to the threshold or more. Where nothing excites vibration above the last mode, the numbers "
        "hold.",
        (
            Limit(
                80.0,
                "Hz",
                "upper end of the range that ISO 2631 and DIN 4150-2 judge",
                "ISO 2631-2:2003, title; DIN 4150-2:1999",
                "perception.FELT_HZ",
            ),
        ),
    ),
)
