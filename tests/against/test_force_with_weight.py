"""Limits of the force on the ground with the weight of all that stands there, against a block and a ram by events."""

from __future__ import annotations

from math import sqrt
from pathlib import Path

import numpy as np
import pytest

from femstruct.errors import FemstructError
from femstruct.language.cases import read_study
from femstruct.study.results import StudyResult
from femstruct.view.terminal import study_tables
from femstruct.workflow.run import run_study
from tests.independent.contact_events import Chain, Touch, linear, run

G = 9.80665
MODEL = """
parts:
  block: {type: block, mass: 100 kg, origin: [0, 0, 0], size: [0.5, 0.5, 0.5]}
  feet: {type: spring, between: [foot, ground],
         stiffness: {x: 400 kN/m, y: 400 kN/m, z: 400 kN/m, rx: 1e5, ry: 1e5, rz: 1e5}}
points: {foot: {on: block, at: [0.25, 0.25, 0]}, top: {on: block, at: [0.25, 0.25, 0.5]}}
damping: {ratio: 0 %}
"""
STUDY = """
model: model.yaml
modes: {count: 6}
bodies:
  ram: {mass: 5 kg, above: top, speed: 2 m/s, contact: {type: linear, stiffness: 1 MN/m, damping: 500 N*s/m}}
  load: {mass: 20 kg, above: ground, contact: {type: linear, stiffness: 10 MN/m}}
record: {ground: force}
limits: {ground force: 1.3 kN, ground force with weight: 2.1 kN}
time: {duration: 150 ms, sampling: 10 kHz, gravity: true}
"""


def computed(folder: Path, study: str = STUDY) -> StudyResult:
    (folder / "model.yaml").write_text(MODEL, encoding="utf-8")
    (folder / "s.study.yaml").write_text(study, encoding="utf-8")
    return run_study(read_study(folder / "s.study.yaml"))


def right() -> tuple[float, float]:
    """Largest force of the motion, and with the weight of the block and of what lies beside it."""
    chain = Chain(
        [sqrt(400e3 / 100.0)], [0.0], {"top": [0.1]}, {"ram": 5.0}, [Touch("hit", "ram", "top", linear(1e6, 500.0))],
        weights={"ram": -5.0 * G}, start={"ram": -2.0},
    )  # fmt: skip
    moved = 400e3 * run(chain, 0.15).moved("top", np.arange(1501) / 1e4)
    return float(np.abs(moved).max()), float(np.abs(moved - 120.0 * G).max())


def test_the_force_with_weight_is_limited_and_told(tmp_path: Path) -> None:
    result = computed(tmp_path)
    motion, weighed = right()
    alone, both = result.verdicts["as given"]
    assert (alone.name, both.name) == ("ground force", "ground force with weight")
    steps = 1e-4  # samples beside the peaks: 100 us of 10 Hz
    assert alone.value == pytest.approx(motion, rel=steps) and alone.met is (motion <= 1300.0)
    assert both.value == pytest.approx(weighed, rel=steps) and both.met is (weighed <= 2100.0)
    assert both.limit == 2100.0 and both.unit == "N"
    row = result.machine["as given"].ground
    assert row is not None and row.with_weight == pytest.approx(both.value, rel=1e-12)  # the same samples
    peaks = next(one for one in study_tables(result) if one.title.startswith("peaks"))
    assert any(line[0].startswith("ground force with weight") for line in peaks.rows)


def test_a_low_pass_leaves_the_weight(tmp_path: Path) -> None:
    """Far below all vibration what is left of the motion moves the block by little: the weight stays."""
    study = STUDY.replace("time:", "peaks: {lowpass: 1 Hz}\ntime:").replace("150 ms", "2 s")
    both = computed(tmp_path, study).verdicts["as given"][1]
    assert both.value is not None and 120.0 * G <= both.value < 1.1 * 120.0 * G


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("gravity: true", "gravity: false", "add 'gravity: true' under 'time:'"),
        ("record: {ground: force}", "record: {ram: velocity}", "add 'ground: force' under 'record:'"),
        ("{ground force: 1.3 kN, ground force with weight", "{feet force with weight", "'femstruct statics' has it"),
        ("with weight: 2.1 kN", "with weight: 2.1 mm", "expected a force"),
    ],
)
def test_a_limit_with_weight_that_means_nothing_is_refused(tmp_path: Path, old: str, new: str, told: str) -> None:
    with pytest.raises(FemstructError, match=told):
        computed(tmp_path, STUDY.replace(old, new).replace("ground force: 1.3 kN, ", ""))
