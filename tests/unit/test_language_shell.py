"""Shells of mesh files as they are written: every key reaches the noun, every mistake has its place."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from femstruct.errors import InputErrors
from femstruct.language.models import read_model, read_model_file
from femstruct.language.parts import InertiaSpec
from femstruct.model.regions import Region
from femstruct.model.structure import Joint, PlaceOn, Structure, Support, SurfaceOn
from femstruct.parts.shell import Shell
from femstruct.study.asked import Extent
from femstruct.workflow.modes import modes_of

MESH = """*NODE
1, 0, 0, 0
2, 200, 0, 0
3, 400, 0, 0
4, 0, 150, 0
5, 200, 150, 0
6, 400, 150, 0
7, 0, 0, 100
8, 200, 0, 100
9, 400, 0, 100
*ELEMENT, TYPE=S4, ELSET=FLOOR
1, 1, 2, 5, 4
2, 2, 3, 6, 5
*ELEMENT, TYPE=S3, ELSET=WALL
3, 1, 2, 8
4, 1, 8, 7
5, 2, 3, 9
6, 2, 9, 8
*NSET, NSET=FEET
4, 6
*ELSET, ELSET=TWO
FLOOR, WALL
*SHELL SECTION, ELSET=TWO, MATERIAL=S
2.5
"""
MODEL = """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
sections: {bar: {shape: rectangle, width: 20 mm, height: 20 mm}}
parts:
  tray:  {type: shell, mesh: meshes/tray.inp, scale: mm, material: steel, thickness: {FLOOR: 3 mm, WALL: 2 mm}}
  floor: {type: shell, mesh: meshes/tray.inp, set: FLOOR, scale: mm, material: steel, offset: 4 mm}
  leg:   {type: frame, material: steel, section: bar, lines: [[[0, 0.15, 0], [0, 0.15, -0.3]]]}
  paint: {type: mass, mass: 2 kg/m^2, on: tray, region: {set: WALL}}
points:
  middle: {on: tray, at: [0.2, 0.075, 0]}
  feet:   {on: tray, set: FEET}
surfaces:
  under:  {on: tray, side: below, region: {set: FLOOR}}
joints:
  weld:   {connect: [leg, tray], sets: {tray: FEET}}
  near:   {connect: [floor, tray], reach: 1 mm, kind: pinned}
supports:
  rim:    {on: tray, set: WALL, fix: simple}
  corner: {on: tray, box: [[0.39, 0.14, -0.01], [0.41, 0.16, 0.01]], fix: [z, rx]}
"""


def written(folder: Path, model: str = MODEL, mesh: str = MESH) -> Path:
    (folder / "meshes").mkdir(exist_ok=True)
    (folder / "meshes" / "tray.inp").write_text(mesh, encoding="utf-8")
    (folder / "tray.yaml").write_text(model, encoding="utf-8")
    return folder / "tray.yaml"


def test_every_key_reaches_the_structure(tmp_path: Path) -> None:
    file = read_model_file(written(tmp_path))
    structure = file.structure
    assert isinstance(structure, Structure)
    tray, floor = structure.parts[:2]
    assert isinstance(tray, Shell) and isinstance(floor, Shell)
    assert (tray.thickness, tray.named, tray.offset) == ({"FLOOR": 0.003, "WALL": 0.002}, None, None)
    assert (floor.thickness, floor.named, floor.offset) == (None, "FLOOR", 0.004)
    assert np.ptp(tray.mesh.points, axis=0) == pytest.approx([0.4, 0.15, 0.1], rel=1e-12)  # rounding of the scale
    assert structure.points[1] == PlaceOn("feet", "tray", named="FEET")
    assert structure.surfaces == (SurfaceOn("under", "tray", "below", Region("set", named="FLOOR")),)
    assert structure.joints == (
        Joint("weld", "leg", "tray", sets={"tray": "FEET"}),
        Joint("near", "floor", "tray", kind="pinned", reach=0.001),
    )
    corner = Region("box", box=((0.39, 0.14, -0.01), (0.41, 0.16, 0.01)))
    assert structure.supports == (
        Support("rim", "simple", on="tray", region=Region("set", named="WALL")),
        Support("corner", ("z", "rx"), on="tray", region=corner),
    )
    digest = file.sources[str(tmp_path / "meshes" / "tray.inp")]
    assert re.match(r"sha256 [0-9a-f]{64}, 2 quad4, 4 tri3, 9 nodes, sets FLOOR, WALL, TWO, FEET\n", digest)


def test_what_is_written_is_meshed(tmp_path: Path) -> None:
    model = read_model(written(tmp_path))
    masses = {name: part.mass for name, part in model.parts.items()}
    # rounding
    assert masses["tray"] == pytest.approx(7850 * (0.4 * 0.15 * 3e-3 + 0.4 * 0.1 * 2e-3), rel=1e-12)
    assert masses["floor"] == pytest.approx(7850 * 0.4 * 0.15 * 2.5e-3, rel=1e-12)  # the file's thickness; rounding
    assert model.inerts[0].total == pytest.approx(2.0 * 0.4 * 0.1, rel=1e-12)  # rounding
    assert model.surfaces["under"].normal == pytest.approx([0, 0, -1])
    assert model.points["feet"].position == pytest.approx([0.2, 0.15, 0.0], abs=1e-12)  # rounding
    ties = {tie.name: tie.rows.shape[0] for tie in model.ties}
    assert (ties["near"], ties["rim"], ties["corner"]) == (3 * 6, 3 * 6, 2)


TRAY = "parts\\.tray"
FLOOR = "parts\\.floor"
MISTAKES = {
    "no file": ("meshes/tray.inp, scale: mm, material: steel, thick", "meshes/none.inp, material: steel, thick",
        "meshes/none", rf"{TRAY}\.mesh: got no file '.*none\.inp', expected a mesh file, named from the model"),
    "no mesh file": ("meshes/tray.inp, scale: mm, material: steel, thick", "tray.stp, material: steel, thick",
        "tray.stp", rf"{TRAY}\.mesh: got 'tray\.stp', expected a mesh file: \.msh, \.inp"),
    "a folder": ("mesh: meshes/tray.inp, set", "mesh: meshes, set", "meshes, set", rf"{FLOOR}\.mesh: got 'meshes'"),
    "an absolute path": ("mesh: meshes/tray.inp, set", "mesh: /etc/a.inp, set", "/etc",
        rf"{FLOOR}\.mesh: got the absolute path"),
    "no set": ("set: FLOOR, scale", "set: FLOORS, scale", "FLOORS",
        rf"{FLOOR}\.set: got 'FLOORS', no set of tray\.inp, expected FLOOR, WALL, TWO, FEET"),
    "a set of nodes": ("set: FLOOR, scale", "set: FEET, scale", "FEET, scale",
        rf"{FLOOR}\.set: got 'FEET', a set without triangles or quadrilaterals.*; sets with them: FLOOR, WALL"),
    "no unit": ("set: FLOOR, scale: mm", "set: FLOOR, scale: milli", "milli",
        rf"{FLOOR}\.scale: got 'milli', expected a unit of length"),
    "a length": ("set: FLOOR, scale: mm", "set: FLOOR, scale: -1", "-1", rf"{FLOOR}\.scale: got -1, expected a pos"),
    "half a thickness": ("{FLOOR: 3 mm, WALL: 2 mm}", "{FLOOR: 3 mm}", "{FLOOR: 3 mm}",
        rf"{TRAY}\.thickness: got 4 of 6 cells without one, expected a set with a thickness"),
    "two thicknesses": ("{FLOOR: 3 mm, WALL: 2 mm}", "{TWO: 3 mm, WALL: 2 mm}", "{TWO",
        rf"{TRAY}\.thickness: got a second thickness of cells of set 'WALL', expected one of each cell"),
    "thickness of no set": ("{FLOOR: 3 mm, WALL: 2 mm}", "{TWO: 3 mm, ROOF: 2 mm}", "{TWO",
        rf"{TRAY}\.thickness: got 'ROOF', no set"),
    "a mass for a thickness": ("WALL: 2 mm}", "WALL: 2 kg}", "{FLOOR",
        rf"{TRAY}\.thickness: got '2 kg', which is a mass, expected a length"),
    "a point off it": ("at: [0.2, 0.075, 0]", "at: [0.2, 0.075, 0.02]", "[0.2, 0.075",
        r"points\.middle\.at: got \(0\.2, 0\.075, 0\.02\) m, 0\.02 m off tray, .* is \(0\.2, 0\.075, 0\)"),
    "a point in a plane": ("at: [0.2, 0.075, 0]", "at: [0.2, 0.075]", "[0.2, 0.075",
        r"points\.middle\.at: got 2 coordinates, expected 3 on a shell"),
    "a word for a point": ("at: [0.2, 0.075, 0]", "at: center", "center",
        r"points\.middle\.at: got center of a shell, expected global coordinates"),
    "both": ("set: FEET}\nsurf", "set: FEET, at: [0, 0, 0]}\nsurf", "{on: tray, set: FEET, at",
        r"points\.feet: got both at and set"),
    "a set of a frame": ("{on: tray, set: FEET}", "{on: leg, set: FEET}", "leg, set",
        r"points\.feet\.on: got 'leg', of type frame, expected the name of a part that is a mesh"),
    "a set that no point has": ("{on: tray, set: FEET}", "{on: tray, set: FOOT}", "{on: tray, set: FOOT",
        r"points\.feet.*: got 'FOOT', no set of tray\.inp"),
    "a rectangle of a shell": ("region: {set: FLOOR}", "region: {rectangle: [1 m, 1 m]}", "{rectangle",
        r"surfaces\.under\.region: got a rectangle of a shell, expected whole, a set or a box"),
    "a surface of cells of another part": ("{on: tray, side: below, region: {set: FLOOR}}",
        "{on: floor, side: below, region: {set: WALL}}", "{on: floor, side",
        r"surfaces\.under\.region: got a set 'WALL' without a cell of floor, expected one with cells"),
    "a mass on cells of another part": ("on: tray, region: {set: WALL}", "on: floor, region: {set: WALL}",
        "on: floor, region", r"parts\.paint\.region: got a set 'WALL' without a cell of floor, expected one with"),
    "an edge of a shell": ("set: WALL, fix: simple", "edge: all, fix: simple", "tray, edge",
        r"supports\.rim\.on: got 'tray', expected the name of a plate; of a slab write 'set: rim' or 'set: side 1'"),
    "an empty box": ("[[0.39, 0.14, -0.01], [0.41, 0.16, 0.01]]", "[[1, 1, 1], [2, 2, 2]]", "[[1, 1, 1]",
        r"supports\.corner\.box: got a box from \(1, 1, 1\) to \(2, 2, 2\) m without a node of tray"),
    "a set of what is not joined": ("sets: {tray: FEET}", "sets: {floor: FEET}", "floor: FEET",
        r"joints\.weld\.sets\.floor: got 'floor', expected leg or tray"),
    "no reach at all": ("reach: 1 mm", "reach: 0 mm", "0 mm, kind", r"joints\.near\.reach: got '0 mm', expected a"),
    "orientation of steel": ("offset: 4 mm", "orientation: [1, 0, 0]", "[1, 0, 0]}",
        rf"{FLOOR}\.orientation: got a direction for 'steel', which is isotropic: it has no direction, expected no "
        r"orientation; leave 'orientation' out"),
    "a re-entrant cell": ("", "", "meshes/tray.inp, scale",
        rf"{TRAY}\.mesh: got 1 of 6 cells without area or with a corner that points inwards: element 2; the first"),
    "a line of the mesh": ("", "", "", r"tray\.inp:7:1: got '400, 15O, 0', expected numbers"),
}  # fmt: skip
MESHES = {
    "a re-entrant cell": MESH.replace("6, 400, 150, 0", "6, 220, 20, 0"),
    "a line of the mesh": MESH.replace("6, 400, 150, 0", "6, 400, 15O, 0"),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_has_its_place(name: str, tmp_path: Path) -> None:
    old, new, told_at, message = MISTAKES[name]
    assert old in MODEL
    path = written(tmp_path, MODEL.replace(old, new, 1), MESHES.get(name, MESH))
    with pytest.raises(InputErrors) as caught:
        read_model(path)
    if not told_at:
        assert re.search(message, caught.value.errors[0]), caught.value.errors
        return
    errors = [line.removeprefix(f"{path}:") for line in caught.value.errors]
    number = next(n for n, t in enumerate(path.read_text().splitlines(), 1) if told_at in t)
    assert re.match(rf"{number}:\d+: {message}", errors[0]), errors


def test_what_is_missing_is_named_with_its_key(tmp_path: Path) -> None:
    shell = "materials:\n  oak: {E: [11 GPa, 0.4 GPa], G: [0.7 GPa, 0.1 GPa], nu: 0.3, rho: 700}\n"
    shell += "parts:\n  tray: {type: shell, mesh: meshes/tray.inp, scale: mm, layers: [[oak, 3 mm]]}\n"
    with pytest.raises(InputErrors, match=r"yaml:4:\d+: .*got none, expected 'orientation', the .*: \[1, 0, 0\]"):
        read_model(written(tmp_path, shell, MESH))


def test_an_edge_of_a_slab_is_a_set(tmp_path: Path) -> None:
    slab = "materials: {concrete: {E: 30 GPa, nu: 0.2, rho: 2400}}\nparts: {deck: {type: slab, material: concrete, "
    slab += "thickness: 0.2, outline: [[0, 0], [5, 0], [5, 4], [0, 4]], mesh: 1}}\n"
    slab += "supports: {walls: {on: deck, edge: all, fix: simple}}\n"
    with pytest.raises(InputErrors, match=r"yaml:3:\d+: .*expected the name of a plate; of a slab write 'set: rim'"):
        read_model(written(tmp_path, slab, MESH))
    read_model(written(tmp_path, slab.replace("edge: all", "set: rim"), MESH))


def test_an_inertia_is_at_every_place_of_its_point_and_its_help_says_so(tmp_path: Path) -> None:
    model = "materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}\nparts:\n"
    model += "  tray: {type: shell, mesh: meshes/tray.inp, scale: mm, material: steel, thickness: 3 mm}\n"
    model += "  pump: {type: inertia, at: feet, mass: 80 kg}\n"
    model += "points: {feet: {on: tray, at: [[0, 0, 0], [0.4, 0, 0]]}}\n"
    with_pumps, without = (
        modes_of(written(tmp_path, text, MESH), Extent(count=7))["mass_kg"]
        for text in (model, model.replace("80 kg", "1e-6 kg"))
    )
    assert with_pumps - without == pytest.approx(160.0, abs=1e-5)  # the 2e-6 kg that are left
    assert "kg each" in InertiaSpec.model_json_schema()["description"]
