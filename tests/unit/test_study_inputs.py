"""The inputs of a study as values: every case of every shipped study differs, and by what its file says."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from acoustics.fields.rectangular import Room
from acoustics.losses import losses_from_beta
from femstruct.conventions import GRAVITY
from femstruct.impact.fatigue import SNLine
from femstruct.language.cases import read_study
from femstruct.laws.hunt_crossley import HuntCrossley
from femstruct.modal.damping import Damping, FromMaterials, ModeDamping, Ratio
from femstruct.modal.steady import Spectrum
from femstruct.model.materials import Given, Material
from femstruct.model.sections import circle
from femstruct.parts.frame import Frame
from femstruct.study.asked import FatigueRequest
from femstruct.study.inputs import Inputs, differences, inputs
from femstruct.study.study import Plan
from femstruct.view.page import cases_table, further_inputs, input_tables
from femstruct.view.structure_tables import _room_parts

MODELS = Path(__file__).parents[2] / "models"
STUDIES = sorted(MODELS.glob("*.study.yaml"))
WITHOUT_UNIT = {
    "nu",
    "loss factor",
    "ratio",
    "harmonics",
    "steps",
    "bond",
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
        (name, one)
        for name, one in numbers
        if one.what not in WITHOUT_UNIT and not one.what.startswith(("mode ", "damping ratio"))
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
    found = {one.what: one.value for one in link.after}
    # 100 kg on a spring for 29 Hz with 13 %, by hand: 3.320 MN/m and 4.738 kN s/m
    assert found["stiffness"] == pytest.approx(3.3202e6, rel=1e-4) and found["damping"] == pytest.approx(
        4737.6, rel=1e-4
    )
    assert found["frequency of damper"] == pytest.approx(29.0, rel=1e-14)  # rounding
    assert found["damping ratio of damper"] == pytest.approx(0.13, rel=1e-14)  # rounding
    assert differences(inputs(plan.cases[3].study), baseline)[0].after == ()


def test_the_bedrooms_tables_say_its_inputs_and_cases_in_units_people_use() -> None:
    plan = read_study(MODELS / "bedroom.study.yaml")
    tables = {grid.title: grid.rows for grid in input_tables(inputs(plan.cases[0].study))}
    assert list(tables) == ["materials", "structure", "what acts on it", "rooms", "analysis"]
    assert tables["materials"] == [("concrete", "30 GPa", "2400 kg/m³", "0.2", "0 %")]
    (materials,) = (grid for grid in input_tables(inputs(plan.cases[0].study)) if grid.title == "materials")
    assert materials.columns[-1] == "loss factor\n(not used)"  # the damping is one loss factor for all
    for damping, column in ((FromMaterials(), "loss factor"), (Ratio(0.02), "loss factor\n(not used)")):
        of = replace(plan.cases[0].study, damping=Damping(damping, (ModeDamping(4, near_hz=19.9, ratio=0.06),)))
        first, *_, last = input_tables(inputs(of))
        assert first.columns[-1] == column
        assert any("mode 4: 6 %" in row[2] for row in last.rows)
    assert "thickness 180 mm" in tables["structure"][0][2] and "drop height 1 m" in tables["what acts on it"][0][2]
    assert "size 5 x 4 x 2.5 m" in tables["rooms"][0][2] and "63 Hz 550 ms" in tables["rooms"][0][2]
    cases = cases_table(plan, ["as is", "200 mm", "damper"])
    assert ("200 mm", "slab: thickness", "180 mm", "200 mm") in cases.rows
    assert [row[0] for row in cases.rows if row[0]] == ["as is", "200 mm", "floating screed, not run", "damper"]


def test_a_reverberation_time_that_is_given_as_one_value_is_shown() -> None:
    """Damping ratios of three modes alone do not say it; where it rises with frequency there is none of all modes."""
    study = read_study(MODELS / "tapping.study.yaml").cases[0].study
    (rooms,) = (grid for grid in input_tables(inputs(study)) if grid.title == "rooms")
    assert "reverberation time of all modes 500 ms" in rooms.rows[0][2]
    described = study.rooms[0].room.described()
    assert described["reverberation_time_of_all_modes_s"] == pytest.approx(0.5, rel=1e-12)  # rounding
    told = "; ".join(_room_parts(described))
    assert told.startswith("first modes ") and told.endswith("; reverberation time 0.5 s of all modes")
    other = Room([5.0, 4.0, 2.5], losses=losses_from_beta(0.01, 100.0))
    assert "reverberation_time_of_all_modes_s" not in other.described()


def test_fatigue_and_spectra_are_told_as_they_are_spoken_of(tmp_path: Path) -> None:
    (tmp_path / "model.yaml").write_text(
        "structure: {type: oscillator, mass: 2 kg, frequency: 40 Hz}\npoints: {m: {}}\ndamping: {ratio: 2 %}\n"
    )
    (tmp_path / "all.study.yaml").write_text(
        """
model: model.yaml
record: {ground: force, m.z: displacement}
vibration:
  shaker: {base: z, psd: [[20 Hz, 0.0098 g^2/Hz], [80 Hz, 0.01 g^2/Hz]], duration: 60 s}
  motor: {at: m.z, harmonic: 3 N, band: [5 Hz, 80 Hz]}
fatigue:
  bolts: {of: ground force, under: shaker, sn: {range: 2 kN, slope: 5}}
"""
    )
    study = read_study(tmp_path / "all.study.yaml").cases[0].study
    weld = FatigueRequest("weld", "portal stress", SNLine(71e6, category=True))
    study = replace(study, fatigue=(weld, *study.fatigue))
    told = {row[0]: row[2] for row in further_inputs(inputs(study)).rows}
    assert told["weld"] == "of portal stress, detail category 71 MPa"
    assert told["bolts"] == "of ground force, under shaker, range 2 kN, endured 2000000 cycles, slope 5"
    assert told["shaker"] == "spectrum 20 Hz 0.0098 g²/Hz, 80 Hz 0.01 g²/Hz, duration 60 s"
    assert told["motor"] == "spectrum 5 Hz 3 N, 80 Hz 3 N"
    many = Spectrum(tuple((float(f), 0.01 * GRAVITY**2) for f in range(10, 40)))
    long = replace(study, fatigue=(), vibration=(replace(study.vibration[0], spectrum=many),))
    (row,) = (row for row in further_inputs(inputs(long)).rows if row[0] == "shaker")
    assert row[2] == "spectrum 30 values, 0.01 to 0.01 g²/Hz, at 30 values, 10 to 39 Hz, duration 60 s"


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
