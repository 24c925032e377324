"""Section constants against closed forms and against each other."""

from __future__ import annotations

import numpy as np
import pytest

from femstruct.errors import InputError
from femstruct.model.sections import Section, box, circle, i_section, rectangle, tube

ROUNDING = 1e-13  # rounding: none here


@pytest.mark.parametrize(
    ("ratio", "factor"), [(1.0, 0.1406), (1.5, 0.1958), (2.0, 0.2287), (5.0, 0.2913), (10.0, 0.3123)]
)
def test_torsion_of_rectangles(ratio: float, factor: float) -> None:
    """Timoshenko & Goodier, Theory of Elasticity, article 109: J = k1 (2a)^3 (2b), four digits."""
    section = rectangle("r", 0.02, 0.02 * ratio)
    assert pytest.approx(factor * 0.02**4 * ratio, rel=4e-4) == section.J  # four digits of the factors: 2e-4 here
    assert rectangle("r", 0.02 * ratio, 0.02).J == section.J
    assert section.Iy == pytest.approx(0.02 * (0.02 * ratio) ** 3 / 12, rel=1e-15)  # rounding: none here
    assert section.Iz == pytest.approx(0.02 * ratio * 0.02**3 / 12, rel=1e-15)  # rounding: none here


def test_circle_and_tube() -> None:
    solid = circle("c", 0.05)
    assert pytest.approx(np.pi * 0.05**4 / 32, rel=1e-15) == solid.J  # rounding: none here
    assert solid.Iy == solid.Iz == pytest.approx(np.pi * 0.05**4 / 64, rel=1e-15)  # rounding: none here
    hollow = tube("t", 0.05, 0.005)
    assert pytest.approx(solid.A - circle("inner", 0.04).A, rel=1e-14) == hollow.A  # rounding: none here
    assert pytest.approx(solid.J - circle("inner", 0.04).J, rel=1e-14) == hollow.J  # rounding: none here
    # of first order in t / r = 1e-6 or below: 3e-10 here
    assert tube("thin", 0.05, 1e-6).ky == pytest.approx(0.5, abs=1e-7)


def test_box_is_the_difference_of_two_rectangles_and_thin_in_torsion() -> None:
    section = box("b", 0.1, 0.2, 0.004)
    outer, inner = rectangle("o", 0.1, 0.2), rectangle("i", 0.092, 0.192)
    for name in ("A", "Iy", "Iz"):
        assert getattr(section, name) == pytest.approx(getattr(outer, name) - getattr(inner, name), rel=ROUNDING)
    area, perimeter = 0.096 * 0.196, 2 * (0.096 + 0.196)
    assert pytest.approx(4 * area**2 * 0.004 / perimeter, rel=ROUNDING) == section.J
    assert section.ky + section.kz == pytest.approx(1.0, rel=0.01)  # walls meet in the corners


def test_i_section_by_its_three_walls() -> None:
    section = i_section("I", 0.1, 0.2, 0.006, 0.009)
    flange, web = rectangle("f", 0.1, 0.009), rectangle("w", 0.006, 0.182)
    assert pytest.approx(2 * flange.A + web.A, rel=ROUNDING) == section.A
    arm = (0.2 - 0.009) / 2
    assert section.Iy == pytest.approx(2 * (flange.Iy + flange.A * arm**2) + web.Iy, rel=ROUNDING)
    assert section.Iz == pytest.approx(2 * flange.Iz + web.Iz, rel=ROUNDING)
    assert pytest.approx((2 * 0.1 * 0.009**3 + 0.191 * 0.006**3) / 3, rel=ROUNDING) == section.J


def test_impossible_shapes_are_refused() -> None:
    with pytest.raises(InputError, match=r"sections.s.width: got -0.1, expected a positive number"):
        rectangle("s", -0.1, 0.1)
    with pytest.raises(InputError, match=r"sections.t.thickness: got 0.03 m, expected less than 0.025 m"):
        tube("t", 0.05, 0.03)
    with pytest.raises(InputError, match=r"less than 0\.05 m"):
        box("b", 0.1, 0.2, 0.05)
    with pytest.raises(InputError, match=r"sections.i"):
        i_section("i", 0.1, 0.2, 0.01, 0.1)
    with pytest.raises(InputError, match=r"sections.g.J"):
        Section("g", 1e-4, 1e-9, 1e-9, float("nan"))
