"""Finished runs side by side: the numbers of both as they are, and beside the baseline of the first."""

import subprocess
import sys
from pathlib import Path

import pytest

from femstruct.errors import InputError
from femstruct.files.results_file.results import write_results
from femstruct.files.results_file.stored import read_results
from femstruct.language import read_study
from femstruct.study.result import StudyResult
from femstruct.workflow.compare.finished import beside, differences, names_of
from femstruct.workflow.run.run import run_study
from tests.data.command_line import femstruct

MODEL = "structure: {type: oscillator, mass: 1 kg, stiffness: 100 N/m}\npoints: {m: {}}\n"
STUDY = """
title: A hit
model: model.yaml
bodies: {ball: {mass: 1 kg, above: m, speed: 1 m/s, contact: {type: linear, stiffness: 1 MN/m}}}
record: {m.z: velocity}
limits: {m.z velocity: 1.2 m/s}
time: {duration: 10 ms, sampling: 10 kHz}
"""


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """A light ball, and a heavy one on a mass of two kinds."""
    made = {}
    for name, ball, more in (("light", "1 kg", ""), ("heavy", "3 kg", "cases: {one: {}, two: {structure.mass: 2 kg}}")):
        folder = tmp_path_factory.mktemp(name)
        (folder / "model.yaml").write_text(MODEL, encoding="utf-8")
        (folder / "hit.study.yaml").write_text(STUDY.replace("mass: 1 kg", f"mass: {ball}") + more, encoding="utf-8")
        write_results(folder / "results.h5", run_study(read_study(folder / "hit.study.yaml")))
        made[name] = folder
    return made


@pytest.fixture(scope="module")
def read(runs: dict[str, Path]) -> dict[str, StudyResult]:
    return {name: read_results(folder) for name, folder in runs.items()}


def test_cases_stand_beside_the_baseline_of_the_first(read: dict[str, StudyResult]) -> None:
    whole = beside(read)
    assert list(whole.cases) == ["light", "heavy: one", "heavy: two"] and whole.comparison.baseline == "light"
    for (run, case), name in {("light", "as given"): "light", ("heavy", "two"): "heavy: two"}.items():
        own = read[run].cases[case].channels["m.z velocity"].whole
        assert whole.cases[name].channels["m.z velocity"].whole == own
    changed = whole.comparison.cases["heavy: one"].peaks["m.z velocity"].whole_percent
    assert changed == pytest.approx(50.0, abs=0.2)  # 2 m / (m + M): 1.5 of 1 m/s; the soft spring
    assert whole.comparison.cases["heavy: two"].frequencies[1][1] == pytest.approx(
        5.0 / 3.14159 / 2**0.5, rel=1e-4
    )  # pi
    assert [one.verdict for name in whole.cases for one in whole.verdicts[name]] == ["met", "exceeded", "met"]


def test_what_differs_in_the_files_is_named_line_by_line(read: dict[str, StudyResult]) -> None:
    told = differences(read)
    assert any(":4: bodies: {ball: {mass: 1 kg" in line and "-> bodies: {ball: {mass: 3 kg" in line for line in told)
    assert any("(nothing) -> cases: {one" in line for line in told) and len(told) == 2
    assert differences({"a": read["light"], "b": read["light"]}) == ["a and b: the same input files"]


def test_names_tell_runs_apart() -> None:
    assert names_of(["x/a/results.h5", "y/a"]) == ["x/a", "y/a"]
    with pytest.raises(InputError, match="given twice"):
        names_of(["x/a/results.h5", "x/a"])


def test_the_command_writes_a_page_and_a_results_file(runs: dict[str, Path], tmp_path: Path) -> None:
    words = [sys.executable, "-m", "femstruct", "compare", *map(str, runs.values()), "-o", str(tmp_path / "out")]
    done = subprocess.run([*words, "--no-pictures"], capture_output=True, text=True, timeout=120)
    assert (done.returncode, done.stderr) == (0, "") and "bodies: {ball: {mass: 3 kg" in done.stdout
    again = read_results(tmp_path / "out")
    assert len(again.cases) == 3 and (tmp_path / "out" / "report.html").is_file()
    alone = femstruct("compare", runs["light"])
    assert alone.returncode == 2 and "got one run, expected two or more" in alone.stderr
