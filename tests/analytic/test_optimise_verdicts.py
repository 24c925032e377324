"""What an optimisation answers where there is no best design, and which limits and goals it takes."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from femstruct.campaign.designs import campaigns_of
from femstruct.campaign.front_search import pareto_front
from femstruct.campaign.optimise import optimise, set_aside
from femstruct.campaign.rows import write_optimum
from femstruct.cli import app
from femstruct.exits import NOT_TRUSTED
from femstruct.files.campaign_tables import optimum_table
from femstruct.language.campaigns import read_search
from femstruct.language.cases import read_study
from femstruct.study.optima import Found, Front
from femstruct.view.campaign_figures import optimum_figure
from femstruct.view.campaign_page import answer_pieces
from femstruct.workflow.run import run_study

MODEL = "structure: {type: oscillator, mass: 1 kg, stiffness: 100 N/m}\npoints: {m: {}}\n"
HIT = """
title: A hit
model: model.yaml
bodies: {ball: {mass: 1 kg, above: m, speed: 1 m/s, contact: {type: linear, stiffness: 1 MN/m}}}
record: {m.z: velocity}
time: {duration: 10 ms, sampling: 10 kHz}
limits: {m.z velocity: 0.5 m/s, settled: 20 ms}
"""
MASS = ["bodies.ball.mass=0.1 kg:2 kg"]
FORCE = "ball on m peak force"


@pytest.fixture
def study(tmp_path: Path) -> Path:
    (tmp_path / "model.yaml").write_text(MODEL, encoding="utf-8")
    path = tmp_path / "hit.study.yaml"
    path.write_text(HIT.replace(", settled: 20 ms", ""), encoding="utf-8")
    return path


def lines(found: Found | Front) -> list[str]:
    return [one for one in answer_pieces(found) if isinstance(one, str)]


def test_the_limits_of_the_study_hold_and_its_own_come_first(study: Path) -> None:
    """2 m / (2 kg + 2 m) of 1 m/s is 0.5 m/s for a third of a kilogram."""
    search = read_search(study, "maximise m.z velocity", MASS, runs=60)
    found = optimise(search, study.parent / "out", workers=1)
    assert found.search.of_study == ("m.z velocity",) and found.feasible
    # the structure's own spring takes off (w t)^2 / 2 over 3 ms of contact: 5e-4; peaks between samples 1e-4
    assert found.goal == pytest.approx(0.5, rel=2e-3) and found.chosen[0].number == pytest.approx(1.0 / 3.0, rel=5e-3)
    assert optimum_table(found)["limits"][0]["of_study"] is True
    assert set_aside(search, study.parent / "out") is None
    own = optimise(read_search(study, "maximise m.z velocity", MASS, ["m.z velocity=0.8 m/s"], runs=60), workers=1)
    assert own.search.of_study == () and own.goal == pytest.approx(0.8, rel=2e-3)  # as above
    text = study.read_text(encoding="utf-8")
    asked = "optimise: {maximise: m.z velocity, vary: {bodies.ball.mass: {from: 0.1 kg, to: 2 kg}}}\n"
    study.write_text(text + asked, encoding="utf-8")
    assert "within the limits of m.z velocity (of the study);" in campaigns_of(study)["femstruct optimise"]


TWO_PLACES = """
model: plate.yaml
modes: {up_to: 400 Hz}
bodies: {ball: {source: rubber ball, above: spots}}
record: {middle.z: velocity, ball on spots: force}
time: {duration: 0.1 s, sampling: 10 kHz}
"""
PLATE = """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
parts: {p: {type: plate, material: steel, thickness: 20 mm, origin: [0, 0, 0], size: [2, 1.5], mesh: [8, 6]}}
supports: {s: {on: p, edge: all, fix: simple}}
points: {spots: {on: p, at: [[1, 0.7], [0.5, 0.4]]}, middle: {on: p, at: center}}
damping: {ratio: 3 %}
"""


def test_of_several_places_the_worst_holds_a_limit_as_in_a_run(tmp_path: Path) -> None:
    """The plate yields less at its second place, where the ball hits harder; the limit lies between both forces."""
    (tmp_path / "plate.yaml").write_text(PLATE, encoding="utf-8")
    path = tmp_path / "drops.study.yaml"
    path.write_text(f"{TWO_PLACES}limits: {{ball on spots force: 9 kN}}\n", encoding="utf-8")
    case = run_study(read_study(path)).cases["as given"]
    first, second = (one.peak_force[f"ball on {place}"] for place, one in case.drops.items())
    assert second > 1.001 * first
    between = 0.5 * (first + second)
    path.write_text(f"{TWO_PLACES}limits: {{ball on spots force: {between} N}}\n", encoding="utf-8")
    found = optimise(read_search(path, "minimise middle.z velocity", ["damping.ratio=2.9 %:3.1 %"], runs=20), workers=1)
    assert not found.feasible and found.limits["ball on spots.1 force"] > between


def test_without_a_design_that_holds_all_limits_this_is_said_first(study: Path) -> None:
    """The lightest ball gives 2 x 0.1 / 1.1 = 0.1818 m/s, 171.8 mm/s above the limit."""
    found = optimise(read_search(study, f"maximise {FORCE}", MASS, ["m.z velocity=0.01 m/s"], runs=40), workers=1)
    first = lines(found)[0]
    assert first.startswith("No design holds all limits: the nearest exceeds 'm.z velocity' by 171.")
    assert not any("largest" in one or "improvement" in one for one in lines(found))
    labels = [line.get_label() for line in optimum_figure(found).axes[0].lines]
    assert "exceeds limits least" in labels and "best" not in labels
    assert optimum_table(found)["limits"][0]["met"] is False
    words = ["optimise", str(study), "--maximise", FORCE, "--vary", MASS[0], "--limit", "m.z velocity=0.01 m/s"]
    run = CliRunner().invoke(app, [*words, "--runs", "20", "--workers", "1", "-o", str(study.parent / "o")])
    assert run.exit_code == NOT_TRUSTED and run.output.startswith("No design holds all limits")


def test_a_goal_without_a_number_has_no_best_design(study: Path) -> None:
    """Without damping the structure never comes to rest: as a goal no number, as a limit one that is exceeded."""
    study.write_text(HIT, encoding="utf-8")
    found = optimise(read_search(study, "minimise settled", MASS, ["settled=20 ms"], runs=20), workers=1)
    told = lines(found)
    assert told[0].startswith("No design has all numbers that are asked for. 'settled' has no number in ")
    count = found.designs
    assert f"in {count} of {count} designs" in told[0] and "the structure does not come to rest" in told[0]
    assert not any("least" in one or "between" in one or "To run it" in one for one in told)
    assert write_optimum(found, study.parent / "o")  # the pictures, too, are without a best design
    limited = optimise(read_search(study, f"minimise {FORCE}", MASS, runs=20), workers=1)
    assert not limited.feasible and limited.left_out == 0 and np.isnan(limited.limits["settled"])
    assert "'settled' is not shown: the structure is not at rest when the window" in lines(limited)[0]


def test_a_goal_that_does_not_depend_on_what_may_be_chosen_is_said_first(study: Path) -> None:
    found = optimise(read_search(study, "minimise total mass", MASS, runs=20), workers=1)
    assert lines(found)[0].startswith("'total mass' is the same for all designs that were tried: it does not depend")
    front = pareto_front(read_search(study, ["minimise total mass", f"minimise {FORCE}"], MASS, runs=24), workers=1)
    told = lines(front)
    assert "The path 'bodies.ball.mass' can be a goal" in told[0]
    assert not any("best in all goals" in one for one in told)


def test_a_path_that_may_be_chosen_can_be_a_goal(study: Path, tmp_path: Path) -> None:
    """The heaviest ball that holds 0.5 m/s is a third of a kilogram."""
    found = optimise(read_search(study, "maximise bodies.ball.mass", MASS, runs=60), workers=1)
    assert found.unit == "kg" and found.goal == found.chosen[0].number == pytest.approx(1.0 / 3.0, rel=5e-3)  # as above
    assert all("is chosen" in one.why for one in found.references)
    assert write_optimum(found, tmp_path / "one")
    search = read_search(study, ["minimise bodies.ball.mass", "maximise m.z velocity"], MASS, runs=30)
    front = pareto_front(search, workers=1)
    assert len(front.members) == int(front.held.sum()) > 3 and front.units == ("kg", "m/s")
    np.testing.assert_array_equal(front.goals[:, 0], front.rows.values[:, 0])
    assert write_optimum(front, tmp_path / "several")


def test_an_interrupted_answer_says_only_that_and_first(study: Path) -> None:
    def stop(line: str) -> None:
        if line.startswith("30 of"):
            raise KeyboardInterrupt

    for goals in ("maximise m.z velocity", ["maximise m.z velocity", f"minimise {FORCE}"]):
        search = read_search(study, goals, MASS, runs=60)
        found = (pareto_front if search.also else optimise)(search, workers=1, progress=stop)
        told = lines(found)
        assert told[0] == "Interrupted: the same command goes on"
        assert not any("it ended" in one or "; interrupted" in one for one in told)


def test_what_is_nearly_as_good_holds_all_limits(study: Path) -> None:
    found = optimise(read_search(study, "maximise m.z velocity", MASS, runs=30), workers=1)
    k = int(np.flatnonzero(~found.held)[0])
    goals = np.where(np.arange(found.designs) == k, found.goal, found.goals)
    assert not replace(found, goals=goals).nearly[k]
    assert replace(found, goals=goals, held=found.held | True).nearly[k]


def test_references_of_a_large_goal_take_the_quantile_that_is_held(study: Path) -> None:
    """90 % of what scatters has no less: the quantile of 10 %."""
    text = HIT.replace("limits: {m.z velocity: 0.5 m/s, settled: 20 ms}\n", "")
    more = "robust: {over: [bodies.ball.speed], quantile: 90 %, samples: 5}, runs: 100"
    text += "vary: {bodies.ball.speed: {uniform: [0.8 m/s, 1.2 m/s]}}\n"
    text += f"optimise: {{maximise: m.z velocity, vary: {{bodies.ball.mass: {{from: 0.1 kg, to: 2 kg}}}}, {more}}}\n"
    study.write_text(text, encoding="utf-8")
    found = optimise(read_search(study), workers=1)
    speeds = found.rows.values[:5, 1]
    # the structure's own spring takes off (w t)^2 / 2 over 3 ms of contact: 5e-4; peaks between samples 1e-4
    assert found.references[0].goal == pytest.approx(float(np.quantile(speeds, 0.1)), rel=2e-3)
    speed = optimum_figure(found).axes[-1]
    assert all(line.get_linestyle() != "None" for line in speed.lines)  # one path scatters: its samples are joined
