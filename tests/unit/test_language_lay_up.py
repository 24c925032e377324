"""Orthotropic materials, layers and smeared ribs as they are written: every key reaches the noun, every mistake has its
place."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from femstruct.errors import InputErrors
from femstruct.language.models import read_model_file
from femstruct.modal.damping import Damping
from femstruct.model.lay_ups import Laminate, Layer, Smeared
from femstruct.model.materials import Material, Orthotropic, timber
from femstruct.model.structure import Structure
from femstruct.parts.plate import Plate
from femstruct.study.asked import Extent
from femstruct.study.inputs import inputs
from femstruct.study.study import Study
from femstruct.view.page import input_tables

DECK = """
materials:
  spruce: {E: [11 GPa, 370 MPa], G: [690 MPa, 50 MPa], nu: 0.35, rho: 420, loss_factor: 3 %}
  glass: {E: [45 GPa, 12 GPa, 12 GPa], G: [5 GPa, 4 GPa, 5 GPa], nu: [0.3, 0.4, 0.08], rho: 2000}
  concrete: {E: 30 GPa, nu: 0.2, rho: 2400}
parts:
  clt: {type: plate, layers: [[spruce, 40 mm], [spruce, 20 mm, 90 deg], [spruce, 40 mm, 0]], origin: [0, 0, 0], size: [5, 4], mesh: 1 m}
  sheet: {type: plate, material: glass, thickness: 5 mm, origin: [0, 5, 0], size: [1, 1], mesh: 0.5 m}
  ribbed: {type: plate, smeared: {D: [6 MN*m, 2 MN*m, 0, 500 kN*m], S: [20 MN/m, 10 MN/m], mass: 200 kg/m^2, loss_factor: 1 %}, thickness: 25 cm, origin: [0, 7, 0], size: [5, 4], mesh: 1 m}
supports: {edges: {on: clt, edge: all, fix: simple}}
"""  # noqa: E501


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "deck.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def test_every_key_reaches_the_structure(tmp_path: Path) -> None:
    structure = read_model_file(written(tmp_path, DECK)).structure
    assert isinstance(structure, Structure)
    clt, sheet, ribbed = structure.parts
    assert isinstance(clt, Plate) and isinstance(sheet, Plate) and isinstance(ribbed, Plate)
    spruce = Orthotropic("spruce", (11e9, 370e6), (690e6, 50e6), 0.35, 420.0, 0.03)
    layers = (Layer(spruce, 0.04), Layer(spruce, 0.02, np.radians(90.0)), Layer(spruce, 0.04))
    assert clt.material == Laminate(layers) and clt.thickness == pytest.approx(0.1, rel=1e-15)  # rounding of the sum
    assert sheet.material == Orthotropic("glass", (45e9, 12e9, 12e9), (5e9, 4e9, 5e9), (0.3, 0.4, 0.08), 2000.0)
    assert ribbed.material == Smeared((6e6, 2e6, 0.0, 5e5), (20e6, 10e6), 200.0, 0.25, loss_factor=0.01)
    assert (ribbed.thickness, ribbed.materials()) == (0.25, ())
    assert clt.materials() == (spruce,) and sheet.materials() == (sheet.material,)
    assert not isinstance(sheet.material, Material)


PLATE = "type: plate, material: glass, thickness: 5 mm"
MISTAKES = {
    "no shear moduli": (", G: [690 MPa, 50 MPa]", "", "{E: [11 GPa", r"materials\.spruce: got a list E without G, "
        r"expected 'G: \[Gxy, Gyz, Gzx\]' beside it; Gyz is the rolling shear of timber"),
    "one shear modulus": ("G: [690 MPa, 50 MPa]", "G: 690 MPa", "690 MPa", r"materials\.spruce\.G: got '690 MPa', "
        r"expected \[Gxy, Gyz\] or \[Gxy, Gyz, Gzx\]; Gyz is the rolling"),
    "a shear modulus too many": ("E: 30 GPa, nu", "E: 30 GPa, G: [1 GPa, 1 GPa], nu", "{E: 30 GPa",
        r"materials\.concrete: got G of an orthotropic material beside one E, .*; G of an isotropic material is"),
    "ratios beside one E": ("nu: 0.2", "nu: [0.2, 0.2, 0.2]", "{E: 30 GPa",
        r"got nu of an orthotropic material beside"),
    "four moduli": ("[11 GPa, 370 MPa]", "[1, 2, 3, 4]", "[1, 2, 3, 4]",
        r"spruce\.E: got 4 moduli, expected one, two"),
    "two ratios": ("nu: 0.35", "nu: [0.35, 0.4]", "[0.35, 0.4]", r"spruce\.nu: got 2 ratios, expected nuxy, or "
        r"\[nuxy, nuyz, nuzx\]; nuij is the contraction along j under stress along i"),
    "unit of a modulus": ("370 MPa]", "370 kg]", "[11 GPa", r"spruce\.E: got '370 kg', which is a mass, expected a"),
    "the other ratio": ("[0.3, 0.4, 0.08]", "[0.3, 0.4, 0.6]", "[0.3, 0.4, 0.6]",
        r"materials\.glass\.nu: got nuzx = 0\.6 with Ez = 1\.2e\+10 Pa and Ex = 4\.5e\+10 Pa, expected less than "
        r"sqrt\(Ez / Ex\) = 0\.5164; .*if 0\.6 is nuxz, write 0\.16"),
    "nothing it is made of": (PLATE, "type: plate, thickness: 5 mm", "{type: plate, thickness",
        r"parts\.sheet: got none of material, layers, smeared, expected exactly one"),
    "two it is made of": (PLATE, f"{PLATE}, layers: [[glass, 5 mm]]", f"{{{PLATE}", r"got both material and layers"),
    "layers and thickness": ("type: plate, layers:", "type: plate, thickness: 1 cm, layers:", "{type: plate, thick",
        r"parts\.clt: got both layers and thickness"),
    "no thickness": (PLATE, "type: plate, material: glass", "sheet: {",
        r"parts\.sheet\.thickness: got nothing, expected "
        r"'thickness'; add 'thickness: \.\.\.'"),
    "no such material": ("[spruce, 20 mm", "[spruse, 20 mm", "spruse", r"parts\.clt\.layers\[1\]\[0\]: got 'spruse', "
        r"expected the name of a material; did you mean 'spruce'\?"),
    "an angle without unit": ("90 deg", "90", "90]", r"layers\[1\]\[2\]: got 90, expected an angle with its unit; "
        r"write 90 deg"),
    "a length for an angle": ("90 deg", "90 mm", "90 mm",
        r"layers\[1\]\[2\]: got '90 mm', which is a length, expected an"),
    "a layer of one value": ("[spruce, 40 mm, 0]", "[spruce]", "[spruce]]",
        r"parts\.clt\.layers\[2\]: got 1 value, expected \[material"),
    "a layer of four": ("[spruce, 40 mm, 0]", "[spruce, 4 cm, 0, 1]", "[spruce, 4 cm",
        r"layers\[2\]: got 4 values, expected \[material, thickness, angle\]"),
    "no layer": ("[[spruce, 40 mm], [spruce, 20 mm, 90 deg], [spruce, 40 mm, 0]]", "[]", "[], origin",
        r"parts\.clt\.layers: got no layer, expected layers \[material, thickness, angle\], or a lay-up"),
    "no list of layers": ("[[spruce, 40 mm], [spruce, 20 mm, 90 deg], [spruce, 40 mm, 0]]", "3", "3, origin",
        r"parts\.clt\.layers: got 3, expected layers"),
    "a lay-up that is not there": ("[[spruce, 40 mm], [spruce, 20 mm, 90 deg], [spruce, 40 mm, 0]]",
        "{like: CLT160 L6, of: spruce}", "CLT160 L6",
        r"layers\.like: got 'CLT160 L6', expected a lay-up of the library; did you mean 'CLT160 L5'\?"),
    "a lay-up of no material": ("[[spruce, 40 mm], [spruce, 20 mm, 90 deg], [spruce, 40 mm, 0]]",
        "{like: CLT160 L5, of: spruse}", "spruse", r"layers\.of: got 'spruse', expected the name of a material"),
    "three rigidities": ("[6 MN*m, 2 MN*m, 0, 500 kN*m]", "[6 MN*m, 2 MN*m, 0]", "[6 MN",
        r"ribbed\.smeared\.D: got a list"),
    "a rigidity of a beam": ("6 MN*m", "6 MN*m^2", "6 MN*m^2",
        r"smeared\.D\[0\]: got .* bending stiffness, expected a moment"),
    "order of rigidities": ("[6 MN*m, 2 MN*m, 0,", "[6 MN*m, 0, 2 MN*m,", "{type: plate, smeared",
        r"got 6e\+06, 0, 2e\+06, 5"),
    "element of the source": ("type: plate, layers", "type: plate, element: hermite12, layers", "hermite12",
        r"parts\.clt\.element: got hermite12 with an orthotropic material or layers, expected bfs16 or acm12"),
}  # fmt: skip


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_has_its_place(name: str, tmp_path: Path) -> None:
    old, new, at, told = MISTAKES[name]
    assert old in DECK
    text = DECK.replace(old, new, 1)
    with pytest.raises(InputErrors) as refused:
        read_model_file(written(tmp_path, text))
    line, column = next((n, one.index(at) + 1) for n, one in enumerate(text.splitlines(), start=1) if at in one)
    (message,) = refused.value.errors
    assert re.search(rf"deck\.yaml:{line}:{column}: .*{told}", message), message


def test_timber_by_its_strength_class(tmp_path: Path) -> None:
    """The means of EN 338; what is known better takes their place."""
    old = DECK.splitlines()[2]
    for written_as, expected in (
        ("{like: C24}", timber("spruce", "C24")),
        ("{like: C30, loss_factor: 2 %}", timber("spruce", "C30", loss_factor=0.02)),
        ("{like: C24, G: [700 MPa, 50 MPa], rho: 450}", timber("spruce", "C24", (700e6, 50e6), 450.0)),
    ):
        structure = read_model_file(written(tmp_path, DECK.replace(old, f"  spruce: {written_as}"))).structure
        assert isinstance(structure, Structure)
        assert structure.parts[0].materials() == (expected,)
    assert (expected.G, expected.rho, expected.E) == ((700e6, 50e6, 700e6), 450.0, (11e9, 370e6, 370e6))
    assert expected.completed == ("C24 of EN 338", "Ez = Ey", "nuxy = nuyz = nuxz = 0.35", "Gzx = Gxy")
    for written_as, told in (
        (
            "{like: C25}",
            r"materials\.spruce\.like: got 'C25', expected a material of the library; did you mean 'C24'\?",
        ),
        ("{like: C24, E: 11 GPa}", r"materials\.spruce\.E: got one modulus, expected \[Ex, Ey\] .* as C24 has"),
        ("{like: C24, roh: 450}", r"spruce\.roh: got the unknown key 'roh', .*did you mean 'rho'\?"),
        ("{like: C24, G: 690 MPa}", r"spruce\.G: got '690 MPa', expected \[Gxy"),
    ):
        with pytest.raises(InputErrors, match=rf"deck\.yaml:3:\d+: .*{told}"):
            read_model_file(written(tmp_path, DECK.replace(old, f"  spruce: {written_as}")))


def test_what_layers_are_made_of_is_shown_with_what_was_completed(tmp_path: Path) -> None:
    structure = read_model_file(written(tmp_path, DECK)).structure
    assert isinstance(structure, Structure)
    asked = inputs(Study("deck", structure, Damping(), Extent(count=3)))
    tables = {grid.title: grid for grid in input_tables(asked)}
    materials = {row[0]: dict(zip(tables["materials"].columns, row, strict=True)) for row in tables["materials"].rows}
    assert list(materials) == ["spruce", "glass"]
    assert materials["spruce"]["completed"] == "Ez = Ey, Gzx = Gxy, nuyz = nuxy, nuzx = nuxy Ez / Ex"
    assert materials["glass"]["completed"] == ""
    told = [row[2] for row in tables["structure"].rows]
    assert "layers spruce 40 mm, spruce 20 mm at 90°, spruce 40 mm" in told[0]
    assert "mass per area 200 kg/m²" in told[2] and "D 6 MN m, 2 MN m, 0 N m, 500 kN m" in told[2]
    assert materials["spruce"]["E"] == "11 GPa, 370 MPa, 370 MPa"
