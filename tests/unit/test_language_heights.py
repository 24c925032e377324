"""Points of given modes with positions: what is above what, and what closes."""

from __future__ import annotations

from pathlib import Path

import pytest

from femstruct.errors import InputError, InputErrors
from femstruct.language.cases import json_schema, read_study
from femstruct.workflow.bases import solve_all
from femstruct.workflow.staging import build_scene

MODEL = """structure:
  type: modes
  frequency: [10 Hz, 100 Hz]
  points: {top: %s, base: %s}
"""
STUDY = """model: model.yaml
modes: {count: 2}
bodies: {damper: {mass: 1 kg, below: top}}
links: {mount: {between: [base, damper], stiffness: 1 kN/m, damping: {closing: 3 N*s/m, opening: 5 N*s/m}}}
time: {duration: 10 ms, sampling: 10 kHz}
"""


def link(folder: Path, top: str, base: str, study: str = STUDY) -> tuple[object, object]:
    """Upper and lower end of the mount."""
    (folder / "model.yaml").write_text(MODEL % (top, base))
    (folder / "hit.study.yaml").write_text(study)
    (case,) = read_study(folder / "hit.study.yaml").cases
    found = build_scene(case.study, solve_all((case,))[case.name].places).links[0]
    return found.upper, found.lower


def test_what_stands_below_a_high_point_is_above_a_low_one(tmp_path: Path) -> None:
    upper, _ = link(tmp_path, "{shape: [1, 1], at: 0.2 m}", "{shape: [1, -1], at: 0 m}")
    assert upper == "damper"
    _, lower = link(tmp_path, "{shape: [1, 1], at: 0.2 m}", "{shape: [1, -1], at: 30 cm}")
    assert lower == "damper"


def test_positions_are_along_the_axis_of_the_study(tmp_path: Path) -> None:
    sideways = STUDY.replace("below", "before")
    upper, _ = link(tmp_path, "{shape: [1, 1], at: 0.2 m}", "{shape: [1, -1], at: 0.1 m}", sideways)
    assert upper == "damper"  # before the far point, after the near one


@pytest.mark.parametrize("base", ["[1, -1]", "{shape: [1, -1]}"])
def test_points_that_are_nowhere_are_refused_where_it_matters(tmp_path: Path, base: str) -> None:
    with pytest.raises(InputError, match=r"links.mount.between: .* write structure.points.base as \{shape"):
        link(tmp_path, "{shape: [1, 1], at: 0.2 m}", base)
    upper, _ = link(tmp_path, "[1, 1]", base, STUDY.replace("[base, damper]", "[damper, top]"))  # its own point
    assert upper != "damper"


@pytest.mark.parametrize(
    ("top", "told"),
    [
        ("{shape: [1, 1], at: 3 kg}", "a mass, expected a length"),
        ("{shape: [1], at: 0 m}", "got 1 values, expected 2, one a mode"),
        ("{at: 0 m}", "shape"),
        ("{shape: [1, 1], height: 1 m}", "height"),
    ],
)
def test_mistakes_are_told_with_their_place(tmp_path: Path, top: str, told: str) -> None:
    with pytest.raises(InputErrors, match=rf"model.yaml:\d+:\d+: structure.*{told}"):
        link(tmp_path, top, "[1, 1]")


def test_schema_knows_both_ways() -> None:
    text = str(json_schema("model"))
    assert "GivenPointSpec" in text
