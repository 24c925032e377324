"""What files name, and what is named on the command line: ordinary files, where it is written that they are."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from femstruct.errors import InputErrors
from femstruct.files.columns import read_measured
from femstruct.language.cases import read_any, read_study
from femstruct.language.models import read_model_file

MODEL = "structure: {type: oscillator, mass: 1 kg, stiffness: 100 N/m}\npoints: {m: {}}\n"
LOAD = "loads: {push: {at: m.z, file: %s}}\ntime: {duration: 10 ms, sampling: 1 kHz}\n"
LAW = (
    "bodies: {ball: {mass: 1 kg, above: m, speed: 1 m/s, contact: {type: table, file: %s}}}\n"
    "time: {duration: 10 ms, sampling: 10 kHz}\n"
)
ROOM_MODEL = """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
parts: {plate: {type: plate, material: steel, thickness: 2 mm, origin: [0, 0, 0.3], size: [0.4, 0.3], mesh: [8, 6]}}
supports: {edges: {on: plate, edge: all, fix: simple}}
surfaces: {below: {on: plate, side: below}}
"""
ROOM = "rooms: {air: {mesh: %s, ceiling: top, under: below, losses: {t60: 1 s}, receivers: {mic: [0.1, 0.1, 0.1]}}}\n"
ROOM += "modes: {count: 3}\ntime: {duration: 10 ms, sampling: 1 kHz}\n"
KINDS = {
    "model": (MODEL, "title: a\nmodel: %s\n"),
    "history": (MODEL, f"model: model.yaml\n{LOAD}"),
    "law": (MODEL, f"model: model.yaml\n{LAW}"),
    "mesh": (ROOM_MODEL, f"model: model.yaml\n{ROOM}"),
}
SECRET = "alice: hunter2\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A study's folder inside another one."""
    (tmp_path / "inner").mkdir()
    return tmp_path / "inner"


def refusal(folder: Path, kind: str, name: str) -> str:
    """The one line that refuses a study which names a file so."""
    model, study = KINDS[kind]
    (folder / "model.yaml").write_text(model, encoding="utf-8")
    (folder / "a.study.yaml").write_text(study % name, encoding="utf-8")
    with pytest.raises(InputErrors) as refused:
        read_study(folder / "a.study.yaml")
    assert len(refused.value.errors) == 1, refused.value.errors
    (line,) = refused.value.errors
    return line


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("../pipe", "which is a pipe"),
        ("../zero", "a link that leads out of"),
        ("/dev/zero", "got the absolute path '/dev/zero', expected a path from this file's folder"),
        ("sub/../../secret", "with '..' behind a name"),
        ("link", "a link that leads out of"),
        ('"a\\0b"', "no text (U+0000)"),
        ('"\\ud800"', "no text"),
        ("..", "got the folder"),
        (".", "got the folder"),
        ("x" * 300, "File name too long"),
        ("circle", "Too many levels of symbolic links"),
    ],
)
def test_what_a_study_names_is_an_ordinary_file_where_it_says(folder: Path, kind: str, name: str, told: str) -> None:
    os.mkfifo(folder.parent / "pipe")
    (folder.parent / "zero").symlink_to("/dev/zero")
    (folder.parent / "secret").write_text(SECRET)
    (folder / "sub").mkdir()
    (folder / "link").symlink_to(folder.parent / "secret")
    (folder / "circle").symlink_to(folder / "circle")
    assert told in refusal(folder, kind, name)


def test_upwards_as_written_and_links_inside_are_followed(folder: Path) -> None:
    (folder.parent / "there.yaml").write_text(MODEL)
    (folder / "link.yaml").symlink_to(folder / "own.yaml")
    (folder / "own.yaml").write_text(MODEL)
    for name in ("../there.yaml", "link.yaml", "../inner/link.yaml"):
        (folder / "a.study.yaml").write_text(f"model: {name}\n")
        assert read_study(folder / "a.study.yaml").cases[0].study.structure.mass == 1.0


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    "text",
    [
        "root:x:0:0:hunter2:/root:/bin/bash\n" * 30,
        "hunter2\n" * 3,
        "- hunter2\n",
        SECRET,
        f"{SECRET}bob: [hunter2]\n",
        "time,force hunter2 hunter2\n1,2\nhunter2,1,hunter2\n",
    ],
)
def test_a_file_that_is_not_ours_is_not_quoted(folder: Path, kind: str, text: str) -> None:
    (folder / "secret.msh").write_text(text)
    assert "hunter2" not in refusal(folder, kind, "secret.msh")


@pytest.mark.parametrize("read", [read_any, read_model_file, read_study, lambda path: read_measured(path, "force")])
def test_pipes_and_devices_are_refused_at_once(tmp_path: Path, read) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "zero").symlink_to("/dev/zero")
    for name, told in (("pipe", "which is a pipe"), ("zero", "which is a device"), ("a\0b", "null byte")):
        with pytest.raises(InputErrors, match=told):
            read(tmp_path / name)
    with pytest.raises(InputErrors, match="cannot be read"):
        read(tmp_path / ("x" * 300))


def test_only_yaml_files_are_offered_for_a_name(tmp_path: Path) -> None:
    (tmp_path / "secrets.txt").write_text("x")
    (tmp_path / "zzz.yaml").write_text("x")
    with pytest.raises(InputErrors, match=r"known here: zzz\.yaml$"):
        read_any(tmp_path / "q")
