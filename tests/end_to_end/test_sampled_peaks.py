"""A recorded force whose peak lies between samples: severe, with both numbers."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from femstruct.cli import app
from femstruct.language import read_study
from femstruct.workflow.run.run import run_study

MODEL = "structure: {type: oscillator, mass: 10 kg, stiffness: 1 MN/m}\npoints: {m: {}}\n"
STUDY = """model: model.yaml
bodies: {ball: {mass: 50 g, above: m, speed: 1 m/s, contact: {type: linear, stiffness: 2 MN/m}}}
record: {m.z: velocityRECORD}
time: {duration: 50 ms, sampling: SAMPLING}
"""
FORCE = ", ball on m: force"


def study(folder: Path, sampling: str, record: str = FORCE) -> Path:
    (folder / "model.yaml").write_text(MODEL, encoding="utf-8")
    path = folder / "one.study.yaml"
    path.write_text(STUDY.replace("SAMPLING", sampling).replace("RECORD", record), encoding="utf-8")
    return path


@pytest.mark.parametrize(
    # contact of pi sqrt(m / k) = 0.5 ms
    ("sampling", "record", "severe"),
    [("1 kHz", FORCE, True), ("100 kHz", FORCE, False), ("1 kHz", "", False)],
)
def test_a_recorded_peak_between_samples_is_severe(tmp_path: Path, sampling: str, record: str, severe: bool) -> None:
    path = study(tmp_path, sampling, record)
    case = run_study(read_study(path)).cases["as given"]
    found = [one for one in case.findings if one.code == "contact-coarsely-sampled"]
    assert [one.severe for one in found] == ([severe] if sampling == "1 kHz" else [])
    if severe:
        assert case.response is not None
        peak = case.response.contacts["ball on m"].peak_force
        assert found[0].values["peak_force_n"] == peak
        assert found[0].values["sampled_peak_n"] == pytest.approx(case.channels["ball on m force"].whole)
        assert found[0].values["sampled_peak_n"] < 0.95 * peak
    left = CliRunner().invoke(app, ["impact", str(path), "--json"]).exit_code
    assert left == (3 if severe else 0)
