"""Frequency weightings A, C, Z and time weightings F, S, I of IEC 61672-1:2013 (I: its annex C)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, Literal

import numpy as np

from acoustics.arrays import Complexes, Floats
from acoustics.errors import AcousticsError
from acoustics.rooms.box_pressure import fade_out, fast_length

TIME_S: Final = {"F": 0.125, "S": 1.0, "I": 0.035}
IMPULSE_DECAY_S: Final = 1.5
_POLES_HZ: Final = (20.598997, 107.65265, 737.86223, 12194.217)  # IEC 61672-1 annex E
_LONGEST_EXPONENT: Final = 600.0  # of the running maximum below: exp of it is a number

FrequencyWeighting = Literal["A", "C", "Z"]
TimeWeighting = Literal["F", "S", "I"]


def frequency_weighting(frequency_hz: Floats, kind: FrequencyWeighting) -> Complexes:
    """Complex response [-] of a frequency weighting at `frequency_hz` [nf] [Hz], 1 at 1 kHz (IEC 61672-1, annex E).

    >>> import numpy as np
    >>> abs(frequency_weighting(np.array([100.0, 1000.0]), "C")).round(3).tolist()
    [0.966, 1.0]
    """
    if kind not in ("A", "C", "Z"):
        raise AcousticsError("weighting", got=repr(kind), expected="A, C or Z")
    if kind == "Z":
        return np.ones(np.shape(frequency_hz), dtype=np.complex128)
    return _response(np.asarray(frequency_hz), kind) / np.abs(_response(np.array(1000.0), kind))


def weighted(p: Floats, dt: float, kind: FrequencyWeighting) -> Floats:
    """History [nt] of `p` [nt], sampled every `dt` [s], through a frequency weighting: the exact response, padded."""
    return p if kind == "Z" else next(iter(weighted_by(p, dt, (kind,))))


def weighted_by(p: Floats, dt: float, kinds: Sequence[FrequencyWeighting]) -> list[Floats]:
    """The same through each of several, its spectrum found once."""
    length = fast_length(2 * len(p))
    spectrum = np.fft.rfft(fade_out(p, length - len(p)))
    frequency_hz = np.asarray(np.fft.rfftfreq(length, dt), dtype=np.float64)
    gains = [frequency_weighting(frequency_hz, kind) for kind in kinds]
    return [np.fft.irfft(spectrum * gain, length)[: len(p)] for gain in gains]


def time_weighted(square: Floats, dt: float, kind: TimeWeighting, every: float = 1.0) -> Floats:
    """Mean square of `square` [nt] as a meter's needle shows it.

    F, S : exponential averages with 125 ms and 1 s. I : one with 35 ms, whose falls are held up to 1.5 s.

    Parameters
    ----------
    every : float
        Of how many samples, `dt` apart, one is given, of a square that is smooth between them.

    Examples
    --------
    >>> import numpy as np
    >>> burst = np.where(np.arange(4800) < 960, 1.0, 0.0)  # 20 ms at 48 kHz
    >>> [float((10 * np.log10(time_weighted(burst, 1 / 48e3, kind).max())).round(1)) for kind in ("F", "S", "I")]
    [-8.3, -17.0, -3.6]
    """
    if kind not in TIME_S:
        raise AcousticsError("time weighting", got=repr(kind), expected="F, S or I")
    keep = np.exp(-dt / TIME_S[kind])
    # sums over the given samples are trapezia of the integral, those over all have their own last sample whole
    summed = every * (_summed(square, keep**every) - 0.5 * square) + 0.5 * square
    average = (1 - keep) * summed
    return _held(average, every * dt) if kind == "I" else average


def _summed(values: Floats, keep: float) -> Floats:
    """Sums s_n = v_n + keep s_(n-1) of values [nt] that are not negative, as those of v_n keep^-n."""
    summed, before = np.empty_like(values), 0.0
    chunk = int(_LONGEST_EXPONENT / -np.log(keep))
    for start in range(0, len(values), chunk):
        part = values[start : start + chunk]
        fall = keep ** np.arange(1.0, len(part) + 1.0)
        summed[start : start + chunk] = (np.cumsum(part / fall) + before) * fall
        before = float(summed[start + len(part) - 1])
    return summed


def _held(average: Floats, dt: float) -> Floats:
    """The larger of the average and its own past, let down with 1.5 s: a running maximum of average exp(t / 1.5 s)."""
    held, least = np.empty_like(average), 0.0
    chunk = int(_LONGEST_EXPONENT * IMPULSE_DECAY_S / dt)
    for start in range(0, len(average), chunk):
        part = average[start : start + chunk]
        rise = np.exp(dt / IMPULSE_DECAY_S * np.arange(1, len(part) + 1))
        held[start : start + chunk] = np.maximum(np.maximum.accumulate(part * rise), least) / rise
        least = float(held[start + len(part) - 1])
    return held


def _response(frequency_hz: Floats, kind: Literal["A", "C"]) -> Complexes:
    jf = np.asarray(1j * frequency_hz, dtype=np.complex128)
    low, second, third, high = _POLES_HZ
    both_ends: Complexes = jf**2 / ((jf + low) ** 2 * (jf + high) ** 2)
    middle: Complexes = jf**2 / ((jf + second) * (jf + third))
    return both_ends * middle if kind == "A" else both_ends
