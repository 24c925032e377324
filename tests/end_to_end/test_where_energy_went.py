"""Energy by modes from the study's file to its tables, and accelerations that the sampling cannot show."""

from __future__ import annotations

from pathlib import Path

import h5py
import pytest

from femstruct.files.results_file import write_results
from femstruct.files.study_tables import summary
from femstruct.language.cases import read_study
from femstruct.study.results import StudyResult
from femstruct.view.terminal import show_study
from femstruct.workflow.run import run_study

MODEL = """
structure: {type: modes, frequency: [100 Hz, 20 kHz], ratio: [1 %, 1 %], points: {P: [1.0, 1.0]}}
"""
STUDY = """
model: model.yaml
bodies: {ball: {mass: 100 g, above: P, speed: 1 m/s, contact: {type: linear, stiffness: 1 GN/m}}}
record: {P.z: acceleration}
time: {duration: 20 ms, sampling: SAMPLING}
"""


def run(folder: Path, sampling: str) -> StudyResult:
    (folder / "model.yaml").write_text(MODEL, encoding="utf-8")
    (folder / "s.study.yaml").write_text(STUDY.replace("SAMPLING", sampling), encoding="utf-8")
    return run_study(read_study(folder / "s.study.yaml"))


def test_from_the_file_to_all_tables(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    result = run(tmp_path, "20 kHz")
    energy = summary(result)["cases"]["as given"]["energy"]
    for when in ("at_separation", "end"):
        parts = energy[when]["modes"]
        assert [(part["name"], part["from_hz"]) for part in parts] == [
            ("mode 1", pytest.approx(100.0)),
            ("mode 2", pytest.approx(20e3)),
        ]
        assert sum(part["energy_j"] for part in parts) == pytest.approx(
            energy[when]["structure"],
            abs=1e-11 * energy["input_j"],  # steps and rounding: 2e-14 here
        )
        lost = energy[when]["lost"]
        assert lost["modes"] > 0.0 and lost["contacts"]["ball on P"] == 0.0  # its law has no dashpot
        assert lost["modes"] + sum(lost["contacts"].values()) + sum(lost["links"].values()) == pytest.approx(
            energy[when]["dissipated"],
            rel=1e-14,  # steps and rounding: none here
        )
    assert energy["end"]["lost"]["modes"] > energy["at_separation"]["lost"]["modes"]
    write_results(tmp_path / "r.h5", result)
    with h5py.File(tmp_path / "r.h5") as file:
        for when in ("at_separation", "end"):
            kept = file[f"cases/as given/energy/lost/{when}"][:].tolist()
            assert kept == [energy[when]["lost"]["modes"], 0.0, *energy[when]["lost"]["contacts"].values()]
        modes = file["cases/as given/energy/modes"]
        assert modes["end"][:].tolist() == [part["energy_j"] for part in energy["end"]["modes"]]
        # steps and rounding: 3e-14 here
        assert modes["at_separation"][:].sum() == pytest.approx(energy["at_separation"]["structure"], rel=1e-11)
    show_study(result, {})
    shown = capsys.readouterr().out
    assert "where the energy went" in shown
    assert "mode 1 (100 Hz)" in shown


def test_an_acceleration_above_half_the_sampling_is_told(tmp_path: Path) -> None:
    """The mode of 20 kHz rings above half of 20 kHz, and below half of 80 kHz."""
    found = [f for f in run(tmp_path, "20 kHz").cases["as given"].findings if f.code == "motion-coarsely-sampled"]
    (told,) = [f for f in found if "rms_m_s2" in f.values]
    assert told.values["above_half_m_s2"] > 0.05 * told.values["rms_m_s2"] > 0.0
    assert told.values["half_sampling_hz"] == 10e3
    assert "motion-coarsely-sampled" not in [f.code for f in run(tmp_path, "80 kHz").cases["as given"].findings]


def test_given_modes_are_cut_at_the_last_one(tmp_path: Path) -> None:
    """A pulse of 0.03 ms beside a structure with no mode above 100 Hz."""
    one_mode = MODEL.replace("[100 Hz, 20 kHz]", "[100 Hz]").replace("[1 %, 1 %]", "[1 %]").replace(", 1.0]", "]")
    (tmp_path / "model.yaml").write_text(one_mode, encoding="utf-8")
    (tmp_path / "s.study.yaml").write_text(STUDY.replace("SAMPLING", "80 kHz"), encoding="utf-8")
    case = run_study(read_study(tmp_path / "s.study.yaml")).cases["as given"]
    (told,) = [f for f in case.findings if f.code == "contact-beyond-modes"]
    assert "above 100 Hz, the highest given mode" in told.message
    assert told.values["highest_hz"] == pytest.approx(100.0)
