"""The equivalent stress of an orthotropic part is shown with a finding, wherever it is shown."""

from __future__ import annotations

from pathlib import Path

import pytest

from femstruct.language.cases import read_study
from femstruct.workflow.model_answers import frf_of, statics_table
from femstruct.workflow.run import run_study

MODEL = """
materials:
  timber: {E: [11 GPa, 370 MPa], G: [690 MPa, 69 MPa], nu: 0.3, rho: 450}
  steel: {E: 210 GPa, nu: 0.3, rho: 7850}
parts:
  board: {type: plate, material: MATERIAL, thickness: 40 mm, origin: [0, 0, 0], size: [1, 0.5], mesh: 250 mm}
points: {middle: {on: board, at: [0.5, 0.25]}}
supports: {wall: {on: board, edge: x0, fix: clamped}}
damping: {ratio: 1 %}
"""
STUDY = """
model: board.yaml
modes: {count: 6}
record: {board: stress}
vibration: {shaker: {base: z, psd: 0.01 g^2/Hz, band: [5 Hz, 50 Hz]}}
"""


@pytest.mark.parametrize(("material", "told"), [("timber", 1), ("steel", 0)])
def test_the_equivalent_stress_of_timber_is_told_to_be_no_measure(material: str, told: int, tmp_path: Path) -> None:
    model, study = tmp_path / "board.yaml", tmp_path / "board.study.yaml"
    model.write_text(MODEL.replace("MATERIAL", material), encoding="utf-8")
    study.write_text(STUDY, encoding="utf-8")
    case = run_study(read_study(study)).cases["as given"]
    found = [one.message for one in case.findings if one.code == "stress-of-orthotropic"]
    assert len(found) == told
    assert all(one.startswith("board:") and "timber is orthotropic" in one for one in found)
    for table in (
        statics_table(model, ["middle.z=-1 kN"], weight=False),
        frf_of(model, "middle.z", "board.stress", "5 Hz:50 Hz", "1 Hz", "", "modal"),
        frf_of(model, "middle.z", "middle.stress", "5 Hz:50 Hz", "1 Hz", "", "modal"),
    ):
        assert [one["code"] for one in table["findings"]].count("stress-of-orthotropic") == told
    study.write_text(STUDY.replace("board: stress", "middle.z: velocity"), encoding="utf-8")
    silent = run_study(read_study(study)).cases["as given"]
    assert "stress-of-orthotropic" not in [one.code for one in silent.findings]
