"""Rooms rated by JIS A 1419-2 and KS F 2863-2, from YAML to pictures, tables and the results file."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest

from acoustics.levels.sound_levels import equivalent_levels
from acoustics.levels.standards import (
    HEAVY_OCTAVES,
    LIGHT_OCTAVES,
    energy_average,
    grade_curve,
    impact_grade,
    inverse_a_curve,
    inverse_a_level,
)
from femstruct.errors import InputErrors
from femstruct.files.results_file import write_results
from femstruct.files.study_tables import summary
from femstruct.language.cases import read_study
from femstruct.study.results import StudyResult
from femstruct.view.sound_figures import rated_bands
from femstruct.view.terminal import show_study
from femstruct.workflow.run import run_study

MODEL = """
materials: {concrete: {E: 30 GPa, nu: 0.2, rho: 2400}}
parts: {slab: {type: plate, material: concrete, thickness: 0.15 m, origin: [0, 0, 2.5], size: [3, 2], mesh: [6, 4]}}
supports: {edges: {on: slab, edge: all, fix: simple}}
points:
  drops: {on: slab, at: [[1.2, 0.8], [2, 1.4]]}
  feet: {on: slab, at: [[1, 1], [1.1, 1], [1.2, 1], [1.3, 1], [1.4, 1]]}
surfaces: {ceiling: {on: slab, side: below}}
damping: {loss_factor: 5 %}
"""
STUDY = """model: model.yaml
modes: {up_to: 900 Hz}
bodies: {tyre: {source: bang machine, above: drops}}
time: {duration: 0.5 s, sampling: 4 kHz}
rooms:
  bedroom:
    size: [3, 2, 2.5]
    under: ceiling
    losses: {t60: 0.5 s}
    receivers: {mic: [[0.8, 0.7, 1.2], [2.1, 1.1, 1.5]]}
    levels: [JIS A 1419-2, KS F 2863-2]
    beyond_modes: blank
    ensemble: 0
limits: {bedroom rating: 55 dB}
cases: {thin: {}, thick: {parts.slab.thickness: 0.2 m}}
"""
TYRE = "{source: bang machine, above: drops}"
HAMMERS = (
    "{source: tapping machine, above: feet, contact: {type: hertz, stiffness: 1e9}, blows: {count: 1, timing: regular}}"
)
SYMBOLS = ["L_i,Fmax,r,H(1)", "L_i,Fmax,AW"]


def run(folder: Path, *edits: tuple[str, str]) -> StudyResult:
    text = STUDY
    for old, new in edits:
        assert old in text
        text = text.replace(old, new)
    (folder / "model.yaml").write_text(MODEL, encoding="utf-8")
    (folder / "one.study.yaml").write_text(text, encoding="utf-8")
    return run_study(read_study(folder / "one.study.yaml"))


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> StudyResult:
    return run(tmp_path_factory.mktemp("grades"))


def test_a_grade_is_made_of_octaves_at_receivers_and_drops_step_by_step(result: StudyResult) -> None:
    """Octaves are filtered: the maxima of their thirds come at other times, and a narrow filter blunts a blow."""
    case = result.cases["thin"]
    octaves, thirds = (
        np.array(
            [
                [[getattr(level, name)[band] for band in bands] for level in drop.levels.values()]
                for drop in case.drops.values()
            ]
        )
        for name, bands in (("octaves_db", HEAVY_OCTAVES), ("bands_db", (50.0, 63.0, 80.0)))
    )
    rated = case.rated["bedroom"]
    np.testing.assert_array_equal(rated.measured_db, octaves)
    places = energy_average(octaves, axis=1)
    mean = places.mean(axis=0)
    assert list(rated.bands_db.values()) == pytest.approx(mean.tolist())
    grade, level = rated.numbers.values()
    by_hand = impact_grade(dict(zip(HEAVY_OCTAVES, places.round(1).mean(axis=0), strict=True)))
    assert (grade.value_db, grade.beside["L number"]) == (by_hand.grade, by_hand.number)
    assert level.value_db == inverse_a_level(dict(zip(HEAVY_OCTAVES, mean, strict=True))).level_db
    assert np.abs(10 * np.log10((10 ** (thirds / 10)).sum(axis=2)) - octaves[:, :, 0]).max() > 0.3
    assert not [one for one in case.findings if one.code in ("rating-of-other-blows", "rating-of-few-places")]


def test_terminal_tables_and_file_say_the_same(
    result: StudyResult, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    thin, thick = (result.cases[name].rated["bedroom"] for name in ("thin", "thick"))
    show_study(result, {})
    shown = capsys.readouterr().out
    assert "impact sound by octave, re 20 µPa" in shown
    for symbol in SYMBOLS:
        row = next(line.split() for line in shown.splitlines() if line.split()[:3] == ["bedroom", symbol, "thick"])
        number = thick.numbers[symbol]
        stated = [number.value_db, *number.beside.values()]
        assert row[3:][: len(stated)] == [f"{one:g}" for one in stated]
        assert f"{thick.above(thin)[symbol]:+z.1f}" in row
        assert f"({thick.above_spread_db(thin)[symbol]:.1f})" in row
    table = summary(result)
    found = table["cases"]["thick"]["rated"]["bedroom"]
    assert list(found["numbers"]) == SYMBOLS
    assert found["numbers"][SYMBOLS[0]]["L number"] == thick.numbers[SYMBOLS[0]].beside["L number"]
    assert "L number" not in found["numbers"][SYMBOLS[1]]
    assert (found["bands"], list(found["bands_db"])) == ("octave", ["63", "125", "250", "500"])
    assert table["comparison"]["thick"]["rated_db"]["bedroom"] == thick.above(thin)
    assert table["comparison"]["thick"]["rated_spread_db"]["bedroom"] == dict(thick.above_spread_db(thin))
    write_results(tmp_path / "results.h5", result)
    with h5py.File(tmp_path / "results.h5") as file:
        stored = file["cases/thick/rated/bedroom"]
        assert stored["symbol"].asstr()[:].tolist() == SYMBOLS
        assert stored["value_db"][:].tolist() == [one.value_db for one in thick.numbers.values()]
        np.testing.assert_array_equal(stored["L number"][:], [thick.numbers[SYMBOLS[0]].beside["L number"], np.nan])
        assert stored["measured_db"].shape == (2, 2, 4)


def test_a_limit_is_of_the_grade(result: StudyResult) -> None:
    for name, case in result.cases.items():
        (verdict,) = result.verdicts[name]
        grade = case.rated["bedroom"].numbers[SYMBOLS[0]].value_db
        assert (verdict.value, verdict.met) == (grade, grade <= 55.0)


def test_the_curves_of_both_numbers_are_drawn(result: StudyResult) -> None:
    rated = result.cases["thin"].rated["bedroom"]
    figure = rated_bands(result, "bedroom")
    assert figure is not None
    axes = figure.axes[0]
    tops = [bar.get_y() + bar.get_height() for bar in axes.patches][:4]
    assert tops == pytest.approx(list(rated.bands_db.values()))
    for style, symbol, curve in (("--", SYMBOLS[0], grade_curve), (":", SYMBOLS[1], inverse_a_curve)):
        (line,) = (line for line in axes.get_lines() if line.get_linestyle() == style)
        assert np.asarray(line.get_ydata()).tolist() == list(curve(rated.numbers[symbol].value_db).values())
    assert axes.get_xlabel() == "octave, nominal centre in Hz"


def test_a_tapping_machine_has_octaves_of_the_mean_square(tmp_path: Path) -> None:
    """Over the last of its turns; by JIS alone."""
    result = run(
        tmp_path,
        (TYRE, HAMMERS),
        ("[JIS A 1419-2, KS F 2863-2]", "JIS A 1419-2"),
        ("sampling: 4 kHz", "sampling: 6 kHz"),
        ("thick: {parts.slab.thickness: 0.2 m}", "thirds: {rooms.bedroom.levels: ISO 717-2, time.sampling: 7.6 kHz}"),
    )
    case = result.cases["thin"]
    rated = case.rated["bedroom"]
    response = case.rooms["bedroom"]
    heard = [equivalent_levels(p[:3000], response.dt, 0.0, 1, response.complete_below_hz) for p in response.p]
    wanted = np.array([[one[band] for band in LIGHT_OCTAVES] for one in heard])
    assert np.isfinite(wanted[:, :3]).all() and np.isnan(wanted[:, 3:]).all()  # modes end below the octave at 1 kHz
    # bands are made before the sound is ended: what their filters hear from above the last mode
    np.testing.assert_allclose(rated.measured_db[0], wanted, atol=0.01)
    assert list(rated.numbers) == ["L_i,r,L"]
    codes = {one.code: one for one in case.findings}
    assert codes["rating-beyond-modes"].values["highest_hz"] == pytest.approx(1995.262 * 1.7645, rel=1e-4)  # digits
    assert "rating-of-other-blows" not in codes
    # octaves and third octaves are never side by side
    figure = rated_bands(result, "bedroom")
    assert figure is not None
    assert len(figure.axes[0].patches) == len(LIGHT_OCTAVES) - len(rated.blank_hz)
    assert summary(result)["comparison"]["thirds"]["rated_db"] == {"bedroom": {}}


def test_other_blows_are_told_and_other_sources_refused(tmp_path: Path) -> None:
    by_hand = "{mass: 7.3 kg, above: drops.1, speed: 4 m/s, contact: {type: linear, stiffness: 60 kN/m, damping: 90}}"
    codes = {one.code: one for one in run(tmp_path, (TYRE, by_hand)).cases["thin"].findings}
    told = "levels by JIS A 1419-2 and KS F 2863-2 require one bang machine; here the source is tyre"
    told += ": single numbers are withheld"
    assert codes["rating-of-other-blows"].message == f"bedroom: {told}"
    codes = {
        one.code: one for one in run(tmp_path, ("[JIS A 1419-2, KS F 2863-2]", "ISO 717-2")).cases["thin"].findings
    }
    told = (
        "require one rubber ball or a tapping machine; here the source is bang machine, for JIS A 1419-2 or KS F 2863-2"
    )
    assert told in codes["rating-of-other-blows"].message
    for source, expected in (
        (
            TYRE.replace("bang machine", "rubber ball"),
            "got a rubber ball by JIS A 1419-2, expected a bang machine or a tap",
        ),
        (
            HAMMERS,
            "got a tapping machine by KS F 2863-2, expected a bang machine; KS F 2863-1 has no accessible source",
        ),
    ):
        with pytest.raises(InputErrors) as caught:
            run(tmp_path, (TYRE, source))
        assert [line.split(": ", 2)[1:] for line in caught.value.errors] == [
            ["rooms.bedroom.levels", line.split(": ", 2)[2]] for line in caught.value.errors
        ]
        assert expected in caught.value.errors[0]
    with pytest.raises(
        InputErrors, match="got a sampling of 1500 Hz, expected 1600 Hz or more for the bands up to 500"
    ):
        run(tmp_path, ("4 kHz", "1.5 kHz"))
