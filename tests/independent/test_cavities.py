"""The reference of two plates on air against closed forms."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from tests.independent.cavities import Fluid, Pair

AIR = Fluid(c=343.0, rho=1.2)


def test_a_thin_cavity_is_a_spring_for_pistons_and_for_tilts() -> None:
    """rho c^2 / d per area; a tilt of long waves only pushes the air along: rho / (k^2 d), 8 / pi^4 of the order 1."""
    s = 2j * pi * 10.0
    found = Pair((1.0, 0.7), (10.0, 20.0), [(0.1, AIR)], {}).air(s)
    spring = 1.2 * 343.0**2 / 0.1 * 0.7
    assert found[0, 0] == pytest.approx(spring, rel=1e-3)  # (k d)^2 / 3
    assert found[0, 3] == pytest.approx(-spring, rel=1e-3)
    sums = sum(8 / (m * pi) ** 4 / ((m * pi) ** 2 + (s / 343.0) ** 2) for m in range(1, 40, 2))
    assert (found[1, 1] + found[1, 4]) - (found[4, 1] + found[4, 4]) == pytest.approx(
        0.0, abs=1e-6 * spring
    )  # rounding
    assert (found[1, 1] - found[1, 4]) / 2 == pytest.approx(
        s * s * 1.2 * 0.7 / 0.1 * sums, rel=0.03
    )  # (k d)^2 / 3 of the order 1


def test_layers_of_one_fluid_are_one_layer() -> None:
    wool = Fluid(c=343.0, rho=1.2, sigma=1e4, bulk=40.0, limp=True)
    one, two = ([(0.3, wool)], [(0.1, wool), (0.2, wool)])
    whole, parts = (Pair((1.0, 0.7), (10.0, 20.0), layers, {}).air(300j) for layers in (one, two))
    np.testing.assert_allclose(parts, whole, rtol=1e-9, atol=1e-6)  # rounding
