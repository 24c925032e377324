"""A recorded force whose peak lies between samples: its history is said to miss it, its peak does not."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from femstruct.cli import app
from femstruct.language.cases import read_study
from femstruct.workflow.run import run_study

MODEL = "structure: {type: oscillator, mass: 10 kg, stiffness: 1 MN/m}\npoints: {m: {}}\n"
STUDY = """model: model.yaml
bodies: {ball: {mass: 50 g, above: m, speed: 1 m/s, contact: {type: linear, stiffness: 2 MN/m}}}
record: {m.z: velocityRECORD}
time: {duration: 50 ms, sampling: SAMPLING}
"""
LIMITS = "limits: {m.z velocity: 0.1 mm/s, ball on m force: 1 MN, m.z displacement: 1 m}\n"
FORCE = ", ball on m: force"


def study(folder: Path, sampling: str, record: str = FORCE) -> Path:
    (folder / "model.yaml").write_text(MODEL, encoding="utf-8")
    path = folder / "one.study.yaml"
    path.write_text(STUDY.replace("SAMPLING", sampling).replace("RECORD", record), encoding="utf-8")
    return path


@pytest.mark.parametrize(
    # contact of pi sqrt(m / k) = 0.5 ms
    ("sampling", "record", "missed"),
    [("1 kHz", FORCE, True), ("100 kHz", FORCE, False), ("1 kHz", "", False)],
)
def test_a_recorded_peak_between_samples_is_found(tmp_path: Path, sampling: str, record: str, missed: bool) -> None:
    path = study(tmp_path, sampling, record)
    case = run_study(read_study(path)).cases["as given"]
    found = [one for one in case.findings if one.code == "contact-coarsely-sampled"]
    assert [one.severe for one in found] == ([False] if sampling == "1 kHz" else [])
    if missed:
        assert case.response is not None
        peak, channel = case.response.contacts["ball on m"].peak_force, case.channels["ball on m force"]
        assert found[0].values["peak_force_n"] == peak
        assert found[0].values["sampled_peak_n"] == pytest.approx(abs(channel.values).max())
        assert found[0].values["sampled_peak_n"] < 0.95 * peak
        # a half sine of 16 samples at least, two beside its top: (pi / 32)^2 / 2
        assert 0.995 * peak < channel.whole <= peak
    assert CliRunner().invoke(app, ["impact", str(path), "--json"]).exit_code == 0


def test_a_peak_that_no_grid_shows_is_a_lower_bound(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A contact of 0.5 ms that memory does not let be followed, on a structure that is sampled densely enough."""
    monkeypatch.setattr("femstruct.impact.resampled.MOST_STATES", 100)
    path = study(tmp_path, "1 kHz")
    text = path.read_text(encoding="utf-8").replace("m.z: velocity", "m.z: [velocity, displacement]")
    path.write_text(text + LIMITS, encoding="utf-8")
    result = run_study(read_study(path))
    case = result.cases["as given"]
    (found,) = [one for one in case.findings if one.code == "motion-coarsely-sampled" and "needed" in one.values]
    assert found.severe and case.response is not None
    assert case.channels["ball on m force"].whole == case.response.contacts["ball on m"].peak_force
    assert [one.verdict for one in result.verdicts["as given"]] == ["exceeded", "met", "not known"]
    assert CliRunner().invoke(app, ["impact", str(path), "--json"]).exit_code == 3


def test_a_machine_has_the_same_forces_and_travels_at_any_sampling() -> None:
    """A forging hammer: blows of 2 ms, modes up to 80 Hz. 150 Hz are 1.9 samples in a period of the last one."""
    path = Path(__file__).parents[2] / "models" / "forging_hammer.study.yaml"
    fine, coarse = (
        run_study(read_study(path, (f"time.sampling={sampling}",), "impact damper")) for sampling in ("8 kHz", "150 Hz")
    )
    for name in coarse.machine:
        one, other = fine.machine[name], coarse.machine[name]
        assert one.ground is not None and other.ground is not None
        share = 0.005  # two of 32 samples a period beside the top of a sine: (pi / 32)^2 / 2
        assert other.ground.dynamic == pytest.approx(one.ground.dynamic, rel=share)
        assert other.ground.with_weight == pytest.approx(one.ground.with_weight, rel=share)
        assert other.travels == pytest.approx(dict(one.travels), rel=share)
    assert coarse.machine["impact damper"].companions["damper"].travel == pytest.approx(
        fine.machine["impact damper"].companions["damper"].travel, rel=share
    )


def test_a_machine_whose_peaks_do_not_fit_into_memory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its forces and travels are blank in all tables; no limit on them is met."""
    monkeypatch.setattr("femstruct.impact.resampled.MOST_STATES", 100)
    path = Path(__file__).parents[2] / "models" / "forging_hammer.study.yaml"
    out = tmp_path / "out"
    given = [
        "run",
        str(path),
        "--case",
        "impact damper",
        "--set",
        "time.sampling=50 Hz",
        "--no-pictures",
        "-o",
        str(out),
    ]
    ended = CliRunner().invoke(app, given)
    assert ended.exit_code == 3, ended.output
    assert "nan" not in ended.output
    cases = json.loads((out / "summary.json").read_text(encoding="utf-8"))["cases"]
    for case in cases.values():
        assert case["machine"]["ground_force"]["dynamic_n"] is None
        assert case["limits"]["ground force"]["verdict"] == "not known"
        assert case["findings"][0]["code"] == "motion-coarsely-sampled"
    assert cases["impact damper"]["machine"]["companions"]["damper"]["travel_m"] is None
