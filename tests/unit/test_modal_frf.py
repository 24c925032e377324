"""Frequency responses: their units, what cannot be driven or heard, and rigid modes with damping."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from femstruct.errors import InputError
from femstruct.language.models import read_model
from femstruct.modal.closed_form import beam, rod
from femstruct.modal.damping import Damping, LossFactor, Rayleigh, with_damping
from femstruct.modal.frf import frf, frf_unit
from femstruct.workflow.model_answers import frf_of

# kind, drive, response, unit: by the dimension of displacement or angle over force or moment
UNITS = [
    ("receptance", "z", "z", "m/N"),
    ("receptance", "z", "rx", "rad/N"),
    ("receptance", "rx", "z", "m/(N m)"),
    ("mobility", "n", "x", "m/(N s)"),
    ("mobility", "rx", "ry", "rad/(N m s)"),
    ("accelerance", "z", "z", "m/(N s^2)"),
    ("accelerance", "rx", "rx", "rad/(N m s^2)"),
    ("accelerance", "rz", "y", "m/(N m s^2)"),
    ("transmissibility", "z", "force", "1"),
    ("transmissibility", "rx", "force_z", "1/m"),
    ("transmissibility", "rx", "ry", "1"),
    ("transmissibility", "rx", "z", "m/rad"),
]


@pytest.mark.parametrize(("kind", "drive", "response", "unit"), UNITS)
def test_units(kind, drive, response, unit):
    assert frf_unit(kind, drive, response) == unit


@pytest.mark.parametrize("law", [Rayleigh(1.0, 1e-5), LossFactor(0.02)])
def test_the_ground_force_of_a_pinned_free_beam_with_damping(law):
    """A rigid mode has no loss at omega = 0 and takes no part in a hysteretic force."""
    basis, points = beam(0.4, 5.9, 0.3, ("pinned", "free"), 5, points={"tip": 0.4})
    damped = with_damping(basis, Damping(law))
    here = points["tip"].probe("z")
    force = frf(damped, here, damped.outputs["ground.z"], [1.0, 50.0], "transmissibility")
    alone = replace(damped, kind=("elastic",) * 5, omega=np.maximum(damped.omega, 1e-6))  # a spring next to none
    soft = frf(alone, here, damped.outputs["ground.z"], [1.0, 50.0], "transmissibility")
    assert np.isfinite(force).all()
    assert force == pytest.approx(soft, rel=1e-13)  # rounding: none here


@pytest.mark.parametrize("direction", ["y", "z", "rx"])
def test_a_rod_has_no_response_across_its_axis(direction):
    basis, points = rod(2.0, 206e9, 7850.0, 3.14e-4, 4, points={"tip": 2.0})
    along, across = points["tip"].probe("x"), points["tip"].probe(direction)
    assert np.abs(frf(basis, along, along, [100.0])).min() > 0
    with pytest.raises(InputError, match="frf drive: got a direction without motion in any mode"):
        frf(basis, across, along, [100.0])
    with pytest.raises(InputError, match="frf response: got a direction without motion in any mode"):
        frf(basis, along, across, [100.0])


PLATE = """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
parts:
  plate: {type: plate, material: steel, thickness: 3 mm, origin: [0, 0, 0], size: [0.5, 0.4], mesh: [6, 6]}
points: {middle: {on: plate, at: center}, off: {on: plate, at: [0.1, 0.1]}}
supports: {edges: {on: plate, edge: all, fix: clamped}}
"""


def test_directions_by_name(tmp_path):
    path = tmp_path / "plate.yaml"
    path.write_text(PLATE, encoding="utf-8")
    asked = {"band": "10 Hz:20 Hz", "step": "10 Hz", "kind": "accelerance", "method": "modal"}
    with pytest.raises(InputError, match=r"--drive: got 'middle.x', no mode moves along x"):
        frf_of(path, "middle.x", "middle.z", **asked)
    with pytest.raises(InputError, match=r"--response: got 'middle.x', no mode moves along x"):
        frf_of(path, "middle.z", "middle.x", **asked)
    assert frf_of(path, "off.rx", "off.rx", **asked)["unit"] == "rad/(N m s^2)"
    assert np.abs(frf_of(path, "middle.rx", "middle.rx", **asked)["real"]).min() > 0  # residual vectors turn it


FRAME = """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
sections: {bar: {shape: rectangle, width: 20 mm, height: 30 mm}}
parts:
  bar: {type: frame, material: steel, section: bar, mesh: 0.1 m, lines: [[[0, 0, 0], [0.9, 0, 0], [0.9, 0.3, 0]]]}
  paint: {type: mass, mass: MASS, on: bar}
"""


@pytest.mark.parametrize(("mass", "kind"), [("2 kg/m", "length"), ("2.4 kg", "total")])
def test_mass_along_a_frame_is_read(tmp_path, mass, kind):
    path = tmp_path / "frame.yaml"
    path.write_text(FRAME.replace("MASS", mass), encoding="utf-8")
    parts = {part.name: part for part in read_model(path).structure.parts}
    assert parts["paint"].per == kind


@pytest.mark.parametrize(
    ("mass", "message"),
    [
        ("2 kg/m^2", "got a mass in kg/m\\^2 along a frame, expected kg or kg/m"),
        ("2 kg, region: {rectangle: [1, 1]}", "expected all of the frame"),
    ],
)
def test_what_no_frame_carries(tmp_path, mass, message):
    path = tmp_path / "frame.yaml"
    path.write_text(FRAME.replace("MASS", mass), encoding="utf-8")
    with pytest.raises(InputError, match=message):
        read_model(path)
