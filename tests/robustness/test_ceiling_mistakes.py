"""Mistakes in hangers, boards and entries of the library: one line each, with its place in the file."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

from femstruct.cli import app
from femstruct.errors import InputError, InputErrors
from femstruct.language.models import read_model_file
from femstruct.model.materials import Material
from femstruct.model.mesher import mesh_structure
from femstruct.model.sections import rectangle
from femstruct.model.structure import Structure
from femstruct.parts.frame import Frame
from femstruct.parts.hangers import Hangers
from femstruct.parts.plate import Plate
from femstruct.workflow.bases import with_positions

TEXT = """\
materials:
  stone: {like: concrete C30/37}
  gypsum: {E: 3 GPa, nu: 0.3, rho: 800, loss_factor: 1 %}
sections:
  joist: {shape: rectangle, width: 80 mm, height: 200 mm}
parts:
  floor: {type: plate, material: stone, thickness: 150 mm, origin: [0, 0, 0.4], size: [4, 3], mesh: 0.5}
  joists: {type: frame, material: gypsum, section: joist, lines: [[[0, 1, 0.3], [4, 1, 0.3]]], mesh: 0.5}
  ceiling: {type: plate, layers: {boards: [[gypsum, 12.5 mm]], bond: 0 %}, origin: [0, 0, 0], size: [4, 3], mesh: 0.5}
  clips: {type: hangers, between: [floor, ceiling], spacing: [1 m, 0.6 m], stiffness: {normal: 20 kN/m}, loss_factor: 0}
  mat: {type: foundation, between: [floor, ceiling], stiffness: {normal: 1 MN/m^3}, loss_factor: 1 %}
damping: {from: materials}
"""
CLIPS = "between: [floor, ceiling], spacing: [1 m, 0.6 m], stiffness: {normal: 20 kN/m}, loss_factor: 0"

# what is replaced, by what, what the line says after its place
MISTAKES = {
    "a material nobody knows": ("concrete C30/37", "concrete C30/38",
        r"2:17: materials\.stone\.like: got 'concrete C30/38', expected a material of the library; did you mean 'con"),
    "a product that is no material": ("concrete C30/37", "hanger ARH-1-20",
        r"2:17: materials\.stone\.like: got 'hanger ARH-1-20', expected a material of the library; "),
    "a ceiling that is a frame": ("between: [floor, ceiling], spacing", "between: [floor, joists], spacing",
        r"10:43: parts\.clips\.between\[1\]: got 'joists', of type frame, expected the name of a plate or slab; "),
    "a ceiling hung on itself": ("between: [floor, ceiling], spacing", "between: [ceiling, ceiling], spacing",
        r"10:35: parts\.clips\.between: got 'ceiling' twice, expected two different parts"),
    "no spacing": (CLIPS, CLIPS.replace("spacing: [1 m, 0.6 m], ", ""),
        r"10:\d+: parts\.clips\.spacing: got nothing, expected 'spacing' or 'at'; add 'spacing: \[600 mm, 900 mm\]'"),
    "a spacing of none": ("[1 m, 0.6 m]", "[0 m, 600 mm]",
        r"10:\d+: parts\.clips\.spacing: got '0 m', expected a positive value: a length"),
    "spacing and places": ("spacing: [1 m, 0.6 m]", "spacing: 1 m, at: [[1, 1]]",
        r"10:10: parts\.clips: got both spacing and at, expected "),
    "lines without a direction": (CLIPS, CLIPS.replace("[1 m, 0.6 m]", "1 m").replace("20 kN/m", "20 kN/m^2"),
        r"10:\d+: parts\.clips\.along: got nothing, expected the axis of the ceiling that lines run along; add"),
    "lines with two spacings": (CLIPS, CLIPS.replace("20 kN/m", "20 kN/m^2") + ", along: x",
        r"10:\d+: parts\.clips\.spacing: got 2 numbers, expected one, across the lines; add"),
    "a direction of clips": (CLIPS, CLIPS + ", along: x",
        r"10:\d+: parts\.clips\.along: got a direction of springs one by one, expected none; remove 'along'"),
    "both kinds of stiffness": ("normal: 20 kN/m", "normal: 20 kN/m, shear: 2 kN/m^2",
        r"parts\.clips\.stiffness: got one stiffness per length, one of each, expected both of one kind"),
    "no stiffness": ("normal: 20 kN/m", "normal: 0 kN/m",
        r"parts\.clips\.stiffness: got no stiffness at all, expected a positive normal or shear stiffness"),
    "stiffness of an area": ("normal: 20 kN/m", "normal: 20 kN/m^3",
        r"parts\.clips\.stiffness\.normal: got '20 kN/m\^3', which is a stiffness per area, expected "),
    "stiffness and like": (CLIPS, CLIPS + ", like: hanger ARH-1-20",
        r"10:10: parts\.clips: got both stiffness and like, expected exactly one of stiffness, like"),
    "mass of a line": (CLIPS, CLIPS + ", mass: 2 kg/m",
        r"parts\.clips\.mass: got a mass per length, expected kg, as the stiffness is of each"),
    "clips below joists in two ways": ("between: [floor, ceiling], spacing", "between: [joists, ceiling], spacing",
        r"parts\.clips\.spacing: got 2 numbers, expected the spacing along the bars; add 'spacing: 500 mm'"),
    "like without its loss factor": ("stiffness: {normal: 20 kN/m}, loss_factor: 0", "like: hanger ARH-1-20",
        r"parts\.clips: got no loss_factor, and hanger ARH-1-20 has none in the library, expected 'loss_factor'"),
    "hangers nobody knows": ("stiffness: {normal: 20 kN/m}", "like: hanger ARH-1-21",
        r"parts\.clips\.like: got 'hanger ARH-1-21', expected hangers or channels of the library; did you mean 'han"),
    "a mat like a material": ("stiffness: {normal: 1 MN/m^3}", "like: concrete C30/37",
        r"parts\.mat\.like: got 'concrete C30/37', expected a resilient layer of the library; "),
    "a bond beyond glue": ("bond: 0 %", "bond: 110 %",
        r"parts\.ceiling\.layers\.bond: got '110 %', expected a ratio of at most 1"),
    "boards without a bond": (", bond: 0 %", "", r"parts\.ceiling\.layers\.bond: got nothing, expected 'bond'"),
    "a lay-up nobody knows": ("{boards: [[gypsum, 12.5 mm]], bond: 0 %}", "{like: CLT160 L6, of: gypsum}",
        r"parts\.ceiling\.layers\.like: got 'CLT160 L6', expected a lay-up of the library; did you mean 'CLT160 L5'"),
    "a lay-up of nothing": ("{boards: [[gypsum, 12.5 mm]], bond: 0 %}", "{like: CLT160 L5, of: sruce}",
        r"parts\.ceiling\.layers\.of: got 'sruce', expected the name of a material; "),
}  # fmt: skip


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_one_line(mistake: str, tmp_path: Path) -> None:
    old, new, line = MISTAKES[mistake]
    assert old in TEXT
    (tmp_path / "a.yaml").write_text(TEXT.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(InputErrors) as raised:
        read_model_file(tmp_path / "a.yaml")
    (message,) = (str(one) for one in raised.value.errors)
    assert "\n" not in message and re.search(line, message), message


def test_without_mistakes_it_is_read(tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text(TEXT, encoding="utf-8")
    assert len(read_model_file(tmp_path / "a.yaml").structure.parts) == 5  # type: ignore[union-attr]


def test_a_spacing_in_metres_is_refused_where_it_is_written(tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text(TEXT.replace("[1 m, 0.6 m]", "[600, 900]", 1), encoding="utf-8")
    source = read_model_file(tmp_path / "a.yaml")
    assert isinstance(source.structure, Structure)
    with (
        pytest.raises(InputErrors, match=r"a\.yaml:10:\d+: parts\.clips\.spacing: got 600 m on .* did you mean 600 mm"),
        with_positions(source),
    ):
        mesh_structure(source.structure)


def test_check_tells_how_many_hangers_there_are_and_what_they_carry(tmp_path: Path) -> None:
    """12 m^2 of 10 kg/m^2 on 4 x 5 hangers of 65 lb; on 1 x 1; and on a layer, too."""
    both = TEXT.replace("stiffness: {normal: 20 kN/m}, loss_factor: 0", "like: hanger ARH-1-20, loss_factor: 5 %")
    (tmp_path / "a.yaml").write_text(both, encoding="utf-8")
    answer = CliRunner().invoke(app, ["check", str(tmp_path / "a.yaml")])
    assert "clips: 20 hangers; other parts or supports carry ceiling, too" in " ".join(answer.output.split())
    like = "".join(line for line in both.splitlines(keepends=True) if not line.startswith("  mat:"))
    (tmp_path / "a.yaml").write_text(like, encoding="utf-8")
    answer = CliRunner().invoke(app, ["check", str(tmp_path / "a.yaml")])
    told = " ".join(answer.output.split())
    assert "clips: 20 hangers, each with 58.84 N of ceiling in the mean, of the 289.1 N that are recommended" in told
    (tmp_path / "a.yaml").write_text(like.replace("[1 m, 0.6 m]", "4 m"), encoding="utf-8")
    told = " ".join(CliRunner().invoke(app, ["check", str(tmp_path / "a.yaml")]).output.split())
    assert "clips: 1 hanger, each with 1177 N of ceiling in the mean, more than the 289.1 N that" in told


BOARD = Material("board", E=3e9, nu=0.3, rho=800.0)
FLOOR = Plate("floor", BOARD, 0.15, (0.0, 0.0, 0.4), (4.0, 3.0), 1.0)
CEILING = Plate("ceiling", BOARD, 0.0125, (0.0, 0.0, 0.0), (4.0, 3.0), 1.0)
JOISTS = Frame("joists", BOARD, rectangle("j", 0.1, 0.2), (((0.0, 1.0, 0.3), (4.0, 1.0, 0.3)),), 1.0)
HANGERS = Hangers("clips", "floor", "ceiling", 2e4, spacing=(1.0,))
BARS = replace(HANGERS, on="joists")

# the nouns and what they say
REFUSED = {
    "nobody": (replace(HANGERS, on="flor"), CEILING, JOISTS, r"parts\.clips\.between: got 'flor', expected a part"),
    "itself": (replace(HANGERS, on="ceiling"), CEILING, JOISTS, r"between: got 'ceiling' twice, expected two parts"),
    "a frame as ceiling": (replace(HANGERS, to="joists"), CEILING, JOISTS, r"got 'joists', expected a ceiling: a p"),
    "no stiffness": (replace(HANGERS, normal=0.0), CEILING, JOISTS, r"stiffness: got 0, 0, expected values >= 0"),
    "less than nothing": (replace(HANGERS, mass=-1.0), CEILING, JOISTS, r"mass: got -1, expected a mass >= 0"),
    "backwards": (replace(HANGERS, spacing=(-1.0,)), CEILING, JOISTS, r"spacing: got -1 m, expected lengths above"),
    "hairs": (replace(HANGERS, spacing=(1e-9,)), CEILING, JOISTS, r"spacing: got 1e-09 m on 4 m, expected at most"),
    "grids of hairs": (replace(HANGERS, spacing=(1e-3,)), CEILING, JOISTS, r"spacing: got .* expected at most 100000"),
    "three ways": (replace(HANGERS, spacing=(1.0, 1.0, 1.0)), CEILING, JOISTS, r"got 3 numbers, expected 1 or 2 for"),
    "no way": (replace(HANGERS, spacing=()), CEILING, JOISTS, r"got no spacing, expected 1 or 2 for pieces below"),
    "metres for millimetres": (replace(HANGERS, spacing=(0.6, 900.0)), CEILING, JOISTS,
        r"spacing: got 900 m on a ceiling of 4 m x 3 m, expected a spacing within the ceiling; .* did you mean 900 mm"),
    "lines beyond": (replace(HANGERS, spacing=(4.5,), per="length", along="x"), CEILING, JOISTS, r"got 4.5 m on a cei"),
    "bars in metres": (replace(BARS, spacing=(500.0,)), CEILING, JOISTS, r"got 500 m on a cei.* did you mean 500 mm"),
    "no direction": (replace(HANGERS, per="length"), CEILING, JOISTS, r"along: got no direction of the lines, exp"),
    "off": (replace(HANGERS, spacing=(), at=((5.0, 1.0),)), CEILING, JOISTS, r"at: got a place 1 m off, expected x f"),
    "beside": (HANGERS, replace(CEILING, origin=(9.0, 0.0, 0.0)), JOISTS, r"between: got .* which do not face each"),
    "inside": (HANGERS, replace(CEILING, origin=(0.0, 0.0, 0.4)), JOISTS, r"between: got .* reaching .* into"),
    "tilted": (BARS, replace(CEILING, normal=(0.1, 0.0, 1.0)), JOISTS, r"got bars of joists at an angle to ceiling"),
    "in the ceiling": (BARS, CEILING, replace(JOISTS, lines=(((0.0, 1.0, 0.05), (4.0, 1.0, 0.05)),)),
        r"got bars of joists reaching 0\.05625 m into ceiling, expected a gap"),
    "beside the ceiling": (BARS, CEILING, replace(JOISTS, lines=(((0.0, 8.0, 0.3), (4.0, 8.0, 0.3)),)),
        r"got no bar of joists over ceiling, expected bars over the ceiling"),
    "along bars": (replace(BARS, along="x"), CEILING, JOISTS, r"along: got a direction below a frame, expected a spa"),
    "lines along bars": (replace(BARS, per="length"), CEILING, JOISTS, r"spacing: got 1 numbers, expected none for"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_nouns_say_what_is_wrong(case: str) -> None:
    hangers, ceiling, joists, message = REFUSED[case]
    with pytest.raises(InputError, match=message):
        mesh_structure(Structure("a ceiling", (FLOOR, joists, ceiling, hangers)))
