"""Contact laws as a study file says them: what each becomes, and one line for each contradiction."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import sqrt
from pathlib import Path
from typing import get_args

import numpy as np
import pytest

from femstruct.errors import InputError, InputErrors
from femstruct.language.bodies import LAW_KINDS
from femstruct.language.cases import json_schema, read_study
from femstruct.laws.cubic import Cubic
from femstruct.laws.hertz import Hertz
from femstruct.laws.hunt_crossley import HuntCrossley
from femstruct.laws.lankarani_nikravesh import LankaraniNikravesh
from femstruct.laws.law import Law
from femstruct.laws.linear import Linear
from femstruct.laws.stop import Stop
from femstruct.laws.tabulated import Tabulated
from femstruct.workflow.run import run_study

SHIPPED = Path(__file__).parents[2] / "models" / "contact_laws.study.yaml"
MODEL = "structure: {type: oscillator, mass: 1 kg, stiffness: 100 N/m}\npoints: {m: {}}\n"
STUDY = """model: model.yaml
modes: {{count: 1}}
bodies:
  ball: {{mass: 200 g, above: m, speed: 2 m/s}}
  back: {{mass: 300 g, below: m}}
contacts:
  hit: {{between: [ball, m], law: {law}}}
time: {{duration: 20 ms, sampling: 20 kHz}}
"""
CSV = "# a pad\nindentation [mm], force [kN]\n0, 0\n1, 0.5\n2, 1.5\n"


def written(folder: Path, law: str, edit: tuple[str, str] = ("", "")) -> Path:
    (folder / "model.yaml").write_text(MODEL)
    (folder / "pad.csv").write_text(CSV)
    study = folder / "hit.study.yaml"
    study.write_text(STUDY.format(law=law).replace(*edit))
    return study


def read(folder: Path, law: str, edit: tuple[str, str] = ("", "")) -> Law:
    return read_study(written(folder, law, edit)).cases[0].study.contacts[0].law


SAYINGS: dict[str, Law] = {
    "{type: linear, stiffness: 2 kN/m, damping: 3 N*s/m, tensile: true}": Linear(2e3, 3.0, True),
    "{type: linear, restitution: 0.5, duration: 2 ms}": Linear.returning(0.5, 0.2, duration=2e-3),
    "{type: linear, restitution: 50 %, stiffness: 2 kN/m, tensile: true}": Linear.returning(
        0.5, 0.2, stiffness=2e3, tensile=True
    ),
    "{type: stop, stiffness: 2 kN/m}": Stop(2e3),
    "{type: hertz, radius: 5 mm, E: [5.9 GPa, 210 GPa], nu: [0.34, 0.34], damping: 150}": Hertz(
        4 / 3 * 5.9e9 * 210e9 / 215.9e9 / (1 - 0.34**2) * sqrt(5e-3), 150.0
    ),
    "{type: hertz, radius: [10 mm, 10 mm], E: [5.9 GPa, 210 GPa], nu: [0.34, 0.34]}": Hertz(
        4 / 3 * 5.9e9 * 210e9 / 215.9e9 / (1 - 0.34**2) * sqrt(5e-3)
    ),
    "{type: hunt-crossley, stiffness: 1e8 N/m^1.5, dissipation: 0.3 s/m}": HuntCrossley(1e8, 1.5, 0.3),
    "{type: hunt-crossley, stiffness: 3 MN/m^1.2, exponent: 1.2, dissipation: 1 ms/mm}": HuntCrossley(3e6, 1.2, 1.0),
    "{type: hunt-crossley, stiffness: 3 kN/m, exponent: 1, restitution: 0.6}": HuntCrossley.returning(
        0.6, 2.0, 3e3, 1.0
    ),
    "{type: hunt-crossley, stiffness: 1e8, restitution: 0.6, at_speed: 0.5 m/s, tensile: true}": HuntCrossley.returning(
        0.6, 0.5, 1e8, tensile=True
    ),
    "{type: lankarani-nikravesh, stiffness: 1e8, restitution: 0.9}": LankaraniNikravesh(1e8, 0.9, 2.0),
    "{type: cubic, stiffness: 1 kN/m, cubic: 2 N/mm^3, restitution: 1}": Cubic(1e3, 2e9),
    "{type: cubic, cubic: 2e9}": Cubic(0.0, 2e9),
}


@pytest.mark.parametrize("text", SAYINGS)
def test_what_is_written_is_what_is_meant(text: str, tmp_path: Path) -> None:
    law, meant = read(tmp_path, text), SAYINGS[text]
    assert type(law) is type(meant)
    if isinstance(meant, Hertz):  # the order of a few products
        assert isinstance(law, Hertz)
        assert law.stiffness == pytest.approx(meant.stiffness, rel=1e-14)  # rounding: 2e-16 here
        assert law.damping == meant.damping
    else:
        assert law == meant


@pytest.mark.parametrize("text", ["curve: [[0, 0], [1 mm, 500 N], [2 mm, 1.5 kN]]", "file: pad.csv"])
def test_tables(text: str, tmp_path: Path) -> None:
    law = read(tmp_path, f"{{type: table, {text}, restitution: 0.6}}")
    assert isinstance(law, Tabulated)
    assert np.allclose(law.indentations, [0, 1e-3, 2e-3], rtol=1e-15)  # read from text: rounding
    assert np.allclose(law.forces, [0, 500, 1500], rtol=1e-15)  # read from text: rounding
    assert law.dissipation == HuntCrossley.returning(0.6, 2.0, 1.0).dissipation
    sources = read_study(tmp_path / "hit.study.yaml").sources
    assert (CSV in sources.values()) == (text == "file: pad.csv")  # kept with the results
    smooth = read(tmp_path, f"{{type: table, {text}, restitution: 0.6, smooth: true}}")
    assert isinstance(smooth, Tabulated)
    assert (law.smooth, smooth.smooth) == (False, True)


def test_two_bodies_meet_with_their_reduced_mass_and_a_drop_tells_the_speed(tmp_path: Path) -> None:
    law = read(
        tmp_path, "{type: linear, restitution: 0.5, duration: 2 ms}", ("between: [ball, m]", "between: [ball, back]")
    )
    assert law == Linear.returning(0.5, 0.06 / 0.5, duration=2e-3)
    dropped = read(
        tmp_path, "{type: hunt-crossley, stiffness: 1e8, restitution: 0.5}", ("speed: 2 m/s", "drop_height: 10 cm")
    )
    assert dropped == HuntCrossley.returning(0.5, sqrt(2 * 9.80665 * 0.1), 1e8)


IN_PYTHON: list[tuple[Law, Law]] = [
    (Hertz(stiffness="1e9 N/m^1.5"), Hertz(1e9)),  # type: ignore[arg-type]
    (
        Hertz(E=("5.9 GPa", 210e9), nu=(0.34, 0.3), radius="5 mm"),  # type: ignore[arg-type]
        Hertz.of_spheres((5e-3, np.inf), (5.9e9, 210e9), (0.34, 0.3)),
    ),
    (HuntCrossley("3 MN/m^1.2", "120 %", dissipation="1 ms/mm"), HuntCrossley(3e6, 1.2, 1.0)),  # type: ignore[arg-type]
    (HuntCrossley(1e8, restitution="60 %", at_speed="2 m/s"), HuntCrossley.returning(0.6, 2.0, 1e8)),  # type: ignore[arg-type]
    (Linear(restitution=0.5, duration="2 ms", mass="200 g"), Linear.returning(0.5, 0.2, duration=2e-3)),  # type: ignore[arg-type]
    (LankaraniNikravesh("1e8 N/m^1.5", 0.9, "2 m/s"), LankaraniNikravesh(1e8, 0.9, 2.0)),  # type: ignore[arg-type]
    (Cubic("1 kN/m", "2 N/mm^3", restitution=1.0, at_speed=3.0), Cubic(1e3, 2e9)),  # type: ignore[arg-type]
    (Stop("2 kN/m", "3 N*s/m"), Stop(2e3, 3.0)),  # type: ignore[arg-type]
]  # fmt: skip


@pytest.mark.parametrize(("given", "meant"), IN_PYTHON, ids=lambda law: type(law).__name__)
def test_python_takes_what_files_take(given: Law, meant: Law) -> None:
    """Texts with units, and what is given in place of a field; what is kept are the numbers."""
    assert given == meant
    assert replace(given) == meant  # type: ignore[type-var]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Hertz("1 N/m"), "hertz law stiffness: got '1 N/m', which is a stiffness, expected a Hertz stiffness"),
        (lambda: Hertz(1e8, E=(1e9, 1e9), nu=(0.3, 0.3)), "hertz law: got both stiffness and E, expected exactly one"),
        (lambda: Hertz(E=(1e9, 1e9), nu=(0.3, 0.3)), "hertz law: got a hertz law without a radius"),
        (lambda: Hertz(), "hertz law: got none of stiffness, E"),
        (lambda: Hertz(1e8, "x"), "hertz law damping: got 'x', expected a Hertz damping"),
        (lambda: HuntCrossley(1e8, restitution=0.5), "hunt-crossley law restitution: got a restitution without a meet"),
        (lambda: HuntCrossley(1e8, at_speed=2.0), "hunt-crossley law: got at_speed without restitution"),
        (lambda: HuntCrossley(1e8, dissipation=1.0, restitution=0.5, at_speed=1.0), "got both dissipation and restitu"),
        (lambda: HuntCrossley(1e8, restitution="130 %", at_speed=1.0), "restitution: got '130 %', expected a ratio"),
        (lambda: Linear(1e4, restitution=0.5), "linear law restitution: got a restitution between two ends without a"),
        (lambda: LankaraniNikravesh(1e8, 0.9), "lankarani-nikravesh law restitution: got a restitution without a mee"),
        (lambda: Stop("2 kg"), "stop law stiffness: got '2 kg', which is a mass, expected a stiffness"),
    ],
)  # fmt: skip
def test_python_names_the_argument(make: Callable[[], Law], message: str) -> None:
    with pytest.raises(InputError, match=message):
        make()


WORDS = [get_args(kind.model_fields["type"].annotation)[0] for kind in LAW_KINDS]
WRONG = {  # law: what stands where the message points, the message
    "{type: linear, stiffness: 1, damping: 2, restitution: 0.5}": ("{type", "got both damping and restitution, expected"
        " exactly one of damping, restitution; remove all but one"),
    "{type: linear, stiffness: 1, duration: 2 ms, restitution: 0.5}": ("{type", "got both stiffness and duration"),
    "{type: linear, duration: 2 ms}": ("{type", "got duration without restitution, expected 'restitution' beside "
        "'duration'; add 'restitution: ...', or remove 'duration'"),
    "{type: linear, restitution: 0.5}": ("{type", "got none of stiffness, duration, expected exactly one"),
    "{type: linear, stiffness: 1, restitution: 1.2}": ("1.2", "restitution: got 1.2, expected a ratio of at most 1"),
    "{type: linear, stiffness: 1, restitution: 0}": ("0}", "restitution: got 0 of a contact that does not pull, "
        "expected a positive value; for a blow that gives nothing back write 'tensile: true' beside it; for one that "
        "hardly returns write 'restitution: 5 %'"),
    "{type: linear, tensile: true, duration: 2 ms, restitution: 0}": ("0}", "restitution: got 0 with a duration, "
        "expected a stiffness"),
    "{type: linear, stiffness: 1, restitution: -0.1}": ("-0.1", "restitution: got -0.1, expected a ratio of at least"),
    **{
        f"{{type: {law}, restitution: 0}}": ("0}", "restitution: got 0, expected a positive value: a ratio; for a"
            " blow that gives nothing back write '{type: linear, stiffness: .., tensile: true, restitution: 0}'")
        for law in ("hunt-crossley, stiffness: 1", "flores, stiffness: 1", "lankarani-nikravesh, stiffness: 1",
            "cubic, cubic: 1", "table, curve: [[0, 0], [1, 1]]")
    },
    "{type: hertz, stiffness: 1e8, radius: 5 mm, E: [1, 1], nu: [0, 0]}": ("{type", "got both stiffness and E"),
    "{type: hertz, radius: 5 mm, E: [1 GPa, 1 GPa]}": ("{type", "got radius without nu"),
    "{type: hertz, stiffness: 1e8, nu: [0.3, 0.3]}": ("{type", "got nu without E"),
    "{type: hertz, stiffness: null}": ("{type", "got none of stiffness, E, expected exactly one of stiffness, E"),
    "{type: hertz, radius: 5 mm, E: [1 GPa, 1 GPa], nu: null}": ("{type", "got radius without nu"),
    "{type: hertz, radius: 5 mm, E: [1 GPa, 1 GPa], nu: [0.3, 0.6]}": ("[0.3, 0.6]", "nu: got 0.3 and 0.6"),
    "{type: hertz, radius: [1, 2, 3], E: [1 GPa, 1 GPa], nu: [0.3, 0.3]}": ("[1, 2, 3]", "got 3 values, expected 2"),
    "{type: hunt-crossley, stiffness: 1e8 N/m}": ("1e8", "stiffness: got '1e8 N/m', which is a stiffness, expected a "
        "stiffness [N/m^1.5]; write it like 1e6 N/m^1.5"),
    "{type: hunt-crossley, stiffness: 1e8 N/m^1.5, exponent: 2}": ("1e8", "expected a stiffness [N/m^2]"),
    "{type: hunt-crossley, stiffness: -1}": ("-1", "stiffness: got -1, expected a positive stiffness"),
    "{type: hunt-crossley, stiffness: 1 N/m^0.5, exponent: 0.5}": ("0.5}", "exponent: got 0.5, expected an exponent of "
        "at least 1"),
    "{type: hunt-crossley, stiffness: 1, restitution: 0.5, dissipation: 1}": ("{type", "got both dissipation and"),
    "{type: hunt-crossley, stiffness: 1, at_speed: 2 m/s}": ("{type", "got at_speed without restitution"),
    "{type: lankarani-nikravesh, stiffness: 1}": ("law:", "restitution: got nothing, expected 'restitution'"),
    "{type: cubic, stiffness: 1}": ("law:", "cubic: got nothing, expected 'cubic'"),
    "{type: cubic, cubic: -1}": ("-1", "cubic: got -1, expected a stiffness per area of at least 0"),
    "{type: cubic, cubic: 0}": ("{type", "got no stiffness, expected a stiffness, a cubic stiffness, or both"),
    "{type: table, curve: [[0, 0], [1, 1]], smooth: 1}": ("1}", "smooth: got 1, expected true or false"),
    "{type: table}": ("{type", "got none of curve, file"),
    "{type: table, curve: [[0, 0]]}": ("[[0", "got 1 values, expected at least 2"),
    "{type: table, curve: [[0, 0], [1 mm, 2 N], [2 mm, 1 N]]}": ("[[0", "got force 1 N after 2 N, expected a rise"),
    "{type: table, file: pad.cs}": ("pad.cs", "got no file"),
    "{type: linear, stiffness: 1, restitution: 30}": ("30}", "got 30, expected a ratio of at most 1; 30 % is 0.3: did "
        "you mean 30 %?"),
    "{type: kelvin-voigt, stiffness: 1}": ("kelvin", f"got 'kelvin-voigt', expected one of {', '.join(WORDS)}"),
}  # fmt: skip


@pytest.mark.parametrize("text", WRONG)
def test_contradictions_are_one_line(text: str, tmp_path: Path) -> None:
    at, message = WRONG[text]
    study = written(tmp_path, text)
    with pytest.raises(InputErrors) as caught:
        read_study(study)
    assert len(caught.value.errors) == 1, caught.value.errors
    line = caught.value.errors[0]
    row = study.read_text().splitlines()[6]
    column = row.index(at, row.index("law:")) + 1
    assert line.startswith(f"{study}:7:{column}: contacts.hit.law"), line
    assert message in line, line


def test_a_speed_or_a_mass_that_nobody_tells(tmp_path: Path) -> None:
    for edit in (("speed: 2 m/s", "speed: 0 m/s"), ("between: [ball, m]", "between: [ball, back]")):
        both_move = ("below: m", "below: m, speed: 1 m/s, contact: {type: linear, stiffness: 1e4}")
        study = written(tmp_path, "{type: hunt-crossley, stiffness: 1e8, restitution: 0.5}", edit)
        study.write_text(study.read_text().replace(*both_move))
        with pytest.raises(
            InputErrors, match=r":7:\d+: contacts\.hit\.law\.restitution: .*without a meeting speed.*at_speed: 2 m/s"
        ):
            read_study(study)
    study = written(tmp_path, "{type: linear, stiffness: 1e4, restitution: 0.5}", ("[ball, m]", "[m, ground]"))
    study.write_text(study.read_text().replace("speed: 2 m/s", "speed: 0 m/s"))
    with pytest.raises(InputErrors, match=r"restitution: got a restitution between two ends without a body"):
        read_study(study)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("0, 0\n1, 2, 3\n", r"pad\.csv:2:1: got 3 columns, expected two: indentation, force"),
        ("depth [s], force\n0, 0\n", r"pad\.csv:1:1: got 'depth \[s\]', expected a length"),
        ("0, 0\n1, two\n", r"pad\.csv:2:1: got '1, two', expected two numbers"),
        ("0, 0\n2, 2\n1, 3\n", r"pad\.csv:1:1: got indentation 1 m after 2 m, expected a rise"),
        ("0.1, 0\n2, 2\n", r"pad\.csv:1:1: got a first indentation of 0\.1 m"),
    ],
)
def test_tables_that_are_none(text: str, message: str, tmp_path: Path) -> None:
    study = written(tmp_path, "{type: table, file: pad.csv}")
    (tmp_path / "pad.csv").write_text(text)
    with pytest.raises(InputErrors, match=message):
        read_study(study)


def test_a_preload_beyond_the_table(tmp_path: Path) -> None:
    study = written(tmp_path, "{type: table, file: pad.csv}, preload: 2 kN")
    with pytest.raises(InputErrors, match=r"contacts\.hit: got 2000 N, expected at most the last force.*1500 N"):
        read_study(study)


def test_a_study_runs_and_its_schema_knows_the_laws(tmp_path: Path) -> None:
    """From the file to the findings: a restitution that Lankarani and Nikravesh miss, a table that ends too soon."""
    study = written(tmp_path, "{type: table, file: pad.csv}")
    cases = {
        "long": "{}",  # the ball and the mass meet with 1/6 kg and 0.33 J; the table holds 1.2 J
        "short": "{bodies.ball.speed: 4 m/s}",  # 1.33 J
        "published": "{contacts.hit.law.type: lankarani-nikravesh, contacts.hit.law.stiffness: 1e7, "
        "contacts.hit.law.restitution: 0.4, remove: [contacts.hit.law.file]}",
    }
    listed = "\n".join(f"  {name}: {changes}" for name, changes in cases.items())
    study.write_text(f"{study.read_text()}cases:\n{listed}\ncompare: {{baseline: long}}\n")
    result = run_study(read_study(study))
    told = {name: {found.code for found in case.findings} for name, case in result.cases.items()}
    doubts = {"beyond-table", "restitution-missed"}
    assert [told[name] & doubts for name in cases] == [set(), {"beyond-table"}, {"restitution-missed"}]
    assert [any(found.severe for found in result.cases[name].findings) for name in cases] == [False, True, False]
    assert '"lankarani-nikravesh"' in str(json_schema("study")).replace("'", '"')


def test_the_shipped_study_does_what_it_says() -> None:
    result = run_study(read_study(SHIPPED))
    expected = {"published": 0.756148680659, "elastic": 1.0, "acrylic on steel": 1.0}
    for name, case in result.cases.items():
        assert case.response is not None
        # the table's curvature jumps at its points
        assert case.response.bodies["ball"].velocity[-1] / 2.0 == pytest.approx(expected.get(name, 0.6), rel=1e-9), name
        told = {found.code for found in case.findings}
        assert ("restitution-missed" in told) == (name == "published")
        hit = case.response.contacts["hit"]
        if name.startswith("linear"):
            assert hit.first_open == pytest.approx(3e-3, rel=1e-9)
            assert hit.force[0] == pytest.approx(2 * 0.1 * -np.log(0.6) / 3e-3 * 2.0, rel=1e-12)  # c v
        else:
            assert hit.force[0] == 0.0
