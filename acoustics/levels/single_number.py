"""Single numbers of impact sound: a value of a room's bands, or a lower bound where bands are not known."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import nan
from types import MappingProxyType
from typing import Annotated, Final

import numpy as np

from acoustics.arrays import Floats, freeze
from acoustics.reported import Reported
from acoustics.tags import stored_as

_SILENCE_DB: Final = -200.0  # of a band that is not known, for the least that a number can be


@stored_as("single number/1")
@dataclass(frozen=True, eq=False)
class SingleNumber:
    """One number that a standard makes of a room's bands.

    value_db : as the standard states it [dB]. unrounded_db : the same as finely as it can be had, for differences.
    deciding_hz : the band that decides it [Hz]. curve_db : levels {nominal [Hz]: [dB]} that the bands are held against,
    and curve : what they are. beside : what is stated with it, {name: [dB]}.
    blank_hz : bands that it is made of and that are not known [Hz]. The values are then lower bounds, as if nothing
    were heard there, and nothing is stated with them; they are nan where no band is known.
    """

    value_db: Annotated[float, Reported("dB", "Single number as its standard states it")]
    unrounded_db: Annotated[float, Reported("dB", "The same before rounding")]
    deciding_hz: Annotated[float, Reported("Hz", "The band that decides it, nominal centre")]
    curve_db: Mapping[float, float]
    curve: str
    beside: Annotated[Mapping[str, float], Reported("dB", "Stated with the single number")] = field(
        default_factory=dict
    )
    blank_hz: tuple[float, ...] = ()
    statistical_hz: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        freeze(self, curve_db=MappingProxyType(dict(self.curve_db)), beside=MappingProxyType(dict(self.beside)))

    @property
    def at_least(self) -> Annotated[bool, Reported("1", "Whether bands are blank and the number is a lower bound")]:
        """Whether it is but a lower bound."""
        return bool(self.blank_hz)

    @property
    def statistical(self) -> Annotated[bool, Reported("1", "Whether some of its bands are statistical")]:
        """Whether bands that it is made of are of statistical energies."""
        return bool(self.statistical_hz)

    @property
    def known_db(self) -> float:
        """The number as finely as it can be had [dB], nan where it is but a bound."""
        return nan if self.blank_hz else self.unrounded_db


@stored_as("kind of single number/1")
@dataclass(frozen=True)
class Number:
    """A single number to be made. standardised : of the levels that are standardised for the room, else of those in it.
    rate : makes it of levels [places of the blow, bands], averaged over receivers [dB]."""

    symbol: str
    standardised: bool
    rate: Callable[[Floats], SingleNumber]


def single_number(number: Number, bands_hz: Sequence[float], places_db: Floats) -> SingleNumber:
    """A number of levels [places of the blow, bands] in the bands of its method; nan is a level that is not known.

    Notes
    -----
    All numbers here grow with the level of every band, so that silence in what is not known gives the least that they
    can be.
    """
    unknown = np.isnan(places_db.sum(axis=0))
    if not unknown.any():
        return number.rate(places_db)
    blank = tuple(band for band, missing in zip(bands_hz, unknown.tolist(), strict=True) if missing)
    if unknown.all():
        return SingleNumber(nan, nan, nan, {}, "", blank_hz=blank)
    least = number.rate(np.where(unknown, _SILENCE_DB, places_db))
    return SingleNumber(least.value_db, least.unrounded_db, nan, {}, "", blank_hz=blank)
