"""Two pistons on a cavity against closed forms: air, wool held and limp, half filled, hangers."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.optimize import brentq

from acoustics.rooms.cavities import Cavity, Frame, Wool
from tests.data.cavities_by_hand import AIR, P0, RHO, driven, exact, matrices, pistons, poles

DEPTH = 0.2
TABLE = [
    (345, 10, 0.05, 85.992798),
    (345, 20, 0.1, 43.597777),
    (80, 20, 0.2, 33.509463),
    (40, 20, 0.25, 32.832434),
    (12.5, 12.5, 0.1, 75.823259),
]
WOOL = {"held": Wool(1e4, 40.0, "held", thermal_rate=2866.0), "limp": Wool(1e4, 40.0, "limp", thermal_rate=2866.0)}


def frequencies(cavity: Cavity, up_to_hz: float, masses: tuple[float, float], per_area: float = 0.0) -> np.ndarray:
    M, _, K = matrices(pistons(cavity, up_to_hz, masses), np.zeros(2))
    apart = np.array(masses) ** -0.5
    K[:2, :2] += per_area * np.outer(apart, apart)
    return np.sqrt(np.abs(eigh(K, M, eigvals_only=True))) / (2 * np.pi)


def test_mass_air_mass_with_the_mass_of_the_air() -> None:
    cavity, masses = Cavity([1, 1, DEPTH], AIR), (345.0, 20.0)

    def free(hz: float) -> float:  # dynamic stiffnesses of both pistons, no force: the determinant
        k = 2 * np.pi * hz / AIR.c
        z, w = RHO * AIR.c * w_of(hz), w_of(hz)
        own = z / np.tan(k * DEPTH)
        return float((own - w**2 * masses[0]) * (own - w**2 * masses[1]) - (z / np.sin(k * DEPTH)) ** 2)

    def w_of(hz: float) -> float:
        return 2 * np.pi * hz

    exactly = brentq(free, 25.0, 35.0, xtol=1e-10)
    assert exactly == pytest.approx(30.773134, abs=1e-6)  # digits of the reference
    none, three = (frequencies(cavity, up_to_hz, masses)[1] for up_to_hz in (100.0, 3000.0))
    assert none == pytest.approx(30.773178, abs=1e-6)  # one element: a linear profile of velocity
    assert three == pytest.approx(exactly, rel=2e-8)  # modes left out are static: (f / f_4)^4
    assert frequencies(cavity, 7000.0, masses)[2] == pytest.approx(859.22819, rel=1e-7)  # the same


@pytest.mark.parametrize(("upper", "lower", "depth", "hz"), TABLE)
def test_mass_air_mass_without_the_mass_of_the_air(upper: float, lower: float, depth: float, hz: float) -> None:
    stiff = 1.4 * P0 / depth * (1 / upper + 1 / lower)
    assert np.sqrt(stiff) / (2 * np.pi) == pytest.approx(hz, abs=1e-6)  # digits of the table
    cavity = Cavity([1, 1, depth], AIR)
    M, _, K = matrices(pistons(cavity, 100.0, (upper, lower)), np.zeros(2))
    assert np.sqrt(K.trace()) / (2 * np.pi) == pytest.approx(hz, abs=1e-6)  # the same
    assert np.trace(M) > 2.0


def test_isothermal_wool_is_the_softer_spring() -> None:
    air = pistons(Cavity([1, 1, DEPTH], AIR, WOOL["limp"]), 100.0)
    stiffness = air.compression.T @ air.compression
    assert np.sqrt(stiffness.trace()) / (2 * np.pi) == pytest.approx(26.054655, abs=1e-6)  # digits of the reference


def test_hangers_beside_the_air() -> None:
    """1.5 per m^2 of 20 kN/m between the pistons."""
    for modulus, hz in ((1.4 * P0, 31.473499), (P0, 26.814979), (0.0, 6.3401954)):
        stiff = (modulus / DEPTH + 1.5 * 20e3) * (1 / 345 + 1 / 20)
        assert np.sqrt(stiff) / (2 * np.pi) == pytest.approx(hz, abs=1e-6)  # digits of the reference
    found = frequencies(Cavity([1, 1, DEPTH], AIR), 3000.0, (345.0, 20.0), per_area=1.5 * 20e3)[1]
    # the mass of the air takes 0.18 % off
    assert found == pytest.approx(31.473499, rel=2.5e-3)
    assert found < 31.473499


@pytest.mark.parametrize(
    ("frame", "hz", "v2"),
    [
        ("held", 20.0, -1.862929e-5 - 4.631507e-5j),
        ("held", 31.5, -1.034282e-5 + 2.461561e-5j),
        ("held", 125.0, 5.761540e-8 + 1.444709e-7j),
        ("limp", 20.0, -6.893e-6 - 6.200064e-5j),
        ("limp", 31.5, -4.052e-6 + 2.467250e-5j),
        ("limp", 50.0, 4.861e-9 + 3.345785e-6j),
        ("limp", 125.0, 6.530713e-8 + 1.665177e-7j),
    ],
)
def test_pistons_with_wool_and_three_modes(frame: str, hz: float, v2: complex) -> None:
    assert exact([(DEPTH, WOOL[frame])], hz)[1] == pytest.approx(v2, rel=2e-4)  # digits of the reference
    three = pistons(Cavity([1, 1, DEPTH], AIR, WOOL[frame]), 2600.0)
    assert len(three.frequency_hz) == 3
    for ours, theirs in zip(driven(three, hz), exact([(DEPTH, WOOL[frame])], hz), strict=True):
        assert ours == pytest.approx(theirs, rel=6.5e-4)  # three modes: 6.3e-4 at 125 Hz in the reference
    eight = pistons(Cavity([1, 1, DEPTH], AIR, WOOL[frame]), 7000.0)
    assert driven(eight, hz)[1] == pytest.approx(exact([(DEPTH, WOOL[frame])], hz)[1], rel=2e-5)  # and eight: 1.4e-5


@pytest.mark.parametrize("frame", ["held", "limp"])
@pytest.mark.parametrize("rate", [0.0, 2866.0])
@pytest.mark.parametrize("hz", [10.0, 31.5, 80.0, 125.0])
def test_half_a_cavity_of_wool(frame: Frame, rate: float, hz: float) -> None:
    """Wool against the second piston; the layers share one face."""
    wool = Wool(1e4, 40.0, frame, thermal_rate=rate)
    expected = exact([(DEPTH / 2, None), (DEPTH / 2, wool)], hz)
    found = driven(pistons(Cavity([1, 1, DEPTH], AIR, wool, 0.1), 2600.0), hz)
    for ours, theirs in zip(found, expected, strict=True):
        assert ours == pytest.approx(theirs, rel=6e-4)  # one mode of each layer
    if (frame, rate, hz) == ("held", 0.0, 31.5):
        assert expected[1] == pytest.approx(-8.7881168e-5 + 3.2105158e-5j, rel=1e-6)  # digits of the reference


def test_poles_of_pistons_with_wool() -> None:
    for frame, pole in (("held", -16.29067 + 162.91769j), ("limp", -5.241438 + 156.59677j)):
        found = poles(*matrices(pistons(Cavity([1, 1, DEPTH], AIR, WOOL[frame]), 7000.0), np.zeros(2)))
        assert found[np.argmin(np.abs(found - pole))] == pytest.approx(pole, rel=1e-6)  # eight modes in the reference


def test_held_wool_is_a_dashpot_to_the_ground_and_limp_wool_is_not() -> None:
    held, limp = (
        poles(*matrices(pistons(Cavity([1, 1, DEPTH], AIR, WOOL[frame]), 900.0), np.zeros(2)))
        for frame in ("held", "limp")
    )
    assert np.abs(held.real + 1e4 * DEPTH / 365.0).min() < 0.05  # the air itself is 0.24 kg of 365
    slow = limp[(np.abs(limp) > 1e-2) & (np.abs(limp) < 100.0)]
    assert not len(slow)
