"""Grades of JIS A 1419-2 against published examples."""

from __future__ import annotations

import pytest

from acoustics.levels.standards import CURVE_50, LIGHT_OCTAVES, impact_grade


def levels(*of_octaves: float) -> dict[float, float]:
    return dict(zip(CURVE_50, of_octaves, strict=False))


def test_examination_question() -> None:
    """Examination of 2016 for managers of building environment, question 87: Lr-75, "about Lr 73", too loud for Lr-70
    at 500 Hz. https://yaku-tik.com/bill/?p=3167, https://bm-sort.com/bmtest-human-16/."""
    found = impact_grade(levels(78, 75, 75, 73, 67, 64, 64), LIGHT_OCTAVES)
    assert (found.number, found.grade, found.deciding_hz) == (73, 75, 500.0)


@pytest.mark.parametrize(
    ("octaves", "number", "grade"),
    [((69, 58, 48, 38), 46, 45), ((67, 62, 50, 41), 49, 50)],
    ids=["803 to 703", "903 to 803"],
)
def test_heavy_blows_in_a_block_of_flats(octaves: tuple[float, ...], number: int, grade: int) -> None:
    """Measured 1997 by the Otsuru laboratory of Oita University, with the allowance of 2 dB:
    https://paperzz.com/doc/6723430/."""
    found = impact_grade(levels(*octaves))
    assert (found.number, found.grade) == (number, grade)


@pytest.mark.parametrize(
    ("octaves", "number", "grade"),
    [((60, 60, 52, 37, 29, 28), 47, None), ((57, 64, 55, 48, 37, 35), 51, 50)],
    ids=["803 to 703", "903 to 803"],
)
def test_light_blows_in_a_block_of_flats(octaves: tuple[float, ...], number: int, grade: int | None) -> None:
    """The same report; 803 to 703 is printed with L-50 where 47 less 2 is within L-45: it may have been 47.4."""
    found = impact_grade(levels(*octaves), LIGHT_OCTAVES)
    assert found.number == number
    assert grade is None or found.grade == grade
