"""Levels of what is heard: peak, A-weighted Fast maximum, third octaves.

Levels are 20 lg(p / p0), p0 = 20 uPa. Third octaves follow IEC 61260-1:2014 (base ten, order-4 Butterworth band
pass, class 1 from 25 Hz to 10 kHz at 48 kHz sampling); A and Fast follow IEC 61672-1:2013.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import ceil, floor, log, log10, pi, sin
from types import MappingProxyType
from typing import Final

import numpy as np
from scipy.signal import butter, lfilter, sosfilt

from acoustics.arrays import Complexes, Floats, freeze, frozen, positive
from acoustics.errors import Advice
from acoustics.extension import fast_length
from acoustics.pressure import RoomResponse

REFERENCE_PA: Final = 20e-6
FAST_S: Final = 0.125
LOWEST_HZ: Final = 25.0
_NOMINAL: Final = (1.0, 1.25, 1.6, 2.0, 2.5, 3.15, 4.0, 5.0, 6.3, 8.0)  # IEC 61260-1 annex E, one decade
_POLES_HZ: Final = (20.598997, 107.65265, 737.86223, 12194.217)  # IEC 61672-1 annex E
SIN_PI_8: Final = sin(pi / 8)
_SILENCE: Final = 1e-30  # Pa^2, -205 dB: the level of nothing is a number


@dataclass(frozen=True, eq=False)
class Levels:
    """Single numbers and third octaves of one pressure history.

    peak_pa : largest |p| [Pa], unweighted; l_peak_db : its level.
    l_afmax_db : largest A-weighted Fast level.
    bands_db : {nominal centre [Hz]: largest Fast level in the third octave, L_Fmax [dB]}, what the impact-sound
        standards of heavy blows use.
    exposure_db : {nominal centre [Hz]: sound exposure level, 10 lg(integral of p^2 dt / (p0^2 1 s)) [dB]}.
    findings : advice; reference_pa : p0 [Pa].
    """

    peak_pa: float
    l_peak_db: float
    l_afmax_db: float
    bands_db: Mapping[float, float]
    exposure_db: Mapping[float, float]
    findings: tuple[Advice, ...] = ()
    reference_pa: float = REFERENCE_PA

    def __post_init__(self) -> None:
        freeze(
            self,
            bands_db=MappingProxyType(dict(self.bands_db)),
            exposure_db=MappingProxyType(dict(self.exposure_db)),
        )


def response_levels(response: RoomResponse) -> dict[str, Levels]:
    """Levels of every receiver of a room response, by name; see `sound_levels`."""
    rows = zip(response.receivers, response.p, strict=True)
    return {receiver.name: sound_levels(p, response.dt) for receiver, p in rows}


def sound_levels(p: Floats, dt: float) -> Levels:
    """Peak, L_AFmax and third-octave levels of a pressure history `p` [nt] [Pa] sampled every `dt` [s].

    Raises AcousticsError: a shape other than [nt], numbers that are not finite, dt not positive.

    Notes
    -----
    The filters start at rest and run on beyond the record's end until they have settled, over a tail in which the
    last pressure fades to zero as half a cosine: a band's maximum may come after the blow's, and a jump to zero would
    be heard in all bands. Bands whose filter rings longer than the record lasts are named by ``band-not-settled``.

    >>> import numpy as np
    >>> t = np.arange(96000) / 48e3
    >>> tone = sound_levels(np.sqrt(2) * np.sin(2 * np.pi * 1000 * t), 1 / 48e3)
    >>> round(tone.l_afmax_db, 2), round(tone.bands_db[1000.0], 2), round(tone.l_peak_db, 2)
    (93.98, 93.98, 96.99)
    """
    p = frozen("p", p, (None,))
    sampling_hz = 1 / positive("dt", dt, "s")
    centres = third_octave_bands(sampling_hz)
    record_s = len(p) * dt
    bands, exposures, unsettled = {}, {}, []
    for nominal, centre in centres.items():
        ringing_s = ringing_time(centre)
        heard = sosfilt(third_octave_filter(centre, sampling_hz), _with_tail(p, ceil(ringing_s * sampling_hz)))
        bands[nominal] = _decibel(float(fast(heard**2, dt).max()))
        exposures[nominal] = _decibel(float(heard @ heard) * dt)
        if ringing_s > record_s:
            unsettled.append(nominal)
    findings = []
    if unsettled:
        findings.append(
            Advice(
                "band-not-settled",
                f"the record of {record_s:.3g} s is shorter than the ringing of the third octaves up to "
                f"{max(unsettled):g} Hz; believe them only if the sound begins and ends within it",
                {"record_s": record_s, "highest_hz": max(unsettled), "needed_s": ringing_time(centres[min(unsettled)])},
            )
        )
    peak = float(np.abs(p).max())
    return Levels(
        peak_pa=peak,
        l_peak_db=_decibel(peak**2),
        l_afmax_db=_decibel(float(fast(a_weighted(p, dt) ** 2, dt).max())),
        bands_db=bands,
        exposure_db=exposures,
        findings=tuple(findings),
    )


def level_spectrum(p: Floats, dt: float) -> tuple[Floats, Floats]:
    """Frequencies [nf] [Hz] and levels [nf] [dB re 20 uPa] of the lines of a history `p` [nt]: the rms of each line.

    Notes
    -----
    No window; lines 1/T apart, T = nt dt. The sum of 10^(L/10) is the mean square over p0^2: lines other than 0 and
    the last of an even record stand for two bins. A blow's line levels fall by 3 dB per doubling of T beyond its end.
    """
    p = frozen("p", p, (None,))
    square = np.abs(np.fft.rfft(p) / len(p)) ** 2
    square[1 : (len(p) + 1) // 2] *= 2
    frequency_hz = np.asarray(np.fft.rfftfreq(len(p), dt), dtype=np.float64)
    return frequency_hz, 10 * np.log10(np.maximum(square, _SILENCE) / REFERENCE_PA**2)


def third_octave_bands(sampling_hz: float) -> dict[float, float]:
    """{nominal: exact} centre frequencies [Hz] from 25 Hz up to the last whose upper edge is below 0.47 sampling_hz.

    IEC 61260-1, 5.2 to 5.5: exact centres 1000 x 10^(n/10) Hz.

    >>> list(third_octave_bands(48000))[:4], list(third_octave_bands(48000))[-1]
    ([25.0, 31.5, 40.0, 50.0], 20000.0)
    """
    first = round(10 * log10(LOWEST_HZ / 1000))
    last = floor(10 * log10(0.47 * sampling_hz / 1000) - 0.5)
    return {
        float(f"{_NOMINAL[n % 10] * 10.0 ** (3 + n // 10):.6g}"): 1000 * 10 ** (n / 10) for n in range(first, last + 1)
    }


def third_octave_filter(centre_hz: float, sampling_hz: float) -> Floats:
    """Second-order sections [4, 6] of the order-4 Butterworth band pass with edges centre x 10^(+-0.05).

    As sections: as one polynomial the 20 Hz filter has a gain of .003 at 48 kHz.
    """
    edges = [centre_hz * 10**-0.05, centre_hz * 10**0.05]
    sections: Floats = butter(4, edges, "bandpass", fs=sampling_hz, output="sos")
    return sections


def ringing_time(centre_hz: float) -> float:
    """Time [s] in which a third octave's slowest pole decays by 60 dB.

    The poles of the order-4 prototype nearest the axis have the real part sin(pi/8) of half the bandwidth.
    """
    return 3 * log(10) / (SIN_PI_8 * pi * centre_hz * (10**0.05 - 10**-0.05))


def a_weighting(frequency_hz: Floats) -> Complexes:
    """Complex response [-] of the A-weighting at `frequency_hz` [nf] [Hz], 1 at 1 kHz (IEC 61672-1, annex E)."""
    return _a_response(np.asarray(frequency_hz)) / np.abs(_a_response(np.array(1000.0)))


def a_weighted(p: Floats, dt: float) -> Floats:
    """A-weighted history [nt] of `p` [nt], by the exact response in the frequency domain, padded."""
    length = fast_length(2 * len(p))
    padded = _with_tail(p, length - len(p))
    weights = a_weighting(np.asarray(np.fft.rfftfreq(length, dt), dtype=np.float64))
    return np.fft.irfft(np.fft.rfft(padded) * weights, length)[: len(p)]


def fast(square: Floats, dt: float) -> Floats:
    """Fast-weighted mean square of `square` [nt]: an exponential average with 125 ms (IEC 61672-1, 3.9)."""
    keep = np.exp(-dt / FAST_S)
    average: Floats = lfilter([1 - keep], [1, -keep], square)
    return average


def _a_response(frequency_hz: Floats) -> Complexes:
    jf = 1j * frequency_hz
    low, second, third, high = _POLES_HZ
    response: Complexes = jf**4 / ((jf + low) ** 2 * (jf + second) * (jf + third) * (jf + high) ** 2)
    return response


def _with_tail(p: Floats, samples: int) -> Floats:
    return np.concatenate([p, p[-1] * 0.5 * (1 + np.cos(pi * np.arange(1, samples + 1) / (samples + 1)))])


def _decibel(square: float) -> float:
    return float(10 * log10(max(square, _SILENCE) / REFERENCE_PA**2))
