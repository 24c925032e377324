"""What is printed of harmonic and random excitations: a table for each kind, with what its numbers are and where."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from femstruct.language.cases import read_study
from femstruct.modal.steady import HarmonicAnswer, RandomAnswer
from femstruct.model.materials import Material
from femstruct.model.mesher import mesh_structure
from femstruct.model.structure import Structure
from femstruct.parts.plate import Plate
from femstruct.study.recorded import LargestStress
from femstruct.study.results import StudyResult
from femstruct.view.answer_tables import harmonic, moved_masses, random
from femstruct.view.histories import energy
from femstruct.view.model_scene import VIEW, NoOpenGL
from femstruct.view.room_scene import picture_stresses
from femstruct.view.spectra import vibration_answer
from femstruct.view.terminal import study_tables
from femstruct.workflow.run import run_study

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


def test_pictures_have_the_units_of_the_tables_and_what_excites(result: StudyResult) -> None:
    """Densities are those of the answers in the shown unit, the excitation is what was written: 0.001 g^2/Hz."""
    figure = vibration_answer(result, "shaker, bar stress")
    axes, beside = figure.axes
    answer = result.cases["as given"].vibration["shaker"].answers["bar stress"]
    assert isinstance(answer, RandomAnswer)
    assert axes.get_ylabel() == "power spectral density in MPa²/Hz"
    np.testing.assert_allclose(axes.get_lines()[0].get_ydata(), 1e-12 * answer.psd, rtol=1e-12)  # rounding
    (row,) = (row for row in random(result).rows if row[1] == "bar stress")
    assert axes.get_lines()[0].get_label() == f"as given: rms {row[3]}"
    assert beside.get_ylabel() == "excitation in g²/Hz"
    np.testing.assert_allclose(beside.get_lines()[0].get_ydata(), 0.001, rtol=1e-9)  # straight in logarithms
    assert axes.get_xlabel() == "frequency in Hz   (numbers: modes)"  # nothing to be a baseline of
    motor = vibration_answer(result, "motor, tip.z acceleration")
    (row,) = (row for row in harmonic(result).rows if row[1] == "tip.z acceleration")
    assert motor.axes[0].get_lines()[0].get_label() == f"as given: largest {row[3]}"
    assert motor.axes[1].get_ylabel() == "excitation in N"


def test_rounding_does_not_stretch_an_axis(result: StudyResult) -> None:
    case = result.cases["as given"]
    one = case.vibration["motor"]
    answer = one.answers["tip.z acceleration"]
    assert isinstance(answer, HarmonicAnswer)
    values = answer.values.copy()
    values[0] = 1e-14 * answer.largest
    answers = {**one.answers, "tip.z acceleration": replace(answer, values=values)}
    vibration = {**case.vibration, "motor": replace(one, answers=answers)}
    figure = vibration_answer(
        replace(result, cases={"as given": replace(case, vibration=vibration)}), "motor, tip.z acceleration"
    )
    low, high = figure.axes[0].get_ylim()
    assert 1e5 < high / low < 1e7


@pytest.mark.parametrize(("duration", "unit"), [("0.6 s", "ms"), ("6 s", "s")])
def test_both_panels_of_energy_have_one_unit_of_time(duration: str, unit: str, tmp_path: Path) -> None:
    model = "structure: {type: oscillator, mass: 2 kg, frequency: 40 Hz}\npoints: {m: {}}\ndamping: {ratio: 2 %}\n"
    (tmp_path / "model.yaml").write_text(model, encoding="utf-8")
    path = tmp_path / "rings.study.yaml"
    text = "model: model.yaml\ninitial: {velocity: {m.z: 1 m/s}}\nrecord: {m.z: displacement}\n"
    path.write_text(f"{text}time: {{duration: {duration}, sampling: 2 kHz}}\n", encoding="utf-8")
    figure = energy(run_study(read_study(path)))
    assert figure is not None
    assert [axes.get_xlabel() for axes in figure.axes] == [f"time in {unit}"] * 2
    ends = [axes.get_xlim()[1] for axes in figure.axes]
    assert ends[1] == pytest.approx({"ms": 600.0, "s": 6.0}[unit])
    layers = [
        max(path.vertices[:, 0].max() for one in axes.collections for path in one.get_paths()) for axes in figure.axes
    ]
    assert layers == pytest.approx(ends)


def test_the_label_of_a_stress_does_not_cover_its_spot(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """It stands to the right of the spot and above it in the view, and the scales are those of the part."""
    pyvista = pytest.importorskip("pyvista")
    seen: dict[str, np.ndarray] = {}
    true = pyvista.Plotter.add_point_labels, pyvista.Plotter.show_bounds

    def labels(self, points, words, **options):  # type: ignore[no-untyped-def]
        seen["labels"] = np.asarray(points)
        return true[0](self, points, words, **options)

    def bounds(self, **options):  # type: ignore[no-untyped-def]
        seen["box"] = np.asarray(options["bounds"])
        return true[1](self, **options)

    monkeypatch.setattr(pyvista.Plotter, "add_point_labels", labels)
    monkeypatch.setattr(pyvista.Plotter, "show_bounds", bounds)
    steel = Material("steel", 210e9, 0.3, 7850.0)
    plate = Plate("plate", steel, 0.01, (0.0, 0.0, 0.0), (1.0, 0.8), 0.2)
    model = mesh_structure(Structure("one", (plate,)))
    places = model.parts["plate"].stresses(model.mesh.n_nodes)
    sizes = np.arange(1.0, len(places.places) + 1)
    found = LargestStress(places.places, places.sides, sizes, np.zeros(len(sizes)), 0.0, 0.0)
    try:
        picture_stresses(model, {"plate": found}, tmp_path / "stress.png")
    except NoOpenGL as error:
        pytest.skip(str(error))
    across = VIEW @ (seen["labels"][0] - places.places[-1])
    assert (across > 0.02).all()  # m, of a plate of 1 m
    np.testing.assert_allclose(seen["box"], [0.0, 1.0, 0.0, 0.8, 0.0, 0.0], atol=0.011)  # its thickness
