"""Ratings of impact sound: ISO 717-2 and the rubber-ball quantities of ISO 16283-2.

The tables and examples were taken from public sources that quote the standards with their pages:
https://github.com/jmrplens/phonometry (tests/reference_data.py, building/measurement/heavy_impact.py) and, for the
reference curve again, https://github.com/ITA-Toolbox (ita_soundInsulationIndexImpact.m). The Japanese grades and the
Korean level of the bang machine are in `acoustics.levels.jis_ks`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import floor, log10
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from acoustics.arrays import Floats, frozen, positive
from acoustics.errors import AcousticsError
from acoustics.tags import stored_as

T0_S: Final = 0.5  # reverberation time of a furnished living room
V0_M3: Final = 50.0
A0_M2: Final = 10.0
SABINE: Final = 0.16  # s/m
FAST_DECAY: Final = 1.7275  # s: T60 of a decay as slow as Fast; 6 ln(10) 0.125 s = 1.72694 in full

_LOWER_THIRDS_HZ: Final = (100.0, 125.0, 160.0, 200.0, 250.0, 315.0, 400.0, 500.0)
# ISO 717-2 table 3, reference curve [dB] by nominal frequency [Hz]
CURVE_THIRDS: Final = dict(
    zip(
        (*_LOWER_THIRDS_HZ, 630.0, 800.0, 1000.0, 1250.0, 1600.0, 2000.0, 2500.0, 3150.0),
        (62, 62, 62, 62, 62, 62, 61, 60, 59, 58, 57, 54, 51, 48, 45, 42),
        strict=True,
    )
)
CURVE_OCTAVES: Final = {125.0: 67, 250.0: 67, 500.0: 65, 1000.0: 62, 2000.0: 49}
# ISO 717-2:2020 table D.3, A-weighting [dB] as it is printed there
A_THIRDS: Final = dict(
    zip(
        (50.0, 63.0, 80.0, *_LOWER_THIRDS_HZ, 630.0),
        (-30.3, -26.2, -22.4, -19.1, -16.2, -13.2, -10.8, -8.7, -6.6, -4.8, -3.2, -1.9),
        strict=True,
    )
)
A_OCTAVES: Final = {63.0: -26.2, 125.0: -16.2, 250.0: -8.7, 500.0: -3.2}


@dataclass(frozen=True)
class ImpactRating:
    """Weighted impact sound pressure level of a tapping machine, ISO 717-2.

    weighted_db : L_n,w, L'_n,w or L'_nT,w after what was rated: the shifted curve at 500 Hz (octaves: less 5 dB).
    adaptation_db : C_I. unfavourable_db : sum of the levels' excess over the shifted curve. deciding_hz : the band
    that exceeds it most, or stays below it least [Hz].
    """

    weighted_db: float
    adaptation_db: float
    unfavourable_db: float
    deciding_hz: float


@dataclass(frozen=True)
class HeavyImpactRating:
    """A-weighted maximum impact sound pressure level of a rubber ball, ISO 717-2 annex D.

    rating_db : L_iA,Fmax, L'_iA,Fmax,V,T, ... after what was rated, rounded to an integer, halves up.
    unrounded_db : before rounding. deciding_hz : the band that puts most into it [Hz].
    """

    rating_db: int
    unrounded_db: float
    deciding_hz: float


@stored_as("energy average/1")
def energy_average(levels_db: ArrayLike, axis: int = 0) -> Floats:
    """Level [dB] of the mean square of levels at several places, along `axis`.

    >>> round(float(energy_average([60, 70])), 2)
    67.4
    """
    average: Floats = 10 * np.log10(np.mean(10 ** (np.asarray(levels_db, dtype=np.float64) / 10), axis=axis))
    return average


def weighted_impact_level(levels_db: Mapping[float, float], *, step_db: float = 1.0) -> ImpactRating:
    """Weighted impact sound pressure level and C_I of levels {nominal centre [Hz]: level [dB]}, ISO 717-2, 4.3 and A.2.

    levels_db : the 16 third octaves 100 to 3150 Hz, or the five octaves 125 to 2000 Hz; others are not looked at.
    step_db : 1, or 0.1 for statements of uncertainty; results are in steps of it.

    Raises AcousticsError: bands missing, a step other than these two.

    Notes
    -----
    Levels are rounded to 0.1 dB. The reference curve is shifted in steps until the sum of what exceeds it is as large
    as possible, but no more than 32.0 dB (octaves: 10.0 dB). C_I = L_sum - 15 - L_w, with the energy sum of 100 to
    2500 Hz (octaves: 125 to 2000 Hz).

    The bare floor of ISO 717-2 table C.1:

    >>> bare = [62.1, 63.2, 63.5, 66.2, 68.5, 70.0, 71.7, 73.1, 73.8, 73.5, 73.8, 73.3, 73.1, 73.0, 72.4, 71.2]
    >>> weighted_impact_level(dict(zip(CURVE_THIRDS, bare)))
    ImpactRating(weighted_db=79.0, adaptation_db=-11.0, unfavourable_db=28.0, deciding_hz=3150.0)
    """
    thirds = all(band in levels_db for band in CURVE_THIRDS)
    curve, allowed, offset = (CURVE_THIRDS, 32.0, 0.0) if thirds else (CURVE_OCTAVES, 10.0, -5.0)
    measured = tenths(in_bands(levels_db, curve))
    reference = np.array(list(curve.values()), dtype=np.float64)
    shift, excess = lowest_shift(measured, reference, allowed, step_of(step_db))
    weighted = shift + curve[500.0] + offset
    summed = _energy_sum(measured[:15] if thirds else measured)
    adaptation = nearest_step(summed, step_db) - 15 - weighted
    deciding = list(curve)[int(np.argmax(measured - reference))]
    return ImpactRating(round(weighted, 6), round(adaptation, 6), excess, deciding)


def shifted_curve(weighted_db: float) -> dict[float, float]:
    """The reference curve of ISO 717-2 shifted to a weighted level {nominal third octave [Hz]: [dB]}.

    >>> shifted_curve(79.0)[500.0], shifted_curve(79.0)[100.0]
    (79.0, 81.0)
    """
    return {band: level + weighted_db - CURVE_THIRDS[500.0] for band, level in CURVE_THIRDS.items()}


def equal_parts(rating_db: float) -> dict[float, float]:
    """Levels of third octaves {nominal [Hz]: [dB]} that put equal parts into a heavy impact's rating: what exceeds
    them decides it.

    >>> heavy_impact_level(equal_parts(50.0)).unrounded_db.__round__(9)
    50.0
    """
    return {band: rating_db - weight - 10 * log10(len(A_THIRDS)) for band, weight in A_THIRDS.items()}


def heavy_impact_level(levels_db: Mapping[float, float]) -> HeavyImpactRating:
    """L_iA,Fmax of the rubber ball from maximum Fast levels {nominal centre [Hz]: L_i,Fmax [dB]}, ISO 717-2 annex D.

    levels_db : the 12 third octaves 50 to 630 Hz or, where one of them is missing, the octaves 63 to 500 Hz; others
        are not looked at. Third octaves are never made octaves first.

    Raises AcousticsError: bands missing.

    The field measurement of ISO 717-2 table D.4:

    >>> heavy_impact_level({63.0: 65.3, 125.0: 64.5, 250.0: 58.0, 500.0: 55.8})
    HeavyImpactRating(rating_db=55, unrounded_db=55.35066..., deciding_hz=500.0)
    """
    table = A_THIRDS if all(band in levels_db for band in A_THIRDS) else A_OCTAVES
    corrected = in_bands(levels_db, table) + np.array(list(table.values()))
    total = _energy_sum(corrected)
    return HeavyImpactRating(floor(total + 0.5), total, list(table)[int(np.argmax(corrected))])


@stored_as("standardised maximum level/1")
def standardised_maximum_level(
    levels_db: Mapping[float, float], volume: float, t60_s: Mapping[float, float]
) -> dict[float, float]:
    """L'_i,Fmax,V,T {nominal centre [Hz]: [dB]} of the rubber ball, ISO 16283-2:2020 formulas 4 to 6.

    levels_db : L_i,Fmax. volume : of the receiving room [m^3]. t60_s : its reverberation times [s] in the same bands.

    Raises AcousticsError: a volume or time that is not positive, a band without a time.

    Notes
    -----
    L_i,Fmax + 10 lg(V / 50 m^3) - 10 lg(g(C) / g(C0)), C = T / 1.7275 s, C0 = 0.5 / 1.7275. g is the largest Fast mean
    square of a decay with the reverberation time T, over its first value; see `fast_of_decay`.

    >>> standardised_maximum_level({63.0: 70.0}, 25.0, {63.0: 0.5})[63.0].__round__(2)
    66.99
    """
    positive("volume", volume, "m^3")
    missing = [band for band in levels_db if band not in t60_s]
    if missing:
        raise AcousticsError("t60", got=f"nothing at {missing[0]:g} Hz", expected="a time for every band")
    return {
        band: level
        + 10 * log10(volume / V0_M3)
        - 10 * log10(fast_of_decay(positive(f"t60 at {band:g} Hz", t60_s[band], "s")) / fast_of_decay(T0_S))
        for band, level in levels_db.items()
    }


def fast_of_decay(t60_s: float) -> float:
    """Largest Fast-weighted mean square of exp(-13.8 t / T60), over its first value: g(C) of ISO 16283-2 formula 4.

    An exponential average with tau of exp(-t / a) is (exp(-t/a) - exp(-t/tau)) / (1 - 1/C), C = a / tau; its maximum
    is where C^(...) stand below.

    >>> round(fast_of_decay(0.5), 4)
    0.1747
    """
    c = t60_s / FAST_DECAY
    if abs(c - 1) < 1e-6:
        return float(np.exp(-1))
    return float((c ** (1 / (1 - c)) - c ** (-1 / (1 - 1 / c))) / (1 - 1 / c))


def standardised_impact_level(levels_db: Mapping[float, float], t60_s: Mapping[float, float]) -> dict[float, float]:
    """L'_nT {nominal centre [Hz]: [dB]} of the tapping machine: L_i - 10 lg(T / 0.5 s), ISO 16283-2 formula 1."""
    return {band: level - 10 * log10(positive("t60", t60_s[band], "s") / T0_S) for band, level in levels_db.items()}


def normalised_impact_level(
    levels_db: Mapping[float, float], volume: float, t60_s: Mapping[float, float]
) -> dict[float, float]:
    """L'_n {nominal centre [Hz]: [dB]} of the tapping machine: L_i + 10 lg(A / 10 m^2), A = 0.16 V / T, ISO 16283-2
    formula 2."""
    positive("volume", volume, "m^3")
    return {
        band: level + 10 * log10(SABINE * volume / positive("t60", t60_s[band], "s") / A0_M2)
        for band, level in levels_db.items()
    }


def lowest_shift(measured_db: Floats, reference_db: Floats, allowed_db: float, step_db: float) -> tuple[float, float]:
    """The lowest shift of a reference curve [n], in steps, that levels [n] exceed by no more than is allowed in sum;
    and that sum [dB].

    >>> lowest_shift(np.array([83.0, 73.0]), np.array([80.0, 70.0]), 2.0, 1.0)
    (2.0, 2.0)
    """
    # The sum falls with the shift, so the lowest shift that is allowed is the answer; a sum of 0 is always allowed.
    top = int(np.ceil((measured_db - reference_db).max() / step_db))
    bottom = int(np.floor((measured_db - reference_db).min() / step_db)) - int(np.ceil(allowed_db / step_db))
    shifts = step_db * np.arange(bottom, top + 1)
    sums = np.maximum(measured_db - reference_db - shifts[:, None], 0).sum(axis=1)
    best = int(np.argmax(sums <= allowed_db + 1e-6))  # sums of tenths, but for rounding
    return float(shifts[best]), round(float(sums[best]), 6)


def step_of(step_db: float) -> float:
    """A step of a shifted curve, 1 or 0.1 dB; AcousticsError for another."""
    if step_db not in (1.0, 0.1):
        raise AcousticsError("step", got=f"{step_db:g} dB", expected="1 or 0.1 dB")
    return step_db


def in_bands(levels_db: Mapping[float, float], bands_hz: Iterable[float]) -> Floats:
    """Levels [n] of some bands out of {nominal centre [Hz]: [dB]}; AcousticsError where one is missing."""
    bands = tuple(bands_hz)
    missing = [f"{band:g}" for band in bands if band not in levels_db]
    if missing:
        raise AcousticsError(
            "levels", got=f"no level at {', '.join(missing)} Hz", expected=f"{len(bands)} bands", do="add these bands"
        )
    return frozen("levels", [levels_db[band] for band in bands], (len(bands),))


def tenths(levels_db: Floats) -> Floats:
    """Rounded to 0.1 dB, halves away from zero; a hair is added because 0.05 is no binary number."""
    rounded: Floats = np.sign(levels_db) * np.floor(np.abs(levels_db) * 10 + 0.5 + 1e-9) / 10
    return rounded


def nearest_step(level_db: float, step_db: float) -> float:
    """Rounded to steps, halves up."""
    return step_db * floor(level_db / step_db + 0.5)


def _energy_sum(levels_db: Floats) -> float:
    return float(10 * np.log10(np.sum(10 ** (levels_db / 10))))
