"""Baffled pistons against closed forms: on the axis, impedance, directivity, power; radiation modes; time."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import j1, struve

from acoustics.air import Air
from acoustics.errors import AcousticsError
from acoustics.fields.half_space import HalfSpace
from acoustics.open_air.power import radiated_power, radiation_efficiency, radiation_impedance, radiation_modes
from acoustics.open_air.rayleigh import field_pressures, harmonic_field
from acoustics.receivers import Receiver
from acoustics.source import SurfaceVelocity, SurfaceVibration

ROUNDING = 1e-11  # rounding: 8e-14 here at most

AIR = Air(343.0, 1.21)
RADIUS = 0.1


def disc(rings: int, round_: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss points along the radius, equal steps round: sums of smooth functions are exact to rounding."""
    nodes, share = np.polynomial.legendre.leggauss(rings)
    r = RADIUS * (nodes + 1) / 2
    angle = 2 * np.pi * (np.arange(round_) + 0.5) / round_
    points = np.stack([np.outer(r, np.cos(angle)), np.outer(r, np.sin(angle)), 0 * np.outer(r, angle)], axis=-1)
    weights = np.outer(RADIUS / 2 * share * r, np.full(round_, 2 * np.pi / round_))
    return points.reshape(-1, 3), weights.ravel()


def rectangle(size: tuple[float, float], cells: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    x, y = ((np.arange(n) + 0.5) / n * length - length / 2 for n, length in zip(cells, size, strict=True))
    points = np.array([[a, b, 0.0] for a in x for b in y])
    return points, np.full(len(points), size[0] * size[1] / len(points))


def still(n: int) -> tuple[np.ndarray, np.ndarray]:
    return np.ones((n, 1)), np.ones((1, 1), dtype=complex)


def test_piston_on_its_axis():
    """|p| = 2 rho c v |sin(k (sqrt(z^2 + a^2) - z) / 2)|, and its phase; to ka = 11."""
    points, weights = disc(24, 64)
    f = np.array([100.0, 1000.0, 3000.0, 6000.0])
    heights = [0.05, 0.2, 1.0]
    shapes = np.ones((len(points), 1))
    receivers = [Receiver(str(z), [0, 0, z]) for z in heights]
    heard, _ = harmonic_field(SurfaceVibration(points, weights, shapes, np.ones((1, 4)), f), HalfSpace(AIR), receivers)
    k = 2 * np.pi * f / AIR.c
    for z, p in zip(heights, heard, strict=True):
        exact = AIR.rho * AIR.c * (np.exp(-1j * k * z) - np.exp(-1j * k * np.hypot(z, RADIUS)))
        assert np.abs(p - exact).max() < ROUNDING * np.abs(exact).max()


def test_piston_impedance_and_power():
    """rho c S (1 - J1(2ka)/ka + j H1(2ka)/ka) (Rayleigh; Struve's H1); power rho c S R1 v^2 / 2 by the far field."""
    points, weights = disc(20, 48)
    area = np.pi * RADIUS**2
    shapes, rates = still(len(points))
    for ka in (0.1, 1.0, 4.0, 10.0):
        k = ka / RADIUS
        exact = 1 - j1(2 * ka) / ka + 1j * struve(1, 2 * ka) / ka
        power = radiated_power(points, weights, shapes, rates, np.array([k * AIR.c / (2 * np.pi)]), AIR)
        assert power[0] == pytest.approx(AIR.rho * AIR.c * area * exact.real / 2, rel=ROUNDING)
        found = radiation_impedance(points, weights, shapes, k, AIR)[0, 0] / (AIR.rho * AIR.c * area)
        assert found.real == pytest.approx(exact.real, rel=2e-3)  # second order in the distance of the points
        assert found.imag == pytest.approx(exact.imag, abs=4e-3)  # first order


def test_reactance_converges_with_the_points():
    """Of a square of points to the closed form of the disc it would be: first order, 8 k^2 a / (3 pi) at low ka."""
    errors = []
    for n in (10, 20, 40):
        points, weights = rectangle((0.2, 0.2), (n, n))
        inside = np.hypot(points[:, 0], points[:, 1]) < RADIUS
        weights = np.full(inside.sum(), np.pi * RADIUS**2 / inside.sum())
        found = radiation_impedance(points[inside], weights, np.ones((inside.sum(), 1)), 0.1 / RADIUS, AIR)[0, 0]
        errors.append(abs(found.imag / (AIR.rho * AIR.c * np.pi * RADIUS**2) / (8 * 0.1 / (3 * np.pi)) - 1))
    assert errors[2] < 0.01
    assert errors[2] < errors[1] < errors[0]


def test_directivity_of_a_piston():
    """2 J1(ka sin theta) / (ka sin theta), far away."""
    points, weights = disc(20, 48)
    k, far = 5.0 / RADIUS, 3000.0
    theta = np.radians([0.0, 15.0, 30.0, 45.0, 60.0, 80.0])
    receivers = [Receiver(f"{t:.2f}", [far * np.sin(t), 0, far * np.cos(t)]) for t in theta]
    shapes, rates = still(len(points))
    moving = SurfaceVibration(points, weights, shapes, rates, [k * AIR.c / 2 / np.pi])
    heard, _ = harmonic_field(moving, HalfSpace(AIR), receivers)
    x = k * RADIUS * np.sin(theta[1:])
    assert np.abs(heard[1:, 0] / heard[0, 0]).tolist() == pytest.approx(
        np.abs(2 * j1(x) / x).tolist(), abs=1e-4
    )  # a / R


def test_efficiency_of_a_rectangular_piston():
    """To rho c S at high frequency, k^2 S / (2 pi) at low."""
    points, weights = rectangle((0.6, 0.4), (48, 32))
    shapes = np.ones((len(points), 1))
    low, high = radiation_efficiency(points, weights, shapes, np.ones((1, 2), complex), np.array([20.0, 3000.0]), AIR)
    # (k a)^2 of the next term, at 20 Hz: 2e-3 here
    assert low == pytest.approx((2 * np.pi * 20 / AIR.c) ** 2 * 0.24 / (2 * np.pi), rel=0.01)
    assert high == pytest.approx(1.0, abs=0.02)  # the edge, which falls as 1 / ka: 3e-3 here


def test_radiation_modes_share_no_power_and_give_all_of_it():
    """Power of any motion is the sum over the modes; the matrix of sin(kr)/(kr) has the same eigenvalues."""
    points, weights = rectangle((0.5, 0.3), (12, 8))
    k = 20.0
    strength, patterns = radiation_modes(points, weights, k)
    area = weights.sum()
    assert patterns.T @ (weights[:, None] * patterns) / area == pytest.approx(np.eye(len(strength)), abs=ROUNDING)
    velocity = np.random.default_rng(3).normal(size=(len(points), 2)) @ np.array([1.0, 1j])
    parts = patterns.T @ (weights * velocity) / area
    power = radiated_power(
        points, weights, np.eye(len(points)), velocity[:, None], np.array([k * AIR.c / (2 * np.pi)]), AIR
    )
    # rounding: 7e-13 here
    assert power[0] == pytest.approx(AIR.rho * AIR.c * area / 2 * (strength * np.abs(parts) ** 2).sum(), rel=1e-10)
    apart = np.linalg.norm(points[:, None] - points, axis=2)
    pairs = k**2 / (2 * np.pi) * np.sinc(k * apart / np.pi) * np.sqrt(np.outer(weights, weights))
    assert np.linalg.eigvalsh(pairs)[::-1][: len(strength)] == pytest.approx(strength, rel=ROUNDING, abs=ROUNDING)


def test_a_piston_in_time():
    """On the axis p(t) = rho c (v(t - z/c) - v(t - sqrt(z^2 + a^2)/c)), exact."""
    fs, z = 96e3, 0.3
    points, weights = disc(24, 16)

    def velocity(t):
        return np.where((t > 0) & (t < 2e-3), np.sin(np.pi * t / 2e-3) ** 8, 0.0)

    t = np.arange(960) / fs
    surface = SurfaceVelocity(points, weights, np.ones((len(points), 1)), [velocity(t)], 1 / fs)
    (heard,) = field_pressures([surface], HalfSpace(AIR), [Receiver("mic", [0, 0, z])])
    exact = AIR.rho * AIR.c * (velocity(t - z / AIR.c) - velocity(t - np.hypot(z, RADIUS) / AIR.c))
    assert np.abs(heard.p[0] - exact).max() < 1e-6 * np.abs(exact).max()  # Gauss points of the disc: 1e-8 here
    assert not heard.findings


def test_what_arrives_after_the_record_is_not_in_it():
    """Receivers 1 to 12 records away: their sound must not come round to the start."""
    fs, nt = 48e3, 480
    t = np.arange(nt) / fs
    rates = np.where(t < 5e-3, np.sin(np.pi * t / 5e-3) ** 8, 0.0)
    surface = SurfaceVelocity(np.zeros((1, 3)), [1e-4], np.ones((1, 1)), [rates], 1 / fs)
    for records in np.arange(1.05, 12.0, 0.5):
        far = Receiver("far", [0, 0, records * nt / fs * AIR.c])
        (heard,) = field_pressures([surface], HalfSpace(AIR), [Receiver("near", [0, 0, 0.5]), far])
        # spectra are cut where they are 1e-9 of the rest
        assert np.abs(heard.p[1]).max() < 1e-7 * np.abs(heard.p[0]).max(), records


def test_what_is_too_coarse_or_too_near_is_told_with_both_numbers():
    points, weights = rectangle((1.0, 1.0), (10, 10))
    shapes, rates = still(len(points))
    mic = [Receiver("mic", [0, 0, 1.0])]
    space = HalfSpace(AIR)
    for f, z, codes in (
        (500.0, 1.0, set()),
        (600.0, 1.0, {"surface-points-coarse"}),
        (500.0, 0.1, {"field-receiver-near"}),
    ):
        mic = [Receiver("mic", [0, 0, z])]
        _, told = harmonic_field(SurfaceVibration(points, weights, shapes, rates, [f]), space, mic)
        assert {one.code for one in told} == codes
    moving = SurfaceVibration(points, weights, shapes, rates, [600.0])
    _, (coarse,) = harmonic_field(moving, space, [Receiver("m", [0, 0, 1])])
    assert coarse.values == pytest.approx({"points_per_wave": 343 / 600 / 0.1, "needed": 6.0})
    assert "5.7 points a wavelength, 6 are needed" in coarse.message


def test_what_is_no_half_space_is_refused():
    points, weights = rectangle((1.0, 1.0), (2, 2))
    shapes, rates = still(4)
    f = np.array([100.0])
    with pytest.raises(AcousticsError, match=r"receiver mic: got .* 1 m behind the surface"):
        harmonic_field(
            SurfaceVibration(points, weights, shapes, rates, f), HalfSpace(AIR), [Receiver("mic", [0, 0, -1])]
        )
    with pytest.raises(AcousticsError, match="off the plane"):
        off = SurfaceVibration(points + np.array([0, 0, 0.1]), weights, shapes, rates, f)
        harmonic_field(off, HalfSpace(AIR), [Receiver("mic", [0, 0, 1])])
    with pytest.raises(AcousticsError, match="a unit vector"):
        HalfSpace(AIR, [0, 0, 2])


def test_a_surface_that_stands_still_is_silent() -> None:
    still = SurfaceVelocity([[0, 0, 0]], [1e-4], [[1]], [np.zeros(100)], dt=1e-4)
    (heard,) = field_pressures([still], HalfSpace(AIR), [Receiver("mic", [0, 0, 1])])
    assert not heard.p.any()
