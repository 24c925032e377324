"""`femstruct identify`: a record in a file, numbers with intervals out, and what a user gets wrong on the way."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from femstruct.cli import app
from femstruct.errors import FemstructError
from femstruct.impact.numerical_error import error_of
from femstruct.impact.response import Response
from femstruct.language.cases import read_study
from femstruct.workflow import case as struck
from femstruct.workflow.identify import identify
from femstruct.workflow.measured_data import MeasuredFiles, read_data
from femstruct.workflow.run import run_study
from femstruct.workflow.trial import Trial

MODELS = Path(__file__).parents[2] / "models"
STUDY, RECORD, CHANNEL = MODELS / "tennis_ball_drop.study.yaml", MODELS / "tennis_ball_drop.csv", "ball on ground force"
STIFFNESS, DAMPING = "bodies.ball.contact.stiffness", "bodies.ball.contact.damping"
FITS = (f"{STIFFNESS}=1e5 N/m^1.5", f"{DAMPING}=50 N*s/m^1.5")


def test_the_shipped_record_gives_the_numbers_it_was_made_with(monkeypatch: pytest.MonkeyPatch) -> None:
    """And the error of the march is that of the answer: of trials nobody asks, which takes a second simulation each."""
    estimated: list[Response] = []
    monkeypatch.setattr(struck, "error_of", lambda response: estimated.append(response) or error_of(response))
    options = ["--measured", str(RECORD), "--channel", CHANNEL, "--fit", FITS[0], "--fit", FITS[1], "--json"]
    done = CliRunner().invoke(app, ["identify", str(STUDY), *options])
    assert done.exit_code == 0, done.output
    table = json.loads(done.stdout)
    for path, truth, unit in ((STIFFNESS, 2.1e5, "N/m^1.5"), (DAMPING, 160.0, "N*s/m^1.5")):
        one = table["parameters"][path]
        assert one["low"] < truth < one["high"]  # this draw; one in twenty is outside
        assert one["unit"] == unit
        assert one["high"] - one["low"] < 0.02 * truth
    assert table["residual_deviation"] == pytest.approx(0.01 * 42.43, rel=0.1)  # 1 % of the peak; 300 samples
    assert table["findings"] == []
    assert len(estimated) == 1


def test_units_delay_and_another_sampling() -> None:
    """The record in mN and ms, 0.2 ms late, every third sample: the answers come in the units of the starts."""
    t, force = np.loadtxt(RECORD.read_text(encoding="utf-8").splitlines()[1:], delimiter=",").T
    rows = (f"{a + 0.2:.5f}, {1e3 * f:.0f}" for a, f in zip(t[::3], force[::3], strict=True))
    folder = Path.cwd()
    late = folder / "late.csv"
    late.write_text("\n".join(("t [ms], f [mN]", *rows)), encoding="utf-8")
    found = identify(STUDY, late, CHANNEL, (f"{STIFFNESS}=0.1 MN/m^1.5", FITS[1]), delay=True).fit
    # the record's noise, 1 %, in a third of its samples
    assert found.values[STIFFNESS] == pytest.approx(0.21, rel=0.01)
    # a third of the samples, and a parameter more that pulls at the same end of the pulse
    assert found.values[DAMPING] == pytest.approx(160.0, rel=0.05)
    assert found.values["delay"] == pytest.approx(2e-4, abs=3 * found.deviations["delay"])


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_a_property_of_a_structure_from_an_acceleration(tmp_path: Path) -> None:
    """The bending stiffness of a beam, on a path of the model; the truth is the study's own."""
    for name in ("pinned_beam.yaml", "pinned_beam_wave.study.yaml"):
        shutil.copy(MODELS / name, tmp_path)
    study, channel = tmp_path / "pinned_beam_wave.study.yaml", "free end.z acceleration"
    case = run_study(read_study(study, only="no damper")).cases["no damper"]
    assert case.response is not None
    rows = np.column_stack((case.response.t, case.channels[channel].values))[::5]
    np.savetxt(tmp_path / "a.csv", rows, delimiter=",")
    found = identify(study, tmp_path / "a.csv", channel, ("structure.EI=5.5 N*m^2",), case="no damper").fit
    # the record has all digits: 6e-14 here
    assert found.values["structure.EI"] == pytest.approx(5.9, rel=1e-11)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"parameters": ()}, "--fit: got no parameter"),
        ({"parameters": (STIFFNESS,)}, f"--fit {STIFFNESS}: got no PATH=START"),
        (
            {"parameters": ("bodies.bal.contact.stiffness=1e5",)},
            "--fit bodies.bal.contact.stiffness=1e5: .* did you mean",
        ),
        ({"parameters": (f"{STIFFNESS}=1 kg",)}, f"--fit {STIFFNESS}=1 kg: .* expected a Hertz stiffness"),
        ({"parameters": ("time.sampling=10 kHz",)}, "data that do not depend on it"),
        ({"channel": "ball force"}, "--channel: got 'ball force', expected a recorded channel; did you mean"),
        ({"measured": Path("none.csv")}, "none.csv: got no file"),
        ({"measured": STUDY}, r"tennis_ball_drop.study.yaml:1:\d+: got"),
        ({"case": "other"}, "--case: got 'other'"),
    ],
)
def test_mistakes_are_told(change: dict[str, object], told: str) -> None:
    given = {"study": STUDY, "measured": RECORD, "channel": CHANNEL, "parameters": FITS} | change
    with pytest.raises(FemstructError, match=told):
        identify(**given)  # type: ignore[arg-type]


def test_records_that_cannot_be_compared_are_refused(tmp_path: Path) -> None:
    early = tmp_path / "early.csv"
    early.write_text("-2, 0\n-1, 0\n", encoding="utf-8")
    with pytest.raises(FemstructError, match="expected times after 0"):
        identify(STUDY, early, CHANNEL, FITS)
    with pytest.raises(FemstructError, match="--delay: got a velocity"):
        identify(STUDY, RECORD, "ball velocity", FITS, delay=True, overrides=("record.ball=velocity",))


def test_a_record_that_begins_late_is_not_to_be_trusted(tmp_path: Path) -> None:
    """Two milliseconds late, and nobody asked for a delay: exit code 3; the picture shows why."""
    t, force = np.loadtxt(RECORD.read_text(encoding="utf-8").splitlines()[1:], delimiter=",").T
    np.savetxt(tmp_path / "late.csv", np.column_stack((1e-3 * t + 2e-3, force)), delimiter=",")
    options = ["--measured", "late.csv", "--channel", CHANNEL, "--fit", FITS[0], "--fit", FITS[1]]
    done = CliRunner().invoke(app, ["identify", str(STUDY), *options, "--picture", "fit.png"])
    assert done.exit_code == 3
    assert "forbids trust, poor-fit" in done.stdout
    assert (tmp_path / "fit.png").stat().st_size > 10_000
    done = CliRunner().invoke(app, ["identify", str(STUDY), *options, "--delay"])
    assert done.exit_code == 0
    for picture in ("fit.txt", "nowhere/fit.png"):
        with pytest.raises(FemstructError):
            CliRunner().invoke(app, ["identify", str(STUDY), *options, "--picture", picture], catch_exceptions=False)


def struck_oscillator(folder: Path, begin: float, end: float) -> Path:
    """A study of a hammer on an oscillator, and beside it the acceleration between two times in a.csv, from t = 0."""
    model = """
        structure: {type: oscillator, mass: 1 kg, stiffness: 100 kN/m}
        points: {m: {}}
        damping: {ratio: 5 %}
    """
    (folder / "oscillator.yaml").write_text(model, encoding="utf-8")
    study = folder / "hit.study.yaml"
    study.write_text(
        """
        model: oscillator.yaml
        bodies: {hammer: {mass: 100 g, above: m, speed: 1 m/s, contact: {type: linear, stiffness: 100 kN/m}}}
        record: {m.z: acceleration}
        time: {duration: 60 ms, sampling: 4 kHz}
        """,
        encoding="utf-8",
    )
    case = run_study(read_study(study)).cases["as given"]
    assert case.response is not None
    kept = (case.response.t > begin - 1e-9) & (case.response.t < end)
    rows = np.column_stack((case.response.t[kept] - begin, case.channels["m.z acceleration"].values[kept]))
    np.savetxt(folder / "a.csv", rows, delimiter=",")
    return study


def test_a_record_that_was_triggered_late_gives_the_truth(tmp_path: Path) -> None:
    """2 ms after the hammer, all digits: the simulation goes on beyond the record by as much as a delay may reach."""
    study = struck_oscillator(tmp_path, 2e-3, 32e-3)
    found = identify(study, tmp_path / "a.csv", "m.z acceleration", ("structure.stiffness=99 kN/m",), delay=True).fit
    assert found.values["structure.stiffness"] == pytest.approx(100.0, rel=1e-9)  # steps end at 1e-9
    assert found.values["delay"] == pytest.approx(-2e-3, rel=1e-9)  # likewise


def ball_on_the_ground() -> Path:
    """A study of 1 kg at 2 m/s on 10 kN/m and a dashpot of 15 N s/m: a pulse of 31 ms that begins with c v = 30 N."""
    Path("none.yaml").write_text("structure: none", encoding="utf-8")
    Path("hit.study.yaml").write_text(
        """
        model: none.yaml
        bodies: {ball: {mass: 1 kg, above: ground, speed: 2 m/s,
                        contact: {type: linear, stiffness: 10 kN/m, damping: 15 N*s/m}}}
        record: {ball on ground: force}
        time: {duration: 40 ms, sampling: 2 kHz}
        """,
        encoding="utf-8",
    )
    return Path("hit.study.yaml")


def test_before_a_simulation_begins_there_is_rest() -> None:
    """A record that begins 2 ms before the dashpot has its force at once."""
    plan = read_study(ball_on_the_ground())
    case = run_study(plan).cases["as given"]
    force = case.channels[CHANNEL].values
    assert force[0] == pytest.approx(30.0, rel=1e-9)  # rounding
    late = np.concatenate((np.zeros(4), force[:60]))
    np.savetxt("late.csv", np.column_stack((np.arange(64) / 2e3, late)), delimiter=",")
    (one,), (delay,) = read_data(MeasuredFiles("late.csv +- 1 N", CHANNEL), plan, delay=True)
    assert one.residuals(Trial({"delay": 2e-3}, None, case)) == pytest.approx(np.zeros(64), abs=1e-9)  # rounding
    assert (delay.low, delay.high) == (pytest.approx(-0.5 * 63 / 2e3), np.inf)


def test_a_record_that_lacks_too_much_of_its_beginning_is_refused() -> None:
    """The second half of a pulse, which is shorter than twice the first one: half of a record is the margin."""
    study = ball_on_the_ground()
    force = run_study(read_study(study)).cases["as given"].channels[CHANNEL].values[30:55]
    np.savetxt("half.csv", np.column_stack((np.arange(25) / 2e3, force)), delimiter=",")
    told = "--delay: got a record that seems to lack the first 6 ms of the simulated history, or more"
    fits = ("bodies.ball.contact.stiffness=10 kN/m:9.9 kN/m:10.1 kN/m",)
    with pytest.raises(FemstructError, match=told):
        identify(study, Path("half.csv"), CHANNEL, fits, delay=True)


def test_terminal_shows_intervals_and_findings() -> None:
    options = ["--measured", str(RECORD), "--channel", CHANNEL, "--fit", f"{STIFFNESS}=1e5", "--set", f"{DAMPING}=100"]
    done = CliRunner().invoke(app, ["identify", str(STUDY), *options])
    assert done.exit_code == 0
    assert "95 % interval" in done.stdout
    table = json.loads(CliRunner().invoke(app, ["identify", str(STUDY), *options, "--json"]).stdout)
    one = table["parameters"][STIFFNESS]
    assert one["low"] < one["value"] < one["high"]
    # five digits are shown, without zeros at their end
    assert f"{one['value']:.5g}  {one['low']:.5g} .. {one['high']:.5g}" in done.stdout
    assert [finding["code"] for finding in table["findings"]] == ["poor-fit", "residuals-not-noise"]  # a wrong damping
    for finding in table["findings"]:
        assert f"limits trust, {finding['code']}: {finding['message']}\n" in done.stdout
