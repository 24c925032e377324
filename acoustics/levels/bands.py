"""Octaves and third octaves of IEC 61260-1:2014: base ten, order-4 Butterworth band pass.

Class 1 from 25 Hz to 20 kHz at 48 kHz sampling.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from math import ceil, cos, floor, inf, log, log10, nan, pi, sin
from types import MappingProxyType
from typing import Final, Literal

import numpy as np
import scipy
from numpy.typing import ArrayLike

from acoustics.arrays import Complexes, Floats
from acoustics.room_response import RoomResponse
from acoustics.rooms.box_pressure import extend_to_rest, fast_length
from acoustics.rooms.room_advice import advice_below

# ----------------------------------------------------------------------------------------------------------------------
# Levels of quotients: 10 lg x, and nothing where there is nothing.
# ----------------------------------------------------------------------------------------------------------------------


def decibel(quotient: float) -> float:
    """10 lg of a quotient of squares [dB]; nan, a level that is not there, of 0 and of what is not known.

    >>> decibel(100.0), decibel(0.0)
    (20.0, nan)
    """
    return 10 * log10(quotient) if quotient > 0 else nan


def decibels(quotients: ArrayLike) -> Floats:
    """The same of each of several.

    >>> decibels([100.0, 0.0]).tolist()
    [20.0, nan]
    """
    values = np.asarray(quotients, dtype=np.float64)
    return np.asarray(10 * np.log10(values, out=np.full(values.shape, nan), where=values > 0))


# ----------------------------------------------------------------------------------------------------------------------
# Octaves and third octaves of IEC 61260-1.
# ----------------------------------------------------------------------------------------------------------------------

LOWEST_HZ: Final = 25.0
ALL_HZ: Final = 1e6  # a sampling that has all bands
Fraction = Literal[1, 3]
_HALF: Final = {1: 0.15, 3: 0.05}  # decades from a centre to its edges
THIRD_EDGE: Final = 10**0.05  # upper edge of a third octave over its centre
_NOMINAL: Final = (1.0, 1.25, 1.6, 2.0, 2.5, 3.15, 4.0, 5.0, 6.3, 8.0)  # IEC 61260-1 annex E, one decade
_NEAREST: Final = complex(-sin(pi / 8), cos(pi / 8))  # of the poles of the low-pass prototype, order 4, to the axis


def third_octave_bands(sampling_hz: float, lowest_hz: float = LOWEST_HZ) -> dict[float, float]:
    """{nominal: exact} centre frequencies [Hz] from 25 Hz up to the last whose upper edge is below 0.47 sampling_hz.

    IEC 61260-1, 5.2 to 5.5: exact centres 1000 x 10^(n/10) Hz.

    Parameters
    ----------
    lowest_hz : float
        Nominal centre of the first band.

    Examples
    --------
    >>> list(third_octave_bands(48000))[:4], list(third_octave_bands(48000))[-1]
    ([25.0, 31.5, 40.0, 50.0], 20000.0)
    """
    return _centres(sampling_hz, 3, lowest_hz)


def band_edges(centre_hz: float, fraction: Fraction = 3) -> tuple[float, float]:
    """Lower and upper edge [Hz] of the octave (1) or third octave (3) with an exact centre.

    >>> [round(edge, 1) for edge in band_edges(1000.0)]
    [891.3, 1122.0]
    """
    return centre_hz * 10 ** -_HALF[fraction], centre_hz * 10 ** _HALF[fraction]


def octave_bands(sampling_hz: float) -> dict[float, float]:
    """{nominal: exact} centre frequencies [Hz] of octaves from 31.5 Hz, as `third_octave_bands`: every third of them.

    >>> list(octave_bands(48000))
    [31.5, 63.0, 125.0, 250.0, 500.0, 1000.0, 2000.0, 4000.0, 8000.0, 16000.0]
    """
    return _centres(sampling_hz, 1)


def nominal_bands(fraction: Fraction, sampling_hz: float = ALL_HZ) -> dict[float, float]:
    """{nominal: exact} centre frequencies [Hz] of octaves (1) or third octaves (3), all or those that a sampling has.

    >>> list(nominal_bands(1, 1000.0)), nominal_bands(3)[31.5]
    ([31.5, 63.0, 125.0, 250.0], 31.622776601683793)
    """
    return octave_bands(sampling_hz) if fraction == 1 else third_octave_bands(sampling_hz)


def band_filter(centre_hz: float, sampling_hz: float, fraction: Fraction = 3) -> Floats:
    """Second-order sections [4, 6] of the order-4 Butterworth band pass of an octave (1) or third octave (3).

    As sections: as one polynomial the 20 Hz filter has a gain of .003 at 48 kHz.
    """
    sections: Floats = scipy.signal.butter(4, band_edges(centre_hz, fraction), "bandpass", fs=sampling_hz, output="sos")
    return sections


def ringing_time(centre_hz: float, fraction: Fraction = 3) -> float:
    """Time [s] in which a band filter's slowest pole decays by 60 dB.

    A pole p of the prototype becomes two of the band pass, h p +- sqrt((h p)^2 - 1) of the centre, h half the relative
    bandwidth; the slowest is the lower one of a p nearest the axis.
    """
    half = 0.5 * (10 ** _HALF[fraction] - 10 ** -_HALF[fraction])
    between = half * _NEAREST
    slowest = min(abs((between + side * (between**2 - 1) ** 0.5).real) for side in (1, -1))
    return 3 * log(10) / (2 * pi * centre_hz * slowest)


def _centres(sampling_hz: float, fraction: Fraction, lowest_hz: float = LOWEST_HZ) -> dict[float, float]:
    first = round(10 * log10(lowest_hz / 1000))
    last = floor(10 * (log10(0.47 * sampling_hz / 1000) - _HALF[fraction]))
    numbers = [n for n in range(first, last + 1) if fraction == 3 or n % 3 == 0]
    return {float(f"{_NOMINAL[n % 10] * 10.0 ** (3 + n // 10):.6g}"): 1000 * 10 ** (n / 10) for n in numbers}


# ----------------------------------------------------------------------------------------------------------------------
# Where a sound ends: above the last frequency that is known of what makes it there is nothing to be heard.
# ----------------------------------------------------------------------------------------------------------------------

OFF_DB: Final = 0.2  # that what is left out beyond a band may change its level
LOUDER_DB: Final = 10.0  # that a third octave beyond may be above those of the band


def truncate_response(response: RoomResponse, complete_below_hz: float) -> RoomResponse:
    """A room's sound without what lies above a frequency [Hz], of which `complete_below_hz` tells.

    What is left out of a structure by modes is made up for by pseudo-modes, which are right in forces and in what is
    heard below the last mode; they ring at frequencies of their own above it.

    Notes
    -----
    Below the end nothing is changed, neither in size nor in time; from there to half a third octave above it lines fade
    as half a cosine. A pulse with content there is heard some periods of the end before its time.

    >>> from acoustics import Receiver
    >>> t = np.arange(48000) / 48e3
    >>> tones = [np.sin(2 * np.pi * f * t) * np.sin(np.pi * t) ** 2 for f in (400.0, 600.0)]
    >>> heard = truncate_response(RoomResponse((Receiver("a", [0, 0, 0]), Receiver("b", [1, 0, 0])), t, tones), 450.0)
    >>> bool(np.abs(heard.p - tones)[0].max() < 1e-4), bool(np.abs(heard.p[1]).max() < 1e-4), heard.complete_below_hz
    (True, True, 450.0)
    """
    return replace(
        response,
        p=_low_passed(response.p, response.dt, complete_below_hz),
        findings=advice_below(response.findings, complete_below_hz),
        complete_below_hz=min(complete_below_hz, response.complete_below_hz),
    )


def is_below(centre_hz: float, complete_below_hz: float, fraction: Fraction = 3) -> bool:
    """Whether a band with an exact centre lies below a frequency, its upper edge included: for what is summed between
    the edges of bands.

    >>> is_below(630.957, 710.0), is_below(794.328, 710.0)
    (True, False)
    """
    return band_edges(centre_hz, fraction)[1] <= complete_below_hz


def passes_below(centre_hz: float, complete_below_hz: float, fraction: Fraction = 3) -> bool:
    """The same for what passes the filter of a band: whether a sound that ends at a frequency has all of the band.

    >>> passes_below(630.957, 710.0), passes_below(630.957, 790.0)
    (False, True)
    """
    return centre_hz * filter_reach(fraction) <= complete_below_hz


@cache
def filter_reach(fraction: Fraction) -> float:
    """How far the filter of a band passes what matters to its level, over its centre.

    Notes
    -----
    An order-4 Butterworth filter passes half of the energy at its edge, and 1 / (1 + x^8) of it beyond, x = (r - 1 / r)
    / (r_e - 1 / r_e), r the frequency over the centre and r_e that of the edge. A mode just above the edge of a band
    without modes changes its level by decibels (1.5 dB are found). What is left out beyond may be 10 dB louder than the
    band, by third octaves, and changes it by no more than 0.2 dB.

    >>> round(filter_reach(3), 4), round(filter_reach(1), 4)
    (1.2503, 1.7645)
    """
    edge = band_edges(1.0, fraction)[1]
    share = (10 ** (OFF_DB / 10) - 1) / 10 ** (LOUDER_DB / 10) * (3 / fraction)
    half = 0.5 * (edge - 1 / edge) * (1 / share - 1) ** 0.125
    return float(half + np.sqrt(1 + half**2))


def _low_passed(p: Floats, dt: float, end_hz: float) -> Floats:
    if not 0.0 < end_hz < 0.5 / dt:
        return p  # complete, or modes that are given and complete to no frequency
    nt = p.shape[1]
    length = fast_length(2 * nt)
    lines = np.fft.rfftfreq(length, dt)
    above = np.clip((lines / end_hz - 1.0) / (THIRD_EDGE - 1.0), 0.0, 1.0)
    spectrum = np.fft.rfft(extend_to_rest(p, length), axis=1)
    low: Floats = np.fft.irfft(spectrum * (0.5 + 0.5 * np.cos(np.pi * above)), length, axis=1)[:, :nt]
    low = np.ascontiguousarray(low)
    low.flags.writeable = False
    return low


# ----------------------------------------------------------------------------------------------------------------------
# Histories through the band filters, by their exact digital responses, and only as many samples as a band has.
#
# What scipy.signal does with the recursion of `band_filter`, to its rounding where all samples
# are kept; without it, since importing it takes longer than the levels of a record.
# ----------------------------------------------------------------------------------------------------------------------

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

    Parameters
    ----------
    thinned : bool
        Whether as few samples are kept as the band needs, else all.
    """
    every = nominal_bands(fraction, sampling_hz)
    centres = {nominal: centre for nominal, centre in every.items() if passes_below(centre, end_hz, fraction)}
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
    least_length = max(PER_PERIOD * band_edges(centre_hz, fraction)[1], LEAST_HZ) / sampling_hz * length
    kept = fast_length(ceil(least_length)) if thinned and least_length < 0.7 * length else length
    lines_hz = np.arange(kept // 2 + 1, dtype=np.float64) * (sampling_hz / length)
    gain = band_response(lines_hz, centre_hz, sampling_hz, fraction)
    loud = np.flatnonzero(np.abs(gain) > FAINT)
    lines = slice(int(loud[0]), int(loud[-1]) + 1)
    fading = np.zeros(length)
    fading[nt : nt + tail] = 0.5 * (1 + np.cos(pi * np.arange(1, tail + 1) / (tail + 1)))
    return BandPass(length, nt, tail, kept, lines.start, gain[lines], np.fft.rfft(fading)[lines])
