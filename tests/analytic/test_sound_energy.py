"""Sound energy, efficiency, directivity against closed forms: pistons, modes of a plate, the far field's integral."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import j1

from acoustics.air import Air
from acoustics.fields.half_space import HalfSpace
from acoustics.levels.sound_energy import REFERENCE_J, radiated_energy, truncate_energy
from acoustics.open_air.power import far_field, radiated_power, radiation_efficiency, radiation_pattern
from acoustics.open_air.rayleigh import field_pressures
from acoustics.receivers import Receiver
from acoustics.source import SurfaceVelocity

ROUNDING = 1e-11  # rounding: 1e-14 here at most

AIR = Air(343.0, 1.21)
NORMAL, ALONG = np.array([0.0, 0.0, 1.0]), np.eye(3)[:2]
pi = np.pi


def gauss(length: float, n: int) -> tuple[np.ndarray, np.ndarray]:
    x, w = np.polynomial.legendre.leggauss(n)
    return x * length / 2, w * length / 2


def plate(size: tuple[float, float], n: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Gauss points of a centred rectangle: sums of smooth functions are exact to rounding."""
    (x, wx), (y, wy) = (gauss(length, count) for length, count in zip(size, n, strict=True))
    return np.array([[a, b, 0.0] for a in x for b in y]), np.outer(wx, wy).ravel()


def mode(points: np.ndarray, size: tuple[float, float], m: int, n: int) -> np.ndarray:
    """Shape [p, 1] of a simply supported plate."""
    x, y = (points[:, i] / size[i] + 0.5 for i in (0, 1))
    return (np.sin(m * pi * x) * np.sin(n * pi * y))[:, None]


def pulse(t: np.ndarray, length: float) -> np.ndarray:
    return np.where((t > 0) & (t < length), np.sin(pi * t / length) ** 6, 0.0)


@pytest.mark.parametrize(("size", "top"), [((0.6, 0.4), 3000.0), ((5.0, 0.02), 800.0), ((0.0, 0.0), 500.0)])
def test_few_sources_radiate_as_all_points_do(size: tuple[float, float], top: float) -> None:
    """Power of any motion by `acoustics.open_air.power` against the sum over all points in every direction, turned in
    space."""
    rng = np.random.default_rng(5)
    points = (rng.random((60, 2)) - 0.5) * size
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    placed = np.column_stack([points, np.zeros(60)]) @ turn + [3.0, -2.0, 5.0]
    weights, shapes = rng.random(60), rng.normal(size=(60, 4))
    f = np.array([top, 20.0, top / 3])
    rates = rng.normal(size=(4, 3)) + 1j * rng.normal(size=(4, 3))
    k = 2 * pi * f / AIR.c
    all_points = [
        AIR.rho * AIR.c * k[i] ** 2 * (np.abs(far_field(placed, weights, shapes, k[i]) @ rates[:, i]) ** 2).sum()
        for i in range(3)
    ]
    # 1e-7: what the nodes leave out of a plane wave
    assert radiated_power(placed, weights, shapes, rates, f, AIR) == pytest.approx(all_points, rel=1e-7)


@pytest.mark.parametrize(("m", "n"), [(1, 1), (3, 1), (1, 2), (3, 2), (2, 2), (2, 4)])
def test_efficiency_of_plate_modes_at_low_frequency(m: int, n: int) -> None:
    """C. E. Wallace, J. Acoust. Soc. Am. 51 (1972) 946: the first term and the next of a series in k.

    The next one here from means over the sphere of powers of the direction: 1/15 of ex^2 ey^2, 1/35 of ex^4 ey^2, ...
    For two even numbers that makes 1/28, where 5/64 is often quoted.
    """
    a, b = size = (0.6, 0.4)
    k = np.array([0.1, 0.2]) / a * pi
    points, weights = plate(size, (24, 20))

    def order(q: int) -> float:
        return 1 - (8 if q % 2 else 24) / (q * pi) ** 2

    odd = m % 2 + n % 2
    first = {
        2: 32 * k**2 * a * b,
        1: 8 * (k * a) * (k * b) ** 3 / 3,
        0: 2 * (k * a) ** 3 * (k * b) ** 3 / 15,
    }[odd] / (m**2 * n**2 * pi**5)
    brackets = order(m) * a / b + order(n) * b / a
    wallace = first * (1 - k**2 * a * b * brackets * {2: 1 / 12, 1: 1 / 20, 0: 1 / 28}[odd])
    found = radiation_efficiency(
        points, weights, mode(points, size, m, n), np.ones((1, 2), complex), k * AIR.c / (2 * pi), AIR
    )
    off = found / wallace - 1
    assert abs(off[1]) < 3e-3  # (k a)^4 of the next term
    assert np.log2(abs(off[1] / off[0])) == pytest.approx(4.0, abs=0.1)  # nothing of second order is left


def test_small_piston_radiates_its_acceleration() -> None:
    """rho S^2 / (2 pi c) int a^2 dt."""
    t = np.arange(9600) / 48e3
    piston = SurfaceVelocity(np.zeros((1, 3)), [1e-4], [[1]], [pulse(t, 0.02)], 1 / 48e3)
    found = radiated_energy(piston, AIR)
    acceleration = np.gradient(piston.rates[0], t)
    small = AIR.rho * 1e-8 / (2 * pi * AIR.c) * (acceleration**2).sum() / 48e3
    assert found.energy_j == pytest.approx(small, rel=1e-4)  # the difference quotient
    # the difference quotient, in dB: 1.4e-4 here
    assert found.level_db == pytest.approx(10 * np.log10(small / 1e-12), abs=1e-3)
    assert not found.findings
    # and of its efficiency: over rho c S int v^2 dt
    plane = AIR.rho * AIR.c * 1e-4 * (piston.rates**2).sum() / 48e3
    assert found.efficiency == pytest.approx(small / plane, rel=1e-4)


def test_disc_of_any_size_radiates_by_its_resistance() -> None:
    """E = 2 int rho c S (1 - J1(2ka)/ka) |V|^2 df; once it is large rho c S int v^2 dt."""
    radius, fs = 1.0, 12e3
    r, share = gauss(radius, 36)
    r = r + radius / 2
    angle = 2 * pi * (np.arange(120) + 0.5) / 120
    points = np.stack([np.outer(r, np.cos(angle)), np.outer(r, np.sin(angle)), 0 * np.outer(r, angle)], axis=-1)
    points, weights = points.reshape(-1, 3), np.outer(share * r, np.full(120, 2 * pi / 120)).ravel()
    t = np.arange(2400) / fs
    for length, large in ((20e-3, False), (4e-3, True)):
        carrier = np.sin(2 * pi * t * 4 / length)
        disc = SurfaceVelocity(points, weights, np.ones((len(points), 1)), [pulse(t, length) * carrier], 1 / fs)
        f = np.fft.rfftfreq(32 * len(t), 1 / fs)[1:]
        spectrum = np.abs(np.fft.rfft(disc.rates[0], 32 * len(t))[1:] / fs) ** 2
        ka = 2 * pi * f / AIR.c * radius
        plane = 2 * AIR.rho * AIR.c * pi * radius**2 * spectrum * f[0]
        found = radiated_energy(disc, AIR)
        # the points' quadrature: 8e-7 here
        assert found.energy_j == pytest.approx((plane * (1 - j1(2 * ka) / ka)).sum(), rel=1e-6)
        if large:
            assert found.energy_j == pytest.approx(plane.sum(), rel=0.02)  # J1(2ka)/ka at ka = 18
            assert found.efficiency == pytest.approx(1.0, abs=0.02)


def test_energy_is_what_arrives_far_away() -> None:
    """p^2 / (rho c) over a half sphere and over time, of modes in different phases: not by the far-field sum."""
    size, fs, far = (0.5, 0.4), 24e3, 25.0
    points, weights = plate(size, (14, 12))
    shapes = np.hstack([mode(points, size, m, n) for m, n in ((1, 1), (2, 1), (1, 3), (2, 2))])
    t = np.arange(3000) / fs
    rates = [pulse(t - 0.002 * i, 0.02) * np.sin(2 * pi * (150 + 170 * i) * t) for i in range(4)]
    surface = SurfaceVelocity(points, weights, shapes, rates, 1 / fs)
    height, share = np.polynomial.legendre.leggauss(10)
    height, share, around = (height + 1) / 2, share / 2, 2 * pi * np.arange(20) / 20
    places = [
        [far * np.sqrt(1 - z * z) * np.cos(a), far * np.sqrt(1 - z * z) * np.sin(a), far * z]
        for z in height
        for a in around
    ]
    (heard,) = field_pressures([surface], HalfSpace(AIR), [Receiver(str(i), p) for i, p in enumerate(places)])
    exposure = (heard.p**2).sum(axis=1) / fs
    arrived = far**2 / (AIR.rho * AIR.c) * (np.repeat(share, 20) * 2 * pi / 20) @ exposure
    found = radiated_energy(surface, AIR)
    assert found.energy_j == pytest.approx(arrived, rel=2e-3)  # the size of the surface over the distance, squared
    assert not found.findings


def test_bands_add_up_and_are_weighted() -> None:
    """A burst about 200 Hz: all of it in few bands, and by A 10.9 dB less (IEC 61672-1, table 3: -10.9 at 200 Hz)."""
    fs = 8e3
    t = np.arange(8000) / fs
    burst = pulse(t, 0.8) * np.sin(2 * pi * 10 ** (-0.7) * 1000 * t)
    found = radiated_energy(SurfaceVelocity(np.zeros((1, 3)), [1e-3], [[1]], [burst], 1 / fs), AIR)
    assert sum(found.bands_j.values()) == pytest.approx(found.energy_j, rel=ROUNDING)
    assert found.bands_j[200.0] == pytest.approx(found.energy_j, rel=ROUNDING)
    assert found.bands_db[200.0] == pytest.approx(10 * np.log10(found.energy_j / REFERENCE_J), abs=ROUNDING)
    assert found.weighted_db - found.level_db == pytest.approx(-10.9, abs=0.1)  # dB, one decimal; the band's width
    assert found.loudest_hz(3) == pytest.approx([199.5], abs=1.5)  # lines 1 Hz apart
    assert next(iter(found.bands_hz)) == 10.0
    k = 2 * pi * 199.5 / AIR.c
    # the band's width: 3e-4 here
    assert found.bands_efficiency[200.0] == pytest.approx(k**2 * 1e-3 / (2 * pi), rel=0.01)


def test_a_record_that_ends_too_early_says_so() -> None:
    fs = 8e3
    t = np.arange(4000) / fs
    tone = np.sin(2 * pi * 200 * t) * np.minimum(1.0, t / 0.05) ** 3
    short = radiated_energy(SurfaceVelocity(np.zeros((1, 3)), [1e-3], [[1]], [tone], 1 / fs), AIR)
    (told,) = short.findings
    assert told.code == "sound-energy-not-decayed"
    assert told.values["last_tenth"] == pytest.approx(0.1, abs=0.02)  # of a tone; its start is faded in
    died = radiated_energy(SurfaceVelocity(np.zeros((1, 3)), [1e-3], [[1]], [tone * np.exp(-12 * t)], 1 / fs), AIR)
    assert not died.findings
    assert died.last_tenth < 1e-3


def test_points_too_far_apart_and_a_start_in_motion_say_so() -> None:
    fs = 24e3
    t = np.arange(4800) / fs
    points, weights = plate((2.0, 1.0), (6, 4))
    quick = pulse(t, 0.02) * np.sin(2 * pi * 400 * t)
    told = {
        one.code: one
        for one in radiated_energy(SurfaceVelocity(points, weights, np.ones((24, 1)), [quick], 1 / fs), AIR).findings
    }
    apart = np.sqrt(weights.max())
    assert told["sound-energy-points-coarse"].values["spacing_hz"] == pytest.approx(AIR.c / 6 / apart)
    assert told["sound-energy-points-coarse"].values["share"] > 0.9
    flung = SurfaceVelocity(points, weights, np.ones((24, 1)), [np.exp(-80 * t)], 1 / fs)
    assert "sound-energy-starts-moving" in [one.code for one in radiated_energy(flung, AIR).findings]


def test_directivity_of_a_rectangular_piston() -> None:
    """sin(x) / x along each side, x = k L sin(theta) / 2; and W from the index."""
    size, f = (0.9, 0.5), np.array([200.0, 1500.0])
    points, weights = plate(size, (30, 24))
    rates = np.ones((1, 2), complex)
    found = radiation_pattern(points, weights, np.ones((len(points), 1)), rates, f, AIR, NORMAL, ALONG)
    sine = np.sin(np.radians(found.angle_deg))
    k = 2 * pi * f / AIR.c
    exact = np.abs(np.sinc(k[:, None, None] * np.array(size)[:, None] * sine / (2 * pi)))
    shown = found.pressure / found.pressure.max(axis=(1, 2), keepdims=True)
    assert shown == pytest.approx(exact, abs=ROUNDING)
    assert found.level_db.max() == 0.0
    assert found.loudest(1) == (0, 0.0)
    axis = AIR.rho * 2 * pi * f * size[0] * size[1] / (2 * pi)  # rho omega Q / (2 pi), times the distance
    assert found.pressure[:, 0, 90] == pytest.approx(axis.tolist(), rel=ROUNDING)
    power = radiated_power(points, weights, np.ones((len(points), 1)), rates, f, AIR)
    mean = power * 2 * AIR.rho * AIR.c / (2 * pi)  # |p|^2 / (2 rho c) over 2 pi
    assert found.index_db == pytest.approx((20 * np.log10(axis) - 10 * np.log10(mean)).tolist(), abs=ROUNDING)


def test_directivity_of_a_plate_mode() -> None:
    """Wallace 1972, eq. 2: cos or sin (alpha / 2) over (alpha / m pi)^2 - 1, along each side."""
    a, b = size = (0.8, 0.5)
    points, weights = plate(size, (40, 24))
    f = np.array([900.0])
    k = 2 * pi * f[0] / AIR.c
    for m, n in ((3, 1), (2, 1), (2, 2)):
        found = radiation_pattern(
            points, weights, mode(points, size, m, n), np.ones((1, 1), complex), f, AIR, NORMAL, ALONG
        )
        sine = np.sin(np.radians(found.angle_deg))

        def side(q: int, length: float, along: np.ndarray) -> np.ndarray:
            alpha = k * length * along
            wave = np.cos(alpha / 2) if q % 2 else np.sin(alpha / 2)
            return 2 * length / (q * pi) * wave / ((alpha / (q * pi)) ** 2 - 1)

        exact = np.stack([side(m, a, sine) * side(n, b, 0 * sine), side(m, a, 0 * sine) * side(n, b, sine)])
        assert found.pressure[0] == pytest.approx(f[0] * AIR.rho * np.abs(exact), abs=1e-9)  # rounding: 1e-12 here
    assert np.isnan(found.index_db[0]) or found.index_db[0] < -200  # (2, 2): nothing in either plane


def test_energy_ends_where_the_motion_is_known() -> None:
    """Two tones, the motion known up to between them: the upper one is not counted, and its third octave is blank."""
    t = np.arange(9600) / 48e3
    burst = np.sin(np.pi * t / t[-1]) ** 2
    speed = burst * (np.sin(2 * np.pi * 200 * t) + np.sin(2 * np.pi * 800 * t))
    piston = SurfaceVelocity(np.zeros((1, 3)), [1e-2], [[1]], [speed], dt=1 / 48e3)
    whole = radiated_energy(piston, Air())
    below = truncate_energy(whole, 400.0)
    assert below.bands_j[200.0] == whole.bands_j[200.0]
    assert np.isnan([below.bands_db[800.0], below.bands_efficiency[800.0], below.bands_db[400.0]]).all()
    # both end between lines: 1e-11 here
    assert below.energy_j == pytest.approx(whole.energy_j * (1 - whole.share_above(400.0)), rel=1e-9)
    assert below.energy_j < 0.2 * whole.energy_j
    # the same: 5e-11 here
    assert below.weighted_j == pytest.approx(whole.weighted_j * (1 - whole.share_above(400.0, "A")), rel=5e-9)
