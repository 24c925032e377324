"""Solids of mesh files as they are written: keys reach the noun, mistakes have their place."""

from __future__ import annotations

from pathlib import Path

import pytest

from femstruct.errors import InputErrors
from femstruct.language.models import read_model
from femstruct.model.materials import Orthotropic
from femstruct.parts.solid import Solid
from femstruct.study.asked import Extent
from femstruct.workflow.modes import modes_of

MESH = """*NODE
1, 0, 0, 0
2, 100, 0, 0
3, 100, 100, 0
4, 0, 100, 0
5, 0, 0, 50
6, 100, 0, 50
7, 100, 100, 50
8, 0, 100, 50
*ELEMENT, TYPE=C3D8, ELSET=BODY
1, 1, 2, 3, 4, 5, 6, 7, 8
*NSET, NSET=FOOT
1, 2, 3, 4
"""
MODEL = """
materials:
  steel: {E: 210 GPa, nu: 0.3, rho: 7850 kg/m^3}
  oak: {E: [11 GPa, 0.8 GPa, 0.8 GPa], G: [0.7 GPa, 0.1 GPa, 0.7 GPa], nu: 0.3, rho: 700 kg/m^3}
parts:
  ram: {type: solid, mesh: ram.inp, scale: mm, set: BODY, material: steel}
supports:
  floor: {on: ram, set: FOOT, fix: [x, y, z]}
points:
  top: {on: ram, at: [50 mm, 50 mm, 50 mm]}
"""


def written(folder: Path, old: str = "", new: str = "") -> Path:
    (folder / "ram.inp").write_text(MESH, encoding="utf-8")
    path = folder / "model.yaml"
    path.write_text(MODEL.replace(old, new) if old else MODEL, encoding="utf-8")
    return path


def test_every_key_reaches_the_noun(tmp_path: Path) -> None:
    structure = read_model(
        written(tmp_path, "material: steel}", "material: oak, orientation: [0, 1, 0], normal: [1, 0, 0]}")
    )
    (ram,) = structure.structure.parts
    assert isinstance(ram, Solid)
    assert isinstance(ram.material, Orthotropic)
    assert (ram.named, ram.orientation, ram.normal) == ("BODY", (0.0, 1.0, 0.0), (1.0, 0.0, 0.0))
    assert ram.mesh.points.max() == pytest.approx(0.1, rel=1e-12)  # rounding of mm


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("set: BODY", "set: BODI", "model.yaml:6:"),
        ("set: BODY", "set: FOOT", "'FOOT', a set without tetrahedra or hexahedra"),
        ("ram.inp", "rom.inp", "rom.inp"),
        ("material: steel}", "material: oak}", "the direction of the material's x"),
        ("material: steel}", "material: steel, orientation: [1, 0, 0]}", "isotropic: it has no direction"),
        ("material: steel}", "material: oak, orientation: [0, 0, 1]}", "across its normal"),
        ("material: steel}", "material: steel, thickness: 2 mm}", "unknown key 'thickness'"),
    ],
)
def test_mistakes_have_their_line(tmp_path: Path, old: str, new: str, told: str) -> None:
    with pytest.raises(InputErrors) as refused:
        read_model(written(tmp_path, old, new))
    assert told in str(refused.value)
    assert "model.yaml:6:" in str(refused.value)


@pytest.mark.parametrize(
    ("held", "turns"),
    [
        ("{on: ram, set: FOOT, fix: [rx]}", "rx"),
        ("{on: ram, fix: [x, ry, rz]}", "ry, rz"),
        ("{on: ram, box: [[-1, -1, -1], [1, 1, 0]], fix: [rz]}", "rz"),
    ],
)
def test_a_rotation_of_nodes_that_have_none_is_refused(held: str, turns: str, tmp_path: Path) -> None:
    """Nothing would be held. A place of a point turns with the face it is on, and can be held."""
    path = written(tmp_path, "{on: ram, set: FOOT, fix: [x, y, z]}", held)
    column = len("  floor: ") + held.index("fix") + 1
    told = f"model.yaml:8:{column}: supports.floor.fix: got {turns} of ram, whose nodes have no rotations, expected "
    with pytest.raises(InputErrors) as refused:
        modes_of(path, Extent(count=3))
    assert told + "directions out of x, y, z, which are all that nodes of solids have; write [x, y, z]" in str(
        refused.value
    )
    at_top = written(tmp_path, "{on: ram, set: FOOT, fix: [x, y, z]}", "{at: top, fix: [x, y, z, rz]}")
    assert modes_of(at_top, Extent(count=3))["rigid_body_modes"] == 2


def test_clamped_is_all_that_a_solid_has(tmp_path: Path) -> None:
    path = written(tmp_path, "fix: [x, y, z]", "fix: clamped")
    assert modes_of(path, Extent(count=3))["rigid_body_modes"] == 0
