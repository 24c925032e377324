"""Ratings of impact sound in octaves: the grades of JIS A 1419-2 and the inverse A-weighted level of KS F 2863-2.

The standards' own tables were not at hand. JIS A 1419-2: curve, octaves, rounding and allowance as
https://github.com/toyoun-benec/syaonApp (syaonApp.py) has them; https://dsp-piano.com/note/value-l says the rule in
words; the first pages of the standard are at https://kikakurui.com/a1/A1419-2-2000-01.html. KS F 2863-2: curve and rule
as https://github.com/yohan2256/daqhats (pc_app/LEGACY_BANG.md) took them from a test report that is published at
https://www.kira.or.kr/gongji_2013/ (printed pages 33 and 34). Its curve is that of the Japanese grade 60.

KS F 2863-1 (tapping machine) and what JIS A 1419-2 makes of a rubber ball are absent: they were not found in a source
that can be read and checked.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import ceil
from types import MappingProxyType
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from acoustics.arrays import Floats
from acoustics.levels.iso import in_bands, lowest_shift, nearest_step, step_of, tenths

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
    """Grade by JIS A 1419-2 of octave levels {nominal centre [Hz]: [dB]}: a floor of grade 55 is better than one of 60.

    levels_db : average of the places of the blow, see `mean_of_places`: largest Fast levels of a bang machine, levels
        of the mean square of a tapping machine. octaves_hz : `HEAVY_OCTAVES` or `LIGHT_OCTAVES`; others are not
        looked at.

    Raises AcousticsError: octaves missing.

    Notes
    -----
    Levels are rounded to 0.1 dB and then to whole decibels. The L number is the largest (level - curve of grade 50) +
    50. The grade is the lowest multiple of 5 whose curve no octave exceeds by more than 2 dB.

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

    levels_db : average of the octaves 63 to 500 Hz: arithmetic over the places of the blow, of the energy over
        microphones. Others are not looked at. step_db : 1, or 0.1 for comparisons that are finer than the standard's.

    Raises AcousticsError: octaves missing, a step other than these two.

    Notes
    -----
    Levels are rounded to 0.1 dB. The curve is shifted in steps to the lowest that the levels exceed by no more than
    8.0 dB in sum.

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
