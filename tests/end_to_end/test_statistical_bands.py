"""Bands beyond the modes of a bare plate: statistical, marked in every reader; of other floors blank."""

from __future__ import annotations

import csv
import json
import shutil
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

from femstruct.errors import InputErrors
from femstruct.files.results_file import read_results, write_results
from femstruct.files.sheets import sheets, write_csv
from femstruct.files.study_tables import summary
from femstruct.language.cases import read_study
from femstruct.study.results import StudyResult
from femstruct.study.study import Study
from femstruct.view.sound_figures import rated_bands
from femstruct.view.terminal import show_study
from femstruct.workflow.check import inspect_file
from femstruct.workflow.rated_floors import bare_plate
from femstruct.workflow.run import run_study

MODELS = Path(__file__).parents[2] / "models"
STUDY = """model: bedroom.yaml
modes: {up_to: 250 Hz}
bodies: {ball: {source: rubber ball, above: drops.1}}
time: {duration: 0.6 s, sampling: 4 kHz}
rooms:
  bedroom:
    size: [5, 4, 2.5]
    under: ceiling
    losses: {t60: 0.5 s}
    receivers: {mic: [[1.0, 0.8, 1.2], [3.9, 1.0, 1.2]]}
    levels: [ISO 16283-2, ISO 717-2]
limits: {bedroom rating: 62 dB}
"""
FILLED = (250.0, 315.0, 400.0, 500.0, 630.0)
NUMBER = "L'_iA,Fmax,V,T"


def study(folder: Path, *changed: tuple[str, str], text: str = STUDY) -> Path:
    shutil.copy(MODELS / "bedroom.yaml", folder / "bedroom.yaml")
    for old, new in changed:
        assert old in text
        text = text.replace(old, new)
    path = folder / "some.study.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def only(path: Path) -> Study:
    return read_study(path).cases[0].study


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> StudyResult:
    return run_study(read_study(study(tmp_path_factory.mktemp("some"))))


def test_blank_bands_are_filled_and_said_to_be(result: StudyResult) -> None:
    (case,) = result.cases.values()
    rated = case.rated["bedroom"]
    assert rated.statistical_hz == FILLED and rated.blank_hz == ()
    assert np.isnan(rated.measured_db[..., -5:]).all()  # levels of modes stay what they are
    assert rated.statistical is not None
    correction = dict(zip(rated.bands_hz, rated.correction_db.tolist(), strict=True))
    for band in FILLED:
        assert rated.bands_db[band] == pytest.approx(
            rated.statistical.levels_db[band] + correction[band], abs=1e-9
        )  # sum
    assert rated.bands_from[200.0] == "modes" and rated.bands_from[250.0] == "statistical"
    number = rated.numbers[NUMBER]
    assert number.statistical and not number.at_least
    # 55.5 with all modes up to 1400 Hz and four drops, study of levels; the statistics scatter by 1.8 dB there
    assert number.unrounded_db == pytest.approx(55.5, abs=1.5)
    (found,) = (one for one in case.findings if one.code == "statistical-bands")
    assert found.message.endswith(
        "; no comparison of modes and statistics is possible: no band has both with enough modes"
    )
    assert "250 to 630 Hz" in found.message and "fewer than 4 modes in those up to 315 Hz" in found.message
    assert not {one.code for one in case.findings} & {"rating-beyond-modes", "statistical-disagrees"}


def test_every_reader_marks_them(result: StudyResult, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    table = json.loads(json.dumps(summary(result), allow_nan=False))
    (case,) = table["cases"].values()
    rated = case["rated"]["bedroom"]
    assert rated["statistical_hz"] == list(FILLED) and rated["bands_from"]["250"] == "statistical"
    assert rated["numbers"][NUMBER]["statistical"] and rated["statistical"]["levels_db"]["250"] > 40.0
    (limits,) = (one for one in case["limits"].values())
    assert limits["statistical"]
    show_study(result, {})
    told = capsys.readouterr().out
    assert "statistical from 250 Hz" in told and "statistical: beyond the modes" in told and "statistical bands" in told
    write_results(tmp_path / "results.h5", result)
    with h5py.File(tmp_path / "results.h5") as file:
        stored = file["cases/as given/rated/bedroom"]
        assert [one.decode() for one in stored["bands_from"]][-5:] == ["statistical"] * 5
        assert stored["statistical"][:].all() and "levels_db" in stored["statistical_bands"]
    again = read_results(tmp_path / "results.h5").cases["as given"].rated["bedroom"]
    assert again.statistical_hz == FILLED and dict(again.bands_db) == dict(
        result.cases["as given"].rated["bedroom"].bands_db
    )
    paths = write_csv(sheets(result), tmp_path, "some")
    (path,) = (one for one in paths if "rated_bands" in one.name)
    with path.open(encoding="utf-8-sig", newline="") as file:
        rows = list(csv.reader(file))
    assert rows[0][1] == "as given: bedroom bands_db (L'_i,Fmax,V,T)"
    heads = {sheet.name: sheet.columns for sheet in sheets(result)}
    assert heads["third octaves"][1] == "as given: bedroom.mic.1 bands_db (L_Fmax)"
    assert heads["octaves"][1].endswith(" octaves_db (L_Fmax)") and heads["exposures"][1].endswith(" exposure_db (L_E)")
    assert heads["findings"][0] == "code" and len(set(heads["findings"])) == len(heads["findings"])
    assert rows[0][2].endswith("bands_from") and rows[-1][2] == "statistical" and rows[1][2] == "modes"
    figure = rated_bands(result, "bedroom")
    assert figure is not None
    assert [bool(bar.get_hatch()) for bar in figure.axes[0].patches] == [False] * 7 + [True] * 5
    assert "statistical" in figure.axes[0].get_xlabel()


@pytest.mark.parametrize(
    ("changed", "why"),
    [
        (("mesh: 200 mm}\n", "mesh: 200 mm}\n  m: {type: mass, at: centre, mass: 5 kg}\n"), "the floor has 2 parts"),
        (("E: 30 GPa, nu: 0.2,", "E: [30 GPa, 20 GPa], G: [12 GPa, 12 GPa], nu: 0.2,"), ""),
        (("loss_factor: 5 %", "loss_factor: 0 %"), "it has no damping"),
    ],
)
def test_floors_that_are_not_one_bare_plate(tmp_path: Path, changed: tuple[str, str], why: str) -> None:
    path = study(tmp_path)
    model = tmp_path / "bedroom.yaml"
    text = model.read_text(encoding="utf-8")
    assert changed[0] in text
    model.write_text(text.replace(*changed), encoding="utf-8")
    one = only(path)
    found = bare_plate(one.rooms[0], one)
    assert (found == why) if why else not isinstance(found, str)


def test_what_else_acts_or_radiates_takes_them_away(tmp_path: Path) -> None:
    one = only(study(tmp_path))
    (plan,) = one.rooms
    assert not isinstance(bare_plate(plan, one), str)
    damper = only(
        study(tmp_path, ("limits:", "links: {spring: {between: [centre, ground], stiffness: 1 MN/m}}\nlimits:"))
    )
    assert bare_plate(plan, damper) == "'spring' acts on the floor"
    assert (
        bare_plate(replace(plan, walls={"x0": "ceiling"}), one)
        == "several surfaces radiate into the room, or a wall of it"
    )
    assert bare_plate(replace(plan, under="other"), one) == "'other' is no rectangle of it"


def test_check_says_which_bands_stay_blank_and_why(tmp_path: Path) -> None:
    def told(*changed: tuple[str, str]) -> list[str]:
        found = inspect_file(study(tmp_path, *changed)).findings
        return [one.message for one in found if one.code == "rating-beyond-modes"]

    assert told() == []
    (few,) = told(("up_to: 250 Hz", "up_to: 40 Hz"))
    assert "50 to 80 Hz are blank" in few and "the plate has less than one mode in these bands" in few
    (spring,) = told(("limits:", "links: {spring: {between: [centre, ground], stiffness: 1 MN/m}}\nlimits:"))
    assert "There are no statistical levels: 'spring' acts on the floor" in spring
    (asked,) = told(("levels:", "beyond_modes: blank\n    levels:"))
    assert "statistical" not in asked


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        (
            ("levels:", "beyond_modes: guessed\n    levels:"),
            "beyond_modes: got 'guessed', expected one of statistical, blank",
        ),
        (("levels: [ISO 16283-2, ISO 717-2]", "beyond_modes: blank"), "'beyond_modes' in a room without levels"),
        (("levels:", "ensemble: 2\n    levels:"), "ensemble: got 2 rooms, expected 3 or more, or 0 for none"),
        (("levels:", "ensemble: many\n    levels:"), "ensemble: got 'many', expected a whole number of rooms"),
        (("levels:", "ensemble: 200\n    levels:"), "ensemble: got 200 rooms, expected at most 100"),
        (("levels:", "ensemble: true\n    levels:"), "ensemble: got true, expected a whole number of rooms"),
        (("levels: [ISO 16283-2, ISO 717-2]", "ensemble: 20"), "ensemble: got an ensemble, and no standard rates"),
        (("levels:", "coupling: two-way\n    ensemble: 20\n    levels:"), "ensemble, and the air reacts on the floor"),
        (("levels:", "beyond_mode: blank\n    levels:"), "beyond_modes"),
    ],
)
def test_wrong_words(tmp_path: Path, changed: tuple[str, str], told: str) -> None:
    with pytest.raises(InputErrors, match=told):
        read_study(study(tmp_path, changed, ("limits: {bedroom rating: 62 dB}\n", "")))
