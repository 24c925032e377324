"""Structure-borne sources that were measured by themselves, where a study puts them, and what came of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Annotated, Final, Literal

from acoustics.reported import Axis
from acoustics.reported import Reported as OfSound
from femstruct.declared import checked
from femstruct.errors import InputError
from femstruct.modal.steady.band_spectrum import BandSpectrum
from femstruct.modal.steady.source_mobility import ForceSource, SourceMobility
from femstruct.modal.steady.spectrum import Spectrum
from femstruct.reported import Held
from femstruct.study.asked import Spot
from femstruct.tags import stored_as

_BAND: Final = Axis("band_hz", "Hz", "Nominal centre of the band")
_DB: Final = "dB re 20 µPa"
_PW: Final = "dB re 1 pW"


@stored_as("measured source/1")
@dataclass(frozen=True)
@checked("sources")
class MeasuredSource:
    """A machine whose blocked force or free velocity was measured, and its mobility (EN 15657): by itself, without
    phase between contacts, so that it has levels by band and no history.

    at : its contacts, a point's direction each; a point of several places is a contact at each. spectra : rms values in
    bands, or power spectral densities, of each contact, or one for all: forces [N] or velocities [m/s]. mobility : at
    each contact.

    Raises InputError for no contact or no spectrum, for contacts in different bands, and for a free velocity without a
    mobility.

    Notes
    -----
    Contacts act as if they were not correlated: powers and mean squares of pressures add up (EN 15657, EN 12354-5).

    A pump on two feet of 2 kg:

    >>> from femstruct.modal.steady.source_mobility import RigidMass
    >>> force = BandSpectrum(((50.0, 4.0), (63.0, 3.0), (80.0, 3.5)))
    >>> feet = (Spot("foot.1", "z"), Spot("foot.2", "z"))
    >>> MeasuredSource("pump", feet, "blocked force", (force,), RigidMass(2.0)).fraction
    3
    """

    name: str
    at: tuple[Spot, ...]
    what: Literal["blocked force", "free velocity"]
    spectra: tuple[BandSpectrum | Spectrum, ...]
    mobility: SourceMobility

    def __post_init__(self) -> None:
        if not self.at or not self.spectra:
            raise InputError(f"sources.{self.name}", got="no contact or no spectrum", expected="one or more of both")
        kinds = {(type(one), self._bands(one)) for one in self.spectra}
        if len(kinds) > 1:
            got = "spectra of contacts in different bands"
            raise InputError(f"sources.{self.name}", got=got, expected="the same bands at all contacts")
        if self.what == "free velocity" and isinstance(self.mobility, ForceSource):
            got, do = "a free velocity of a source of infinite mobility", "give its mobility, or its blocked force"
            raise InputError(f"sources.{self.name}.free_velocity", got=got, expected="a source with a mobility", do=do)

    @staticmethod
    def _bands(one: BandSpectrum | Spectrum) -> object:
        return (
            (one.fraction, [band for band, _ in one.values]).__repr__() if isinstance(one, BandSpectrum) else one.band
        )

    @property
    def fraction(self) -> Literal[1, 3]:
        """Of an octave are the bands of its results: 3 for thirds."""
        first = self.spectra[0]
        return first.fraction if isinstance(first, BandSpectrum) else 3

    @property
    def band(self) -> tuple[float, float]:
        """From where to where it is known [Hz]."""
        return self.spectra[0].band


@stored_as("source levels/1")
@dataclass(frozen=True, eq=False)
class SourceLevels:
    """Sound of a measured source at one receiver. bands_db : levels of the mean square {nominal centre [Hz]: [dB]}, nan
    where modes end below the band. l_aeq_db : A-weighted, of the bands that are not blank."""

    bands_db: Annotated[Mapping[float, float], OfSound(_DB, "Level of the mean square in the band", axis=_BAND)]
    l_aeq_db: Annotated[float, OfSound(_DB, "A-weighted level of the bands that are given", symbol="L_Aeq")]

    def __post_init__(self) -> None:
        object.__setattr__(self, "bands_db", MappingProxyType(dict(self.bands_db)))


@stored_as("installed source/1")
@dataclass(frozen=True, eq=False)
class InstalledSource:
    """What a measured source does where it stands. power_db : structure-borne sound power into the structure, by band,
    nan where its modes end below; least_db, most_db : between which it lies, as far as the phase of the source's
    mobility is not known. levels : by "ROOM.RECEIVER".
    """

    excited_by: Annotated[str, OfSound("1", "Where it acts")]
    what: Annotated[str, OfSound("1", "What was measured of it")]
    power_db: Annotated[Mapping[float, float], OfSound(_PW, "Structure-borne sound power", axis=_BAND)]
    least_db: Annotated[Mapping[float, float], OfSound(_PW, "Least power for any phase of the source", axis=_BAND)]
    most_db: Annotated[Mapping[float, float], OfSound(_PW, "Largest power for any phase of the source", axis=_BAND)]
    levels: Annotated[
        Mapping[str, SourceLevels], Held("Levels at the receivers, ROOM.RECEIVER", "Levels at one receiver")
    ] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name in ("power_db", "least_db", "most_db", "levels"):
            object.__setattr__(self, name, MappingProxyType(dict(getattr(self, name))))
