"""Rainflow cycles and their damage, against the example of the standard and closed forms."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import rainflow

import femstruct as fs
from femstruct.errors import InputErrors
from femstruct.files.results_file import read_results, write_results
from femstruct.files.study_tables import summary
from femstruct.impact.fatigue import (
    counted,
    counted_on_planes,
    expected,
    most_damaged,
    normals_of,
    plane_weights,
    rainflow_cycles,
)
from femstruct.impact.fatigue import most_damaged_by_spectra as most_damaged_of_spectra
from femstruct.language.cases import read_study
from femstruct.workflow.bases import solve_all
from femstruct.workflow.run import run_study
from tests.independent.vibration import dirlik

MODEL = "structure: {type: oscillator, mass: 2 kg, frequency: 40 Hz}\npoints: {m: {}}\ndamping: {ratio: 2 %}\n"
BAR = """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
sections: {flat: {shape: rectangle, width: 20 mm, height: 10 mm}}
parts:
  bar: {type: frame, material: steel, section: flat, lines: [[[0, 0, 0], [1, 0, 0]]], mesh: 100 mm}
  lump: {type: mass, mass: 20 kg, at: tip}   # a velocity of a point of a bar alone would depend on the modes
points: {foot: {on: bar, at: [0, 0, 0]}, tip: {on: bar, at: [1, 0, 0]}}
supports: {wall: {at: foot, fix: clamped}}
damping: {ratio: 0.1 %}
"""
STUDY = """
model: model.yaml
initial: {velocity: {m.z: 1 m/s}}
record: {m.z: displacement}
fatigue:
  spring: {of: m.z displacement, sn: {range: 2 mm, at: 1e5, slope: 4}}
time: {duration: 0.25 s, sampling: 20 kHz}
"""


def written(folder: Path, old: str = "", new: str = "") -> Path:
    (folder / "model.yaml").write_text(MODEL, encoding="utf-8")
    path = folder / "rings.study.yaml"
    path.write_text(STUDY.replace(old, new) if old else STUDY, encoding="utf-8")
    return path


def test_the_example_of_the_standard() -> None:
    """ASTM E1049-85, figure 6 (-2, 1, -3, 5, -1, 3, -4, 4, -2): 0.5, 1.5, 0.5, 1, 0.5 ranges of 3, 4, 6, 8, 9;
    the points between the reversals, and those that stay where they are, change nothing."""
    turns = np.array([-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0])
    whole = np.interp(np.arange(0.0, 8.01, 0.25), np.arange(9.0), turns).repeat(2)
    for history in (turns, whole):
        found = rainflow_cycles(history)
        known = {size: float(found.counts[found.ranges == size].sum()) for size in np.unique(found.ranges)}
        assert known == {3.0: 0.5, 4.0: 1.5, 6.0: 0.5, 8.0: 1.0, 9.0: 0.5}
    assert rainflow_cycles(np.zeros(5)).counts.sum() == 0.0


def test_a_sine_of_many_periods_is_as_many_cycles() -> None:
    t = np.arange(20001) / 20000.0
    line = fs.SNLine(100e6, at=2e6, slope=3.0)
    found = counted("weld", "Pa", 40e6 * np.sin(2 * np.pi * 50.0 * t), line)
    assert found.cycles == pytest.approx(50.0, abs=0.51)  # the first and the last quarter of a period are half cycles
    assert found.largest == pytest.approx(80e6, rel=1e-9)  # rounding
    assert found.counts[-1] == pytest.approx(49.5, abs=0.01)  # all but the ends
    ends = 2 * 0.5 * 0.5**3 - 0.5
    assert found.damage == pytest.approx((50.0 + ends) * (80.0 / 100.0) ** 3 / 2e6, rel=1e-9)  # rounding
    assert found.life == pytest.approx(1.0 / found.damage, rel=1e-12)  # rounding


def test_a_detail_category_is_that_of_the_standard() -> None:
    """EN 1993-1-9, figure 7.1: the knee at 5e6 cycles is 0.737 of the category, the cut-off at 1e8 is 0.549 of that."""
    line = fs.SNLine(71e6, category=True)
    knee, low = 0.737 * 71e6, 0.549 * 0.737 * 71e6
    np.testing.assert_allclose(
        line.endured(np.array([142e6, knee, 1.001 * low, 0.998 * low])), [2e6 / 8, 5e6, 1e8, np.inf], rtol=8e-3
    )  # three digits to the fifth power


def test_the_worst_plane() -> None:
    """Pure shear is normal stress on the planes at 45 degrees; tension along any direction on that normal to it."""
    t = np.sin(np.linspace(0.0, 20.0, 4001))
    shear = counted_on_planes("p", np.array([0 * t, 0 * t, 10e6 * t]), ("xx", "yy", "xy"), None, "here")
    assert shear.largest == pytest.approx(20e6, rel=1e-6)  # samples beside the peak
    assert shear.on == "here, normal to (0.71, 0.71, 0)"
    rng = np.random.default_rng(3)
    names = ("xx", "yy", "zz", "xy", "yz", "zx")
    for _ in range(5):
        n = rng.normal(size=3)
        n /= np.linalg.norm(n)
        state = np.array([n["xyz".index(a)] * n["xyz".index(b)] for a, b in names])
        pulled = counted_on_planes("s", 10e6 * state[:, None] * t, names, fs.SNLine(71e6), "here")
        assert 20e6 * (1.0 - 0.015) <= pulled.largest <= 20e6 * (1 + 1e-12)  # rounding


def test_what_dies_away_is_half_cycles(tmp_path: Path) -> None:
    """Peaks of an oscillator that was set in motion fall by exp(-pi zeta / sqrt(1 - zeta^2)): every way from one to the
    next is half a cycle."""
    result = run_study(read_study(written(tmp_path)))
    case = result.cases["as given"]
    found = case.fatigue["spring"]
    zeta, w = 0.02, 2 * np.pi * 40.0
    fall = np.pi * zeta / np.sqrt(1 - zeta**2)
    damped = w * np.sqrt(1 - zeta**2)
    t1 = np.arctan(np.sqrt(1 - zeta**2) / zeta) / damped
    first = np.exp(-zeta * w * t1) * np.sin(damped * t1) / damped
    count = int(np.floor((0.25 - t1) * damped / np.pi)) + 1
    peaks = first * np.exp(-fall * np.arange(count))
    ranges = np.concatenate([[first], peaks[:-1] + peaks[1:]])
    last = 1e-3  # the way from the last peak to the end of the record, and samples beside the peaks
    assert found.largest == pytest.approx(peaks[0] + peaks[1], rel=last)
    assert found.damage == pytest.approx((0.5 * (ranges / 2e-3) ** 4).sum() / 1e5, rel=last)
    assert found.cycles == pytest.approx(0.5 * (len(ranges) + 1), abs=0.01)  # and that to the end
    table = json.loads(json.dumps(summary(result)))["cases"]["as given"]["fatigue"]["spring"]
    assert table["records_to_failure"] == pytest.approx(1.0 / found.damage, rel=1e-12)  # the digits of JSON
    write_results(tmp_path / "results.h5", result)
    kept = read_results(tmp_path / "results.h5").cases["as given"].fatigue["spring"]
    np.testing.assert_array_equal(kept.counts, found.counts)


def test_samples_that_miss_the_peaks_are_a_finding(tmp_path: Path) -> None:
    case = run_study(read_study(written(tmp_path, "sampling: 20 kHz", "sampling: 190 Hz"))).cases["as given"]
    assert [one.code for one in case.findings if one.code.startswith("fatigue")] == ["fatigue-coarsely-sampled"]


def test_the_stress_of_a_part_is_counted_where_it_is_largest(tmp_path: Path) -> None:
    """A cantilever that swings in its first mode is stressed at the wall by M / W, with the sign of its bending: twice
    as wide a range as the equivalent stress, which has none."""
    (tmp_path / "bar.yaml").write_text(BAR, encoding="utf-8")
    path = tmp_path / "bar.study.yaml"
    path.write_text(
        """
model: bar.yaml
modes: {count: 1}
initial: {velocity: {tip.z: 1 m/s}}
record: {bar: stress}
fatigue: {wall: {of: bar stress, sn: {category: 71 MPa}}}
time: {duration: 1 s, sampling: 20 kHz}
""",
        encoding="utf-8",
    )
    case = run_study(read_study(path)).cases["as given"]
    found, stress = case.fatigue["wall"], case.channels["bar stress"]
    within = 8e-3  # it falls by pi zeta in half a period; shear beside the bending
    assert found.largest == pytest.approx(2.0 * stress.whole, rel=within)
    assert found.on.startswith("(0, ") and "normal to (1, 0, 0)" in found.on


LINES = [fs.SNLine(71e6, category=True), fs.SNLine(90e6, 2e6, 5.0), fs.SNLine(90e6, 2e6, 0.7), None]


def damage_of(history: np.ndarray, line: fs.SNLine | None) -> float:
    """By the package `rainflow` and Miner's sum, written out; without a line the largest range."""
    cycles = [(size, count) for size, _, count, _, _ in rainflow.extract_cycles(history)]
    if line is None:
        return float(max(size for size, _ in cycles))
    return float(sum(count / line.endured(np.array([size]))[0] for size, count in cycles))


@pytest.mark.parametrize("line", LINES)
@pytest.mark.parametrize("components", [("xx",), ("xx", "yy", "xy")])
def test_the_most_damaged_place_is_that_of_all_places_counted_one_by_one(
    line: fs.SNLine | None, components: tuple[str, ...]
) -> None:
    """Stresses of random places in four modes that die away, after a blow that is large once somewhere else."""
    rng = np.random.default_rng(37)
    t = np.arange(200) / 200.0
    q = np.array([np.exp(-2.0 * t) * np.sin(2.0 * np.pi * f * t) for f in (3.0, 11.0, 23.0, 41.0)])
    q = np.vstack([q, np.exp(-(((t - 0.1) / 0.01) ** 2))])
    for _ in range(2):
        rows = 60e6 * rng.normal(size=(12, len(components), 5)) * (rng.random((12, 1, 5)) < 0.5)
        weights = plane_weights(normals_of(components), components)
        all_of_them = [max(damage_of(one, line) for one in weights @ (place @ q)) for place in rows]
        found = most_damaged(rows, q, components, line)
        assert all_of_them[found] == pytest.approx(max(all_of_them), rel=1e-9)  # the same sums in other orders


def test_damage_of_a_stress_is_that_of_its_most_damaged_place(tmp_path: Path) -> None:
    """A hinged beam: a slow push bends its middle most, once; a quarter rings longer in the second mode."""
    (tmp_path / "beam.yaml").write_text(
        "materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}\n"
        "sections: {bar: {shape: rectangle, width: 40 mm, height: 20 mm}}\n"
        "parts: {bar: {type: frame, material: steel, section: bar, mesh: 250 mm, lines: [[[0, 0, 0], [1, 0, 0]]]}}\n"
        "points: {a: {on: bar, at: [0, 0, 0]}, b: {on: bar, at: [1, 0, 0]}, m: {on: bar, at: [0.5, 0, 0]}, "
        "q: {on: bar, at: [0.25, 0, 0]}}\n"
        "supports: {l: {at: a, fix: [x, y, z, rx]}, r: {at: b, fix: [x, y, z, rx]}}\ndamping: {ratio: 1 %}\n",
        encoding="utf-8",
    )
    path = tmp_path / "beam.study.yaml"
    path.write_text(
        "model: beam.yaml\nmodes: {up_to: 1 kHz}\nrecord: {bar: stress}\n"
        "loads:\n  slow: {at: m.z, half_sine: {amplitude: 1500 N, frequency: 5 Hz}}\n"
        "  ring: {at: q.z, half_sine: {amplitude: 2.5 kN, frequency: 187 Hz}, first: 0.12 s}\n"
        "fatigue: {f: {of: bar stress, sn: {range: 90 MPa, at: 2e6, slope: 3}}}\n"
        "time: {duration: 0.3 s, sampling: 5 kHz}\n",
        encoding="utf-8",
    )
    study = read_study(path)
    case = run_study(study).cases["as given"]
    assert case.response is not None and case.channels["bar stress"].stressed is not None
    places = solve_all(study.cases)["as given"].places.stresses("bar", "")
    rows, q = places.of(case.response.basis.shapes), case.response.q
    line = fs.SNLine(90e6, 2e6, 3.0)
    weights = plane_weights(normals_of(places.components), places.components)
    assert case.fatigue["f"].damage is not None
    by_place = [max(damage_of(one, line) for one in weights @ (place @ q)) for place in rows]
    assert case.fatigue["f"].damage == pytest.approx(max(by_place), rel=1e-9)  # the same sums in another order
    assert by_place[case.channels["bar stress"].stressed.worst] < 0.9 * max(by_place)  # the case is what it says


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("of: m.z displacement", "of: m.z velocity", "a recorded channel"),
        ("range: 2 mm", "range: 2 MPa", "a length"),
        ("range: 2 mm, at: 1e5, slope: 4", "category: 71 MPa", "a length"),
        ("range: 2 mm,", "category: 71 MPa,", "a category alone"),
        ("range: 2 mm", "range: 0", "positive"),
        ("slope: 4", "slope: -3", "got -3, expected a positive value; write 3"),
        (", slope: 4", "", "got a range without its slope, expected 'slope' beside 'range'; add 'slope: 3'"),
    ],
)
def test_mistakes_have_their_line(old: str, new: str, told: str, tmp_path: Path) -> None:
    with pytest.raises(InputErrors) as refused:
        read_study(written(tmp_path, old, new))
    assert told in str(refused.value)
    assert "rings.study.yaml:6:" in str(refused.value)


def noise(f: np.ndarray, psd: np.ndarray, duration: float, rate: float = 1000.0) -> np.ndarray:
    """A history of sines of random phase with a power spectral density."""
    count = round(duration * rate)
    lines = np.fft.rfftfreq(count, 1.0 / rate)
    level = np.interp(lines, f, psd, left=0.0, right=0.0)
    phases = np.exp(2j * np.pi * np.random.default_rng(5).uniform(size=len(lines)))
    return np.fft.irfft(np.sqrt(level / (2.0 * duration)) * phases) * count


@pytest.mark.parametrize(("humps", "errs"), [("one", (0.02, 0.02)), ("flat", (0.08, 0.1)), ("two", (0.09, 0.2))])
def test_random_cycles_are_those_that_are_counted_in_time(humps: str, errs: tuple[float, float]) -> None:
    """Dirlik's density against rainflow cycles of 2000 s of noise, slopes of 3 and 5: 0 and 0 % off for one hump, -6
    and -8 % for a flat spectrum, -6 and -14 % for two humps. Whatever the density, the mean range follows from the path
    of the history: 2 sqrt(pi / 2) times the standard deviation and the irregularity."""
    f = np.linspace(1.0, 60.0, 1201)
    two = np.exp(-(((f - 8.0) / 2.0) ** 2)) + 0.6 * np.exp(-(((f - 40.0) / 4.0) ** 2))
    psd = {"one": np.exp(-(((f - 30.0) / 6.0) ** 2)), "flat": np.ones_like(f), "two": two}[humps]
    history = noise(f, psd, 2000.0)
    cycles = rainflow_cycles(history)
    assert history.std() == pytest.approx(np.sqrt(np.trapezoid(psd, f)), rel=1e-3)  # of the interpolation
    for slope, err in zip((3.0, 5.0), errs, strict=True):
        line = fs.SNLine(20.0, slope=slope)
        found = expected("a", "N", psd, f, 2000.0, line)
        assert found.damage == pytest.approx(cycles.damage(line), rel=err)
    assert found.cycles == pytest.approx(cycles.counts.sum(), rel=5e-3)  # of one record
    assert found.largest == pytest.approx(cycles.ranges.max(), rel=0.1)  # of one record
    path = np.sqrt(np.pi / 2) * np.trapezoid(f**2 * psd, f) / np.sqrt(np.trapezoid(f**4 * psd, f))
    linear = expected("a", "N", psd, f, 2000.0, fs.SNLine(1.0, at=1.0, slope=1.0))
    assert linear.damage / linear.cycles == pytest.approx(2.0 * path, rel=3e-3)  # Dirlik has 1.25 for sqrt(pi / 2)


def test_small_ripples_on_a_slow_motion_are_cycles() -> None:
    """As many as there are peaks, sqrt(m4 / m2) a second (S. O. Rice), however small they are beside what they ride on:
    of 1 and 0.07 N rms at 5 and 70 Hz two thirds of them were not in the classes."""
    f = np.linspace(1.0, 80.0, 15801)
    psd = np.where(np.abs(f - 5.0) < 0.2, 2.5, 0.0) + np.where(np.abs(f - 70.0) < 0.5, 0.00435, 0.0)
    m2, m4 = (float((f**n * psd).sum()) for n in (2, 4))
    found = expected("a", "N", psd, f, 1000.0, None)
    assert found.cycles == pytest.approx(1000.0 * np.sqrt(m4 / m2), rel=1e-6)  # edges of the bands
    assert (found.counts >= 0.0).all()


RANDOM = """
model: bar.yaml
modes: {up_to: 800 Hz}
record: {bar: stress, wall: force, tip.z: displacement}
vibration: {shaker: {base: z, psd: 0.1 g^2/Hz, band: [2 Hz, 200 Hz], duration: 3600 s}}
fatigue:
  root: {of: bar stress, under: shaker, sn: {category: 71 MPa}}
  bolts: {of: wall force, under: shaker, sn: {range: 100 N, slope: 5}}
"""


def test_a_random_excitation_in_a_study(tmp_path: Path) -> None:
    (tmp_path / "bar.yaml").write_text(BAR, encoding="utf-8")
    path = tmp_path / "bar.study.yaml"
    path.write_text(RANDOM, encoding="utf-8")
    case = run_study(read_study(path)).cases["as given"]
    one, bolts, root = case.vibration["shaker"], case.fatigue["bolts"], case.fatigue["root"]
    force = one.answers["wall force"]
    by_hand = expected("f", "N", force.psd, force.frequency_hz, 3600.0, fs.SNLine(100.0, slope=5.0))
    assert bolts.damage == pytest.approx(by_hand.damage, rel=1e-12)  # rounding
    stress = one.answers["bar stress"]
    line = fs.SNLine(71e6, category=True)
    axial = expected("s", "Pa", stress.psd, stress.frequency_hz, 3600.0, line)  # bending: the shear beside it is small
    assert root.damage == pytest.approx(axial.damage, rel=0.02)  # of that shear, to the fifth power
    assert "normal to (1, 0, 0)" in root.on
    assert [one.code for one in case.findings].count("random-damage-estimated") == 2
    path.write_text(RANDOM.replace("under: shaker, sn: {range", "under: shaken, sn: {range"), encoding="utf-8")
    with pytest.raises(InputErrors, match=r"fatigue.bolts.under: got 'shaken'"):
        read_study(path)


SHAKEN = """
model: beam.yaml
modes: {up_to: 400 Hz}
record: {bar: stress}
vibration:
  shaker:
    at: q.z
    psd: [[20 Hz, 1 N^2/Hz], [100 Hz, 1 N^2/Hz], [101 Hz, 0.3 N^2/Hz], [300 Hz, 0.3 N^2/Hz]]
    duration: 60 min
fatigue: {f: {of: bar stress, under: shaker, sn: {range: 9 MPa, at: 2e6, slope: 3}}}
"""
PINNED = """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
sections: {bar: {shape: rectangle, width: 40 mm, height: 20 mm}}
parts: {bar: {type: frame, material: steel, section: bar, mesh: 50 mm, lines: [[[0, 0, 0], [1, 0, 0]]]}}
points: {a: {on: bar, at: [0, 0, 0]}, b: {on: bar, at: [1, 0, 0]}, q: {on: bar, at: [0.25, 0, 0]}}
supports: {l: {at: a, fix: [x, y, z, rx]}, r: {at: b, fix: [x, y, z, rx]}}
damping: {ratio: 2 %}
"""


def shaken_beam(lines: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Places 50 mm apart and the psd of the bending stress there [place, line]: sines, a force at the quarter."""
    mu, bending, x = 7850.0 * 0.04 * 0.02, 210e9 * 0.04 * 0.02**3 / 12.0, np.arange(21) / 20.0
    n = np.arange(1, 3)[:, None]
    own = (n * np.pi) ** 2 * np.sqrt(bending / mu)
    w = 2.0 * np.pi * lines
    q = 2.0 / mu * np.sin(n * np.pi / 4.0) / (own**2 - w**2 + 0.04j * own * w)
    stress = 210e9 * 0.01 * ((n * np.pi) ** 2 * np.sin(n * np.pi * x)).T @ q
    return x, np.abs(stress) ** 2 * np.where(lines < 100.5, 1.0, 0.3)


def test_random_damage_is_that_of_the_most_damaged_place(tmp_path: Path) -> None:
    """The middle of a hinged beam has the largest rms, of the first mode; beside it are more cycles, of the second."""
    (tmp_path / "beam.yaml").write_text(PINNED, encoding="utf-8")
    (tmp_path / "beam.study.yaml").write_text(SHAKEN, encoding="utf-8")
    case = run_study(read_study(tmp_path / "beam.study.yaml")).cases["as given"]
    lines = np.linspace(20.0, 300.0, 28001)
    x, psd = shaken_beam(lines)
    moments = np.array([np.trapezoid(lines**n * psd, lines) for n in (0, 1, 2, 4)])
    damage = [dirlik(one, 3.0, 9e6, 2e6, 3600.0) if one[0] > 0.0 else 0.0 for one in moments.T]
    rms, worst = int(moments[0].argmax()), int(np.argmax(damage))
    assert x[rms] == 0.5 and damage[rms] < 0.9 * damage[worst]  # the case is what it says
    found, where = case.fatigue["f"], case.vibration["shaker"].answers["bar stress"].where
    assert where.startswith("(0.5, ")
    assert found.on.startswith(f"({x[worst]:.4g}, ")
    # shear and rotary inertia of the bar move the second mode by 0.5 %, to the third power; the corner of the psd
    assert found.damage == pytest.approx(damage[worst], rel=0.03)


@pytest.mark.parametrize("line", [*LINES[:2], None])
def test_the_most_damaged_place_of_random_stresses_is_that_of_all_places(line: fs.SNLine | None) -> None:
    """Every place and plane of a face by itself, of modes in six bands."""
    rng, f = np.random.default_rng(7), np.linspace(1.0, 200.0, 2001)
    centres = np.array([8.0, 20.0, 45.0, 70.0, 110.0, 160.0])
    modes = np.exp(-(((f - centres[:, None]) / 2.0) ** 2))
    rows = 40e6 * rng.normal(size=(15, 3, 6)) * (rng.random((15, 1, 6)) < 0.5)
    psd = np.einsum("pck,kf,pdk->pcdf", rows, modes / 4.0, rows)
    moments = np.array([np.trapezoid(f**n * psd, f, axis=-1) for n in (0, 1, 2, 4)])
    weights = plane_weights(normals_of(("xx", "yy", "xy")), ("xx", "yy", "xy"))
    sizes = []
    for place in psd:
        planes = [np.einsum("c,cdf,d->f", w, place, w).clip(0.0) for w in weights]
        each = [expected("", "Pa", one, f, 3600.0, line) for one in planes]
        sizes.append(max(one.largest if one.damage is None else one.damage for one in each))
    found = most_damaged_of_spectra(moments, ("xx", "yy", "xy"), 3600.0, line)
    assert sizes[found] == pytest.approx(max(sizes), rel=1e-6)  # sums in another order
