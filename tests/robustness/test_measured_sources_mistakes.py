"""Measured sources that are written wrongly: one clear line each, with its place."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from femstruct.errors import FemstructError, InputErrors
from femstruct.language.cases import read_study
from femstruct.workflow.bases import with_positions
from femstruct.workflow.run import run_study

PLATE = """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
parts: {plate: {type: plate, material: steel, thickness: 4 mm, origin: [0, 0, 1], size: [0.5, 0.4], mesh: 100 mm}}
supports: {edges: {on: plate, edge: all, fix: simple}}
points: {feet: {on: plate, at: [[0.15, 0.1], [0.35, 0.25]]}, rim: {on: plate, at: [0, 0]}}
"""
FORCE = "blocked_force: {50 Hz: 1 N}"
LINES = {
    "neither force nor velocity": ("at: feet.z, mass: 1 kg", r"none of blocked_force, free_velocity"),
    "no mobility": (f"at: feet.z, {FORCE}", r"none of mobility, impedance, mass, expected exactly one"),
    "two mobilities": (f"at: feet.z, {FORCE}, mass: 1 kg, mobility: infinite", r"both mobility and mass"),
    "no point": (f"at: foot.z, {FORCE}, mass: 1 kg", r"sources\.pump\.at: got 'foot\.z', expected a direction"),
    "no direction": (f"at: feet, {FORCE}, mass: 1 kg", r"sources\.pump\.at: got 'feet'"),
    "a rotation": (f"at: feet.1.rx, {FORCE}, mass: 1 kg", r"'feet\.1\.rx', a rotation, expected a direction"),
    "a level without reference": (
        "at: feet.z, blocked_force: {50 Hz: 80 dB}, mass: 1 kg",
        r"blocked_force: got levels in dB without their reference.*'dB re 1e-6 N'",
    ),
    "another dimension": (
        "at: feet.z, blocked_force: {50 Hz: 1 m/s}, mass: 1 kg",
        r"blocked_force: got '1 m/s', which is a speed, expected a force",
    ),
    "no band": ("at: feet.z, blocked_force: {70 Hz: 1 N}, mass: 1 kg", r"a band at 70 Hz, expected nominal centres of"),
    "thirds as octaves": (
        "at: feet.z, bands: octave, blocked_force: {50 Hz: 1 N}, mass: 1 kg",
        r"a band at 50 Hz, expected nominal centres of octaves",
    ),
    "a band twice": (
        "at: feet.z, blocked_force: {50 Hz: 1 N, 50: 2 N}, mass: 1 kg",
        r"blocked_force: got 50 Hz twice, expected each frequency once",
    ),
    "one number": ("at: feet.z, blocked_force: 3 N, mass: 1 kg", r"got '3 N', expected values by band"),
    "velocity of infinite mobility": (
        "at: feet.z, free_velocity: {50 Hz: 1 mm/s}, mobility: infinite",
        r"got a free velocity of a source of infinite mobility",
    ),
    "an active source": (f"at: feet.z, {FORCE}, mobility: {{lines: active.csv}}", r"active\.csv:1:1: got a real part"),
    "two columns": (f"at: feet.z, {FORCE}, mobility: {{lines: two.csv}}", r"two\.csv:2:1: got 2 columns, expect"),
    "no file": ("at: feet.z, blocked_force: {file: none.csv}, mass: 1 kg", r"blocked_force: got no file '.*none\.csv'"),
    "different bands": (
        "at: feet.z, blocked_force: [{50 Hz: 1 N}, {63 Hz: 1 N}], mass: 1 kg",
        r"spectra of contacts in different bands",
    ),
}  # fmt: skip
RUNS = {
    "three spectra": (
        "at: feet.z, blocked_force: [{50 Hz: 1 N}, {50 Hz: 1 N}, {50 Hz: 1 N}], mass: 1 kg",
        r"a\.study\.yaml:5:3: sources\.pump: got 3 spectra for 2 contacts, expected one for all, or one for each",
    ),
    "a contact twice": (
        "at: [feet.z, feet.2.z], blocked_force: {50 Hz: 1 N}, mass: 1 kg",
        r"a\.study\.yaml:5:\d+: sources\.pump\.at: got 'feet\.2\.z' twice, expected each contact once",
    ),
    "a mobility elsewhere": (
        "at: feet.z, blocked_force: {50 Hz: 1 N}, mobility: {200 Hz: 1e-4 m/s/N, 250 Hz: 1e-4 m/s/N}",
        r"a mobility from 141\.4 to 353\.6 Hz beside a band at 50 Hz",
    ),
    "a held place": ("at: rim.z, blocked_force: {50 Hz: 1 N}, mass: 1 kg", r"'rim\.z', which no mode moves"),
    "no damping": (
        "at: feet.z, blocked_force: {100 Hz: 1 N}, mass: 1 kg",
        r"1 of the modes from 89\.1\d+ to 112\.2\d* Hz without damping",
    ),
}


def written(folder: Path, source: str, damping: str = "damping: {loss_factor: 3 %}\n") -> Path:
    (folder / "model.yaml").write_text(PLATE + damping, encoding="utf-8")
    (folder / "active.csv").write_text("f;Re;Im\n40;-1;0\n90;-1;0\n", encoding="utf-8")
    (folder / "two.csv").write_text("f;Re\n40;1\n90;1\n", encoding="utf-8")
    path = folder / "a.study.yaml"
    path.write_text(
        f"title: T\nmodel: model.yaml\nmodes: {{up_to: 700 Hz}}\nsources:\n  pump: {{{source}}}\n", encoding="utf-8"
    )
    return path


@pytest.mark.parametrize("name", LINES)
def test_a_mistake_is_one_line(name: str, tmp_path: Path) -> None:
    source, told = LINES[name]
    with pytest.raises(InputErrors) as caught:
        read_study(written(tmp_path, source))
    (line,) = caught.value.errors
    assert re.search(told, line), line
    assert re.match(r"\S+\.(yaml|csv):\d+:\d+: ", line), line


@pytest.mark.parametrize("name", RUNS)
def test_what_modes_and_meshes_show_is_one_line_too(name: str, tmp_path: Path) -> None:
    source, told = RUNS[name]
    damping = "" if name == "no damping" else "damping: {loss_factor: 3 %}\n"
    plan = read_study(written(tmp_path, source, damping))
    with pytest.raises(FemstructError) as caught, with_positions(plan):
        run_study(plan)
    assert re.search(told, str(caught.value)), caught.value
