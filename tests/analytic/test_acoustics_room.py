"""The room against closed forms: travelling waves, exact modal equations, uniform compression, box modes."""

from __future__ import annotations

import sys
from math import comb, pi

import numpy as np
import pytest

from acoustics.air import Air
from acoustics.fields.rectangular import Room
from acoustics.levels.sound_levels import sound_levels
from acoustics.losses import Losses, losses_from_beta, losses_from_t60
from acoustics.receivers import Receiver
from acoustics.rooms.box import cosines, horizontal_wavenumber, overlaps, room_modes, transfer
from acoustics.rooms.box_harmonic import pressure_map
from acoustics.rooms.box_pressure import pressure, pressures
from acoustics.source import SurfaceVelocity

ROUNDING = 1e-12  # rounding: 9e-15 here at most

SIZE = [0.58, 0.47, 0.1]
AIR = Air(c=340, rho=1.29)
LX, LY, LZ = SIZE
LAWS = {"kelvin_voigt": losses_from_beta(0.0116, 293), "constant_decay": losses_from_t60(0.4)}


def ceiling(room, shape, velocity, dt, n=(40, 36)):
    """A ceiling with one shape, its points at the centres of a grid (exact for cosines below the grid's order)."""
    lx, ly, lz = room.size
    x, y = ((np.arange(k) + 0.5) / k * length for k, length in zip(n, (lx, ly), strict=True))
    grid = np.stack([*(axis.ravel() for axis in np.meshgrid(x, y, indexing="ij")), np.full(n[0] * n[1], lz)], axis=1)
    weights = np.full(len(grid), lx * ly / len(grid))
    return SurfaceVelocity(grid, weights, shape(grid[:, 0], grid[:, 1])[:, None], velocity[None, :], dt)


def piston(x, y):
    return np.ones_like(x)


def off_centre_bump(x, y):
    return np.exp(-((x - 0.2) ** 2 + (y - 0.3) ** 2) / 0.01)


class Burst:
    """v = Re exp(lambda t) (1 - exp(-alpha t))^5, a sum of exponentials that starts as t^5 and has not decayed."""

    def __init__(self, alpha=900.0, lam=-4 + 2j * pi * 120):
        j = np.arange(6)
        self.amplitude = np.array([comb(5, i) * (-1.0) ** i for i in j])
        self.exponent = lam - alpha * j

    def rate(self, t, order=0):
        return ((self.amplitude * self.exponent**order) @ np.exp(np.outer(self.exponent, t))).real

    def oscillator(self, t, forcing, omega, c1, numerator):
        """x'' + c1 x' + omega^2 x = numerator(d/dt) v from rest, exactly; forcing: exp(lambda t) [6, nt]."""
        lam = self.exponent
        particular = self.amplitude * numerator(lam) / (lam**2 + c1 * lam + omega**2)
        forced = particular @ forcing
        root = np.sqrt(complex((c1 / 2) ** 2 - omega**2))
        r1, r2 = -c1 / 2 + root, -c1 / 2 - root
        # complex start values so that the real part of the sum starts from rest as well
        x0, v0 = -particular.sum(), -(particular * lam).sum()
        b = (v0 - r1 * x0) / (r2 - r1)
        return (forced + (x0 - b) * np.exp(r1 * t) + b * np.exp(r2 * t)).real


def exact_modal(room, burst, coefficients, orders, place, t, n_z=24):
    """Pressure by the exact modal equations of the room and the static share of the modes left out."""
    rho, c, losses = room.air.rho, room.air.c, room.losses
    tau, gamma = losses.relaxation_time, losses.decay_rate
    x, y, z = place
    p, forcing = np.zeros_like(t), np.exp(np.outer(burst.exponent, t))
    rate, acceleration = burst.rate(t), burst.rate(t, 1)
    for (i, m), a in zip(orders, coefficients, strict=True):
        here = a * np.cos(i * pi * x / LX) * np.cos(m * pi * y / LY)
        k2 = (i * pi / LX) ** 2 + (m * pi / LY) ** 2

        def numerator(lam):
            # wall acceleration, with the resistance of the air (decay) or through its viscosity (Kelvin-Voigt)
            return c**2 * rho * (1 + tau * lam) * (lam + 2 * gamma)

        static = z**2 / (2 * LZ) - LZ / 6 if k2 == 0 else np.cosh(k2**0.5 * z) / (k2**0.5 * np.sinh(k2**0.5 * LZ))
        total = static * rho * (acceleration + 2 * gamma * rate)
        for n in range(n_z):
            omega2 = c**2 * (k2 + (n * pi / LZ) ** 2)
            shape = (1 if n == 0 else 2) * (-1) ** n / LZ * np.cos(n * pi * z / LZ)
            if omega2 == 0:
                # rigid piston on the air: rho c^2 (1 + tau d/dt) x / Lz
                amplitude = burst.amplitude / burst.exponent
                displacement = (amplitude @ (forcing - 1)).real
                total += shape * c**2 * rho * (displacement + tau * rate)
                continue
            modal = burst.oscillator(t, forcing, omega2**0.5, tau * omega2 + 2 * gamma, numerator)
            quasi = c**2 * rho / omega2 * (acceleration + 2 * gamma * rate)
            total += shape * (modal - quasi)
        p += here * total
    return p


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("z", [0.05, 0.083])
def test_pressure_follows_the_exact_modal_equations(law, z):
    room = Room(SIZE, AIR, LAWS[law])
    burst, t = Burst(), np.arange(9600) / 48e3
    orders = [(i, m) for i in range(4) for m in range(4)]
    surface = ceiling(room, off_centre_bump, burst.rate(t), 1 / 48e3)
    shape = surface.shapes[:, 0]
    x, y = surface.points[:, 0], surface.points[:, 1]
    coefficients = []
    for i, m in orders:
        cosine = np.cos(i * pi * x / LX) * np.cos(m * pi * y / LY)
        coefficients.append((shape @ cosine) / (cosine @ cosine))  # least squares: no factor 1 or 2 to get wrong
    place = [0.1, 0.37, z]
    truth = exact_modal(room, burst, coefficients, orders, place, t)
    heard = pressure(surface, room, [Receiver("mic", place)], orders=4).p[0]
    error = np.abs(heard - truth) / np.abs(truth).max()
    # some 1e-7 from the sampling of a source of some 500 Hz; 1e-6 at the very last sample, from its continuation
    assert error.max() < 3e-6
    assert error[:-480].max() < 1e-6  # 4e-7 here
    assert np.ptp(truth[-2400:]) > 0.05 * np.ptp(truth)  # the record has not decayed: the hard case


def test_piston_follows_the_travelling_waves():
    """Without losses p = rho c sum_m v(t - (2 m Lz + Lz -+ z)/c), the ceiling's echoes."""
    room = Room(SIZE, AIR)
    burst, t, z = Burst(), np.arange(9600) / 48e3, 0.03
    truth = np.zeros_like(t)
    for m in range(int(t[-1] * AIR.c / (2 * LZ)) + 1):
        for path in (2 * m * LZ + LZ - z, 2 * m * LZ + LZ + z):
            late = t - path / AIR.c
            truth += AIR.rho * AIR.c * np.where(late > 0, burst.rate(np.maximum(late, 0)), 0)
    heard = pressure(ceiling(room, piston, burst.rate(t), 1 / 48e3), room, [Receiver("m", [0.1, 0.1, z])]).p[0]
    assert np.abs(heard - truth).max() < 1e-6 * np.abs(truth).max()  # the sampling of the source: 1e-7 here


def test_uniform_compression_at_the_height_where_the_next_term_vanishes():
    """cos(kz)/(k sin kL) = (1/(k^2 L)) (1 + k^2 (L^2/6 - z^2/2) + O(k^4)): at z = L/sqrt(3) uniform to (kL)^4 / 45."""
    s = np.array([2j * pi * 19.9])
    height = np.array([LZ / 3**0.5, 0.0, LZ])
    found = np.array([h[0, 0] for h in transfer(Room(SIZE, AIR), s, np.zeros(1), height)])
    uniform = AIR.bulk_modulus / (s[0] * LZ)
    assert abs(found[0] / uniform - 1) < 1e-7  # (kL)^4 / 45 = 4e-8 at most
    assert 1e-4 < abs(found[1] / uniform - 1) < 3e-4  # (kL)^2 / 6 = 2e-4
    assert 4e-4 < abs(found[2] / uniform - 1) < 6e-4  # -(kL)^2 / 3 = 4e-4 and the next term


@pytest.mark.parametrize("law", [*LAWS, "source"])
def test_a_surface_moving_into_the_room_raises_the_pressure_by_its_displaced_volume(law):
    losses = LAWS.get(law, Losses("source", beta=0.0116))
    room = Room(SIZE, AIR, losses)
    t = np.arange(24000) / 48e3
    velocity = np.where(t < 0.1, 1e-3 * (1 - np.cos(2 * pi * t / 0.1)), 0)
    surface = ceiling(room, off_centre_bump, velocity, 1 / 48e3)
    heard = pressure(surface, room, [Receiver("mic", [0.3, 0.2, 0.02])], orders=6).p[0]
    displaced = surface.weights @ surface.shapes @ surface.rates.sum(axis=1) * surface.dt
    static = AIR.bulk_modulus * displaced / room.volume
    assert static > 0
    # the room has fallen silent but for the pressure of the compressed air; the constant damping ratio changes its
    # stiffness by beta^2 and leaks 2 beta / pi of the padding's return into it
    assert heard[16000:20000].mean() == pytest.approx(static, rel=2e-2 if law == "source" else 1e-5)


def test_box_modes():
    frequency_hz, indices = room_modes(Room(SIZE, AIR), 1701)
    chosen = {tuple(i): f for i, f in zip(indices.tolist(), frequency_hz, strict=True)}
    wanted = {(1, 0, 0): 293, (0, 1, 0): 362, (1, 1, 0): 466, (0, 0, 1): 1700}
    for index, f in wanted.items():
        assert chosen[index] == pytest.approx(f, rel=3e-3)  # the source's digits
    assert frequency_hz[0] == chosen[1, 0, 0]
    assert (np.diff(frequency_hz) >= 0).all()


def test_transfer_peaks_at_the_box_modes():
    """The zeros of mu sin(mu Lz), found by scanning the transfer, are the room's modes."""
    room = Room(SIZE, AIR, losses_from_beta(1e-4, 293))
    f = np.arange(250.0, 500.0, 0.05)
    for order, wanted in (((1, 0), 293.1), ((0, 1), 361.7), ((1, 1), 465.6)):
        k_lm = horizontal_wavenumber(room, np.array([order]))
        gain = np.abs(transfer(room, 2j * pi * f, k_lm, np.array([0.05]))[0][0])
        assert f[gain.argmax()] == pytest.approx(wanted, abs=0.1)  # the scan's step


def test_evanescent_waves_do_not_overflow():
    """A high room and a fine cosine: |Im mu| Lz = 1885, where cosh is infinite; the wave is exp(-k (Lz - z)) / k."""
    room = Room([1.0, 1.0, 6.0], AIR)
    s, k_lm = np.array([1 + 2j * pi * 50]), np.array([100 * pi])
    near, far = (h[0, 0] for h in transfer(room, s, k_lm, np.array([5.99, 0.0])))
    mu = np.sqrt(k_lm[0] ** 2 + (s[0] / AIR.c) ** 2)
    assert near == pytest.approx(AIR.rho * s[0] * np.exp(-mu * 0.01) / mu, rel=ROUNDING)
    assert far == 0


@pytest.mark.parametrize(
    ("height", "levels"),
    [
        (2.5, [1.0, 1.2, 1.5]),  # tenths of a metre: powers of one exponential
        (2.5, [1.5, 1.0, 1.2]),
        (2.5, [1.013, 1.2, 1.57]),  # an exponential for every gap
        (12.0, [0.0, 0.1, 11.99, 12.0]),
        (0.1, [0.05]),
    ],
)
def test_the_transfer_is_that_of_its_formula(height: float, levels: list[float]) -> None:
    """Against the formula of `transfer` with an exponential for each term: rounding, of arguments up to 60 x 12."""
    room = Room([5.0, 4.0, height], AIR, LAWS["constant_decay"])
    s, k_lm = 100 + 2j * pi * np.linspace(1.0, 5000.0, 400), np.linspace(0.0, 60.0, 50)
    mu = np.sqrt(k_lm[:, None] ** 2 + (s**2 + 2 * room.losses.decay_rate * s) / AIR.c**2)  # of exp(-mu x), Re mu > 0
    front = AIR.rho * (s + 2 * room.losses.decay_rate) / (mu * (1 - np.exp(-2 * mu * height)))
    for found, z in zip(transfer(room, s, k_lm, np.array(levels)), levels, strict=True):
        wanted = front * (np.exp(-mu * (height - z)) + np.exp(-mu * (height + z)))
        np.testing.assert_allclose(found, wanted, rtol=1e-11, atol=1e-300)  # but for denormal numbers


def test_what_is_of_no_interest_is_left_out_and_the_rest_is_right() -> None:
    """A blow with content to some 3 kHz, of which bands up to 500 Hz are wanted; their flanks see -60 dB."""
    room = Room([2.0, 1.5, 1.0], AIR, LAWS["constant_decay"])
    t = np.arange(6000) / 12e3
    blow = np.exp(-(((t - 0.02) / 2e-4) ** 2)) * np.sin(2 * pi * 300 * t)
    moving = ceiling(room, off_centre_bump, blow, 1 / 12e3)
    here = [Receiver("mid", [0.3, 0.4, 0.5]), Receiver("low", [1.7, 1.2, 0.2])]
    whole, cut = pressures([moving], room, here)[0], pressures([moving], room, here, up_to_hz=500.0)[0]
    lines = whole.frequency_hz
    wanted, beyond = (lines > 20) & (lines < 500), lines > 1600
    size = np.abs(whole.spectrum[:, wanted]).max()
    # the search for cosines stops at 1e-4 of what is heard, of another sound in the two
    assert np.abs(whole.spectrum - cut.spectrum)[:, wanted].max() < 1e-3 * size
    # what the fade leaves: 3e-6 here
    assert np.abs(cut.spectrum[:, beyond]).max() < 1e-4 * np.abs(whole.spectrum[:, beyond]).max()
    bands = [sound_levels(one.p[0], one.dt).bands_db for one in (whole, cut)]
    for band in (63.0, 125.0, 250.0, 400.0):
        assert bands[1][band] == pytest.approx(bands[0][band], abs=5e-4)  # flanks of the bands see -60 dB: 5e-6 dB here


@pytest.mark.parametrize("kind", ["none", "source"])
def test_waves_that_have_decayed_on_the_way_are_left_out(kind, monkeypatch):
    """Over a high room cosines that evanesce are evaluated only from the frequency on at which they arrive: against all
    of them at all frequencies."""
    room = Room([0.58, 0.47, 2.0], AIR, LAWS["constant_decay"] if kind == "none" else losses_from_beta(0.01, 300, kind))
    blow = np.exp(-(((np.arange(1200) / 12e3 - 0.02) / 2e-4) ** 2))
    moving = ceiling(room, off_centre_bump, np.gradient(blow), 1 / 12e3)
    here = [Receiver("mid", [0.1, 0.2, 0.9]), Receiver("low", [0.1, 0.2, 0.2])]
    transfers = []

    def counted(room, s, k_lm, z):
        transfers.append(len(s) * len(k_lm))
        return transfer(room, s, k_lm, z)

    stage = sys.modules["acoustics.rooms.box_pressure"]
    monkeypatch.setattr(stage, "transfer", counted)
    monkeypatch.setattr(stage, "_TILE", 64)
    found = pressure(moving, room, here, orders=24).p
    fewer = sum(transfers)
    transfers.clear()
    monkeypatch.setattr(stage, "LEAST_EVANESCENT", 1e-300)
    whole = pressure(moving, room, here, orders=24).p
    assert fewer < 0.8 * sum(transfers)
    # 1e-9 of each cosine is left out; the window on the record raises that by exp(13.5 / 2) on average
    np.testing.assert_allclose(found, whole, rtol=0, atol=1e-6 * np.abs(whole).max())


def test_sums_over_a_grid_of_points_are_those_over_its_points():
    """Crossings of lines, in any order, are summed line by line; with one missing, point by point."""
    random = np.random.default_rng(3)
    room = Room(SIZE, AIR)
    x, y = np.meshgrid(random.uniform(0, LX, 9), random.uniform(0, LY, 6), indexing="ij")
    points = random.permutation(np.column_stack([x.ravel(), y.ravel()]))
    orders = np.array([(0, 0), (3, 1), (1, 7), (1, 2), (5, 0), (2, 2), (8, 3)])
    weighted = random.normal(size=(len(points), 4))
    for some in (slice(None), slice(1, None)):
        for picked in (orders, orders[:, ::-1]):  # more rows than columns, and the other way round
            plain = cosines(room, picked, points[some]).T @ weighted[some]
            # rounding: 2e-15 here
            np.testing.assert_allclose(overlaps(room, picked, points[some], weighted[some]), plain, rtol=0, atol=1e-13)


@pytest.mark.parametrize("order", [(0, 0), (1, 0), (0, 2), (2, 1)])
def test_a_cosine_ceiling_has_that_amplitude_whatever_its_order(order):
    """No 6 dB for an index of zero: v = cos cos drives its own cosine with amplitude 1, and nothing else."""
    room = Room(SIZE, AIR, LAWS["kelvin_voigt"])
    i, m = order
    velocity = Burst().rate(np.arange(4800) / 48e3)
    surface = ceiling(room, lambda x, y: np.cos(i * pi * x / LX) * np.cos(m * pi * y / LY), velocity, 1 / 48e3)
    field = pressure_map(surface, room, [100.0], at=0.05, divisions=(4, 4), orders=5)
    k_lm = horizontal_wavenumber(room, np.array([order]))
    gain = transfer(room, np.array([2j * pi * 100.0]), k_lm, np.array([0.05]))[0][0, 0]
    corner = gain * (velocity @ np.exp(-2j * pi * 100 * np.arange(4800) / 48e3)) / 48e3
    expected = corner * np.outer(np.cos(i * pi * field.first / LX), np.cos(m * pi * field.second / LY))
    np.testing.assert_allclose(field.spectrum[0], expected, rtol=0, atol=ROUNDING * abs(corner))


PULSE_AT, SIGMA = 0.15, 1.2e-4


def pulse(t):
    """Velocity of a surface that goes out and back: no net displacement; shorter than the first mode's 3.4 ms."""
    u = (t - PULSE_AT) / SIGMA
    return -u * np.exp(-(u**2) / 2)


def shares(p, t, first=7, last=3):
    """Energy before the pulse begins and after it has passed, as shares of the whole."""
    energy = p**2 / (p @ p)
    return energy[t < PULSE_AT - first * SIGMA].sum(), energy[t > PULSE_AT + last * SIGMA].sum()


SPOT = Receiver("spot", [0.45, 0.1, 0.02])
TIMES = np.arange(28800) / 96e3


def heard_under(losses):
    surface = ceiling(Room(SIZE, AIR, losses), off_centre_bump, pulse(TIMES), 1 / 96e3)
    return pressure(surface, Room(SIZE, AIR, losses), [SPOT], orders=8), surface


@pytest.mark.parametrize("law", LAWS)
def test_the_pressure_comes_after_its_cause(law):
    before, after = shares(heard_under(LAWS[law])[0].p[0], TIMES)
    assert before <= ROUNDING
    assert after >= 0.99


def test_the_sign_of_the_source_answers_before_its_cause():
    """k = omega (1 + j beta) / c turns the transfer H into -conj(H): the same energy, mirrored in time."""
    heard, surface = heard_under(Losses("source", beta=0.0116))
    n = 2 * len(TIMES)
    v, p = np.fft.rfft(surface.rates[0], n), np.fft.rfft(heard.p[0], n)
    transfer_ = np.divide(p, v, out=np.zeros_like(v), where=np.abs(v) > 1e-7 * np.abs(v).max())
    before, after = shares(np.fft.irfft(-np.conj(transfer_) * v, n)[: len(TIMES)], TIMES, first=3, last=7)
    assert before >= 0.99
    assert after <= 1e-4  # what the constant ratio leaks; the causal laws leave 1e-18


def test_the_corrected_form_of_the_source_is_nearly_causal_and_says_so():
    heard = heard_under(Losses("source", beta=0.0116))[0]
    before, after = shares(heard.p[0], TIMES)
    assert 1e-9 < before <= 1e-3  # not strictly causal: more than the rounding that causal laws leave
    assert after >= 0.99
    assert "non-causal-losses" in [finding.code for finding in heard.findings]
