"""A channel of a case beside that of the baseline, in decibels at the modes of the baseline."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final
from weakref import WeakKeyDictionary

import numpy as np

from femstruct.arrays import Floats
from femstruct.study.recorded import NET_FORCE, Channel
from femstruct.study.result import CaseResult

NEAR = 0.02  # a spectral peak belongs to a mode within 2 % of its frequency
FINENESS = 0.2  # Hz between spectral lines at most, so that 2 % of the lowest modes holds some, ...
PADDING = 100  # ... but no more lines than that many times the record's own: two in 2 % of the lowest mode it shows
RESOLVED: Final = 0.25  # of the lower of two samplings: above it, what is folded differs between them
STILL: Final = 1e-9  # of the other case: 180 dB less, or more, is rounding of what does not move
_ROUNDING: Final = 1e-9  # of a count of samples


class Spectra:
    """Amplitude spectra of channels, held by who compares cases: a channel that is compared again keeps its own."""

    def __init__(self) -> None:
        self._kept: WeakKeyDictionary[Channel, tuple[tuple[float, int], Floats]] = WeakKeyDictionary()

    def of(self, channel: Channel, sampling: float, count: int | None = None) -> Floats:
        """|FFT| of the first samples of a record, all if None, padded with zeros; sampling [Hz]."""
        values = channel.values[:count]
        asked = sampling, len(values)
        kept = self._kept.get(channel)
        if kept is not None and kept[0] == asked:
            return kept[1]
        wanted = min(sampling / FINENESS, PADDING * len(values))
        length = 2 ** int(np.ceil(np.log2(max(2 * len(values), wanted))))
        spectrum = np.abs(np.fft.rfft(values, length))
        self._kept[channel] = asked, spectrum
        return spectrum


def mode_attenuation(reference: CaseResult, result: CaseResult, channel: str, spectra: Spectra) -> dict[int, float]:
    """Attenuation [dB] of a channel's spectrum at the baseline's own peaks, by the number of the mode they belong to.

    A mode is listed when the baseline's spectrum has a local maximum within 2 % of its frequency; a net force, which
    has no peaks at modes, is compared at the frequency of every mode. A record shorter than one period of a mode does
    not show it, nor does a room above its own modes, nor what moves with rounding errors alone in either case. The
    spectrum is that of the whole record, not windowed; of repeated blows it is a comb of their interval, and no mode is
    listed.

    Notes
    -----
    Of two records the longer one is cut to the other, and both spectra are taken at the same frequencies: the integral
    of x exp(-2 pi i f t) over time. Where the samplings are equal it is compared line by line of the FFT; where they
    differ, as sums over each record's own samples, the first of which counts half, up to a quarter of the lower
    sampling.
    """
    if reference.response is None or result.response is None or reference.response.blows or result.response.blows:
        return {}
    own, other = reference.channels[channel], result.channels[channel]
    samplings = reference.response.clock.sampling, result.response.clock.sampling
    window = min(len(one.values) / sampling for one, sampling in zip((own, other), samplings, strict=True))
    counts = [int(window * sampling * (1.0 + _ROUNDING)) for sampling in samplings]
    before = spectra.of(own, samplings[0], counts[0])
    step = samplings[0] / (2.0 * (len(before) - 1))
    found = dict(_lines(reference, channel, before, step, 1.0 / window))
    if samplings[0] == samplings[1]:
        after = spectra.of(other, samplings[1], counts[1])
        pairs = {mode: (float(before[line]), float(after[line])) for mode, line in found.items()}
    else:
        pairs = {
            mode: (
                spectral_size(own.values[: counts[0]], samplings[0], line * step),
                spectral_size(other.values[: counts[1]], samplings[1], line * step),
            )
            for mode, line in found.items()
            if line * step <= RESOLVED * min(samplings)
        }
    return {mode: float(20.0 * np.log10(a / b)) for mode, (a, b) in pairs.items() if min(a, b) > STILL * max(a, b)}


def _lines(
    reference: CaseResult, channel: str, before: Floats, step: float, slowest: float
) -> Iterator[tuple[int, int]]:
    """Modes by number, each with the line of the baseline's spectrum it is compared at. step, slowest [Hz] : between
    lines; one period in the record."""
    rooms = reference.case.study.rooms
    highest = min((plan.complete_below_hz for plan in rooms if channel.startswith(f"{plan.name}.")), default=np.inf)
    top = np.flatnonzero((before[1:-1] > before[:-2]) & (before[1:-1] >= before[2:])) + 1
    for number, (kind, frequency) in enumerate(zip(reference.basis.kind, reference.basis.frequency_hz, strict=True), 1):
        near = top[slice(*np.searchsorted(top, np.array([1.0 - NEAR, 1.0 + NEAR]) * frequency / step))]
        if channel.startswith(NET_FORCE):
            near = np.array([round(frequency / step)])
        if kind == "elastic" and slowest <= frequency <= highest and near.size and near[-1] < len(before):
            yield number, int(near[before[near].argmax()])


def spectral_size(values: Floats, sampling: float, frequency: float) -> float:
    """|Integral of x exp(-2 pi i f t)| over a record [nt] that begins at t = 0 [unit s]; sampling, frequency [Hz].

    >>> t = np.arange(20_000) / 20e3
    >>> round(spectral_size(np.exp(-30.0 * t), 20e3, 0.0), 6)  # 1 / 30
    0.033333
    """
    turns = np.exp((-2j * np.pi * frequency / sampling) * np.arange(len(values)))
    return float(abs(values @ turns - 0.5 * values[0])) / sampling
