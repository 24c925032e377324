"""A folder that several runs write to holds what the last of them made, and what is nobody's business of theirs."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from femstruct.files.writing import COMING, EARLIER, NAME, WRITTEN, staged_folder
from femstruct.language.cases import read_study
from femstruct.study.results import StudyResult
from femstruct.workflow import run as output
from femstruct.workflow.run import run_study, write_all

MODEL = """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
parts: {plate: {type: plate, material: steel, thickness: 2 mm, origin: [0, 0, 0.3], size: [0.4, 0.3], mesh: [8, 6]}}
supports: {edges: {on: plate, edge: all, fix: simple}}
points: {off: {on: plate, at: [0.17, 0.11]}}
surfaces: {below: {on: plate, side: below}}
damping: {ratio: 2 %}
"""
STUDY = """
model: model.yaml
modes: {up_to: 500 Hz}
bodies: {ball: {mass: 10 g, above: off, speed: 1 m/s, contact: {type: hertz, stiffness: 1e8}}}
time: {duration: 50 ms, sampling: 8 kHz}
rooms:
  box: {size: [0.4, 0.3, 0.2], under: below, losses: {t60: 0.1 s}, receivers: {mic: [0.1, 0.1, 0.1]}}
cases:
  light: {}
  twice / new: {bodies.ball.mass: 20 g}
"""
LIGHT = {"light.box.mic.wav", "light.box.mic.wav.json"}
TWICE = {"twice _ new.box.mic.wav", "twice _ new.box.mic.wav.json"}

KILLED = """
import os, pathlib, signal, sys
from femstruct.files.writing import staged_folder
move, moves = pathlib.Path.replace, []
def replace(self, target):
    if self.parent.name.startswith(".run"):
        if len(moves) == int(sys.argv[2]):
            os.kill(os.getpid(), signal.SIGKILL)
        moves.append(target)
    return move(self, target)
pathlib.Path.replace = replace
with staged_folder(pathlib.Path(sys.argv[1])) as stage:
    for name in "abcdef":
        (stage.path / name).write_text("other")
"""
WAITS = """
import os, pathlib, signal, sys
from femstruct.files.writing import staged_folder
move = pathlib.Path.replace
def replace(self, target):
    os.kill(os.getpid(), signal.SIGINT)
    return move(self, target)
try:
    with staged_folder(pathlib.Path(sys.argv[1])) as stage:
        for name in "abc":
            (stage.path / name).write_text("other")
        pathlib.Path.replace = replace
except KeyboardInterrupt:
    print("interrupted")
"""


@pytest.fixture(scope="module")
def both(tmp_path_factory: pytest.TempPathFactory) -> dict[str, StudyResult]:
    """Of the study with both cases, and of each alone."""
    folder = tmp_path_factory.mktemp("study")
    (folder / "model.yaml").write_text(MODEL)
    (folder / "one.study.yaml").write_text(STUDY)
    return {
        str(only): run_study(read_study(folder / "one.study.yaml", only=only))
        for only in (None, "light", "twice / new")
    }


@pytest.fixture(autouse=True)
def no_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(output, "_drawn", lambda result, folder, clock: ([], ""))
    monkeypatch.setattr(output, "write_room_modes", lambda plan, path: None)


def names(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


def test_a_run_of_one_case_removes_the_sounds_of_the_other(both: dict[str, StudyResult], tmp_path: Path) -> None:
    write_all(both["None"], tmp_path)
    assert names(tmp_path) > LIGHT | TWICE
    (tmp_path / "mine.wav").write_text("not of any run")
    _, told = write_all(both["twice / new"], tmp_path)
    assert names(tmp_path) & (LIGHT | TWICE | {"mine.wav"}) == TWICE | {"mine.wav"}
    assert told.startswith("Removed") and "light.box.mic.wav" in told and "mine" not in told
    assert set(json.loads((tmp_path / NAME).read_text())[WRITTEN]) == names(tmp_path) - {"mine.wav", NAME}
    assert write_all(both["twice / new"], tmp_path)[1] == ""


def test_what_was_changed_since_is_kept(both: dict[str, StudyResult], tmp_path: Path) -> None:
    write_all(both["None"], tmp_path)
    with (tmp_path / "light.box.mic.wav").open("ab") as file:
        file.write(b"tag")
    write_all(both["twice / new"], tmp_path)
    assert names(tmp_path) & LIGHT == {"light.box.mic.wav"}


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.mark.parametrize("fault", [KeyboardInterrupt(), OSError(28, "No space left on device"), MemoryError()])
def test_a_run_that_does_not_finish_writing_leaves_the_one_before(
    fault: BaseException, both: dict[str, StudyResult], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Results, tables, sounds and pictures of one run, whatever fails last."""
    write_all(both["light"], tmp_path)
    before = contents(tmp_path)

    def fail(*arguments: object) -> None:
        raise fault

    with monkeypatch.context() as patch:
        patch.setattr(output, "write_report", fail)
        with pytest.raises(type(fault)):
            write_all(both["twice / new"], tmp_path)
    assert contents(tmp_path) == before
    write_all(both["twice / new"], tmp_path)
    assert names(tmp_path) & (LIGHT | TWICE) == TWICE


def test_interrupted_before_anything_was_there_nothing_is(
    both: dict[str, StudyResult], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(*arguments: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(output, "write_report", interrupt)
    with pytest.raises(KeyboardInterrupt):
        write_all(both["light"], tmp_path / "out")
    assert names(tmp_path / "out") == set()


@pytest.mark.parametrize("moved", range(1, 6))
def test_killed_while_files_take_their_places_the_list_tells(moved: int, tmp_path: Path) -> None:
    folder = tmp_path / "out"
    folder.mkdir()
    with staged_folder(folder) as stage:
        for name in "abcdef":
            (stage.path / name).write_text("one")
    killed = subprocess.run([sys.executable, "-c", KILLED, str(folder), str(moved)])
    assert killed.returncode == -signal.SIGKILL
    files = {name: (folder / name).read_text() for name in "abcdef"}
    assert sorted(files.values()) == ["one"] * (6 - moved) + ["other"] * moved
    assert json.loads((folder / NAME).read_text())[COMING] == list("abcdef")
    with staged_folder(folder) as stage:
        (stage.path / "g").write_text("third")
    assert names(folder) >= {"g", NAME} and not [name for name in names(folder) if name.startswith(".")]
    assert COMING not in json.loads((folder / NAME).read_text())


def test_ctrl_c_waits_while_files_take_their_places(tmp_path: Path) -> None:
    done = subprocess.run([sys.executable, "-c", WAITS, str(tmp_path)], capture_output=True, text=True)
    assert done.stdout == "interrupted\n", done.stderr
    assert names(tmp_path) == {*"abc", NAME}
    assert {(tmp_path / name).read_text() for name in "abc"} == {"other"}


def test_a_run_without_all_its_cases_removes_nothing_and_tells_what_is_older(
    both: dict[str, StudyResult], tmp_path: Path
) -> None:
    """Ctrl-C in the second case: what is finished is written beside what is there."""
    write_all(both["None"], tmp_path)
    _, said = write_all(replace(both["light"], plan=both["None"].plan), tmp_path)
    assert names(tmp_path) > LIGHT | TWICE
    told = json.loads((tmp_path / NAME).read_text())
    assert set(told[WRITTEN]) > LIGHT and set(told[EARLIER]) == TWICE
    assert said.startswith("Some cases are missing. These files are of an earlier run: twice _ new.box.mic.wav")


@pytest.mark.parametrize(
    "told", ["", "[1]", '{"a": 1}', f'{{"{WRITTEN}": {{"../x": 1, "sub": 0, "link": 1}}, "{EARLIER}": {{}}}}']
)
def test_nothing_outside_the_list_or_the_folder_is_removed(told: str, tmp_path: Path) -> None:
    folder = tmp_path / "results"
    (folder / "sub").mkdir(parents=True)
    (tmp_path / "x").write_text("1")
    (folder / "link").symlink_to(tmp_path / "x")
    (folder / NAME).write_text(told)
    with staged_folder(folder) as stage:
        (stage.path / "a").write_text("a")
    assert not stage.removed
    assert names(tmp_path) == {"results", "x"} and names(folder) == {"sub", "link", "a", NAME}
