"""Frames of any section against closed forms."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np
import pytest

from tests.independent.frames import Floats, Section, Skeleton, axes, section

E, G, RHO = 2e11, 8e10, 7800.0
BAR = section("rectangle", width=0.03, height=0.05)


def _cantilever(L: float = 1.2, shape: Section = BAR, **more: object) -> tuple[Skeleton, int]:
    found = Skeleton()
    root, tip = found.place(np.zeros(3)), found.place(np.array([L, 0, 0]))
    found.bar(root, tip, shape, E, G, RHO, **more)  # type: ignore[arg-type]
    found.hold(root)
    return found, tip


def _tip(found: Skeleton, tip: int, direction: int, size: float = 1.0) -> Floats:
    return found.rest(found.load({(tip, direction): size}))[6 * tip : 6 * tip + 6]


def test_a_cantilever_bends_shears_stretches_and_twists() -> None:
    found, tip = _cantilever()
    L = 1.2
    assert _tip(found, tip, 2)[2] == pytest.approx(L**3 / 3 / E / BAR.Iy + L / (G * 5 / 6 * BAR.A))
    assert _tip(found, tip, 1)[1] == pytest.approx(L**3 / 3 / E / BAR.Iz + L / (G * 5 / 6 * BAR.A))
    assert _tip(found, tip, 2)[4] == pytest.approx(-(L**2) / 2 / E / BAR.Iy)  # a load up turns the tip against y
    assert _tip(found, tip, 0)[0] == pytest.approx(L / E / BAR.A)
    assert _tip(found, tip, 3)[3] == pytest.approx(L / G / BAR.J)
    motions = found.rest(found.load({(tip, 2): 7.0}))
    assert found.stresses(motions)[0, 0].max() == pytest.approx(7 * L * 0.025 / BAR.Iy)  # M z / I
    twisted = found.stresses(found.rest(found.load({(tip, 3): 7.0})))
    assert twisted == pytest.approx(
        sqrt(3) * 7 / 0.2364 / 0.03**2 / 0.05, rel=3e-3
    )  # three digits of a table, between 1.5 and 2
    held = found.pushes(motions, found.load({(tip, 2): 7.0}))[:6]
    assert held == pytest.approx([0, 0, 7, 0, -7 * L, 0], abs=1e-6)  # rounding of a stiff bar's forces


def test_a_pinned_bar_that_shears_rings_as_timoshenko_says() -> None:
    """Of n half waves k = n pi / L: rho^2 I / (k G) w^4 - (rho A + rho I k^2 (1 + E / k G)) w^2 + E I k^4 = 0."""
    found, L, k = Skeleton(), 0.5, pi / 0.5
    ends = [found.place(np.array([x, 0, 0])) for x in (0.0, L)]
    found.bar(*ends, BAR, E, G, RHO)
    for end in ends:
        found.hold(end, (0, 1, 2, 3))
    kG = G * 5 / 6
    for I in (BAR.Iy, BAR.Iz):  # noqa: E741
        a, b, c = RHO**2 * I / kG, RHO * BAR.A + RHO * I * k**2 * (1 + E / kG), E * I * k**4
        w2 = 2 * c / (b + sqrt(b * b - 4 * a * c))
        assert abs(found.modes(6)[0] / (sqrt(w2) / 2 / pi) - 1).min() < 1e-7  # polynomials of degree seven


def test_arms_turn_the_bar_about_the_place_where_it_is_held() -> None:
    """A bar half a metre above its feet's places: a pull along it bends the arms, which are rigid."""
    up = np.array([0, 0, 0.5])
    found, tip = _cantilever(arms=(up, up))
    L = 1.2
    moved = _tip(found, tip, 0, 3.0)  # a force below the bar: N = 3, M = 1.5 about -y
    assert moved[4] == pytest.approx(-1.5 * L / E / BAR.Iy)
    assert moved[0] == pytest.approx(3 * L / E / BAR.A + 1.5 * L / E / BAR.Iy * 0.5)


def test_the_height_of_a_section_points_where_it_is_told() -> None:
    found, tip = _cantilever(up=np.array([0.0, 1, 1]))
    flat = _tip(found, tip, 2)
    y, z = (1.2**3 / 3 / E / I + 1.2 / (G * 5 / 6 * BAR.A) for I in (BAR.Iz, BAR.Iy))  # noqa: E741
    assert flat[2] == pytest.approx((y + z) / 2) and flat[1] == pytest.approx((z - y) / 2)
    assert axes(np.array([0, 0, 2.0]), None)[2].tolist() == [1, 0, 0]


def test_sections_of_tables() -> None:
    """IPE 100 without its fillets, by Steiner; a square's torsion, 0.1406 a^4; a thin tube shears with half of it."""
    ipe = section("I", width=0.055, height=0.1, web=0.0041, flange=0.0057)
    strips = 2 * (0.055 * 0.0057**3 / 12 + 0.055 * 0.0057 * 0.04715**2) + 0.0041 * 0.0886**3 / 12
    assert (ipe.Iy, ipe.A) == pytest.approx((strips, 2 * 0.055 * 0.0057 + 0.0041 * 0.0886))
    assert ipe.Iz == pytest.approx(2 * 0.0057 * 0.055**3 / 12 + 0.0886 * 0.0041**3 / 12)
    assert pytest.approx(0.14058e-4, rel=1e-4) == section("rectangle", width=0.1, height=0.1).J  # of a table
    assert section("tube", outer=1.0, thickness=1e-4).ky == pytest.approx(0.5, rel=1e-6)  # of a thin wall
    box = section("box", width=0.1, height=0.2, thickness=0.002)
    assert pytest.approx(4 * (0.098 * 0.198) ** 2 * 0.002 / (2 * (0.098 + 0.198))) == box.J


def test_a_body_on_a_spring_with_a_dashpot_and_an_equation() -> None:
    found = Skeleton()
    at = found.place(np.zeros(3))
    found.body(at, 2.0)
    found.spring(at, None, np.array([800.0, 0, 0, 0, 0, 0]), np.array([4.0, 0, 0, 0, 0, 0]))
    found.hold(at, (1, 2, 3, 4, 5))
    assert found.modes(1)[0][0] == pytest.approx(20 / 2 / pi)
    pole = found.poles(1)[0]
    assert (abs(pole), -pole.real / abs(pole)) == pytest.approx((20, 4 / 2 / sqrt(1600)))
    w = 2 * pi * 3.0
    force = found.load({(at, 0): 1.0})
    assert found.shaken(np.array([3.0]), force)[0, 0] == pytest.approx(1 / (800 + 4j * w - 2 * w * w))
    lossy = found.shaken(np.array([3.0]), force, loss=0.1, ratio=0.05)[0, 0]
    assert lossy == pytest.approx(1 / (800 * 1.1j - 800j + 800 * (1 + 0j) + (4 + 2 * 0.05 * 40) * 1j * w - 2 * w * w))


def test_an_offset_body_swings_about_its_place() -> None:
    """Steiner's theorem, and a product of inertia that ties two turns together."""
    found = Skeleton()
    at = found.place(np.zeros(3))
    found.body(at, 3.0, np.diag([0.1, 0.2, 0.3]), np.array([0.4, 0, 0]))
    found.spring(at, None, np.array([0, 0, 0, 0, 50.0, 0]))
    found.hold(at, (0, 1, 2, 3, 5))
    assert found.modes(1)[0][0] == pytest.approx(sqrt(50 / (0.2 + 3 * 0.16)) / 2 / pi)
