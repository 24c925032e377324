"""The shipped floor files, as the SI nouns their lines say."""

from dataclasses import replace
from math import sqrt
from pathlib import Path

import numpy as np
import pytest

from femstruct.language.cases import json_schema, read_any, read_study
from femstruct.language.models import ModelFile, read_model_file
from femstruct.laws.hertz import Hertz
from femstruct.modal.damping import Ratio
from femstruct.model.regions import Region
from femstruct.model.structure import Structure
from femstruct.parts.foundation import Foundation
from femstruct.parts.frame import Frame
from femstruct.parts.mass import Mass
from femstruct.parts.plate import Plate
from femstruct.study.study import Plan

MODELS = Path(__file__).parents[2] / "models"
FLOOR = MODELS / "floor_frame_slab.yaml"
TENNIS = MODELS / "floor_tennis_ball.study.yaml"
ACRYLIC = MODELS / "floor_acrylic_ball.study.yaml"


@pytest.fixture(scope="module")
def floor() -> Structure:
    structure = read_model_file(FLOOR).structure
    assert isinstance(structure, Structure)
    return structure


@pytest.fixture(scope="module")
def tennis() -> Plan:
    return read_study(TENNIS)


def test_plates_of_the_floor(floor: Structure) -> None:
    parts = {part.name: part for part in floor.parts}
    plate, slab = parts["floor"], parts["slab"]
    assert isinstance(plate, Plate) and isinstance(slab, Plate)
    assert (plate.material.E, plate.material.nu, plate.material.rho) == (5.9e9, 0.35, 1171.875)
    assert (plate.thickness, plate.size, plate.mesh, plate.element) == (0.005, (0.4, 0.32), (16, 16), "hermite12")
    assert plate.origin == (-0.2, -0.16, 0.08)
    assert (slab.thickness, slab.mesh, slab.material.E) == (0.03, 0.03, 22.25e9)
    mass = plate.material.rho * plate.thickness * plate.size[0] * plate.size[1]
    assert mass == pytest.approx(0.75, rel=1e-12)  # the source's floor mass


def test_frames_and_foam_of_the_floor(floor: Structure) -> None:
    parts = {part.name: part for part in floor.parts}
    edge, posts, foam = parts["edge"], parts["posts"], parts["foam"]
    assert isinstance(edge, Frame) and isinstance(posts, Frame) and isinstance(foam, Foundation)
    assert (len(edge.lines), len(edge.lines[0]), len(posts.lines)) == (1, 9, 8)
    assert pytest.approx(7.216e-3 * 6.405e-3, rel=1e-13) == edge.section.A  # rounding: none here
    assert edge.section.Iy == pytest.approx(7.216e-3 * 6.405e-3**3 / 12, rel=1e-13)  # rounding: none here
    assert (edge.mesh, edge.element, edge.start_offset) == (0.02, "timoshenko", (0.0, 0.0, 0.0))
    assert foam.region == Region("rim", (0.58, 0.47))
    assert (foam.on, foam.normal, foam.shear) == ("slab", 2.21e5, 7.3e4)
    assert [(joint.a, joint.b, joint.kind) for joint in floor.joints] == [
        ("edge", "floor", "rigid"),
        ("posts", "floor", "rigid"),
        ("posts", "slab", "rigid"),
    ]


def test_places_and_damping_of_the_floor(floor: Structure) -> None:
    points = {point.name: point for point in floor.points}
    assert points["O_f"].at == ((0.2, 0.16),)  # the centre, from the floor's corner
    assert points["O_s"].at == ((0.33, 0.285),)
    assert points["B"].at == ((0.3, 0.24),)
    assert (floor.surfaces[0].side, floor.surfaces[0].region) == ("below", Region("rectangle", (0.58, 0.47)))
    damping = read_model_file(FLOOR).damping
    assert damping.base == Ratio(0.02)
    assert [(mode.number, mode.ratio, mode.near_hz) for mode in damping.modes] == [
        (4, 0.06, 19.9),
        (7, 0.018, 151.1),
        (10, 0.01, 274.4),
        (12, 0.01, 347.1),
        (15, 0.019, 448.3),
    ]


def test_cases_of_the_tennis_ball(tennis: Plan) -> None:
    assert [case.name for case in tennis.cases] == ["without damper", "damper 0.6", "damper 1.2"]
    assert tennis.baseline == "without damper"
    masses = [{body.name: body.mass for body in case.study.bodies} for case in tennis.cases]
    assert masses == [{"ball": 0.054}, {"ball": 0.054, "damper": 0.45}, {"ball": 0.054, "damper": 0.9}]
    assert tennis.cases[2].changes == {"bodies.damper.mass": "0.90 kg"}
    assert tennis.cases[0].changes == {"bodies.damper": "removed"}


def test_removing_a_body_removes_what_hangs_on_it(tennis: Plan) -> None:
    alone = tennis.cases[0].study
    assert [contact.name for contact in alone.contacts] == ["ball on floor"]
    assert alone.links == ()
    assert [str(record) for record in alone.records] == [
        "B.z acceleration",
        "O_f.z acceleration",
        "O_s.z velocity",
        "ball on floor force",
    ]


def test_the_impact_of_the_tennis_ball(tennis: Plan) -> None:
    study = tennis.cases[1].study
    ball, damper = study.bodies
    assert (ball.side, ball.target, ball.dropped, ball.law) == ("above", "O_f", True, None)
    assert ball.speed == pytest.approx(sqrt(2 * 9.80665 * 0.23), rel=1e-15)  # rounding: none here
    assert (damper.side, damper.target, damper.speed, damper.dropped) == ("below", "O_f", 0.0, False)
    assert study.contacts[0].between == ("ball", "O_f")
    assert study.contacts[0].law == Hertz(3.7e5, 150.0)
    assert study.contacts[1].law == Hertz(6.1e8)
    link = study.links[0]
    assert (link.between, link.stiffness, link.closing, link.opening) == (("damper", "O_s"), 507.0, 0.0, 40.0)


def test_the_rest_of_the_tennis_ball_study(tennis: Plan) -> None:
    study = tennis.cases[1].study
    assert (study.extent.up_to_hz, study.extent.count) == (3000.0, None)
    assert [(str(one.drive), str(one.response), one.kind, one.band, one.step) for one in study.frf] == [
        ("O_s.z", "O_s.z", "accelerance", (1.0, 500.0), 0.25),
        ("B.z", "B.z", "accelerance", (1.0, 500.0), 0.25),
    ]
    assert study.time is not None
    assert (study.time.duration, study.time.sampling, study.time.gravity, study.time.quiet) == (2.0, 48e3, False, 0.0)
    assert (study.peaks.first_impact, study.peaks.lowpass_hz) == (0.02, None)
    (plan,) = study.rooms
    assert (plan.name, plan.under, plan.offset) == ("box", "ceiling", (0.0, 0.0))
    assert plan.room.size.tolist() == [0.58, 0.47, 0.1]
    assert (plan.room.air.c, plan.room.air.rho, plan.room.losses.kind) == (340.0, 1.29, "kelvin_voigt")
    # rounding: none here
    assert plan.room.losses.relaxation_time == pytest.approx(2 * 0.0116 / (2 * np.pi * 293), rel=1e-14)
    assert [(receiver.name, receiver.position.tolist()) for receiver in plan.receivers] == [
        ("mic", [0.29, 0.235, 0.05])
    ]


def test_the_model_of_the_cases_is_one(tennis: Plan) -> None:
    assert tennis.cases[0].study.structure == tennis.cases[1].study.structure == read_model_file(FLOOR).structure


def test_sources_are_verbatim_and_positions_are_kept(tennis: Plan) -> None:
    assert tennis.sources == {str(path): path.read_text(encoding="utf-8") for path in (TENNIS, FLOOR)}
    assert tennis.positions["points.O_f"][:2] == (str(FLOOR), 43)
    assert tennis.positions["bodies.damper.mass"][:2] == (str(TENNIS), 9)


def test_the_acrylic_ball_and_its_added_mass() -> None:
    plan = read_study(ACRYLIC)
    assert [case.name for case in plan.cases] == ["none", "damper 0.3 kg", "added mass 0.3 kg"]
    none, damper, added = (case.study for case in plan.cases)
    assert [body.name for body in added.bodies] == ["ball"] == [body.name for body in none.bodies]
    assert [(body.name, body.mass) for body in damper.bodies] == [("ball", 0.045), ("damper", 0.3)]
    assert isinstance(none.structure, Structure) and isinstance(added.structure, Structure)
    assert added.structure.parts[-1] == Mass("added mass", 0.3, at="O_f")
    assert replace(added.structure, parts=added.structure.parts[:-1]) == none.structure
    assert damper.contacts[0].law == Hertz(3.3e7, 500.0)
    assert plan.cases[0].study.peaks.lowpass_hz == 1000.0


def test_files_are_told_apart() -> None:
    assert isinstance(read_any(FLOOR), ModelFile)
    assert isinstance(read_any(TENNIS), Plan)


def test_schemas_offer_quantities_as_numbers_and_texts() -> None:
    model, study = json_schema("model"), json_schema("study")
    thickness = model["$defs"]["PlateSpec"]["properties"]["thickness"]["anyOf"][0]  # or a lay-up has it
    assert [option["type"] for option in thickness["anyOf"]] == ["number", "string"]
    assert thickness["description"].startswith("a length [m]")
    assert "from" in model["$defs"]["DampingSpec"]["properties"]
    assert study["required"] == ["model"]
    assert model["additionalProperties"] is False
