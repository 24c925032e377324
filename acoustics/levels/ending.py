"""Where a sound ends: above the last frequency that is known of what makes it there is nothing to be heard."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Final

import numpy as np

from acoustics.arrays import Floats
from acoustics.levels.bands import THIRD_EDGE, Fraction, band_edges
from acoustics.room_response import RoomResponse
from acoustics.rooms.continuation import extended, fast_length
from acoustics.rooms.room_advice import advice_below

OFF_DB: Final = 0.2  # that what is left out beyond a band may change its level
LOUDER_DB: Final = 10.0  # that a third octave beyond may be above those of the band


def ended(response: RoomResponse, complete_below_hz: float) -> RoomResponse:
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
    >>> heard = ended(RoomResponse((Receiver("a", [0, 0, 0]), Receiver("b", [1, 0, 0])), t, tones), 450.0)
    >>> bool(np.abs(heard.p - tones)[0].max() < 1e-4), bool(np.abs(heard.p[1]).max() < 1e-4), heard.complete_below_hz
    (True, True, 450.0)
    """
    return replace(
        response,
        p=_low_passed(response.p, response.dt, complete_below_hz),
        findings=advice_below(response.findings, complete_below_hz),
        complete_below_hz=min(complete_below_hz, response.complete_below_hz),
    )


def shown(centre_hz: float, complete_below_hz: float, fraction: Fraction = 3) -> bool:
    """Whether a band with an exact centre lies below a frequency, its upper edge included: for what is summed between
    the edges of bands.

    >>> shown(630.957, 710.0), shown(794.328, 710.0)
    (True, False)
    """
    return band_edges(centre_hz, fraction)[1] <= complete_below_hz


def filtered(centre_hz: float, complete_below_hz: float, fraction: Fraction = 3) -> bool:
    """The same for what passes the filter of a band: whether a sound that ends at a frequency has all of the band.

    >>> filtered(630.957, 710.0), filtered(630.957, 790.0)
    (False, True)
    """
    return centre_hz * passed_by(fraction) <= complete_below_hz


@cache
def passed_by(fraction: Fraction) -> float:
    """How far the filter of a band passes what matters to its level, over its centre.

    Notes
    -----
    An order-4 Butterworth filter passes half of the energy at its edge, and 1 / (1 + x^8) of it beyond, x = (r - 1 / r)
    / (r_e - 1 / r_e), r the frequency over the centre and r_e that of the edge. A mode just above the edge of a band
    without modes changes its level by decibels (1.5 dB are found). What is left out beyond may be 10 dB louder than the
    band, by third octaves, and changes it by no more than 0.2 dB.

    >>> round(passed_by(3), 4), round(passed_by(1), 4)
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
    spectrum = np.fft.rfft(extended(p, length), axis=1)
    low: Floats = np.fft.irfft(spectrum * (0.5 + 0.5 * np.cos(np.pi * above)), length, axis=1)[:, :nt]
    low = np.ascontiguousarray(low)
    low.flags.writeable = False
    return low
