"""A room's impact sound as the standards state it: levels by band over blows and receivers, and single numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import isfinite
from types import MappingProxyType
from typing import Annotated, Final, NamedTuple

import numpy as np

from acoustics.arrays import Floats, freeze, frozen
from acoustics.errors import AcousticsError
from acoustics.fields.sound_field import SoundField
from acoustics.levels.bands import nominal_bands
from acoustics.levels.standards import (
    FIELD,
    RATING,
    Blows,
    Method,
    RatingNumber,
    SingleNumber,
    energy_average,
    method_of,
    single_number,
)
from acoustics.levels.statistical import Agreement, StatisticalBands, agreement
from acoustics.reported import Axis, Reported
from acoustics.tags import stored_as

# ----------------------------------------------------------------------------------------------------------------------
# Low bands as a laboratory would find them: over rooms of nearly one size, places of the source and microphones.
# ----------------------------------------------------------------------------------------------------------------------

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

    def numbers(
        self, numbers: Sequence[RatingNumber], bands_hz: Sequence[float], others_db: Floats
    ) -> dict[str, Interval]:
        """Single numbers before rounding over the members {symbol: interval}, of those that are known and that low
        bands change: where others decide in every member, an interval would say nothing of rooms and places.

        Parameters
        ----------
        bands_hz : Sequence[float] [b]
            Nominal centres [Hz].
        others_db : Floats [b]
            Levels in the room of the bands that are not low [dB].
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


# ----------------------------------------------------------------------------------------------------------------------
# A room's impact sound as the standards state it.
# ----------------------------------------------------------------------------------------------------------------------

_OCTAVES: Final = frozenset(nominal_bands(1))  # nominal centres [Hz] of all that is heard
_DB: Final = "dB re 20 µPa"
_BAND: Final = Axis("band_hz", "Hz", "Nominal centre of the band")


@stored_as("rated room/1")
@dataclass(frozen=True, eq=False)
class RatedRoom:
    """Sound of standard blows in one room, by band, and the single numbers made of it.

    method : how the standards rate these blows. measured_db : levels in the room [drops, receivers, b] [dB], nan in
    bands that are not known. correction_db : what standardising adds to them for the room's volume and reverberation
    time [b] [dB], 0 where nothing is standardised. t60_s : reverberation times {nominal centre [Hz]: [s]}.
    statistical : levels of the same bands from statistical energies, which stand where levels are not known; None where
    the floor is not one that they are for. ensemble : low bands over rooms of nearly this size and places drawn anew;
    None where that could not be had.

    Notes
    -----
    Averages over receivers are of the energy. Over drops (places of the blow) ISO 16283-2 averages the energy too, as
    it has it for fixed microphones, JIS A 1418 the levels. Spreads are standard deviations of a sample, nan for one
    value: of a number over drops, each averaged over its receivers, and over receivers, each averaged over the drops.
    """

    method: Method
    measured_db: Annotated[
        Floats, Reported(_DB, "Level in the room, not standardised", along=("drop", "receiver", "band_hz"))
    ]
    correction_db: Annotated[Floats, Reported("dB", "What standardising adds", along=("band_hz",))]
    t60_s: Annotated[Mapping[float, float], Reported("s", "Reverberation time of the room", axis=_BAND)]
    statistical: StatisticalBands | None = None
    ensemble: Ensemble | None = None

    def __post_init__(self) -> None:
        bands = len(self.bands_hz)
        freeze(
            self,
            measured_db=frozen("measured levels", self.measured_db, (None, None, bands), blanks=True),
            correction_db=frozen("correction", self.correction_db, (bands,)),
            t60_s=MappingProxyType(dict(self.t60_s)),
        )

    @property
    def standards(self) -> tuple[str, ...]:
        """Those that were applied."""
        return self.method.standards

    @property
    def bands_hz(self) -> tuple[float, ...]:
        """Nominal centres [Hz]."""
        return self.method.bands_hz

    @property
    def blank_hz(self) -> Annotated[tuple[float, ...], Reported("Hz", "Bands that are not known")]:
        """Nominal centres [Hz] of the bands that are not known."""
        unknown = np.isnan(self._filled_db.sum(axis=(0, 1)))
        return tuple(self.bands_hz[i] for i in np.flatnonzero(unknown))

    @property
    def statistical_hz(self) -> Annotated[tuple[float, ...], Reported("Hz", "Bands that are statistical")]:
        """Nominal centres [Hz] of the bands that no modes have and that are of statistical energies."""
        unknown = np.isnan(self.measured_db.sum(axis=(0, 1)))
        return tuple(self.bands_hz[i] for i in np.flatnonzero(unknown) if self.bands_hz[i] not in self.blank_hz)

    @property
    def bands_from(
        self,
    ) -> Annotated[Mapping[float, str], Reported("1", "What a band is from: modes or statistical", axis=_BAND)]:
        """Where the levels by band come from {nominal centre [Hz]: "modes", "statistical" or "blank"}."""
        others = dict.fromkeys(self.blank_hz, "blank") | dict.fromkeys(self.statistical_hz, "statistical")
        return MappingProxyType({band: others.get(band, "modes") for band in self.bands_hz})

    @cached_property
    def agreement(self) -> Agreement | None:
        """The bands that modes and statistical energies both have, side by side; None where there are none."""
        if self.statistical is None:
            return None
        return agreement(
            self.statistical, self._by_band(10 * np.log10(np.mean(10 ** (self.measured_db / 10), axis=(0, 1))))
        )

    @cached_property
    def _filled_db(self) -> Floats:
        """Levels in the room [drops, receivers, b] with statistical ones where they are not known."""
        if self.statistical is None:
            return self.measured_db
        stated = self.statistical.stated_db
        found = np.array([stated.get(band, np.nan) for band in self.bands_hz])
        unknown = np.isnan(self.measured_db.sum(axis=(0, 1)))
        return np.asarray(np.where(unknown, found, self.measured_db))

    @property
    def band_quantity(self) -> str:
        """Symbol of the levels by band."""
        return self.method.band_quantity

    @property
    def drops(self) -> Annotated[int, Reported("1", "Places of the source")]:
        """At how many places the blow was struck."""
        return int(self.measured_db.shape[0])

    @property
    def receivers(self) -> Annotated[int, Reported("1", "Receivers")]:
        """Number of receivers."""
        return int(self.measured_db.shape[1])

    @cached_property
    def bands_db(
        self,
    ) -> Annotated[Mapping[float, float], Reported(_DB, "Mean over drops and receivers", axis=_BAND)]:
        """Averages over drops and receivers {nominal centre [Hz]: `band_quantity` [dB]}."""
        places = energy_average(self._filled_db + self.correction_db, axis=1)
        return self._by_band(self.method.average(places))

    @cached_property
    def spread_db(
        self,
    ) -> Annotated[Mapping[float, float], Reported("dB", "Their standard deviation", axis=_BAND)]:
        """Standard deviation of a band's levels over all drops and receivers {nominal centre [Hz]: [dB]}."""
        return self._by_band(_deviation(self.measured_db.reshape(-1, len(self.bands_hz))))

    @property
    def mean_db(self) -> Annotated[Mapping[float, float], Reported(_DB, "Mean over rooms and places", axis=_BAND)]:
        """Over the ensemble {nominal centre [Hz]: [dB]}, nan where there is none."""
        return self._by_band(np.array([one.mean for one in self.intervals]))

    @property
    def low_db(self) -> Annotated[Mapping[float, float], Reported(_DB, "Lower end of the 90 % interval", axis=_BAND)]:
        """What one measurement of twenty is below {nominal centre [Hz]: [dB]}, nan where that is not known."""
        return self._by_band(np.array([one.low for one in self.intervals]))

    @property
    def high_db(self) -> Annotated[Mapping[float, float], Reported(_DB, "Upper end of the 90 % interval", axis=_BAND)]:
        """What one measurement of twenty is above {nominal centre [Hz]: [dB]}, nan where that is not known."""
        return self._by_band(np.array([one.high for one in self.intervals]))

    @property
    def intervals(self) -> list[Interval]:
        """Of every band over the ensemble, nan where there is none."""
        return [Interval(np.nan, np.nan, np.nan)] * len(self.bands_hz) if not self.ensemble else self.ensemble.intervals

    @cached_property
    def number_intervals(self) -> Mapping[str, Interval]:
        """Single numbers before rounding over the ensemble {symbol: interval}, the other bands as they are; empty
        without an ensemble; without numbers that are but bounds, and those that no low band changes."""
        if self.ensemble is None:
            return MappingProxyType({})
        others = self.method.average(energy_average(self._filled_db, axis=1))
        return MappingProxyType(self.ensemble.numbers(self.method.numbers, self.bands_hz, others))

    @cached_property
    def numbers(self) -> Mapping[str, SingleNumber]:
        """Single numbers by symbol, the first the one to state: of `bands_db`, then, where these are standardised, of
        the levels as they are in the room."""
        return MappingProxyType({one.symbol: self._rated(one, self._filled_db) for one in self.method.numbers})

    @cached_property
    def curves(self) -> Mapping[str, SingleNumber]:
        """Those of the single numbers that are made of `bands_db` and can be drawn beside them."""
        shown = self.method.correct is not None
        return MappingProxyType(
            {one.symbol: self.numbers[one.symbol] for one in self.method.numbers if one.standardised == shown}
        )

    @property
    def rating(self) -> SingleNumber | None:
        """The first of the numbers, None where the standards make none."""
        return next(iter(self.numbers.values()), None)

    @cached_property
    def drops_spread_db(self) -> Mapping[str, float]:
        """Standard deviation over the drops of their own single numbers, before rounding {symbol: [dB]}."""
        return _deviations(self._own(self._at_drops))

    @cached_property
    def receivers_spread_db(self) -> Mapping[str, float]:
        """Standard deviation over the receivers of their own single numbers, before rounding {symbol: [dB]}."""
        return _deviations(self._own([one[:, None] for one in np.swapaxes(self._filled_db, 0, 1)]))

    def above(self, other: RatedRoom) -> dict[str, float]:
        """What the numbers are above those of another room, before rounding {symbol: [dB]}; only those that both
        have, nan where either is not known but for a bound."""
        return {
            symbol: one.known_db - other.numbers[symbol].known_db
            for symbol, one in self.numbers.items()
            if symbol in other.numbers
        }

    def above_spread_db(self, other: RatedRoom) -> Mapping[str, float]:
        """Standard deviation over the drops of what `above` says, each drop against the same one there {symbol: [dB]};
        nan for one drop, or where the other room has not as many."""
        mine, theirs = self._own(self._at_drops), other._own(other._at_drops)
        both = [symbol for symbol in mine if symbol in theirs]
        if self.drops != other.drops:
            return MappingProxyType(dict.fromkeys(both, float("nan")))
        return _deviations({symbol: mine[symbol] - theirs[symbol] for symbol in both})

    @property
    def _at_drops(self) -> list[Floats]:
        """Levels of one drop each [1, receivers, b]."""
        return [one[None] for one in self._filled_db]

    def _rated(self, number: RatingNumber, levels_db: Floats) -> SingleNumber:
        """A number of levels [drops, receivers, b] in the room."""
        places = energy_average(levels_db + self.correction_db * number.standardised, axis=1)
        return replace(single_number(number, self.bands_hz, places), statistical_hz=self.statistical_hz)

    def _own(self, parts: Sequence[Floats]) -> dict[str, Floats]:
        """Single numbers of parts of the levels, before rounding {symbol: [parts]}."""
        return {
            one.symbol: np.array([self._rated(one, part).known_db for part in parts]) for one in self.method.numbers
        }

    def _by_band(self, values: Floats) -> Mapping[float, float]:
        return MappingProxyType(dict(zip(self.bands_hz, values.tolist(), strict=True)))


def rate_room(
    levels_db: Sequence[Sequence[Mapping[float, float]]],
    room: SoundField,
    standards: Sequence[str] = (FIELD, RATING),
    blows: Blows = "heavy",
    statistical: StatisticalBands | None = None,
    ensemble: Ensemble | None = None,
) -> RatedRoom:
    """Impact sound levels of a room from those of every drop at every receiver, by the standards asked for.

    Parameters
    ----------
    levels_db : Sequence[Sequence[Mapping[float, float]]]
        By drop and receiver, {nominal centre [Hz]: [dB]}, in the bands of the standards, third octaves of ISO, octaves
        of JIS and KS: `Levels.bands_db` or `Levels.octaves_db` of heavy blows, `equivalent_levels` of a tapping
        machine; bands beyond those rated are not looked at. Octaves are not made of third octaves: maxima do not add.
        nan is a level that is not known: numbers that need it are lower bounds.
    standards : Sequence[str]
        ISO 16283-2 and ISO 717-2, or JIS A 1419-2 and KS F 2863-2; see `acoustics.levels.standards`.
    statistical : StatisticalBands | None
        Levels that stand where those of no drop or receiver are known.
    ensemble : Ensemble | None
        Of low bands.

    Raises
    ------
    AcousticsError
        No receivers, standards that `acoustics.levels.standards.method_of` refuses, third octaves for octaves, bands
        missing (sampled too low), a room without losses where ISO 16283-2 needs its reverberation time.

    Notes
    -----
    The reverberation time is that of the room as it is modelled: T60 of its losses at the band's centre or, where walls
    absorb too, what would be measured in the band.

    References
    ----------
    ISO 16283-2:2020 formulae 1 and 4 to 6, ISO 717-2:2020 clause 4 and annex D; see `acoustics.levels.standards`. JIS A
    1419-2, KS F 2863-2; see `acoustics.levels.standards`.

    Examples
    --------
    Two drops heard at one place, 60 and 70 dB in every band, in a room of 50 m^3 and half a second:

    >>> from acoustics import Room, losses_from_t60
    >>> bedroom = Room([5.0, 4.0, 2.5], losses=losses_from_t60(0.5))
    >>> bands = method_of(["ISO 717-2"]).bands_hz
    >>> found = rate_room([[dict.fromkeys(bands, level)] for level in (60.0, 70.0)], bedroom)
    >>> round(found.bands_db[63.0], 1), found.rating.value_db, round(found.drops_spread_db["L'_iA,Fmax,V,T"], 2)
    (67.4, 70.0, 7.07)
    """
    method = method_of(standards, blows)
    if not levels_db or not all(levels_db):
        raise AcousticsError("levels", got="no receiver", expected="one or more")
    bands = method.bands_hz
    between = [band for drop in levels_db for one in drop for band in one if band not in _OCTAVES]
    if method.fraction == 1 and between:
        got = f"a level at {between[0]:g} Hz, of third octaves"
        raise AcousticsError("levels", got=got, expected="octaves", do="filter the pressure in octaves")
    missing = [band for band in bands if any(band not in one for drop in levels_db for one in drop)]
    if missing:
        raise AcousticsError("levels", got=f"nothing at {missing[0]:g} Hz", expected="all bands", do="sample faster")
    t60 = {band: room.t60(band, method.fraction) for band in bands}
    correction = dict.fromkeys(bands, 0.0)
    if method.correct is not None:
        if not all(map(isfinite, t60.values())):
            raise AcousticsError("room.losses", got="none", expected="a reverberation time", do="give the room losses")
        correction = method.correct(correction, room.volume, t60)
    return RatedRoom(
        method=method,
        measured_db=np.array([[[one[band] for band in bands] for one in drop] for drop in levels_db]),
        correction_db=np.array(list(correction.values())),
        t60_s=t60,
        statistical=statistical,
        ensemble=ensemble,
    )


def _deviations(values: Mapping[str, Floats]) -> Mapping[str, float]:
    return MappingProxyType({name: float(_deviation(one)) for name, one in values.items()})


def _deviation(values: Floats) -> Floats:
    """Standard deviation of a sample along its first axis, nan for one value."""
    if len(values) < 2:
        return np.full(values.shape[1:], np.nan)
    return np.asarray(np.std(values, axis=0, ddof=1))
