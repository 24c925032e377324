"""Rooms as the standards state them: a row for every case, and their bands side by side."""

from __future__ import annotations

from math import isfinite

from acoustics.ratings import HeavyImpactRating, ImpactRating
from femstruct.study.result import CaseResult, StudyResult
from femstruct.view.grid import Grid

ASSUMED = "the floor alone radiates, no flanking; walls and floor of the room are rigid but for its reverberation time"


def ratings(result: StudyResult) -> Grid:
    """A row for every case and rated room: single numbers, difference to the baseline, spreads, deciding band."""
    rooms = [(name, room, one) for name, case in result.cases.items() for room, one in case.rated.items()]
    symbols = list(dict.fromkeys(symbol for _, _, one in rooms for symbol in (one.quantity, one.plain_quantity)))
    baseline = result.comparison.baseline
    grid = Grid(
        f"impact sound by the standards ({ASSUMED})",
        (
            "case",
            "room",
            *(f"{symbol} [dB]" for symbol in symbols),
            "difference [dB]",
            "spread over drops [dB]",
            "over receivers [dB]",
            "decided at [Hz]",
        ),
        keys=2,
    )
    for name, room, one in rooms:
        if one.rating is None or one.plain_rating is None:
            continue
        numbers = {one.plain_quantity: _told(one.plain_rating), one.quantity: _told(one.rating)}
        beside = result.cases[baseline].rated.get(room)
        change = None if beside is None else one.above(beside)
        grid.add(
            name,
            room,
            *(numbers.get(symbol, "-") for symbol in symbols),
            "" if name == baseline else "-" if change is None else f"{change:+.1f}",
            f"{_number(one.drops_spread_db)} ({one.drops})",
            f"{_number(one.receivers_spread_db)} ({one.receivers})",
            f"{one.rating.deciding_hz:g}",
        )
    return grid


def first_drop(result: StudyResult) -> str:
    """A sentence that says which drop all but the ratings is of, where a source strikes several places; "" else."""
    count = max((len(case.drops) for case in result.cases.values()), default=0)
    if not count:
        return ""
    return f"the source strikes {count} places; ratings are of all, the rest is of the first, {struck_first(result)}"


def struck_first(result: StudyResult) -> str:
    """The place that histories and pictures are of, where a source strikes several; "" else."""
    return ", ".join(dict.fromkeys(next(iter(case.drops)) for case in result.cases.values() if case.drops))


def bands(result: StudyResult) -> Grid:
    """Third octaves of every rated room and their spread over drops and receivers; rows only where there are any."""
    grid = Grid(
        "impact sound by third octave, re 20 uPa: average over drops and receivers (spread)", ("", *result.cases)
    )
    cases = result.cases.values()
    for room in dict.fromkeys(room for case in cases for room in case.rated):
        first = next(case.rated[room] for case in cases if room in case.rated)
        for band in first.bands_db:
            grid.add(f"{room} {first.band_quantity} {band:g} Hz [dB]", *(_band(case, room, band) for case in cases))
    return grid


def _told(rating: HeavyImpactRating | ImpactRating) -> str:
    """A single number; of a tapping machine's with C_I in brackets, as ISO 717-2 states it."""
    if isinstance(rating, ImpactRating):
        return f"{rating.weighted_db:g} ({rating.adaptation_db:+g})"
    return f"{rating.rating_db}"


def _number(value: float) -> str:
    return f"{value:.1f}" if isfinite(value) else "-"


def _band(case: CaseResult, room: str, band: float) -> str:
    found = case.rated.get(room)
    if found is None or band not in found.bands_db:
        return "-"
    spread = found.spread_db[band]
    return f"{found.bands_db[band]:.1f}" + (f" ({spread:.1f})" if isfinite(spread) else "")
