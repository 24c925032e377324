"""The formulation of contacts by events, against closed forms; nothing of the packages is in it."""

from __future__ import annotations

from math import acos, exp, gamma, pi, sqrt

import numpy as np
import pytest

from tests.independent.contact_events import (
    Chain,
    Pulse,
    Spring,
    Touch,
    chi_of_restitution,
    cubic,
    factored,
    hertz,
    linear,
    power,
    run,
    table,
)

CLOSE = 1e-8  # DOP853 at 1e-11 over some hundred steps


def _hit(law: object, mass: float = 0.3, speed: float = 2.0) -> Chain:
    return Chain(bodies={"a": mass}, touches=[Touch("c", "a", None, law)], start={"a": -speed})


def test_linear_springs_and_dashpots() -> None:
    """Peak v sqrt(k m), lasting pi sqrt(m / k); with a dashpot exp(-2 z acos(z) / sqrt(1 - z^2)) comes back."""
    m, v, k = 0.3, 2.0, 4e5
    path = run(_hit(linear(k), m, v), 10e-3)
    assert path.peak("c") == pytest.approx(v * sqrt(k * m), rel=CLOSE)
    assert path.touching("c")[0][1] == pytest.approx(pi * sqrt(m / k), rel=CLOSE)
    z = 0.2
    path = run(_hit(linear(k, 2 * z * sqrt(k * m)), m, v), 10e-3)
    back = path.speed("a", np.array([10e-3]))[0]
    assert back / v == pytest.approx(exp(-2 * z * acos(z) / sqrt(1 - z * z)), rel=CLOSE)
    path = run(_hit(linear(k, 2 * z * sqrt(k * m), tensile=True), m, v), 10e-3)
    assert path.speed("a", np.array([10e-3]))[0] / v == pytest.approx(exp(-pi * z / sqrt(1 - z * z)), rel=CLOSE)


def test_springs_of_other_shapes() -> None:
    """Energy gives the depth, hence the peak; the beta function gives how long a power lasts."""
    m, v, k, n = 0.3, 2.0, 1e9, 1.5
    depth = ((n + 1) * m * v * v / (2 * k)) ** (1 / (n + 1))
    lasts = 2 * depth / v * sqrt(pi) * gamma(1 + 1 / (n + 1)) / gamma(0.5 + 1 / (n + 1))
    for law in (hertz(k), power(k, n)):
        path = run(_hit(law, m, v), 10e-3)
        assert path.peak("c") == pytest.approx(k * depth**n, rel=CLOSE)
        assert path.touching("c")[0][1] == pytest.approx(lasts, rel=1e-7)  # d^1.5 bends at its ends
    k, k3 = 1e5, 1e11
    square = (-k + sqrt(k * k + 2 * k3 * m * v * v)) / k3
    assert run(_hit(cubic(k, k3), m, v), 10e-3).peak("c") == pytest.approx((k + k3 * square) * sqrt(square), rel=CLOSE)
    # straight lines 0-1 mm of 1e5 N/m, then 5e5 N/m: 0.05 J in the first, the rest in the second
    path = run(_hit(table([0, 1e-3, 2e-3], [0, 100, 600]), m, v), 20e-3)
    beyond = (-100 + sqrt(100**2 + 2 * 5e5 * (0.5 * m * v * v - 0.05))) / 5e5
    assert path.peak("c") == pytest.approx(100 + 5e5 * beyond, rel=CLOSE)


@pytest.mark.parametrize("e", [0.05, 0.4, 0.9, 0.995])
def test_dissipation_of_a_restitution(e: float) -> None:
    """What is asked for comes back, of two springs."""
    chi = chi_of_restitution(e, 2.0)
    for law in (power(1e9, 1.5, chi), factored(lambda d, _: 1e5 * d, chi)):
        path = run(_hit(law), 0.05)
        # chi of a law is solved to 1e-8
        assert path.speed("a", np.array([0.05]))[0] / 2.0 == pytest.approx(e, rel=1e-7)


def test_two_bodies_and_a_gap() -> None:
    """Newton's cradle of unlike masses: momentum and energy; the gap delays the second meeting."""
    chain = Chain(
        bodies={"a": 0.2, "b": 0.5},
        touches=[Touch("c", "a", "b", linear(1e6)), Touch("d", "b", None, hertz(1e9), gap=5e-3)],
        start={"a": -3.0},
    )
    path = run(chain, 20e-3)
    first, second = path.touching("c")[0], path.touching("d")[0]
    between = 0.5 * (first[1] + second[0])
    speeds = [path.speed(name, np.array([between]))[0] for name in "ab"]
    assert speeds == pytest.approx([-3 * (0.2 - 0.5) / 0.7, -3 * 0.4 / 0.7], rel=CLOSE)
    assert second[0] > first[1]
    assert path.moved("b", np.array([second[0]]))[0] == pytest.approx(-5e-3, rel=CLOSE)


def test_an_oscillator_a_link_and_a_pulse() -> None:
    """A half sine on an oscillator, and a mass linked to the ground as one: Duhamel's closed form."""
    m, w, amplitude, hertz_ = 2.0, 2 * pi * 7.0, 50.0, 20.0
    p = 2 * pi * hertz_
    t = np.linspace(0, 1 / (2 * hertz_), 50)
    right = amplitude / m / (w * w - p * p) * (np.sin(p * t) - p / w * np.sin(w * t))
    chain = Chain([w], [0.0], {"m": [1 / sqrt(m)]}, pulses=[Pulse("m", amplitude, hertz_)])
    assert np.abs(run(chain, 0.1).moved("m", t) - right).max() < CLOSE * np.abs(right).max()
    chain = Chain(bodies={"m": m}, springs=[Spring("m", None, m * w * w)], pulses=[Pulse("m", amplitude, hertz_)])
    assert np.abs(run(chain, 0.1).moved("m", t) - right).max() < CLOSE * np.abs(right).max()


def test_one_way_dashpots() -> None:
    """Free decay: half a period with each constant, exp(-pi z / sqrt(1 - z^2)) each."""
    m, k, z = 1.0, 1e4, (0.05, 0.3)
    c = [2 * one * sqrt(k * m) for one in z]
    chain = Chain(bodies={"m": m}, springs=[Spring("m", None, k, c[0], c[1])], start={"m": -1.0})
    path = run(chain, 1.0)
    halves = [pi / (sqrt(k / m) * sqrt(1 - one * one)) for one in z]
    # going down (closing) to the turn, then up (opening) to the next: extrema lie where the speed is 0
    turn = acos(z[0]) / (sqrt(k / m) * sqrt(1 - z[0] ** 2))
    low, high = path.moved("m", np.array([turn, turn + halves[1]]))
    # rtol 1e-11 over the periods until the turn
    assert path.speed("m", np.array([turn]))[0] == pytest.approx(0.0, abs=1e-9)
    assert -high / low == pytest.approx(exp(-pi * z[1] / sqrt(1 - z[1] ** 2)), rel=CLOSE)


def test_a_preload_and_a_weight() -> None:
    """Lifted gently off its preload, a body on a spring of the law moves as if bilateral; one that falls bounces."""
    m, k = 0.5, 1e5
    chain = Chain(bodies={"a": m}, touches=[Touch("c", "a", None, linear(k), preload=50.0)], start={"a": 0.1})
    path = run(chain, 0.05)
    t = np.linspace(0, 0.05, 20)
    right = 0.1 / sqrt(k / m) * np.sin(sqrt(k / m) * t)  # 22 N at most: never open
    # rounding and rtol 1e-11 of a motion of tenths of a millimetre
    assert np.abs(path.moved("a", t) - right).max() < 1e-12
    g, v = 9.80665, 1.0
    falls = Chain(bodies={"a": m}, touches=[Touch("c", "a", None, linear(1e7))], weights={"a": -m * g}, start={"a": -v})
    path = run(falls, 0.3)
    intervals = path.touching("c")
    assert intervals[1][0] - intervals[0][1] == pytest.approx(2 * v / g, rel=CLOSE)
