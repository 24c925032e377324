"""What the README shows of files and commands is what the program has."""

import io
import re
import tomllib
from pathlib import Path

import pytest
import typer.main
from ruamel.yaml import YAML

from femstruct.cli import app
from femstruct.files.band_tables import read_bands
from femstruct.files.columns import read_columns
from femstruct.language.cases import read_study
from femstruct.language.models import read_model_file
from femstruct.model.mesher import mesh_structure

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
SHOWN = re.findall(r"`models/([\w.]+\.yaml)`:\n\n```yaml\n(.*?)```", README, re.DOTALL)


def read(text: str) -> dict[str, object]:
    return dict(YAML(typ="safe").load(io.StringIO(text)))


@pytest.mark.parametrize(("name", "text"), SHOWN, ids=[name for name, _ in SHOWN])
def test_files_shown_are_shipped_ones(name: str, text: str) -> None:
    shipped = read((ROOT / "models" / name).read_text(encoding="utf-8"))
    shown = read(text)
    assert shown == {key: shipped[key] for key in shown}


def test_a_model_and_a_study_are_shown() -> None:
    assert [name for name, _ in SHOWN] == ["small_plate.yaml", "steel_ball.study.yaml"]


def test_cases_shown_are_read(tmp_path: Path) -> None:
    """Beside the study shown above them; the first changes nothing and is the baseline."""
    (cases,) = re.findall(r"```yaml\n(cases:\n.*?)```", README, re.DOTALL)
    for name in ("small_plate.yaml", "steel_ball.study.yaml"):
        text = (ROOT / "models" / name).read_text(encoding="utf-8")
        (tmp_path / name).write_text(text + (cases if "study" in name else ""), encoding="utf-8")
    plan = read_study(tmp_path / "steel_ball.study.yaml")
    assert [case.name for case in plan.cases] == ["as built", "thick", "with a mass"]
    assert plan.baseline == "as built" and not plan.cases[0].changes
    assert len(plan.cases[2].study.structure.parts) == 2


PLATE = """\
materials: {BRICK}
parts: {floor: {type: plate, origin: [0, 0, 0], material: brick, thickness: 0.2, size: [5, 4], mesh: 0.5}}
points: {middle: {on: floor, at: center}}
supports: {rim: {on: floor, edge: all, fix: simple}}
"""


def test_a_plate_becomes_a_slab_as_it_is_said(tmp_path: Path) -> None:
    told = re.search(r"becomes a slab by (`.*?center`)", README, re.DOTALL)
    brick = re.search(r"`(brick: .*?)`", README)
    assert told and brick
    _, *keys = re.findall(r"`(\w+: [^`]*)`", told[1])  # type: slab, then the new one and the old one in turn
    text = PLATE.replace("BRICK", brick[1])
    (tmp_path / "plate.yaml").write_text(text, encoding="utf-8")
    for new, old in zip(keys[::2], keys[1::2], strict=True):
        assert old in text
        text = text.replace(old, new)
    (tmp_path / "slab.yaml").write_text(text.replace("type: plate", "type: slab"), encoding="utf-8")
    for name in ("plate.yaml", "slab.yaml"):
        mesh_structure(read_model_file(tmp_path / name).structure)


def test_every_command_has_its_line() -> None:
    commands = set(typer.main.get_command(app).commands)  # type: ignore[attr-defined]
    assert commands == set(re.findall(r"`femstruct ([a-z-]+)", README))


def test_the_dampers_are_named_by_their_mass_over_that_of_the_floor() -> None:
    model = read((ROOT / "models" / "floor_frame_slab.yaml").read_text(encoding="utf-8"))
    study = read((ROOT / "models" / "floor_tennis_ball.study.yaml").read_text(encoding="utf-8"))
    floor = model["parts"]["floor"]
    density = float(model["materials"][floor["material"]]["rho"].split()[0])
    mass = density * 1e-3 * float(floor["thickness"].split()[0]) * floor["size"][0] * floor["size"][1]
    assert f"({mass:.2f} kg)" in README
    for ratio, damper in (("0.6", "0.45"), ("1.2", "0.90")):
        assert study["cases"][f"damper {ratio}"] == {"bodies.damper.mass": f"{damper} kg"}
        assert float(damper) == pytest.approx(float(ratio) * mass, rel=1e-9)  # rounding
    assert re.search(r"0\.6 and 1\.2 times the mass of the floor .* 0\.45 and 0\.90 kg", README)


SOURCE_FILES = re.findall(r"^\| `([a-z_]+: .*?)` \| .* \| `(.*)`, `(.*)` \|$", README, re.MULTILINE)
COLUMNS = {  # what the program reads there
    "blocked_force: {file: ..}": ("force",),
    "free_velocity: {file: ..}": ("speed",),
    "mobility: {file: ..}": ("mobility",),
    "mobility: {lines: ..}": ("frequency", "mobility", "mobility"),
    "blocked_force: {psd: {file: ..}}": ("frequency", "force psd"),
    "reduction: {file: ..}": ("level",),
    "footstep: ..": ("time", "force"),
}


def test_files_of_sources_are_read_as_they_are_shown(tmp_path: Path) -> None:
    assert [key for key, _, _ in SOURCE_FILES] == list(COLUMNS)
    for key, head, row in SOURCE_FILES:
        file = tmp_path / "a.csv"
        first, *values = re.split(r"[;,] ", row)
        second = f"{2 * float(first):g}"  # a band or a time later
        rows = [head, row, row.replace(first, second, 1)]
        file.write_text("\n".join(rows), encoding="utf-8")
        dimensions = COLUMNS[key]
        if len(dimensions) == 1:
            assert list(read_bands(file, dimensions[0], {})) == [float(first), float(second)]
        else:
            columns = read_columns(file, dimensions, {}, lambda *found: found)
            assert [column[0] for column in columns] == [float(one) for one in (first, *values)]


def test_extras_are_those_of_the_clone() -> None:
    """No package of this name is meant but the one in the folder."""
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    named = re.findall(r"pip install (?:-q )?(?:-e )?'?([\w.]*)\[(\w+)\]", README)
    assert named and all(package == "." and extra in extras for package, extra in named)


def test_pages_that_are_named_exist() -> None:
    for path in re.findall(r"`((?:docs|femstruct|scripts|models)/[\w/.]+|[A-Z]+\.md)`", README):
        assert (ROOT / path).exists(), path
