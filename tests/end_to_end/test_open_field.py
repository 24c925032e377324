"""A slab in a baffle, heard in the open: pressures in time and frequency, and what is no half space."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from femstruct.errors import InputErrors
from femstruct.language.cases import read_study
from femstruct.workflow.check import inspect_file
from femstruct.workflow.run import run_study

STUDY = """
model: plate.yaml
modes: {up_to: 1 kHz}
loads: {push: {at: P.z, half_sine: {amplitude: -10 N, frequency: 60 Hz}}}
record: {P.z: acceleration}
time: {duration: 500 ms, sampling: 12 kHz}
frf: {mic: {drive: P.z, response: open.mic.pressure, kind: pressure, band: [5 Hz, 300 Hz], step: 5 Hz}}
rooms:
  open: {KEY: low, receivers: {mic: [0.1, 0.2, -2]}}
  roof: {above: top, receivers: {mic: [0.1, 0.2, 2]}}
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "plate.yaml").write_text(
        """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
parts: {plate: {type: plate, material: steel, thickness: 3 mm, origin: [1, 2, 0.3], size: [0.5, 0.4], mesh: [10, 8]}}
supports: {edges: {on: plate, edge: all, fix: simple}}
points: {P: {on: plate, at: [0.2, 0.15]}}
surfaces: {low: {on: plate, side: below}, top: {on: plate, side: above}}
damping: {ratio: 5 %}
"""
    )
    return tmp_path


def study(folder: Path, key: str = "below", mic: str = "[0.1, 0.2, -2]") -> Path:
    path = folder / "hit.study.yaml"
    path.write_text(STUDY.replace("KEY", key).replace("[0.1, 0.2, -2]", mic))
    return path


def test_both_sides_and_both_domains(folder: Path) -> None:
    case = run_study(read_study(study(folder))).cases["as given"]
    assert case.response is not None
    below, above = case.rooms["open"].p[0], case.rooms["roof"].p[0]
    assert np.abs(below + above).max() < 1e-9 * np.abs(below).max()  # pushed down: pressed below, thinned above
    early = case.response.t < 2.0 / 343.0 - 5e-4  # before sound from the nearest point of the plate is there
    # 2 %: what the sampling makes of the start of the push, where the acceleration jumps
    assert np.abs(below[early]).max() < 0.02 * np.abs(below).max()
    assert np.abs(below[case.response.t < 2.0 / 343.0 + 2e-3]).max() > 0.05 * np.abs(below).max()
    # the record has decayed: its spectrum is the response per force times the force's
    answer = case.frf["mic"]
    assert answer.unit == "Pa/N"
    t = case.response.t
    push = np.where(t < 1 / 120, -10 * np.sin(2 * np.pi * 60 * t), 0.0)
    kernel = np.exp(-2j * np.pi * np.outer(answer.frequency_hz, t)) / 12e3
    heard, wanted = kernel @ below, (kernel @ push) * answer.values
    assert np.abs(heard - wanted).max() < 3e-3 * np.abs(wanted).max()  # the start of the push, between samples


def test_check_tells_of_open_air(folder: Path) -> None:
    rooms = inspect_file(study(folder)).table()["rooms"]
    assert rooms["open"] == {"side": "below", "receivers_m": {"mic": [0.1, 0.2, -2.0]}}
    assert rooms["roof"]["side"] == "above"


@pytest.mark.parametrize(
    ("key", "mic", "told"),
    [
        ("below", "[0, 0, 2]", r"receivers\.mic: got \[0\.0, 0\.0, 2\.0\] m, expected a point below the surface"),
        ("above", "[0, 0, 2]", "expected a normal that points up"),
        ("size: [1, 1, 1], below", "[0, 0, -2]", "'size' beside 'below'"),
        ("coupling: two-way, below", "[0, 0, -2]", "'coupling' beside 'below'"),
        ("under", "[0, 0, -2]", "size, mesh"),
        ("above: top, below", "[0, 0, -2]", "under, above, below"),
        ("below: lo, air: {c: 340}} #", "[0, 0, -2]", "did you mean 'low'"),
    ],
)
def test_what_is_wrong_is_said(folder: Path, key: str, mic: str, told: str) -> None:
    with pytest.raises(InputErrors, match=told) as refused:
        inspect_file(study(folder, key, mic))
    assert "hit.study.yaml:" in str(refused.value)
