"""Bands beyond the modes: blank in every reader, single numbers that need them are bounds, nothing is heard there."""

from __future__ import annotations

import json
import re
import shutil
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

from acoustics.levels.sound_levels import level_spectrum
from femstruct.files.results_file import write_results
from femstruct.files.study_tables import summary
from femstruct.language.cases import read_study
from femstruct.study.results import StudyResult
from femstruct.view.sound_figures import rated_bands
from femstruct.view.spectra import sound
from femstruct.view.terminal import show_study
from femstruct.workflow.case_comparison import verdicts
from femstruct.workflow.check import inspect_file
from femstruct.workflow.run import run_study
from femstruct.workflow.study_findings import blanks_before

MODEL = Path(__file__).parents[2] / "models" / "bedroom.yaml"
STUDY = """model: bedroom.yaml
modes: {up_to: 790 Hz}
bodies: {ball: {source: rubber ball, above: drops.1}}
time: {duration: 0.8 s, sampling: 8 kHz}
rooms:
  bedroom:
    size: [5, 4, 2.5]
    under: ceiling
    losses: {t60: 0.5 s}
    receivers: {mic: [[1.0, 0.8, 1.2], [3.9, 1.0, 1.0]]}
    levels: [ISO 16283-2, ISO 717-2]
    beyond_modes: blank
    ensemble: 0
limits: {bedroom rating: LIMIT}
cases: {all: {}, few: {modes.up_to: 250 Hz}, hardly any: {modes.up_to: 40 Hz}}
compare: {baseline: all}
"""
INSIDE = (50.0, 63.0, 80.0, 100.0, 125.0, 160.0, 200.0)  # the filter of 200 Hz passes what is below 249.5 Hz
BLANK = (250.0, 315.0, 400.0, 500.0, 630.0)
NUMBER = "L'_iA,Fmax,V,T"


def study(folder: Path, limit: str = "62 dB") -> Path:
    shutil.copy(MODEL, folder / "bedroom.yaml")
    path = folder / "few.study.yaml"
    path.write_text(STUDY.replace("LIMIT", limit), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> StudyResult:
    return run_study(read_study(study(tmp_path_factory.mktemp("few"))))


def test_bands_inside_the_modes_are_right_and_others_blank(result: StudyResult) -> None:
    """Basis to 250 Hz beside 790 Hz, 0.1 dB where what the filters pass lies inside, as studied with 1400 Hz."""
    every, few = (result.cases[name].rated["bedroom"] for name in ("all", "few"))
    assert [few.bands_db[band] for band in INSIDE] == pytest.approx([every.bands_db[b] for b in INSIDE], abs=0.1)
    assert np.isnan([few.bands_db[band] for band in BLANK]).all()
    assert (every.blank_hz, few.blank_hz) == ((), BLANK)
    levels = result.cases["few"].levels["bedroom.mic.1"]
    assert np.isfinite(levels.bands_db[200.0]) and np.isnan(levels.bands_db[250.0])
    assert np.isfinite(levels.octaves_db[125.0]) and np.isnan(levels.octaves_db[250.0])  # 176.8 and 353.6 Hz
    assert np.isnan(levels.exposure_db[250.0])


def test_single_numbers_that_need_blank_bands_are_bounds(result: StudyResult) -> None:
    every, few, none = (result.cases[name].rated["bedroom"].numbers[NUMBER] for name in ("all", "few", "hardly any"))
    assert few.blank_hz == BLANK and few.value_db <= every.value_db
    assert few.unrounded_db > every.unrounded_db - 8.0  # 4.5 dB in the study this is from
    assert np.isnan(none.value_db)
    change = result.cases["few"].rated["bedroom"].above(result.cases["all"].rated["bedroom"])
    assert np.isnan(change[NUMBER])


def test_nothing_is_heard_beyond_the_modes(result: StudyResult) -> None:
    """Pseudo-modes of the ball's place ring at frequencies of their own above 250 Hz."""
    case = result.cases["few"]
    pseudo = case.basis.frequency_hz[case.basis.modes.stop :]
    heard = case.rooms["bedroom"]
    assert heard.complete_below_hz == pytest.approx(250.0)
    f, level = level_spectrum(heard.p[0], heard.dt)
    beyond = f > 250.0 * 10**0.05
    assert pseudo.size and (pseudo[0] > 250.0)
    assert level[beyond].max() < level[~beyond].max() - 55.0
    # what is below the end is right: the same as with all modes but for the filter's delay
    _, whole = level_spectrum(result.cases["all"].rooms["bedroom"].p[0], heard.dt)
    inside = (f > 20.0) & (f < 200.0) & (whole > whole.max() - 30.0)
    assert np.abs(level - whole)[inside].max() < 0.3


def test_every_reader_copes(result: StudyResult, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    table = json.loads(json.dumps(summary(result), allow_nan=False))
    few = table["cases"]["few"]["rated"]["bedroom"]
    assert few["bands_db"]["250"] is None and few["blank_hz"] == list(BLANK)
    assert few["numbers"][NUMBER]["at_least"] and few["numbers"][NUMBER]["deciding_hz"] is None
    assert table["cases"]["hardly any"]["rated"]["bedroom"]["numbers"][NUMBER]["value_db"] is None
    assert table["cases"]["few"]["levels"]["bedroom.mic.1"]["bands_db"]["250"] is None
    assert table["cases"]["few"]["levels"]["bedroom.mic.1"]["complete_below_hz"] == pytest.approx(250.0)
    assert table["comparison"]["few"]["rated_db"]["bedroom"][NUMBER] is None
    assert "250" not in table["comparison"]["few"]["bands_db"] and "200" in table["comparison"]["few"]["bands_db"]
    show_study(result, {})
    told = capsys.readouterr().out
    assert "at least" in told and "blank" in told and not re.search(r"\bnan\b", told)
    write_results(tmp_path / "results.h5", result)
    with h5py.File(tmp_path / "results.h5") as file:
        stored = file["cases/few/rated/bedroom"]
        assert np.isnan(stored["bands_db"][-1]) and stored["at_least"][:].all()
        assert file["cases/few/rooms/bedroom"].attrs["complete_below_hz"] == pytest.approx(250.0)
    drawn = rated_bands(result, "bedroom")
    assert drawn is not None and "no bar: beyond the modes" in drawn.axes[0].get_xlabel()
    figure = sound(result, "bedroom.mic.1")
    assert figure is not None
    ends = [line.get_xdata().max() for line in figure.axes[0].lines if line.get_label() in ("few", "all")]
    assert sorted(ends) == pytest.approx([250.0, 790.0], rel=0.02)  # lines of the spectrum: 1 % at 250 Hz


@pytest.mark.parametrize(("limit", "told"), [("62 dB", "not known"), ("40 dB", "exceeded")])
def test_a_limit_on_a_bound_is_exceeded_or_not_known(
    result: StudyResult, tmp_path: Path, limit: str, told: str
) -> None:
    limits = read_study(study(tmp_path, limit)).cases[0].study.limits
    case = result.cases["few"]
    (verdict,) = verdicts(replace(case, case=replace(case.case, study=replace(case.case.study, limits=limits))))
    assert verdict.verdict == told and verdict.least


def test_check_says_beforehand_what_stays_blank(tmp_path: Path) -> None:
    found = [one for one in inspect_file(study(tmp_path)).findings if one.code == "rating-beyond-modes"]
    assert ["bedroom (few)" in found[0].message, "bedroom (hardly any)" in found[1].message] == [True, True]
    assert "250 to 630 Hz are blank" in found[0].message and "at least" in found[0].message
    assert "up_to: 790 Hz" in found[0].message
    (plate,) = read_study(study(tmp_path)).cases[0].study.structure.parts
    wave = (plate.material.E * plate.thickness**2 / (12 * (1 - plate.material.nu**2) * plate.material.rho)) ** 0.25
    wave *= (2 * np.pi / 790.0) ** 0.5  # 2 pi (D / m omega^2)^(1/4)
    assert found[0].values["cell_m"] == pytest.approx(wave / 6.0, rel=1e-9)  # six cells a wave
    assert f"cells of {1e3 * wave / 6.0:.3g} mm or less" in found[0].message
    assert "no single number" in found[1].message


def test_cases_that_differ_by_their_cells_alone_share_a_finding(tmp_path: Path) -> None:
    """A thinner floor needs smaller cells: one finding, with those."""
    path = study(tmp_path)
    cases = read_study(path).cases
    few = next(case for case in cases if case.name == "few")
    (part,) = few.study.structure.parts
    thin = replace(part, thickness=part.thickness / 1.44)
    other = replace(few, name="thin", study=replace(few.study, structure=replace(few.study.structure, parts=(thin,))))
    ((room, both),) = blanks_before([few, other])
    ((_, one),) = blanks_before([few])
    assert room == "bedroom" and both.values["cell_m"] == pytest.approx(one.values["cell_m"] / 1.2, rel=1e-9)  # h^0.5
