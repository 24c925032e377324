"""Mistakes in what a study optimises: one line each, where it is written."""

from pathlib import Path

import pytest

from femstruct.campaign.forecast import forecast_campaign, forecast_search
from femstruct.campaign.optimise import optimise
from femstruct.errors import InputErrors
from femstruct.language.campaigns import read_campaign, read_search

IN_FILE = {
    "{vary: {a.b: {from: 1, to: 2}}}": "got none of minimise, maximise",
    "{minimise: [f, f], vary: {a.b: {from: 1, to: 2}}}": "optimise.minimise: got 'f' twice, expected each goal once",
    "{minimise: f, maximise: [g, f], vary: {a.b: {from: 1, to: 2}}}": "got 'f' twice",
    "{minimise: [f, g, h], maximise: k, vary: {a.b: {from: 1, to: 2}}}": "got 4 goals, expected one to three",
    "{minimise: [], vary: {a.b: {from: 1, to: 2}}}": "got none of minimise, maximise",
    "{minimise: [f, 3], vary: {a.b: {from: 1, to: 2}}}": "optimise.minimise[1]: got 3, expected",
    "{minimise: {f: 1}, vary: {a.b: {from: 1, to: 2}}}": "got a mapping {f: 1}, expected the name of a number, or",
    "{minimise: f}": "optimise.vary: got nothing to choose",
    "{minimise: f, vary: {a.b: {normal: {mean: 1, sd: 1}}}}": "optimise.vary.a.b: got a distribution, expected a range",
    "{minimise: f, vary: {a.b: {from: 2, to: 1}}}": "optimise.vary.a.b: got 2 to 1, expected rising bounds",
    "{minimise: f, vary: {a.b: {from: 1, to: 2}}, limits: {g: 3 mmm}}": "optimise.limits.g: got '3 mmm' with",
    "{minimise: f, vary: {a.b: {from: 1, to: 2}}, runs: 5}": "optimise.runs: got 5 runs, expected 20 or more",
    "{minimise: f, vary: {a.b: {from: 1, to: 2}}, robust: {over: [c.e]}}": "got 'c.e', expected a path under 'vary:'",
    "{minimise: f, vary: {a.b: {from: 1, to: 2}}, robust: {over: [c.d], quantile: 120 %}}": "below 1",
    "{minimize: f, vary: {a.b: {from: 1, to: 2}}}": "did you mean 'minimise'?",
}


@pytest.mark.parametrize("value", IN_FILE)
def test_mistakes_of_a_file(value: str, tmp_path: Path) -> None:
    path = tmp_path / "a.study.yaml"
    text = f"model: m.yaml\nvary: {{c.d: {{uniform: [1, 2]}}}}\noptimise: {value}\n"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputErrors) as caught:
        read_search(path)
    assert len(caught.value.errors) == 1 and IN_FILE[value] in caught.value.errors[0], caught.value.errors
    assert caught.value.errors[0].startswith(f"{path}:3:")


def test_mistakes_of_the_command_line(tmp_path: Path) -> None:
    path = tmp_path / "a.study.yaml"
    path.write_text("model: m.yaml\n", encoding="utf-8")
    with pytest.raises(InputErrors, match=r"got a study that optimises nothing, .* add 'optimise: "):
        read_search(path)
    with pytest.raises(InputErrors, match="--limit g: got no NAME=VALUE"):
        read_search(path, "minimise f", ["a.b=1:2"], ["g"])
    with pytest.raises(InputErrors, match=r"--vary a\.b=1:2:3:log: .*got '3', expected one of linear, log"):
        read_search(path, "minimise f", ["a.b=1:2:3:log"])
    found = read_search(path, "maximise f", ["a.b=1 kg:2 kg:log", "c=1,2"], ["g=3 mm"])
    assert [getattr(one, "law", "list") for one in found.designs] == ["log-uniform", "list"]
    assert found.sense == "maximise" and dict(found.limits) == {"g": 0.003}
    several = read_search(path, ["minimise f", "maximise g"], ["a.b=1:2"])
    assert [(one.name, one.sense) for one in several.goals] == [("f", "minimise"), ("g", "maximise")]


STUDY = """
model: model.yaml
bodies: {ball: {mass: 1 kg, above: m, speed: 1 m/s, contact: {type: linear, stiffness: 1 MN/m}}}
record: {m.z: velocity}
time: {duration: 10 ms, sampling: 10 kHz}
cases: {bare: {}, damped: {add: {bodies.damper: {mass: 1 kg, below: m}}}}
"""
BEFORE = {
    "{case: damped, minimise: m.z velocity, vary: {bodies.damper.mass: {from: 1 mm, to: 2 mm}}}": (
        "vary bodies.damper.mass, value 0.001 m: bodies.damper.mass: got '0.001 m', which is a length, expected a mass"
    ),
    "{minimise: m.z velocity, vary: {bodies.damper.mass: {from: 1 kg, to: 2 kg}}}": (
        "got a path that case 'damped' adds, expected a path of case 'bare', which is run; choose the case"
    ),
    "{minimise: m.z velocity, vary: {bodies.ball.above: {values: [m, n]}}}": "vary bodies.ball.above, value n: ",
    "{minimise: m.z velocity, vary: {bodies.ball.mass: {from: 0 kg, to: -1 kg}}}": "got 0 to -1 kg, expected rising",
    "{minimise: m.z velocty, vary: {bodies.ball.mass: {from: 1 kg, to: 2 kg}}}": "did you mean 'm.z velocity'?",
    "{minimise: m.z velocity, vary: {bodies.dampr.mass: {from: 1 kg, to: 2 kg}}}": "did you mean 'damper'?",
}


@pytest.mark.parametrize("value", BEFORE)
def test_what_cannot_be_is_refused_before_anything_is_run(value: str, tmp_path: Path) -> None:
    (tmp_path / "model.yaml").write_text(
        "structure: {type: oscillator, mass: 1 kg, stiffness: 100 N/m}\npoints: {m: {}}\n", encoding="utf-8"
    )
    path = tmp_path / "a.study.yaml"
    path.write_text(f"{STUDY}optimise: {value}\n", encoding="utf-8")
    for ask in (lambda: optimise(read_search(path), workers=1), lambda: forecast_search(read_search(path))):
        with pytest.raises(InputErrors) as caught:
            ask()
        assert len(caught.value.errors) == 1 and BEFORE[value] in caught.value.errors[0], caught.value.errors
        assert caught.value.errors[0].startswith(f"{path}:7:")


def test_a_range_of_which_one_end_cannot_be_is_tried(tmp_path: Path) -> None:
    """Designs there fail, with their reason; those that can be are compared."""
    (tmp_path / "model.yaml").write_text(
        "structure: {type: oscillator, mass: 1 kg, stiffness: 100 N/m}\npoints: {m: {}}\n", encoding="utf-8"
    )
    path = tmp_path / "a.study.yaml"
    path.write_text(STUDY, encoding="utf-8")
    search = read_search(path, "maximise m.z velocity", ["bodies.ball.mass=-1 kg:1 kg"], runs=40)
    told = forecast_search(search, workers=1)
    assert "got '-1.0 kg', expected a positive value" in str(told["refused: bodies.ball.mass, lower end of its range"])
    assert told["may be chosen: bodies.ball.mass"] == "-1 kg .. 1 kg" and "m.z velocity" in str(told["main numbers"])
    found = optimise(search, workers=1)
    assert found.left_out and found.chosen[0].number == pytest.approx(1.0, abs=0.1)  # the end of the range, 40 designs


def test_a_plan_states_goals_that_have_no_number(tmp_path: Path) -> None:
    (tmp_path / "model.yaml").write_text(
        "structure: {type: oscillator, mass: 1 kg, stiffness: 100 N/m}\npoints: {m: {}}\n", encoding="utf-8"
    )
    path = tmp_path / "a.study.yaml"
    path.write_text(f"{STUDY}limits: {{settled: 1 s}}\n", encoding="utf-8")
    why = "settled (not at rest when the window, or the time between blows, ends)"
    for goal, lacking in (("settled", why), ("m.z velocity", why)):  # a limit of the study, too
        told = forecast_search(read_search(path, f"minimise {goal}", ["bodies.ball.mass=1 kg:2 kg"]), workers=1)
        assert told["not known in the design that was run"] == lacking
    told = forecast_campaign(read_campaign(path, ["bodies.ball.mass=1 kg,2 kg"]), workers=1)
    assert told["not known in the first sample"] == why


def test_a_sweep_of_a_case_refuses_paths_of_others(tmp_path: Path) -> None:
    path = tmp_path / "a.study.yaml"
    path.write_text(STUDY, encoding="utf-8")
    with pytest.raises(InputErrors, match="got a path that case 'damped' adds, expected a path of case 'bare'"):
        read_campaign(path, ["bodies.damper.mass=1 kg,2 kg"], case="bare")
    assert read_campaign(path, ["bodies.damper.mass=1 kg,2 kg"], case="damped").case == "damped"
