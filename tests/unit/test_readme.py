"""What the README shows of files and commands is what the program has."""

import io
import re
from pathlib import Path

import pytest
import typer.main
from ruamel.yaml import YAML

from femstruct.cli import app

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


def test_every_command_has_its_line() -> None:
    commands = set(typer.main.get_command(app).commands)  # type: ignore[attr-defined]
    assert commands == set(re.findall(r"`femstruct ([a-z-]+)", README))


def test_pages_that_are_named_exist() -> None:
    for path in re.findall(r"`((?:docs|femstruct|scripts|models)/[\w/.]+|[A-Z]+\.md)`", README):
        assert (ROOT / path).exists(), path
