"""Octaves and third octaves of IEC 61260-1:2014: base ten, order-4 Butterworth band pass.

Class 1 from 25 Hz to 20 kHz at 48 kHz sampling.
"""

from __future__ import annotations

from math import floor, log, log10, pi, sin
from typing import Final, Literal

import scipy

from acoustics.arrays import Floats

LOWEST_HZ: Final = 25.0
Fraction = Literal[1, 3]
_HALF: Final = {1: 0.15, 3: 0.05}  # decades from a centre to its edges
THIRD_EDGE: Final = 10**0.05  # upper edge of a third octave over its centre
_NOMINAL: Final = (1.0, 1.25, 1.6, 2.0, 2.5, 3.15, 4.0, 5.0, 6.3, 8.0)  # IEC 61260-1 annex E, one decade
_SIN_PI_8: Final = sin(pi / 8)


def third_octave_bands(sampling_hz: float, lowest_hz: float = LOWEST_HZ) -> dict[float, float]:
    """{nominal: exact} centre frequencies [Hz] from 25 Hz up to the last whose upper edge is below 0.47 sampling_hz.

    lowest_hz : nominal centre of the first band.

    IEC 61260-1, 5.2 to 5.5: exact centres 1000 x 10^(n/10) Hz.

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


def band_filter(centre_hz: float, sampling_hz: float, fraction: Fraction = 3) -> Floats:
    """Second-order sections [4, 6] of the order-4 Butterworth band pass of an octave (1) or third octave (3).

    As sections: as one polynomial the 20 Hz filter has a gain of .003 at 48 kHz.
    """
    sections: Floats = scipy.signal.butter(4, band_edges(centre_hz, fraction), "bandpass", fs=sampling_hz, output="sos")
    return sections


def ringing_time(centre_hz: float, fraction: Fraction = 3) -> float:
    """Time [s] in which a band filter's slowest pole decays by 60 dB.

    The poles of the order-4 prototype nearest the axis have the real part sin(pi/8) of half the bandwidth.
    """
    width = 10 ** _HALF[fraction] - 10 ** -_HALF[fraction]
    return 3 * log(10) / (_SIN_PI_8 * pi * centre_hz * width)


def _centres(sampling_hz: float, fraction: Fraction, lowest_hz: float = LOWEST_HZ) -> dict[float, float]:
    first = round(10 * log10(lowest_hz / 1000))
    last = floor(10 * (log10(0.47 * sampling_hz / 1000) - _HALF[fraction]))
    wanted = [n for n in range(first, last + 1) if fraction == 3 or n % 3 == 0]
    return {float(f"{_NOMINAL[n % 10] * 10.0 ** (3 + n // 10):.6g}"): 1000 * 10 ** (n / 10) for n in wanted}
