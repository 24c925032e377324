"""Low bands as a laboratory would find them: over rooms of nearly one size, places of the source and microphones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Final, NamedTuple

import numpy as np

from acoustics.arrays import Floats, freeze, frozen
from acoustics.levels.single_number import Number, single_number
from acoustics.reported import Reported
from acoustics.tags import stored_as

_ROUNDING_DB: Final = 1e-9
TWO_SIDED_90: Final = 1.645  # standard deviations of a normal variable that hold 90 %


class Interval(NamedTuple):
    """Mean of a level and the limits between which nine measurements of ten lie [dB]."""

    mean: float
    low: float
    high: float


@stored_as("ensemble of rooms/1")
@dataclass(frozen=True, eq=False)
class Ensemble:
    """Levels of one floor over rooms and places {member, band}.

    members_db [m, b] : level of each member in the room, averaged over its places as its standard does [dB]; nan in
    bands that are not low. correction_db [m, b] : what standardising adds for the member's own volume. rooms : how many
    rooms the members are of. moved : what else is drawn anew.
    """

    members_db: Annotated[Floats, Reported("dB re 20 µPa", "Level of one member", along=("member", "band_hz"))]
    correction_db: Annotated[Floats, Reported("dB", "What standardising adds", along=("member", "band_hz"))]
    rooms: Annotated[int, Reported("1", "Rooms of the ensemble, sides within 5 %")]
    moved: Annotated[str, Reported("1", "What is drawn anew beside the rooms")]

    def __post_init__(self) -> None:
        members = frozen("members", self.members_db, (None, None), blanks=True)
        correction = frozen("members' correction", self.correction_db, members.shape)
        freeze(self, members_db=members, correction_db=correction)

    @property
    def intervals(self) -> list[Interval]:
        """Of every band, standardised; nan where it is not low."""
        return [interval(one.tolist()) for one in (self.members_db + self.correction_db).T]

    def numbers(self, numbers: Sequence[Number], bands_hz: Sequence[float], others_db: Floats) -> dict[str, Interval]:
        """Single numbers before rounding over the members {symbol: interval}, of those that are known and that low
        bands change: where others decide in every member, an interval would say nothing of rooms and places.

        bands_hz [b] : nominal centres [Hz]. others_db [b] : levels in the room of the bands that are not low [dB].
        """
        members, found = np.where(np.isnan(self.members_db), others_db, self.members_db), {}
        for one in numbers:
            alike, own = (
                [single_number(one, bands_hz, row[None]).known_db for row in members + correction * one.standardised]
                for correction in (self.correction_db.mean(axis=0), self.correction_db)
            )
            if np.ptp(alike) > _ROUNDING_DB:
                found[one.symbol] = interval(own)
        return found


def interval(levels_db: Sequence[float]) -> Interval:
    """Mean and 90 % interval of one more member of an ensemble of levels [dB], nan where one is not known.

    Notes
    -----
    Normal in decibels; the mean of some members is itself uncertain, by one part in their number of the variance.

    >>> [round(one, 2) for one in interval([60.0, 62.0, 64.0, 62.0])]
    [62.0, 59.0, 65.0]
    """
    levels = np.asarray(levels_db)
    mean = float(levels.mean())
    half = TWO_SIDED_90 * float(levels.std(ddof=1)) * (1 + 1 / len(levels)) ** 0.5
    return Interval(mean, mean - half, mean + half)
