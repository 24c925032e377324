"""A room's impact sound as the standards state it: levels by third octave over its receivers, and one number."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from types import MappingProxyType
from typing import Final

import numpy as np

from acoustics.arrays import freeze
from acoustics.errors import AcousticsError
from acoustics.levels import Levels
from acoustics.ratings import (
    A_THIRDS,
    HeavyImpactRating,
    energy_average,
    heavy_impact_level,
    standardised_maximum_level,
)
from acoustics.room import Room, t60_of

FIELD: Final = "ISO 16283-2"
RATING: Final = "ISO 717-2"
STANDARDS: Final = (FIELD, RATING)
HIGHEST_HZ: Final = 630 * 10**0.05  # where the last third octave ends


@dataclass(frozen=True, eq=False)
class RatedRoom:
    """What is heard of heavy blows in one room, in the third octaves 50 to 630 Hz {nominal centre [Hz]: ...}.

    standards : those that were applied, of `STANDARDS`.
    bands_db : maximum Fast levels, the energy average over the receivers: L'_i,Fmax,V,T where ISO 16283-2 was applied
        (volume and reverberation time taken out), else L_i,Fmax.
    spread_db : largest less smallest of the receivers in the band. t60_s : reverberation time of the band.
    rating : of bands_db by ISO 717-2 annex D, None where it was not applied; rating_spread_db : largest less smallest
        of the receivers' own, before rounding. receivers : how many.
    """

    standards: tuple[str, ...]
    bands_db: Mapping[float, float]
    spread_db: Mapping[float, float]
    t60_s: Mapping[float, float]
    rating: HeavyImpactRating | None
    rating_spread_db: float | None
    receivers: int

    def __post_init__(self) -> None:
        for name in ("bands_db", "spread_db", "t60_s"):
            freeze(self, **{name: MappingProxyType(dict(getattr(self, name)))})

    @property
    def quantity(self) -> str:
        """Symbol of the single number."""
        return "L'_iA,Fmax,V,T" if FIELD in self.standards else "L_iA,Fmax"

    @property
    def band_quantity(self) -> str:
        """Symbol of the levels by third octave."""
        return "L'_i,Fmax,V,T" if FIELD in self.standards else "L_i,Fmax"


def rate_room(levels: Sequence[Levels], room: Room, standards: Sequence[str] = STANDARDS) -> RatedRoom:
    """Impact sound levels of a room from the levels at its receivers, by the standards asked for.

    levels : of one blow, or of several places of it, one per receiver; standards : of `STANDARDS`.

    Raises AcousticsError: nobody who listens, another standard, bands missing (sampled too low), a room without losses
    where ISO 16283-2 needs its reverberation time.

    Notes
    -----
    The reverberation time is that of the room as it is modelled, T60 of its losses at the band's centre.

    References
    ----------
    ISO 16283-2:2020 formulae 4 to 6, ISO 717-2:2020 annex D; see `acoustics.ratings`.
    """
    others = [one for one in standards if one not in STANDARDS]
    if others or not standards:
        raise AcousticsError("levels", got=others[0] if others else "nothing", expected=" or ".join(STANDARDS))
    if not levels:
        raise AcousticsError("levels", got="no receiver", expected="one or more")
    missing = [band for band in A_THIRDS if any(band not in one.bands_db for one in levels)]
    if missing:
        raise AcousticsError("levels", got=f"nothing at {missing[0]:g} Hz", expected="all bands", do="sample faster")
    t60 = {band: t60_of(room.losses, band) for band in A_THIRDS}
    heard = [{band: one.bands_db[band] for band in A_THIRDS} for one in levels]
    if FIELD in standards:
        if not all(map(isfinite, t60.values())):
            raise AcousticsError("room.losses", got="none", expected="a reverberation time", do="give the room losses")
        heard = [standardised_maximum_level(one, room.volume, t60) for one in heard]
    table = np.array([list(one.values()) for one in heard])
    bands = dict(zip(A_THIRDS, energy_average(table).tolist(), strict=True))
    rating = heavy_impact_level(bands) if RATING in standards else None
    each = [heavy_impact_level(one).unrounded_db for one in heard] if rating is not None else []
    return RatedRoom(
        standards=tuple(one for one in STANDARDS if one in standards),
        bands_db=bands,
        spread_db=dict(zip(A_THIRDS, np.ptp(table, axis=0).tolist(), strict=True)),
        t60_s=t60,
        rating=rating,
        rating_spread_db=max(each) - min(each) if each else None,
        receivers=len(levels),
    )
