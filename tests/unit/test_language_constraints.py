"""Constraints as they are written: keys reach the noun, mistakes have their place."""

from __future__ import annotations

from pathlib import Path

import pytest

from femstruct.conventions import DIRECTIONS
from femstruct.errors import InputErrors
from femstruct.language.models import read_model
from femstruct.model.constraints import Average, Equation, RigidLink
from femstruct.model.regions import Region

MODEL = """
materials:
  steel: {E: 210 GPa, nu: 0.3, rho: 7850 kg/m^3}
parts:
  floor: {type: plate, material: steel, thickness: 8 mm, origin: [0, 0, 0], size: [1, 0.8], mesh: [10, 8]}
  machine: {type: block, mass: 30 kg, origin: [0.3, 0.3, 0.1], size: [0.2, 0.2, 0.2]}
points:
  foot: {on: machine, at: [0.1, 0.1, 0]}
  head: {on: machine, at: [0.1, 0.1, 0.2]}
  bolts: {on: floor, at: [[0.3, 0.3], [0.5, 0.3], [0.4, 0.5]]}
  far: {on: floor, at: [0.9, 0.7]}
constraints:
  seat: {average: foot, of: bolts}
  rod: {equation: {head.z: 1, far.z: -0.5}}
"""


def read(folder: Path, seat: str = "", rod: str = "") -> tuple[object, ...]:
    text = MODEL.replace("{average: foot, of: bolts}", seat or "{average: foot, of: bolts}")
    path = folder / "model.yaml"
    path.write_text(text.replace("{equation: {head.z: 1, far.z: -0.5}}", rod or "{equation: {head.z: 1, far.z: -0.5}}"))
    return read_model(path).structure.constraints


def test_every_key_reaches_the_noun(tmp_path: Path) -> None:
    assert read(tmp_path) == (Average("seat", "foot", ("bolts",)), Equation("rod", {"head.z": 1.0, "far.z": -0.5}))
    seat, _ = read(tmp_path, "{rigid: head, to: [far, bolts.2], directions: [z, rx]}")
    assert seat == RigidLink("seat", "head", ("far", "bolts.2"), directions=("z", "rx"))
    seat, _ = read(tmp_path, "{average: foot, of: {on: floor, rectangle: [0.2, 0.1], at: [0.4, 0.4]}}")
    region = Region("rectangle", (0.2, 0.1), (0.4, 0.4))
    assert seat == Average("seat", "foot", (), "floor", region, DIRECTIONS)


@pytest.mark.parametrize(
    ("seat", "told"),
    [
        ("{average: foot}", "13:9: constraints.seat: got average without of, expected 'of' beside 'average'"),
        ("{of: bolts}", "constraints.seat: got none of rigid, average, equation"),
        ("{rigid: foot, average: foot, of: bolts, to: far}", "constraints.seat: got both rigid and average"),
        ("{rigid: foot, of: bolts}", "constraints.seat: got rigid without to"),
        ("{average: fot, of: bolts}", "13:19: constraints.seat.average: got 'fot', expected the name of a point"),
        ("{average: foot, of: [bolt]}", "constraints.seat.of[0]: got 'bolt', expected the name of a point"),
        ("{average: bolts, of: [foot]}", "constraints.seat.average: got 'bolts', which has 3 places"),
        ("{average: foot, of: 5}", "constraints.seat.of: got 5, expected names of points, or a region of a part"),
        ("{average: foot, of: {on: flor}}", "constraints.seat.of.on: got 'flor', expected the name of a part"),
        ("{average: foot, of: {on: floor, hole: 3}}", "constraints.seat.of.hole: got the unknown key 'hole'"),
        ("{rigid: foot, to: {on: floor, line: [[0, 0], [1, 0]]}}", "got a region of floor, expected a set or a box"),
        ("{average: foot, of: bolts, directions: [w]}", "constraints.seat.directions: got 'w', expected one of x"),
        ("{equation: {foot.z: 1}}", "constraints.seat.equation: got 1 term, expected two or more"),
        ("{equation: {foot.z: 1, fa.z: -1}}", "constraints.seat.equation.fa.z: got 'fa.z', expected"),
        ("{equation: {foot.z: 1, far.q: -1}}", "constraints.seat.equation.far.q: got 'far.q', expected"),
        ("{equation: {foot.z: 1, far.z: 0}}", "constraints.seat.equation: got 0 for far.z, expected a factor"),
        ("{equation: {foot.z: 1, far.z: -1}, directions: [z]}", "constraints.seat: got both directions and equation"),
        ("{seam: {on: floor}, onto: {on: floor, set: a}}", "constraints.seat.seam: got no nodes of a mesh"),
        ("{seam: {on: floor, set: a}}", "constraints.seat: got seam without onto"),
        ("{rigid: foot, to: [foot]}", "constraints.seat.to: got 'foot' itself, expected other points"),
    ],
)
def test_a_mistake_is_one_clear_line(tmp_path: Path, seat: str, told: str) -> None:
    with pytest.raises(InputErrors) as caught:
        read(tmp_path, seat)
    assert told in str(caught.value)
    assert len(caught.value.errors) == 1
