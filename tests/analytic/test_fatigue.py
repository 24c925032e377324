"""Rainflow cycles and their damage, against the example of the standard and closed forms."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import femstruct as fs
from femstruct import read_results, read_study, run_study, write_results
from femstruct.errors import InputErrors
from femstruct.files.tables.study_tables import summary
from femstruct.impact.result.fatigue import counted, counted_on_planes, rainflow_cycles

MODEL = "structure: {type: oscillator, mass: 2 kg, frequency: 40 Hz}\npoints: {m: {}}\ndamping: {ratio: 2 %}\n"
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
    assert shear.on == "here, normal to (0.71, 0.71, 0) in local axes"
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
    (tmp_path / "bar.yaml").write_text(
        """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
sections: {flat: {shape: rectangle, width: 20 mm, height: 10 mm}}
parts: {bar: {type: frame, material: steel, section: flat, lines: [[[0, 0, 0], [1, 0, 0]]], mesh: 100 mm}}
points: {foot: {on: bar, at: [0, 0, 0]}, tip: {on: bar, at: [1, 0, 0]}}
supports: {wall: {at: foot, fix: clamped}}
damping: {ratio: 0.1 %}
""",
        encoding="utf-8",
    )
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


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("of: m.z displacement", "of: m.z velocity", "a recorded channel"),
        ("range: 2 mm", "range: 2 MPa", "a length"),
        ("range: 2 mm, at: 1e5, slope: 4", "category: 71 MPa", "a length"),
        ("range: 2 mm,", "category: 71 MPa,", "a category alone"),
        ("range: 2 mm", "range: 0", "positive"),
    ],
)
def test_mistakes_have_their_line(old: str, new: str, told: str, tmp_path: Path) -> None:
    with pytest.raises(InputErrors) as refused:
        read_study(written(tmp_path, old, new))
    assert told in str(refused.value)
    assert "rings.study.yaml:6:" in str(refused.value)
