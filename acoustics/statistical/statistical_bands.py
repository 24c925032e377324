"""Bands of a rated room from statistical energies: beside the bands of modes, and in place of those that are blank."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Annotated, Final

import numpy as np

from acoustics.arrays import Floats, freeze
from acoustics.reported import Axis, Reported
from acoustics.tags import stored_as

_BAND: Final = Axis("band_hz", "Hz", "Nominal centre of the band")
_DB: Final = "dB re 20 µPa"
FEWEST: Final = 1.0  # modes in a band below which it is not stated: its level is that of a mode beside it, or of none
MANY: Final = 4.0  # modes in a band from which on its level is that of statistical energies, within their scatter
SYSTEMATIC_DB: Final = 1.0  # what the mean may always be: edges and corners are in no infinite plate
_OF_SHAPES: Final = 1.25  # relative variance of the squared shape sin^2 sin^2 of a mode at a random place
_OF_ROOM: Final = 0.238  # degrees of freedom of a microphone's mean square, of bandwidth times T60
_DB_PER: Final = 10 / np.log(10)  # of a level, of a small relative change of a mean square


@stored_as("statistical bands/1")
@dataclass(frozen=True, eq=False)
class StatisticalBands:
    """Levels in the room by statistical energies {nominal centre [Hz]: [dB]}, not standardised, and their worth.

    levels_db : with what the plate's shear adds. alike_db : of the same theory of plates as the modes', to hold beside
    them. modes : of the plate in each band, from `MANY` on levels of one floor follow the statistics. scatter_db : the
    standard deviation of one floor, averaged over its places, that is to be expected about them.
    """

    levels_db: Annotated[Mapping[float, float], Reported(_DB, "Level by statistical energies", axis=_BAND)]
    alike_db: Mapping[float, float]
    modes: Annotated[Mapping[float, float], Reported("1", "Modes of the plate in the band", axis=_BAND)]
    scatter_db: Annotated[
        Mapping[float, float], Reported("dB", "Standard deviation to expect of one floor", axis=_BAND)
    ]

    def __post_init__(self) -> None:
        for name in ("levels_db", "alike_db", "modes", "scatter_db"):
            freeze(self, **{name: MappingProxyType(dict(getattr(self, name)))})

    @property
    def stated_db(self) -> Mapping[float, float]:
        """Levels of the bands with a mode or more, which may stand where those of modes are not known."""
        return {band: level for band, level in self.levels_db.items() if self.modes[band] >= FEWEST}

    @property
    def reliable_hz(self) -> tuple[float, ...]:
        """Bands [Hz] in which the plate has enough modes."""
        return tuple(band for band, count in self.modes.items() if count >= MANY)


@dataclass(frozen=True)
class Agreement:
    """Bands that modes and statistical energies both have, with enough modes: the mean of modal less statistical
    levels, its standard deviation over the bands (nan for one), and what the mean may be by scatter alone."""

    bands: Annotated[int, Reported("1", "Bands that both have")]
    mean_db: Annotated[float, Reported("dB", "Mean of modal less statistical levels")]
    deviation_db: Annotated[float, Reported("dB", "Its standard deviation over the bands")]
    allowed_db: Annotated[float, Reported("dB", "What the mean may be: twice its deviation by scatter, 1 at least")]

    @property
    def agree(self) -> bool:
        """Whether the mean is within what scatter makes of it."""
        return abs(self.mean_db) <= self.allowed_db


def agreement(statistical: StatisticalBands, modal_db: Mapping[float, float]) -> Agreement | None:
    """Modal levels of a room {nominal centre [Hz]: [dB]}, nan where they are not known, beside statistical ones; None
    without a common band of enough modes.

    >>> flat = dict.fromkeys((400.0, 500.0), 60.0)
    >>> found = StatisticalBands(flat, flat, {400.0: 4.5, 500.0: 5.6}, dict.fromkeys(flat, 1.5))
    >>> both = agreement(found, {400.0: 61.0, 500.0: 60.0})
    >>> both.bands, both.mean_db, round(both.deviation_db, 2), round(both.allowed_db, 2)
    (2, 0.5, 0.71, 2.12)
    """
    both = [band for band in statistical.reliable_hz if np.isfinite(modal_db.get(band, np.nan))]
    if not both:
        return None
    off = np.array([modal_db[band] - statistical.alike_db[band] for band in both])
    scatter = np.array([statistical.scatter_db[band] for band in both])
    deviation = float(np.std(off, ddof=1)) if len(both) > 1 else float("nan")
    allowed = max(SYSTEMATIC_DB, float(2 * np.sqrt((scatter**2).sum()) / len(both)))
    return Agreement(len(both), float(off.mean()), deviation, allowed)


def expected_scatter(modes: Floats, width_hz: Floats, t60_s: Floats, drops: int, receivers: int) -> Floats:
    """Standard deviation [n] [dB] to expect of bands of one floor, averaged over places of the source and receivers.

    modes, width_hz, t60_s [n] : of the plate in each band, the band's width, the room's reverberation time.

    Notes
    -----
    Of the plate: squared shapes sin^2 sin^2 have a relative variance of 5/4 at each place of the source. Of the room:
    1 + 0.238 B T degrees of freedom of the mean square at each receiver (M. R. Schroeder, J. Acoust. Soc. Am. 46, 277
    (1969)). Seen over ensembles of rooms: 1.6 dB at 250 Hz where this has 1.7, 0.6 at 1000 Hz where it has 0.9. With a
    single mode in a band it is too small.

    >>> one = np.ones(1)
    >>> expected_scatter(2.5 * one, 57.7 * one, 0.5 * one, 4, 4).round(1)
    array([1.7])
    """
    shapes = _OF_SHAPES / (drops * modes)
    room = 1 / ((1 + _OF_ROOM * width_hz * t60_s) * receivers)
    return np.asarray(_DB_PER * np.sqrt(shapes + room))
