"""The formulations of steady vibration, shock, perception and fatigue against closed forms and printed numbers."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np
import pytest

from tests.independent import vibration as by_hand


def test_moments_of_an_oscillator_under_white_noise() -> None:
    """Miles and Crandall: mean square of the absolute acceleration pi f S (1 + 4 z^2) / (4 z), from 0 to everywhere."""
    f0, z, s = 20.0, 0.03, 2.0
    m = by_hand.moments(
        lambda f: np.abs(by_hand.transmitted(2 * pi * f0, z, 2 * pi * f)) ** 2 * s, 1e-9, 2000 * f0, [f0]
    )
    # beyond 2000 f0 the square falls as 4 z^2 f0^2 / f^2: 4 z^2 f0 / 2000 of S
    assert m[0] == pytest.approx(pi * f0 * s * (1 + 4 * z * z) / (4 * z) - 4 * z * z * f0 / 2000 * s, rel=1e-7)


def test_damage_of_a_narrow_band() -> None:
    """Dirlik's ranges of a narrow band are Rayleigh's: within 3 %, as his fit has it."""
    f0, z = 50.0, 0.002
    m = by_hand.moments(
        lambda f: np.abs(by_hand.receptance([2 * pi * f0], [z], [1], [1])(2 * pi * f)) ** 2, 40, 60, [f0]
    )
    # the narrow band still has a width, which Dirlik counts
    assert by_hand.dirlik(m, 4, 1e-3, 1e6, 10) == pytest.approx(by_hand.rayleigh_damage(m, 4, 1e-3, 1e6, 10), rel=0.03)


def test_rainflow_of_the_standard() -> None:
    """The example of ASTM E1049-85, figure 6: -2 1 -3 5 -1 3 -4 4 -2."""
    found = by_hand.rainflow(np.array([-2.0, 1, -3, 5, -1, 3, -4, 4, -2]))
    counts = {size: sum(c for s, c in found if s == size) for size in {s for s, _ in found}}
    assert counts == {3: 0.5, 4: 1.5, 6: 0.5, 8: 1.0, 9: 0.5}
    assert by_hand.miner([(2.0, 1.0), (1.0, 0.5)], 3, 1.0, 100.0) == pytest.approx(0.085)


def test_shock_spectrum_of_a_half_sine() -> None:
    """Undamped: 1.7685 at 0.81 cycles in the pulse (Harris' Shock and Vibration Handbook: 1.76 to 1.77); slow ones feel
    its change of speed, 2 pi f dv; stiff ones the pulse itself."""
    lasts = 0.01
    step = lasts / 4000
    pulse = np.sin(pi * np.arange(4001) / 4000)
    up, down = by_hand.shock_spectrum(pulse, step, np.linspace(70, 90, 41), 1e-9)
    # a printed value of three decimals
    assert up.max() == pytest.approx(1.768, abs=0.002)
    assert down == pytest.approx(up, rel=0.5)  # they ring on as far, but not where the pulse holds them
    slow, stiff = (by_hand.shock_spectrum(pulse, step, np.array([f]), z)[0][0] for f, z in ((0.5, 0.0), (5e3, 0.3)))
    # terms of the next order in f / f_n
    assert slow == pytest.approx(2 * pi * 0.5 * 2 * lasts / pi, rel=1e-3)
    # terms of the next order in f / f_n
    assert stiff == pytest.approx(1.0, rel=2e-3)


def test_weightings_as_printed() -> None:
    """ISO 2631-1, table 3 (factors x 1000): Wk and Wd; ISO 2631-2, table A.1: Wm; KB at its corner."""
    f = np.array([1.0, 4.0, 8.0, 16.0, 63.0])
    # printed factors have three digits, at true third octave centres
    assert np.abs(by_hand.w_k(f)) * 1000 == pytest.approx([482, 967, 1036, 768, 186], rel=6e-3)
    # printed factors have three digits, at true third octave centres
    assert np.abs(by_hand.w_d(f)) * 1000 == pytest.approx([1011, 512, 253, 125, 29.5], rel=8e-3)
    # printed factors have three digits, at true third octave centres
    assert np.abs(by_hand.w_m(f)) * 1000 == pytest.approx([833, 816, 579, 335, 83.6], rel=1.2e-2)
    # corner of the weighting: the band limits' own share
    assert abs(by_hand.kb(np.array([5.6]))[0]) == pytest.approx(1 / sqrt(2), rel=5e-4)


def test_running_rms_of_a_steady_sine() -> None:
    """It comes to the rms, and to 1 - e^-1 of the square after one time constant."""
    fs = 2000.0
    t = np.arange(0, 2.0, 1 / fs)
    found = by_hand.running_rms(np.sin(2 * pi * 50 * t), fs, 0.125)
    # ripple of the running mean
    assert found[-200:].mean() == pytest.approx(sqrt(0.5), rel=2e-3)
    # ripple of the running mean over a few periods
    assert (found[240:260] ** 2).mean() == pytest.approx(0.5 * (1 - np.exp(-1)), rel=0.02)


def test_lines_in_double_logarithmic_paper() -> None:
    """3 dB an octave: half at double."""
    of = by_hand.log_log([(10.0, 1.0), (100.0, 0.1)])
    assert of(np.array([5.0, 20.0, 100.0])) == pytest.approx([0.0, 0.5, 0.1])


def test_receptance_of_an_oscillator() -> None:
    """1 / k at rest, 1 / (2 z k) at resonance."""
    of = by_hand.receptance([10.0], [0.05], [1 / sqrt(2)], [1 / sqrt(2)])
    assert np.abs(of(np.array([0.0, 10.0]))) == pytest.approx([1 / 200, 1 / 20])
