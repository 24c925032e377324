"""Sags, tilts and modes of blocks that `check` tells, against statics by hand."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import femstruct as fs
from femstruct.cli import app
from femstruct.workflow.bases import Places, Solved, sags
from femstruct.workflow.structure_findings import structure_findings

ROUNDING = 1e-12  # rounding: 2e-15 here at most

G = 9.80665
LEANING = """
parts:
  machine: {type: block, mass: 2 t, origin: [0, 0, 0.3], size: [2, 1, 1], center: [1.05, 0.5, 0.4]}
  mounts:
    type: spring
    between: [feet, ground]
    stiffness: {x: 0.5 MN/m, y: 0.5 MN/m, z: 1 MN/m}
points:
  feet: {on: machine, at: [[0.2, 0.2, 0], [1.8, 0.2, 0], [1.8, 0.8, 0], [0.2, 0.8, 0]]}
damping: {ratio: 3 %}
"""


def told(path: Path) -> dict[str, object]:
    answer = CliRunner().invoke(app, ["check", str(path), "--json"])
    assert answer.exit_code == 0, answer.output
    table: dict[str, object] = json.loads(answer.stdout)
    return table


def test_a_block_with_its_weight_beside_the_middle_leans(tmp_path: Path) -> None:
    """The feet bear the weight and its moment about their middle, 0.05 m of it; they are not pushed sideways."""
    path = tmp_path / "leaning.yaml"
    path.write_text(LEANING)
    table = told(path)
    tilt = 2000 * G * 0.05 / (4 * 1e6 * 0.8**2)
    sag = 2000 * G / 4e6 + tilt * 0.05  # of the centre of mass, which is lower by the tilt
    rest = table["sags"]["machine"]  # type: ignore[index]
    assert rest["tilt_rad"] == pytest.approx(tilt, rel=ROUNDING)
    assert rest["sag_m"] == pytest.approx(sag, rel=ROUNDING)
    assert not table["findings"]
    path.write_text(LEANING.replace("[1.05, 0.5, 0.4]", "[1, 0.53, 0.4]"))  # towards y: it leans about x, span 0.6 m
    rest = told(path)["sags"]["machine"]  # type: ignore[index]
    assert rest["tilt_rad"] == pytest.approx(2000 * G * 0.03 / (4 * 1e6 * 0.3**2), rel=ROUNDING)
    path.write_text(LEANING.replace("[1.05, 0.5, 0.4]", "[1.3, 0.5, 0.4]"))
    table = told(path)
    (finding,) = table["findings"]  # type: ignore[misc]
    assert finding["code"] == "leaning-block"
    assert finding["values"]["tilt_rad"] == pytest.approx(2000 * G * 0.3 / (4 * 1e6 * 0.8**2), rel=ROUNDING)
    answer = CliRunner().invoke(app, ["check", str(path)])
    assert "machine sags" in answer.output
    assert "mm/m" in answer.output


def test_modes_of_a_block_are_named_by_what_moves(tmp_path: Path) -> None:
    path = tmp_path / "level.yaml"
    path.write_text(LEANING.replace("center: [1.05, 0.5, 0.4]", "center: [1, 0.5, 0.5]"))
    modes = told(path)["block_modes"]
    assert len(modes) == 6  # type: ignore[arg-type]
    heave = next(mode for mode in modes if "machine z" in mode["shares"])  # type: ignore[attr-defined]
    assert heave["shares"]["machine z"] == pytest.approx(1.0, rel=ROUNDING)
    assert heave["frequency_hz"] == pytest.approx(np.sqrt(4e6 / 2000) / (2 * np.pi), rel=ROUNDING)
    assert heave["damping_ratio"] == pytest.approx(0.03)
    for mode in modes:  # type: ignore[attr-defined]
        assert sum(mode["shares"].values()) == pytest.approx(1.0, abs=0.1)  # those under 5 % are not told


def test_what_nothing_holds_up_has_no_sag(tmp_path: Path) -> None:
    path = tmp_path / "free.yaml"
    path.write_text(LEANING.replace(", z: 1 MN/m", ""))
    table = told(path)
    assert table["sags"] == {}
    path.write_text("parts: {stone: {type: block, mass: 2000, origin: [0, 0, 0], size: [1, 1, 1]}}")
    table = told(path)
    assert table["sags"] == {}
    assert table["rigid_body_modes"] == 6


def test_a_sag_does_not_depend_on_how_many_modes_there_are() -> None:
    """A heavy block on stiff springs below a light one on soft springs: the first mode is of the light one alone."""
    floor = fs.Block("floor", 1000.0, origin=(0.0, 0.0, 0.0), size=(1.0, 1.0, 1.0))
    ceiling = fs.Block("ceiling", 1.0, origin=(0.0, 0.0, 2.0), size=(1.0, 1.0, 1.0))
    points = tuple(
        fs.PlaceOn(name, on, at=((0.5, 0.5, z),))
        for name, on, z in (("foot", "floor", 0.0), ("top", "floor", 1.0), ("low", "ceiling", 0.0))
    )
    stiff = fs.Spring("stiff", "foot", None, stiffness=(1e7,) * 6)
    soft = fs.Spring("soft", "low", "top", stiffness=(1e3,) * 6)
    structure = fs.Structure("two", (floor, ceiling, stiff, soft), points=points)
    model = fs.mesh_structure(structure)
    found = {one.part: one.sag for one in sags(model, fs.modal_basis(fs.assemble(model), count=1))}
    assert found["floor"] == pytest.approx(1001.0 * G / 1e7, rel=1e-9)  # rounding of stiffnesses 1e4 apart
    assert found["ceiling"] == pytest.approx(1001.0 * G / 1e7 + G / 1e3, rel=1e-9)  # the same
    free = replace(structure, parts=(floor, ceiling, replace(stiff, stiffness=(0.0, 0.0, 1e7, 0.0, 0.0, 0.0)), soft))
    loose = fs.mesh_structure(free)
    assert not sags(loose, fs.modal_basis(fs.assemble(loose), count=6))  # those at 0 Hz and of the ceiling
    all_modes = sags(loose, fs.modal_basis(fs.assemble(loose), count=12))
    assert {one.part: one.sag for one in all_modes}["floor"] == pytest.approx(1001.0 * G / 1e7, rel=1e-9)  # the same


def test_what_sags_far_is_judged_without_the_air_of_cavities() -> None:
    """A block of 1 t on a spring of 1 kN/m sags by 9.8 m, whatever air holds while it vibrates; it is free to slide."""
    block = fs.Block("block", 1000.0, origin=(0.0, 0.0, 0.0), size=(1.0, 1.0, 1.0))
    foot = fs.PlaceOn("foot", "block", at=((0.5, 0.5, 0.0),))
    spring = fs.Spring("spring", "foot", None, stiffness=(0.0, 0.0, 1e3, 1e9, 1e9, 1e9))
    structure = fs.Structure("one", (block, spring), points=(foot,))
    model = fs.mesh_structure(structure)
    vacuo = fs.modal_basis(fs.assemble(model), count=6)
    air = replace(vacuo, omega=100.0 * vacuo.omega)
    told = structure_findings(Solved("one", structure, model, Places(model.points, {}), vacuo), air)
    (far,) = [one for one in told if one.code == "sags-far"]
    assert far.values["sag_m"] == pytest.approx(1000.0 * G / 1e3, rel=1e-6)  # rounding of stiffnesses 1e6 apart


HANG = "links: {sp: {between: [tmd, corner], frequency: 4 Hz, ratio: 10 %}}\ncontacts:\n"
LIE = "contacts:\n  lie: {between: [tmd, corner], law: {type: hertz, stiffness: 1e9}}\n"
LADEN = """model: m.yaml
modes: {count: 6}
bodies: {tmd: {mass: 0.3 t, above: corner}, on: {mass: 0.2 t, above: tmd}}
record: {tmd: displacement}
time: {duration: 10 ms, sampling: 4 kHz, gravity: GRAVITY}
HELD  c: {between: [on, tmd], law: {type: hertz, stiffness: 1e9}}
"""


@pytest.mark.parametrize("gravity", ["true", "false"])
@pytest.mark.parametrize("held", [HANG, LIE])
def test_what_hangs_or_lies_on_a_structure_sags_it(tmp_path: Path, held: str, gravity: str) -> None:
    """2 t on four springs of 1 MN/m at (+-0.8, +-0.3) m, 0.5 t on a corner at (1, 0.5) m of the middle: heave by all of
    it, angles by its moments over k x^2 and k y^2. It had the weight of the structure alone."""
    model = LEANING.replace("[1.05, 0.5, 0.4]", "[1, 0.5, 0]").replace("x: 0.5 MN/m, y: 0.5 MN/m", "x: 1e12, y: 1e12")
    model = model.replace("points:", "points:\n  corner: {on: machine, at: [2, 1, 0]}")
    (tmp_path / "m.yaml").write_text(model, encoding="utf-8")
    study = LADEN.replace("GRAVITY", gravity).replace("HELD", held)
    (tmp_path / "s.study.yaml").write_text(study, encoding="utf-8")
    sag = told(tmp_path / "s.study.yaml")["sags"]["machine"]
    assert sag["sag_m"] == pytest.approx(2500.0 * G / 4e6, rel=1e-6)  # the springs' 1e12 N/m sideways
    turned = np.hypot(500.0 * G * 1.0 / (4e6 * 0.8**2), 500.0 * G * 0.5 / (4e6 * 0.3**2))
    assert sag["tilt_rad"] == pytest.approx(turned, rel=1e-5)  # the same
