"""Measured reductions below a tapping machine: on heavy floors band by band, refused on light ones; and its blows with
the standard's scatter."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import femstruct as fs
from femstruct.errors import FemstructError, InputErrors
from femstruct.impact.scene import blow_scatter
from femstruct.study.results import StudyResult
from femstruct.workflow.bases import with_positions

BANDS = (100, 125, 160, 200, 250, 315, 400, 500, 630, 800, 1000, 1250, 1600, 2000, 2500, 3150)
MODEL = """
materials:
  concrete: {E: 30 GPa, nu: 0.2, rho: 2400}
  board: {E: 3 GPa, nu: 0.3, rho: 700}
parts: {slab: {type: plate, material: concrete, thickness: 140 mm, origin: [0, 0, 2.5], size: [4.2, 3.1], mesh: 300 mm}}
supports: {walls: {on: slab, edge: all, fix: simple}}
points: {feet: {on: slab, side: above, at: [[1.3, 1.0], [1.4, 1.0], [1.5, 1.0], [1.6, 1.0], [1.7, 1.0]]}}
surfaces: {ceiling: {on: slab, side: below}}
damping: {loss_factor: 5 %}
"""
STUDY = """
model: m.yaml
modes: {up_to: 190 Hz}
bodies:
  hammer: {source: tapping machine, above: feet, contact: {type: linear, stiffness: 1 MN/m}}
time: {duration: 1.7 s, sampling: 8 kHz}
rooms:
  bedroom: {size: [4.2, 3.1, 2.5], under: ceiling, losses: {t60: 0.5 s}, receivers: {mic: [1.0, 0.8, 1.2]}, levels: [ISO 717-2]}
"""  # noqa: E501


def written(folder: Path, more: str = "", edits: dict[str, str] | None = None) -> Path:
    text = STUDY
    for old, new in (edits or {}).items():
        assert old in text
        text = text.replace(old, new)
    (folder / "m.yaml").write_text(MODEL, encoding="utf-8")
    rows = "".join(f"{band};{0.5 * number:.1f}\n".replace(".", ",") for number, band in enumerate(BANDS))
    (folder / "dl.csv").write_text(f"f [Hz];ΔL [dB]\n{rows}", encoding="utf-16")
    path = folder / "t.study.yaml"
    path.write_text(text + more, encoding="utf-8")
    return path


def ran(path: Path, sets: tuple[str, ...] = ()) -> StudyResult:
    plan = fs.read_study(path, sets)
    with with_positions(plan):
        return fs.run_study(plan)


CASES = """
cases:
  bare: {}
  covered: {add: {bodies.hammer.covering: {reduction: {file: dl.csv}}}}
compare: {baseline: bare}
"""


def test_a_reduction_is_taken_off_band_by_band_on_a_heavy_floor(tmp_path: Path) -> None:
    result = ran(written(tmp_path, CASES))
    bare, covered = (result.cases[name] for name in ("bare", "covered"))
    before, after = (one.rated["bedroom"] for one in (bare, covered))
    for number, band in enumerate(BANDS):  # of modes up to 190 Hz, of statistical energies above
        assert before.bands_db[band] - after.bands_db[band] == pytest.approx(0.5 * number, abs=1e-6)  # kept transfers
    if before.ensemble is not None and after.ensemble is not None:
        less = before.ensemble.members_db - after.ensemble.members_db
        known = np.isfinite(less)
        assert less[known] == pytest.approx((0.5 * np.arange(16) + 0 * less)[known], abs=1e-6)  # kept transfers
    (found,) = (one for one in covered.findings if one.code == "covering-in-ratings")
    # 8 sqrt(B m) of 140 mm of concrete is 3.83e5 N s/m: at 3150 Hz, 10 lg(1 + (w m / Z)^2) = 3 mdB
    assert found.values["taken_db"] < 0.1
    heard, alone = (one.levels["bedroom.mic"].l_afmax_db for one in (covered, bare))
    assert heard == pytest.approx(alone, abs=1e-6)  # of the bare floor; a kept transfer and a new one


LIGHT = ("parts.slab.material=board", "parts.slab.thickness=22 mm")


def test_a_reduction_of_a_heavy_floor_is_refused_on_a_light_one(tmp_path: Path) -> None:
    covered = {"1 MN/m}}": "1 MN/m}, covering: {reduction: {file: dl.csv}}}"}
    with pytest.raises(FemstructError) as caught:
        ran(written(tmp_path, edits=covered), LIGHT)
    told = str(caught.value)
    assert re.search(
        r"t\.study\.yaml:5:\d+: bodies\.hammer\.covering: got a reduction measured on a heavy floor, on a", told
    )
    found = re.search(
        r"mobility is (\S+) m/\(N s\), that of a hammer (\S+), and the force of the hammers is (\S+) dB", told
    )
    assert found is not None
    # the last rated band, 3162 Hz: 1 / (w m), and 1 / 8 sqrt(B m) of the board within what a few modes differ by
    assert float(found[2]) == pytest.approx(1 / (2 * np.pi * 3162.3 * 0.5), rel=0.01)
    impedance = 8 * np.sqrt(3e9 * 0.022**3 / 12 / 0.91 * 700 * 0.022)
    assert float(found[1]) == pytest.approx(1 / impedance, rel=0.5)
    assert float(found[3]) > 5.0


def test_a_reduction_of_a_light_floor_is_for_light_ones(tmp_path: Path) -> None:
    light = {"1 MN/m}}": "1 MN/m}, covering: {reduction: {file: dl.csv}, measured_on: light}}"}
    path = written(tmp_path, edits=light)
    codes = [one.code for one in ran(path, LIGHT).cases["as given"].findings]
    assert "covering-in-ratings" in codes
    with pytest.raises(
        FemstructError, match=r"measured on a light floor, on a heavy one: .*leave out 'measured_on: light'"
    ):
        ran(path)


def test_a_covering_that_lacks_a_rated_band_is_refused_in_scripts_too(tmp_path: Path) -> None:
    plan = fs.read_study(written(tmp_path, edits={"1 MN/m}}": "1 MN/m}, covering: {reduction: {file: dl.csv}}}"}))
    (case,) = plan.cases
    less = fs.Covering({100.0: 1.0})
    bodies = tuple(replace(body, covering=less) for body in case.study.bodies)
    short = replace(plan, cases=(replace(case, study=replace(case.study, bodies=bodies)),))
    with pytest.raises(FemstructError, match=r"covering: got a covering without a reduction at 125 Hz"):
        fs.run_study(short)


WRONG = {
    "a ball": (
        {
            "source: tapping machine, above: feet, contact: {type: linear, stiffness: 1 MN/m}": "source: rubber ball, "
            "above: feet.1, covering: {reduction: {100 Hz: 1 dB}}"
        },
        r"bodies\.hammer\.covering: got a measured reduction below a body that is no tapping machine",
    ),
    "bands missing": (
        {"1 MN/m}}": "1 MN/m}, covering: {reduction: {100 Hz: 1 dB}}}"},
        r"rooms\.bedroom\.levels: got a covering without a reduction at 125 Hz",
    ),
    "one number": (
        {"1 MN/m}}": "1 MN/m}, covering: {reduction: 20 dB}}"},
        r"bodies\.hammer\.covering\.reduction: got '20 dB', expected a reduction for each band",
    ),
    "no rating": (
        {"1 MN/m}}": "1 MN/m}, covering: {reduction: {file: dl.csv}}}", ", levels: [ISO 717-2]": ""},
        r"bodies\.hammer\.covering: got a covering, and no room whose levels are rated",
    ),
    "another unit": (
        {"1 MN/m}}": "1 MN/m}, covering: {reduction: {100 Hz: 1 mm}}}"},
        r"bodies\.hammer\.covering\.reduction: got '1 mm', which is a length, expected a level",
    ),
    "a sign": (
        {"1 MN/m}}": "1 MN/m}, covering: {reduction: {100 Hz: -30 dB}}}"},
        r"bodies\.hammer\.covering\.reduction: got '-30 dB', expected a reduction of at least -20 dB; what a covering",
    ),
    "several places misspelt": (
        {
            "source: tapping machine, above: feet, contact: {type: linear, stiffness: 1 MN/m}": "source: rubber ball, "
            "above: feett"
        },
        r"bodies\.hammer\.above: got 'feett', expected the name of a point.*; did you mean 'feet'\?",
    ),
    "a seed without scatter": (
        {"1 MN/m}}": "1 MN/m}, blows: {count: 3, timing: regular, seed: 2}}"},
        r"bodies\.hammer\.blows\.seed: got a seed of blows that are not scattered",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_coverings_and_blows_that_are_wrong_are_one_line(name: str, tmp_path: Path) -> None:
    edits, told = WRONG[name]
    with pytest.raises(InputErrors) as caught:
        fs.read_study(written(tmp_path, edits=edits))
    (line,) = caught.value.errors
    assert re.search(r"t\.study\.yaml:\d+:\d+: " + told, line), line


def test_scattered_blows_keep_the_tolerances_of_the_standard(tmp_path: Path) -> None:
    """ISO 10140-5 annex E: 100 +- 20 ms between two blows, 100 +- 5 ms on average; repeatable by their seed."""
    for seed in range(1, 40):
        times = (0.1 * np.arange(20) + blow_scatter(4, seed).ravel()) * 1e3
        assert np.abs(np.diff(times) - 100.0).max() <= 20.0
        assert abs(np.diff(times).mean() - 100.0) <= 5.0
    edits = {"1 MN/m}}": "1 MN/m}, blows: {count: 3, timing: scattered, seed: 7}}"}
    first, again = (fs.read_study(written(tmp_path, edits=edits)).cases[0].study for _ in range(2))
    other = fs.read_study(written(tmp_path, edits={"1 MN/m}}": edits["1 MN/m}}"].replace("7", "8")})).cases[0].study
    late = [np.array([body.blows.late for body in study.bodies if body.blows]).T for study in (first, again, other)]
    assert late[0] == pytest.approx(blow_scatter(3, 7)) and (late[0] == late[1]).all() and (late[0] != late[2]).any()
    struck = ran(written(tmp_path, edits=edits)).cases["as given"].response
    assert struck is not None
    t = np.array(sorted(blow.t for blow in struck.blows))
    assert t == pytest.approx(0.1 * np.arange(15) + blow_scatter(3, 7).ravel(), abs=1 / 8000)  # ticks of the clock


def test_scatter_takes_the_lines_out_of_the_spectrum() -> None:
    """Of the lines of even blows sinc^2(2 f J) of the power is left, J = 10 ms: expectation over seeds."""
    f, turns = np.array([10.0, 20.0, 30.0, 130.0]), 8
    left = np.zeros(4)
    for seed in range(1, 201):
        times = 0.1 * np.arange(5 * turns) + blow_scatter(turns, seed).ravel()
        left += np.abs(np.exp(2j * np.pi * np.outer(f, times)).mean(axis=1)) ** 2 / 200
    share = np.sinc(2 * f * 0.01) ** 2
    # 1/40 of power beside the lines; 200 seeds: a tenth of the rest
    assert left == pytest.approx(share + (1 - share) / 40, rel=0.15, abs=0.005)


STEPS = """
model: m.yaml
modes: {up_to: 190 Hz}
loads: {walker: {at: feet.1.z, footstep: step.csv, every: 0.5 s, count: 2}}
record: {feet.1.z: velocity}
time: {duration: 1.2 s, sampling: 2 kHz}
"""
STEP = "t [ms];F [N]\n0;0\n8,5;700\n20;900\n600;0\n"


def stepped(folder: Path, sets: tuple[str, ...] = (), step: str = STEP) -> StudyResult:
    written(folder)
    (folder / "step.csv").write_text(step, encoding="utf-8")
    (folder / "s.study.yaml").write_text(STEPS, encoding="utf-8")
    return ran(folder / "s.study.yaml", sets)


def test_recorded_footsteps_press_downwards(tmp_path: Path) -> None:
    result = stepped(tmp_path)
    (load,) = result.cases["as given"].case.study.loads
    assert load.footstep and isinstance(load.history, fs.Table) and load.history.values.min() == -900.0
    assert "footstep-on-light-floor" not in {
        one.code for one in result.cases["as given"].findings
    }  # 140 mm of concrete
    light = {one.code: one for one in stepped(tmp_path, LIGHT).cases["as given"].findings}
    found = light["footstep-on-light-floor"].values
    assert found["foot"] == pytest.approx(
        1 / (2 * np.pi * found["band_hz"] * 4.6), rel=0.02
    )  # nominal and exact centres
    assert 1.0 < found["taken_db"] < 15.0


@pytest.mark.parametrize(
    ("step", "told"),
    [
        ("t [ms];F [N]\n0;0\n8;-700\n600;0\n", r"step\.csv:1:1: got a force that is upwards on the average"),
        ("t [ms];F [kg]\n0;0\n8;70\n600;0\n", r"step\.csv:1:1: got 'F \[kg\]', expected a force"),
        ("t;F;G\n0;0;0\n8;70;0\n600;0;0\n", r"step\.csv:2:1: got 3 columns, expected two: time, value"),
    ],
)
def test_footsteps_that_are_none(tmp_path: Path, step: str, told: str) -> None:
    with pytest.raises(InputErrors, match=told):
        stepped(tmp_path, step=step)
    (tmp_path / "s.study.yaml").write_text(STEPS.replace("feet.1.z, foot", "feet.1.x, foot"), encoding="utf-8")
    with pytest.raises(InputErrors, match=r"loads\.walker\.at: got a footstep along 'feet\.1\.x', expected POINT\.z"):
        fs.read_study(tmp_path / "s.study.yaml")
