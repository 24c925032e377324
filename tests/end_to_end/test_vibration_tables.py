"""What is printed of harmonic and random excitations: a table for each kind, with what its numbers are and where."""

from __future__ import annotations

from pathlib import Path

import pytest

from femstruct import read_study, run_study
from femstruct.study.result import StudyResult
from femstruct.view.figures.shaken_figures import vibration_answer
from femstruct.view.tables.answer_tables import harmonic, moved_masses, random
from femstruct.view.tables.terminal import study_tables

MODEL = """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
sections: {flat: {shape: rectangle, width: 20 mm, height: 10 mm}}
parts: {bar: {type: frame, material: steel, section: flat, lines: [[[0, 0, 0], [1, 0, 0]]], mesh: 100 mm}}
points: {foot: {on: bar, at: [0, 0, 0]}, tip: {on: bar, at: [1, 0, 0]}}
supports: {wall: {at: foot, fix: clamped}}
damping: {ratio: 1 %}
"""
STUDY = """
model: bar.yaml
modes: {up_to: 800 Hz}
record: {bar: stress, wall: force, tip.z: acceleration}
vibration:
  shaker: {base: z, psd: 0.001 g^2/Hz, band: [2 Hz, 200 Hz], duration: 60 s}
  motor: {at: tip.z, harmonic: 2 N, band: [2 Hz, 100 Hz]}
"""


def run(folder: Path, text: str = STUDY) -> StudyResult:
    (folder / "bar.yaml").write_text(MODEL, encoding="utf-8")
    (folder / "bar.study.yaml").write_text(text, encoding="utf-8")
    return run_study(read_study(folder / "bar.study.yaml"))


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> StudyResult:
    return run(tmp_path_factory.mktemp("vibration"))


def test_each_kind_of_excitation_has_its_own_table(result: StudyResult) -> None:
    assert list(harmonic(result).columns) == ["", "channel", "case", "largest", "at [Hz]", "where"]
    columns = ["", "channel", "case", "rms", "mean frequency [Hz]", "expected peak in 60 s", "where"]
    assert list(random(result).columns) == columns
    assert {row[0] for row in harmonic(result).rows} == {"motor"}
    assert {row[0] for row in random(result).rows} == {"shaker"}
    titles = [grid.title.partition(":")[0] for grid in study_tables(result) if grid.rows]
    assert {"harmonic vibration", "random vibration"} <= set(titles)


def test_a_stress_has_its_place_and_the_reason_of_what_it_has_not(result: StudyResult) -> None:
    """A cantilever is stressed most where it is clamped."""
    (row,) = (row for row in random(result).rows if row[1] == "bar stress")
    assert row[4:6] == ["-", "-"]
    assert row[6].startswith("(0, ")
    assert "no mean frequency, no expected peak" in random(result).title
    (row,) = (row for row in harmonic(result).rows if row[1] == "bar stress")
    assert row[5].startswith("(0, ")
    others = [row[-1] for grid in (harmonic(result), random(result)) for row in grid.rows if row[1] != "bar stress"]
    assert set(others) == {"-"}


def test_a_force_has_its_axis(result: StudyResult) -> None:
    """In what is shown; JSON, files and `fatigue: {of: ..}` have the names of records in time."""
    shown = {row[1] for grid in (harmonic(result), random(result)) for row in grid.rows}
    assert "wall force z" in shown
    assert "wall force" not in shown
    assert "wall force" in result.cases["as given"].vibration["shaker"].answers
    titles = [
        figure.get_suptitle() or figure.texts[0].get_text()
        for figure in (vibration_answer(result, f"{name}, wall force") for name in ("shaker", "motor"))
    ]
    assert all("wall force z, excited by" in title for title in titles)


def test_the_effective_mass_is_beside_the_mass(result: StudyResult) -> None:
    """A bar of 1 m x 20 mm x 10 mm of steel."""
    grid = moved_masses(result)
    ((name, _, axis, modes, mass, share),) = grid.rows
    base = result.cases["as given"].vibration["shaker"].base
    assert base is not None
    total = 1.0 * 0.02 * 0.01 * 7850.0
    assert (name, axis, modes) == ("shaker", "z", str(len(base.mass)))
    assert mass == f"{base.mass.sum():.4g} of {total:.4g} kg"
    assert share == f"{100.0 * base.mass.sum() / total:.0f} %"
    assert grid.title.startswith("effective mass")


def test_without_stresses_and_durations_there_are_no_columns_for_them(tmp_path: Path) -> None:
    text = STUDY.replace("bar: stress, ", "").replace(", duration: 60 s", "")
    found = run(tmp_path, text)
    assert list(random(found).columns) == ["", "channel", "case", "rms", "mean frequency [Hz]"]
    assert "Mises" not in random(found).title
    assert all(len(row) == 5 for grid in (random(found), harmonic(found)) for row in grid.rows)


def test_several_durations_stand_with_their_peaks(tmp_path: Path) -> None:
    more = "  road: {base: z, psd: 0.001 g^2/Hz, band: [2 Hz, 200 Hz], duration: 600 s}\n"
    grid = random(run(tmp_path, STUDY + more))
    assert "expected peak" in grid.columns
    ends = {row[0]: row[5].partition(" in ")[2] for row in grid.rows if row[1] == "tip.z acceleration"}
    assert ends == {"shaker": "60 s", "road": "600 s"}
