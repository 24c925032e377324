"""Contacts of a structure without bodies: which axis they act along, against the energy at the turn."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from femstruct.errors import InputError
from femstruct.language.cases import read_study
from femstruct.study.results import CaseResult
from femstruct.workflow.run import run_study

BUMPED = """model: model.yaml
modes: {count: 6}
initial: {velocity: {middle.z: -1 m/s}}
contacts: {bump: {between: [middle, ground], gap: 1 mm, law: {type: linear, stiffness: 1 MN/m}}}
record: {bump: force}
time: {duration: 20 ms, sampling: 20 kHz}
"""
BLOCK = """parts:
  block: {type: block, mass: 10 kg, origin: [0, 0, 0], size: [0.1, 0.1, 0.1]}
  feet: {type: spring, between: [foot, ground], stiffness: {x: 20 kN/m, y: 20 kN/m, z: 40 kN/m}}
points:
  foot: {on: block, at: [[0.02, 0.02, 0], [0.08, 0.02, 0], [0.08, 0.08, 0], [0.02, 0.08, 0]]}
  middle: {on: block, at: [0.05, 0.05, 0.05]}
damping: {ratio: 0 %}
"""
SIDEWAYS = "frf: {aside: {drive: middle.x, response: middle.x, kind: mobility, band: [1 Hz, 50 Hz], step: 1 Hz}}\n"
PUSHED = "loads: {aside: {at: middle.x, half_sine: {amplitude: 1 N, frequency: 20 Hz}}}\n"


def bumped(folder: Path, more: str) -> CaseResult:
    (folder / "model.yaml").write_text(BLOCK, encoding="utf-8")
    (folder / "bump.study.yaml").write_text(BUMPED + more, encoding="utf-8")
    return run_study(read_study(folder / "bump.study.yaml")).cases["as given"]


@pytest.mark.parametrize("more", ["", SIDEWAYS])
def test_a_bumper_stands_in_the_way_of_what_starts(tmp_path: Path, more: str) -> None:
    """At the turn springs and bumper hold all energy: m v^2 = K x^2 + k (x - gap)^2. A response along x that is asked
    for beside turns nothing."""
    mass, feet, bump, gap = 10.0, 160e3, 1e6, 1e-3
    deepest = float(np.roots([feet + bump, -2.0 * bump * gap, bump * gap**2 - mass]).max())
    found = bumped(tmp_path, more).response
    assert found.contacts["bump"].peak_force == pytest.approx(bump * (deepest - gap), rel=1e-9)  # rounding of the modes


def test_a_bumper_that_may_stand_along_two_axes_is_refused(tmp_path: Path) -> None:
    """A push of 1 N along x turned it by a quarter: it was never touched, and nothing said so. A body tells."""
    with pytest.raises(InputError, match=r"contacts\.bump: got starts and loads along x and along z"):
        bumped(tmp_path, PUSHED)
    one, two = (bumped(tmp_path, more) for more in ("", f"{PUSHED}bodies: {{marker: {{mass: 1 g, above: middle}}}}\n"))
    before, after = (case.response.contacts["bump"].peak_force for case in (one, two))
    assert after == pytest.approx(before, rel=1e-9)  # rounding: x and z of a block on its middle are apart


@pytest.mark.parametrize(("velocity", "where"), [("[-1, 0, 0]", "[0, 0.05, 0.05]"), ("[0, 0, -1]", "[0.05, 0.05, 0]")])
def test_what_flies_as_a_whole_meets_its_buffer(tmp_path: Path, velocity: str, where: str) -> None:
    """v sqrt(k m), along x as along z; a block that flew along x went through its buffer, and nothing said so."""
    block = BLOCK.splitlines()[1]
    points = f"points: {{nose: {{on: block, at: {where}}}, middle: {{on: block, at: [0.05, 0.05, 0.05]}}}}\n"
    (tmp_path / "model.yaml").write_text(f"parts:\n{block}\n{points}damping: {{ratio: 0 %}}\n", encoding="utf-8")
    start = f"initial: {{rigid: {{about: middle, velocity: {velocity}}}}}"
    text = BUMPED.replace("initial: {velocity: {middle.z: -1 m/s}}", start).replace(
        "[middle, ground]", "[nose, ground]"
    )
    (tmp_path / "bump.study.yaml").write_text(text, encoding="utf-8")
    found = run_study(read_study(tmp_path / "bump.study.yaml")).cases["as given"].response
    assert found.contacts["bump"].peak_force == pytest.approx(np.sqrt(1e6 * 10.0), rel=1e-9)  # rounding of the modes
