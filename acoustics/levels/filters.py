"""Histories through the band filters, by their exact digital responses, and only as many samples as a band has.

What scipy.signal does with the recursion of `acoustics.levels.bands.band_filter`, to its rounding where all samples
are kept; without it, since importing it takes longer than the levels of a record.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from math import ceil, inf, pi
from types import MappingProxyType
from typing import Final

import numpy as np

from acoustics.arrays import Complexes, Floats
from acoustics.levels.bands import Fraction, band_edges, octave_bands, ringing_time, third_octave_bands
from acoustics.levels.ending import filtered
from acoustics.rooms.continuation import fast_length

FAINT: Final = 1e-8  # gain below which a line is left out
PER_PERIOD: Final = 32  # samples of the upper edge's period that are kept at least, ...
LEAST_HZ: Final = 3000.0  # ... and samples a second: a largest Fast level is right to 0.001 dB
_POLES: Final = np.exp(1j * pi * (2 * np.arange(4) + 5) / 8)  # of the low-pass prototype, order 4


@dataclass(frozen=True, eq=False)
class Banded:
    """A history through a band filter.

    values [n] : the history, every `every` samples of the original (1 where all are kept), while it lasted and rang on.
    """

    values: Floats
    every: float


@dataclass(frozen=True, eq=False)
class BandPass:
    """The filter of one band for records of nt samples, on the lines [first:last] of a transform of `length` samples.

    tail : samples over which the last value of a record fades out, and the filter rings. fade : what a unit last value
    adds to the spectrum by that.
    """

    length: int
    nt: int
    tail: int
    kept: int
    first: int
    response: Complexes
    fade: Complexes

    def of(self, spectrum: Complexes, last: float) -> Banded:
        """The history of a record with a spectrum [nf] of `length` samples, followed by the fade of its last value."""
        lines = slice(self.first, self.first + len(self.response))
        own = np.zeros(self.kept // 2 + 1, dtype=np.complex128)
        own[lines] = (spectrum[lines] + last * self.fade) * self.response
        every = self.length / self.kept
        values = np.fft.irfft(own, self.kept)[: int((self.nt + self.tail) / every)]
        values /= every
        return Banded(values, every)


def band_response(frequency_hz: Floats, centre_hz: float, sampling_hz: float, fraction: Fraction = 3) -> Complexes:
    """Complex gain [nf] of the order-4 Butterworth band pass of an octave (1) or third octave (3), by the bilinear
    transform with its edges in place.

    >>> low, high = band_edges(1000.0)
    >>> np.abs(band_response(np.array([low, 1000.0, high]), 1000.0, 48e3)).round(4).tolist()
    [0.7071, 1.0, 0.7071]
    """
    low, high = (np.tan(pi * edge / sampling_hz) for edge in band_edges(centre_hz, fraction))
    x = np.tan(pi * np.minimum(frequency_hz / sampling_hz, 0.5))
    with np.errstate(divide="ignore"):
        shifted = np.where(x > 0, (x - low * high / x) / (high - low), -np.inf)
    gain = np.zeros(len(x), dtype=np.complex128)
    here = np.abs(shifted) < 1e12
    gain[here] = 1.0 / np.prod(1j * shifted[here] - _POLES[:, None], axis=0)
    return gain


@lru_cache(maxsize=4)
def band_passes(
    nt: int, sampling_hz: float, fraction: Fraction, end_hz: float = inf, *, thinned: bool = True
) -> Mapping[float, BandPass]:
    """Filters of all bands up to a frequency {nominal centre [Hz]: filter} for records of nt samples, of one length of
    transform; kept for the next record of that kind.

    thinned : whether as few samples are kept as the band needs, else all.
    """
    every = octave_bands(sampling_hz) if fraction == 1 else third_octave_bands(sampling_hz)
    centres = {nominal: centre for nominal, centre in every.items() if filtered(centre, end_hz, fraction)}
    tails = {nominal: ceil(ringing_time(centre, fraction) * sampling_hz) for nominal, centre in centres.items()}
    length = fast_length(nt + 2 * max(tails.values(), default=1))
    return MappingProxyType(
        {
            nominal: _band_pass(centre, tails[nominal], length, nt, sampling_hz, fraction, thinned)
            for nominal, centre in centres.items()
        }
    )


def _band_pass(
    centre_hz: float, tail: int, length: int, nt: int, sampling_hz: float, fraction: Fraction, thinned: bool
) -> BandPass:
    wanted = max(PER_PERIOD * band_edges(centre_hz, fraction)[1], LEAST_HZ) / sampling_hz * length
    kept = fast_length(ceil(wanted)) if thinned and wanted < 0.7 * length else length
    lines_hz = np.arange(kept // 2 + 1, dtype=np.float64) * (sampling_hz / length)
    gain = band_response(lines_hz, centre_hz, sampling_hz, fraction)
    loud = np.flatnonzero(np.abs(gain) > FAINT)
    lines = slice(int(loud[0]), int(loud[-1]) + 1)
    fading = np.zeros(length)
    fading[nt : nt + tail] = 0.5 * (1 + np.cos(pi * np.arange(1, tail + 1) / (tail + 1)))
    return BandPass(length, nt, tail, kept, lines.start, gain[lines], np.fft.rfft(fading)[lines])
