"""The inputs of a study as values: every case of every shipped study differs, and by what its file says."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from femstruct.impact.laws.hunt_crossley import HuntCrossley
from femstruct.language import read_study
from femstruct.model.given import Given
from femstruct.model.material import Material
from femstruct.model.section import circle
from femstruct.parts.frame import Frame
from femstruct.study.inputs import Inputs, differences, inputs
from femstruct.study.study import Plan
from femstruct.view.page.input_tables import cases_table, input_tables

MODELS = Path(__file__).parents[2] / "models"
STUDIES = sorted(MODELS.glob("*.study.yaml"))
WITHOUT_UNIT = {
    "nu",
    "loss factor",
    "ratio",
    "harmonics",
    "steps",
    "count",
    "restitution",
    "exponent",
    "within",
    "modes",
}


FEWER_MODES = {"l_room.study.yaml": ("rooms.living room.modes={up_to: 30 Hz}",)}  # its room says how many it has


def baseline_of(plan: Plan) -> Inputs:
    return inputs(next(case.study for case in plan.cases if case.name == plan.baseline))


@pytest.mark.parametrize("path", STUDIES, ids=lambda path: path.name)
def test_every_case_differs_from_the_baseline_and_no_number_lacks_its_unit(path: Path) -> None:
    plan = read_study(path, FEWER_MODES.get(path.name, ()))
    baseline = baseline_of(plan)
    for case in plan.cases:
        found = differences(baseline, inputs(case.study))
        assert bool(found) == (case.name != plan.baseline), case.name
    numbers = [
        (item.name, one)
        for items in baseline.groups.values()
        for item in items
        for one in item.given
        if isinstance(one.value, float) and not one.unit
    ]
    assert not [
        (name, one) for name, one in numbers if one.what not in WITHOUT_UNIT and not one.what.startswith("mode ")
    ]


def test_the_bedrooms_differences_are_those_of_its_file() -> None:
    plan = read_study(MODELS / "bedroom.study.yaml")
    baseline = baseline_of(plan)
    assert [item.name for item in baseline.groups["parts"]] == ["slab"]
    cases = {case.name: differences(baseline, inputs(case.study)) for case in plan.cases}
    (thicker,) = cases["200 mm"]
    assert (thicker.group, thicker.name) == ("parts", "slab")
    assert (thicker.before, thicker.after) == ((Given("thickness", 0.18, "m"),), (Given("thickness", 0.2, "m"),))
    screed = [(one.group, one.name, bool(one.before)) for one in cases["floating screed"]]
    added = [("materials", "screed", False), ("parts", "screed", False), ("parts", "wool", False)]
    assert screed == [*added, ("points", "drops", True)]
    link = next(one for one in cases["damper"] if one.group == "links")
    assert Given("damping", 4740.0, "N s/m") in link.after and Given("stiffness", 3.32e6, "N/m") in link.after
    assert differences(inputs(plan.cases[3].study), baseline)[0].after == ()


def test_the_bedrooms_tables_say_its_inputs_and_cases_in_units_people_use() -> None:
    plan = read_study(MODELS / "bedroom.study.yaml")
    tables = {grid.title: grid.rows for grid in input_tables(inputs(plan.cases[0].study))}
    assert list(tables) == ["materials", "structure", "what acts on it", "rooms", "analysis"]
    assert tables["materials"] == [("concrete", "30 GPa", "2400 kg/m³", "0.2", "0 %")]
    assert "thickness 180 mm" in tables["structure"][0][2] and "drop height 1 m" in tables["what acts on it"][0][2]
    assert "size 5 x 4 x 2.5 m" in tables["rooms"][0][2] and "63 Hz 550 ms" in tables["rooms"][0][2]
    cases = cases_table(plan, ["as is", "200 mm", "damper"])
    assert ("200 mm", "slab: thickness", "180 mm", "200 mm") in cases.rows
    assert [row[0] for row in cases.rows if row[0]] == ["as is", "200 mm", "floating screed, not run", "damper"]


def test_a_laws_stiffness_has_the_unit_of_its_exponent() -> None:
    assert HuntCrossley(4e6).described() == (Given("stiffness", 4e6, "N/m^1.5"),)
    assert HuntCrossley(4e6, exponent=2.0, dissipation=0.3).described()[0].unit == "N/m^2"


def test_what_a_part_gives_is_what_it_was_made_with() -> None:
    steel = Material("steel", 210e9, 0.3, 7850.0)
    ends = ((0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    post = Frame("post", steel, circle("rod", 0.02), (ends,), mesh=0.1)
    assert post.described() == (
        Given("material", steel),
        Given("section", circle("rod", 0.02)),
        Given("lines", (ends,), "m"),
        Given("mesh", 0.1, "m"),
    )
    assert replace(post, element="euler").described()[-1] == Given("element", "euler")
