"""A source of several places: one simulation for each, rated together; against studies with one place each."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest

from acoustics.levels.bands import filter_reach
from acoustics.levels.rated import rate_room
from acoustics.levels.standards import heavy_impact_level
from femstruct.errors import InputErrors
from femstruct.files.results_file import write_results
from femstruct.files.study_tables import summary
from femstruct.language.cases import read_study
from femstruct.study.results import StudyResult
from femstruct.view.page import report
from femstruct.view.sound_figures import levels_over_time, rated_bands
from femstruct.view.spectra import sound
from femstruct.view.structure_tables import show_inspection
from femstruct.view.terminal import show_study
from femstruct.workflow import case as struck
from femstruct.workflow.check import inspect_file
from femstruct.workflow.run import run_study, without_rooms

MODEL = """
materials: {concrete: {E: 30 GPa, nu: 0.2, rho: 2400}}
parts: {slab: {type: plate, material: concrete, thickness: 0.15 m, origin: [0, 0, 2.5], size: [3, 2], mesh: [6, 4]}}
supports: {edges: {on: slab, edge: all, fix: simple}}
points: {drops: {on: slab, at: [[1.2, 0.8], [0.6, 1.3]]}, other: {on: slab, at: [[2, 1], [2.2, 1]]}}
surfaces: {ceiling: {on: slab, side: below}}
damping: {loss_factor: 5 %}
"""
STUDY = """model: model.yaml
modes: {up_to: 800 Hz}
bodies: {ball: {source: rubber ball, above: drops}}
record: {ball on drops: force}
time: {duration: 0.4 s, sampling: 4 kHz}
rooms:
  bedroom:
    size: [3, 2, 2.5]
    under: ceiling
    losses: {t60: 0.4 s}
    receivers: {mic: [[0.8, 0.7, 1.2], [2.1, 1.1, 1.5]]}
    levels: [ISO 16283-2, ISO 717-2]
    beyond_modes: blank
    ensemble: 0
"""
FEET = "[[1, 1], [1.1, 1], [1.2, 1], [1.3, 1], [1.4, 1], [2, 0.5], [2, 0.6], [2, 0.7], [2, 0.8], [2, 0.9]]"
TURNS = "blows: {count: 2, timing: regular}"
HAMMERS = f"{{source: tapping machine, above: feet, contact: {{type: linear, stiffness: 2 MN/m}}, {TURNS}}}"


def read(folder: Path, study: str = STUDY, model: str = MODEL):
    (folder / "model.yaml").write_text(model, encoding="utf-8")
    (folder / "one.study.yaml").write_text(study, encoding="utf-8")
    return read_study(folder / "one.study.yaml")


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> StudyResult:
    return run_study(read(tmp_path_factory.mktemp("drops")))


def test_drops_are_the_runs_of_their_places(result: StudyResult, tmp_path: Path) -> None:
    """Each place alone gives the same levels; rated together they are one energy average."""
    case = result.cases["as given"]
    assert list(case.drops) == ["drops.1", "drops.2"]
    alone = []
    for i in (1, 2):
        one = run_study(
            read(tmp_path, STUDY.replace("above: drops", f"above: drops.{i}").replace("on drops", f"on drops.{i}"))
        )
        found = one.cases["as given"]
        alone.append([level.bands_db for level in found.levels.values()])
        for name, level in found.levels.items():
            # alone, the basis has residual vectors for one place, not two: modes are the same, statics are not
            together = case.drops[f"drops.{i}"].levels[name].bands_db
            for band in (63.0, 125.0, 250.0, 500.0):
                # dB: residual vectors, as said above
                assert together[band] == pytest.approx(level.bands_db[band], abs=0.05)
        assert found.drops == {}
    by_hand = rate_room(alone, case.case.study.rooms[0].room)
    rated = case.rated["bedroom"]
    assert dict(rated.bands_db) == pytest.approx(dict(by_hand.bands_db), abs=0.05)  # the same
    assert dict(rated.drops_spread_db) == pytest.approx(dict(by_hand.drops_spread_db), abs=0.01)  # 8e-5 here
    levels = [drop.levels["bedroom.mic.1"].bands_db[63.0] for drop in case.drops.values()]
    assert abs(levels[0] - levels[1]) > 1.0  # or the test could not tell one place from the other
    assert rated.measured_db[:, 0, 1].tolist() == levels


def test_channels_are_those_of_the_first_drop(result: StudyResult) -> None:
    case = result.cases["as given"]
    assert case.response is not None
    assert list(case.response.contacts) == ["ball on drops.1"]
    assert case.channels["ball on drops.1 force"].whole > 1000.0
    assert list(case.drops["drops.2"].peak_force) == ["ball on drops.2"]
    few = next(one for one in case.findings if one.code == "rating-of-few-places")
    assert (few.values["drops"], few.values["receivers"], few.values["wanted"]) == (2, 2, 4)


def test_drops_in_terminal_tables_and_file(
    result: StudyResult, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    case = result.cases["as given"]
    rated = case.rated["bedroom"]
    show_study(result, {})
    shown = capsys.readouterr().out
    told = "the source strikes 2 places; ratings are of all, other results are of the first, drops.1"
    assert told in shown
    assert told in report(result)
    symbol = "L'_iA,Fmax,V,T"
    row = next(line for line in shown.splitlines() if symbol in line and "as given" in line)
    spreads = [f"{spread[symbol]:.1f}" for spread in (rated.drops_spread_db, rated.receivers_spread_db)]
    assert row.split()[5:7] == spreads and "2 drops" in shown and "2 receivers" in shown
    table = summary(result)["cases"]["as given"]
    found = table["rated"]["bedroom"]["numbers"][symbol]
    assert found["drops_spread_db"] == pytest.approx(rated.drops_spread_db[symbol])
    assert table["drops"]["drops.2"]["levels"]["bedroom.mic.1"]["bands_db"]["63"] == rated.measured_db[1, 0, 1]
    write_results(tmp_path / "results.h5", result)
    with h5py.File(tmp_path / "results.h5") as file:
        stored = file["cases/as given/rated/bedroom"]
        assert stored["measured_db"].shape == (2, 2, 12)
        np.testing.assert_array_equal(stored["measured_db"][:], rated.measured_db)
        second = file["cases/as given/drops/drops.2/levels/bedroom.mic.2"]
        levels = case.drops["drops.2"].levels["bedroom.mic.2"]
        np.testing.assert_array_equal(second["bands_db"][:], list(levels.bands_db.values()))


def test_bands_are_drawn_with_the_curve_of_the_rating(result: StudyResult) -> None:
    """Bars as high as the averages, whiskers of one standard deviation, a curve that rates as the baseline does."""
    rated = result.cases["as given"].rated["bedroom"]
    figure = rated_bands(result, "bedroom")
    assert figure is not None
    axes = figure.axes[0]
    tops = [bar.get_y() + bar.get_height() for bar in axes.patches]
    assert tops == pytest.approx(list(rated.bands_db.values()))
    (curve,) = (line for line in axes.get_lines() if line.get_linestyle() == "--")
    assert rated.rating is not None
    drawn = dict(zip(rated.bands_hz, np.asarray(curve.get_ydata()), strict=True))
    assert heavy_impact_level(drawn).unrounded_db == pytest.approx(rated.rating.unrounded_db)
    assert axes.get_ylabel() == "L'_i,Fmax,V,T in dB re 20 µPa"
    for other in (levels_over_time(result, "bedroom"), sound(result, "bedroom.mic.1")):
        assert other is not None
        assert other.texts[0].get_text().endswith(", source at drops.1")


def test_a_tapping_machine_has_positions_of_five_hammers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Ten places are two positions; levels are those of the mean square over the later half of its turns."""
    model = MODEL.replace("points: {drops:", f"points: {{feet: {{on: slab, at: {FEET}}}, drops:")
    study = STUDY.replace("{source: rubber ball, above: drops}", HAMMERS).replace(
        "record: {ball on drops: force}", "record: {ball on feet: force}\nlimits: {ball on feet force: 1 kN}"
    )
    study = study.replace("duration: 0.4 s, sampling: 4 kHz", "duration: 1 s, sampling: 7.6 kHz")
    study = study.replace("[[0.8, 0.7, 1.2], [2.1, 1.1, 1.5]]", "[0.8, 0.7, 1.2]")
    plan = read(tmp_path, study, model)
    case = plan.cases[0]
    assert list(case.drops) == ["feet.1-5", "feet.6-10"]
    bodies = case.drops["feet.6-10"].bodies
    assert [body.target for body in bodies] == [f"feet.{i}" for i in range(6, 11)]
    assert [body.blows.first for body in bodies if body.blows] == pytest.approx([0.1 * i for i in range(5)])
    result = run_study(plan)
    found = result.cases["as given"]
    forces = [max(drop.peak_force.values()) for drop in found.drops.values()]
    judged = result.verdicts["as given"]
    assert [one.name for one in judged] == [f"ball.{i} on feet force" for i in range(1, 6)]
    # samples of a half sine of 1.6 ms at 7.6 kHz miss 1 - cos(pi / 24) of its peak at most
    assert max(one.value or 0.0 for one in judged) == pytest.approx(max(forces), rel=1e-2)
    assert {one.at for one in judged} <= set(found.drops)
    rated = found.rated["bedroom"]
    assert (rated.method.blows, next(iter(rated.numbers)), rated.measured_db.shape) == (
        "tapping",
        "L'_nT,w",
        (2, 1, 16),
    )
    exposures = found.drops["feet.1-5"].levels["bedroom.mic"].exposure_db
    # 1 s of sound: its exposure is its mean level. The later half is no louder or softer than the whole by more than
    # what builds up in the first turns and rings on: 2 dB
    wanted = [exposures[band] for band in rated.bands_hz]
    assert rated.measured_db[0, 0].tolist() == pytest.approx(wanted, abs=2.0, nan_ok=True)
    assert rated.blank_hz == tuple(band for band in rated.bands_hz if band > 630.0)
    codes = {one.code: one for one in found.findings}
    assert codes["rating-beyond-modes"].values["highest_hz"] == pytest.approx(10**3.5 * filter_reach(3))
    assert "tapping-not-steady" not in codes
    steady = {
        "blow-before-rest",
        "structure-not-decayed",
        "surface-not-decayed",
    }  # true of a machine that runs, and no reason to doubt
    assert not steady & set(codes)
    assert "rating-of-other-blows" not in codes
    monkeypatch.setattr(struck, "STEADY", ())
    told = {one.code for one in run_study(without_rooms(plan)).cases["as given"].findings}
    assert "blow-before-rest" in told  # but for its steadiness


LIMITED = "limits: {ball on drops force: FORCE, settled: 0.3 s, bedroom rating: LEVEL}\nrecord:"


def test_limits_are_of_the_worst_drop_and_of_the_rating(
    result: StudyResult, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The forces of the drops, each alone, decide; the rating is of both. Half a decibel below it is exceeded."""
    before = result.cases["as given"]
    peaks = {place: drop.peak_force[f"ball on {place}"] for place, drop in before.drops.items()}
    rating = before.rated["bedroom"].rating
    assert rating is not None
    between = 0.5 * sum(peaks.values())  # met at one place, exceeded at the other
    level = rating.value_db
    text = LIMITED.replace("FORCE", f"{between} N").replace("LEVEL", f"{level - 0.5} dB")
    limited = run_study(read(tmp_path, STUDY.replace("record:", text)))
    force, settled, rated = limited.verdicts["as given"]
    worst = max(peaks, key=peaks.__getitem__)
    assert (force.name, force.at, force.met) == ("ball on drops force", worst, False)
    # samples at 4 kHz see a little less than the peak
    assert force.value == pytest.approx(peaks[worst], rel=5e-3)
    rests = {place: drop.verdicts[1].value for place, drop in limited.cases["as given"].drops.items()}
    assert (settled.name, settled.value) == ("settled", max(one for one in rests.values() if one is not None))
    assert rests[settled.at] == settled.value
    assert (rated.name, rated.at, rated.unit) == ("bedroom rating", "", "dB")
    assert (rated.value, rated.limit, rated.met) == (level, level - 0.5, False)
    show_study(limited, {})
    shown = capsys.readouterr().out
    assert f"at {worst}" in shown
    assert "exceeded by 0.5 dB" in shown
    assert "ratings are of all, limits of the worst, other results are of the first" in shown
    table = summary(limited)["cases"]["as given"]["limits"]
    assert (table["ball on drops force"]["at"], table["bedroom rating"]["at"]) == (worst, None)
    assert table["bedroom rating"]["verdict"] == "exceeded"
    write_results(tmp_path / "results.h5", limited)
    with h5py.File(tmp_path / "results.h5") as file:
        assert list(file["cases/as given/limits/at"].asstr()) == [worst, settled.at, ""]
    deaf = run_study(without_rooms(read_study(tmp_path / "one.study.yaml")))
    assert [one.name for one in deaf.verdicts["as given"]] == ["ball on drops force", "settled"]


def test_a_room_that_is_removed_takes_its_limit_along(tmp_path: Path) -> None:
    text = STUDY.replace("record:", "limits: {bedroom rating: 53 dB}\nrecord:")
    plan = read(tmp_path, text + "cases: {all: {limits.bedroom rating: 50}, none: {remove: [rooms.bedroom]}}\n")
    assert [[(one.name, one.value, one.room) for one in case.study.limits] for case in plan.cases] == [
        [("bedroom rating", 50.0, "bedroom")],
        [],
    ]


def test_check_names_the_places(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    read(tmp_path)
    table = inspect_file(tmp_path / "one.study.yaml").table()
    assert table["drops"] == ["drops.1", "drops.2"]
    show_inspection(table)
    assert "the source strikes drops.1, drops.2: one simulation for each" in capsys.readouterr().out
    assert inspect_file(tmp_path / "model.yaml").table()["drops"] == []


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("bodies: {", "bodies: {second: {source: bang machine, above: other}, ", "a second source of several places"),
        ("record:", "limits: {ball on drops.1 force: 1 kN}\nrecord:", "did you mean 'ball on drops force'"),
        ("source: rubber ball, above: drops", "source: rubber ball, above: dropss", "did you mean 'drops"),
    ],
)
def test_what_cannot_be_dropped_is_refused_with_its_line(tmp_path: Path, old: str, new: str, told: str) -> None:
    with pytest.raises(InputErrors, match=told):
        read(tmp_path, STUDY.replace(old, new, 1))


def test_tapping_needs_a_sampling_and_a_turn(tmp_path: Path) -> None:
    model = MODEL.replace("points: {drops:", f"points: {{feet: {{on: slab, at: {FEET}}}, drops:")
    study = STUDY.replace("{source: rubber ball, above: drops}", HAMMERS).replace(
        "record: {ball on drops: force}\n", ""
    )
    with pytest.raises(InputErrors, match="7600 Hz or more for the bands up to 3150 Hz") as caught:
        read(tmp_path, study, model)
    assert "0.5 s or more: one turn of its five hammers" in str(caught.value)
