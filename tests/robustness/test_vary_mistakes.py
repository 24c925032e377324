"""Mistakes in what a study varies: one line each, where it is written."""

from pathlib import Path

import pytest

from femstruct.campaign.forecast import forecast_campaign
from femstruct.campaign.optimise import optimise
from femstruct.campaign.sweep import sweep
from femstruct.errors import InputErrors
from femstruct.language.campaigns import read_campaign, read_search
from femstruct.language.cases import read_study
from femstruct.study.campaigns import Listed
from femstruct.view.campaign_answers import swept_pieces

IN_FILE = {
    "{from: 1 kg, to: 2 kg, step: 3}": "vary.a.b.step: got the unknown key 'step'",
    "{from: 1 kg, to: 2 m, steps: 3}": "3:8: vary.a.b: got a length and a mass, expected numbers of one dimension",
    "{from: 0 kg, to: 2 kg, steps: 3, scale: log}": "3:8: vary.a.b: got 0 on a logarithmic scale",
    "{from: 1 kg}": "got from without to",
    "{values: []}": "3:17: vary.a.b.values: got an empty list, expected a list of values",
    "{values: [1], uniform: [1, 2]}": "got both values and uniform",
    "{uniform: [2, 1]}": "3:8: vary.a.b: got 2 to 1, expected rising bounds",
    "{uniform: 3 kg}": "expected two numbers [from, to]",
    "{normal: {mean: 30 GPa, sd: -5 %}}": "got a deviation of -1.5e+09, expected a positive one",
    "{normal: {mean: 30 GPa}}": "vary.a.b.normal.sd: got nothing, expected 'sd'",
    "{from: 1,5 kg, to: 2 kg}": "a comma begins the next item",
    "{normal: {mean: 2 %, sd: 20 %}}": "a mean and a deviation in percent, 2 % and 20 %, expected a deviation as a "
    "plain number; write 'sd: 0.004' for 20 % of the mean, or 'sd: 0.2' for a deviation of 20 %",
    "{values: [1, 5 t, 2 t]}": "got 1 without a unit beside a mass, expected a unit with every value, or with none",
    "{from: 1, to: 2 t}": "3:8: vary.a.b: got 1 without a unit beside a mass",
    "{normal: {mean: 2 t, sd: 0.1}}": "got 0.1 without a unit beside a mass",
    "{}": "got none of from, values, normal, uniform",
    "3 kg": "3:8: vary.a.b: got '3 kg', expected a mapping",
    "{uniform: [1, 2]}": "3:3: vary.a.b: got a range without steps, expected steps, values or samples",
}


@pytest.mark.parametrize("value", IN_FILE)
def test_mistakes_of_a_file(value: str, tmp_path: Path) -> None:
    path = tmp_path / "a.study.yaml"
    path.write_text(f"model: m.yaml\nvary:\n  a.b: {value}\n", encoding="utf-8")
    with pytest.raises(InputErrors) as caught:
        read_campaign(path)
    assert len(caught.value.errors) == 1 and IN_FILE[value] in caught.value.errors[0], caught.value.errors


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("a.b", "--vary a.b: got no range and no list, expected PATH=FROM:TO:STEPS"),
        ("a.b=1:2:3:4:5", "got no range and no list"),
        ("a.b=1:2:x", "vary.a.b.steps: got 'x', expected a whole number from 1 to 100000"),
        ("a.b=1:2:3:lin", "did you mean 'linear'?"),
        (
            "a.b=1,5 t,2 t",
            "got 1 without a unit beside a mass, expected a unit with every value, or with none; values are "
            "separated by commas, decimals by a point, as 1.5 kg; write 1 with its unit",
        ),
        ("a.b=1,5:3:4", "got no range and no list"),
        ("a.b=1,5 t:3 t:4", "got no range and no list"),
        ("a.b=normal(3 kg)", "vary.a.b.normal.sd: got nothing, expected 'sd'"),
        ("a.b=uniform(1 kg, 2 m)", "vary.a.b: got a length and a mass"),
        ("a.b=1 kgg:2:3", "got '1 kgg' with an unknown unit 'kgg', expected a number with its unit"),
    ],
)
def test_mistakes_of_the_command_line(text: str, told: str, tmp_path: Path) -> None:
    path = tmp_path / "a.study.yaml"
    path.write_text("model: m.yaml\n", encoding="utf-8")
    with pytest.raises(InputErrors) as caught:
        read_campaign(path, [text])
    assert len(caught.value.errors) == 1 and told in caught.value.errors[0], caught.value.errors


def test_a_study_is_read_with_what_it_varies(tmp_path: Path) -> None:
    """So `check` and `run` tell, too, not only a sweep."""
    model = "structure: {type: oscillator, mass: 1 kg, stiffness: 100 N/m}\npoints: {m: {}}\n"
    (tmp_path / "m.yaml").write_text(model, encoding="utf-8")
    study = """model: m.yaml
bodies: {ball: {mass: 1 kg, above: m, speed: 1 m/s, contact: {type: linear, stiffness: 1 MN/m}}}
time: {duration: 10 ms, sampling: 10 kHz}
cases: {one: {}, two: {add: {bodies.other: {mass: 1 kg, above: ground}}}}
vary:
  bodies.other.mass: {from: 1 kg, to: 2 kg}
  bodies.bal.mass: {from: 1 kg, to: 2 kg}
optimise:
  minimise: ball on m peak force
  vary: {bodies.bll.mass: {from: 1 kg, to: 2 kg}}
  robust: {over: [bodies.ball.mass]}
"""
    (tmp_path / "a.study.yaml").write_text(study, encoding="utf-8")
    with pytest.raises(InputErrors) as caught:
        read_study(tmp_path / "a.study.yaml")
    told = caught.value.errors
    assert len(told) == 3, told
    assert ":7:3: " in told[0] and "the path 'bodies.bal.mass', which does not exist" in told[0]
    assert ":10:10: " in told[1] and "did you mean 'ball'" in told[1]
    assert ":11:18: " in told[2] and "expected a path under 'vary:'" in told[2]
    indices = "model: m.yaml\nvary: {structure.mass: {uniform: [1, 2]}}\nsamples: {method: sobol indices, count: 100}\n"
    (tmp_path / "b.study.yaml").write_text(indices, encoding="utf-8")
    with pytest.raises(InputErrors, match=r"b\.study\.yaml:3:34: .*write 64 or 128"):
        read_campaign(tmp_path / "b.study.yaml")


def test_a_study_that_varies_nothing_is_told_what_to_add(tmp_path: Path) -> None:
    path = tmp_path / "a.study.yaml"
    path.write_text("model: m.yaml\nsamples: {method: sobl, count: 4}\n", encoding="utf-8")
    with pytest.raises(InputErrors, match=r"2:19: samples\.method: got 'sobl'.*did you mean 'sobol'"):
        read_campaign(path, ["a.b=1:2:3"])
    path.write_text("model: m.yaml\n", encoding="utf-8")
    with pytest.raises(InputErrors, match=r"got a study that varies nothing, .* add 'vary: "):
        read_campaign(path)


@pytest.mark.parametrize(
    ("text", "texts"),
    [
        ("a.at=[1, 2],[3, 4]", ("[1, 2]", "[3, 4]")),
        ("a.at=[[1, 1], [2, 2]],[[1, 3], [2, 4]]", ("[[1, 1], [2, 2]]", "[[1, 3], [2, 4]]")),
        ("a.law={type: hertz, stiffness: 1e8},{type: linear, stiffness: 1 MN/m}",
         ("{type: hertz, stiffness: 100000000.0}", "{type: linear, stiffness: 1 MN/m}")),
        ("a.mass=0,50 g,1 kg", ("0", "50 g", "1 kg")),
        ("a.ratio=0.02,3 %", ("0.02", "3 %")),
        ("a.material=steel,concrete", ("steel", "concrete")),
    ],
)  # fmt: skip
def test_lists_of_the_command_line(text: str, texts: tuple[str, ...], tmp_path: Path) -> None:
    path = tmp_path / "a.study.yaml"
    path.write_text("model: m.yaml\n", encoding="utf-8")
    assert read_campaign(path, [text]).varied[0] == Listed(*_parts(text, texts))


def _parts(text: str, texts: tuple[str, ...]) -> tuple[object, ...]:
    numbers = {"a.mass": ((0.0, 0.05, 1.0), "kg"), "a.ratio": ((0.02, 0.03), "1")}
    path = text.partition("=")[0]
    return (path, texts, *numbers.get(path, ()))


def test_a_key_with_a_capital_is_named(tmp_path: Path) -> None:
    path = tmp_path / "a.study.yaml"
    path.write_text("model: m.yaml\nVary: {a.b: {values: [1]}}\n", encoding="utf-8")
    with pytest.raises(InputErrors, match=r"got a study that varies nothing, .*; write 'vary' for 'Vary'"):
        read_campaign(path)


OVERRULED = """
model: m.yaml
vary: {bodies.ram.mass: {values: [1 kg, 2 kg]}}
optimise: {minimise: ram on ground peak force, vary: {bodies.ram.mass: {from: 1 kg, to: 2 kg}}, runs: 20}
bodies: {ram: {mass: 3 kg, above: ground, speed: 1 m/s, contact: {type: linear, stiffness: 1 MN/m}}}
time: {duration: 20 ms, sampling: 10 kHz}
cases: {as built: {}, heavy: {bodies.ram.mass: 8 kg}}
"""


def overruled(folder: Path) -> Path:
    (folder / "m.yaml").write_text("structure: none\n", encoding="utf-8")
    (folder / "a.study.yaml").write_text(OVERRULED, encoding="utf-8")
    return folder / "a.study.yaml"


def test_a_case_that_sets_what_varies_is_named(tmp_path: Path) -> None:
    """Its rows are all the same: v sqrt(k m) of 8 kg."""
    rows = sweep(read_campaign(overruled(tmp_path)), tmp_path / "swept")
    force = rows.of("ram on ground peak force", "heavy")
    assert force == pytest.approx([(1e6 * 8.0) ** 0.5] * 2, rel=1e-9)  # rounding
    told = (
        "bodies.ram.mass does not vary in 'heavy', which sets this itself: vary 'cases.heavy.bodies.ram.mass' for that"
    )
    assert told in list(swept_pieces(rows))
    assert (
        forecast_campaign(read_campaign(tmp_path / "a.study.yaml"))["set by case 'heavy' itself"] == "bodies.ram.mass"
    )
    there = ("cases.heavy.bodies.ram.mass=1 kg,2 kg",)
    rows = sweep(read_campaign(tmp_path / "a.study.yaml", there), tmp_path / "there")
    varied = rows.of("ram on ground peak force", "heavy")
    assert sorted(set(varied.round(6))) == pytest.approx([1e3, 2e6**0.5], rel=1e-6)  # what rounding left


def test_a_case_alone_that_sets_what_varies_is_refused(tmp_path: Path) -> None:
    told = r":3:8: vary bodies.ram.mass: got a path that case 'heavy' sets itself.*vary 'cases.heavy.bodies.ram.mass'"
    with pytest.raises(InputErrors, match=told):
        read_campaign(overruled(tmp_path), case="heavy")
    with pytest.raises(InputErrors, match="got a path that case 'heavy' sets itself"):
        optimise(read_search(tmp_path / "a.study.yaml", case="heavy"), tmp_path / "found")
