"""Finished runs side by side: the numbers of both as they are, and beside the baseline of the first."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from femstruct.errors import InputError
from femstruct.files.results_file import read_results, write_results
from femstruct.files.study_tables import summary
from femstruct.language.cases import read_study
from femstruct.study.recorded import Channel
from femstruct.study.results import StudyResult
from femstruct.view.case_tables import machine
from femstruct.view.page import report
from femstruct.workflow.run import run_study
from femstruct.workflow.run_comparison import _between, _File, combine_runs, differences, names_of
from tests.data.command_line import femstruct

MODEL = "structure: {type: oscillator, mass: 1 kg, stiffness: 100 N/m}\npoints: {m: {}}\n"
BEAM = """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850 kg/m^3}}
sections: {bar: {shape: rectangle, width: 20 mm, height: 20 mm}}
parts: {beam: {type: frame, material: steel, section: bar, lines: [[[5, 0, 0], [6, 0, 0]]], mesh: 250 mm}}
supports: {foot: {at: root, fix: clamped}}
points: {m: {on: beam, at: [6, 0, 0]}, root: {on: beam, at: [5, 0, 0]}}
damping: {ratio: 2 %}
"""
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
    whole = combine_runs(read)
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
    assert differences({"a": read["light"], "b": read["light"]}) == ("a and b: the same input files",)


def run_in(folder: Path, *sets: str, model: str = MODEL, study: str = STUDY) -> StudyResult:
    """A study in a folder of its own, run with --set."""
    folder.mkdir(exist_ok=True)
    (folder / "model.yaml").write_text(model, encoding="utf-8")
    (folder / "hit.study.yaml").write_text(study, encoding="utf-8")
    return run_study(read_study(folder / "hit.study.yaml", sets))


def test_what_runs_were_set_to_is_listed_and_what_cases_change_is_not(tmp_path: Path) -> None:
    more = "cases: {one: {}, two: {structure.mass: 2 kg, remove: [limits]}}\n"
    runs = {
        "a": run_in(tmp_path, study=STUDY + more),
        "b": run_in(tmp_path, "time.sampling=12 kHz", "structure.mass=3 kg", study=STUDY + more),
    }
    assert differences(runs) == (
        "a and b: the same input files",
        "b was run with --set time.sampling=12 kHz, --set structure.mass=3 kg",
    )
    whole = combine_runs(runs)
    assert whole.comparison.inputs == differences(runs)
    page = report(whole)
    assert "What differs in the input files" in page and "b was run with --set time.sampling=12 kHz" in page
    assert "modes are compared up to 2500 Hz" in page
    assert "modes are compared up to 2500 Hz" in str(summary(whole)["comparison"]["b: one"]["notes"])
    assert not any("was run with" in line for line in differences({"w": whole, "a": runs["a"]}))


def test_lines_of_a_block_are_listed_one_by_one_and_a_long_block_is_cut() -> None:
    """Files with little in common had up to eight lines of YAML in one."""
    mine = _File("m.yaml", "".join(f"part {i}: {{type: plate, thickness: {i} mm}}\n" for i in range(1, 5)), {}, {})
    theirs = replace(mine, text=mine.text.replace(" mm}", " cm}"))
    told = list(_between(mine, theirs))
    assert [line.partition(":")[2].partition(":")[0] for line in told] == ["1", "2", "3", "4"]
    assert told[2] == "m.yaml:3: part 3: {type: plate, thickness: 3 mm} -> part 3: {type: plate, thickness: 3 cm}"
    (told_of,) = _between(mine, replace(mine, text="other: 1\n"))
    assert told_of.endswith(" .. -> other: 1") and len(told_of) < 160


def test_blocks_of_sweeps_are_named_and_not_listed(tmp_path: Path) -> None:
    vary = "vary:\n  bodies.ball.mass: {from: 1 kg, to: 2 kg}\n"
    runs = {"a": run_in(tmp_path / "a"), "b": run_in(tmp_path / "b", study=vary + STUDY)}
    (told,) = differences(runs)
    assert told.startswith("a -> b:") and told.endswith("other blocks, which a run does not read: vary")
    runs["b"] = run_in(tmp_path / "b", study=vary + STUDY.replace("1.2 m/s", "1.3 m/s"))
    changed, named = differences(runs)
    assert "study.yaml:6: limits: {m.z velocity: 1.2 m/s} -> limits: {m.z velocity: 1.3 m/s}" in changed
    assert named.endswith("vary")


def test_runs_of_different_structures_stand_side_by_side(tmp_path: Path) -> None:
    """A beam 5 m from the oscillator has no node in common with it."""
    runs = {"a": run_in(tmp_path / "a"), "b": run_in(tmp_path / "b", model=BEAM, study="modes: {count: 2}" + STUDY)}
    for name, one in runs.items():
        write_results(tmp_path / name / "results.h5", one)
    done = femstruct("compare", tmp_path / "a", tmp_path / "b", "-o", tmp_path / "out", "--no-pictures")
    assert done.returncode == 0, done.stderr
    assert "b: modes are not compared: the structures have no node in common" in done.stdout
    assert "structure: {type: oscillator" in done.stdout and "attenuation at the modes" not in done.stdout
    assert read_results(tmp_path / "out").cases.keys() == {"a", "b"}
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "b: modes are not compared" in page and "m.z velocity" in page


def test_a_machine_stands_beside_a_run_that_is_about_none(tmp_path: Path) -> None:
    blows = STUDY.replace("speed: 1 m/s", "speed: 1 m/s, blows: {count: 2, every: 4 ms}")
    runs = {"a": run_in(tmp_path / "a"), "b": run_in(tmp_path / "b", study=blows)}
    grid = machine(combine_runs(runs))
    assert [row[0] for row in grid.rows] == ["b"]


def test_a_change_beside_the_baseline_of_the_first_is_a_finding_when_it_is_not_converged(
    read: dict[str, StudyResult],
) -> None:
    """-40 % of the peak with residual vectors and -20 % without them: not the same change."""

    def having(run: str, whole: float, alone: float) -> StudyResult:
        result, name = read[run], "m.z acceleration"
        case = result.cases["as given"]
        one = Channel(name, case.channels["m.z velocity"].values, "m/s^2", whole, whole, by_modes=(alone, alone))
        return replace(result, cases={"as given": replace(case, channels={name: one}, findings=())})

    whole = combine_runs({"a": having("light", 10.0, 5.0), "b": having("light", 6.0, 4.0)})
    assert [one.code for one in whole.cases["b"].findings] == ["change-not-converged"]
    assert not whole.cases["a"].findings
    alike = combine_runs({"a": having("light", 10.0, 5.0), "b": having("light", 6.0, 3.0)})
    assert not alike.cases["b"].findings


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
