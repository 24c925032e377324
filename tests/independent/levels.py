"""Levels and ratings from the texts of IEC 61672-1, IEC 61260-1, ISO 717-2 and ISO 16283-2; nothing of the packages."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import ceil, exp, log10

import numpy as np

Floats = np.ndarray
P0 = 20e-6
REFERENCE = (62, 62, 62, 62, 62, 62, 61, 60, 59, 58, 57, 54, 51, 48, 45, 42)  # ISO 717-2, third octaves 100 to 3150 Hz
THIRDS = (100, 125, 160, 200, 250, 315, 400, 500, 630, 800, 1000, 1250, 1600, 2000, 2500, 3150)


def exact(nominal: float) -> float:
    """The centre of a third octave that is called so: 1000 times a power of 10^0.1."""
    return float(1000.0 * 10 ** (round(10 * log10(nominal / 1000.0)) / 10))


def a_weighting(f: Floats) -> Floats:
    """Its gain, IEC 61672-1, annex E: 1 at 1 kHz."""

    def raw(f: Floats) -> Floats:
        q = f * f
        return (
            12194.217**2
            * q
            * q
            / ((q + 20.598997**2) * (q + 12194.217**2) * np.sqrt((q + 107.65265**2) * (q + 737.86223**2)))
        )

    return raw(np.asarray(f, float)) / raw(np.array(1000.0))


def a_filter(f: Floats) -> Floats:
    """The same with its phase: poles of annex E, causal."""
    s = 2j * np.pi * np.asarray(f, float)
    w1, w2, w3, w4 = (2 * np.pi * one for one in (20.598997, 107.65265, 737.86223, 12194.217))
    gain = s**4 * w4**2 / ((s + w1) ** 2 * (s + w2) * (s + w3) * (s + w4) ** 2)
    t = 2j * np.pi * 1000.0
    return gain / abs(t**4 * w4**2 / ((t + w1) ** 2 * (t + w2) * (t + w3) * (t + w4) ** 2))


def c_filter(f: Floats) -> Floats:
    """C weighting with its phase: poles of annex E, causal."""
    s, t = 2j * np.pi * np.asarray(f, float), 2j * np.pi * 1000.0
    w1, w4 = 2 * np.pi * 20.598997, 2 * np.pi * 12194.217
    return (s / (s + w1) / (s + w4)) ** 2 / abs(t / (t + w1) / (t + w4)) ** 2


def passed(history: Floats, sampling: float, filter: object) -> Floats:
    """A history through a causal filter of frequency, silence around it."""
    n = 1 << ceil(np.log2(len(history) + 2 * sampling))
    f = np.fft.rfftfreq(n, 1 / sampling)
    return np.fft.irfft(np.fft.rfft(history, n) * filter(f), n)[: len(history) + int(sampling)]  # type: ignore[operator]


def fast_maximum(history: Floats, sampling: float, seconds: float = 0.125) -> float:
    """Largest exponentially averaged level [dB] of a history and of silence after it."""
    keep, mean, most = exp(-1 / sampling / seconds), 0.0, 0.0
    share = 1 - keep
    for one in (history**2).tolist():
        mean = keep * mean + share * one
        most = max(most, mean)
    return 10 * log10(most / P0**2)


def exposure(history: Floats, sampling: float, low: float = 0.0, high: float = np.inf) -> float:
    """10 lg of the integral of the square from one frequency to another over p0^2 and 1 s, by Parseval."""
    n = 4 * len(history)
    f = np.fft.rfftfreq(n, 1 / sampling)
    energy = 2 * np.abs(np.fft.rfft(history, n)) ** 2 / sampling**2
    inside = (f >= low) & (f < high)
    return 10 * log10(float(energy[inside].sum()) * sampling / n / P0**2)


def third_exposure(history: Floats, sampling: float, nominal: float) -> float:
    """The same of a third octave."""
    edge = 10**0.05
    return exposure(history, sampling, exact(nominal) / edge, exact(nominal) * edge)


def impact_rating(levels: Sequence[float], octaves: bool = False) -> tuple[int, int]:
    """L_n,w and C_I of ISO 717-2 from 16 third octaves (or 5 octaves), levels rounded to tenths as the standard has it.

    The reference curve is moved in steps of 1 dB until the unfavourable deviations sum to at most 32 (10) dB.
    """
    curve = (67, 67, 65, 62, 49) if octaves else REFERENCE
    allowed, offset = (10.0, -5) if octaves else (32.0, 0)
    rounded = [round(10 * one) / 10 for one in levels]
    shift = next(
        step
        for step in range(-200, 200)
        if sum(max(0.0, level - (one + step)) for level, one in zip(rounded, curve, strict=True)) <= allowed + 1e-9
    )
    weighted = curve[2 if octaves else THIRDS.index(500)] + offset + shift
    used = rounded if octaves else rounded[:15]
    total = 10 * log10(sum(10 ** (one / 10) for one in used))
    return weighted, int(np.floor(total + 0.5)) - 15 - weighted


def energy_mean(levels: Sequence[float]) -> float:
    """Level of the mean of energies."""
    return 10 * log10(sum(10 ** (one / 10) for one in levels) / len(levels))


def total(levels: Mapping[float, float] | Sequence[float]) -> float:
    """Level of the sum of energies."""
    values = levels.values() if isinstance(levels, Mapping) else levels
    return 10 * log10(sum(10 ** (one / 10) for one in values))


def standardised(level: float, t60: float, wanted: float = 0.5) -> float:
    """ISO 16283-2: L'_nT = L_i - 10 lg(T / 0.5 s)."""
    return level - 10 * log10(t60 / wanted)


def normalised(level: float, t60: float, volume: float, area: float = 10.0) -> float:
    """ISO 16283-2: L'_n = L_i + 10 lg(A / 10 m^2), A = 0.16 V / T."""
    return level + 10 * log10(0.16 * volume / t60 / area)
