"""Spectral plates with ribs and walls against closed forms, patch tests and frames."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from math import pi, sqrt

import numpy as np
import pytest

from tests.independent.frames import Floats, Skeleton
from tests.independent.frames import section as shape
from tests.independent.ritz import Section, iso, section
from tests.independent.spectral_plates import PX, PY, Bar, Built, Plate, U, V, W, between_lines

E, NU, RHO = 3e10, 0.2, 2400.0


def skew(a: float, b: float, low: float, high: float, rows: int = 2) -> Floats:
    """A rectangle cut along a line from (low, 0) to (high, b)."""
    t = np.linspace(0, 1, rows + 1)
    x = np.array([0 * t, low + (high - low) * t, a + 0 * t])
    return between_lines(np.stack([x, np.tile(b * t, (3, 1))], axis=-1))


def sides(a: float, b: float) -> dict[str, tuple[tuple[float, float], tuple[float, float]]]:
    return {"y0": ((0, 0), (a, 0)), "x1": ((a, 0), (a, b)), "y1": ((0, b), (a, b)), "x0": ((0, 0), (0, b))}


def hard(built: Built, name: str, a: float, b: float, which: str = "x0 x1 y0 y1") -> Built:
    for one in which.split():
        built.hold(name, *sides(a, b)[one], (U, V, W, PY if one[0] == "x" else PX))
    return built


def first(built: Built, place: tuple[float, float] = (0.3, 0.4), count: int = 3) -> Floats:
    return built.linear({("q", "z"): built.row("p", *place, "z")}, 12).modes(count)[0]


def mindlin(of: Section, k2: float) -> float:
    """The lower root of (S k2 - I0 w2) (D k2 + S - I2 w2) = S^2 k2, of waves sin sin [Hz]."""
    S, D, (I0, _, I2) = of.S[0, 0], of.D[0, 0], of.mass
    roots = np.roots([I0 * I2, -(I0 * (D * k2 + S) + I2 * S * k2), S * D * k2 * k2])
    return sqrt(min(roots.real)) / (2 * pi)


def test_a_thick_plate_of_skew_elements_by_navier() -> None:
    """Each order more takes three quarters of the error and more: 3e-2 of order 2 to 1e-8 of order 6."""
    of = section([iso(E, NU, 0.2, RHO)])
    right = mindlin(of, 2 * pi**2)
    off = [first(hard(Built({"p": Plate(skew(1, 1, 0.3, 0.7), of)}, p), "p", 1, 1))[0] / right - 1 for p in range(2, 8)]
    assert min(off) > -1e-10 and off[-1] < 1e-8  # from above; rounding
    assert all(finer < 0.25 * coarse for coarse, finer in pairwise(off[:-1]))


@pytest.mark.parametrize(("which", "printed"), [("clamped", 28.951), ("free", 9.631)])
def test_thin_plates_by_levy(which: str, printed: float) -> None:
    """Leissa (1973), two sides simple and two clamped or free, nu 0.3: w a^2 sqrt(m / D)."""
    of = section([iso(E, 0.3, 0.005, RHO)])
    built = hard(Built({"p": Plate(skew(1, 1, 0.4, 0.6), of)}, 8), "p", 1, 1, "x0 x1")
    for one in ("y0", "y1") if which == "clamped" else ():
        built.hold("p", *sides(1, 1)[one], (U, V, W, PX, PY))
    unit = sqrt(of.D[0, 0] / of.mass[0]) / (2 * pi)
    assert first(built, count=1)[0] / unit == pytest.approx(printed, rel=5e-4)  # shear of h / a = 1 / 200; digits


def test_a_strip_is_a_timoshenko_beam() -> None:
    of = section([iso(E, 0.0, 0.2, RHO)])
    built = hard(Built({"p": Plate(skew(2, 0.3, 0.7, 1.2, 1), of)}, 8), "p", 2, 0.3, "x0 x1")
    assert first(built, (0.5, 0.1), 1)[0] == pytest.approx(mindlin(of, (pi / 2) ** 2), rel=1e-7)  # order 8


RIB = Bar((0.5, 0.0), (0.9, 1.2), (0.01, -0.02, -0.09), -0.03, shape("rectangle", width=0.04, height=0.12),
          1.1e10, 4e9, 600.0, 0.03)  # fmt: skip


@pytest.mark.parametrize("order", [3, 6])
def test_constant_curvatures_of_a_plate_with_an_oblique_eccentric_rib(order: int) -> None:
    """Energy by hand; inside nothing pushes, for all forces in plate and rib are constant. The rib turns as it is bent:
    its stretch is that of the plate, and its curvature times its depth; its sections stay across its axis."""
    of = section([iso(E, NU, 0.06, RHO)])
    built = Built({"p": Plate(skew(1.6, 1.2, 0.5, 0.9), of)}, order).rib("p", RIB)
    k, stretch = np.array([1e-3, -4e-4, 7e-4]), 3e-5
    x, y = built.meshes["p"].nodes.T
    moved = np.zeros(built.count)
    each = moved[: 5 * len(x)].reshape(-1, 5)
    each[:, U], each[:, W] = stretch * x, -(k[0] * x**2 + k[1] * y**2 + k[2] * x * y) / 2
    each[:, PX], each[:, PY] = k[0] * x + k[2] * y / 2, k[1] * y + k[2] * x / 2
    length = np.hypot(0.4, 1.2)
    c, s = np.array([0.4, 1.2]) / length
    along, twist = k @ [c * c, s * s, c * s], (k[0] - k[1]) * c * s + k[2] * (s * s - c * c) / 2
    z, before, beside = RIB.arm[2], RIB.arm[:2] @ np.array([c, s]), RIB.arm[:2] @ np.array([-s, c])
    chain = np.unique(built.meshes["p"].on(np.array(RIB.start), np.array(RIB.end)))
    chain = chain[np.argsort(y[chain])]
    turns = moved[5 * len(x) :].reshape(-1, 2)
    turns[:, 0] = each[chain, PX] * c + each[chain, PY] * s - twist * beside + along * before
    turns[:, 1] = -stretch * c * s - twist * z
    K, r = built.matrix("K").toarray(), RIB.shape
    bar = RIB.E * (r.A * (stretch * c * c + z * along) ** 2 + r.Iy * along**2) + RIB.G * r.J * twist**2
    plate = 1.6 * 1.2 * (k @ of.D @ k + of.A[0, 0] * stretch**2)
    assert moved @ K @ moved == pytest.approx(plate + length * bar, rel=1e-9)  # rounding of sums of 1e3 terms
    force = K @ moved
    inside = np.flatnonzero((x > 1e-6) & (x < 1.6 - 1e-6) & (y > 1e-6) & (y < 1.2 - 1e-6))
    within = np.r_[(5 * inside[:, None] + np.arange(5)).ravel(), 5 * len(x) + np.arange(2, 2 * len(chain) - 2)]
    assert np.abs(force[within]).max() < 1e-9 * np.abs(force).max()  # the same


def test_a_narrow_strip_on_a_rib_is_a_composite_beam() -> None:
    """On two supports, one of which slides, under its weight: 5 q L^4 / 384 over both bendings and both areas on their
    distance."""
    length, b, h, e = 4.0, 0.05, 0.01, 0.04
    of = section([iso(E, 0.0, h, RHO)])
    strip = between_lines(np.stack(np.meshgrid(np.linspace(0, length, 5), [0, b / 2, b], indexing="ij"), axis=-1))
    side = shape("rectangle", width=0.02, height=0.07)
    rib = Bar((0, b / 2), (length, b / 2), (0, 0, -e), -h / 2, side, 1e10, 5e9, 0)
    built = Built({"p": Plate(strip, of)}, 8).rib("p", rib)
    built.hold("p", (0, 0), (0, b), (U, V, W)).hold("p", (length, 0), (length, b), (W,))
    found = built.linear({("q", "z"): built.row("p", length / 2, b / 2, "z")}, 6)
    EA, EAr = E * b * h, rib.E * rib.shape.A
    bending = E * b * h**3 / 12 + rib.E * rib.shape.Iy + EA * EAr / (EA + EAr) * e**2
    sag = -9.80665 * RHO * b * h * length**4 * 5 / 384 / bending
    at = found.rows["q", "z"] @ found.rest(found.load({}, weight=True))
    assert at == pytest.approx(sag, rel=3e-3)  # shear of rib and plate, 10 E I / k G A L^2


def test_a_wall_on_a_strip_is_a_frame() -> None:
    """Without lateral strain and as wide as the strip it bends and stretches as bars do; weight along two axes."""
    a, h, t, height, width = 1.4, 0.1, 0.08, 0.6, 0.3
    floor, wall = section([iso(E, 0.0, h, RHO)]), section([iso(E, 0.0, t, RHO)])
    grid = np.stack(np.meshgrid([0, 0.5, a], [0, width], indexing="ij"), axis=-1)
    upright = np.stack(np.meshgrid([0, width], [0, height], indexing="ij"), axis=-1)
    axes = np.array([[0, 1.0, 0], [0, 0, 1.0], [1.0, 0, 0]])
    plates = {
        "p": Plate(between_lines(grid), floor),
        "w": Plate(between_lines(upright), wall, np.array([0.5, 0, 0]), axes),
    }
    built = Built(plates, 6).stand("w", (0, 0), (width, 0), "p")
    built.hold("p", (0, 0), (0, width), (U, V, W, PX, PY)).hold("p", (a, 0), (a, width), (U, V, W, PX, PY))
    rows = {
        ("q", "z"): built.row("p", 0.9, 0.1, "z"),
        ("t", "x"): built.row("w", 0.1, height, "x"),
        ("t", "ry"): built.row("w", 0.2, height, "ry"),
    }
    found = built.linear(rows, 6)
    bones, G = Skeleton(6), E / 2
    ends = [bones.place(np.array(at)) for at in ((0, 0, 0), (0.5, 0, 0), (0.9, 0, 0), (a, 0, 0), (0.5, 0, height))]
    for start, end, thick in ((0, 1, h), (1, 2, h), (2, 3, h), (1, 4, t)):
        side = shape("rectangle", width=width, height=thick)
        bones.bar(ends[start], ends[end], side, E, G, RHO, up=np.array([1.0, 0, 0]) if end == 4 else None)
    bones.hold(ends[0])
    bones.hold(ends[3])
    M = bones.matrix("M")
    for axis in (0, 2):
        pull = np.tile(np.eye(6)[axis], len(bones.at))
        right = bones.rest(M @ pull)
        got = found.rest(found.rides[axis])
        for way, place, motion in ((("q", "z"), 2, 2), (("t", "x"), 4, 0), (("t", "ry"), 4, 4)):
            assert found.rows[way] @ got == pytest.approx(
                right[6 * ends[place] + motion], rel=1e-6, abs=1e-16
            )  # polynomials of order 4


def _ribbed_and_walled(turn: Floats) -> Built:
    of = section([iso(E, NU, 0.06, RHO)])
    low, high, b = 0.5, 0.9, 1.2
    length = float(np.hypot(high - low, b))
    along, up = np.array([high - low, b, 0]) / length, np.array([0, 0, 1.0])
    wall = np.stack(np.meshgrid([0, length / 2, length], [0, 0.5], indexing="ij"), axis=-1)
    axes = np.array([along, up, np.cross(along, up)]) @ turn.T
    middle = turn @ np.array([low, 0, 0])
    plates = {
        "p": Plate(skew(1.6, b, low, high), of, axes=turn.T),
        "w": Plate(between_lines(wall), of, middle, axes),
    }
    built = Built(plates, 6).rib("p", RIB).stand("w", (0, 0), (length, 0), "p")
    return built.hold("p", *sides(1.6, b)["x0"], (U, V, W, PX, PY))


def test_turned_in_space_it_is_the_same() -> None:
    turn = np.linalg.qr(np.array([[1.0, 2, 3], [0.3, -1, 2], [4, 0.1, 1]]))[0]
    turn *= np.linalg.det(turn)
    plain, other = (_ribbed_and_walled(one) for one in (np.eye(3), turn))
    assert first(other) == pytest.approx(first(plain), rel=1e-8)  # of the eigensolution


def test_what_few_modes_and_loads_at_rest_leave_out() -> None:
    """Response beside the first mode and sag under a force, by 12 and by 40 modes."""
    built = _ribbed_and_walled(np.eye(3))
    rows = {("q", "z"): built.row("p", 0.3, 0.4, "z"), ("d", "z"): built.row("p", 1.2, 0.7, "z")}
    answers = []
    for count in (12, 40):
        found = built.linear(rows, count)
        load = found.load({("d", "z"): 1.0})
        own = found.modes(1)[0]
        moved = [found.rest(load), np.linalg.solve(found.K - (2 * pi * 1.4 * own[0]) ** 2 * found.M, load)]
        answers.append([found.rows["q", "z"] @ one for one in moved])
    assert answers[0] == pytest.approx(answers[1], rel=2e-3)  # of a mode left out: (1.4 f1 / f12)^4 of its share


def test_losses_are_of_each_part() -> None:
    of = section([iso(E, NU, 0.06, RHO, 0.04)])
    one = Plate(skew(1.6, 1.2, 0.5, 0.9), of, lossy=section([iso(E, NU, 0.06, RHO, 0.04)], lossy=True),
                springs=(1e5, 1e5, -0.03), spring_loss=0.04)  # fmt: skip
    built = Built({"p": one}, 4).rib("p", replace(RIB, loss=0.04))
    losses = built.linear({("q", "z"): built.row("p", 0.3, 0.4, "z")}, 9).losses(8)
    assert losses == pytest.approx(0.04, rel=1e-9)  # rounding
