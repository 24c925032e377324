"""What the march leaves wrong, from YAML to findings, terminal, tables and the results file; chaos is told."""

from __future__ import annotations

import json
from pathlib import Path

import h5py
import pytest

from femstruct import cli
from femstruct.exits import GOOD, NOT_TRUSTED, leave_with
from femstruct.files.results_file import read_results, write_results
from femstruct.files.study_tables import summary
from femstruct.impact.numerical_error import ErrorEstimate, Resolved, error_of, unresolved_findings
from femstruct.impact.scene import GROUND, Body, Clock, Contact, Scene
from femstruct.impact.simulate import simulate
from femstruct.language.cases import read_study
from femstruct.laws.hertz import Hertz
from femstruct.modal.closed_form import given_modes
from femstruct.study.results import StudyResult
from femstruct.view.page import report
from femstruct.view.terminal import show_study
from femstruct.workflow.run import run_study

MODEL = "structure: {type: modes, frequency: [40, 310], ratio: [0, 0], points: {p: [1.5, 1.1]}}"
STUDY = """
model: m.yaml
bodies: {b: {mass: 1 kg, above: p, speed: 1 m/s}}
contacts: {rattle: {between: [b, p], law: {type: stop, stiffness: 1e7}, gap: 2 mm}}
record: {p.z: velocity}
time: {duration: 0.3 s, sampling: 20 kHz}
cases:
  long: {}
  short: {time.duration: 10 ms}
  hertz: {time.duration: 10 ms, contacts.rattle.law: {type: hertz, stiffness: 1e8}, contacts.rattle.gap: 0}
compare: {baseline: long}
"""


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("rattle")
    (folder / "m.yaml").write_text(MODEL, encoding="utf-8")
    (folder / "rattle.study.yaml").write_text(STUDY, encoding="utf-8")
    return folder / "rattle.study.yaml"


@pytest.fixture(scope="module")
def result(study: Path) -> StudyResult:
    return run_study(read_study(study))


def test_a_rattling_body_is_not_to_be_trusted_but_its_first_hit_is(result: StudyResult) -> None:
    """Some twenty undamped collisions make of rounding what they like: the peak of the window is anybody's guess."""
    errors = result.cases["long"].errors
    assert errors is not None and errors.exact
    whole, first = errors.peak["rattle"], errors.first_peak["rattle"]
    assert whole.relative > 1e-2
    assert first.relative < 1e-11  # rounding of one hit
    assert errors.first_until < 0.02
    (found,) = [one for one in result.cases["long"].findings if one.code == "contact-unresolved"]
    assert found.severe
    assert found.values["peak_force_n"] == whole.value
    assert found.values["error_n"] == whole.error
    assert f"{whole.value:.4g} N may be wrong by {whole.error:.3g} N" in found.message
    assert f"rattle {first.value:.4g} N). Use these" in found.message
    (end,) = [one for one in result.cases["long"].findings if one.code == "end-unresolved"]
    assert not end.severe
    assert end.values["error_m_s"] == errors.velocity["b"].error


def test_what_is_resolved_has_no_finding(result: StudyResult) -> None:
    for name in ("short", "hertz"):
        case = result.cases[name]
        assert case.errors is not None
        assert case.errors.exact == (name == "short")
        assert case.errors.peak["rattle"].relative < 2e-10  # of few hits, and of the steps: 2e-12 here
        assert not {"contact-unresolved", "end-unresolved"} & {one.code for one in case.findings}


def test_terminal_tables_and_file_say_the_same(
    result: StudyResult, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    show_study(result, {})
    printed = capsys.readouterr().out
    assert "short: estimated error, rounding only: peak forces" in printed
    assert "against a run at a tolerance of 1e-10" in printed
    assert "forbids trust, contact-unresolved" in printed
    page = report(result)
    assert page.count("estimated error") == printed.count("estimated error") == 3
    assert "error estimate " in printed.partition("CPU seconds: ")[2]  # a stage of its own
    write_results(tmp_path / "results.h5", result)
    tables = summary(result)["cases"]
    assert summary(read_results(tmp_path / "results.h5"))["cases"] == tables
    for name, case in result.cases.items():
        told, errors = tables[name]["error_estimate"], case.errors
        assert errors is not None
        peak, speed = errors.peak["rattle"], errors.velocity["b"]
        assert told["peak_force"]["rattle"] == {
            "value": peak.value,
            "error": peak.error,
            "relative": peak.error / peak.scale,
            "scale": peak.scale,
            "unit": "N",
        }
        assert told["end_velocity"]["b"]["error"] == speed.error
        assert told["end_velocity"]["b"]["unit"] == "m/s"
        assert told["against"] == (1e-10 if name == "hertz" else None)
        with h5py.File(tmp_path / "results.h5") as file:
            kept = file[f"cases/{name}/error_estimate"]
            assert kept.attrs["first_until"] == told["first_until_s"]
            assert kept["peak_force/error"][0] == peak.error
            assert kept["first_peak_force/value"][0] == errors.first_peak["rattle"].value
            assert kept["end_velocity/error"].attrs["unit"] == "m/s"


def test_exit_code(study: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """3 for the long window, 0 for the short one."""
    for case, code in (("long", NOT_TRUSTED), ("short", GOOD)):
        words = ["impact", str(study), "--case", case, "--json"]
        assert leave_with(lambda words=words: cli.app(words)) == code
        assert json.loads(capsys.readouterr().out)["cases"][case]["error_estimate"]["from"] == "rounding"


def test_a_coarse_tolerance_is_told() -> None:
    """A ball caught between a wall and a vibrating mass, 1e-4 a step: the finding's error is that of a strict run."""
    basis, points = given_modes([40.0, 310.0], [0.0, 0.0], {"p": [1.5, 1.1]})
    scene = Scene(
        (Body("b", 0.3, -1.0),),
        (
            Contact("floor", "b", points["p"].probe("z"), Hertz(1e8)),
            Contact("wall", GROUND, "b", Hertz(1e8), gap=2e-3),
        ),
    )
    coarse, strict = (simulate(basis, scene, Clock(0.2, 2e4, tolerance=tolerance)) for tolerance in (1e-4, 1e-12))
    (found,) = [one for one in unresolved_findings(error_of(coarse)) if one.code == "contact-unresolved"]
    missed = abs(coarse.contacts["floor"].peak_force - strict.contacts["floor"].peak_force)
    assert missed > 1e-3 * strict.contacts["floor"].peak_force
    assert not found.severe
    assert found.message.startswith("Contact 'floor'")
    assert found.values["error_n"] == pytest.approx(missed, rel=0.01)  # what 1e-10 and 1e-12 differ by
    assert not unresolved_findings(error_of(strict))


def test_severity_accuracy_and_what_to_do() -> None:
    """Thresholds, the share an asked accuracy leaves to the march, and the advice where the first peak is wrong too."""

    def judged(relative: float, within: float | None = None, tolerance: float | None = 1e-4) -> list[tuple[str, bool]]:
        peak = {"c": Resolved(100.0, 100.0 * relative, 100.0)}
        errors = ErrorEstimate(tolerance, tolerance, 1.0, peak, peak, {})
        return [
            (one.message.partition(" % is allowed. ")[2], one.severe) for one in unresolved_findings(errors, within)
        ]

    assert judged(0.9e-3) == []
    assert judged(1.1e-3) == [("The time steps do not resolve it: use a smaller tolerance than 0.0001", False)]
    assert judged(1.1e-2)[0][1]
    assert judged(float("inf"))[0][1]
    assert judged(2e-4, within=1e-3) and not judged(2e-4, within=1e-2)
    assert judged(1.1e-3, tolerance=None)[0][0] == "The contact is so light that rounding determines its force"
