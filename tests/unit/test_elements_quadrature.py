"""Gauss points on the unit interval."""

import pytest

from femstruct.elements.polynomials import gauss_interval


@pytest.mark.parametrize("n", [1, 2, 4])
def test_gauss_points_are_exact_to_degree_2n_minus_1_and_not_beyond(n):
    points, weights = gauss_interval(n)
    assert weights @ points ** (2 * n - 1) == pytest.approx(1 / (2 * n), rel=1e-14)  # rounding: none here
    assert abs(weights @ points ** (2 * n) - 1 / (2 * n + 1)) > 1e-6
