"""Findings about forces outside the window and tapping machines that are none, against impulses and places by hand."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from femstruct.errors import InputErrors
from femstruct.impact.scene import HalfSine, Table
from femstruct.language.cases import read_study
from femstruct.study.acting import PlannedLoad, Repeat
from femstruct.view.console import scaled
from femstruct.workflow.impact_findings import hammer_findings, load_findings

TRIANGLE = Table(np.array([0.0, 0.01, 0.02]), np.array([0.0, 1000.0, 0.0]))  # 10 N s


def load(history: HalfSine | Table, **repeat: float) -> PlannedLoad:
    return PlannedLoad("hammer", "ball", "body", history, Repeat(**repeat))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("history", "repeat"),
    [
        (TRIANGLE, {}),
        (TRIANGLE, {"count": 5, "every": 0.1, "first": 0.5}),
        (Table(np.array([-0.01, 0.0, 0.01]), np.array([0.0, 0.0, 5.0])), {}),  # a pretrigger of nothing
        (HalfSine(1000.0, 50.0), {"first": 0.99}),
    ],
)
def test_forces_inside_the_window_are_left_alone(history: HalfSine | Table, repeat: dict[str, float]) -> None:
    assert load_findings([load(history, **repeat)], 1.0) == ()


# a half sine has A / (pi f) = 6.3662 N s; half of its half period gives half of that
@pytest.mark.parametrize(
    ("history", "repeat", "whole", "inside", "severe"),
    [
        (Table(TRIANGLE.times - 0.01, TRIANGLE.values), {}, 10.0, 5.0, False),
        (Table(TRIANGLE.times - 0.05, TRIANGLE.values), {}, 10.0, 0.0, True),
        (Table(TRIANGLE.times, -TRIANGLE.values), {"first": 0.99}, 10.0, 5.0, False),
        (TRIANGLE, {"first": 2.0}, 10.0, 0.0, True),
        (TRIANGLE, {"count": 4, "every": 0.3, "first": 0.25}, 40.0, 30.0, False),
        (HalfSine(1000.0, 50.0), {"first": 0.995}, 6.3662, 3.1831, False),
    ],
)
def test_forces_that_are_cut_are_told_with_their_impulses(
    history: HalfSine | Table, repeat: dict[str, float], whole: float, inside: float, severe: bool
) -> None:
    (found,) = load_findings([load(history, **repeat)], 1.0)
    assert found.code == "load-cut"
    assert found.severe is severe
    assert found.values["whole"] == pytest.approx(whole, rel=1e-3)  # straight lines along a half sine: 1e-4
    assert found.values["inside"] == pytest.approx(inside, rel=1e-3, abs=1e-9)  # as above; zero but for rounding


def machine(x: list[float]) -> Any:
    """Five hammers at x [m], and where they are."""
    bodies = tuple(SimpleNamespace(name=f"m.{i}", source="tapping machine", target=str(i)) for i in range(len(x)))
    points = {str(i): SimpleNamespace(position=np.array([at, 0.0, 2.0])) for i, at in enumerate(x)}
    return SimpleNamespace(bodies=bodies), SimpleNamespace(point=lambda name, _: points[name])


def test_hammers_of_one_machine_stand_beside_each_other() -> None:
    assert hammer_findings(*machine([1.0, 1.1, 1.2, 1.3, 1.4])) == ()
    assert hammer_findings(*machine([1.0, 1.098, 1.2, 1.3, 1.4])) == ()  # within 3 mm
    assert hammer_findings(*machine([1.0])) == ()
    (found,) = hammer_findings(*machine([1.0, 1.1, 2.9, 3.0, 3.1]))
    assert found.code == "tapping-hammer-spacing"
    assert found.values["apart_m"] == pytest.approx(1.8)


def test_nothing_is_scaled_to_its_own_unit() -> None:
    assert scaled("J", 0.0) == (1.0, "J")


@pytest.mark.parametrize(
    ("csv", "told"),
    [
        (
            "",
            r"hit\.study\.yaml:3:\d+: loads\.push\.file: got 0 lines of numbers in '.*force\.csv'",
        ),
        ("time [s], force [N]\n0, 1\n", r"got 1 lines of numbers"),
        ("t\n0\n1\n", r"force\.csv:2:1: got 1 columns.*decimals with a point"),
        ("t;F;G\n0,0;1,5;2\n1,0;1,5;2\n", r"force\.csv:2:1: got 3 columns, expected two"),
        ("t;F\n0,0;1,5\n1.5;2,5\n", r"force\.csv:3:1: got '1\.5' in a table whose decimals have a comma"),
        ("t;F\n0,0;1.234,5\n", r"force\.csv:2:1: got '1\.234,5', a number with a thousands separator"),
        ("t [s];F [kg]\n0;1\n1;2\n", r"force\.csv:1:1: got 'F \[kg\]', expected a force \[N\]"),
        ("t [s];F [dB]\n0;1\n1;2\n", r"force\.csv:1:1: got levels in dB without their reference"),
        ("t;F\n0;1\nend;2\n", r"force\.csv:3:1: got 'end, 2', expected two numbers"),
    ],
)
def test_csv_files_that_say_nothing(tmp_path: Path, csv: str, told: str) -> None:
    (tmp_path / "force.csv").write_text(csv, encoding="utf-8")
    (tmp_path / "m.yaml").write_text(
        "structure: {type: oscillator, mass: 1 kg, frequency: 5 Hz}\npoints: {m: {}}\n", encoding="utf-8"
    )
    study = tmp_path / "hit.study.yaml"
    study.write_text(
        "model: m.yaml\nloads:\n  push: {at: m.z, file: force.csv}\ntime: {duration: 1 s, sampling: 1 kHz}\n"
    )
    with pytest.raises(InputErrors, match=told):
        read_study(study)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("title: T\nparts:\n\tslab: {}\n", r"m\.yaml:3:1: got broken YAML .*; indent with spaces: YAML has no tabs"),
        ("title: T\nparts: # über\n", r"m\.yaml:1:1: got a character in another encoding \(line 2, byte 0xfc\)"),
    ],
)
def test_tabs_and_encodings_are_named(tmp_path: Path, text: str, told: str) -> None:
    (tmp_path / "m.yaml").write_text(text, encoding="latin-1")
    with pytest.raises(InputErrors, match=told):
        read_study(tmp_path / "m.yaml")
