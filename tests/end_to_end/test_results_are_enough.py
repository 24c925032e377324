"""results.h5 is enough: pages, tables, pictures and sounds of a run are made of it again, byte for byte."""

from __future__ import annotations

import csv
import json
import shutil
import sys
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from typer.testing import CliRunner

from femstruct.cli import app
from femstruct.errors import FemstructError, InputError
from femstruct.exits import leave_with
from femstruct.files.results_file import read_results
from femstruct.files.sheets import Sheet, _rows
from femstruct.files.writing import NAME
from femstruct.view.page import report
from femstruct.workflow import run as solving

MODEL = """
materials: {concrete: {E: 30 GPa, nu: 0.2, rho: 2400}}
parts: {slab: {type: plate, material: concrete, thickness: 0.15 m, origin: [0, 0, 2.5], size: [3, 2], mesh: [6, 4]}}
supports: {edges: {on: slab, edge: all, fix: simple}}
points: {drops: {on: slab, at: [[1.2, 0.8], [0.6, 1.3]]}, other: {on: slab, at: [[2, 1], [2.2, 1]]}}
surfaces: {ceiling: {on: slab, side: below}}
damping: {loss_factor: 5 %}
"""
STUDY = """model: model.yaml
modes: {up_to: 500 Hz}
bodies: {ball: {source: rubber ball, above: drops}}
record: {ball on drops: force, other.1.z: [velocity, acceleration]}
frf: {push: {drive: other.1.z, response: other.2.z, band: [1 Hz, 400 Hz], kind: mobility, step: 1 Hz}}
limits: {bedroom rating: 58 dB}
time: {duration: 0.3 s, sampling: 4 kHz}
rooms:
  bedroom:
    size: [3, 2, 2.5]
    under: ceiling
    losses: {t60: 0.4 s}
    receivers: {mic: [[0.8, 0.7, 1.2], [2.1, 1.1, 1.5]]}
    levels: [ISO 16283-2, ISO 717-2]
cases: {as it is: {}, thick: {parts.slab.thickness: 0.2 m}}
"""


def call(*words: object) -> tuple[int, str]:
    """Exit code and what is printed, by the command line as it is."""
    runner = CliRunner()
    told = runner.invoke(app, [str(word) for word in words], catch_exceptions=True)
    if told.exception is not None and not isinstance(told.exception, SystemExit):
        error = told.exception

        def again() -> None:
            raise error

        return leave_with(again), str(error)
    return told.exit_code, told.stdout


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What `femstruct run` leaves of two cases, two drops, a room that is rated, a response."""
    work = tmp_path_factory.mktemp("run")
    (work / "model.yaml").write_text(MODEL, encoding="utf-8")
    (work / "one.study.yaml").write_text(STUDY, encoding="utf-8")
    code, told = call("run", work / "one.study.yaml", "-o", work / "out")
    assert code in (0, 3), told
    return work / "out"


@pytest.fixture
def unsolved(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whoever solves anything fails."""
    monkeypatch.delattr(solving, "solve_all")
    monkeypatch.delattr(solving, "run_case")


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_report_makes_the_same_files(folder: Path, tmp_path: Path, unsolved: None) -> None:
    """Pictures, sounds, summary.json, modes of the room, the page: from the file alone, in its folder and elsewhere."""
    made = contents(folder)
    assert sum(name.endswith(".png") for name in made) >= 12 and "listen.bedroom.mic.1.wav" in made
    alone = tmp_path / "alone"
    alone.mkdir()
    shutil.copyfile(folder / "results.h5", alone / "results.h5")
    code, _ = call("report", alone / "results.h5")
    assert code in (0, 3)
    assert contents(alone) == made
    call("report", folder, "-o", tmp_path / "elsewhere", "--no-pictures")
    there = contents(tmp_path / "elsewhere")
    assert {name for name in made if not name.endswith(".png")} == set(there)
    assert all(there[name] == made[name] for name in there if name not in (NAME, "report.html"))


def test_what_is_printed_is_what_run_prints(folder: Path, tmp_path: Path) -> None:
    code, told = call("report", folder, "-o", tmp_path / "a", "--no-pictures", "--json")
    assert json.loads(told) == json.loads((folder / "summary.json").read_text())
    severe = any(finding["severe"] for finding in json.loads(told)["findings"])
    assert code == (3 if severe else 0)
    assert "impact sound by the standards" in call("report", folder, "-o", tmp_path / "a", "--no-pictures")[1]
    assert not list((tmp_path / "a").glob("*.png"))


def test_a_folder_belongs_to_one_run(folder: Path, tmp_path: Path) -> None:
    """What an earlier report left and this one does not make is removed; the list names what is there now."""
    out = tmp_path / "out"
    shutil.copytree(folder, out)
    (out / "mine.txt").write_text("somebody's own")
    call("report", folder, "-o", out, "--no-pictures")
    left = {path.name for path in out.iterdir()} - {NAME, "mine.txt"}
    assert (out / "mine.txt").exists() and not any(name.endswith(".png") for name in left)
    assert set(json.loads((out / NAME).read_text())["written by the last run"]) == left


def test_plot_draws_one_picture(folder: Path, tmp_path: Path, unsolved: None) -> None:
    code, told = call("plot", folder, "history_ball_on_drops.1_force", "-o", tmp_path)
    assert code == 0 and told.strip() == str(tmp_path / "history_ball_on_drops.1_force.png")
    drawn = (tmp_path / "history_ball_on_drops.1_force.png").read_bytes()
    assert drawn == (folder / "history_ball_on_drops.1_force.png").read_bytes()
    code, told = call("plot", folder, "--json")
    names = json.loads(told)["pictures"]
    flat = {path.stem for path in folder.glob("*.png")} - {"pressure_surfaces_bedroom"}
    assert code == 0 and {name for name in flat if not name.startswith("mode_shapes")} <= set(names)
    assert {"mode_shapes", "rooms"} <= set(names)


def test_plot_of_something_unknown_lists_what_there_is(folder: Path, tmp_path: Path) -> None:
    code, told = call("plot", folder, "histry_ball_on_drops.1_force", "-o", tmp_path)
    assert code == 2 and "did you mean 'history_ball_on_drops.1_force'?" in told
    assert ", energy, " in told.replace("\n", " ") and "more mistakes" not in told and not list(tmp_path.iterdir())
    code, told = call("plot", folder, "own_sound_bedroom", "-o", tmp_path)
    assert (
        code == 2 and "nothing to show in this study: no body radiates there" in told and not list(tmp_path.iterdir())
    )
    code, told = call("plot", folder)
    assert code == 0 and "own_sound_bedroom" not in told
    code, told = call("plot", folder, "-v")
    assert code == 0 and "own_sound_bedroom: without content; no body radiates there" in told


def test_what_is_read_draws_what_was_run(folder: Path) -> None:
    """The page without its files: the same from the same nouns."""
    page = report(read_results(folder / "results.h5"))
    assert "<h1>" in page and "bedroom" in page


@pytest.mark.parametrize("command", [["report"], ["plot", "energy"], ["export"]])
def test_no_file_and_no_whole_file(folder: Path, tmp_path: Path, command: list[str]) -> None:
    """One plain sentence each, and 2."""
    word, *more = command
    data = (folder / "results.h5").read_bytes()
    (tmp_path / "cut.h5").write_bytes(data[:100_000])
    (tmp_path / "flip.h5").write_bytes(data[:5000] + bytes([data[5000] ^ 4]) + data[5001:])
    for name, told in (("none.h5", "no such file"), ("cut.h5", "cut short"), ("flip.h5", "damaged")):
        code, said = call(word, tmp_path / name, *more, "-o", tmp_path / "out")
        assert code == 2 and told in said and len(said.strip().splitlines()) == 1, said
    assert not (tmp_path / "out").exists()


def test_errors_are_of_this_project(folder: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        read_results(tmp_path)
    assert issubclass(InputError, FemstructError)


def cells(path: Path, sheet: int) -> list[list[float | str]]:
    """A sheet of a workbook as Excel reads it: numbers, and texts by their number in the shared table."""
    name = "{http://schemas.openxmlformats.org/spreadsheetml/2006/main}"
    with zipfile.ZipFile(path) as book:
        texts = ["".join(one.itertext()) for one in ElementTree.fromstring(book.read("xl/sharedStrings.xml"))]
        page = ElementTree.fromstring(book.read(f"xl/worksheets/sheet{sheet}.xml"))

    def value(cell: ElementTree.Element) -> float | str:
        text = cell.findtext(f"{name}v", "")
        return texts[int(text)] if cell.get("t") == "s" else float(text)

    return [[value(cell) for cell in row if cell.find(f"{name}v") is not None] for row in page.iter(f"{name}row")]


def test_export_writes_what_the_nouns_say(folder: Path, tmp_path: Path, unsolved: None) -> None:
    """Third octaves first, then ratings, of all cases: as comma-separated values and as a workbook."""
    result = read_results(folder / "results.h5")
    code, told = call("export", folder, "--to", "csv", "-o", tmp_path, "--json")
    paths = json.loads(told)["written"]
    assert code == 0 and [Path(path).name for path in paths[:2]] == ["out.third_octaves.csv", "out.ratings.csv"]
    with Path(paths[0]).open(encoding="utf-8-sig", newline="") as file:
        head, *rows = csv.reader(file)
    assert head[:2] == ["band_hz", "as it is: bedroom.mic.1 bands_db (L_Fmax)"] and len(head) == 1 + 2 * 2
    levels = result.cases["thick"].levels["bedroom.mic.2"].bands_db
    assert [float(row[0]) for row in rows] == list(levels)
    found = {float(row[0]): float(row[4]) if row[4] else None for row in rows}
    assert found == {band: level if np.isfinite(level) else None for band, level in levels.items()}
    with Path(paths[1]).open(encoding="utf-8-sig", newline="") as file:
        ratings = list(csv.DictReader(file))
    rated = {
        (name, symbol): one
        for name, case in result.cases.items()
        for symbol, one in case.rated["bedroom"].numbers.items()
    }
    assert [(row["case"], row["number"]) for row in ratings] == list(rated)
    assert [float(row["value_db"]) for row in ratings] == [one.value_db for one in rated.values()]
    code, told = call("export", folder, "--to", "xlsx", "-o", tmp_path)
    assert code == 0 and told.strip() == str(tmp_path / "out.xlsx")
    assert cells(tmp_path / "out.xlsx", 1)[0] == head
    assert [row[3] for row in cells(tmp_path / "out.xlsx", 2)[1:]] == [one.value_db for one in rated.values()]


def test_export_without_its_package_says_what_to_install(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "xlsxwriter", None)
    code, told = call("export", folder, "--to", "xlsx", "-o", tmp_path)
    assert code == 2 and "pip install xlsxwriter" in told and not list(tmp_path.iterdir())


def test_blows_have_a_row_each() -> None:
    """Lists of a table are rows, and what is one number is repeated."""
    rows = _rows("blows", ("case",), [(("a",), {"t_s": [0.0, 1.0], "growth": 2.0, "inner": {}})])
    assert rows == Sheet("blows", ("case", "t_s", "growth"), [("a", 0.0, 2.0), ("a", 1.0, 2.0)])
