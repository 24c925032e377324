"""What cases and overrides do to the tree of a study and its model."""

import re
from pathlib import Path

import pytest

from femstruct.errors import FemstructError, InputErrors
from femstruct.impact.scene import HalfSine, Table
from femstruct.language.cases import read_study
from femstruct.language.models import read_model_file, with_position
from femstruct.laws.linear import Linear
from femstruct.laws.stop import Stop
from femstruct.model.structure import Structure
from femstruct.parts.mass import Mass
from femstruct.study.asked import Spot
from femstruct.study.structures import BeamModel, ModesModel, NoStructure, OscillatorModel, RodModel
from femstruct.study.study import Plan

MODEL = """\
title: plate
materials: {steel: {E: 206 GPa, nu: 0.3, rho: 7850}}
parts:
  plate: {type: plate, material: steel, thickness: 2 mm, origin: [0, 0, 0], size: [1, 1], mesh: [4, 4]}
points:
  P: {on: plate, at: center}
  Q: {on: plate, at: [[0.1, 0.1], [0.9, 0.9]]}
surfaces: {top: {on: plate}}
supports: {rim: {on: plate, edge: all, fix: simple}}
damping: {ratio: 1 %}
"""
STUDY = """\
title: drop
model: plate.yaml
modes: {count: 10}
bodies: {ball: {mass: 10 g, above: P, speed: 1 m/s, contact: {type: linear, stiffness: 1e5}}}
record: {P.z: [displacement, velocity], ball: travel, ball on P: force, ground: force}
time: {duration: 10 ms, sampling: 10 kHz}
"""


@pytest.fixture
def files(tmp_path: Path) -> Path:
    (tmp_path / "plate.yaml").write_text(MODEL)
    (tmp_path / "drop.study.yaml").write_text(STUDY)
    return tmp_path / "drop.study.yaml"


def plan(files: Path, more: str = "", *overrides: str) -> Plan:
    files.write_text(STUDY + more)
    return read_study(files, overrides)


def lines(files: Path, more: str = "", *overrides: str) -> tuple[str, ...]:
    with pytest.raises(InputErrors) as caught:
        plan(files, more, *overrides)
    return caught.value.errors


def test_without_cases_there_is_one(files: Path) -> None:
    read = plan(files)
    assert [case.name for case in read.cases] == [read.baseline] == ["as given"]
    assert read.cases[0].study.bodies[0].law == Linear(1e5)
    assert read.cases[0].changes == {}


def test_the_first_case_is_the_baseline_unless_told(files: Path) -> None:
    assert plan(files, "cases: {a: {}, b: {bodies.ball.mass: 1 kg}}\n").baseline == "a"
    assert plan(files, "cases: {a: {}, b: {bodies.ball.mass: 1 kg}}\ncompare: {baseline: b}\n").baseline == "b"


def test_a_mapping_patches_and_a_value_replaces(files: Path) -> None:
    read = plan(
        files, "cases: {a: {bodies.ball: {mass: 1 kg}, parts.plate.thickness: 3 mm, points.P.at: [0.2, 0.3]}}\n"
    )
    study = read.cases[0].study
    assert (study.bodies[0].mass, study.bodies[0].speed) == (1.0, 1.0)
    assert isinstance(study.structure, Structure)
    assert study.structure.parts[0].thickness == 0.003  # type: ignore[union-attr]
    assert study.structure.points[0].at == ((0.2, 0.3),)
    assert read.cases[0].changes["parts.plate.thickness"] == "3 mm"


def test_cases_do_not_touch_each_other(files: Path) -> None:
    read = plan(files, "cases: {a: {bodies.ball.mass: 1 kg}, b: {}}\n")
    assert [case.study.bodies[0].mass for case in read.cases] == [1.0, 0.01]


def test_paths_of_keys_with_dots_and_of_list_items(files: Path) -> None:
    read = plan(files, "cases: {a: {record.P.z: acceleration, 'parts.plate.size[0]': 2 m}}\n")
    study = read.cases[0].study
    assert str(study.records[0]) == "P.z acceleration"
    assert isinstance(study.structure, Structure)
    assert study.structure.parts[0].size == (2.0, 1.0)  # type: ignore[union-attr]


def test_defaults_can_be_set_by_their_path(files: Path) -> None:
    read = plan(
        files, "cases: {a: {time.gravity: true, peaks.lowpass: 1 kHz, quiet: 1 ms, parts.plate.element: acm12}}\n"
    )
    study = read.cases[0].study
    assert study.time is not None
    assert (study.time.gravity, study.time.quiet, study.peaks.lowpass_hz) == (True, 1e-3, 1000.0)


def test_adding_a_part_and_a_body(files: Path) -> None:
    more = """\
cases:
  a: {}
  b:
    add:
      parts.lump: {type: mass, at: Q, mass: 0.3 kg}
      bodies.other: {mass: 1 kg, below: P}
      links.other on P: {between: [other, P], stiffness: 1 kN/m}
"""
    study = plan(files, more).cases[1].study
    assert isinstance(study.structure, Structure)
    assert study.structure.parts[1] == Mass("lump", 0.3, at="Q")
    assert [body.name for body in study.bodies] == ["ball", "other"]
    assert study.links[0].stiffness == 1000.0


def test_removing_a_part_removes_its_records(files: Path) -> None:
    model = files.parent / "plate.yaml"
    model.write_text(
        MODEL.replace("points:\n", "  k: {type: spring, between: [P, ground], stiffness: {z: 1 kN/m}}\npoints:\n")
    )
    more = "frf: {f: {drive: P.z, response: k.force, kind: transmissibility, band: [1, 10], step: 1}}\n"
    read = plan(files, f"{more}cases: {{a: {{}}, b: {{remove: [parts.k]}}}}\n".replace("a: {}", "a: {record.k: force}"))
    assert [str(record) for record in read.cases[0].study.records][-1] == "k force"
    assert len(read.cases[0].study.frf) == 1
    assert read.cases[1].study.frf == ()


def test_a_case_can_swap_the_model(files: Path) -> None:
    (files.parent / "thick.yaml").write_text(MODEL.replace("2 mm", "9 mm"))
    read = plan(files, "cases: {a: {}, b: {model: thick.yaml, parts.plate.mesh: [5, 5]}}\n")
    structure = read.cases[1].study.structure
    assert isinstance(structure, Structure)
    assert structure.parts[0].thickness == 0.009  # type: ignore[union-attr]
    assert structure.parts[0].mesh == (5, 5)  # type: ignore[union-attr]
    assert read.cases[1].changes["model"] == "thick.yaml"
    assert len(read.sources) == 3


def test_overrides_change_the_file_before_the_cases_do(files: Path) -> None:
    read = plan(
        files, "cases: {a: {}, b: {bodies.ball.mass: 1 kg}}\n", "bodies.ball.mass=2 kg", "points.P.at=[0.1, 0.2]"
    )
    assert [case.study.bodies[0].mass for case in read.cases] == [2.0, 1.0]
    assert read.cases[0].changes == {"bodies.ball.mass": "2 kg", "points.P.at": "[0.1, 0.2]"}


def test_overrides_of_a_model_file(files: Path) -> None:
    structure = read_model_file(files.parent / "plate.yaml", ["parts.plate.thickness=4 mm"]).structure
    assert isinstance(structure, Structure)
    assert structure.parts[0].thickness == 0.004  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("bodies.bal.mass=1 kg", r"--set bodies.bal.mass=1 kg: got the path .*did you mean 'ball'"),
        ("bodies.ball.mass=1 m", r"--set bodies.ball.mass=1 m: bodies.ball.mass: got '1 m', which is a length"),
        ("bodies.ball.mas=1 kg", r"bodies.ball.mas: got the unknown key 'mas'.*'mass'"),
        ("nonsense", r"--set nonsense: got no PATH=VALUE"),
        ("bodies.ball.mass=[1", r"broken YAML"),
        ("=1", r"no PATH=VALUE"),
        ("bodies.ball.mass=", "got no PATH=VALUE"),
    ],
)
def test_overrides_that_cannot_be(files: Path, override: str, message: str) -> None:
    errors = lines(files, "", override)
    assert any(re.search(message, line) for line in errors), errors


def test_an_override_every_case_undoes_is_refused(files: Path) -> None:
    errors = lines(
        files, "cases: {a: {bodies.ball.mass: 1 kg}, b: {bodies.ball.mass: 2 kg}}\n", "bodies.ball.mass=3 kg"
    )
    assert len(errors) == 1 and "every case sets itself" in errors[0] and "cases.a.bodies.ball.mass" in errors[0]


def test_one_case_alone(files: Path) -> None:
    files.write_text(STUDY + "cases: {a: {}, b: {bodies.ball.mass: 1 kg}}\n")
    only = read_study(files, only="b")
    assert [case.name for case in only.cases] == [only.baseline] == ["b"]
    with pytest.raises(InputErrors, match="expected a case of"):
        read_study(files, only="c")


@pytest.mark.parametrize(
    ("case", "message"),
    [
        ("{bodies.other: {mass: 1 kg, above: P}}", "a new one goes under 'add:'"),
        ("{bodies: {other: {mass: 1 kg, above: P}}}", "a new one goes under 'add:'"),
        ("{add: {bodies.ball: {mass: 1 kg, above: P}}}", "which is there already"),
        ("{add: {bdies.x: {mass: 1 kg, above: P}}}", "did you mean 'bodies'"),
        ("{add: [bodies.x]}", "expected a mapping of new paths"),
        ("{remove: [5]}", "expected a path"),
        ("{'': 1}", "does not exist"),
        ("{bodies.ball.mass.x: 1}", "does not exist"),
        ("{'parts.plate.size[7]': 1}", "does not exist"),
        ("[1, 2]", "expected a mapping of paths to values"),
        ("{model: none.yaml}", "got no file"),
        ("{bodies.ball.above: R}", "the name of a point, body"),
    ],
)
def test_cases_that_cannot_be(files: Path, case: str, message: str) -> None:
    errors = lines(files, f"cases:\n  a: {case}\n")
    assert any(message in line for line in errors), errors
    assert errors[0].startswith(f"{files}:8:"), errors


def test_loads_from_a_file_beside_the_study(files: Path) -> None:
    (files.parent / "force.csv").write_text("# hammer\ntime [ms], force [kN]\n0, 0\n1, 0.5\n\n2, 0\n")
    wind = "wind: {on: top, half_sine: {amplitude: 3 Pa, frequency: 9}}"
    read = plan(files, f"loads: {{hammer: {{at: Q.2.z, file: force.csv}}, {wind}}}\n")
    csv = files.parent / "force.csv"
    assert read.sources[str(csv)] == csv.read_text()  # a run can be done again from its results
    loads = read.cases[0].study.loads
    assert isinstance(loads[0].history, Table)
    assert loads[0].history.times.tolist() == [0.0, 0.001, 0.002]
    assert loads[0].history.values.tolist() == [0.0, 500.0, 0.0]
    assert (loads[0].on, loads[0].kind) == (Spot("Q.2", "z"), "point")
    assert isinstance(loads[1].history, HalfSine)
    assert (loads[1].on, loads[1].kind, loads[1].history.amplitude) == ("top", "surface", 3.0)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("0, 0\n1, x\n", r"force\.csv:2:1: got '1, x', expected two numbers"),
        ("0, 0, 0\n", r"force\.csv:1:1: got 3 columns"),
        ("0, 0\n1, nan\n", r"force\.csv:2:1: .*finite"),
        ("time [m], force [N]\n0, 0\n", r"force\.csv:1:1: got 'time \[m\]', expected a time"),
        ("1, 0\n0, 0\n", r"force\.csv:1:1: got times that do not increase"),
        ("", r"got 0 lines of numbers in .*force\.csv"),
    ],
)
def test_load_files_that_cannot_be(files: Path, text: str, message: str) -> None:
    (files.parent / "force.csv").write_text(text)
    errors = lines(files, "loads: {hammer: {at: P.z, file: force.csv}}\n")
    assert len(errors) == 1 and re.search(message, errors[0]), errors


def test_a_load_file_that_is_not_there(files: Path) -> None:
    (line,) = lines(files, "loads: {hammer: {at: P.z, file: force.csv}}\n")
    assert line.startswith(f"{files}:7:33: loads.hammer.file: got no file")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("structure: none", NoStructure()),
        (
            "structure: {type: oscillator, mass: 2 kg, frequency: 3 Hz}\npoints: {m: {}}",
            OscillatorModel(2.0, 3.0, None, {"m": 0.0}),
        ),
        (
            "structure: {type: rod, length: 2 m, E: 206 GPa, rho: 7850, area: 3.14e-4}\n"
            "points: {left: {at: 0}, mid: {at: center}}",
            RodModel(2.0, 206e9, 7850.0, 3.14e-4, 50, {"left": 0.0, "mid": 1.0}),
        ),
        (
            "structure: {type: beam, length: 1 m, ends: [pinned, free], EI: 25, mass_per_length: 2 kg/m}\n"
            "points: {tip: {at: [1]}}",
            BeamModel(1.0, ("pinned", "free"), 25.0, 2.0, 6, {"tip": 1.0}),
        ),
        (
            "structure: {type: modes, frequency: [6.4, 283], ratio: [0, 1 %], points: {O_b: [0.14, 0.392]}}",
            ModesModel((6.4, 283.0), (0.0, 0.01), {"O_b": (0.14, 0.392)}),
        ),
    ],
)
def test_closed_form_structures(tmp_path: Path, text: str, expected: object) -> None:
    path = tmp_path / "model.yaml"
    path.write_text(text)
    assert read_model_file(path).structure == expected


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "structure: {type: rod, length: 2 m, E: 206 GPa, rho: 7850, area: 3e-4}\npoints: {p: {at: 3 m}}",
            "from 0 to 2 m",
        ),
        ("structure: {type: modes, frequency: [6, 9], points: {p: [1]}}", "1 values, expected 2"),
        ("structure: {type: oscillator, mass: 2 kg}", "exactly one of frequency, stiffness"),
        ("structure: {type: plank}", "expected one of none, oscillator, rod, beam, modes"),
        ("structure: none\nparts: {a: {type: mass, at: P, mass: 1 kg}}", "'parts' beside 'structure'"),
        ("title: nothing", "no parts"),
    ],
)
def test_closed_form_structures_that_cannot_be(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "model.yaml"
    path.write_text(text)
    with pytest.raises(InputErrors) as caught:
        read_model_file(path)
    assert any(message in line for line in caught.value.errors), caught.value.errors


def test_a_named_contact_that_agrees_with_the_body_is_used_once(files: Path) -> None:
    contact = "contacts: {c: {between: [P, ball], law: {type: linear, stiffness: 100 kN/m}}}\n"
    files.write_text(STUDY.replace("ball on P: force", "c: force") + contact)
    study = read_study(files).cases[0].study
    assert study.bodies[0].law is None
    assert study.contacts[0].law == Linear(1e5)


def test_laws_links_rooms_and_starts(files: Path) -> None:
    more = """\
contacts: {stop: {between: [ball, ground], law: {type: stop, stiffness: 1 MN/m, damping: 3, tensile: true}, gap: 1 mm}}
links: {l: {between: [ball, P], damping: 4 N*s/m, release_at: 2 ms, preload: -5 N}}
initial: {velocity: {P.z: 1 m/s, P.rx: 2 rad/s}}
peaks: {first_impact: until next contact}
rooms:
  r: {size: [1, 1, 1], under: top, at: [0.1, 0], losses: {t60: 0.5 s}, receivers: {mic: [[0, 0, 0], [0.2, 0.3, 0.4]]}}
save: modal
"""
    study = plan(files, more).cases[0].study
    assert study.contacts[0].law == Stop(1e6, 3.0, True)
    assert study.contacts[0].gap == 1e-3
    link = study.links[0]
    assert (link.closing, link.opening, link.release_at, link.preload) == (4.0, 4.0, 2e-3, -5.0)
    assert study.initial.velocities == ((Spot("P", "z"), 1.0), (Spot("P", "rx"), 2.0))
    assert study.peaks.first_impact is None
    # the centre of the surface at (0.1, 0.0) from the corner of a ceiling of 1 x 1 m
    assert study.rooms[0].offset == pytest.approx((-0.4, -0.5))
    assert study.rooms[0].room.losses.decay_rate == pytest.approx(6.907755 / 0.5, rel=1e-6)  # ln(1e6) / 2 / T60
    assert [receiver.name for receiver in study.rooms[0].receivers] == ["mic.1", "mic.2"]
    assert study.save_modal


def test_errors_of_later_stages_get_their_position(files: Path) -> None:
    read = plan(files)
    error = FemstructError("points.P", got="[3, 3]", expected="a place on the plate")
    where = f"{files.parent / 'plate.yaml'}:6:3"
    assert with_position(read, error) == f"{where}: points.P: got [3, 3], expected a place on the plate"
    assert with_position(read, FemstructError("points.P.somewhere else")).startswith(f"{where}: ")
    assert with_position(read, FemstructError("basis", got="nothing")) == "basis: got nothing"
