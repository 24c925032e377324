"""docs/clt_floor.md: the closed form of infinite layered floors beside others, and the study itself (`-m stress`)."""

from __future__ import annotations

import re
import runpy
from dataclasses import replace
from math import cos, log, log10, pi, radians
from pathlib import Path

import numpy as np
import pytest
from systems.layered_floor import RHO, C, Floor, Slab, driven, impact_levels, sound_reduction, weighted_reduction

ROOT = Path(__file__).parents[2]
SCRIPT = runpy.run_path(str(ROOT / "scripts" / "clt_page.py"), run_name="page")
PAGE = (ROOT / "docs" / "clt_floor.md").read_text(encoding="utf-8")
LIMP = Slab((1e-9, 1e-9), (1e9, 1e9), 1e-9, mass=500.0, loss=0.0)


def test_stiffness_and_mobility_of_clt_by_residues() -> None:
    """Five layers of 40 mm: D, S and the mobility of a point with shear, computed apart (5 and 8 digits)."""
    slab = Slab.of_layers(40, 40, 40, 40, 40, rho=450.0, G_rolling=69e6)
    assert pytest.approx((5859306.7, 1720693.3), rel=1e-7) == slab.D  # 8 digits there
    assert pytest.approx((21462546.0, 13189651.0), rel=1e-6) == slab.S  # 400 trapezoids a layer
    for f, mobility in ((50.0, 1.0870709e-05), (100.0, 1.3979016e-05)):
        found, _, _ = driven(Floor(replace(slab, loss=2e-3)), f, waves=10000)
        assert found.real == pytest.approx(mobility, rel=0.02)  # a hammer of 15 mm, 0.2 % of loss and air below


def test_a_floating_floor_by_quadrature_and_residues() -> None:
    """Energy of a heavy slab without and with a floating screed, computed apart [dB]."""
    D = 7145833.3
    bare = Floor(Slab((D, D), (1e15, 1e15), D / 2, mass=322.0, loss=0.02))
    every_way = bare.slab.stiffness(np.array([3.0]), np.linspace(0.0, pi, 7), 100.0)
    assert every_way == pytest.approx(np.full(7, every_way[0]), rel=1e-12)  # isotropic where D66 is D / 2
    with_screed = replace(bare, wool=10e6, wool_loss=0.1, boards=(100.0, 217013.89, 0.02))
    for f, reduction in ((63.0, 2.0998779), (100.0, 10.099053), (250.0, 26.609203)):
        energies = [driven(floor, f, waves=5000)[2] for floor in (bare, with_screed)]
        # the air below, which takes 1 to 3 % of what the losses take, and the size of the hammer: 0.13 dB
        assert 10 * log10(energies[0] / energies[1]) == pytest.approx(reduction, abs=0.2)


def test_a_limp_floor_radiates_and_insulates_as_its_mass() -> None:
    """Power of a point force on it, rho F^2 / (2 pi c m^2); R of a field up to an angle by the integral of tau."""
    assert driven(Floor(LIMP), 100.0)[1] == pytest.approx(RHO / (2 * pi * C * 500.0**2), rel=5e-3)  # k a = 0.03; air
    light, low = Floor(replace(LIMP, mass=100.0)), cos(radians(78.0)) ** 2
    for band, R in sound_reduction(light).items():
        lines = [(pi * band * 2 ** (n / 30) * 100.0 / (RHO * C)) ** 2 for n in (-4, -2, 0, 2, 4)]  # of the band
        tau = sum(log((1 + a2) / (1 + a2 * low)) / (a2 * (1 - low)) for a2 in lines) / len(lines)
        assert pytest.approx(-10 * log10(tau), abs=2e-3) == R, band  # 60 angles


def test_a_fill_that_waves_cross_in_an_instant_is_a_mass() -> None:
    floor = SCRIPT["AS_STATED"]
    levels = [impact_levels(one, (100.0, 500.0, 3150.0)) for one in (replace(floor, fill_speed=30000.0), floor)]
    stiff, mass = (list(one.values()) for one in levels)
    assert stiff == pytest.approx(mass, abs=0.01)  # (2 pi f h / c)^2 / 3 = 5e-4 of its mass at 3150 Hz: 5e-3 dB


def test_ratings_of_iso_717_1() -> None:
    """A curve that is the reference curve, 52 + 2 dB: sum of deviations 32 dB allows 2 dB more in 16 bands."""
    bands = dict(zip(SCRIPT["CURVE_THIRDS"], (33, 36, 39, 42, 45, 48, 51, 52, 53, 54, 55, *[56] * 5), strict=True))
    assert weighted_reduction({band: float(level) for band, level in bands.items()})[0] == 54


def test_the_page_says_what_the_closed_form_does() -> None:
    """Every rating of the table, and the closed form in brackets, as the script has them now."""
    for published, floors in SCRIPT["PUBLISHED"].values():
        assert published.split(", ")[0].removeprefix("R_w ") in PAGE
        for words, floor in floors.items():
            number, pink, traffic = weighted_reduction(sound_reduction(floor))
            assert f"| {words} | {number} ({pink:+d}; {traffic:+d}) |" in PAGE
    row = re.search(r"^\| 250 \| (.*) \|$", PAGE, re.MULTILINE)
    assert row is not None
    shown = [float(cell) for cell in re.findall(r"\((-?[\d.]+)\)", row[1])]
    found = [impact_levels(floor, [250.0])[250.0] for floor in SCRIPT["CASES"].values()]
    assert shown == pytest.approx(found, abs=0.051)  # a digit


@pytest.mark.stress  # the shipped study: some 75 s of CPU time
def test_the_page_is_of_the_study_as_it_is() -> None:
    fresh = SCRIPT["page"](SCRIPT["computed"]())
    numbers = [[float(one) for one in re.findall(r"-?\d+\.\d", text)] for text in (fresh, PAGE)]
    assert numbers[0] == pytest.approx(numbers[1], abs=0.11)  # a digit; modes of another machine
