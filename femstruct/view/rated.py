"""Rooms as the standards state them, case beside case."""

from __future__ import annotations

from femstruct.study.result import CaseResult, StudyResult
from femstruct.view.grid import Grid


def rated(result: StudyResult) -> Grid:
    """Single number, the band that decides it, and third octaves of every rated room; rows only where there are any."""
    grid = Grid("impact sound by standards, re 20 uPa: energy average over receivers (spread)", ("", *result.cases))
    cases = result.cases.values()
    for room in dict.fromkeys(room for case in cases for room in case.rated):
        first = next(case.rated[room] for case in cases if room in case.rated)
        if first.rating is not None:
            grid.add(f"{room} {first.quantity} [dB]", *(_rating(case, room) for case in cases))
            grid.add(f"{room} decided at [Hz]", *(_deciding(case, room) for case in cases))
        for band in first.bands_db:
            grid.add(f"{room} {first.band_quantity} {band:g} Hz [dB]", *(_band(case, room, band) for case in cases))
    return grid


def _rating(case: CaseResult, room: str) -> str:
    found = case.rated.get(room)
    if found is None or found.rating is None:
        return "-"
    return f"{found.rating.rating_db} ({found.rating_spread_db:.1f})"


def _deciding(case: CaseResult, room: str) -> str:
    found = case.rated.get(room)
    return "-" if found is None or found.rating is None else f"{found.rating.deciding_hz:g}"


def _band(case: CaseResult, room: str, band: float) -> str:
    found = case.rated.get(room)
    return "-" if found is None else f"{found.bands_db[band]:.1f} ({found.spread_db[band]:.1f})"
