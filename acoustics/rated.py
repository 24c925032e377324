"""A room's impact sound as the standards state it: levels by third octave over blows and receivers, and one number."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import isfinite
from types import MappingProxyType
from typing import Final, Literal

import numpy as np

from acoustics.arrays import Floats, freeze, frozen
from acoustics.errors import AcousticsError
from acoustics.ratings import (
    A_THIRDS,
    CURVE_THIRDS,
    HeavyImpactRating,
    ImpactRating,
    energy_average,
    heavy_impact_level,
    standardised_impact_level,
    standardised_maximum_level,
    weighted_impact_level,
)
from acoustics.room import Enclosed, t60_of

FIELD: Final = "ISO 16283-2"
RATING: Final = "ISO 717-2"
STANDARDS: Final = (FIELD, RATING)
Blows = Literal["heavy", "tapping"]
BANDS: Final[Mapping[Blows, tuple[float, ...]]] = MappingProxyType(
    {"heavy": tuple(A_THIRDS), "tapping": tuple(CURVE_THIRDS)}
)
_SYMBOLS: Final = {  # (blows, standardised): of the single number, of the bands
    ("heavy", True): ("L'_iA,Fmax,V,T", "L'_i,Fmax,V,T"),
    ("heavy", False): ("L_iA,Fmax", "L_i,Fmax"),
    ("tapping", True): ("L'_nT,w", "L'_nT"),
    ("tapping", False): ("L_i,w", "L_i"),
}


@dataclass(frozen=True, eq=False)
class RatedRoom:
    """What is heard of standard blows in one room, in third octaves.

    blows : heavy (rubber ball: maximum Fast levels, 50 to 630 Hz) or tapping (machine: levels of the mean square, 100
        to 3150 Hz). standards : those that were applied, of `STANDARDS`. bands_hz : nominal centres [b] [Hz].
    measured_db : levels in the room [drops, receivers, b] [dB]. correction_db : what ISO 16283-2 adds to them for the
        room's volume and reverberation time [b] [dB], 0 where it was not applied. t60_s : reverberation times [b] [s].

    Notes
    -----
    Energy averages are over all drops (places of the blow) and receivers alike, as ISO 16283-2 has it for fixed
    microphones. Spreads are standard deviations of a sample, nan for one value: of the rating over drops, each averaged
    over its receivers, and over receivers, each averaged over the drops.
    """

    blows: Blows
    standards: tuple[str, ...]
    bands_hz: tuple[float, ...]
    measured_db: Floats
    correction_db: Floats
    t60_s: Mapping[float, float]

    def __post_init__(self) -> None:
        bands = len(self.bands_hz)
        freeze(
            self,
            measured_db=frozen("measured levels", self.measured_db, (None, None, bands)),
            correction_db=frozen("correction", self.correction_db, (bands,)),
            t60_s=MappingProxyType(dict(self.t60_s)),
        )

    @property
    def quantity(self) -> str:
        """Symbol of the single number."""
        return _SYMBOLS[self.blows, FIELD in self.standards][0]

    @property
    def plain_quantity(self) -> str:
        """Symbol of `plain_rating`."""
        return _SYMBOLS[self.blows, False][0]

    @property
    def band_quantity(self) -> str:
        """Symbol of the levels by third octave."""
        return _SYMBOLS[self.blows, FIELD in self.standards][1]

    @property
    def drops(self) -> int:
        """At how many places the blow was struck."""
        return int(self.measured_db.shape[0])

    @property
    def receivers(self) -> int:
        """How many listened."""
        return int(self.measured_db.shape[1])

    @cached_property
    def bands_db(self) -> Mapping[float, float]:
        """Energy averages over drops and receivers {nominal centre [Hz]: `band_quantity` [dB]}."""
        return self._average(self.measured_db + self.correction_db)

    @cached_property
    def spread_db(self) -> Mapping[float, float]:
        """Standard deviation of a band's levels over all drops and receivers {nominal centre [Hz]: [dB]}."""
        return self._by_band(_deviation(self.measured_db.reshape(-1, len(self.bands_hz))))

    @cached_property
    def rating(self) -> HeavyImpactRating | ImpactRating | None:
        """Single number of `bands_db` by ISO 717-2, None where it was not applied."""
        return self._rated(self.bands_db) if RATING in self.standards else None

    @cached_property
    def unrounded_db(self) -> float | None:
        """The single number as finely as ISO 717-2 has it: before rounding, of a tapping machine in steps of 0.1 dB."""
        return self._finely(self.bands_db) if RATING in self.standards else None

    @cached_property
    def plain_rating(self) -> HeavyImpactRating | ImpactRating | None:
        """The same of the levels as they are in the room, not standardised: L_iA,Fmax of heavy blows."""
        return self._rated(self._average(self.measured_db)) if RATING in self.standards else None

    @cached_property
    def drops_spread_db(self) -> float:
        """Standard deviation over the drops of their own ratings, before rounding [dB]."""
        return float(_deviation(self._numbers(self.measured_db)))

    @cached_property
    def receivers_spread_db(self) -> float:
        """Standard deviation over the receivers of their own ratings, before rounding [dB]."""
        return float(_deviation(self._numbers(np.swapaxes(self.measured_db, 0, 1))))

    def above(self, other: RatedRoom) -> float | None:
        """What this rating is above another, before rounding [dB]; None where one has none or they are of other
        quantities."""
        if self.unrounded_db is None or other.unrounded_db is None or self.quantity != other.quantity:
            return None
        return self.unrounded_db - other.unrounded_db

    def _numbers(self, levels_db: Floats) -> Floats:
        """Ratings [n] of levels [n, m, b], each averaged over m."""
        each = [self._average(one[None]) for one in levels_db + self.correction_db]
        return np.array([self._finely(one) for one in each])

    def _average(self, levels_db: Floats) -> Mapping[float, float]:
        return self._by_band(energy_average(levels_db.reshape(-1, len(self.bands_hz))))

    def _by_band(self, values: Floats) -> Mapping[float, float]:
        return MappingProxyType(dict(zip(self.bands_hz, values.tolist(), strict=True)))

    def _finely(self, bands_db: Mapping[float, float]) -> float:
        if self.blows == "heavy":
            return heavy_impact_level(bands_db).unrounded_db
        return weighted_impact_level(bands_db, step_db=0.1).weighted_db

    def _rated(self, bands_db: Mapping[float, float]) -> HeavyImpactRating | ImpactRating:
        return heavy_impact_level(bands_db) if self.blows == "heavy" else weighted_impact_level(bands_db)


def number_of(rating: HeavyImpactRating | ImpactRating) -> float:
    """The single number of a rating, in whole decibels [dB].

    >>> number_of(HeavyImpactRating(55, 55.35, 500.0))
    55.0
    """
    return rating.weighted_db if isinstance(rating, ImpactRating) else float(rating.rating_db)


def rate_room(
    levels_db: Sequence[Sequence[Mapping[float, float]]],
    room: Enclosed,
    standards: Sequence[str] = STANDARDS,
    blows: Blows = "heavy",
) -> RatedRoom:
    """Impact sound levels of a room from those of every drop at every receiver, by the standards asked for.

    levels_db : by drop and receiver, {nominal centre [Hz]: [dB]}: `Levels.bands_db` of heavy blows, `equivalent_levels`
        of a tapping machine; other bands are not looked at. standards : of `STANDARDS`.

    Raises AcousticsError: nobody who listens, another standard, bands missing (sampled too low), a room without losses
    where ISO 16283-2 needs its reverberation time.

    Notes
    -----
    The reverberation time is that of the room as it is modelled, T60 of its losses at the band's centre.

    References
    ----------
    ISO 16283-2:2020 formulae 1 and 4 to 6, ISO 717-2:2020 clause 4 and annex D; see `acoustics.ratings`.

    Two drops heard at one place, 60 and 70 dB in every band, in a room of 50 m^3 and half a second:

    >>> from acoustics import Room, losses_from_t60
    >>> bedroom = Room([5.0, 4.0, 2.5], losses=losses_from_t60(0.5))
    >>> found = rate_room([[dict.fromkeys(BANDS["heavy"], level)] for level in (60.0, 70.0)], bedroom)
    >>> round(found.bands_db[63.0], 1), found.rating.rating_db, round(found.drops_spread_db, 2)
    (67.4, 70, 7.07)
    """
    others = [one for one in standards if one not in STANDARDS]
    if others or not standards:
        raise AcousticsError("levels", got=others[0] if others else "nothing", expected=" or ".join(STANDARDS))
    if not levels_db or not all(levels_db):
        raise AcousticsError("levels", got="no receiver", expected="one or more")
    bands = BANDS[blows]
    missing = [band for band in bands if any(band not in one for drop in levels_db for one in drop)]
    if missing:
        raise AcousticsError("levels", got=f"nothing at {missing[0]:g} Hz", expected="all bands", do="sample faster")
    t60 = {band: t60_of(room.losses, band) for band in bands}
    correction = dict.fromkeys(bands, 0.0)
    if FIELD in standards:
        if not all(map(isfinite, t60.values())):
            raise AcousticsError("room.losses", got="none", expected="a reverberation time", do="give the room losses")
        correction = (
            standardised_maximum_level(correction, room.volume, t60)
            if blows == "heavy"
            else standardised_impact_level(correction, t60)
        )
    return RatedRoom(
        blows=blows,
        standards=tuple(one for one in STANDARDS if one in standards),
        bands_hz=bands,
        measured_db=np.array([[[one[band] for band in bands] for one in drop] for drop in levels_db]),
        correction_db=np.array(list(correction.values())),
        t60_s=t60,
    )


def _deviation(values: Floats) -> Floats:
    """Standard deviation of a sample along its first axis, nan for one value."""
    if len(values) < 2:
        return np.full(values.shape[1:], np.nan)
    return np.asarray(np.std(values, axis=0, ddof=1))
