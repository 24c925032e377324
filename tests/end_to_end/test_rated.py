"""Rooms rated by standards, from YAML to terminal, tables and the results file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

from acoustics.levels.standards import A_THIRDS, heavy_impact_level, standardised_maximum_level
from femstruct.files.results_file import write_results
from femstruct.files.study_tables import summary
from femstruct.language.cases import read_study
from femstruct.study.asked import Limit
from femstruct.study.results import StudyResult
from femstruct.view.answer_tables import ratings
from femstruct.view.page import table
from femstruct.view.sound_figures import rated_bands
from femstruct.view.terminal import show_study
from femstruct.workflow.case_comparison import verdicts
from femstruct.workflow.run import run_study

MODEL = """
materials: {concrete: {E: 30 GPa, nu: 0.2, rho: 2400}}
parts: {slab: {type: plate, material: concrete, thickness: 0.15 m, origin: [0, 0, 2.5], size: [3, 2], mesh: [6, 4]}}
supports: {edges: {on: slab, edge: all, fix: simple}}
points: {p: {on: slab, at: [1.2, 0.8]}}
surfaces: {ceiling: {on: slab, side: below}}
damping: {loss_factor: 5 %}
"""
STUDY = """model: model.yaml
modes: {up_to: UP_TO}
bodies: {ball: BALL}
time: {duration: 0.5 s, sampling: 8 kHz}
rooms:
  bedroom:
    size: [3, 2, 2.5]
    under: ceiling
    losses: {t60: {63 Hz: 0.4 s, 250 Hz: 0.5 s, 500 Hz: 0.8 s}}
    receivers: {mic: [[0.8, 0.7, 1.2], [2.1, 1.1, 1.5]]}
    levels: [ISO 16283-2, ISO 717-2]
cases: {as is: {}, plain: {rooms.bedroom.levels: ISO 717-2}}
"""
BALL = "{source: rubber ball, above: p}"
OTHER = "{mass: 2.5 kg, above: p, speed: 4 m/s, contact: {type: linear, stiffness: 60 kN/m, damping: 90}}"


def run(folder: Path, up_to: str = "800 Hz", ball: str = BALL) -> StudyResult:
    (folder / "model.yaml").write_text(MODEL, encoding="utf-8")
    (folder / "one.study.yaml").write_text(STUDY.replace("UP_TO", up_to).replace("BALL", ball), encoding="utf-8")
    return run_study(read_study(folder / "one.study.yaml"))


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> StudyResult:
    return run(tmp_path_factory.mktemp("rated"))


def test_the_rating_is_made_of_the_receivers_levels_step_by_step(result: StudyResult) -> None:
    case = result.cases["as is"]
    rated, t60 = case.rated["bedroom"], case.rated["bedroom"].t60_s
    power = np.mean([[10 ** (one.bands_db[band] / 10) for band in A_THIRDS] for one in case.levels.values()], axis=0)
    mean = dict(zip(A_THIRDS, 10 * np.log10(power), strict=True))
    by_hand = standardised_maximum_level(mean, 3 * 2 * 2.5, t60)
    assert dict(rated.bands_db) == pytest.approx(by_hand)
    for found, wanted in ((rated, by_hand), (result.cases["plain"].rated["bedroom"], mean)):
        assert found.rating is not None
        # rounding: 7e-14 here
        assert found.rating.unrounded_db == pytest.approx(heavy_impact_level(wanted).unrounded_db, rel=1e-12)


def test_times_that_rise_are_told_and_the_modelled_ones_are_used(result: StudyResult) -> None:
    case = result.cases["as is"]
    found = next(one for one in case.findings if one.code == "t60-missed")
    assert found.message.startswith("bedroom: ")
    # one time T of all bands, as the least of sum (T_i / T - 1)^2 has it: sum T_i^2 / sum T_i of 0.4, 0.5 and 0.8 s
    one = (0.4**2 + 0.5**2 + 0.8**2) / (0.4 + 0.5 + 0.8)
    assert found.values["asked_63_hz_s"] == 0.4
    assert found.values["modelled_63_hz_s"] == pytest.approx(one, rel=1e-12)  # rounding
    assert list(case.rated["bedroom"].t60_s.values()) == pytest.approx([one] * len(A_THIRDS), rel=1e-12)  # rounding
    assert not [one for one in case.findings if one.code in ("rating-beyond-modes", "rating-of-other-blows")]


def test_missed_times_are_told_of_responses_along_frequency_too(tmp_path: Path) -> None:
    study = STUDY[: STUDY.index("bodies:")] + STUDY[STUDY.index("rooms:") :]
    heard = "frf: {f: {drive: p.z, response: bedroom.mic.1.pressure, kind: pressure, band: [20, 40], step: 10}}"
    study = study[: study.index("    levels:")] + heard
    (tmp_path / "model.yaml").write_text(MODEL, encoding="utf-8")
    (tmp_path / "one.study.yaml").write_text(study.replace("UP_TO", "300 Hz"), encoding="utf-8")
    (case,) = run_study(read_study(tmp_path / "one.study.yaml")).cases.values()
    assert [one.code for one in case.findings].count("t60-missed") == 1


def test_terminal_tables_and_file_say_the_same(
    result: StudyResult, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rated = result.cases["as is"].rated["bedroom"]
    symbol, plain = rated.numbers
    assert (symbol, plain) == ("L'_iA,Fmax,V,T", "L_iA,Fmax")
    show_study(result, {})
    rows = [line.split() for line in capsys.readouterr().out.splitlines() if line.startswith("bedroom")]
    for name in (symbol, plain):
        number, spread = rated.numbers[name], rated.receivers_spread_db[name]
        (row,) = (row for row in rows if row[1:4] == [name, "as", "is"])
        over = rated.number_intervals[name]
        rooms = [f"{over.mean:.1f}", f"[{over.low:.1f},", f"{over.high:.1f}]"]
        alone = [f"{number.value_db:g}", "-", f"{spread:.1f}"]
        assert row[4:] == [*alone, *rooms, f"{number.deciding_hz:g}"]
    assert next(row for row in rows if row[1:3] == [plain, "plain"])[4] == "+0.0"  # the same levels, not standardised
    assert not [row for row in rows if row[1:3] == [symbol, "plain"]]
    one = summary(result)["cases"]["as is"]["rated"]["bedroom"]
    assert one["numbers"][symbol]["value_db"] == rated.numbers[symbol].value_db
    assert one["bands_db"]["63"] == rated.bands_db[63.0]
    assert one["receivers"] == 2
    change = summary(result)["comparison"]["plain"]["rated_db"]  # of what both have; the room's transfer is taken again
    assert change == {"bedroom": {plain: pytest.approx(0.0, abs=1e-9)}}  # rounding: 4e-12 here
    write_results(tmp_path / "results.h5", result)
    with h5py.File(tmp_path / "results.h5") as file:
        stored = file["cases/as is/rated/bedroom"]
        assert stored["symbol"].asstr()[:].tolist() == [symbol, plain]
        assert stored["value_db"][0] == rated.numbers[symbol].value_db
        assert stored["bands_db"][:].tolist() == list(rated.bands_db.values())
        assert stored["t60_s"].attrs["unit"] == "s"


def test_how_many_places_spreads_are_over_is_no_number_among_levels(result: StudyResult) -> None:
    grid = ratings(result)
    assert grid.title.endswith("; spreads are over 1 drop and 2 receivers)")
    assert table(grid).count("<table>") == 1  # also with four drops and C_I it fits on paper
    case = result.cases["plain"]
    fewer = replace(
        case, rated={"bedroom": replace(case.rated["bedroom"], measured_db=case.rated["bedroom"].measured_db[:, :1])}
    )
    other = ratings(replace(result, cases={**result.cases, "plain": fewer}))
    assert "spreads are over" not in other.title
    column = [head.partition("\n")[0] for head in other.columns].index("over")
    assert [row[column].partition(" ")[2] for row in other.rows] == ["(2 receivers)", "(2 receivers)", "(1 receiver)"]


def test_lines_on_the_bars_are_in_the_legend(result: StudyResult) -> None:
    figure = rated_bands(result, "bedroom")
    assert figure is not None
    labels = figure.axes[0].get_legend_handles_labels()[1]
    assert "standard deviation over drops and receivers, to each side" in labels
    assert "mean over rooms and places, and 90 % interval" in labels
    assert "L'_iA,Fmax,V,T of the baseline: levels at which all bands have equal shares in it" in labels
    marks = [line for line in figure.axes[0].get_lines() if line.get_marker() == "D" and len(line.get_xdata())]
    assert marks and all(line.get_markerfacecolor() == "white" for line in marks)  # the bars of the baseline are dark


def test_few_modes_and_another_blow_are_told(tmp_path: Path) -> None:
    findings = {one.code: one for one in run(tmp_path, "300 Hz", OTHER).cases["as is"].findings}
    assert findings["rating-beyond-modes"].values["complete_below_hz"] == pytest.approx(300.0)
    assert (
        "require one rubber ball or a tapping machine; here the source is ball"
        in findings["rating-of-other-blows"].message
    )


def test_what_the_standards_do_not_rate_has_bands_and_no_single_number(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    result = run(tmp_path, "800 Hz", OTHER)
    rated = result.cases["as is"].rated["bedroom"]
    assert not rated.numbers and rated.rating is None
    assert np.isfinite(list(rated.bands_db.values())).all()
    assert summary(result)["cases"]["as is"]["rated"]["bedroom"]["numbers"] == {}
    show_study(result, {})
    told = capsys.readouterr().out
    assert "L'_iA,Fmax" not in told and "single numbers are withheld" in " ".join(told.split())
    limit = Limit("bedroom rating", 60.0, "bedroom")
    case = result.cases["as is"]
    study = replace(case.case.study, limits=(limit,))
    (verdict,) = verdicts(replace(case, case=replace(case.case, study=study)))
    assert verdict.verdict == "not known"
