"""Levels of sound: peaks, maxima by time weighting, exposures, octaves and third octaves.

Levels are 20 lg(p / p0), p0 = 20 uPa.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import lru_cache
from math import ceil, inf, nan, pi
from types import MappingProxyType
from typing import Annotated, Final

import numpy as np

from acoustics.arrays import Complexes, Floats, freeze, frozen, positive
from acoustics.errors import AcousticsError, Advice
from acoustics.levels.bands import (
    Fraction,
    band_edges,
    band_passes,
    decibel,
    decibels,
    nominal_bands,
    ringing_time,
    third_octave_bands,
)
from acoustics.levels.weighting import FrequencyWeighting, TimeWeighting, time_weighted, weighted, weighted_by
from acoustics.reported import Axis, Reported
from acoustics.room_response import RoomResponse
from acoustics.rooms.box_pressure import fast_length
from acoustics.tags import stored_as

# ----------------------------------------------------------------------------------------------------------------------
# Reverberation time of a decay that was computed or measured.
# ----------------------------------------------------------------------------------------------------------------------


def reverberation_time(p: Floats, dt: float, *, top_db: float = -5.0, bottom_db: float = -35.0) -> float:
    """Time [s] in which the sound of a decaying history `p` [nt] [Pa] falls by 60 dB.

    Parameters
    ----------
    top_db, bottom_db : float
        Part of the decay that a line is fitted to: -5 to -35 dB is T30 of ISO 3382-1, -5 to -25 T20.

    Raises
    ------
    AcousticsError
        A history that does not fall to 10 dB below `bottom_db`, where what is left of the record would bend the line.

    Notes
    -----
    Backward integration (M. R. Schroeder, J. Acoust. Soc. Am. 37, 409 (1965), doi:10.1121/1.1909343), then a line by
    least squares through the level.

    Examples
    --------
    >>> t = np.arange(48000) / 24e3
    >>> round(reverberation_time(np.sin(2000 * t) * 10 ** (-3 * t / 0.8), 1 / 24e3), 4)
    0.8
    """
    p = frozen("p", p, (None,))
    left = np.cumsum(p[::-1] ** 2)[::-1]
    if not left[0] > 0:
        raise AcousticsError("p", got="silence", expected="a decay")
    level = 10 * np.log10(np.maximum(left / left[0], 1e-30))
    # the last tenth of the record shows how far the decay got
    reached = float(level[int(0.9 * len(level))])
    if reached > bottom_db - 10:
        raise AcousticsError(
            "p", got=f"a decay to {reached:.1f} dB", expected=f"{bottom_db - 10:g} dB or lower", do="record longer"
        )
    part = (level <= top_db) & (level >= bottom_db)
    slope = np.polyfit(positive("dt", dt, "s") * np.flatnonzero(part), level[part], 1)[0]
    return float(-60 / slope)


# ----------------------------------------------------------------------------------------------------------------------
# Impact force exposure levels: how hard a standard source strikes, octave by octave.
# ----------------------------------------------------------------------------------------------------------------------

EXPOSURE_BANDS_HZ: Final = (31.5, 63.0, 125.0, 250.0, 500.0)
LEAST_SAMPLING_HZ: Final = 1600.0  # for the octave at 500 Hz


def force_exposure_levels(force: Floats, dt: float) -> dict[float, float]:
    """Impact force exposure level {nominal centre [Hz]: [dB]} in the octaves 31.5 to 500 Hz of a force `force` [nt]
    [N] sampled every `dt` [s]; nan of no force.

    Raises AcousticsError: a shape other than [nt], numbers that are not finite, a sampling too low for these octaves.

    Notes
    -----
    L_FE = 10 lg(integral of F^2 dt / (1 N^2 1 s)) of the force filtered by an octave, the filters of
    `acoustics.levels.bands`. The force is zero before and after the record, over which the filters ring out: a force
    that has not ended by then is cut.

    References
    ----------
    ISO 16283-2:2020 annex A, ISO 10140-5 annex F, JIS A 1418-2 (https://kikakurui.com/a1/A1418-2-2019-01.html).

    A step of 1 N and back, whose spectrum is 1 / (pi f) |sin(pi f T)|:

    >>> round(force_exposure_levels(np.ones(4800), 1 / 48e3)[500.0], 2)
    -38.35
    """
    force = frozen("force", force, (None,))
    sampling_hz = 1 / positive("dt", dt, "s")
    if sampling_hz < LEAST_SAMPLING_HZ * (1 - 1e-9):
        raise AcousticsError("dt", got=f"{sampling_hz:g} Hz", expected=f"{LEAST_SAMPLING_HZ:g} Hz or more")
    passes, found = band_passes(len(force), sampling_hz, 1, thinned=False), {}
    for nominal in EXPOSURE_BANDS_HZ:
        passed = passes[nominal].of(np.fft.rfft(force, passes[nominal].length), 0.0).values
        found[nominal] = decibel(float(passed @ passed) * dt)
    return found


# ----------------------------------------------------------------------------------------------------------------------
# Levels of bands from a spectrum at some hundred lines: what many rooms and places need that are compared.
# ----------------------------------------------------------------------------------------------------------------------

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

    Parameters
    ----------
    s : Complexes
        Evenly spaced on the frequency axis, from 0 on.
    """
    step_hz = float((s[1] - s[0]).imag) / (2 * pi)
    gains = np.array([np.abs(band_gain(s, centre, fraction)) ** 2 for centre in bands_hz.values()])
    return np.asarray(2 * step_hz * np.abs(spectra) ** 2 @ gains.T)


def largest_fast(spectra: Complexes, s: Complexes, bands_hz: Mapping[float, float], fraction: Fraction = 3) -> Floats:
    """Largest Fast mean squares [n, b] [Pa^2] in bands {nominal: exact centre} of pressures of spectra [n, nf] [Pa s].

    Parameters
    ----------
    s : Complexes
        Evenly spaced with one real part a > 0, the spectrum being that of the pressure times exp(-a t): what comes
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


# ----------------------------------------------------------------------------------------------------------------------
# Levels of sound.
# ----------------------------------------------------------------------------------------------------------------------

REFERENCE_PA: Final = 20e-6
_DB: Final = "dB re 20 µPa"
_BAND: Final = Axis("band_hz", "Hz", "Nominal centre of the third octave")
_OCTAVE: Final = Axis("octave_hz", "Hz", "Nominal centre of the octave")


@stored_as("sound levels/1")
@dataclass(frozen=True, eq=False)
class Levels:
    """Single numbers, octaves and third octaves of one pressure history, levels in dB re 20 uPa.

    peak_pa : largest |p| [Pa], unweighted; l_peak_db : its level. l_cpeak_db : the same, C-weighted.
    l_afmax_db, l_asmax_db, l_aimax_db : largest A-weighted Fast, Slow and Impulse level.
    l_aeq_db : A-weighted level of the mean square over the record. l_ae_db : A-weighted sound exposure level,
        10 lg(integral of p_A^2 dt / (p0^2 1 s)).
    bands_db : {nominal centre [Hz]: largest Fast level in the third octave, L_Fmax}, what the impact-sound standards
        of heavy blows use. octaves_db : the same of octaves.
    exposure_db : {nominal centre [Hz]: unweighted sound exposure level in the third octave}.
    findings : advice; reference_pa : p0 [Pa]. complete_below_hz : where the sound ends; bands whose filters
    pass more (`acoustics.levels.bands.passes_below`) are nan, single numbers are of the sound below.
    Levels of silence are nan.
    """

    peak_pa: Annotated[float, Reported("Pa", "Largest |pressure|, unweighted")]
    l_peak_db: Annotated[float, Reported(_DB, "Level of the peak, unweighted", symbol="L_peak")]
    l_cpeak_db: Annotated[float, Reported(_DB, "Level of the peak, C-weighted")]
    l_afmax_db: Annotated[float, Reported(_DB, "Largest A-weighted Fast level", symbol="L_AFmax")]
    l_asmax_db: Annotated[float, Reported(_DB, "Largest A-weighted Slow level")]
    l_aimax_db: Annotated[float, Reported(_DB, "Largest A-weighted Impulse level")]
    l_aeq_db: Annotated[float, Reported(_DB, "A-weighted level of the mean square over the record")]
    l_ae_db: Annotated[float, Reported(_DB, "A-weighted sound exposure level")]
    bands_db: Annotated[Mapping[float, float], Reported(_DB, "Largest Fast level in the third octave", axis=_BAND)]
    octaves_db: Annotated[Mapping[float, float], Reported(_DB, "Largest Fast level in the octave", axis=_OCTAVE)]
    exposure_db: Annotated[Mapping[float, float], Reported(_DB, "Sound exposure level in the third octave", axis=_BAND)]
    findings: tuple[Advice, ...] = ()
    reference_pa: float = REFERENCE_PA
    complete_below_hz: Annotated[float, Reported("Hz", "Where the sound ends; bands that reach above are blank")] = inf

    def __post_init__(self) -> None:
        for name in ("bands_db", "octaves_db", "exposure_db"):
            freeze(self, **{name: MappingProxyType(dict(getattr(self, name)))})

    @property
    def single_numbers(self) -> dict[str, float]:
        """The levels that are one number each, by name [dB]."""
        return {field.name: getattr(self, field.name) for field in fields(self) if field.name.startswith("l_")}


def response_levels(response: RoomResponse, bands_of: RoomResponse | None = None) -> dict[str, Levels]:
    """Levels of every receiver of a room response, by name; see `sound_levels`.

    Parameters
    ----------
    bands_of : RoomResponse | None
        The same before it was ended at `response.complete_below_hz`: of the last bands, what their filters pass from
        beyond is up to 0.1 dB.
    """
    end = response.complete_below_hz
    rows = zip(response.receivers, response.p, (bands_of or response).p, strict=True)
    return {receiver.name: _levels(p, whole, response.dt, end) for receiver, p, whole in rows}


def sound_levels(p: Floats, dt: float) -> Levels:
    """Peaks, maxima, exposures and band levels of a pressure history `p` [nt] [Pa] sampled every `dt` [s].

    Raises AcousticsError: a shape other than [nt], numbers that are not finite, dt not positive.

    Notes
    -----
    The filters start at rest and run on beyond the record's end until they have settled, over a tail in which the
    last pressure fades to zero as half a cosine: a band's maximum may come after the blow's, and a jump to zero would
    be heard in all bands. Bands whose filter rings longer than the record lasts are named by ``band-not-settled``.

    >>> import numpy as np
    >>> t = np.arange(96000) / 48e3
    >>> tone = sound_levels(np.sqrt(2) * np.sin(2 * np.pi * 1000 * t), 1 / 48e3)
    >>> round(tone.l_afmax_db, 2), round(tone.bands_db[1000.0], 2), round(tone.l_peak_db, 2), round(tone.l_ae_db, 2)
    (93.98, 93.98, 96.99, 96.99)
    """
    p = frozen("p", p, (None,))
    return _levels(p, p, positive("dt", dt, "s"), inf)


def _levels(p: Floats, whole: Floats, dt: float, end_hz: float) -> Levels:
    """Levels of a history `p` [nt] that ends at a frequency, its bands of the `whole` one."""
    bands, exposures = _band_levels(whole, dt, 3, end_hz)
    by_ear, nearly_flat = weighted_by(p, dt, ("A", "C"))
    square = by_ear**2
    peak, total = float(np.abs(p).max()), float(square.sum()) * dt
    return Levels(
        peak_pa=peak,
        l_peak_db=_decibel(peak**2),
        l_cpeak_db=_decibel(float(np.abs(nearly_flat).max()) ** 2),
        l_afmax_db=_decibel(float(time_weighted(square, dt, "F").max())),
        l_asmax_db=_decibel(float(time_weighted(square, dt, "S").max())),
        l_aimax_db=_decibel(float(time_weighted(square, dt, "I").max())),
        l_aeq_db=_decibel(total / (len(p) * dt)),
        l_ae_db=_decibel(total),
        bands_db=bands,
        octaves_db=_band_levels(whole, dt, 1, end_hz)[0],
        exposure_db=exposures,
        findings=_unsettled(len(p) * dt, third_octave_bands(1 / dt)),
        complete_below_hz=end_hz,
    )


def a_levels(p: Floats, dt: float) -> tuple[float, float, float]:
    """Largest A-weighted Fast and Slow levels and the A-weighted exposure level [dB] of a history `p` [nt] [Pa] alone:
    L_AFmax, L_ASmax and L_AE of `sound_levels`, in a fifth of its time.

    >>> t = np.arange(48000) / 48e3
    >>> [round(level, 1) for level in a_levels(np.sqrt(2) * np.sin(2 * np.pi * 1000 * t), 1 / 48e3)]
    [94.0, 92.0, 94.0]
    """
    (by_ear,) = weighted_by(p, dt, ("A",))
    square = by_ear**2
    fast, slow = (_decibel(float(time_weighted(square, dt, one).max())) for one in ("F", "S"))
    return fast, slow, _decibel(float(square.sum()) * dt)


def _band_levels(
    p: Floats, dt: float, fraction: Fraction, end_hz: float
) -> tuple[dict[float, float], dict[float, float]]:
    """({nominal: largest Fast level}, {nominal: exposure level}) of octaves (1) or third octaves (3) [Hz], nan beyond
    the sound's end."""
    centres = nominal_bands(fraction, 1 / dt)
    largest, exposures = dict.fromkeys(centres, nan), dict.fromkeys(centres, nan)
    passes = band_passes(len(p), 1 / dt, fraction, end_hz)
    spectrum = np.fft.rfft(p, next((one.length for one in passes.values()), len(p)))
    for nominal, one in passes.items():
        passed = one.of(spectrum, float(p[-1]))
        largest[nominal] = _decibel(float(time_weighted(passed.values**2, dt, "F", passed.every).max()))
        exposures[nominal] = _decibel(float(passed.values @ passed.values) * passed.every * dt)
    return largest, exposures


def _unsettled(record_s: float, centres: Mapping[float, float]) -> tuple[Advice, ...]:
    """Advice that names the third octaves {nominal: exact} [Hz] whose filter rings longer than the record lasts."""
    unsettled = [nominal for nominal, centre in centres.items() if ringing_time(centre) > record_s]
    if not unsettled:
        return ()
    return (
        Advice(
            "band-not-settled",
            f"the record of {record_s:.3g} s is shorter than the decay of the third-octave filters up to "
            f"{max(unsettled):g} Hz; use these bands only if the sound begins and ends within the record",
            {"record_s": record_s, "highest_hz": max(unsettled), "needed_s": ringing_time(centres[min(unsettled)])},
        ),
    )


def equivalent_levels(
    p: Floats, dt: float, since_s: float = 0.0, fraction: Fraction = 3, complete_below_hz: float = inf
) -> dict[float, float]:
    """Levels of the mean square in third octaves {nominal centre [Hz]: [dB re 20 uPa]} of `p` [nt] [Pa] from a time
    on.

    Parameters
    ----------
    since_s : float
        What comes before [s] runs through the filters and is not averaged: they start at rest.
    fraction : Fraction
        3, or 1 for octaves.
    complete_below_hz : float
        Bands whose filters pass more are nan.

    Raises
    ------
    AcousticsError
        A record that ends before.

    Examples
    --------
    A tone of 94 dB, from the second half second on:

    >>> import numpy as np
    >>> tone = np.sqrt(2) * np.sin(2 * np.pi * 1000 * np.arange(48000) / 48e3)
    >>> round(equivalent_levels(tone, 1 / 48e3, 0.5)[1000.0], 2)
    93.98
    """
    p = frozen("p", p, (None,))
    first = ceil(since_s / positive("dt", dt, "s") - 1e-6)
    if not 0 <= first < len(p):
        raise AcousticsError("p", got=f"a record of {len(p) * dt:g} s", expected=f"more than {since_s:g} s")
    centres = nominal_bands(fraction, 1 / dt)
    found = dict.fromkeys(centres, nan)
    passes = band_passes(len(p), 1 / dt, fraction, complete_below_hz, thinned=False)
    spectrum = np.fft.rfft(p, next((one.length for one in passes.values()), len(p)))
    for nominal, one in passes.items():
        passed = one.of(spectrum, 0.0).values[first : len(p)]
        found[nominal] = _decibel(float(np.mean(passed**2)))
    return found


def level_history(p: Floats, dt: float, frequency: FrequencyWeighting = "A", time: TimeWeighting = "F") -> Floats:
    """Level over time [nt] [dB re 20 uPa] of a history `p` [nt] [Pa] as a meter shows it, L_AF(t) if nothing is said;
    nan in silence.

    >>> import numpy as np
    >>> tone = np.sqrt(2) * np.sin(2 * np.pi * 1000 * np.arange(96000) / 48e3)
    >>> level_history(tone, 1 / 48e3)[[5999, 95999]].round(1).tolist()  # after 125 ms: 1 - 1/e of it, 2 dB less
    [92.0, 94.0]
    """
    square = weighted(frozen("p", p, (None,)), positive("dt", dt, "s"), frequency) ** 2
    return decibels(time_weighted(square, dt, time) / REFERENCE_PA**2)


def level_spectrum(p: Floats, dt: float) -> tuple[Floats, Floats]:
    """Frequencies [nf] [Hz] and levels [nf] [dB re 20 uPa] of the lines of a history `p` [nt]: the rms of each line;
    nan of a line with nothing.

    Notes
    -----
    No window; lines 1/T apart, T = nt dt. The sum of 10^(L/10) is the mean square over p0^2: lines other than 0 and
    the last of an even record stand for two bins. A blow's line levels fall by 3 dB per doubling of T beyond its end.
    """
    p = frozen("p", p, (None,))
    square = np.abs(np.fft.rfft(p) / len(p)) ** 2
    square[1 : (len(p) + 1) // 2] *= 2
    frequency_hz = np.asarray(np.fft.rfftfreq(len(p), dt), dtype=np.float64)
    return frequency_hz, decibels(square / REFERENCE_PA**2)


def _decibel(square: float) -> float:
    return decibel(square / REFERENCE_PA**2)
