"""`femstruct reduce`, and a study of a structure with a reduced part and a constraint, from the command line on."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import femstruct as fs
from femstruct.cli import app
from femstruct.errors import InputError, InputErrors
from femstruct.files.results_file import read_results
from femstruct.language.models import read_model_file
from femstruct.workflow.check import inspect_file

FLOOR = """
materials: {concrete: {E: 30 GPa, nu: 0.2, rho: 2400, loss_factor: 1 %}}
parts:
  left: LEFT
  right: {type: plate, material: concrete, thickness: 100 mm, origin: [3, 0, 0], size: [2, 3], mesh: [4, 6]}
  machine: {type: block, mass: 50 kg, origin: [3.5, 1, 0.2], size: [0.5, 0.5, 0.3]}
joints: {line: {connect: [left, right]}}
points:
  p: {on: left, at: MIDDLE}
  feet: {on: right, at: [[0.5, 1], [1, 1], [1, 1.5], [0.5, 1.5]]}
  under: {on: machine, at: [0.25, 0.25, 0]}
supports: {west: WEST, east: {on: right, edge: x1, fix: [x, y, z]}}
constraints: {seat: {average: under, of: feet}}
damping: {from: materials}
"""
PLATE = "{type: plate, material: concrete, thickness: 100 mm, origin: [0, 0, 0], size: [3, 3], mesh: [6, 6]}"
BOX = "{on: left, box: [[-0.01, -1, -1], [0.01, 4, 1]], fix: [x, y, z]}"
STUDY = """
model: MODEL
modes: {up_to: 100 Hz}
bodies:
  ball: {mass: 2 kg, above: p, drop_height: 10 cm, contact: {type: hertz, stiffness: 1e7}}
record: {p.z: velocity, seat: force}
time: {duration: 40 ms, sampling: 20 kHz}
"""


def written(folder: Path, name: str, left: str, west: str, middle: str) -> Path:
    text = FLOOR.replace("LEFT", left).replace("WEST", west).replace("MIDDLE", middle)
    (folder / f"{name}.yaml").write_text(text)
    (folder / f"{name}.study.yaml").write_text(STUDY.replace("MODEL", f"{name}.yaml"))
    return folder / f"{name}.yaml"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("reduced")
    written(path, "whole", PLATE, "{on: left, edge: x0, fix: [x, y, z]}", "[1.5, 1.5]")
    written(path, "built", "{type: reduced, file: left.npz}", BOX, "[1.5, 1.5, 0]")
    return path


def femstruct(*words: object) -> tuple[int, str]:
    done = CliRunner().invoke(app, [str(word) for word in words])
    return done.exit_code, done.output


def test_a_blow_on_a_reduced_part_is_a_blow_on_the_part(folder: Path) -> None:
    code, told = femstruct(
        "reduce", folder / "whole.yaml", "--part", "left", "--up-to", "200 Hz", "-o", folder / "left.npz", "--json"
    )
    assert code == 0, told
    assert json.loads(told)["interface nodes"] == 15  # 7 of each of two edges, and the point
    found = {}
    for name in ("whole", "built"):
        code, told = femstruct("run", folder / f"{name}.study.yaml", "-o", folder / name, "--no-pictures")
        assert code == 0, told
        (case,) = read_results(folder / name / "results.h5").cases.values()
        found[name] = {channel.name: np.asarray(channel.values) for channel in case.channels.values()}
    for channel, exact in found["whole"].items():
        # the first period of the last mode: residual vectors stand for what either leaves out
        assert found["built"][channel] == pytest.approx(exact, abs=1e-2 * np.abs(exact).max()), channel


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--part", "lft", "-o", "a.npz"), "--part: got 'lft', expected a part with nodes: left, right, machine"),
        (("--part", "machine", "-o", "a.npz"), "parts.machine: got a rigid part, expected one that deforms"),
        (("--part", "left", "-o", "a.txt"), "--output: got 'a.txt', expected a file NAME.npz"),
        (
            ("--part", "left", "-o", "a.npz", "--up-to", "5 kg"),
            "--up-to: got '5 kg', which is a mass, expected",
        ),
        (("--part", "left", "-o", "a.npz", "--up-to", "9 Hz", "--count", "3"), "got both, expected one of them"),
    ],
)
def test_a_mistake_is_one_clear_line(folder: Path, words: tuple[str, ...], told: str, monkeypatch) -> None:
    monkeypatch.chdir(folder)
    shutil.rmtree(folder / "nothing", ignore_errors=True)
    with pytest.raises(Exception, match=r".") as caught:
        CliRunner().invoke(app, ["reduce", "whole.yaml", *words], catch_exceptions=False)
    assert told in str(caught.value)
    assert not (folder / "a.npz").exists()


RADIATING = """
materials: {concrete: {E: 30 GPa, nu: 0.2, rho: 2400, loss_factor: 1 %}}
parts: {slab: SLAB}
points: {p: {on: slab, at: MIDDLE}}
supports: {west: {on: slab, WEST, fix: [x, y, z]}, east: {on: slab, EAST, fix: [x, y, z]}}
surfaces: {under: {on: slab, side: below}}
"""
WHOLE = {
    "SLAB": "{type: slab, material: concrete, thickness: 0.1, outline: [[0, 0], [3, 0], [3, 2], [0, 2]], mesh: 0.25}",
    "MIDDLE": "[1.5, 1]",
    "WEST": "set: side 4",
    "EAST": "set: side 2",
}
AGAIN = {
    "SLAB": "{type: reduced, file: slab.npz}",
    "MIDDLE": "[1.5, 1, 0]",
    "WEST": "box: [[-0.01, -1, -1], [0.01, 4, 1]]",
    "EAST": "box: [[2.99, -1, -1], [3.01, 4, 1]]",
}


def radiating(folder: Path, name: str, words: dict[str, str]) -> Path:
    text = RADIATING
    for word, value in words.items():
        text = text.replace(word, value)
    (folder / f"{name}.yaml").write_text(text, encoding="utf-8")
    return folder / f"{name}.yaml"


def test_what_was_reduced_radiates_as_it_did(tmp_path: Path) -> None:
    """Volume velocities and mean squares of the modes over the underside."""
    source = radiating(tmp_path, "whole", WHOLE)
    code, told = femstruct("reduce", source, "--part", "slab", "--up-to", "600 Hz", "-o", tmp_path / "slab.npz")
    assert code == 0, told
    sums = []
    for path in (source, radiating(tmp_path, "again", AGAIN)):
        structure = read_model_file(path).structure
        assert isinstance(structure, fs.Structure)
        model = fs.mesh_structure(structure)
        basis = fs.modal_basis(fs.assemble(model), up_to=300.0)
        under = model.surfaces["under"]
        assert under.normals == pytest.approx(np.tile([0.0, 0.0, -1.0], (len(under.normals), 1)), abs=1e-12)  # rounding
        motion = under.rows @ basis.shapes.reshape(-1, basis.shapes.shape[-1])[:, :9]
        sums.append(np.concatenate([np.abs(under.weights @ motion), under.weights @ motion**2]))
    # what modes to twice the band leave of the shapes
    assert sums[1] == pytest.approx(sums[0], abs=2e-3 * np.max(sums[0]))


@pytest.mark.parametrize(
    ("region", "told"),
    [
        ("region: {box: [[5, 5, 5], [6, 6, 6]]}", "without a cell of slab"),
        ("region: {set: rim}", "expected whole, or a box; matrices have no sets"),
    ],
)
def test_surfaces_that_a_reduced_part_has_not(region: str, told: str, tmp_path: Path) -> None:
    source = radiating(tmp_path, "whole", WHOLE)
    femstruct("reduce", source, "--part", "slab", "--count", "3", "-o", tmp_path / "slab.npz")
    path = radiating(tmp_path, "again", AGAIN)
    path.write_text(path.read_text(encoding="utf-8").replace("side: below", f"side: below, {region}"), encoding="utf-8")
    with pytest.raises((InputError, InputErrors)) as refused:
        inspect_file(path)
    assert told in str(refused.value) and "again.yaml:6:" in str(refused.value)


HELD = """
materials: {concrete: {E: 30 GPa, nu: 0.2, rho: 2400}}
parts: {slab: SLAB}
points: {p: {on: slab, at: MIDDLE}}
supports: {border: {on: slab, set: SET, fix: [x, y, z]}}
"""


def held(folder: Path, name: str, words: dict[str, str], named: str) -> Path:
    text = HELD.replace("SLAB", words["SLAB"]).replace("MIDDLE", words["MIDDLE"]).replace("SET", named)
    (folder / f"{name}.yaml").write_text(text, encoding="utf-8")
    return folder / f"{name}.yaml"


def test_what_held_a_part_is_a_set_of_the_reduced_one(tmp_path: Path) -> None:
    """A slab on its rim, reduced and held again by the name of the support: the same frequencies."""
    source = held(tmp_path, "whole", WHOLE, "rim")
    code, told = femstruct("reduce", source, "--part", "slab", "--up-to", "600 Hz", "-o", tmp_path / "slab.npz")
    assert code == 0, told
    assert "supports border: not in the file; hold set 'border' again where it is used" in told
    assert "residual vectors: " in told and " in place of " in told
    frequencies = []
    for path in (source, held(tmp_path, "again", AGAIN, "border")):
        structure = read_model_file(path).structure
        assert isinstance(structure, fs.Structure)
        basis = fs.modal_basis(fs.assemble(fs.mesh_structure(structure)), up_to=300.0)
        frequencies.append(basis.frequency_hz[basis.modes][:5])
    assert frequencies[1] == pytest.approx(frequencies[0], rel=1e-6)  # twice the band kept
    with pytest.raises((InputError, InputErrors)) as refused:
        inspect_file(held(tmp_path, "wrong", AGAIN, "rim"))
    assert "wrong.yaml:5:" in str(refused.value) and "'rim', no set of slab, expected border" in str(refused.value)
