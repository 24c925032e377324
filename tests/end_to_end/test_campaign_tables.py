"""Tables of sweeps and optimisations for a spreadsheet, and what commands on one run answer to their folders."""

import csv
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from femstruct.files.campaign_files import write_found, write_swept, write_table
from femstruct.study.campaigns import Scattered, Swept
from femstruct.study.optima import Chosen, Found, Search
from tests.data.command_line import femstruct

NUMBERS = [[[5.0, 7.5], [6.0, np.nan]], [[4.0, 6.5], [np.nan, np.nan]]]  # by case, sample and name


def rows() -> Swept:
    return Swept(
        title="hits",
        paths=("bodies.ball.mass", "points.m.at"),
        units=("kg", ""),
        texts=(("1 kg", "center"), ("2 kg", "[0, 1]")),
        values=[[1.0, np.nan], [2.0, np.nan]],
        method="grid",
        cases=("as built", "damper"),
        baseline="as built",
        names=("hit peak force", "mode 1 frequency"),
        number_units=("N", "Hz"),
        main=("hit peak force",),
        numbers=NUMBERS,
        done=np.array([True, False]),
        severe=(((), ()), (("mechanism",), ())),
        findings=(((), ()), (("mechanism",), ())),
        trouble=("", ""),
    )


def found() -> Found:
    mass = Scattered("bodies.ball.mass", "uniform", 1.0, 2.0, "kg")
    return Found(
        search=Search("hit.study.yaml", "mode 1 frequency", (mass,)),
        unit="Hz",
        goal=5.0,
        ends=(5.0, 5.0),
        chosen=(Chosen("bodies.ball.mass", "1 kg", 1.0, "kg", "lower", 0.1),),
        limits={},
        feasible=True,
        best=0,
        runs=2,
        designs=2,
        left_out=0,
        goals=np.array([5.0, 6.0]),
        held=np.array([True, True]),
        history=((1, 5.0),),
        spent=True,
        interrupted=False,
        rows=rows(),
    )


@pytest.fixture
def sweep(tmp_path: Path) -> Path:
    folder = tmp_path / "hit.sweep"
    folder.mkdir()
    write_swept(folder / "sweep.h5", rows())
    write_table(folder / "sweep.csv", rows())
    return folder


@pytest.fixture
def optimisation(tmp_path: Path) -> Path:
    folder = tmp_path / "hit.optimise"
    folder.mkdir()
    write_found(folder / "optimise.h5", found())
    (folder / "optimise.html").write_text("", encoding="utf-8")
    return folder


def cells(path: Path) -> list[list[str]]:
    """The first sheet of a workbook, cells as texts."""
    name = "{http://schemas.openxmlformats.org/spreadsheetml/2006/main}"
    with zipfile.ZipFile(path) as book:
        texts = ["".join(one.itertext()) for one in ElementTree.fromstring(book.read("xl/sharedStrings.xml"))]
        page = ElementTree.fromstring(book.read("xl/worksheets/sheet1.xml"))

    def value(cell: ElementTree.Element) -> str:
        text = cell.findtext(f"{name}v") or ""
        return texts[int(text)] if cell.get("t") == "s" else text

    return [[value(cell) for cell in row] for row in page.iter(f"{name}row")]


def test_a_sweep_is_written_as_a_workbook_and_as_csv(sweep: Path, tmp_path: Path) -> None:
    head = ["sample", "case", "bodies.ball.mass [kg]", "points.m.at", "hit peak force [N]", "mode 1 frequency [Hz]"]
    done = femstruct("export", sweep, "--to", "xlsx", "-o", tmp_path / "out")
    assert done.returncode == 0 and done.stdout.strip() == str(tmp_path / "out" / "hit.sweep.xlsx")
    book = cells(tmp_path / "out" / "hit.sweep.xlsx")
    assert book[0] == [*head, "severe findings", "trouble"]
    assert book[1][:6] == ["0", "as built", "1", "center", "5", "7.5"]
    assert book[2][:7] == ["0", "damper", "1", "center", "4", "6.5", "mechanism"]
    assert "not run" in book[3] and len(book) == 5
    assert femstruct("export", sweep, "--to", "csv", "-o", tmp_path / "out").returncode == 0
    with (tmp_path / "out" / "hit.sweep.samples.csv").open(encoding="utf-8-sig", newline="") as file:
        table = list(csv.DictReader(file))
    with (sweep / "sweep.csv").open(encoding="utf-8", newline="") as file:
        own = list(csv.DictReader(file))
    assert [{name: row[name] for name in own[0]} for row in table] == own
    assert [row["mode 1 frequency [Hz]"] for row in table] == ["7.5", "6.5", "", ""]


def test_an_optimisation_has_its_goal_first(optimisation: Path, tmp_path: Path) -> None:
    done = femstruct("export", optimisation / "optimise.h5", "--to", "xlsx", "-o", tmp_path)
    assert done.returncode == 0, done.stderr
    assert cells(tmp_path / "hit.optimise.xlsx")[0][4:6] == ["mode 1 frequency [Hz]", "hit peak force [N]"]


@pytest.mark.parametrize("command", [["report"], ["plot"], ["export", "--to", "vtu"], ["compare"]])
def test_commands_on_a_run_name_what_is_in_the_folder(
    command: list[str], sweep: Path, optimisation: Path, tmp_path: Path
) -> None:
    for folder, got, there in (
        (sweep, "a sweep", sweep / "sweep.csv"),
        (optimisation, "an optimisation", optimisation / "optimise.html"),
    ):
        others = [tmp_path] if command == ["compare"] else []
        done = femstruct(*command, folder, *others)
        assert done.returncode == 2 and f"{folder}" in done.stderr
        assert f"got {got}, expected one run, with its results.h5; open {there}, or" in done.stderr
        assert "no such file" not in done.stderr and len(done.stderr.strip().splitlines()) == 1
