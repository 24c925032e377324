"""Grades of JIS A 1419-2 and the level of KS F 2863-2, against the sources that quote them and their definitions."""

from __future__ import annotations

from math import ceil

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from acoustics.errors import AcousticsError
from acoustics.levels.standards import (
    CURVE_50,
    HEAVY_OCTAVES,
    INVERSE_A,
    LIGHT_OCTAVES,
    grade_curve,
    impact_grade,
    inverse_a_curve,
    inverse_a_level,
    mean_of_places,
)

one_level = st.integers(200, 900).map(lambda tenths: tenths / 10)
four = st.lists(one_level, min_size=4, max_size=4)
five = st.lists(one_level, min_size=5, max_size=5)


def heavy(levels):
    return dict(zip(HEAVY_OCTAVES, levels, strict=True))


def test_two_independent_sources_have_one_curve():
    """The Korean curve is the Japanese one of grade 60."""
    assert grade_curve(60.0) == dict(INVERSE_A)
    assert grade_curve(50.0, tuple(CURVE_50)) == dict(CURVE_50)


@pytest.mark.parametrize(
    ("levels", "number", "grade", "deciding"),
    [
        ([73, 63, 56, 50], 50, 50, 63.0),  # on the curve of grade 50
        ([75, 63, 56, 50], 52, 50, 63.0),  # 2 dB above it in one octave are allowed,
        ([76, 63, 56, 50], 53, 55, 63.0),  # 3 dB are not
        ([75, 65, 58, 52], 52, 50, 63.0),  # allowed in every octave
        ([75.4, 63, 56, 50], 52, 50, 63.0),  # rounded to whole decibels
        ([75.5, 63, 56, 50], 53, 55, 63.0),
        ([75.45, 63, 56, 50], 53, 55, 63.0),  # to .1 dB first
        ([60, 60, 50, 57.6], 58, 60, 500.0),
        ([50, 40, 33, 27], 27, 25, 63.0),
    ],
)
def test_grades_by_hand(levels, number, grade, deciding):
    """The rule of syaonApp.py: ceil((L number - 2) / 5) x 5."""
    found = impact_grade(heavy(levels))
    assert (found.number, found.grade, found.deciding_hz) == (number, grade, deciding)


def test_a_tapping_machine_is_graded_in_its_own_octaves():
    levels = dict(zip(LIGHT_OCTAVES, [63, 56, 50, 47, 59], strict=True))
    found = impact_grade({63.0: 120.0, **levels, 4000.0: 120.0}, LIGHT_OCTAVES)  # 59 - 46 above grade 50
    assert (found.number, found.grade, found.deciding_hz) == (63, 65, 2000.0)


@pytest.mark.parametrize(
    ("levels", "level", "excess"),
    [
        ([83, 73, 66, 60], 58, 8.0),  # four octaves, 2 dB each
        ([91, 0, 0, 0], 60, 8.0),
        ([91.1, 0, 0, 0], 61, 7.1),
        ([92, 0, 0, 0], 61, 8.0),
        ([91.04, 0, 0, 0], 60, 8.0),  # rounded to .1 dB
        ([91.05, 0, 0, 0], 61, 7.1),
    ],
)
def test_levels_that_the_source_tests(levels, level, excess):
    """The cases of pc_app/tests/test_legacy_bang.py, and where .1 dB decides."""
    found = inverse_a_level(heavy(levels))
    assert (found.level_db, found.excess_db) == (level, pytest.approx(excess))


@given(four, st.integers(-20, 20))
def test_shifts_shift(levels, steps):
    """Five decibels are a grade; one is one of the L number and of the inverse A-weighted level."""
    before, after = (impact_grade(heavy(np.add(levels, shift))) for shift in (0, 5 * steps))
    assert (after.grade, after.number) == (before.grade + 5 * steps, before.number + 5 * steps)
    one = impact_grade(heavy(np.add(levels, steps)))
    assert one.number == before.number + steps
    assert one.unrounded_db == pytest.approx(before.unrounded_db + steps)
    low, high = (inverse_a_level(heavy(np.add(levels, shift))) for shift in (0, steps))
    assert (high.level_db, high.excess_db) == (low.level_db + steps, pytest.approx(low.excess_db))


@given(four, st.integers(0, 3), st.integers(1, 300))
def test_a_louder_octave_is_never_better(levels, octave, tenths):
    louder = list(levels)
    louder[octave] += tenths / 10
    for rate in (impact_grade, inverse_a_level):
        before, after = rate(heavy(levels)), rate(heavy(louder))
        for name in ("grade", "number", "unrounded_db", "level_db"):
            if hasattr(before, name):
                assert getattr(after, name) >= getattr(before, name)


@given(five)
def test_grades_are_what_their_words_say(levels):
    """The lowest curve that no octave, in whole decibels, exceeds by more than two."""
    bands = dict(zip(LIGHT_OCTAVES, levels, strict=True))
    found = impact_grade(dict(reversed(bands.items())), LIGHT_OCTAVES)  # the order of a table says nothing
    whole = {band: np.floor(level + 0.5) for band, level in bands.items()}

    def exceeds(grade):
        return any(whole[band] > level + 2 for band, level in grade_curve(grade, LIGHT_OCTAVES).items())

    assert not exceeds(found.grade)
    assert exceeds(found.grade - 5)
    assert found.grade == 5 * ceil((found.number - 2) / 5)
    assert abs(found.unrounded_db - found.number) <= 0.5 + 1e-9  # rounding


@given(four)
def test_a_shifted_curve_lies_as_low_as_it_may(levels):
    for step in (1.0, 0.1):
        found = inverse_a_level(heavy(levels), step_db=step)

        def excess(level_db):
            curve = inverse_a_curve(level_db)
            return sum(max(0.0, level - curve[band]) for band, level in heavy(levels).items())

        assert excess(found.level_db) == pytest.approx(found.excess_db, abs=1e-6)  # rounding of sums of 0.1 dB
        assert found.excess_db <= 8.0
        assert excess(found.level_db - step) > 8.0
    assert 0 <= inverse_a_level(heavy(levels)).level_db - found.level_db < 1.0  # the coarser step lies above


@given(st.lists(four, min_size=2, max_size=5), st.permutations(range(4)))
def test_places_of_the_blow_are_alike(places, order):
    """Arithmetic, not of the energy; their order does not matter."""
    mean = mean_of_places(places)
    assert mean == pytest.approx(np.mean(places, axis=0))
    assert mean_of_places(places[::-1]) == pytest.approx(mean)
    assert mean_of_places(np.array(places)[:, order]) == pytest.approx(mean[list(order)])
    assert mean_of_places([[60.04, 60.05]]) == pytest.approx([60.0, 60.1])


@pytest.mark.parametrize(
    ("rate", "told"),
    [
        (lambda: impact_grade({63.0: 70.0, 250.0: 50.0}), "levels: got no level at 125, 500 Hz, expected 4 bands"),
        (lambda: impact_grade(heavy([70] * 4), LIGHT_OCTAVES), "got no level at 1000, 2000 Hz, expected 5 bands"),
        (lambda: inverse_a_level({63.0: 70.0}), "got no level at 125, 250, 500 Hz"),
        (lambda: impact_grade(heavy([70, 60, np.nan, 50])), "expected finite numbers"),
        (lambda: inverse_a_level(heavy([70] * 4), step_db=5.0), "step: got 5 dB, expected 1 or 0.1 dB"),
    ],
)
def test_bands_that_are_missing_are_named(rate, told):
    with pytest.raises(AcousticsError, match=told):
        rate()
