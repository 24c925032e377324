"""A folder that several runs write to holds what the last of them made, and what is nobody's business of theirs."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from femstruct.files.atomic import replacing
from femstruct.files.belongings import EARLIER, NAME, WRITTEN, owning
from femstruct.language import read_study
from femstruct.study.result import StudyResult
from femstruct.workflow import output
from femstruct.workflow.output import write_all
from femstruct.workflow.run import run_study

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
    monkeypatch.setattr(output, "plot_all", lambda result, folder: [])
    monkeypatch.setattr(output, "shapes_all", lambda result, folder: ([], ""))
    monkeypatch.setattr(output, "room_pictures", lambda result, folder: ([], ""))
    monkeypatch.setattr(output, "write_room_modes", lambda plan, path: None)


def names(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


def test_a_run_of_one_case_removes_the_sounds_of_the_other(both: dict[str, StudyResult], tmp_path: Path) -> None:
    write_all(both["None"], tmp_path)
    assert names(tmp_path) > LIGHT | TWICE
    (tmp_path / "mine.wav").write_text("not of any run")
    _, told = write_all(both["twice / new"], tmp_path)
    assert names(tmp_path) & (LIGHT | TWICE | {"mine.wav"}) == TWICE | {"mine.wav"}
    assert told.startswith("removed") and "light.box.mic.wav" in told and "mine" not in told
    assert set(json.loads((tmp_path / NAME).read_text())[WRITTEN]) == names(tmp_path) - {"mine.wav", NAME}
    assert write_all(both["twice / new"], tmp_path)[1] == ""


def test_what_was_changed_since_is_kept(both: dict[str, StudyResult], tmp_path: Path) -> None:
    write_all(both["None"], tmp_path)
    with (tmp_path / "light.box.mic.wav").open("ab") as file:
        file.write(b"tag")
    write_all(both["twice / new"], tmp_path)
    assert names(tmp_path) & LIGHT == {"light.box.mic.wav"}


def test_interrupted_writing_removes_nothing_and_the_next_run_clears(
    both: dict[str, StudyResult], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_all(both["light"], tmp_path)

    def interrupt(*arguments: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(output, "write_report", interrupt)
        with pytest.raises(KeyboardInterrupt):
            write_all(both["twice / new"], tmp_path)
    assert names(tmp_path) > LIGHT | TWICE
    told = json.loads((tmp_path / NAME).read_text())
    assert set(told[WRITTEN]) > TWICE and set(told[EARLIER]) > LIGHT and not set(told[WRITTEN]) & LIGHT
    write_all(both["light"], tmp_path)
    assert names(tmp_path) & (LIGHT | TWICE) == LIGHT


def test_a_run_without_all_its_cases_removes_nothing(both: dict[str, StudyResult], tmp_path: Path) -> None:
    """Ctrl-C in the second case: what is finished is written beside what is there."""
    write_all(both["None"], tmp_path)
    write_all(replace(both["light"], plan=both["None"].plan), tmp_path)
    assert names(tmp_path) > LIGHT | TWICE
    told = json.loads((tmp_path / NAME).read_text())
    assert set(told[WRITTEN]) > LIGHT and set(told[EARLIER]) == TWICE


@pytest.mark.parametrize(
    "told", ["", "[1]", '{"a": 1}', f'{{"{WRITTEN}": {{"../x": 1, "sub": 0, "link": 1}}, "{EARLIER}": {{}}}}']
)
def test_nothing_outside_the_list_or_the_folder_is_removed(told: str, tmp_path: Path) -> None:
    folder = tmp_path / "results"
    (folder / "sub").mkdir(parents=True)
    (tmp_path / "x").write_text("1")
    (folder / "link").symlink_to(tmp_path / "x")
    (folder / NAME).write_text(told)
    with owning(folder) as removed, replacing(folder / "a") as temporary:
        temporary.write_text("a")
    assert not removed
    assert names(tmp_path) == {"results", "x"} and names(folder) == {"sub", "link", "a", NAME}
