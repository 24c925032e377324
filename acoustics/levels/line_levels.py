"""Levels of bands from a spectrum at some hundred lines: what many rooms and places need that are compared."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from math import pi
from typing import Final

import numpy as np

from acoustics.arrays import Complexes, Floats
from acoustics.levels.bands import Fraction, band_edges
from acoustics.rooms.continuation import fast_length

REFERENCE_SQUARED: Final = (20e-6) ** 2
FAST_S: Final = 0.125
PER_PERIOD: Final = 6.0  # samples of the upper edge's period: squares are known without folding into the average
_POLES: Final = np.exp(1j * pi * (2 * np.arange(4) + 5) / 8)  # of the low-pass prototype, order 4


def band_gain(s: Complexes, centre_hz: float, fraction: Fraction = 3) -> Complexes:
    """Complex gain [nf] of the order-4 Butterworth band pass of a band at complex frequencies s [nf] [1/s].

    >>> low, high = band_edges(1000.0)
    >>> np.abs(band_gain(2j * pi * np.array([low, 1000.0, high]), 1000.0)).round(4).tolist()
    [0.7071, 1.0, 0.7071]
    """
    return _gain(np.asarray(s, dtype=np.complex128).tobytes(), centre_hz, fraction)


@lru_cache(maxsize=64)
def _gain(lines: bytes, centre_hz: float, fraction: Fraction) -> Complexes:
    """The same, kept for the next spectra at these lines."""
    s = np.frombuffer(lines, dtype=np.complex128)
    low, high = (2 * pi * edge for edge in band_edges(centre_hz, fraction))
    with np.errstate(divide="ignore", invalid="ignore"):
        prototype = (s**2 + low * high) / (s * (high - low))
        gain = 1.0 / np.prod(prototype - _POLES[:, None], axis=0)
    gain = np.where(s == 0, 0.0, gain)
    gain.flags.writeable = False
    return gain


def exposures(spectra: Complexes, s: Complexes, bands_hz: Mapping[float, float], fraction: Fraction = 3) -> Floats:
    """Sound exposures [n, b] [Pa^2 s] in bands {nominal: exact centre} of pressures with spectra [n, nf] [Pa s].

    s : evenly spaced on the frequency axis, from 0 on.
    """
    step_hz = float((s[1] - s[0]).imag) / (2 * pi)
    gains = np.array([np.abs(band_gain(s, centre, fraction)) ** 2 for centre in bands_hz.values()])
    return np.asarray(2 * step_hz * np.abs(spectra) ** 2 @ gains.T)


def largest_fast(spectra: Complexes, s: Complexes, bands_hz: Mapping[float, float], fraction: Fraction = 3) -> Floats:
    """Largest Fast mean squares [n, b] [Pa^2] in bands {nominal: exact centre} of pressures of spectra [n, nf] [Pa s].

    s : evenly spaced with one real part a > 0, the spectrum being that of the pressure times exp(-a t): what comes
        after the record, 1 / spacing long, then folds back to its beginning by exp(-a / spacing) smaller.
    """
    step_hz, decay = float((s[1] - s[0]).imag) / (2 * pi), float(s[0].real)
    found = np.empty((len(spectra), len(bands_hz)))
    for column, centre in enumerate(bands_hz.values()):
        samples = fast_length(int(np.ceil(PER_PERIOD * band_edges(centre, fraction)[1] / step_hz)))
        lines = slice(0, min(len(s), samples // 2))
        dt = 1 / (step_hz * samples)
        p = np.fft.irfft(spectra[:, lines] * band_gain(s[lines], centre, fraction), samples, axis=1) / dt
        p *= np.exp(decay * dt * np.arange(samples))
        keep = np.exp(-dt / FAST_S)
        fall = keep ** np.arange(samples)
        found[:, column] = ((1 - keep) * np.cumsum(p**2 / fall, axis=1) * fall).max(axis=1)
    return found
