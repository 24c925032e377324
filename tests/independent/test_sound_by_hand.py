"""The formulations of levels, boxes and open air against closed forms and printed numbers."""

from __future__ import annotations

from math import log10, pi

import numpy as np
import pytest

from tests.independent import levels
from tests.independent.pistons import Oscillator, ceiling_piston
from tests.independent.plates import (
    Box,
    SupportedPlate,
    motion_with_air_of_box,
    power_in_the_open,
    pressure_in_box,
    pressure_in_the_open,
    pressure_of_motion,
    sine_on_cosine,
)


def test_a_weighting_as_printed() -> None:
    """IEC 61672-1, table 3: 63 Hz -26.2, 250 Hz -8.6, 4 kHz 1.0, 16 kHz -6.6 dB."""
    f = np.array([levels.exact(one) for one in (63, 250, 1000, 4000, 16000)])
    # the table of IEC 61672-1 has one decimal
    assert 20 * np.log10(levels.a_weighting(f)) == pytest.approx([-26.2, -8.6, 0, 1.0, -6.6], abs=0.05)
    # the poles are those of the formula: rounding
    assert np.abs(levels.a_filter(f)) == pytest.approx(levels.a_weighting(f), rel=1e-9)


def test_levels_of_a_tone() -> None:
    """94 dB of 1 Pa rms; a burst of one time constant reaches 1 - 1/e; its exposure lies in its band."""
    fs = 48000.0
    t = np.arange(0, 1.0, 1 / fs)
    tone = np.sqrt(2) * np.sin(2 * pi * 1000 * t)
    # ripple of the time weighting at twice 1 kHz
    assert levels.fast_maximum(tone, fs) == pytest.approx(93.98, abs=0.01)
    burst = np.where(t < 0.125, tone, 0.0)
    # ripple of the time weighting at twice 1 kHz
    assert levels.fast_maximum(burst, fs) == pytest.approx(93.98 + 10 * log10(1 - np.exp(-1)), abs=0.01)
    # skirts of the band, which take the ends of a tone
    assert levels.third_exposure(tone, fs, 1000) == pytest.approx(93.98, abs=0.02)


def test_rating_as_printed() -> None:
    """A spectrum that is the reference curve has its 60 dB, with 32 dB beyond it still; C_I of equal bands."""
    curve = np.array(levels.REFERENCE, float)
    assert levels.impact_rating(curve)[0] == 58  # 32 dB over 16 bands is 2 dB each
    assert levels.impact_rating(curve + 2)[0] == 60
    assert levels.impact_rating(curve + 2.1)[0] == 61
    weighted, c = levels.impact_rating([60.0] * 16)
    assert weighted + c == round(60 + 10 * log10(15)) - 15


def test_box_is_a_tube_to_its_piston() -> None:
    """All of the ceiling moves: -j rho c v cos(k z) / sin(k L), in every receiver."""
    box = Box((1.1, 0.9, 2.0))
    f, z = np.array([20.0, 70.0, 130.0]), 0.7
    k = 2 * pi * f / box.c
    right = -1j * box.rho * box.c * np.cos(k * z) / np.sin(k * 2.0) / (1.1 * 0.9)  # per flow into it
    found = box.per_flow(2j * pi * f, (0, 0), (0.3, 0.2, z), 2.0, 60)
    assert found == pytest.approx(right, rel=2e-5)  # tail beyond 60 orders at rest


def test_integrals_of_sines_and_cosines() -> None:
    """By quadrature, also where both have one wavelength."""
    for m, length, start, order, whole in ((3, 0.7, 0.2, 2, 1.5), (2, 1.0, 0.0, 2, 1.0), (1, 0.5, 0.25, 2, 1.0)):
        x, w = np.polynomial.legendre.leggauss(60)
        u = start + length * (x + 1) / 2
        right = (w * length / 2 * np.sin(m * pi * (u - start) / length) * np.cos(order * pi * u / whole)).sum()
        # rounding of an integral of about 1
        assert sine_on_cosine(m, length, start, order, whole) == pytest.approx(right, abs=1e-14)


def test_a_stiff_plate_over_a_box_and_in_the_open() -> None:
    """Slowly, a box is a spring rho c^2 / V of the displaced volume; far away open air has rho a / (2 pi r)."""
    plate = SupportedPlate(0.6, 0.5, 5e-3, 70e9, 0.3, 2700.0)
    f, drive = np.array([1.0]), (0.3, 0.25)
    found = pressure_in_box(Box((0.6, 0.5, 0.4)), plate, (0, 0), drive, (0.1, 0.1, 0.4 / np.sqrt(3)), f, 0.02, 6e4)
    bent = sum(
        plate.shape(m, n, drive) / (2 * pi * g) ** 2
        * 2 / np.sqrt(plate.rho * plate.h * 0.3) * 4 * 0.3 / (pi * pi * m * n) for g, m, n in plate.modes(6e4)
        if m % 2 and n % 2
    )  # fmt: skip
    # terms of the next order in (k L)^2
    assert found[0].real == pytest.approx(-1.21 * 343**2 / 0.12 * bent, rel=1e-3)
    far = pressure_in_the_open(plate, drive, (0, 0, 30.0), f, 0.0, 6e4)
    # terms of the next order in L / r
    assert abs(far[0]) == pytest.approx(1.21 * (2 * pi) ** 2 * bent / (2 * pi * 30.0), rel=1e-3)


def test_air_that_pushes_back_and_power() -> None:
    """Thin air changes nothing; slow air is a spring of the displaced volume; a slow plate is a source of that flow."""
    plate, drive, f = SupportedPlate(0.6, 0.5, 5e-3, 70e9, 0.3, 2700.0), (0.2, 0.25), np.array([1.0])
    thin = Box((0.6, 0.5, 0.4), rho=1e-9)
    shapes, moved = motion_with_air_of_box(thin, plate, (0, 0), drive, f, 0.02, 6e3)
    place = (0.1, 0.1, 0.3)
    alone = pressure_in_box(thin, plate, (0, 0), drive, place, f, 0.02, 6e3)
    # the air pushes back by 1e-9 of its own
    assert pressure_of_motion(thin, plate, (0, 0), shapes, moved, place, f) == pytest.approx(alone, rel=1e-6)
    dense = Box((0.6, 0.5, 0.4), rho=1e3)
    shapes, moved = motion_with_air_of_box(dense, plate, (0, 0), drive, f, 0.0, 6e3, orders=1)
    amount = 2 / np.sqrt(plate.rho * plate.h * 0.3) * 0.3 / pi**2
    volumes = np.array([4 * amount / (m * n) if m % 2 and n % 2 else 0.0 for m, n in shapes])
    free = np.array([plate.shape(m, n, drive) / (2 * pi * g) ** 2 for g, m, n in plate.modes(6e3)])
    soft = volumes / np.array([(2 * pi * g) ** 2 for g, _, _ in plate.modes(6e3)])
    spring = 1e3 * 343**2 / 0.12
    # a spring in parallel by Sherman and Morrison; inertia at 1 Hz, (1 / 63)^2, and of the air
    assert (volumes @ moved)[0].real == pytest.approx(volumes @ free / (1 + spring * (volumes @ soft)), rel=1e-3)
    power = power_in_the_open(plate, drive, f, 0.0, 6e3)[0]
    flow = 2 * pi * (volumes @ free)
    # Q^2 w^2 rho / (2 pi c) of a source on a wall; inertia of the plate, twice (1 / 63)^2
    assert power == pytest.approx(flow**2 * (2 * pi) ** 2 * 1.21 / (2 * pi * 343), rel=1e-3)


def test_a_piston_over_a_box_by_another_sum() -> None:
    """Orders of the ceiling in closed form along the height, or by cosines of the height; and a piston that is all."""
    size, gamma, tau, s = (1.4, 1.1, 0.9), 20.0, 1e-5, 2j * pi * np.array([30.0, 170.0, 260.0])
    piston, place = ceiling_piston(size, (0.2, 0.3, 0.8, 0.5), gamma=gamma, tau=tau, orders=12), (0.3, 0.2, 0.4)
    box = Box(size, gamma=gamma, tau=tau)

    def along(order: int, start: float, long: float, whole: float) -> float:
        x, w = np.polynomial.legendre.leggauss(40)
        return float((w * long / 2 * np.cos(order * pi * (start + long * (x + 1) / 2) / whole)).sum())

    right = sum(
        along(i, 0.2, 0.8, 1.4) * along(j, 0.3, 0.5, 1.1) * box.per_flow(s, (i, j), place, 0.9, 200)
        for i in range(12) for j in range(12)
    )  # fmt: skip
    # the tail of the sum along the height, as at rest beyond 200 orders
    assert piston.per_velocity(s, place) == pytest.approx(right, rel=1e-5)
    whole = ceiling_piston(size, (0.0, 0.0, 1.4, 1.1), orders=3)
    k = s.imag / 343.0
    # all orders but the first are rounding
    assert whole.on_piston(s) == pytest.approx(-1j * 1.21 * 343 * 1.54 / np.tan(k * 0.9), rel=1e-9)


def test_a_piston_on_air_that_leaks() -> None:
    """Slowly, air is a spring rho c^2 S^2 / V; where the leak has no impedance there is no pressure."""
    whole, moved = ceiling_piston((1.4, 1.1, 0.9), (0.0, 0.0, 1.4, 1.1), orders=3), Oscillator(10.0, 50.0, 0.02)
    s, place = 2j * pi * np.array([0.1]), (0.3, 0.2, 0.4)
    spring, own = 1.21 * 343**2 * 1.54 / 0.9, 10.0 * (2 * pi * 50) ** 2
    found = whole.per_force(moved, s, place, True, None)
    # terms of the next order in f over 50 Hz; and losses, 0.02 f / 50 Hz
    assert found == pytest.approx(-spring / 1.54 / (own + spring), rel=1e-4)
    plug = s * 2.0
    # a spring rho c^2 / V of volume and the plug in parallel: p = Q / (V s / (rho c^2) + 1 / (s M))
    soft = 0.9 * 1.54 * s / (1.21 * 343**2)
    flow = -s * 1.54 / (own + 1.54**2 * s / (soft + 1 / plug))
    assert whole.per_force(moved, s, place, True, plug) == pytest.approx(flow / (soft + 1 / plug), rel=1e-4)
