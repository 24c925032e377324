"""Blocks and layers as they are written: every key reaches the noun, every mistake has its place."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from femstruct.cli import app
from femstruct.errors import InputErrors
from femstruct.language.models import read_model, read_model_file
from femstruct.language.parts import BlockSpec, PlateSpec, SpringSpec
from femstruct.model.regions import Region
from femstruct.model.structure import PlaceOn, Structure
from femstruct.parts.block import Block
from femstruct.parts.foundation import Foundation

MODELS = Path(__file__).parents[2] / "models"
STACK = """
materials: {concrete: {E: 30 GPa, nu: 0.2, rho: 2400}}
parts:
  slab:    {type: plate, material: concrete, thickness: 0.2 m, origin: [0, 0, 0], size: [4, 3], mesh: [4, 3]}
  machine: {type: block, mass: 1.2 t, origin: [1, 1, 0.12], size: [1, 80 cm, 0.6], center: [0.4, 0.4, 0.2], inertia: [60 kg*m^2, 70, 80]}
  mat:     {type: foundation, between: [machine, slab], region: {rectangle: [0.8, 0.6]}, stiffness: {normal: 10 MN/m3, shear: 3 MN/m3}, loss_factor: 8 %}
  ground:
"""  # noqa: E501
POINTS = """
points:
  top:    {on: machine, at: top}
  bottom: {on: machine, at: bottom, side: below}
  middle: {on: machine, at: center}
  feet:   {on: machine, at: [[0, 0, 0], [1, 0.8, 0]]}
supports: {walls: {on: slab, edge: all, fix: simple}}
"""
STACK = STACK.replace("  ground:\n", "") + POINTS


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "stack.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def test_every_key_reaches_the_structure(tmp_path: Path) -> None:
    structure = read_model_file(written(tmp_path, STACK)).structure
    assert isinstance(structure, Structure)
    _, machine, mat = structure.parts
    assert machine == Block("machine", 1200.0, (1, 1, 0.12), (1, 0.8, 0.6), (0.4, 0.4, 0.2), (60, 70, 80))
    assert mat == Foundation("mat", "machine", Region("rectangle", (0.8, 0.6)), 1e7, 3e6, 0.08, to="slab")
    assert structure.points == (
        PlaceOn("top", "machine", ((0.5, 0.4, 0.6),)),
        PlaceOn("bottom", "machine", ((0.5, 0.4, 0.0),), "below"),
        PlaceOn("middle", "machine", ((0.5, 0.4, 0.3),)),
        PlaceOn("feet", "machine", ((0.0, 0.0, 0.0), (1.0, 0.8, 0.0))),
    )
    assert read_model(written(tmp_path, STACK)).elastics[0].rows.shape[0] > 0


MISTAKES = {
    "off the block": ("[1, 0.8, 0]]", "[1, 0.9, 0]]", "[[0, 0, 0]", r"points\.feet\.at: got \[1\.0, 0\.9, 0\.0\] m, "
        r"expected a place on the block, 1 m x 0\.8 m x 0\.6 m; measure from the block's own corner"),
    "two coordinates": ("at: top", "at: [0.5, 0.4]", "[0.5, 0.4]}",
        r"points\.top\.at: got 2 coordinates, expected 3 on a block; from its lower corner"),
    "a word that is none": ("at: top", "at: topp", "topp", r"points\.top\.at: got 'topp'.*top"),
    "into the slab": ("origin: [1, 1, 0.12]", "origin: [1, 1, 0.05]", "between: [machine",
        r"parts\.mat\.between: got slab reaching 0\.05 m into machine, expected a gap for the layer"),
    "unit of the region": ("region: {rectangle: [0.8, 0.6]}", "region: {rim: [0.8, 0.6]}", "10 MN/m3",
        r"parts\.mat\.stiffness\.normal: got a stiffness in N/m\^3, expected N/m\^2"),
    "beyond the block": ("rectangle: [0.8, 0.6]", "rectangle: [1.2, 0.6]", "region: {rectangle: [1.2",
        r"parts\.mat\.region: got a region that reaches 0\.1 m beyond machine"),
    "edge of a block": ("on: slab, edge: all", "on: machine, edge: all", "machine, edge",
        r"supports\.walls\.on: got 'machine', of type block, expected the name of a plate"),
}  # fmt: skip


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_has_its_place(name: str, tmp_path: Path) -> None:
    old, new, told_at, message = MISTAKES[name]
    assert old in STACK
    path = written(tmp_path, STACK.replace(old, new, 1))
    with pytest.raises(InputErrors) as caught:
        read_model(path)
    errors = [line.removeprefix(f"{path}:") for line in caught.value.errors]
    number, line = next((n, t) for n, t in enumerate(path.read_text().splitlines(), 1) if told_at in t)
    assert re.match(rf"{number}:{line.index(told_at) + 1}: {message}", errors[0]), errors


def test_the_forging_hammer_is_what_its_file_says() -> None:
    """Heave on the springs at 15 % of critical, the anvil on its pad: numbers worked out by hand in the file."""
    answer = CliRunner().invoke(app, ["modes", str(MODELS / "forging_hammer.yaml"), "--json"])
    assert answer.exit_code == 0, answer.output
    table = json.loads(answer.stdout)
    frequency, ratio = table["frequency_hz"], table["damping_ratio"]
    heave = max(range(6), key=lambda i: table["modal_mass_kg"]["z"][i])
    assert frequency[heave] == pytest.approx(3.99, rel=2e-3)  # the pad gives way by (3.99 / 79.7)^2 of it
    assert ratio[heave] == pytest.approx(0.15, rel=2e-3)
    assert frequency[11] == pytest.approx(79.7, rel=2e-3)  # the springs add half of (3.2 / 79.7)^2
    assert len(frequency) == 12
    assert table["complete_below_hz"] is None
    assert not table["findings"]


def test_every_kind_says_which_of_its_places_have_words() -> None:
    shared = {"material": "steel", "thickness": 0.1, "origin": [0, 0, 0], "mesh": [2, 2]}
    plate = PlateSpec.model_validate({"type": "plate", "size": [2, 4], **shared})
    block = BlockSpec.model_validate({"type": "block", "mass": 1, "origin": [1, 1, 1], "size": [2, 4, 6]})
    spring = SpringSpec.model_validate({"type": "spring", "between": ["a", "b"]})
    assert plate.named_places == {"center": (1.0, 2.0)}
    assert block.named_places == {"bottom": (1.0, 2.0, 0.0), "center": (1.0, 2.0, 3.0), "top": (1.0, 2.0, 6.0)}
    assert spring.named_places == {}
