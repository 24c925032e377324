"""Bodies that strike several times and loads that come again, from YAML to tables, files and the terminal."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import h5py
import numpy as np
import pytest

from femstruct.errors import InputErrors
from femstruct.files.study_tables import summary
from femstruct.language.cases import read_study
from femstruct.study.results import StudyResult
from femstruct.view.case_tables import blows
from femstruct.view.histories import energy
from femstruct.view.model_scene import shapes_all
from femstruct.view.structure_tables import show_modes
from femstruct.view.terminal import show_study
from femstruct.view.undrawn import no_shapes
from femstruct.workflow.modes import extent_of, modes_of
from femstruct.workflow.run import run_study, write_all

MODELS = Path(__file__).parents[2] / "models"
MODEL = """structure:
  type: modes
  frequency: [18, 45, 140]
  ratio: [4 %, 4 %, 4 %]
  points: {p1: [0.1, 0.2, 0.1], p2: [0.2, 0.1, -0.1], p3: [0.3, -0.1, 0.1]}
"""
STUDY = """model: model.yaml
modes: {count: 3}
bodies:
  one:   {mass: 0.5 kg, above: p1, drop_height: 4 cm, contact: {type: hertz, stiffness: 2e7},
          blows: {count: 2, every: 0.3 s}}
  two:   {mass: 0.5 kg, above: p2, drop_height: 4 cm, contact: {type: hertz, stiffness: 2e7},
          blows: {count: 2, every: 0.3 s, first: 0.1 s}}
  three: {mass: 0.5 kg, above: p3, drop_height: 4 cm, contact: {type: hertz, stiffness: 2e7},
          blows: {count: 2, every: 0.3 s, first: 0.2 s}}
loads:
  step: {at: p3.z, half_sine: {amplitude: -30 N, frequency: 10 Hz}, first: 0.05 s, every: 0.2 s, count: 3}
record: {p1.z: velocity, one: travel}
time: {duration: 0.62 s, sampling: 20 kHz, gravity: true}
"""


def write(folder: Path, study: str = STUDY) -> Path:
    (folder / "model.yaml").write_text(MODEL, encoding="utf-8")
    (folder / "taps.study.yaml").write_text(study, encoding="utf-8")
    return folder / "taps.study.yaml"


@pytest.fixture(scope="module")
def taps(tmp_path_factory: pytest.TempPathFactory) -> StudyResult:
    return run_study(read_study(write(tmp_path_factory.mktemp("taps"))))


@pytest.fixture(scope="module")
def strokes() -> StudyResult:
    return run_study(read_study(MODELS / "press_strokes.study.yaml"))


def test_hammers_take_turns(taps: StudyResult) -> None:
    response = taps.cases["as given"].response
    assert response is not None
    assert [blow.body for blow in response.blows] == ["one", "two", "three"] * 2
    # steps and rounding: 6e-17 here
    assert [blow.t for blow in response.blows] == pytest.approx(0.1 * np.arange(6), abs=1e-14)
    assert response.ledger.residual < 1e-9  # steps and rounding: 2e-12 here
    speed = np.sqrt(2 * 9.80665 * 0.04)
    # steps and rounding: 1e-16 here
    assert response.bodies["two"].velocity[[0, 2000]] == pytest.approx([0.0, -speed], rel=1e-13)


def test_a_travel_begins_anew_at_every_blow(taps: StudyResult) -> None:
    travel = taps.cases["as given"].channels["one travel"].values
    assert travel[[0, 6000]] == pytest.approx([0.0, 0.0], abs=1e-15)  # steps and rounding: none here
    assert abs(travel[5999]) > 1e-4


def test_loads_come_three_times(taps: StudyResult) -> None:
    response = taps.cases["as given"].response
    assert response is not None
    push = response.pushes[np.abs(response.pushes).max(axis=1).argsort()]
    # rounding: a sample meets the top of the half sine
    force = next(row for row in push if row.min() == pytest.approx(-30.0, rel=1e-6))
    assert np.flatnonzero(np.diff((force < 0).astype(int)) == 1) == pytest.approx([1000, 5000, 9000], abs=1)


def test_blows_in_json_file_and_figures(taps: StudyResult, tmp_path: Path) -> None:
    case = taps.cases["as given"]
    assert case.response is not None
    table = summary(taps)["cases"]["as given"]
    assert list(table["blows"]) == ["one", "two", "three"]
    assert set(table["blows"]["one"]) == {
        "t_s", "interval_s", "input_j", "impulse_ns", "peak_force_n", "peak_time_s", "closings", "held_force_n",
        "structure_largest_j", "structure_left_j", "rest_after_s", "energy_growth", "number",
    }  # fmt: skip
    assert table["blows"]["three"]["t_s"] == pytest.approx([0.2, 0.5])
    assert max(table["blows"]["two"]["peak_force_n"]) == table["contacts"]["two on p2"]["peak_force_n"]
    brought = sum(sum(blows["input_j"]) for blows in table["blows"].values())
    # the first blow of "one" is the start; what the loads did is the rest
    assert table["energy"]["input_j"] == pytest.approx(brought + table["energy"]["end"]["work"], rel=1e-12)
    first, last = (table["blows"]["one"]["structure_largest_j"][i] for i in (0, -1))
    assert table["blows"]["one"]["energy_growth"] == last / first
    write_all(taps, tmp_path)
    with h5py.File(tmp_path / "results.h5") as file:
        blows = file["cases/as given/blows"]
        assert list(blows["body"].asstr()) == [blow.body for blow in case.response.blows]
        np.testing.assert_array_equal(blows["peak_force"], [blow.peak_force for blow in case.response.blows])
        assert blows["rest_after"].attrs["units"] == "s" and blows["impulse"].attrs["units"] == "N s"
        np.testing.assert_array_equal(file["cases/as given/energy/blows"], case.response.ledger.blows)


def test_the_energy_figure_counts_blows_as_put_in(taps: StudyResult) -> None:
    case = taps.cases["as given"]
    assert case.response is not None
    figure = energy(taps)
    assert figure is not None
    put_in = next(line for line in figure.axes[1].get_lines() if line.get_label() == "put in")
    ledger = case.response.ledger
    share = put_in.get_ydata()[-1] / put_in.get_ydata()[0]
    assert share == pytest.approx((ledger.start.total + ledger.end.work + ledger.end.blows) / ledger.start.total)


def test_blows_long_after_the_window_do_not_happen(tmp_path: Path) -> None:
    """The second blow of each body is 30 years away, beyond what whole numbers of ticks can count."""
    response = run_study(read_study(write(tmp_path, STUDY.replace("every: 0.3 s", "every: 1e9 s")))).cases["as given"]
    assert response.response is not None
    assert [(blow.body, blow.number) for blow in response.response.blows] == [("one", 1), ("two", 1), ("three", 1)]


def test_the_energy_figure_of_a_structure_at_rest_has_a_height(tmp_path: Path) -> None:
    still = "bodies: {one: {mass: 0.5 kg, above: p1, speed: 0 m/s, contact: {type: hertz, stiffness: 2e7}}}\n"
    asked = "record: {p1.z: velocity}\ntime: {duration: 10 ms, sampling: 20 kHz}"
    text = STUDY[: STUDY.index("bodies:")] + still + asked
    figure = energy(run_study(read_study(write(tmp_path, text))))
    assert figure is not None and figure.axes[0].get_ylim() == (0.0, 1.0)


def test_blows_in_the_terminal(strokes: StudyResult, capsys: pytest.CaptureFixture[str]) -> None:
    show_study(strokes, {}, verbose=True)
    told = capsys.readouterr().out
    rows = [line for line in told.splitlines() if line.startswith("slider") and " of 5" in line]
    assert len(rows) == 10
    assert rows[0].split()[:8] == ["slider", "every", "0.4", "s", "1", "of", "5", "0.000"]
    assert "not in 400" in rows[0] and "%)" in rows[1]
    assert "blow-before-rest: After 4 of 5 blows" in told


def test_the_shipped_strokes(strokes: StudyResult) -> None:
    """What models/press_strokes.study.yaml says to expect."""
    soon, late = (strokes.cases[name] for name in ("every 0.4 s", "every 0.8 s"))
    assert soon.response is not None and late.response is not None
    left = [blow.left_energy / blow.largest_energy for blow in (soon.response.blows[0], late.response.blows[0])]
    assert left[0] > 0.01 > left[1]
    # only the heave is left, so its decay over 0.4 s more lies between: e^(-2 x .05 x 40 x .4), and a swing of the
    # dissipated power with its phase, of the order of the damping ratio
    assert left[1] / left[0] == pytest.approx(np.exp(-1.6), rel=0.05)
    codes = [{finding.code for finding in case.findings} for case in (soon, late)]
    assert "blow-before-rest" in codes[0] and "blow-before-rest" not in codes[1]
    for response in (soon.response, late.response):
        assert [blow.held_since for blow in response.blows] == [None] * 5
        assert response.ledger.residual < 1e-12  # steps and rounding: 4e-15 here
    spread = [np.ptp([blow.peak_force for blow in case.blows]) for case in (soon.response, late.response)]
    assert spread[0] > 2 * spread[1] > 0


MISTAKES = {
    "no speed": ("one:   {mass: 0.5 kg, above: p1, drop_height: 4 cm,", "one:   {mass: 0.5 kg, above: p1,", "{count: 2",
        r"bodies\.one\.blows: got no speed, expected a body that strikes; add 'speed:' or 'drop_height:'"),
    "no rhythm": ("blows: {count: 2, every: 0.3 s}}", "blows: {count: 2}}", "blows: {count: 2}}",
        r"bodies\.one\.blows\.every: got nothing, expected 'every'"),
    "count": ("{count: 2, every: 0.3 s}}", "{count: 2.5, every: 0.3 s}}", "2.5",
        r"bodies\.one\.blows\.count: got 2\.5, expected a whole number"),
    "every": ("{count: 2, every: 0.3 s}}", "{count: 2, every: 0 s}}", "0 s}}",
        r"bodies\.one\.blows\.every: got '0 s', expected a positive value"),
    "unknown key": ("first: 0.1 s}}", "frist: 0.1 s}}", "frist",
        r"bodies\.two\.blows\.frist: got the unknown key 'frist'.*did you mean 'first'\?"),
    "a link": ("loads:\n", "links:\n  rope: {between: [one, ground], stiffness: 10 N/m}\nloads:\n", "one, ground",
        r"links\.rope\.between\[0\]: got 'one', which is lifted off at every blow, expected a body without blows"),
    "a preload": ("loads:\n", "contacts:\n  c: {between: [one, p2], law: {type: linear, stiffness: 1}, preload: 1 N}\n"
        "loads:\n", "1 N}", r"contacts\.c\.preload: got a preload on 'one', which is lifted off at every blow"),
    "count of loads": (", every: 0.2 s, count: 3", ", count: 47", "47",
        r"loads\.step\.count: got 'count' without 'every', expected both or none; add 'every: \.\.\.'"),
    "every of loads": (", every: 0.2 s, count: 3", ", every: 0.47 s", "0.47 s",
        r"loads\.step\.every: got 'every' without 'count'"),
}  # fmt: skip


@pytest.mark.parametrize("name", MISTAKES)
def test_mistakes_say_where(name: str, tmp_path: Path) -> None:
    old, new, marked, said = MISTAKES[name]
    assert old in STUDY
    path = write(tmp_path, STUDY.replace(old, new, 1))
    with pytest.raises(InputErrors) as told:
        read_study(path)
    (line,) = str(told.value).splitlines()
    number, column = next(
        (i, text.index(marked) + 1) for i, text in enumerate(path.read_text().splitlines(), 1) if marked in text
    )
    assert re.match(rf"{re.escape(str(path))}:{number}:{column}: {said}", line), line


def test_a_comb_of_blows_says_nothing_of_modes(strokes: StudyResult) -> None:
    for beside in strokes.comparison.cases.values():
        assert not any(beside.modes_db.values())


def test_a_table_of_blows_has_units_that_suit_it_and_no_zeros_of_no_structure(tmp_path: Path) -> None:
    """Half of m v^2 of a ball of 1 t with 2 m/s is 2 kJ, a thousandth of it 2 J; bodies alone have no structure."""
    law = "contact: {type: linear, stiffness: 1 GN/m}, blows: {count: 2, every: 20 ms}"
    body = f"{{mass: %s, above: %s, speed: 2 m/s, {law}}}"
    more = "time: {duration: 40 ms, sampling: 20 kHz, gravity: false}\n"
    (tmp_path / "m.yaml").write_text("structure: {type: oscillator, mass: 1 t, stiffness: 1 N/m}\npoints: {m: {}}\n")
    (tmp_path / "none.yaml").write_text("structure: none\n")

    def rows(model: str, mass: str, above: str) -> tuple[Sequence[str], Sequence[Sequence[str]]]:
        text = f"model: {model}\nbodies: {{ball: {body % (mass, above)}}}\nrecord: {{ball: velocity}}\n{more}"
        (tmp_path / "s.study.yaml").write_text(text, encoding="utf-8")
        table = blows(run_study(read_study(tmp_path / "s.study.yaml")))
        return table.columns, table.rows

    heads, (first, _) = rows("m.yaml", "1 t", "m")
    assert heads[6] == "structure at most [kJ]" and float(first[6]) == pytest.approx(2.0, rel=1e-3)  # printed digits
    heads, (first, _) = rows("m.yaml", "1 kg", "m")
    share = 4.0 * 1000.0 / 1001.0**2  # of the energy that an elastic impact hands over
    assert heads[6] == "structure at most [mJ]" and float(first[6]) == pytest.approx(2e3 * share, rel=1e-3)  # digits
    assert [row[6:] for row in rows("none.yaml", "1 kg", "ground")[1]] == [("no structure", "")] * 2


def test_a_structure_that_only_floats_is_run_with_its_pictures(tmp_path: Path) -> None:
    """It ended in an error, "no elastic mode": there is no shape to draw, which is said."""
    model = "parts: {block: {type: block, mass: 1 t, origin: [0, 0, 0], size: [1, 1, 1]}}\n"
    model += "points: {m: {on: block, at: top}}\n"
    (tmp_path / "m.yaml").write_text(model, encoding="utf-8")
    ball = "{mass: 1 t, above: m, speed: 2 m/s, contact: {type: linear, stiffness: 1 MN/m}}"
    text = f"model: m.yaml\nmodes: {{count: 6}}\nbodies: {{ball: {ball}}}\nrecord: {{m.z: velocity}}\n"
    text += "time: {duration: 100 ms, sampling: 5 kHz, gravity: false}\n"
    (tmp_path / "s.study.yaml").write_text(text, encoding="utf-8")
    result = run_study(read_study(tmp_path / "s.study.yaml"))
    assert shapes_all(result, tmp_path) == (
        [],
        "Pictures of shapes left out: all modes of a structure are rigid-body modes.",
    )
    assert no_shapes(result) == "all modes are rigid-body modes"
    (case,) = result.cases.values()
    assert case.response.bodies["ball"].end_velocity == pytest.approx(0.0, abs=1e-6)  # m/s: of equal masses, tolerance


def test_bodies_alone_have_no_table_of_modes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "none.yaml").write_text("structure: none\n")
    show_modes(modes_of(tmp_path / "none.yaml", extent_of(None, "")))
    assert capsys.readouterr().out == "none\nno modes: bodies only\n"
