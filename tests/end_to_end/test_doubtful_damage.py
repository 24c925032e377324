"""Damage and verdicts that rest on a peak which is not to be quoted: marked, with what they are otherwise."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from femstruct.files.results_file import read_results, write_results
from femstruct.files.study_tables import summary
from femstruct.impact.fatigue import rainflow_cycles
from femstruct.language.cases import read_study
from femstruct.study.results import StudyResult
from femstruct.view.answer_tables import fatigue
from femstruct.view.case_tables import limits, machine
from femstruct.view.terminal import study_tables
from femstruct.workflow.run import run_study

MODEL = """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
parts: {bar: {type: plate, material: steel, thickness: 10 mm, origin: [0, 0, 0], size: [1, 0.4], mesh: 100 mm}}
points: {tip: {on: bar, at: [1, 0.2]}, hit: {on: bar, at: [0.5, 0.2]}}
supports: {wall: {on: bar, edge: x0, fix: clamped}}
damping: {ratio: 1 %}
"""
STUDY = """
model: bar.yaml
modes: {count: 4}
bodies: {ball: {mass: 50 g, above: hit, speed: 1 m/s, contact: {type: hertz, stiffness: 1e9}}}
record: {bar: stress, hit.z: acceleration, tip.z: displacement}
fatigue:
  root: {of: bar stress, sn: {range: 100 MPa, slope: 5}}
  felt: {of: hit.z acceleration}
  moved: {of: tip.z displacement}
limits: {bar stress: 1 GPa, tip.z displacement: 1 m}
time: {duration: 50 ms, sampling: 50 kHz}
"""


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> StudyResult:
    folder = tmp_path_factory.mktemp("doubtful")
    (folder / "bar.yaml").write_text(MODEL, encoding="utf-8")
    (folder / "bar.study.yaml").write_text(STUDY, encoding="utf-8")
    return run_study(read_study(folder / "bar.study.yaml"))


def test_damage_of_a_doubtful_peak_is_marked(result: StudyResult, tmp_path: Path) -> None:
    """A blow's acceleration is the residual vectors' for the most, and its stress differs from cell to cell; the
    displacement is neither. One power law: a stress that is smaller by a share has that share's power of damage."""
    case = result.cases["as given"]
    found, stress = case.fatigue, case.channels["bar stress"]
    assert [name for name, one in found.items() if not one.converged] == ["root", "felt"]
    assert stress.stressed is not None
    share = max(stress.stressed.jump, stress.stressed.falls)
    assert share > 0.2
    assert found["root"].damage is not None
    assert found["root"].damage_beside == pytest.approx(found["root"].damage * (1.0 - share) ** 5, rel=1e-9)  # rounding
    told = {one.message.partition(":")[0]: one for one in case.findings if one.code == "damage-not-converged"}
    assert list(told) == ["root", "felt"]
    assert f"{found['root'].damage_beside:.3g} with the smaller stress" in told["root"].message
    told_of_stress = [one.message for one in case.findings if one.message.startswith("bar stress: do not quote")]
    assert told_of_stress and all(" MPa" in one and " Pa " not in one for one in told_of_stress), told_of_stress
    (grid,) = [grid for grid in study_tables(result) if grid.title.startswith("largest stresses")]
    assert grid.title.endswith("(? : do not quote, see stress-uneven)") and grid.rows[0][2].endswith(" ?")
    table = json.loads(json.dumps(summary(result)))["cases"]["as given"]
    assert [table["fatigue"][name]["converged"] for name in ("root", "felt", "moved")] == [False, False, True]
    assert table["fatigue"]["root"]["damage_modes_alone"] == pytest.approx(found["root"].damage_modes_alone)
    write_results(tmp_path / "results.h5", result)
    kept = read_results(tmp_path / "results.h5").cases["as given"].fatigue["root"]
    assert (kept.converged, kept.damage_beside) == (False, found["root"].damage_beside)


def test_the_histogram_says_how_its_ranges_are_rounded(result: StudyResult, tmp_path: Path) -> None:
    """Damage from the upper ends of its classes is too high, from the lower ones too low; the one kept is between."""
    h5py = pytest.importorskip("h5py")
    write_results(tmp_path / "results.h5", result)
    with h5py.File(tmp_path / "results.h5") as file:
        (place,) = (file[path] for path in _paths(file) if path.endswith("fatigue/root"))
        upper, counts, kept = place["ranges"][:], place["counts"][:], float(place.attrs["damage"])
        told = " ".join(str(value) for value in place["ranges"].attrs.values())
    above = float((counts * (upper / 100e6) ** 5).sum() / 2e6)
    below = float((counts * ((upper - upper[0]) / 100e6) ** 5).sum() / 2e6)
    assert below < kept < above
    assert kept == result.cases["as given"].fatigue["root"].damage
    assert "Upper end" in told
    assert "too high" in told


def _paths(file: object) -> list[str]:
    found: list[str] = []
    file.visit(found.append)  # type: ignore[attr-defined]
    return found


def test_cycles_without_residual_vectors_are_those_of_the_modes(result: StudyResult) -> None:
    """The acceleration of the struck point in its modes alone is the second difference of what they displace."""
    case = result.cases["as given"]
    response = case.response
    assert response is not None
    row = result.models[case.basis_key].points["hit"].probe("z").of(case.basis.shapes)  # type: ignore[union-attr]
    true = [kind != "residual" for kind in case.basis.kind]
    assert not all(true)
    alone = np.diff((row * true) @ response.q, 2) * response.clock.sampling**2
    whole = case.fatigue["felt"]
    within = 0.02  # the blow of 0.2 ms is seen through three samples 20 us apart: (pi h / T)^2 / 12
    assert whole.largest_modes_alone == pytest.approx(rainflow_cycles(alone).largest, rel=within)
    assert whole.largest > 1.5 * float(whole.largest_modes_alone)


def test_verdicts_say_what_they_rest_on(result: StudyResult) -> None:
    told = json.loads(json.dumps(summary(result)))["cases"]["as given"]["limits"]
    assert [told[name]["converged"] for name in ("bar stress", "tip.z displacement")] == [False, True]
    text = limits(result)
    assert "see peak-not-converged and stress-uneven" in text.title
    assert [row[2].partition("\n")[0] for row in text.rows] == ["met ?", "met"]
    assert any("met ?" in cell for row in machine(result).rows for cell in row) or not result.machine


def test_the_table_marks_what_is_not_to_be_quoted(result: StudyResult) -> None:
    grid = fatigue(result)
    assert "see damage-not-converged" in grid.title
    marked = {row[0]: [cell.endswith(" ?") for cell in row[4:7]] for row in grid.rows}
    assert marked == {"root": [True, True, True], "felt": [True, False, False], "moved": [False, False, False]}
    case = result.cases["as given"]
    sure = {name: replace(one, converged=True) for name, one in case.fatigue.items()}
    assert "?" not in fatigue(replace(result, cases={"as given": replace(case, fatigue=sure)})).title


def test_damage_under_a_random_excitation_inherits_the_mesh(tmp_path: Path) -> None:
    """Dirlik's damage of one power law goes with the power of the stress, too."""
    (tmp_path / "bar.yaml").write_text(MODEL, encoding="utf-8")
    path = tmp_path / "bar.study.yaml"
    path.write_text(
        "model: bar.yaml\nmodes: {up_to: 800 Hz}\nrecord: {bar: stress}\n"
        "vibration: {shaker: {at: hit.z, psd: 1 N^2/Hz, band: [60 Hz, 400 Hz], duration: 3600 s}}\n"
        "fatigue: {root: {of: bar stress, under: shaker, sn: {range: 100 MPa, slope: 5}}}\n",
        encoding="utf-8",
    )
    case = run_study(read_study(path)).cases["as given"]
    one, answer = case.fatigue["root"], case.vibration["shaker"].answers["bar stress"]
    assert answer.uneven > 0.2  # type: ignore[union-attr]
    assert not one.converged
    by_law = one.damage * (1.0 - answer.uneven) ** 5  # type: ignore[operator, union-attr]
    assert one.damage_beside == pytest.approx(by_law, rel=1e-9)  # rounding
    assert [finding.code for finding in case.findings].count("damage-not-converged") == 1
