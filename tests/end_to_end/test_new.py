"""Files to start from: every kind is written, checked and computed as it is; nothing is written over."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Callable
from math import log10
from pathlib import Path

import pytest

from femstruct.errors import InputError
from femstruct.templates import starting_files
from femstruct.templates.starting_files import KINDS, named, what_of, write_new
from tests.data.command_line import femstruct

ROOT = Path(__file__).parents[2]
# of each what makes it short; the rest is as it is shipped
SHORTER = {
    "joist-floor": ["modes.up_to=25 Hz", "time.duration=0.1 s"],
    "clt-floor": ["modes.up_to=60 Hz", "time.duration=0.1 s"],
    "slab": ["modes.up_to=150 Hz", "time.duration=0.1 s"],
    "floating-floor": ["modes.up_to=100 Hz", "time.duration=0.1 s"],
    "press": ["modes.up_to=100 Hz", "time.duration=0.1 s"],
    "hammer": [],
    "room": ["modes.up_to=60 Hz", "time.duration=0.1 s"],
}
THIRDS = (31.5, 40, 50, 63, 80, 100, 125, 160, 200, 250, 315, 400, 500)
Outputs = Callable[..., tuple[int, str, str]]


@pytest.fixture
def called(tmp_path: Path) -> Outputs:
    """The program in a folder of its own: exit code, output, errors."""

    def call(*words: str) -> tuple[int, str, str]:
        done = femstruct(*words, cwd=tmp_path)
        return done.returncode, done.stdout, done.stderr

    return call


LONG = ("joist-floor", "clt-floor", "floating-floor")  # 5 to 10 s each
SHORT_ONES = [pytest.param(kind, marks=pytest.mark.stress) if kind in LONG else kind for kind in KINDS]


@pytest.mark.parametrize("kind", LONG)
def test_each_long_kind_is_written_and_checked(kind: str, called: Outputs, tmp_path: Path) -> None:
    """The others are checked as they are written, and run, below."""
    code, out, _ = called("new", kind, "mine")
    assert code == 0 and out.startswith("mine.yaml and mine.study.yaml written")
    code, out, err = called("check", "mine.study.yaml", *(word for one in SHORTER[kind] for word in ("--set", one)))
    assert code == 0 and "forbids trust" not in out + err


@pytest.mark.parametrize("kind", SHORT_ONES)
def test_each_kind_is_checked_and_runs_as_it_is_written(kind: str, called: Outputs, tmp_path: Path) -> None:
    code, out, _ = called("new", kind, "mine")
    assert code == 0 and out.startswith("mine.yaml and mine.study.yaml written")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["mine.study.yaml", "mine.yaml"]
    code, out, err = called("check", "mine.study.yaml")
    assert code == 0 and "forbids trust" not in out + err
    sets = [word for one in SHORTER[kind] for word in ("--set", one)]
    code, out, err = called("run", "mine.study.yaml", "--no-pictures", "-o", "out", *sets)
    assert code == 0 and "forbids trust" not in out + err, out + err
    assert (tmp_path / "out" / "results.h5").exists()


def test_the_levels_of_a_floor_are_printed_by_sound(called: Outputs) -> None:
    called("new", "clt-floor")
    words = [word for one in SHORTER["clt-floor"] for word in ("--set", one)]
    code, out, err = called("sound", "clt_floor.study.yaml", *words)
    assert code == 0 and "mic" in out, err


def test_all_kinds_are_listed(called: Outputs, tmp_path: Path) -> None:
    code, out, _ = called("new")
    assert code == 0
    assert [line.split()[0] for line in out.splitlines()][: len(KINDS)] == list(KINDS)
    code, out, _ = called("new", "--json")
    assert code == 0 and [one["kind"] for one in json.loads(out)] == list(KINDS)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("kind", KINDS)
def test_what_a_kind_gives_is_what_its_study_asks_for(kind: str) -> None:
    """The highest third octave is that of which the modes reach 1.25 times the centre; a rating is asked for."""
    text = named(kind)[f"{kind.replace('-', '_')}.study.yaml"]
    told, modes = what_of(kind).rpartition(": ")[2], re.search(r"up_to: (\d+) Hz", text)
    if bands := re.search(r"up to (\d+) Hz", told):
        assert modes and "rooms:" in text
        shown = [band for band in THIRDS if 1.25 * 10 ** (round(10 * log10(band)) / 10) <= float(modes[1])]
        assert float(bands[1]) == shown[-1]
    assert ("rated" in told) == ("levels: [" in text)
    assert ("two cases" in told) == (text.count("cases:") == 1) and ("limits" in told) == ("limits:" in text)


def test_its_name_is_that_of_the_kind_unless_one_is_given(called: Outputs, tmp_path: Path) -> None:
    code, out, _ = called("new", "joist-floor", "--json")
    assert (code, json.loads(out)) == (0, {"model": "joist_floor.yaml", "study": "joist_floor.study.yaml"})
    assert "model: joist_floor.yaml\n" in (tmp_path / "joist_floor.study.yaml").read_text(encoding="utf-8")
    assert "model: our floor.yaml\n" in named("joist-floor", "our floor")["our floor.study.yaml"]


WRONG = {
    ("slabb",): "new: got 'slabb', expected one of joist-floor, .*; did you mean 'slab'\\?",
    (
        "slab",
        "a/b",
    ): "new: got 'a/b', expected a name without a folder and without \\.yaml; write fem",
    ("slab", "..\\b"): "new: got '\\.\\..*', expected a name without a folder",
    ("slab", "mine.yaml"): "new: got 'mine\\.yaml', expected a name without a folder and without \\.yaml",
}


@pytest.mark.parametrize("words", WRONG, ids=" ".join)
def test_a_wrong_word_is_one_line(words: tuple[str, ...], called: Outputs, tmp_path: Path) -> None:
    code, out, err = called("new", *words)
    assert (code, out) == (2, "") and len(err.strip().splitlines()) == 1
    with pytest.raises(InputError, match=WRONG[words]):
        write_new(*words, folder=tmp_path)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("there", ["slab.yaml", "slab.study.yaml"])
def test_nothing_is_written_over(there: str, called: Outputs, tmp_path: Path) -> None:
    (tmp_path / there).write_text("mine", encoding="utf-8")
    code, _, err = called("new", "slab")
    told = f"new: got {there}, which is here already, expected a new file; choose a name: femstruct new slab NAME"
    assert (code, err.strip()) == (2, told)
    assert [path.name for path in tmp_path.iterdir()] == [there]
    assert (tmp_path / there).read_text(encoding="utf-8") == "mine"


def test_they_are_data_of_the_package() -> None:
    """A wheel has them: their folder is a package, and its YAML files are listed as data."""
    listed = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["setuptools"]
    folder = Path(starting_files.__file__).parent
    assert listed["package-data"]["femstruct.templates"] == ["*.yaml"]
    found = {path.name for path in folder.glob("*.yaml")}
    assert found == {f"{kind.replace('-', '_')}{end}" for kind in KINDS for end in (".yaml", ".study.yaml")}
    assert all(what_of(kind) for kind in KINDS)
