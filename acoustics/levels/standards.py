"""How standards rate impact sound: ISO 717-2, ISO 16283-2, JIS A 1419-2, KS F 2863-2."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from math import ceil, floor, log10, nan
from types import MappingProxyType
from typing import Annotated, Final, Literal

import numpy as np
from numpy.typing import ArrayLike

from acoustics.arrays import Floats, freeze, frozen, positive
from acoustics.errors import AcousticsError
from acoustics.levels.bands import Fraction, filter_reach
from acoustics.reported import Reported
from acoustics.tags import stored_as

# ----------------------------------------------------------------------------------------------------------------------
# Single numbers of impact sound: a value of a room's bands, or a lower bound where bands are not known.
# ----------------------------------------------------------------------------------------------------------------------

_SILENCE_DB: Final = -200.0  # of a band that is not known, for the least that a number can be


@stored_as("single number/1")
@dataclass(frozen=True, eq=False)
class SingleNumber:
    """One number that a standard makes of a room's bands.

    value_db : as the standard states it [dB]. unrounded_db : the same as finely as it can be had, for differences.
    deciding_hz : the band that decides it [Hz]. curve_db : levels {nominal [Hz]: [dB]} that the bands are held against,
    and curve : what they are. beside : what is stated with it, {name: [dB]}.
    blank_hz : bands that it is made of and that are not known [Hz]. The values are then lower bounds, as if nothing
    were heard there, and nothing is stated with them; they are nan where no band is known.
    """

    value_db: Annotated[float, Reported("dB", "Single number as its standard states it")]
    unrounded_db: Annotated[float, Reported("dB", "The same before rounding")]
    deciding_hz: Annotated[float, Reported("Hz", "The band that decides it, nominal centre")]
    curve_db: Mapping[float, float]
    curve: str
    beside: Annotated[Mapping[str, float], Reported("dB", "Stated with the single number")] = field(
        default_factory=dict
    )
    blank_hz: tuple[float, ...] = ()
    statistical_hz: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        freeze(self, curve_db=MappingProxyType(dict(self.curve_db)), beside=MappingProxyType(dict(self.beside)))

    @property
    def at_least(self) -> Annotated[bool, Reported("1", "Whether bands are blank and the number is a lower bound")]:
        """Whether it is but a lower bound."""
        return bool(self.blank_hz)

    @property
    def statistical(self) -> Annotated[bool, Reported("1", "Whether some of its bands are statistical")]:
        """Whether bands that it is made of are of statistical energies."""
        return bool(self.statistical_hz)

    @property
    def known_db(self) -> float:
        """The number as finely as it can be had [dB], nan where it is but a bound."""
        return nan if self.blank_hz else self.unrounded_db


@stored_as("kind of single number/1")
@dataclass(frozen=True)
class RatingNumber:
    """A single number to be made. standardised : of the levels that are standardised for the room, else of those in it.
    rate : makes it of levels [places of the blow, bands], averaged over receivers [dB]."""

    symbol: str
    standardised: bool
    rate: Callable[[Floats], SingleNumber]


def single_number(number: RatingNumber, bands_hz: Sequence[float], places_db: Floats) -> SingleNumber:
    """A number of levels [places of the blow, bands] in the bands of its method; nan is a level that is not known.

    Notes
    -----
    All numbers here grow with the level of every band, so that silence in what is not known gives the least that they
    can be.
    """
    unknown = np.isnan(places_db.sum(axis=0))
    if not unknown.any():
        return number.rate(places_db)
    blank = tuple(band for band, missing in zip(bands_hz, unknown.tolist(), strict=True) if missing)
    if unknown.all():
        return SingleNumber(nan, nan, nan, {}, "", blank_hz=blank)
    least = number.rate(np.where(unknown, _SILENCE_DB, places_db))
    return SingleNumber(least.value_db, least.unrounded_db, nan, {}, "", blank_hz=blank)


# ----------------------------------------------------------------------------------------------------------------------
# Ratings of impact sound: ISO 717-2 and the rubber-ball quantities of ISO 16283-2.
#
# The tables and examples were taken from public sources that quote the standards with their pages:
# https://github.com/jmrplens/phonometry (tests/reference_data.py, building/measurement/heavy_impact.py) and, for the
# reference curve again, https://github.com/ITA-Toolbox (ita_soundInsulationIndexImpact.m). The Japanese grades and the
# Korean level of the bang machine follow below.
# ----------------------------------------------------------------------------------------------------------------------

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
    """Weighted impact sound pressure level and C_I of levels {nominal centre [Hz]: level [dB]}, ISO 717-2, 4.3 and
    A.2.

    Parameters
    ----------
    levels_db : Mapping[float, float]
        The 16 third octaves 100 to 3150 Hz, or the five octaves 125 to 2000 Hz; others are not looked at.
    step_db : float
        1, or 0.1 for statements of uncertainty; results are in steps of it.

    Raises
    ------
    AcousticsError
        Bands missing, a step other than these two.

    Notes
    -----
    Levels are rounded to 0.1 dB. The reference curve is shifted in steps until the sum of what exceeds it is as large
    as possible, but no more than 32.0 dB (octaves: 10.0 dB). C_I = L_sum - 15 - L_w, with the energy sum of 100 to
    2500 Hz (octaves: 125 to 2000 Hz).

    Examples
    --------
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


def shift_curve(weighted_db: float) -> dict[float, float]:
    """The reference curve of ISO 717-2 shifted to a weighted level {nominal third octave [Hz]: [dB]}.

    >>> shift_curve(79.0)[500.0], shift_curve(79.0)[100.0]
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

    Parameters
    ----------
    levels_db : Mapping[float, float]
        The 12 third octaves 50 to 630 Hz or, where one of them is missing, the octaves 63 to 500 Hz; others are not
        looked at. Third octaves are never made octaves first.

    Raises
    ------
    AcousticsError
        Bands missing.

    Examples
    --------
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

    Parameters
    ----------
    levels_db : Mapping[float, float]
        L_i,Fmax.
    volume : float
        Of the receiving room [m^3].
    t60_s : Mapping[float, float]
        Its reverberation times [s] in the same bands.

    Raises
    ------
    AcousticsError
        A volume or time that is not positive, a band without a time.

    Notes
    -----
    L_i,Fmax + 10 lg(V / 50 m^3) - 10 lg(g(C) / g(C0)), C = T / 1.7275 s, C0 = 0.5 / 1.7275. g is the largest Fast mean
    square of a decay with the reverberation time T, over its first value; see `fast_of_decay`.

    Examples
    --------
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


# ----------------------------------------------------------------------------------------------------------------------
# Ratings of impact sound in octaves: the grades of JIS A 1419-2 and the inverse A-weighted level of KS F 2863-2.
#
# The standards' own tables were not at hand. JIS A 1419-2: curve, octaves, rounding and allowance as
# https://github.com/toyoun-benec/syaonApp (syaonApp.py) has them; https://dsp-piano.com/note/value-l says the rule in
# words; the first pages of the standard are at https://kikakurui.com/a1/A1419-2-2000-01.html. KS F 2863-2: curve and
# rule as https://github.com/yohan2256/daqhats (pc_app/LEGACY_BANG.md) took them from a test report that is published at
# https://www.kira.or.kr/gongji_2013/ (printed pages 33 and 34). Its curve is that of the Japanese grade 60.
#
# KS F 2863-1 (tapping machine) and what JIS A 1419-2 makes of a rubber ball are absent: they were not found in a source
# that can be read and checked.
# ----------------------------------------------------------------------------------------------------------------------

# JIS A 1419-2, curve of grade 50 [dB] by nominal octave [Hz]; other grades are shifted by steps of 5 dB
CURVE_50: Final[Mapping[float, float]] = MappingProxyType(
    {63.0: 73.0, 125.0: 63.0, 250.0: 56.0, 500.0: 50.0, 1000.0: 47.0, 2000.0: 46.0, 4000.0: 46.0}
)
HEAVY_OCTAVES: Final = (63.0, 125.0, 250.0, 500.0)  # of the bang machine
LIGHT_OCTAVES: Final = (125.0, 250.0, 500.0, 1000.0, 2000.0)  # of the tapping machine
# KS F 2863-2, inverse A-weighting curve [dB] by nominal octave [Hz]
INVERSE_A: Final[Mapping[float, float]] = MappingProxyType({63.0: 83.0, 125.0: 73.0, 250.0: 66.0, 500.0: 60.0})
GRADE_STEP_DB: Final = 5
ALLOWED_DB: Final = 2  # by which a level measured in a building may exceed the curve of its grade
EXCESS_DB: Final = 8.0  # that the levels may have above the inverse A-weighting curve, summed


@dataclass(frozen=True)
class ImpactGrade:
    """Grade of a floor by JIS A 1419-2.

    grade : L_i,Fmax,r,H(1) of the bang machine, L_i,r,L of the tapping machine: a multiple of 5. number : the "L
    number", what the curve that no octave exceeds has at 500 Hz, whole [dB]. unrounded_db : the same before rounding.
    deciding_hz : the octave that exceeds the curve most, or stays below it least [Hz].
    """

    grade: int
    number: int
    unrounded_db: float
    deciding_hz: float


@dataclass(frozen=True)
class InverseALevel:
    """Inverse A-weighted maximum impact sound level L_i,Fmax,AW of a bang machine, KS F 2863-2.

    level_db : the shifted curve at 500 Hz. excess_db : what the levels have above it, summed. deciding_hz : the octave
    that exceeds the curve most, or stays below it least [Hz].
    """

    level_db: float
    excess_db: float
    deciding_hz: float


def impact_grade(levels_db: Mapping[float, float], octaves_hz: Sequence[float] = HEAVY_OCTAVES) -> ImpactGrade:
    """Grade by JIS A 1419-2 of octave levels {nominal centre [Hz]: [dB]}: a floor of grade 55 is better than one of
    60.

    Parameters
    ----------
    levels_db : Mapping[float, float]
        Average of the places of the blow, see `mean_of_places`: largest Fast levels of a bang machine, levels of the
        mean square of a tapping machine.
    octaves_hz : Sequence[float]
        `HEAVY_OCTAVES` or `LIGHT_OCTAVES`; others are not looked at.

    Raises
    ------
    AcousticsError
        Octaves missing.

    Notes
    -----
    Levels are rounded to 0.1 dB and then to whole decibels. The L number is the largest (level - curve of grade 50) +
    50. The grade is the lowest multiple of 5 whose curve no octave exceeds by more than 2 dB.

    Examples
    --------
    A floor that is loudest in the octave at 63 Hz, 77.6 - 73 above grade 50, rounded:

    >>> impact_grade({63.0: 77.6, 125.0: 66.0, 250.0: 56.2, 500.0: 44.0})
    ImpactGrade(grade=55, number=55, unrounded_db=54.6, deciding_hz=63.0)
    """
    levels = in_bands(levels_db, octaves_hz)
    curve = np.array([CURVE_50[band] for band in octaves_hz])
    above = levels - curve
    whole = np.array([nearest_step(level, 1.0) for level in tenths(levels).tolist()]) - curve
    number = round(float(whole.max())) + 50
    return ImpactGrade(
        grade=GRADE_STEP_DB * ceil((number - ALLOWED_DB) / GRADE_STEP_DB),
        number=number,
        unrounded_db=round(float(above.max()) + 50, 9),
        deciding_hz=octaves_hz[int(np.argmax(above))],
    )


def grade_curve(grade: float, octaves_hz: Sequence[float] = HEAVY_OCTAVES) -> dict[float, float]:
    """The curve of a grade of JIS A 1419-2 {nominal octave [Hz]: [dB]}.

    >>> grade_curve(60.0)
    {63.0: 83.0, 125.0: 73.0, 250.0: 66.0, 500.0: 60.0}
    """
    return {band: CURVE_50[band] + grade - 50 for band in octaves_hz}


def mean_of_places(levels_db: ArrayLike) -> Floats:
    """Arithmetic mean [...] of levels [places, ...] [dB], each rounded to 0.1 dB first, as JIS A 1418 has it for the
    places of the blow; over microphones it has the `energy_average`.

    >>> float(mean_of_places([60.04, 70.0]))
    65.0
    """
    return np.asarray(np.mean(tenths(np.asarray(levels_db, dtype=np.float64)), axis=0))


def inverse_a_level(levels_db: Mapping[float, float], *, step_db: float = 1.0) -> InverseALevel:
    """Inverse A-weighted level by KS F 2863-2 of largest Fast levels {nominal octave [Hz]: [dB]} of a bang machine.

    Parameters
    ----------
    levels_db : Mapping[float, float]
        Average of the octaves 63 to 500 Hz: arithmetic over the places of the blow, of the energy over microphones.
        Others are not looked at.
    step_db : float
        1, or 0.1 for comparisons that are finer than the standard's.

    Raises
    ------
    AcousticsError
        Octaves missing, a step other than these two.

    Notes
    -----
    Levels are rounded to 0.1 dB. The curve is shifted in steps to the lowest that the levels exceed by no more than
    8.0 dB in sum.

    Examples
    --------
    >>> inverse_a_level({63.0: 83.0, 125.0: 73.0, 250.0: 66.0, 500.0: 60.0})
    InverseALevel(level_db=58.0, excess_db=8.0, deciding_hz=63.0)
    """
    reference = np.array(list(INVERSE_A.values()))
    measured = tenths(in_bands(levels_db, tuple(INVERSE_A)))
    shift, excess = lowest_shift(measured, reference, EXCESS_DB, step_of(step_db))
    deciding = tuple(INVERSE_A)[int(np.argmax(measured - reference))]
    return InverseALevel(round(INVERSE_A[500.0] + shift, 6), excess, deciding)


def inverse_a_curve(level_db: float) -> dict[float, float]:
    """The curve of KS F 2863-2 shifted to a level {nominal octave [Hz]: [dB]}.

    >>> inverse_a_curve(58.0)[63.0]
    81.0
    """
    return {band: one + level_db - INVERSE_A[500.0] for band, one in INVERSE_A.items()}


# ----------------------------------------------------------------------------------------------------------------------
# How standards rate impact sound: what is measured in which bands, how it is averaged, what numbers are made of it.
#
# The one place that knows what a standard's name means.
# ----------------------------------------------------------------------------------------------------------------------

FIELD: Final = "ISO 16283-2"
RATING: Final = "ISO 717-2"
GRADES: Final = "JIS A 1419-2"
INVERSE: Final = "KS F 2863-2"
STANDARDS: Final = (FIELD, RATING, GRADES, INVERSE)
Blows = Literal["heavy", "tapping"]
BALL: Final = "rubber ball"
BANG_MACHINE: Final = "bang machine"
TAPPING_MACHINE: Final = "tapping machine"
_NOT_FOUND: Final = "has no accessible source to check it against"
_OF_BALL: Final = f"its rating of a rubber ball {_NOT_FOUND}: write {RATING}"
_REFUSED: Final = {  # (standard, source): (expected, why)
    (GRADES, BALL): ("a bang machine or a tapping machine", _OF_BALL),
    (INVERSE, BALL): ("a bang machine", _OF_BALL),
    (INVERSE, TAPPING_MACHINE): ("a bang machine", f"KS F 2863-1 {_NOT_FOUND}: write {GRADES} or {RATING}"),
}  # fmt: skip
_RATED_BY: Final = {  # source: standards that make a number of it
    BALL: (RATING,),
    BANG_MACHINE: (GRADES, INVERSE),
    TAPPING_MACHINE: (RATING, GRADES),
}
_SYMBOLS: Final = {  # (blows, standardised): of the bands, of the single number
    ("heavy", True): ("L'_i,Fmax,V,T", "L'_iA,Fmax,V,T"),
    ("heavy", False): ("L_i,Fmax", "L_iA,Fmax"),
    ("tapping", True): ("L'_nT", "L'_nT,w"),
    ("tapping", False): ("L_i", "L_i,w"),
}


def band_quantity_of(symbol: str) -> str:
    """The symbol of the bands that a single number of ISO is made of; "" for other numbers.

    >>> band_quantity_of("L'_nT,w"), band_quantity_of("L-50")
    ("L'_nT", '')
    """
    return next((bands for bands, number in _SYMBOLS.values() if number == symbol), "")


@stored_as("method of rating/1")
@dataclass(frozen=True)
class Method:
    """How standards rate one kind of blows.

    standards : of `STANDARDS`. blows : heavy (largest Fast levels) or tapping (levels of the mean square). source :
    what must strike. fraction : 3 for third octaves, 1 for octaves. bands_hz : nominal centres [Hz]. band_quantity :
    symbol of the levels. average : of levels [places, bands] over the places of the blow; over receivers all average
    the energy. numbers : what is made of them, in order. correct : standardises levels {band: [dB]} for a room's volume
    [m^3] and reverberation times {band: [s]}, None where nothing is.
    measured_by : the standard of measurement, "" where none is applied. fewest : places of the source, and of
    microphones, that it has, 0 where that is not known. volume_m3 : the least and the largest room it is for, or None.
    """

    standards: Annotated[tuple[str, ...], Reported("1", "Standards that were applied")]
    blows: Annotated[Blows, Reported("1", "Kind of blows")]
    source: str
    fraction: Fraction
    bands_hz: tuple[float, ...]
    band_quantity: Annotated[str, Reported("1", "Symbol of the levels by band")]
    average: Callable[[Floats], Floats]
    numbers: tuple[RatingNumber, ...]
    correct: Callable[[Mapping[float, float], float, Mapping[float, float]], dict[float, float]] | None = None
    measured_by: str = ""
    fewest: int = 0
    volume_m3: tuple[float, float] | None = None

    @property
    def bands(self) -> Annotated[str, Reported("1", "What the bands are called")]:
        """What the bands are called."""
        return "octave" if self.fraction == 1 else "third octave"

    @property
    def highest_hz(self) -> float:
        """Where the last band ends [Hz]: the upper edge beside its exact centre, 3162.28 Hz of the band 3150 Hz."""
        return self._last_exact * _half(self.fraction)

    @property
    def passed_hz(self) -> float:
        """Up to where the filter of the last band passes what matters to its level [Hz]."""
        return self._last_exact * filter_reach(self.fraction)

    @property
    def _last_exact(self) -> float:
        return float(10 ** (round(10 * log10(self.bands_hz[-1])) / 10))

    @property
    def least_sampling_hz(self) -> float:
        """The sampling that has all bands, in hundreds [Hz]: the last ends below 0.47 of it."""
        return 100.0 * ceil(self.highest_hz / 47.0)


def method_of(standards: Sequence[str], blows: Blows = "heavy") -> Method:
    """How the standards asked for rate blows.

    Parameters
    ----------
    standards : Sequence[str]
        Of `STANDARDS`, those of ISO or JIS A 1419-2 and KS F 2863-2.

    Raises
    ------
    AcousticsError
        None, another, both kinds in one room, blows that one of them does not rate.

    Examples
    --------
    >>> method_of(["KS F 2863-2", "JIS A 1419-2"]).standards
    ('JIS A 1419-2', 'KS F 2863-2')
    """
    others = [one for one in standards if one not in STANDARDS]
    if others or not standards:
        raise AcousticsError("levels", got=others[0] if others else "nothing", expected=" or ".join(STANDARDS))
    chosen = tuple(one for one in STANDARDS if one in standards)
    in_thirds = [one for one in chosen if one in (FIELD, RATING)]
    in_octaves = [one for one in chosen if one not in in_thirds]
    if in_thirds and in_octaves:
        raise AcousticsError(
            "levels",
            got=f"{in_thirds[0]}, in third octaves, with {in_octaves[0]}, in octaves",
            expected="standards of the same bands",
            do="for the other, add a second room of the same size at the same place",
        )
    if blows == "tapping":
        refuse_source(chosen, TAPPING_MACHINE)
    return _by_thirds(chosen, blows) if in_thirds else _by_octaves(chosen, blows)


def refuse_source(standards: Sequence[str], source: str) -> None:
    """AcousticsError where a standard source is one whose rating by one of the standards is not known here."""
    for standard in standards:
        if (standard, source) in _REFUSED:
            expected, why = _REFUSED[standard, source]
            raise AcousticsError("levels", got=f"a {source} by {standard}", expected=expected, do=why)


def sources_of(standards: Sequence[str]) -> tuple[str, ...]:
    """The standard sources whose levels all of these standards have.

    >>> sources_of(["ISO 16283-2", "ISO 717-2"]), sources_of(["KS F 2863-2"])
    (('rubber ball', 'tapping machine'), ('bang machine',))
    """
    thirds = (FIELD, RATING)
    chosen = [RATING if one in thirds else one for one in standards]
    return tuple(source for source, rated in _RATED_BY.items() if set(chosen) <= set(rated))


def rating_of(source: str) -> tuple[str, ...]:
    """The standards that make a single number of what a source makes heard; none of what is no standard source.

    >>> rating_of("bang machine")
    ('JIS A 1419-2', 'KS F 2863-2')
    """
    return _RATED_BY.get(source, ())


def _by_thirds(standards: tuple[str, ...], blows: Blows) -> Method:
    """ISO: third octaves, energy averages over all places, standardised or not."""
    measured = FIELD in standards
    heavy = blows == "heavy"
    rate = _a_weighted if heavy else _weighted
    stated = dict.fromkeys((measured, False)) if RATING in standards else {}
    return Method(
        standards=standards,
        blows=blows,
        source=BALL if heavy else TAPPING_MACHINE,
        fraction=3,
        bands_hz=tuple(A_THIRDS if heavy else CURVE_THIRDS),
        band_quantity=_SYMBOLS[blows, measured][0],
        average=energy_average,
        numbers=tuple(RatingNumber(_SYMBOLS[blows, one][1], one, rate) for one in stated),
        correct=(standardised_maximum_level if heavy else _standardised) if measured else None,
        measured_by=FIELD if measured else "",
        # of the ball "quattro o più posizioni differenti": https://www.sonorasrl.com, La palla in gomma; of microphones
        # the text was not at hand
        fewest=4 if measured else 0,
        # scope: https://standards.iteh.ai/catalog/standards/sist/cace4e42-6d16-453c-81f2-2bc2bce32e99
        volume_m3=(10.0, 250.0) if measured else None,
    )


def _by_octaves(standards: tuple[str, ...], blows: Blows) -> Method:
    """JIS and KS: octaves, arithmetic averages over the places of the blow, levels as they are in the room."""
    heavy = blows == "heavy"
    octaves = HEAVY_OCTAVES if heavy else LIGHT_OCTAVES
    numbers = {
        GRADES: RatingNumber(
            *(("L_i,Fmax,r,H(1)", False, _heavy_grade) if heavy else ("L_i,r,L", False, _light_grade))
        ),
        INVERSE: RatingNumber("L_i,Fmax,AW", False, _inverse_a),
    }
    return Method(
        standards=standards,
        blows=blows,
        source=BANG_MACHINE if heavy else TAPPING_MACHINE,
        fraction=1,
        bands_hz=octaves,
        band_quantity=_SYMBOLS[blows, False][0],
        average=_arithmetic,
        numbers=tuple(numbers[one] for one in standards),
    )


@stored_as("A-weighted number/1")
def _a_weighted(places_db: Floats) -> SingleNumber:
    found = heavy_impact_level(dict(zip(A_THIRDS, energy_average(places_db).tolist(), strict=True)))
    curve = equal_parts(found.unrounded_db)
    return SingleNumber(
        float(found.rating_db),
        found.unrounded_db,
        found.deciding_hz,
        curve,
        "levels at which all bands have equal shares in it",
    )


@stored_as("weighted number/1")
def _weighted(places_db: Floats) -> SingleNumber:
    levels = dict(zip(CURVE_THIRDS, energy_average(places_db).tolist(), strict=True))
    found, finely = weighted_impact_level(levels), weighted_impact_level(levels, step_db=0.1)
    return SingleNumber(
        found.weighted_db,
        finely.weighted_db,
        found.deciding_hz,
        shift_curve(found.weighted_db),
        "shifted reference curve",
        {"C_I": found.adaptation_db},
    )


@stored_as("grade of heavy blows/1")
def _heavy_grade(places_db: Floats) -> SingleNumber:
    return _grade(HEAVY_OCTAVES, places_db)


@stored_as("grade of light blows/1")
def _light_grade(places_db: Floats) -> SingleNumber:
    return _grade(LIGHT_OCTAVES, places_db)


def _grade(octaves: tuple[float, ...], places_db: Floats) -> SingleNumber:
    found = impact_grade(dict(zip(octaves, mean_of_places(places_db).tolist(), strict=True)), octaves)
    curve = grade_curve(found.grade, octaves)
    return SingleNumber(
        float(found.grade),
        found.unrounded_db,
        found.deciding_hz,
        curve,
        "curve of the grade",
        {"L number": float(found.number)},
    )


@stored_as("inverse A number/1")
def _inverse_a(places_db: Floats) -> SingleNumber:
    levels = dict(zip(HEAVY_OCTAVES, _arithmetic(places_db).tolist(), strict=True))
    found, finely = inverse_a_level(levels), inverse_a_level(levels, step_db=0.1)
    curve = inverse_a_curve(found.level_db)
    return SingleNumber(found.level_db, finely.level_db, found.deciding_hz, curve, "shifted inverse A curve")


@stored_as("standardised level/1")
def _standardised(levels_db: Mapping[float, float], volume: float, t60_s: Mapping[float, float]) -> dict[float, float]:
    return standardised_impact_level(levels_db, t60_s)


@stored_as("arithmetic average/1")
def _arithmetic(levels_db: Floats) -> Floats:
    return np.asarray(np.mean(levels_db, axis=0))


def _half(fraction: Fraction) -> float:
    """A band's upper edge over its centre."""
    return float(10 ** (0.15 if fraction == 1 else 0.05))
