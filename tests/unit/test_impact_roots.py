"""First roots of polynomials: none is skipped, however close together, at the end, or at the start."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial import polynomial

from femstruct.impact.exact import DEPTH, NEVER, ORDER, exact_rule, first_descent, stays_positive


def first(roots: list[float], scale: float = 1.0, order: int = ORDER, lead: int = 0) -> float:
    c = np.zeros(ORDER + 1)
    made = polynomial.polyfromroots(roots)
    made *= scale * np.sign(made[0])
    c[lead : lead + len(made)] = made
    return first_descent(c, lead, order, exact_rule().bernstein, np.zeros((DEPTH, ORDER + 1)), np.zeros((DEPTH, 2)))


@pytest.mark.parametrize("apart", [1e-1, 1e-3, 1e-6])
def test_close_roots_are_found(apart: float) -> None:
    """A dip of apart^2 / 4 below zero: its first end to rounding over the slope there."""
    # steps and rounding: none here
    assert first([0.3, 0.3 + apart, 2.5, -1.2]) == pytest.approx(0.3, abs=1e-15 / apart * 10)


def test_random_roots_against_the_list() -> None:
    rng = np.random.default_rng(3)
    for _ in range(2000):
        roots = list(rng.uniform(-1.5, 2.5, rng.integers(1, 9)))
        inside = sorted(r for r in roots if 0 < r <= 1)
        found = first(roots, 10 ** rng.uniform(-9, 9), int(rng.integers(len(roots), ORDER + 1)))
        slope = np.prod([abs(inside[0] - r) for r in roots if r != inside[0]]) if inside else 1.0
        size = np.prod([1 + abs(r) for r in roots])
        if inside and slope > 1e-9 * size:
            assert found == pytest.approx(inside[0], abs=1e-14 * size / slope)  # steps and rounding: 1e-16 here
        elif not inside:
            assert found == NEVER or found > 1.0 - 1e-6


def test_leading_coefficients_may_be_left_out() -> None:
    """theta^3 (0.4 - theta): what is zero at the start is divided off, its next root stays."""
    assert first([0.4], lead=3) == pytest.approx(0.4, abs=1e-15)  # rounding


@pytest.mark.parametrize("start", [1e-8, 1e-20, 5e-26, 1e-40])
def test_a_start_far_below_the_rounding_of_the_step_is_a_start(start: float) -> None:
    """start + b theta - theta^2: the rounding of a value near 0 is not that of the whole step."""
    c = np.zeros(ORDER + 1)
    args = (exact_rule().bernstein, np.zeros((DEPTH, ORDER + 1)), np.zeros((DEPTH, 2)))
    for b in (0.0, 1e-16, -1e-16):
        c[:3] = start, b, -1.0
        both = abs(b) + np.sqrt(b**2 + 4.0 * start)
        root = 0.5 * both if b >= 0.0 else 2.0 * start / both
        # the step is halved 60 times at most
        assert first_descent(c, 0, ORDER, *args) == pytest.approx(root, rel=1e-14, abs=0.0 if root > 1e-17 else 1e-17)


def test_touching_is_no_descent() -> None:
    """(theta - 0.5)^2 touches zero and never goes below; nor does it by less than rounding."""
    assert first([0.5, 0.5]) == NEVER
    c = np.zeros(ORDER + 1)
    c[:3] = 0.25 - 1e-17, -1.0, 1.0
    args = (exact_rule().bernstein, np.zeros((DEPTH, ORDER + 1)), np.zeros((DEPTH, 2)))
    assert first_descent(c, 0, ORDER, *args) == NEVER
    c[0] = 0.25 - 1e-13
    # steps and rounding: 6e-12 here
    assert first_descent(c, 0, ORDER, *args) == pytest.approx(0.5 - np.sqrt(1e-13), abs=1e-9)


def test_the_first_look_never_lies() -> None:
    """stays_positive is a proof: no polynomial it passes is negative anywhere."""
    rng = np.random.default_rng(5)
    theta = np.linspace(0.0, 1.0, 201)
    passed = 0
    for _ in range(2000):
        c = rng.standard_normal(ORDER + 1) * 2.0 ** np.arange(ORDER + 1)
        c /= np.cumprod(np.maximum(np.arange(ORDER + 1), 1))
        c[0] = abs(c[0])
        if stays_positive(c, 0, ORDER, exact_rule().coarse):
            passed += 1
            assert polynomial.polyval(theta, c).min() > 0.0
    assert passed > 100
