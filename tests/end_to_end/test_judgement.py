"""Every command goes through one judgement: `frf` and `identify` too, and `check` for all cases of a study."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from femstruct.files.study_tables import summary
from femstruct.language.cases import read_study
from femstruct.study.results import CaseResult
from femstruct.view.histories import history
from femstruct.view.terminal import study_tables
from femstruct.workflow.bases import solve_all
from femstruct.workflow.check import inspect_file
from femstruct.workflow.exchange import frfs_of
from femstruct.workflow.identify import identify
from femstruct.workflow.model_answers import frf_of
from femstruct.workflow.recorded_channels import converged
from femstruct.workflow.run import run_study
from tests.data.command_line import femstruct

PLATE = """
materials: {{steel: {{E: 210 GPa, nu: 0.3, rho: 7850}}}}
parts:
  p: {{type: plate, material: steel, thickness: 5 mm, origin: [0, 0, 0], size: [0.6, 0.4], mesh: {mesh},
     element: {element}}}
supports: {{s: {{on: p, edge: all, fix: simple}}}}
points: {{a: {{on: p, at: [0.2, 0.15]}}}}
damping: {damping}
"""
STUDY = """
model: plate.yaml
modes: {up_to: 1 kHz}
bodies: {ball: {mass: 5 g, above: a, speed: 1 m/s, contact: {type: linear, stiffness: 100 kN/m}}}
record: {ball on a: force}
time: {duration: 5 ms, sampling: 20 kHz}
"""


def plate(folder: Path, mesh: str = "25 mm", element: str = "bfs16", damping: str = "{ratio: 1 %}") -> Path:
    path = folder / "plate.yaml"
    path.write_text(PLATE.format(mesh=mesh, element=element, damping=damping), encoding="utf-8")
    return path


def study(folder: Path, text: str = STUDY) -> Path:
    plate(folder)
    path = folder / "hit.study.yaml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("changes", "code", "severe"),
    [
        ({"damping": "{ratio: 0}"}, "no-damping", True),
        ({"mesh": "100 mm"}, "coarse-mesh", False),
        ({"mesh": "200 mm"}, "coarse-mesh", True),
        ({"element": "hermite12"}, "twist-defect", False),
    ],
    ids=["undamped", "four cells a wave", "less than two", "hermite12"],
)
def test_a_frequency_response_is_judged(tmp_path: Path, changes: dict[str, str], code: str, severe: bool) -> None:
    told = frf_of(plate(tmp_path, **changes), "a.z", "a.z", "10 Hz:500 Hz", "5 Hz", "", "modal")["findings"]
    found = {finding["code"]: finding for finding in told}
    assert code in found and found[code]["severe"] is severe
    good = frf_of(plate(tmp_path), "a.z", "a.z", "10 Hz:500 Hz", "5 Hz", "", "modal")["findings"]
    assert code not in {finding["code"] for finding in good}


def test_a_response_without_damping_says_what_its_peaks_are(tmp_path: Path) -> None:
    """The first mode of this plate is at (1 / 0.36 + 1 / 0.16) pi / 2 sqrt(D / rho h) = 110.9 Hz."""
    D = 210e9 * 0.005**3 / (12 * (1 - 0.3**2))
    first = np.pi / 2 * (1 / 0.36 + 1 / 0.16) * np.sqrt(D / (7850 * 0.005))
    (told,) = [
        finding
        for finding in frf_of(plate(tmp_path, damping="{ratio: 0}"), "a.z", "a.z", "10 Hz:200 Hz", "5 Hz", "", "modal")[
            "findings"
        ]
        if finding["code"] == "no-damping"
    ]
    assert told["values"]["first_hz"] == pytest.approx(first, rel=5e-5)  # the mesh: 5e-7 here
    assert (told["values"]["modes"], told["values"]["step_hz"]) == (1, 5.0)


def test_a_response_says_that_its_peak_is_between_two_lines(tmp_path: Path) -> None:
    """One response, several, and a study: the first mode, at 110.9 Hz and 2.2 Hz wide, is 20 Hz from its lines."""

    def missed(told: list[dict[str, Any]]) -> list[dict[str, Any]]:
        return [one for one in told if one["code"] == "peak-between-lines"]

    path, asked = plate(tmp_path), ("10 Hz:200 Hz", "40 Hz", "mobility")
    (told,) = missed(frf_of(path, "a.z", "a.z", *asked, "modal")["findings"])
    assert told["message"].startswith("a.z / a.z: the largest value, ")
    assert told["values"]["peak_hz"] == pytest.approx(110.9, rel=1e-3)  # the closed form above, in four digits
    finer = f"{told['values']['needed_hz']} Hz"
    assert not missed(frf_of(path, "a.z", "a.z", asked[0], finer, asked[2], "modal")["findings"])
    of_default = frf_of(path, "a.z", "a.z", "10 Hz:5010 Hz", "", asked[2], "modal")  # 500 lines would be 10 Hz apart
    assert not missed(of_default["findings"]) and of_default["frequency_hz"][1] == pytest.approx(10.5, rel=1e-12)  # sum
    assert len(frfs_of(path, ["a.z"], ["a.z"], "10 Hz:5010 Hz", "", asked[2])[0].frequency_hz) == 10_001
    (one,) = missed(frfs_of(path, ["a.z"], ["a.z", "a.rx"], *asked)[1]["findings"])
    assert one["message"].startswith(("a.z / ", "a.rx / ")) and one["values"]["step_hz"] == 40.0
    ask = "frf: {own: {drive: a.z, response: a.z, kind: mobility, band: [10 Hz, 200 Hz], step: 40 Hz}}"
    case = run_study(read_study(study(tmp_path, STUDY + ask))).cases["as given"]
    (found,) = (finding for finding in case.findings if finding.code == "peak-between-lines")
    assert found.message.startswith("frf.own: the largest value, ")
    # 1e-3 of the largest response is what modes up to 2.5 times the band leave; the study has more of them
    assert case.frf["own"].peak == pytest.approx(told["values"]["peak"], rel=1e-3)


def test_frf_prints_its_findings_as_comments_and_leaves_with_three(tmp_path: Path) -> None:
    ran = femstruct("frf", plate(tmp_path, damping="{ratio: 0}"), "--drive", "a.z", "--response", "a.z", "--band",
                    "10 Hz:200 Hz")  # fmt: skip
    assert ran.returncode == 3
    assert ran.stdout.startswith("# forbids trust, no-damping: ")
    assert np.loadtxt(ran.stdout.splitlines()).shape == (501, 3)
    assert (
        femstruct("frf", plate(tmp_path), "--drive", "a.z", "--response", "a.z", "--band", "10 Hz:200 Hz").returncode
        == 0
    )


def test_check_judges_all_cases(tmp_path: Path) -> None:
    """What is wrong in a variant alone is told with its name, a severe one with exit 3."""
    path = study(
        tmp_path,
        STUDY + "cases: {as given: {}, thousandth: {parts.p.thickness: 0.005 mm}, same: {bodies.ball.mass: 6 g}}\n",
    )
    severe = [finding for finding in inspect_file(path).findings if finding.severe]
    assert severe and all("(case thousandth)" in finding.message for finding in severe)
    assert femstruct("check", path).returncode == 3
    assert not [finding for finding in inspect_file(study(tmp_path)).findings if finding.severe]


def test_check_stages_all_cases(tmp_path: Path) -> None:
    """A variant that strikes nothing is wrong input before anything is run."""
    path = study(tmp_path, STUDY + "cases: {as given: {}, off: {bodies.ball.above: nowhere}}\n")
    ran = femstruct("check", path)
    assert ran.returncode == 2 and "nowhere" in ran.stderr and "Traceback" not in ran.stderr


@pytest.mark.parametrize(
    ("line", "code", "severe"),
    [
        ("loads: {pulse: {at: a.z, half_sine: {amplitude: 1 N, frequency: 6 kHz}}}", "load-coarsely-sampled", False),
        ("loads: {pulse: {at: a.z, half_sine: {amplitude: 1 N, frequency: 6 Hz}}}", "load-cut", True),
    ],
)
def test_check_looks_at_loads(tmp_path: Path, line: str, code: str, severe: bool) -> None:
    found = {finding.code: finding for finding in inspect_file(study(tmp_path, STUDY + line + "\n")).findings}
    assert code in found and found[code].severe is severe


def test_check_counts_the_blows_that_the_window_holds(tmp_path: Path) -> None:
    text = STUDY.replace("speed: 1 m/s,", "speed: 1 m/s, blows: {count: 4, every: 2 ms},")
    found = {finding.code: finding for finding in inspect_file(study(tmp_path, text)).findings}
    assert found["blows-left-out"].values["blows"] == 3  # at 0, 2 and 4 ms of 5 ms
    assert "blows-left-out" not in {finding.code for finding in inspect_file(study(tmp_path)).findings}


def test_identify_tells_the_findings_of_its_simulation(tmp_path: Path) -> None:
    """The fit is good, the structure is not: hermite12 is too stiff in twist, whatever the contact."""
    path = study(tmp_path)
    plate(tmp_path, element="hermite12")
    t = np.arange(0.0, 4e-3, 1e-4)
    np.savetxt(
        tmp_path / "force.csv", np.column_stack((t, 20.0 * np.sin(4000.0 * t) * (t < np.pi / 4000.0))), delimiter=","
    )
    found = identify(path, tmp_path / "force.csv", "ball on a force", ["bodies.ball.contact.stiffness=80 kN/m"])
    assert "twist-defect" in {finding.code for finding in found.findings}
    assert "twist-defect" in {finding["code"] for finding in json.loads(json.dumps(found.table()["findings"]))}


def motion(folder: Path, more: str = "") -> CaseResult:
    """The plate hit by a ball, displacement and acceleration where it is hit."""
    text = STUDY.replace("record: {ball on a: force}", "record: {a.z: [displacement, acceleration]}")
    return run_study(read_study(study(folder, text + more))).cases["as given"]


def test_a_peak_that_hangs_on_residual_vectors_is_told(tmp_path: Path) -> None:
    """The acceleration where the ball strikes, not the displacement; both numbers from the modes themselves."""
    result = motion(tmp_path)
    response = result.response
    assert response is not None
    (told,) = [finding for finding in result.findings if finding.code == "peak-not-converged"]
    assert told.message.startswith("a.z acceleration")
    true = np.array([kind == "elastic" for kind in response.basis.kind])
    row = solve_all(read_study(tmp_path / "hit.study.yaml").cases)["as given"].places.point("a", "").probe("z")
    parts = row.of(response.basis.shapes)[:, None] * response.qdd
    assert told.values["peak"] == pytest.approx(np.abs(parts.sum(axis=0)).max(), rel=1e-13)  # the same sum: rounding
    # the same sum: rounding
    assert told.values["modes_alone"] == pytest.approx(np.abs(parts[true].sum(axis=0)).max(), rel=1e-13)
    assert told.values["apart"] > told.values["allowed"]


def test_a_low_pass_or_more_modes_make_peaks_converge(tmp_path: Path) -> None:
    """What residual vectors are of a peak, measured: 58 %, below 400 Hz 5 %, with modes to 8 kHz 36 %."""

    def apart(result: CaseResult) -> float:
        channel = result.channels["a.z acceleration"]
        assert channel.by_modes is not None
        return abs(channel.whole - channel.by_modes[1]) / channel.whole

    few, filtered = apart(motion(tmp_path)), apart(motion(tmp_path, "peaks: {lowpass: 400 Hz}\n"))
    finer = ("modes.up_to=8 kHz", "time.sampling=80 kHz")
    motion(tmp_path)
    many = apart(run_study(read_study(tmp_path / "hit.study.yaml", finer)).cases["as given"])
    assert few > 0.5
    assert filtered < 0.2 * few
    assert many < 0.7 * few


def test_a_change_that_hangs_on_residual_vectors_is_told(tmp_path: Path) -> None:
    text = STUDY.replace("record: {ball on a: force}", "record: {a.z: acceleration}")
    text += "cases: {as given: {}, harder: {bodies.ball.contact.stiffness: 400 kN/m}}\n"
    result = run_study(read_study(study(tmp_path, text)))
    harder = result.cases["harder"]
    (told,) = [finding for finding in harder.findings if finding.code == "change-not-converged"]
    assert abs(told.values["change_percent"] - told.values["modes_alone_percent"]) > told.values["allowed"]
    peaks = result.comparison.cases["harder"].peaks
    assert not peaks["a.z acceleration"].converged and peaks["net force on a"].converged
    (grid,) = [grid for grid in study_tables(result) if grid.title.startswith("peaks")]
    assert "? : do not quote, see peak-not-converged and change-not-converged" in grid.title
    assert [row[2].endswith(" % ?") for row in grid.rows] == [True, False]
    for row, name in zip(grid.rows, ("a.z acceleration", "net force on a"), strict=True):
        for cell, case in zip(row[1:], result.cases.values(), strict=True):
            sure = converged(case.channels[name])
            assert [one.endswith(" ?") for one in cell.split("\n")[0].split(" / ")] == [not sure, not sure]
            assert summary(result)["cases"][case.case.name]["peaks"][name]["converged"] == sure
    assert not converged(harder.channels["a.z acceleration"])
    figure = history(result, "a.z acceleration")
    assert "? : do not quote, see peak-not-converged" in figure.texts[0].get_text()
    labels = figure.axes[0].get_legend_handles_labels()[1]
    assert len(labels) == 2 and all(label.endswith(" in all ?") for label in labels)


def undamped(folder: Path, damping: str, changes: str = "", window: str = "0.1 s") -> dict[str, Any] | None:
    """What `check` says of a plate without damping that is struck and, in a room, heard."""
    path = plate(folder, "100 mm", damping=damping)
    text = path.read_text(encoding="utf-8").replace("rho: 7850", "rho: 7850, loss_factor: 2 %")
    path.write_text(text + "surfaces: {below: {on: p, side: below}}\n", encoding="utf-8")
    hit = STUDY.replace("1 kHz", "500 Hz").replace("5 ms", window) + changes
    (folder / "hit.study.yaml").write_text(hit, encoding="utf-8")
    told = [one for one in inspect_file(folder / "hit.study.yaml").table()["findings"] if one["code"] == "undamped"]
    return json.loads(json.dumps(told[0])) if told else None


ROOM = "rooms: {box: {size: [0.6, 0.4, 0.3], under: below, receivers: {mic: [0.1, 0.1, 0.1]}%s}}\n"


def test_a_simulation_without_damping_says_so(tmp_path: Path) -> None:
    """No word on damping: exit 0 and levels of a plate that never came to rest. Modes of this plate begin at 110.9 Hz:
    0.1 s has 11 periods."""
    told = undamped(tmp_path, "{ratio: 0}")
    assert told is not None and not told["severe"]
    assert "Loss factors of materials (of p) are used only with 'damping: {from: materials}'" in told["message"]
    assert told["values"]["first_hz"] == pytest.approx(110.9, rel=1e-3)  # four digits; the mesh: 1e-4
    for damping in ("{ratio: 0.1 %}", "{from: materials}", "{modes: {1: {ratio: 1 %, near: 110 Hz}}}"):
        first = undamped(tmp_path, damping)
        assert first is None or first["values"]["first_hz"] > 200.0, damping
    assert undamped(tmp_path, "{ratio: 3.3e-7}") is not None  # practically none
    assert undamped(tmp_path, "{ratio: 0}", window="50 ms") is None  # 6 periods: the impact itself


def test_levels_in_a_room_under_a_structure_without_damping_forbid_trust(tmp_path: Path) -> None:
    """With air that reacts on the plate, the air damps it; one undamped mode of several limits trust."""
    (told,) = (one for one in [undamped(tmp_path, "{ratio: 0}", ROOM % "")] if one)
    assert told["severe"] and "Levels in box are too high" in told["message"]
    (air,) = (one for one in [undamped(tmp_path, "{ratio: 0}", ROOM % ", coupling: two-way")] if one)
    (some,) = (one for one in [undamped(tmp_path, "{modes: {1: {ratio: 1 %, near: 110 Hz}}}", ROOM % "")] if one)
    assert not air["severe"] and not some["severe"]
    assert femstruct("check", tmp_path / "hit.study.yaml").returncode == 0


def test_a_peak_is_judged_and_quoted_in_the_window_of_the_table(tmp_path: Path) -> None:
    """Where nothing meets there is no first impact: a tick at the start, all of residual vectors, is in no table."""
    plate(tmp_path)
    path = study(
        tmp_path,
        "model: plate.yaml\nmodes: {up_to: 800 Hz}\nrecord: {a.z: [velocity, acceleration]}\n"
        "loads:\n  tick: {at: a.z, half_sine: {amplitude: 1 N, frequency: 2 kHz}}\n"
        "  push: {at: a.z, half_sine: {amplitude: 100 N, frequency: 180 Hz}, first: 50 ms}\n"
        "time: {duration: 0.2 s, sampling: 20 kHz}\n",
    )
    result = run_study(read_study(path)).cases["as given"]
    for name, apart in (("a.z velocity", False), ("a.z acceleration", True)):
        channel = result.channels[name]
        assert channel.by_modes is not None
        first, whole = zip((channel.first_impact, channel.whole), channel.by_modes, strict=True)
        assert max(first) > 1.05 * min(first) and max(first) < 0.5 * min(whole)  # what was judged, and quoted
        told = [one for one in result.findings if one.code == "peak-not-converged" and one.message.startswith(name)]
        assert (max(whole) > 1.05 * min(whole), bool(told)) == (apart, apart)
        assert all(one.values["peak"] == channel.whole and "impact" not in one.message for one in told)
