"""Statistical energies against closed forms, and their two ways to radiate against each other."""

from __future__ import annotations

from math import log, pi, sqrt

import numpy as np
import pytest

from tests.independent import contact_events as ev
from tests.independent import statistical_energies as se

E, NU, RHO, H = 30e9, 0.2, 2400.0, 0.14
D = E * H**3 / 12 / (1 - NU**2)
SLAB = se.Plate(
    RHO * H,
    D * np.array([[1, NU, 0], [NU, 1, 0], [0, 0, (1 - NU) / 2]]),
    (5 / 6 * E / 2 / (1 + NU) * H,) * 2,
    RHO * H**3 / 12,
)


def test_a_thin_plate_has_the_mobility_and_modes_of_textbooks() -> None:
    for f in (50.0, 3150.0):
        assert se.point_mobility(SLAB.thin, f) == pytest.approx(1 / 8 / sqrt(SLAB.mass * D), rel=1e-12)  # rounding
        assert se.modes_per_hz(SLAB.thin, np.array([f]), 12.0)[0] == pytest.approx(
            6 * sqrt(SLAB.mass / D), rel=1e-12
        )  # rounding


def test_a_thick_plate_has_the_wave_of_mindlin() -> None:
    """(S k^2 - m w^2)(D k^2 + S - I w^2) = S^2 k^2; at low frequency that of a thin one."""
    own, omega = se.waves(SLAB, np.array([2000.0])), 2 * pi * 2000.0
    (S, _), k = SLAB.S, own.k
    left = (S * k**2 - SLAB.mass * omega**2) * (D * k**2 + S - SLAB.rotary * omega**2)
    assert left == pytest.approx(S**2 * k**2, rel=1e-9)  # the end of Newton's steps
    assert se.point_mobility(SLAB, 1.0) == pytest.approx(
        se.point_mobility(SLAB.thin, 1.0), rel=1e-3
    )  # (k h)^2 at 1 Hz: 3e-4


def test_waves_radiate_alike_by_distance_and_by_far_field() -> None:
    for f in (63.0, 125.0, 500.0):
        own = se.waves(SLAB, np.array([f]), angles=64)
        k, sides = 2 * pi * f / 343.0, (4.0, 2.5)
        far = se.by_far_field(k, own.k[0], own.angle, own.mobility[0], sides)
        assert se.by_distance(k, float(own.k[0, 0]), sides) == pytest.approx(far, rel=1e-7)  # of both sums
    # far above the critical frequency 1 / sqrt(1 - fc / f); 5 % of a rectangle of 30 wavelengths
    assert se.efficiency(2500.0, 343.0, SLAB.thin, (4.0, 2.5)) == pytest.approx(1.026, rel=0.05)


def test_layers_of_one_material_are_one_plate() -> None:
    Q = 12 * D / H**3 * np.array([[1, NU, 0], [NU, 1, 0], [0, 0, (1 - NU) / 2]])
    layers = [(Q, E / 2 / (1 + NU), share * H) for share in (0.2, 0.5, 0.3)]
    assert se.shear_stiffness(layers, 0) == pytest.approx(SLAB.S[0], rel=1e-12)  # rounding


def test_a_hammer_on_a_rigid_floor_gives_twice_its_momentum_to_low_bands() -> None:
    t, force = se.blow(0.5, 0.886, ev.linear(1e8), 1e12)
    passed = 100.0 * 2 * (10**0.05 - 10**-0.05) * (2 * 0.5 * 0.886) ** 2
    # an order-4 filter lets through pi/8 / sin(pi/8) of the width: x^8 in the denominator
    assert se.exposure(100.0, t, force) == pytest.approx(passed * pi / 8 / np.sin(pi / 8), rel=2e-3)  # 0.2 ms at 100 Hz


def test_energies_through_one_slow_stage() -> None:
    """A plate and filters that are fast leave a room's decay before a Fast average: the closed form of two stages."""
    room = se.Room((5.0, 4.0, 2.5), 3 * log(10) / 0.5)
    floor = se.Floor(SLAB, 20.0, (5.0, 4.0), {2500.0: 5.0})
    f, falls = se.exact(2500.0), room.falls(1.0)
    first, decay = floor.sent(2500.0, room)
    start = first / decay * room.rho * room.c**2 / room.volume * room.inside(f)
    late = log(falls / 8.0) / (falls - 8.0)
    wanted = start * falls * 8.0 / (falls - 8.0) * (np.exp(-8.0 * late) - np.exp(-falls * late)) / falls
    # filter and plate come 1 ms late, of a maximum that is flat
    assert se.largest(floor, room, {2500.0: 1.0}, 3) == pytest.approx(wanted, rel=2e-3)
