"""`femstruct identify` on measured frequencies, shapes, responses and levels: a floor that is known, with noise."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from femstruct.cli import app
from femstruct.errors import FemstructError
from femstruct.files.frf_files import write_frf_csv, write_frf_uff
from femstruct.files.sheets import sheets, write_comparison, write_csv
from femstruct.files.uff import write_uff
from femstruct.language.cases import read_study
from femstruct.language.models import read_model_file
from femstruct.modal.measured import FrfTable, MeasuredModes, Measurement
from femstruct.study.asked import Beside, Extent
from femstruct.view.drawing import save
from femstruct.view.fit_figures import fit_figure
from femstruct.view.structure_tables import found_lines, show_identification
from femstruct.workflow.bases import solve
from femstruct.workflow.exchange import frfs_of
from femstruct.workflow.identify import Identification, identify
from femstruct.workflow.measured_data import FrfDatum, MeasuredFiles, read_data, read_frfs, read_levels
from femstruct.workflow.modes import modes_of
from femstruct.workflow.run import run_study
from femstruct.workflow.trial import Needs, Trial, Trials, parameters_of, read_source

FLOOR = Path(__file__).parents[1] / "data" / "floor_to_fit.yaml"
CONCRETE, POSTS, LOSS = "materials.concrete.E", "parts.posts.stiffness.z", "materials.concrete.loss_factor"
DENSITY = "materials.concrete.rho"
TRUTH = {CONCRETE: 30.0, POSTS: 20.0, LOSS: 3.0}
STARTS = (f"{CONCRETE}=26 GPa:15 GPa:60 GPa", f"{POSTS}=17 MN/m", f"{LOSS}=4 %")
MEASURED = (3, 5, 6, 7, 8)  # modes that move up and down
NOISE = 0.02
OF_THE_FLOOR = {"thick-plate", "coarse-mesh", "thick-for-short-waves", "modal-mass-low"}  # not of the fit


@cache
def exact() -> tuple[np.ndarray, FrfTable]:
    """Natural frequencies of the modes measured, and one response."""
    hertz = np.array(modes_of(FLOOR, Extent(count=8))["frequency_hz"])[np.array(MEASURED) - 1]
    return hertz, frfs_of(FLOOR, ["P.z"], ["Q.z"], "6 Hz:66 Hz", "1 Hz", "accelerance")[0]


def written(folder: Path, seed: int, noise: float = NOISE) -> MeasuredFiles:
    """Files of the floor with independent noise."""
    rng, (hertz, table) = np.random.default_rng(seed), exact()
    rows = zip(MEASURED, (hertz * (1.0 + noise * rng.standard_normal(len(hertz)))).tolist(), strict=True)
    lines = ["mode; f [Hz]; scatter [%]", *(f"{mode}; {value:.6f}; {100 * NOISE:g}" for mode, value in rows)]
    (folder / "f.csv").write_text("\n".join(lines), encoding="utf-8")
    both = rng.standard_normal((2, *table.values.shape))
    noisy = replace(table, values=table.values * (1.0 + noise * (both[0] + 1j * both[1])))
    write_frf_csv(noisy, folder / "frf.csv")
    return MeasuredFiles(modes=(str(folder / "f.csv"),), frfs=(f"{folder / 'frf.csv'} +- {100 * NOISE:g} %",))


def covered(found: Identification) -> list[bool]:
    return [found.fit.low[name] <= value <= found.fit.high[name] for name, value in TRUTH.items()]


def test_frequencies_and_a_response_give_the_floor_they_are_of(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Stiffness of concrete and posts and a loss factor, in all the ways in which they are shown."""
    found = identify(FLOOR, written(tmp_path, 5), parameters=STARTS)
    assert covered(found) == [True] * 3  # of this draw; one interval in twenty does not
    assert found.fit.known and found.runs < 12  # Gauss and Newton: 9 here
    assert {finding.code for finding in found.findings} <= OF_THE_FLOOR
    table = found.table()
    assert [(one["name"], one["numbers"]) for one in table["data"]] == [("f.csv", 5), ("accelerance Q.z / P.z", 122)]
    assert table["not_distinguished"] == [] and "channel" not in table
    show_identification(table, found.beside)
    shown = capsys.readouterr().out
    assert "to use the values: --set 'materials.concrete.E=" in shown and "f.csv: 5 numbers, residuals" in shown
    write_comparison(found.beside, tmp_path / "beside.csv")
    rows = (tmp_path / "beside.csv").read_text(encoding="utf-8-sig").splitlines()
    assert len(rows) == 1 + 5 + 61 and rows[1].startswith("modes,f.csv,1.0,,Hz,") and rows[1].endswith(",mode 3")
    assert rows[6].startswith("frf,accelerance Q.z / P.z,6.0,Hz,m/(N s^2),")
    levels = Beside("levels", "hall.mic", "dB", [63.0, 125.0], [60.0, 50.0], [61.0, 49.0], [1.0, 1.0])  # type: ignore[arg-type]
    lines = found_lines(found.table())
    figure = fit_figure((*found.beside, levels), found.title, lines)
    assert [text.get_text() for text in figure.texts[1:]] == lines
    value, low, high = (f"{one[CONCRETE]:.5g}" for one in (found.fit.values, found.fit.low, found.fit.high))
    assert lines[0] == f"{CONCRETE} = {value} GPa  (95 % interval {low} .. {high})"
    save(figure, tmp_path / "fit.png")
    assert (tmp_path / "fit.png").stat().st_size > 10_000


@pytest.mark.stress
def test_exact_data_give_the_truth(tmp_path: Path) -> None:
    exactly = identify(FLOOR, written(tmp_path, 5, noise=0.0), parameters=STARTS)
    # the table has what modes with two residual vectors make of it, 1e-6 of it; six decimals of the frequencies
    assert exactly.fit.values == pytest.approx(TRUTH, rel=1e-5)
    noisy = identify(FLOOR, written(tmp_path, 5), parameters=STARTS)
    assert exactly.fit.deviations == pytest.approx(noisy.fit.deviations, rel=0.05)  # of the scatter, not of residuals
    assert exactly.changes[0] == "materials.concrete.E=30 GPa"


@pytest.mark.stress
def test_intervals_cover_the_truth(tmp_path: Path) -> None:
    """100 seeds of 2 % of noise: 90 to 98 % of the intervals of three parameters hold the truth, and of each 95 %
    but for chance. 340 seeds have 96.5, 94.7 and 96.5 %."""
    hits = np.array([covered(identify(FLOOR, written(tmp_path, seed), parameters=STARTS)) for seed in range(100)])
    share = hits.sum(axis=0) / 100.0
    assert 270 <= hits.sum() <= 294, share
    assert np.abs(share - 0.95).max() < 3.0 * np.sqrt(0.95 * 0.05 / 100.0), share  # three deviations, binomially


def test_what_frequencies_cannot_distinguish_is_named(tmp_path: Path) -> None:
    """Frequencies are those of stiffness over mass: three numbers, of which only two ratios count."""
    files = replace(written(tmp_path, 5), frfs=())
    found = identify(FLOOR, files, parameters=(f"{CONCRETE}=29 GPa", f"{POSTS}=21 MN/m", f"{DENSITY}=2450 kg/m^3"))
    assert found.runs < 15  # 12 here
    assert found.fit.open == pytest.approx(np.ones((1, 3)) / np.sqrt(3.0), abs=1e-6)  # derivatives are as good
    (one,) = found.combinations
    assert [kept.formula for kept in one.kept] == [f"{CONCRETE} / {DENSITY}", f"{POSTS} / {DENSITY}"]
    told = next(finding for finding in found.findings if finding.code == "parameters-not-distinguished")
    assert f"{CONCRETE}, {POSTS} and {DENSITY}: the data cannot distinguish them: +10 % of {CONCRETE}" in told.message
    assert np.isinf(found.fit.high[CONCRETE]) and found.table()["parameters"][CONCRETE]["high"] is None


@pytest.mark.stress
def test_what_is_determined_has_the_interval_of_a_fit_of_it_alone(tmp_path: Path) -> None:
    """Stiffness over density, with the density left open or fixed."""
    files = replace(written(tmp_path, 5), frfs=())
    (one,) = identify(FLOOR, files, parameters=(*STARTS[:2], f"{DENSITY}=2600 kg/m^3")).combinations
    two = identify(FLOOR, files, parameters=STARTS[:2])
    for name, kept in ((CONCRETE, one.kept[0]), (POSTS, one.kept[1])):  # the density is as in the file
        assert kept.value == pytest.approx(two.fit.values[name] / 2400.0, rel=1e-6)  # the last step
        half = 0.5 * (two.fit.high[name] - two.fit.low[name])
        assert kept.half == pytest.approx(half / two.fit.values[name], rel=1e-4)  # likewise


def test_one_frequency_leaves_stiffness_of_concrete_and_posts_open(tmp_path: Path) -> None:
    """Heave: the slab bends on its posts."""
    (tmp_path / "heave.csv").write_text("mode, frequency [Hz], scatter [%]\n3, 11.97, 1", encoding="utf-8")
    alone = identify(FLOOR, MeasuredFiles(modes=(str(tmp_path / "heave.csv"),)), parameters=STARTS[:2])
    (one,) = alone.combinations
    assert one.names == (CONCRETE, POSTS) and one.changes[0] * one.changes[1] < 0.0
    assert one.kept[0].words == "the product of powers"
    power = float(one.kept[0].formula.rpartition("^")[2])  # E k^q: the frequency goes with its (2 + 2 q)th root
    assert one.kept[0].half == pytest.approx(0.01 * 1.96 * (2.0 + 2.0 * power), rel=0.01)  # three digits of q


def test_a_sum_is_no_product(tmp_path: Path) -> None:
    """Two springs side by side below one mass: only their sum counts."""
    model = """
        parts: {mass: {type: block, mass: 8 kg, origin: [0, 0, 0], size: [1, 1, 1]},
                one: {type: spring, between: [foot, ground], stiffness: {z: 3 kN/m}},
                other: {type: spring, between: [foot, ground], stiffness: {z: 5 kN/m}}}
        points: {foot: {on: mass, at: [0.5, 0.5, 0.5]}}
    """
    (tmp_path / "springs.yaml").write_text(model, encoding="utf-8")
    hertz = np.sqrt(1.21 * 8000.0 / 8.0) / (2.0 * np.pi)
    (tmp_path / "f.csv").write_text(f"{hertz:.9f}", encoding="utf-8")
    fits = ("parts.one.stiffness.z=3 kN/m", "parts.other.stiffness.z=5 kN/m")
    found = identify(tmp_path / "springs.yaml", MeasuredFiles(modes=(f"{tmp_path / 'f.csv'} +- 1 %",)), parameters=fits)
    (kept,) = found.combinations[0].kept
    assert (kept.words, kept.formula) == ("the sum", "parts.one.stiffness.z + parts.other.stiffness.z")
    assert kept.value == pytest.approx(1.21 * 8.0, rel=1e-8)  # nine decimals
    assert kept.half == pytest.approx(2 * 0.01 * 1.96, rel=1e-3)  # k goes with the square of f; 1.95996
    assert {finding.code for finding in found.findings} == {"parameters-not-distinguished", "pairs-by-order"}


def with_shapes(folder: Path) -> tuple[MeasuredFiles, int]:
    """A universal file of modes with noise of 5 % on their shapes at half of the nodes, along z; how many these are."""
    solved = solve(read_model_file(FLOOR).structure, Extent(count=8))
    basis, kept = solved.basis, np.array(MEASURED) - 1
    places = np.arange(0, len(basis.points), 2)
    shapes = np.zeros((len(places), 3, len(kept)))
    shapes[:, 2] = basis.shapes[places, 2][:, kept]
    size = np.sqrt((shapes[:, 2] ** 2).mean(axis=0))
    shapes[:, 2] += 0.05 * size * np.random.default_rng(2).standard_normal(shapes[:, 2].shape)
    directed = np.zeros((len(places), 3), dtype=bool)
    directed[:, 2] = True
    modes = MeasuredModes(basis.frequency_hz[kept], np.zeros(5), shapes, basis.points[places], directed)
    write_uff(Measurement("test", np.arange(len(places)) + 1, basis.points[places], modes=modes), folder / "m.uff")
    return MeasuredFiles(modes=(f"{folder / 'm.uff'} +- 0.5 %",)), len(places)


@pytest.mark.stress
def test_shapes_pair_the_modes_and_count(tmp_path: Path) -> None:
    """Modes of a universal file at half of the nodes, along z, of which the fit knows no numbers."""
    files, places = with_shapes(tmp_path)
    by_frequency = identify(FLOOR, files, parameters=STARTS[:2])
    notes = by_frequency.beside[0].notes
    assert [note.split(",")[0] for note in notes] == [f"mode {i}" for i in MEASURED]
    assert min(float(note.rpartition(" ")[2]) for note in notes) > 0.99
    assert by_frequency.fit.values == pytest.approx({CONCRETE: 30.0, POSTS: 20.0}, rel=1e-5)  # digits of the file
    both = identify(FLOOR, replace(files, shapes="5 %"), parameters=STARTS[:2])
    assert all(both.fit.deviations[name] < by_frequency.fit.deviations[name] for name in (CONCRETE, POSTS))
    assert both.left[0].count == 5 + 5 * (places - 1)  # along its partner a shape says nothing
    assert 0.7 < both.left[0].rms < 1.1  # of shapes as stated, less what five mixtures take


def test_options_reach_the_data(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    words = ["identify", str(FLOOR), "--fit", STARTS[0]]
    for option in ("--modes", "--frf"):
        with pytest.raises(FemstructError, match=f"no file 'none{option}.csv'"):
            CliRunner().invoke(app, [*words, option, f"none{option}.csv +- 1 %"], catch_exceptions=False)
    for option, given in (
        ("--near", "200 %"),
        ("--shapes", "5 %"),
        ("--length", "x"),
        ("--band", "1:2"),
        ("--levels", "x"),
    ):
        written(tmp_path, 1)
        with pytest.raises(FemstructError, match=option):
            CliRunner().invoke(app, [*words, "--modes", "f.csv", option, given], catch_exceptions=False)


def exported(tmp_path: Path) -> Path:
    """Levels of a study of a ball on the floor over a room, as `export` writes them; the study stands beside them."""
    (tmp_path / "floor.yaml").write_text(FLOOR.read_text(encoding="utf-8"), encoding="utf-8")
    study = """
        model: floor.yaml
        modes: {up_to: 200 Hz}
        bodies: {ball: {mass: 2.5 kg, above: P, drop_height: 1 m, contact: {type: linear, stiffness: 60 kN/m}}}
        time: {duration: 0.3 s, sampling: 2 kHz}
        rooms: {hall: {size: [4, 3, 2.5], under: ceiling, losses: {t60: 0.5 s}, receivers: {mic: [1.2, 1, 1.2]}}}
    """
    (tmp_path / "drop.study.yaml").write_text(study, encoding="utf-8")
    result = run_study(read_study(tmp_path / "drop.study.yaml"))
    write_csv(sheets(result), tmp_path, "out")
    file = tmp_path / "out.third_octaves.csv"
    assert any(row.endswith(",") for row in file.read_text("utf-8-sig").splitlines())
    assert file.read_text("utf-8-sig").splitlines()[0] == "band_hz,as given: hall.mic bands_db (L_Fmax)"
    earlier = tmp_path / "earlier.csv"
    earlier.write_text(file.read_text("utf-8-sig").replace(" (L_Fmax)", ""), encoding="utf-8")
    assert len(read_levels(earlier, 0.5, result.plan)) == 1
    (one,) = read_levels(file, 0.5, result.plan)
    assert one.residuals(Trial({}, None, result.cases["as given"])) == pytest.approx(
        np.zeros(9), abs=1e-9
    )  # digits of the table
    return file


def test_levels_are_those_that_export_writes(tmp_path: Path) -> None:
    """Blanks and all; one that was measured 2 dB higher is four times a scatter of 0.5 dB."""
    file = exported(tmp_path)
    told = file.read_text("utf-8-sig").splitlines()
    band, level = told[2].split(",")
    (tmp_path / "higher.csv").write_text(f"Hz; hall.mic [dB]\n{band}; {float(level) + 2.0}\n", encoding="utf-8")
    plan = read_study(tmp_path / "drop.study.yaml")
    (one,) = read_levels(tmp_path / "higher.csv", 0.5, plan)
    case = run_study(plan).cases["as given"]
    assert one.residuals(Trial({}, None, case)) == pytest.approx([-4.0], abs=1e-9)  # digits of the table


def test_levels_are_those_of_the_planned_time_whatever_is_fitted_beside_them(tmp_path: Path) -> None:
    """A history of 50 ms beside levels of 0.3 s: of 50 ms a level would have a sixth of the time to average over."""
    levels, drop = exported(tmp_path), tmp_path / "drop.study.yaml"
    (tmp_path / "v.csv").write_text("".join(f"{i / 2000}, {1 + i}\n" for i in range(100)), encoding="utf-8")
    files = MeasuredFiles(str(tmp_path / "v.csv"), "ball velocity", levels=(f"{levels} +- 1 dB",))
    recorded, stiffness = ("record.ball=velocity",), "bodies.ball.contact.stiffness"
    data, _ = read_data(files, read_source(drop, recorded, ""), delay=False)
    found, units = parameters_of((f"{stiffness}=60 kN/m",))
    trials = Trials(drop, found, units, sum((one.needs for one in data), start=Needs()), overrides=recorded)
    left = data[1].residuals(trials.at({stiffness: 60.0}))
    assert left == pytest.approx(np.zeros(9), abs=1e-9)  # digits of the table
    alone = Trials(drop, found, units, data[0].needs, overrides=recorded).at({stiffness: 60.0})
    assert alone.result is not None and alone.result.response is not None
    assert alone.result.response.t[-1] < 0.06  # a history alone needs no more than itself


@pytest.mark.stress
def test_levels_of_a_study(tmp_path: Path) -> None:
    """The stiffness of a ball."""
    levels = MeasuredFiles(levels=(f"{exported(tmp_path)} +- 1 dB",))
    found = identify(tmp_path / "drop.study.yaml", levels, parameters=("bodies.ball.contact.stiffness=52 kN/m",))
    assert [(one.kind, one.name) for one in found.beside] == [("levels", "hall.mic")]
    # differences of a simulation
    assert found.fit.values["bodies.ball.contact.stiffness"] == pytest.approx(60.0, rel=1e-5)


def test_residuals_and_their_derivatives(tmp_path: Path) -> None:
    """Frequencies, shapes and a response of one trial, away from the truth: derivatives as differences have them."""
    files = replace(with_shapes(tmp_path)[0], shapes="5 %", frfs=written(tmp_path, 3).frfs)
    data, _ = read_data(files, read_source(FLOOR, (), ""), delay=False)
    found, units = parameters_of((STARTS[0], STARTS[1]))
    trials = Trials(FLOOR, found, units, sum((one.needs for one in data), start=Needs()))
    values = {CONCRETE: 29.0, POSTS: 21.0}
    change = trials.change(values, POSTS)
    assert change is not None
    for one in data:
        slope = one.slopes(trials.at(values), change)
        up, down = ({**values, POSTS: 21.0 + step} for step in (2e-3, -2e-3))
        expected = (one.residuals(trials.at(up)) - one.residuals(trials.at(down))) / 4e-3
        assert slope == pytest.approx(expected, abs=1e-5 * float(np.abs(expected).max()))  # differences of 1e-4


def test_pairs_follow_shapes_where_the_order_changes(tmp_path: Path) -> None:
    """On soft posts heave is below both sways: mode 1, not 3. By number it is followed from the start, by order not."""
    shaped = with_shapes(tmp_path)[0]
    for files in (shaped, replace(written(tmp_path, 1), frfs=())):
        (one,), _ = read_data(files, read_source(FLOOR, (), ""), delay=False)
        found, units = parameters_of((f"{POSTS}=20 MN/m",))
        trials = Trials(FLOOR, found, units, one.needs)
        stiff, soft = trials.at({POSTS: 20.0}), trials.at({POSTS: 4.0})
        assert [one.beside(trial)[0].notes[0].split(",")[0] for trial in (stiff, soft)] == ["mode 3", "mode 1"]
        (told,) = one.findings(stiff, soft)
        assert told.code == "mode-pair-swapped" and "mode 3, then 1" in told.message


def test_responses_of_universal_files_are_found_by_name_or_place(tmp_path: Path) -> None:
    """A file whose nodes have other names than the points of the model, in millimetres; and one of a node beside it."""
    table = exact()[1]
    places = {"first": [1.5, 1.0, 0.0], "other": [2.5, 2.0, 0.0]}
    renamed = FrfTable(table.frequency_hz, ("first.z",), ("other.z",), table.kinds, table.values)
    write_frf_uff(renamed, places, tmp_path / "named.uff")
    points = solve(read_model_file(FLOOR).structure, Extent(count=1), ()).places
    (one,) = read_frfs(tmp_path / "named.uff", 0.02, points, (20.0, 30.0), 1.0)
    assert (str(one.request.drive), str(one.request.response), one.frequency_hz[0], len(one.values)) == (
        "P.z",
        "Q.z",
        20,
        11,
    )
    assert one.values == pytest.approx(table.values[0, 0, 14:25], rel=1e-6)  # digits of the file
    write_frf_uff(renamed, {**places, "other": [2.6, 2.0, 0.0]}, tmp_path / "beside.uff")
    with pytest.raises(
        FemstructError, match=r"--frf: got 'other.z' at \(2.6, 2, 0\) m, which is no point of the model"
    ):
        read_frfs(tmp_path / "beside.uff", 0.02, points, None, 1.0)


def test_a_missing_mode_is_thought_of(tmp_path: Path) -> None:
    """Five modes without numbers, which order takes for the first five: the finding proposes a column of numbers."""
    hertz = exact()[0]
    for head, rows in (
        ("frequency [Hz]", [f"{value:.4f}" for value in hertz]),
        ("frequency [Hz];mode", [f"{value:.4f};{mode}" for value, mode in zip(hertz, MEASURED, strict=True)]),
    ):
        (tmp_path / "f.csv").write_text("\n".join([head, *rows]), encoding="utf-8")
        files = MeasuredFiles(modes=(f"{tmp_path / 'f.csv'} +- 0.5 %",))
        found = identify(FLOOR, files, parameters=(f"{POSTS}=22 MN/m:15:30",), overrides=(f"{CONCRETE}=36 GPa",))
        (told,) = (one for one in found.findings if one.code == "fit-beyond-scatter")
        assert ("a column 'mode'" in told.message and "or measure shapes" in told.message) == (";" not in head)


def test_damping_of_single_modes_follows_them(tmp_path: Path) -> None:
    """Mode 3 of the file is heave, with 4 %; on soft posts it is mode 1, far from where the file expects it."""
    text = FLOOR.read_text(encoding="utf-8").replace(
        "damping: {from: materials}", "damping: {ratio: 1 %, modes: {3: {ratio: 4 %, near: 11.97 Hz}}}"
    )
    file = tmp_path / "floor.yaml"
    file.write_text(text, encoding="utf-8")
    (one,), _ = read_data(replace(written(tmp_path, 1), modes=()), read_source(file, (), ""), delay=False)
    found, units = parameters_of((f"{POSTS}=20 MN/m",))
    trials = Trials(file, found, units, one.needs)
    dashpots = trials.at({POSTS: 4.0}).modes.bare.viscous  # type: ignore[union-attr]  # modes are what it needs
    soft = trials.at({POSTS: 4.0}).modes.damped  # type: ignore[union-attr]
    own = (np.diag(soft.viscous) - np.diag(dashpots)) / (2.0 * soft.omega)
    assert own[:3] == pytest.approx([0.04, 0.01, 0.01], rel=1e-9)  # rounding
    change = trials.change({POSTS: 4.0}, POSTS)
    assert change is not None and not change.of_damping and one.slopes(trials.at({POSTS: 4.0}), change) is None


def test_near_equal_frequencies_are_one_space(tmp_path: Path) -> None:
    """Modes (1, 2) and (2, 1) of a square plate, turned by 45 degrees and 0.4 % apart: their mean counts, once, and
    their shapes lie in the space of both."""
    model = """
        materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
        parts: {plate: {type: plate, material: steel, thickness: 3 mm, origin: [0, 0, 0], size: [1, 1], mesh: [6, 6]}}
        supports: {edges: {on: plate, edge: all, fix: simple}}
    """
    (tmp_path / "square.yaml").write_text(model, encoding="utf-8")
    basis = solve(read_model_file(tmp_path / "square.yaml").structure, Extent(count=3)).basis
    turned = basis.shapes[:, :3, 1:3] @ (np.array([[1.0, -1.0], [1.0, 1.0]]) / np.sqrt(2.0))
    hertz = basis.frequency_hz[1] * np.array([0.999, 1.003])
    modes = MeasuredModes(hertz, np.zeros(2), turned, basis.points, (turned != 0.0).any(axis=2))
    numbers = np.arange(len(basis.points)) + 1
    write_uff(Measurement("square", numbers, basis.points, modes=modes), tmp_path / "m.uff")
    files = MeasuredFiles(modes=(f"{tmp_path / 'm.uff'} +- 1 %",), shapes="5 %")
    (one,), _ = read_data(files, read_source(tmp_path / "square.yaml", (), ""), delay=False)
    found, units = parameters_of(("materials.steel.E=210 GPa",))
    left = one.residuals(Trials(tmp_path / "square.yaml", found, units, one.needs).at({"materials.steel.E": 210.0}))
    # a mean 0.1 % too low, of which two of 1 % have a scatter of 0.71 %; six digits of the file
    assert left[:2] == pytest.approx([-0.001 / 0.01 * np.sqrt(2.0), 0.0], rel=2e-3)
    assert np.abs(left[2:]).max() < 1e-3  # likewise, over 5 %


def test_intervals_count_a_space_of_near_equal_modes_once(tmp_path: Path) -> None:
    """A square plate, its first mode and the pair (1, 2), (2, 1): two numbers for one parameter. f = x f0 with
    x = sqrt(E), so x and its deviation are those of a straight line, with one degree of freedom."""
    model = """
        materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
        parts: {plate: {type: plate, material: steel, thickness: 3 mm, origin: [0, 0, 0], size: [1, 1], mesh: [6, 6]}}
        supports: {edges: {on: plate, edge: all, fix: simple}}
        points: {P: {on: plate, at: [0.3, 0.4]}, Q: {on: plate, at: [0.6, 0.3]}}
    """
    (tmp_path / "square.yaml").write_text(model, encoding="utf-8")
    basis = solve(read_model_file(tmp_path / "square.yaml").structure, Extent(count=3)).basis
    own, shapes = basis.frequency_hz[:3], basis.shapes[:, :3, :3]
    hertz = own * np.array([1.01, 0.995, 0.997])
    modes = MeasuredModes(hertz, np.zeros(3), shapes, basis.points, (shapes != 0.0).any(axis=2))
    write_uff(Measurement("square", np.arange(len(basis.points)) + 1, basis.points, modes=modes), tmp_path / "m.uff")
    files = MeasuredFiles(modes=(str(tmp_path / "m.uff"),))
    found = identify(tmp_path / "square.yaml", files, parameters=("materials.steel.E=205 GPa",))
    # means over their scatters: 1 % of a frequency, of the mean of two 1 % / sqrt(2)
    f0, f = np.array([own[0], own[1:].mean()]), np.array([hertz[0], hertz[1:].mean()])
    weights = 1.0 / np.array([0.01 * hertz[0], 0.005 * np.hypot(*hertz[1:])]) ** 2
    x = (weights * f0 * f).sum() / (weights * f0**2).sum()
    deviation = np.sqrt((weights * (f - x * f0) ** 2).sum() / (weights * f0**2).sum())
    fit, name = found.fit, "materials.steel.E"
    assert fit.values[name] == pytest.approx(210.0 * x**2, rel=1e-5)  # six digits of the file
    assert fit.deviations[name] == pytest.approx(2.0 * 210.0 * x * deviation, rel=1e-3)  # of differences of 1 %
    t95 = 12.7062  # Student's t, 97.5 %, 1 degree of freedom, from tables
    assert fit.high[name] - fit.values[name] == pytest.approx(t95 * fit.deviations[name], rel=1e-5)  # six digits
    assert found.left[0].count == fit.numbers == 2
    with pytest.raises(FemstructError, match="measured: got 2 samples, expected more than 2"):
        identify(
            tmp_path / "square.yaml",
            files,
            parameters=("materials.steel.E=205 GPa", "parts.plate.thickness=2.9 mm"),
        )


def test_a_response_sees_where_its_points_are(tmp_path: Path) -> None:
    """Matrices do not change where a point moves: its slope is left to differences, that of a spring is not."""
    (one,), _ = read_data(replace(written(tmp_path, 1), modes=()), read_source(FLOOR, (), ""), delay=False)
    found, units = parameters_of(("points.P.at[0]=1.4 m", "points.Q.at[1]=2 m", f"{POSTS}=20 MN/m"))
    trials = Trials(FLOOR, found, units, one.needs)
    start = {each.name: each.start for each in found}
    assert [trials.change(start, each.name) is None for each in found] == [True, True, False]


def test_a_column_of_scatter_is_in_the_unit_of_the_response(tmp_path: Path) -> None:
    """Of 4 and of 3 + 4j a scatter of 0.1 and 1 are 2.5 % and 20 %."""
    name = "accelerance Q.z / P.z [m/(N s^2)]"
    head = f"f [Hz],{name} real,{name} imag,{name} scatter"
    (tmp_path / "frf.csv").write_text(f"{head}\n10,4,0,0.1\n11,3,4,1\n", encoding="utf-8")
    (one,), _ = read_data(MeasuredFiles(frfs=(str(tmp_path / "frf.csv"),)), read_source(FLOOR, (), ""), delay=False)
    assert isinstance(one, FrfDatum) and one.known
    assert one.scatter == pytest.approx([0.025, 0.2], rel=1e-12)  # rounding
