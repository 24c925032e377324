"""What is to be known of low bands: those of a room and places that are far from what others would have."""

from __future__ import annotations

from typing import Final

from acoustics.levels.rated import RatedRoom
from femstruct.errors import Finding

BEYOND_DB: Final = 1.0  # by which a band may be outside the interval before it is said


def ensemble_findings(rated: RatedRoom) -> tuple[Finding, ...]:
    """A finding of one room where single bands of it lie outside the interval of rooms and places like its own."""
    if rated.ensemble is None:
        return ()
    off = {}
    for band, level, one in zip(rated.bands_hz, rated.bands_db.values(), rated.intervals, strict=True):
        beyond = max(level - one.high, one.low - level)
        if beyond > BEYOND_DB:
            off[band] = level - one.mean
    if not off:
        return ()
    worst = max(off, key=lambda band: abs(off[band]))
    told = ", ".join(f"{band:g} Hz by {above:+.1f} dB" for band, above in off.items())
    return (
        Finding(
            "band-of-one-room",
            f"levels of this room and these places differ from the mean of {rated.ensemble.rooms} rooms with sides "
            f"within 5 % and of other {rated.ensemble.moved}: {told}. Nine measurements of ten are nearer to that "
            "mean: use it",
            {"bands": len(off), "worst_hz": worst, "worst_db": off[worst], "rooms": rated.ensemble.rooms},
        ),
    )
