"""A run never silently takes the place of one with other inputs: that is kept beside it, whole, with a number."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from femstruct.errors import FemstructError
from femstruct.files.results_file import read_results
from femstruct.files.writing import INPUTS, NAME, move_previous_folder, staged_folder
from femstruct.language.cases import read_study
from femstruct.workflow import run as output
from femstruct.workflow.provenance import inputs_of
from femstruct.workflow.run import redraw
from femstruct.workflow.watch import rounds
from tests.data.command_line import femstruct

MODEL = "structure: {type: oscillator, mass: 1 kg, stiffness: 100 N/m}\npoints: {m: {}}\n"
STUDY = """
title: A hit
model: model.yaml
bodies: {ball: {mass: 1 kg, above: m, speed: 1 m/s, contact: {type: linear, stiffness: 1 MN/m}}}
record: {m.z: velocity}
time: {duration: 10 ms, sampling: 10 kHz}
cases: {light: {}, heavy: {structure.mass: 4 kg}}
"""
KILLED = """
import os, pathlib, signal, sys
from femstruct.files.writing import staged_folder
steps = []
def counted(what):
    def step(*arguments, **options):
        if len(steps) == int(sys.argv[2]):
            os.kill(os.getpid(), signal.SIGKILL)
        steps.append(what)
        return what(*arguments, **options)
    return step
with staged_folder(pathlib.Path(sys.argv[1]), inputs="new", keep=True) as stage:
    for name in "abc":
        (stage.path / name).write_text("new")
    os.link, pathlib.Path.rename = counted(os.link), counted(pathlib.Path.rename)
    pathlib.Path.replace = counted(pathlib.Path.replace)
print(len(steps))
"""


@pytest.fixture
def study(tmp_path: Path) -> Path:
    (tmp_path / "model.yaml").write_text(MODEL, encoding="utf-8")
    path = tmp_path / "hit.study.yaml"
    path.write_text(STUDY, encoding="utf-8")
    return path


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def text(folder: Path) -> dict[str, str]:
    return {path.name: path.read_text() for path in folder.iterdir() if path.name != NAME}


def put(folder: Path, inputs: str, *names: str) -> None:
    folder.mkdir(exist_ok=True)
    with staged_folder(folder, inputs=inputs, keep=True) as stage:
        for name in names:
            (stage.path / name).write_text(inputs)


def test_a_run_of_other_inputs_is_kept_and_the_same_is_replaced(study: Path, tmp_path: Path) -> None:
    folder = tmp_path / "out"
    run = ["run", study, "-o", folder, "--no-pictures"]
    first = femstruct(*run)
    assert first.returncode == 0 and "now in" not in first.stderr
    again = femstruct(*run)
    assert not (tmp_path / "out.1").exists() and "now in" not in again.stderr
    (folder / "notes.txt").write_text("mine")
    before = contents(folder)
    other = femstruct(*run, "--set", "bodies.ball.mass=2 kg", "--json")
    assert f"The run of other inputs that was in {folder} is now in {tmp_path / 'out.1'}" in other.stderr
    assert "cases" in json.loads(other.stdout)
    assert contents(tmp_path / "out.1") == {name: one for name, one in before.items() if name != "notes.txt"}
    assert (folder / "notes.txt").read_text() == "mine"
    masses = [read_results(one).plan.cases[0].study.bodies[0].mass for one in (tmp_path / "out.1", folder)]
    assert masses == [1.0, 2.0]
    one = femstruct(*run, "--set", "bodies.ball.mass=2 kg", "--case", "light")  # the other case would be gone
    assert "out.2" in one.stderr and list(read_results(tmp_path / "out.2").cases) == ["light", "heavy"]
    told = femstruct(*run, "--replace")
    assert "now in" not in told.stderr and not (tmp_path / "out.3").exists()
    assert redraw(folder / "results.h5", folder, pictures=False, keep=pytest.fail)


def test_inputs_are_the_files_and_what_is_changed_in_them(study: Path) -> None:
    plan = read_study(study)
    own = inputs_of(plan)
    elsewhere = {f"elsewhere/{Path(name).name}": one for name, one in plan.sources.items()}
    assert inputs_of(replace(plan, sources=elsewhere, positions={})) == own
    assert inputs_of(read_study(study, ("time.duration=11 ms",))) != own
    assert inputs_of(read_study(study, only="light")) != own
    study.write_text(STUDY + "# a word\n", encoding="utf-8")
    assert inputs_of(read_study(study)) != own  # the page shows the files as they are


def test_killed_at_any_step_both_runs_are_whole_or_the_new_one_is_not_there(tmp_path: Path) -> None:
    """Three files and their list are linked, one folder is named, the list and three files take their places."""
    steps = 4 + 1 + 1 + 3 + 1
    for step in range(steps + 1):
        folder = tmp_path / f"{step}" / "out"
        folder.parent.mkdir()
        put(folder, "old", "a", "b", "d")
        line = [sys.executable, "-c", KILLED, str(folder), str(step)]
        process = subprocess.run(line, capture_output=True, text=True)
        kept = folder.with_name("out.1")
        if step < steps:
            assert process.returncode == -signal.SIGKILL, process.stderr
        else:
            assert process.stdout.strip() == f"{steps}", process.stderr
        if kept.exists():
            assert text(kept) == dict.fromkeys("abd", "old")
        else:
            assert step <= 4 and text_of(folder) == dict.fromkeys("abd", "old")
    assert text(folder) == dict.fromkeys("abc", "new")


def text_of(folder: Path) -> dict[str, str]:
    return {path.name: path.read_text() for path in folder.iterdir() if path.is_file() and path.name != NAME}


def test_where_nothing_can_be_written_beside_it_is_kept_inside(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder, true = tmp_path / "out", os.access
    put(folder, "old", "a")
    with monkeypatch.context() as patch:
        patch.setattr(os, "access", lambda path, mode: Path(path) != tmp_path and true(path, mode))
        patch.setattr(os, "link", lambda *paths: (_ for _ in ()).throw(OSError(18, "another disk")))
        put(folder, "new", "a")
    assert text(folder / "out.1") == {"a": "old"} and (folder / "a").read_text() == "new"
    with monkeypatch.context() as patch:
        patch.setattr(Path, "mkdir", lambda *arguments, **options: (_ for _ in ()).throw(OSError(28, "No space left")))
        with pytest.raises(FemstructError, match=r"No space left while keeping the earlier run.*--replace"):
            move_previous_folder(folder, ["a"])
    assert (folder / "a").read_text() == "new"


def test_what_is_unknown_is_kept_and_what_somebody_changed_stays(tmp_path: Path) -> None:
    folder = tmp_path / "out"
    put(folder, "old", "a", "b")
    told = json.loads((folder / NAME).read_text())
    assert told.pop(INPUTS) == "old"
    (folder / NAME).write_text(json.dumps(told))  # as older versions wrote it
    (folder / "b").write_text("changed by hand")
    put(folder, "new", "a")
    assert text(tmp_path / "out.1") == {"a": "old"} and text(folder) == {"a": "new", "b": "changed by hand"}


def test_a_watch_keeps_what_was_there_before_it_once(
    study: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, kept, changes = tmp_path / "out", list[str](), iter(("2 kg", "", "3 kg", ""))
    monkeypatch.setattr(output, "write_report", lambda result, path, **files: path.write_text("page"))
    put(folder, "old", "a")

    def wait() -> bool:
        mass = next(changes, None)
        if mass:
            study.write_text(STUDY.replace("mass: 1 kg", f"mass: {mass}"), encoding="utf-8")
        return mass is not None

    found = list(rounds(study, (), "", folder, wait=wait, keep=kept.append))
    assert [one.error for one in found] == [None] * len(found) and len(found) > 1
    assert len(kept) == 1 and text(tmp_path / "out.1") == {"a": "old"} and not (tmp_path / "out.2").exists()
