"""Mistakes in what a study optimises: one line each, where it is written."""

from pathlib import Path

import pytest

from femstruct.errors import InputErrors
from femstruct.language.searches import read_search

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
