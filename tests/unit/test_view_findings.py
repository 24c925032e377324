"""Findings for people, by rank on a terminal, in comments and on the page; for machines, all of them."""

from __future__ import annotations

import json
import re
import runpy
from dataclasses import replace
from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console
from typer.testing import CliRunner

from femstruct.cli import app
from femstruct.errors import Finding
from femstruct.files.results_file import read_results, write_results
from femstruct.files.study_tables import summary
from femstruct.files.tables import finding_from, finding_table, study_findings_table
from femstruct.study.results import StudyResult
from femstruct.view.console import show_findings
from femstruct.view.page import report
from femstruct.view.structure_tables import show_frf
from femstruct.view.terminal import show_study

AIR = Finding("two-way-coupling", "The air reacts.")
FLOAT = Finding("floating-floor", "It floats.")
TWIST = Finding("twist-defect", "Stiff in twist.", {"mean_excess": 0.1})
COARSE = Finding("coarse-mesh", "Too few <cells>.", severe=True)
FOUND = (AIR, TWIST, FLOAT, COARSE)
ORDER = ["coarse-mesh", "twist-defect", "two-way-coupling", "floating-floor"]
CODES = re.compile(r"(?:forbids trust|limits trust|remark), ([\w-]+):")


@pytest.fixture
def result() -> StudyResult:
    made = runpy.run_path(str(Path(__file__).parents[1] / "data" / "study_by_hand.py"))["study_by_hand"]()
    return replace(made, cases={name: replace(case, findings=FOUND) for name, case in made.cases.items()})


def shown(found: tuple[Finding, ...], verbose: bool) -> str:
    console = Console(file=StringIO(), width=60)
    show_findings(console, [(one, "") for one in found], verbose)
    return console.file.getvalue()


def test_remarks_are_counted_and_shown_on_demand() -> None:
    assert CODES.findall(shown(FOUND, verbose=False)) == ORDER[:2]
    assert shown(FOUND, verbose=False).endswith("  2 remarks: -v shows them\n")
    assert shown((AIR,), verbose=False).endswith("  1 remark: -v shows it\n")
    assert CODES.findall(shown(FOUND, verbose=True)) == ORDER
    assert "-v" not in shown(FOUND, verbose=True) and shown((), verbose=False) == ""


def test_comments_of_a_frequency_response(capsys: pytest.CaptureFixture[str]) -> None:
    columns = {"frequency_hz": [1.0], "real": [2.0], "imag": [3.0]}
    about = {"kind": "mobility", "response": "a.z", "drive": "a.z", "method": "modal", "unit": "m/s/N"}
    table = {**columns, **about, "findings": [finding_table(one) for one in FOUND]}
    for verbose in (False, True):
        show_frf(table, verbose)
        lines = capsys.readouterr().out.splitlines()
        assert CODES.findall("\n".join(lines)) == (ORDER if verbose else ORDER[:2])
        assert all(line.startswith("# ") for line in lines[:-1]) and not lines[-1].startswith("#")


def test_a_study_tells_them_and_the_page_has_all(result: StudyResult, capsys: pytest.CaptureFixture[str]) -> None:
    show_study(result, {})
    assert CODES.findall(capsys.readouterr().out) == ORDER[:2]
    show_study(result, {}, verbose=True)
    assert CODES.findall(capsys.readouterr().out) == ORDER
    page = report(result)
    assert re.findall(r"<li[^>]*>([\w-]+): ", page) == ORDER
    assert '<li class="severe">coarse-mesh: Too few &lt;cells&gt;.</li>' in page
    assert "<li>floating-floor: It floats.</li>" in page


def test_machines_have_all_with_their_ranks(result: StudyResult, tmp_path: Path) -> None:
    told = json.loads(json.dumps(summary(result)["findings"]))
    assert [one["code"] for one in told] == ORDER
    assert [one["rank"] for one in told] == ["forbids trust", "limits trust", "remark", "remark"]
    assert all(one["cases"] == list(result.cases) for one in told)
    write_results(tmp_path / "results.h5", result)
    assert study_findings_table(read_results(tmp_path / "results.h5")) == told
    assert [finding_from(one) for one in told] == [COARSE, TWIST, AIR, FLOAT]


@pytest.mark.parametrize("command", ["run", "check", "modes", "frf", "impact", "sound", "identify"])
def test_every_command_that_computes_has_the_option(command: str) -> None:
    told = CliRunner().invoke(app, [command, "--help"], env={"COLUMNS": "200"}).stdout
    assert re.search(r"-v, +--verbose|--verbose +-v", told)


def test_a_command_shows_remarks_on_demand() -> None:
    words = ["check", str(Path(__file__).parents[2] / "models" / "small_plate.yaml")]
    few, all_of_them = (CliRunner().invoke(app, [*words, *more]).stdout for more in ([], ["-v"]))
    hidden = re.search(r"(\d+) remarks?: -v", few)
    assert hidden and len(CODES.findall(all_of_them)) == len(CODES.findall(few)) + int(hidden[1])
