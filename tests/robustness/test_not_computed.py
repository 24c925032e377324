"""Motion of the base in time and parts that fall are answered by name where they are written, and what the answers say
to write instead gives the right numbers."""

from __future__ import annotations

from math import pi, sqrt
from pathlib import Path

import numpy as np
import pytest

from femstruct.errors import FemstructError
from femstruct.language.cases import read_study
from femstruct.study.results import CaseResult
from femstruct.workflow.run import run_study
from tests.independent.vibration import shock_spectrum

BLOCK = """
parts:
  machine: {type: block, mass: 10 kg, origin: [0, 0, 0], size: [0.1, 0.1, 0.1]MORE}
  FEET
points: {foot: {on: machine, at: [0.05, 0.05, 0]}, m: {on: machine, at: [0.05, 0.05, 0.05]}OTHERS}
damping: {ratio: 5 %}
"""
STIFF = "stiffness: {x: 1 MN/m, y: 1 MN/m, z: 1 MN/m, rx: 1e5, ry: 1e5, rz: 1e5}"
STANDS = f"feet: {{type: spring, between: [foot, ground], {STIFF}}}"
STUDY = "model: model.yaml\nmodes: {count: 6}\nrecord: {m.z: acceleration}\n"
TIME = "time: {duration: 1 s, sampling: 2 kHz"
PUSH = "half_sine: {amplitude: 1 N, frequency: 9 Hz}"
BASE = [
    f"base: {{z: quake.csv}}\n{TIME}}}\n",
    f"ground_motion: quake.csv\n{TIME}}}\n",
    f"{TIME}, base: quake.csv}}\n",
    f"loads: {{quake: {{base: z, file: quake.csv}}}}\n{TIME}}}\n",
    f"loads: {{quake: {{at: ground.z, {PUSH}}}}}\n{TIME}}}\n",
    f"loads: {{quake: {{at: m.z, acceleration: quake.csv}}}}\n{TIME}}}\n",
    f"initial: {{velocity: {{ground.z: 1 m/s}}}}\n{TIME}}}\n",
    "vibration: {quake: {base: z, file: quake.csv}}\n",
    f"vibration: {{shock: {{base: z, {PUSH}}}}}\n",
]
FALLS = [
    f"initial: {{drop_height: 1 m}}\n{TIME}}}\n",
    f"initial: {{rigid: {{about: m, drop_height: 1 m}}}}\n{TIME}}}\n",
    f"bodies: {{machine: {{above: ground, drop_height: 1 m}}}}\n{TIME}}}\n",
    f"bodies: {{m1: {{part: machine, above: ground, drop_height: 1 m}}}}\n{TIME}}}\n",
]


def run(folder: Path, study: str, feet: str = STANDS, more: str = "", others: str = "") -> CaseResult:
    model = BLOCK.replace("FEET", feet).replace("MORE", more).replace("OTHERS", others)
    (folder / "model.yaml").write_text(model, encoding="utf-8")
    path = folder / "s.study.yaml"
    path.write_text(STUDY + study, encoding="utf-8")
    return run_study(read_study(path)).cases["as given"]


@pytest.mark.parametrize("study", BASE)
def test_motion_of_the_base_in_time_is_answered_by_name(tmp_path: Path, study: str) -> None:
    with pytest.raises(
        FemstructError, match=r"motion of the base in time is not computed: .*loads: \{shock.*base: z, \.\.\}\}'$"
    ):
        run(tmp_path, study)


@pytest.mark.parametrize("study", FALLS)
def test_parts_that_fall_are_answered_by_name(tmp_path: Path, study: str) -> None:
    with pytest.raises(FemstructError, match=r"parts do not fall: .*initial: \{rigid.*drop_height: 1 m\}\}'"):
        run(tmp_path, study)


@pytest.mark.parametrize("more", [", drop_height: 1 m", ", falls: true", ", speed: 1 m/s"])
def test_a_part_that_falls_in_the_model_is_answered_by_name(tmp_path: Path, more: str) -> None:
    with pytest.raises(FemstructError, match="parts do not fall"):
        run(tmp_path, f"{TIME}}}\n", more=more)


def test_a_part_that_gravity_would_let_fall_is_told_what_to_write(tmp_path: Path) -> None:
    contact = "contacts: {floor: {between: [foot, ground], gap: 1 m, law: {type: linear, stiffness: 1 MN/m}}}\n"
    case = run(tmp_path, f"{contact}{TIME}, gravity: true}}\n", feet="")
    (told,) = [one for one in case.findings if one.code == "nothing-carries-weight"]
    assert told.severe and "initial: {rigid: {about: POINT, velocity: [0, 0, -4.43 m/s]}}" in told.message


def test_a_heavy_block_in_place_of_the_ground_is_a_base_that_moves(tmp_path: Path) -> None:
    """15 g of 45 Hz under an oscillator of 50.3 Hz, damped by 5 %, against one on a base."""
    table = "table: {type: block, mass: 10 t, origin: [-0.5, -0.5, -1], size: [1.1, 1.1, 1]}"
    feet = f"feet: {{type: spring, between: [foot, top], {STIFF}}}\n  {table}"
    top = ", top: {on: table, at: [0.55, 0.55, 1]}, centre: {on: table, at: [0.55, 0.55, 0.5]}"
    push = 10e3 * 15.0 * 9.80665
    load = f"loads: {{shock: {{at: centre.z, half_sine: {{amplitude: {push} N, frequency: 45 Hz}}}}}}\n"
    found = run(tmp_path, f"{load}time: {{duration: 0.1 s, sampling: 20 kHz}}\n", feet, others=top)
    step = 1.0 / 45.0 / 2.0 / 500.0
    base = 15.0 * 9.80665 * np.sin(2.0 * pi * 45.0 * step * np.arange(501))
    up, down = shock_spectrum(np.append(base, 0.0), step, np.array([sqrt(1e6 / 10.0) / 2.0 / pi]), 0.05)
    # of 1000 times the mass: what stands on it moves it by a thousandth
    assert found.channels["m.z acceleration"].whole == pytest.approx(max(up[0], down[0]), rel=2e-3)


def test_a_structure_with_its_speed_strikes_as_if_it_had_fallen(tmp_path: Path) -> None:
    """10 kg from 1 m on 1 MN/m: v sqrt(k m)."""
    contact = "contacts: {floor: {between: [foot, ground], law: {type: linear, stiffness: 1 MN/m}}}\n"
    start = "initial: {rigid: {about: m, velocity: [0, 0, -4.43 m/s]}}\n"
    case = run(tmp_path, f"{contact}{start}time: {{duration: 0.1 s, sampling: 20 kHz}}\n", feet="")
    assert case.response is not None
    # the three digits of the speed
    assert case.response.contacts["floor"].peak_force == pytest.approx(sqrt(2.0 * 9.80665 * 1e6 * 10.0), rel=1e-3)
