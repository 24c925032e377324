"""Standard sources from YAML: what they bring, the hammers' turns, and the finding when the floor gives way."""

from __future__ import annotations

from pathlib import Path

import pytest

from femstruct.impact.scene import RUBBER_BALL
from femstruct.language.cases import read_study
from femstruct.study.results import StudyResult
from femstruct.workflow.run import run_study

FLOOR = """structure: {{type: modes, frequency: [{frequency}], ratio: [3 %], points: {{p: [{shape}]}}}}
"""
BALL = """model: model.yaml
modes: {count: 1}
bodies: {ball: {source: SOURCE, above: p}}
record: {ball on p: force}
time: {duration: 60 ms, sampling: 48 kHz}
"""
HAMMERS = """model: model.yaml
modes: {up_to: 200 Hz}
bodies:
  hammer:
    {source: tapping machine, above: feet, contact: {type: hertz, stiffness: 2e9}, blows: {count: 2, timing: regular}}
time: {duration: 1 s, sampling: 8 kHz}
"""
PLATE = """
materials: {concrete: {E: 30 GPa, nu: 0.2, rho: 2400}}
parts: {slab: {type: plate, material: concrete, thickness: 0.2 m, origin: [0, 0, 0], size: [3, 2], mesh: [6, 4]}}
supports: {edges: {on: slab, edge: all, fix: simple}}
points: {feet: {on: slab, at: [[1, 1], [1.1, 1], [1.2, 1], [1.3, 1], [1.4, 1]]}}
"""


def run(folder: Path, model: str, study: str) -> StudyResult:
    (folder / "model.yaml").write_text(model, encoding="utf-8")
    (folder / "one.study.yaml").write_text(study, encoding="utf-8")
    return run_study(read_study(folder / "one.study.yaml"))


@pytest.mark.parametrize("source", ["rubber ball", "bang machine"])
def test_a_stiff_floor_keeps_a_source_to_its_standard(tmp_path: Path, source: str) -> None:
    # a mode of 4 t at 300 Hz: rigid beside either source
    model = FLOOR.format(frequency=300, shape=4000**-0.5)
    case = run(tmp_path, model, BALL.replace("SOURCE", source)).cases["as given"]
    assert not [found for found in case.findings if found.code.startswith("source")]
    body = case.case.study.bodies[0]
    assert (body.source, body.dropped) == (source, True)


def test_a_soft_floor_takes_the_ball_off_its_standard(tmp_path: Path) -> None:
    model = FLOOR.format(frequency=20, shape=8**-0.5)  # a board of 8 kg at 20 Hz goes along with a ball of 2.5 kg
    case = run(tmp_path, model, BALL.replace("SOURCE", "rubber ball")).cases["as given"]
    found = next(found for found in case.findings if found.code == "source-off-standard")
    assert response_restitution(case) == pytest.approx(found.values["restitution"])
    assert found.values["restitution"] < 0.7
    assert "restitution" in found.message
    assert "0.8 +- 0.1" in found.message


def response_restitution(case) -> float:
    assert case.response is not None
    return float(case.response.bodies["ball"].velocity[-1]) / RUBBER_BALL.speed


def test_a_sampling_too_low_for_the_octaves_is_told(tmp_path: Path) -> None:
    model = FLOOR.format(frequency=300, shape=4000**-0.5)
    study = BALL.replace("SOURCE", "rubber ball").replace("48 kHz", "1 kHz")
    codes = [found.code for found in run(tmp_path, model, study).cases["as given"].findings]
    assert "source-coarsely-sampled" in codes


def test_hammers_strike_in_turn_at_the_speed_of_the_standard(tmp_path: Path) -> None:
    response = run(tmp_path, PLATE, HAMMERS).cases["as given"].response
    assert response is not None
    assert [blow.body for blow in response.blows] == [f"hammer.{i}" for i in (1, 2, 3, 4, 5)] * 2
    # rounding of sums of 0.1
    assert [blow.t for blow in response.blows] == pytest.approx([0.1 * i for i in range(10)], abs=1e-14)
    struck = response.bodies["hammer.3"].velocity[int(0.2 * 8000)]
    assert -struck == pytest.approx(0.886, abs=0.022)  # ISO 10140-5 annex E
    assert all(blow.closings >= 1 for blow in response.blows)
