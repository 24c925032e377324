"""What a velocity does after its record ends: the part that a discrete Fourier transform invents if nobody says."""

from __future__ import annotations

from functools import lru_cache
from math import erfc
from typing import Final

import numpy as np

from acoustics.arrays import Complexes, Floats

PADDING: Final = 1.5  # length of the transform over that of the record
FADE: Final = 0.8  # share of half the sampling from which a spectrum is faded out
_FLANK: Final = 5.0  # half the width of the Gaussian flank: 8e-13 is left of it at either end
WINDOW: Final = 13.5  # a T: wrap-around is exp(-a T PADDING) = 2e-9, rounding is amplified by exp(a T) to 2e-10


def transform_axis(nt: int, dt: float, *, damped: bool = True) -> tuple[Complexes, Floats]:
    """Complex frequencies s [nf] [1/s] and weights [length] of the transform of a record of `nt` samples.

    damped : s = a + j omega, the record weighted with exp(-a t), a T = 13.5; otherwise s = j omega and weights of 1.
    """
    length = fast_length(int(np.ceil(PADDING * nt)))
    decay = WINDOW / (nt * dt) if damped else 0.0
    s = np.asarray(decay + 2j * np.pi * np.fft.rfftfreq(length, dt), dtype=np.complex128)
    return s, np.exp(-decay * dt * np.arange(length))


@lru_cache(maxsize=256)  # it is asked for every band of every record
def fast_length(n: int) -> int:
    """Smallest even number >= `n` without prime factors above 5, at which Fourier transforms are fast.

    >>> fast_length(192000), fast_length(97)
    (192000, 100)
    """
    odd: list[int] = [3**j * 5**k for j in range(20) for k in range(14)]
    return min(part << max(1, (-(-n // part) - 1).bit_length()) for part in odd)


def band_end(nf: int) -> Floats:
    """Weights [nf] of a spectrum from 0 to half the sampling: 1, from 0.8 of it down to 0 as half a cosine.

    Notes
    -----
    A spectrum that is cut at half the sampling is heard before its cause, as sin(x)/x; wrapped around to the end of
    the record that is amplified by exp(a T), to more than the sound itself where the sampling is coarse.
    """
    above = np.clip((np.arange(nf) / (nf - 1) - FADE) / (1 - FADE), 0, 1)
    return np.asarray(0.5 * (1 + np.cos(np.pi * above)))


def band_cut(frequency_hz: Floats, up_to_hz: float) -> Floats:
    """Weights [nf] of a spectrum that is not wanted above a frequency: 1 to a third octave beyond it, 0 an octave on.

    Notes
    -----
    As the integral of a Gaussian, whose transform is over within some periods of `up_to_hz`: a fade with corners rings
    for the whole record, which is amplified by exp(a T).
    """
    low, high = up_to_hz * 10**0.1, 2 * up_to_hz * 10**0.1
    flank = _FLANK * (2 * (frequency_hz - low) / (high - low) - 1)
    return 0.5 * np.array([erfc(place) for place in flank.tolist()])


def extended(velocity: Floats, length: int) -> Floats:
    """`velocity` [n, nt] continued to `length` samples and brought smoothly to rest there.

    Notes
    -----
    Reflected about its last sample, so that value and slope go on, and faded out by half a cosine. A causal room
    cannot hear it within the record; a jump to zero would ring, through the band limit, back into the last 5 %.
    """
    nt = velocity.shape[1]
    tail = min(nt - 1, length - nt - 1)
    fade = 0.5 * (1 + np.cos(np.pi * np.arange(1, tail + 1) / (tail + 1)))
    mirrored = 2 * velocity[:, -1:] - velocity[:, -2 : -2 - tail : -1]
    whole = np.zeros((len(velocity), length))
    whole[:, :nt] = velocity
    whole[:, nt : nt + tail] = mirrored * fade
    return whole


def returned(velocity: Floats, length: int) -> Floats:
    """`extended`, with a smooth pulse in the padding that brings the displacement back to where it started."""
    whole = extended(velocity, length)
    nt = velocity.shape[1]
    pulse = 1 - np.cos(2 * np.pi * np.arange(length - nt) / (length - nt))
    whole[:, nt:] -= np.outer(whole.sum(axis=1), pulse / pulse.sum())
    return whole


def faded(p: Floats, samples: int) -> Floats:
    """`p` [nt] and after it its last value, fading to zero as half a cosine over `samples`."""
    return np.concatenate([p, p[-1] * 0.5 * (1 + np.cos(np.pi * np.arange(1, samples + 1) / (samples + 1)))])


def source_bandwidth(velocity: Floats, dt: float) -> float:
    """Frequency [Hz] below which all but 1e-6 of the energy of the velocities [n, nt] lies."""
    length = fast_length(2 * velocity.shape[1])
    energy = (np.abs(np.fft.rfft(extended(velocity, length), axis=1)) ** 2).sum(axis=0)
    total = np.cumsum(energy)
    highest = int(np.searchsorted(total, (1 - 1e-6) * total[-1])) if total[-1] > 0 else 0
    return float(np.fft.rfftfreq(length, dt)[highest])
