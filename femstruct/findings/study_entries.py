"""Findings on a run as a whole."""

from __future__ import annotations

from typing import Final

from femstruct.findings.entry import FORBIDS, Entry

STUDY: Final = (
    Entry(
        "interrupted",
        "The run was interrupted, so cases are missing.",
        FORBIDS,
        "Ctrl-C or a signal ended the run after the baseline; exit code 130",
        "Run again.",
    ),
)
