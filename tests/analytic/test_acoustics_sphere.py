"""A pushed sphere against closed forms: free air in time and frequency, energy of a step, and before a rigid plane."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss
from scipy.special import zeta

from acoustics.air import Air
from acoustics.errors import AcousticsError
from acoustics.fields.half_space import HalfSpace
from acoustics.open_air import sphere
from acoustics.open_air import sphere as multipoles
from acoustics.open_air.sphere import HIGHEST_KA, Sphere, sphere_pressures, sphere_transfer
from acoustics.receivers import Receiver

AIR = Air(343.0, 1.21)
SPACE = HalfSpace(AIR)
A = 0.01


def koss(t: np.ndarray, r: float, cos: float, length: float) -> np.ndarray:
    """Pressure [Pa] in free air of a sphere whose acceleration is 1 m/s^2 sin(pi t / length) for `length` [s].

    Velocity potential cos d/dr (f(t - (r - a) / c) / r); the wall asks f'' + 2 w f' + 2 w^2 f = a c^2 u, w = c / a;
    p = rho cos (f' / r^2 + f'' / (c r)). y = f' is a particular sine and what the poles -w +- j w make of its start;
    a half sine is a sine and another one from its end.
    """
    w, turn = AIR.c / A, np.pi / length
    steady = A * AIR.c**2 / (2 * w * w - turn * turn + 2j * w * turn)  # of exp(j turn t)

    def started(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        whole = steady * np.exp(1j * turn * t)
        y, slope = whole.imag, (1j * turn * whole).imag
        b = -steady.imag
        c = (-(1j * turn * steady).imag + w * b) / w  # y(0) = y'(0) = 0
        fade, own = np.exp(-w * np.maximum(t, 0)), b * np.cos(w * t) + c * np.sin(w * t)
        y = y + fade * own
        slope = slope + fade * (-w * own + w * (c * np.cos(w * t) - b * np.sin(w * t)))
        return np.where(t > 0, y, 0.0), np.where(t > 0, slope, 0.0)

    late = t - (r - A) / AIR.c
    (y, slope), (y2, slope2) = started(late), started(late - length)
    return AIR.rho * cos * ((y + y2) / r**2 + (slope + slope2) / (AIR.c * r))


@pytest.mark.parametrize(
    ("length", "sampling", "allowed"),
    [
        # its ends are kinks, whose spectrum goes on beyond ka = 24, 131 kHz: sin(x) / x about them
        (100e-6, 800e3, 1e-3),
        (1e-3, 800e3, 6e-4),
    ],
)
def test_half_sine_in_free_air(length: float, sampling: float, allowed: float) -> None:
    """Near and far, ahead, aside and behind; the plane is so far away that its echo comes after the record."""
    t = np.arange(round(4e-3 * sampling)) / sampling
    velocity = np.where(t < length, 1 - np.cos(np.pi * t / length), 2.0) * length / np.pi
    spots = [(0.012, 0.0), (0.03, 0.4), (0.3, 1.2), (0.3, 2.5), (1.0, 0.0)]
    mics = [Receiver(str(i), [r * np.sin(q), 0, 2 + r * np.cos(q)]) for i, (r, q) in enumerate(spots)]
    heard = sphere_pressures([Sphere(A, [0, 0, 2], velocity, 1 / sampling)], SPACE, mics)
    assert not heard.findings
    for (r, angle), p in zip(spots, heard.p, strict=True):
        exact = koss(t, r, np.cos(angle), length)
        assert np.abs(p - exact).max() < allowed * np.abs(exact).max(), (r, angle)
    # twice the push, and two spheres at one place: linear
    both = sphere_pressures([Sphere(A, [0, 0, 2], velocity, 1 / sampling)] * 2, SPACE, mics[:1])
    assert both.p[0] == pytest.approx(2 * heard.p[0], abs=1e-6 * np.abs(heard.p).max())  # another length


def test_step_radiates_as_much_energy_as_it_leaves_in_the_air() -> None:
    """pi rho a^3 u^2 / 3, the kinetic energy of the added mass 2/3 pi rho a^3, once more as sound.

    Far away |p| = rho c (a / r) cos u(omega) ka^2 / sqrt(ka^4 + 4); of a step u = 1 / omega. Beyond ka = 24 the
    integral of 1 / ka^2 is left.
    """
    ka = np.linspace(1e-3, HIGHEST_KA, 40001)
    r = 1e4
    space, place = HalfSpace(AIR), np.array([0.0, 0.0, 1e9])  # whose echo is nothing
    heard = np.abs(
        sphere_transfer(space, A, place, ka * AIR.c / (2 * np.pi * A), [Receiver("far", [0, 0, 1e9 + r])])[0]
    )
    exact = AIR.rho * AIR.c * A / r * ka**2 / np.sqrt(ka**4 + 4)
    # 1e-4: the echo, 1e4 m beside 2e9 m, and coordinates of 1e9 m in 16 digits
    assert heard == pytest.approx(exact, rel=1e-4)
    share = (heard * r / (AIR.rho * AIR.c * A)) ** 2 / ka**2
    total = np.trapezoid(share, ka) + 1 / HIGHEST_KA
    energy = 4 * np.pi / 3 * AIR.rho * A**3 / np.pi * total
    assert energy == pytest.approx(np.pi * AIR.rho * A**3 / 3, rel=2e-4)  # 4 / 24^5 of the tail, and the echo


def around(height: float, r: float, cos: np.ndarray) -> list[Receiver]:
    return [Receiver(str(i), [r * A * np.sqrt(1 - q * q), 0, A * (height + r * q)]) for i, q in enumerate(cos.tolist())]


@pytest.mark.parametrize("height", [1.15, 2.0, 6.0])
def test_air_moves_with_the_sphere_and_not_through_the_plane(height: float) -> None:
    """dp/dr = -j omega rho u cos on the sphere, dp/dz = 0 on the plane: with waves that go out, there is one such."""
    ka = np.array([0.05, 0.7, 2.0, 3.3, 5.0])
    f = ka * AIR.c / (2 * np.pi * A)
    place, step = np.array([0.0, 0.0, height * A]), 1e-4
    cos = np.linspace(-0.93, 0.99, 9)
    near = [sphere_transfer(SPACE, A, place, f, around(height, 1 + i * step, cos)) for i in range(5)]
    slope = (-25 * near[0] + 48 * near[1] - 36 * near[2] + 16 * near[3] - 3 * near[4]) / (12 * step * A)
    given = -2j * np.pi * f * AIR.rho * cos[:, None]
    # 4e-3: the highest multipoles left out, at the plane; they do not travel
    assert np.abs(slope - given).max(axis=0) == pytest.approx(0, abs=(4e-3 * np.abs(given).max(axis=0)).max())
    flat = [Receiver(str(i), [x * A, 0, z * A]) for i, (x, z) in enumerate([(1.5, 1e-6), (1.5, 1e-3), (1.501, 1e-6)])]
    below, above, aside = sphere_transfer(SPACE, A, place, f, flat)
    assert (np.abs(above - below) < 0.02 * np.abs(aside - below)).all()  # level, but for the square of 1e-3


def test_touching_sphere_at_low_frequencies() -> None:
    """Images of images: dipoles 1 / n^3 at the heights a / n (Lamb, Hydrodynamics), far away a quadrupole zeta(4)
    times that of a sphere and an image that do not hear each other."""
    f = np.array([2e-3 * AIR.c / (2 * np.pi * A)])
    place = np.array([0.0, 0.0, A])
    r = 100 * A
    heard = sphere_transfer(SPACE, A, place, f, [Receiver("far", [0, 0, r])])[0, 0]
    k = 2 * np.pi * f[0] / AIR.c

    def dipole(z: float) -> complex:
        return -(k**2) * AIR.rho * AIR.c * A**3 / 2 * np.exp(-1j * k * z) / z * (1 + 1 / (1j * k * z))

    pair = dipole(r - A) - dipole(r + A)
    assert abs(heard / pair) == pytest.approx(zeta(4), rel=2e-3)  # (ka)^2, (a / r)^2, splines


@pytest.mark.parametrize(("orders", "allowed"), [(10, 1.5e-2), (40, 1e-3)])  # the gap's logarithm: orders^-2
def test_added_mass_of_a_touching_sphere(orders: int, allowed: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """pi rho a^3 (2 zeta(3) - 4/3), 0.803 of the air it displaces, half of it in free air (Lamb, Hydrodynamics)."""
    for module in (multipoles, sphere):
        monkeypatch.setattr(module, "ORDERS", orders)
    f = np.array([2e-3 * AIR.c / (2 * np.pi * A)])
    cos, weights = leggauss(200)
    shell = sphere_transfer(SPACE, A, np.array([0.0, 0.0, A]), f, around(1.0, 1 + 1e-9, cos))[:, 0]
    force = 2 * np.pi * A**2 * (weights * cos) @ shell
    mass = (force / (2j * np.pi * f[0])).real
    assert mass == pytest.approx(np.pi * AIR.rho * A**3 * (2 * zeta(3) - 4 / 3), rel=allowed)


@pytest.mark.parametrize("height", [1.0, 3.0])
def test_power_given_is_power_that_arrives(height: float) -> None:
    """Re(force times velocity) / 2 of the sphere, and |p|^2 / (2 rho c) over a distant half sphere, ka to 8."""
    ka = np.array([0.2, 0.5, 1.0, 2.0, 3.0, 5.0, 8.0])
    f = ka * AIR.c / (2 * np.pi * A)
    place = np.array([0.0, 0.0, height * A])
    cos, weights = leggauss(160)
    shell = sphere_transfer(SPACE, A, place, f, around(height, 1 + 1e-9, cos))
    given = 0.5 * (2 * np.pi * A**2 * (weights * cos) @ shell).real
    r = 1e5 * A
    up = (cos + 1) / 2
    far = [Receiver(str(i), [r * np.sqrt(1 - q * q), 0, r * q]) for i, q in enumerate(up.tolist())]
    heard = np.abs(sphere_transfer(SPACE, A, place, f, far)) ** 2
    arrived = 2 * np.pi * r**2 * (weights / 2) @ heard / (2 * AIR.rho * AIR.c)
    assert given == pytest.approx(arrived, rel=2e-3)  # splines where little arrives, ka = 0.2


def test_what_cannot_be_heard_is_said() -> None:
    place = np.array([0.0, 0.0, 2 * A])
    ball = Sphere(A, place, np.ones(100), 1e-5)
    mic = [Receiver("mic", [0, 0, 1])]
    with pytest.raises(AcousticsError, match=r"inside a sphere of 0.01 m"):
        sphere_pressures([ball], SPACE, [Receiver("in", [0, 0, 0.025])])
    with pytest.raises(AcousticsError, match=r"a centre 0.005 m in front of the plane"):
        sphere_pressures([Sphere(A, [0, 0, A / 2], np.ones(100), 1e-5)], SPACE, mic)
    with pytest.raises(AcousticsError, match="different sampling"):
        sphere_pressures([ball, Sphere(A, place, np.ones(100), 2e-5)], SPACE, mic)
    with pytest.raises(AcousticsError, match="expected at least one"):
        sphere_pressures([], SPACE, mic)
    with pytest.raises(AcousticsError, match="ka = 36"):
        sphere_transfer(SPACE, A, place, np.array([200e3]), mic)
    t = np.arange(2000) / 1e6
    short = np.where(t < 12e-6, 1 - np.cos(np.pi * t / 12e-6), 2.0)
    found = {
        one.code: one.values for one in sphere_pressures([Sphere(0.1, [0, 0, 0.1], short, 1e-6)], SPACE, mic).findings
    }
    assert set(found) == {"sphere-too-large"}
    assert found["sphere-too-large"]["up_to_hz"] == pytest.approx(13.1e3, rel=1e-2)  # three digits
    coarse = [Sphere(A, [0, 0, A], short[::6], 6e-6)]
    assert [one.code for one in sphere_pressures(coarse, SPACE, mic).findings] == ["push-coarsely-sampled"]
    silent = sphere_pressures([Sphere(A, [0, 0, A], np.zeros(100), 1e-5)], SPACE, mic)
    assert not silent.findings
    assert not silent.p.any()
