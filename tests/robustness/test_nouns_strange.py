"""Every exported noun, made of anything: it is refused as bad input, naming the field, or it is made."""

from __future__ import annotations

from dataclasses import fields, is_dataclass, replace
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.sparse import csr_array

import femstruct as fs
from acoustics.fields.rectangular import Room
from acoustics.receivers import Receiver
from femstruct.errors import FemstructError, InputError
from femstruct.model.imported_mesh import Stated, StatedHold

STEEL = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0)
SPRUCE = fs.Orthotropic("spruce", E=(11e9, 370e6), G=(690e6, 50e6), nu=0.35, rho=420.0)
TUBE = fs.Section("tube", A=1e-3, Iy=1e-6, Iz=1e-6, J=2e-6)
PLATE = fs.Plate("plate", STEEL, 0.01, (0.0, 0.0, 0.0), (1.0, 1.0), 0.1)
BALL = fs.PlacedBody("ball", 0.05, "above", "middle", speed=1.0, law=fs.Hertz(1e8), blows=fs.Repeat(2, 0.1))
MIDDLE = fs.Spot("middle", "z")
STUDY = fs.Study("a fall", fs.NoStructure(), fs.Damping(), fs.Extent(), bodies=(BALL,), time=fs.TimePlan(0.1, 1e4))
PUSH = fs.HalfSine(-300.0, 62.5)
TRAY = fs.ImportedMesh(
    "tray", [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], range(1, 5), {"quad4": [[0, 1, 2, 3]]}, {"quad4": [1]}
)
HELD = replace(TRAY, stated=Stated(holds=(StatedHold("feet", np.array([0, 1]), (2,)),)))
CUBE = fs.ImportedMesh(
    "cube",
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]],
    range(8),
    {"hex8": [range(8)]},
    {"hex8": [1]},
)
FAN = fs.Component(
    "fan.npz", csr_array([[2.0]]), csr_array((1, 1)), csr_array([[200.0]]), csr_array(np.eye(7, 1, -2)),
    [[0.0, 0.0, 0.0]], 2.0, ("z",), [0],
)  # fmt: skip
NOUNS = [
    SPRUCE, fs.Layer(SPRUCE, 0.04), fs.Laminate((fs.Layer(SPRUCE, 0.04),)),
    fs.Smeared((6e6, 2e6, 1e5, 5e5), (2e7, 1e7), 84.0, 0.2),
    fs.LossByFrequency(((63.0, 0.06), (125.0, 0.05))),
    STEEL, TUBE, PLATE, BALL, MIDDLE, STUDY, PUSH, TUBE,
    fs.Region("rim", size=(0.5, 0.2), at=(0.1, 0.1)),
    fs.Joint("weld", "tube", "plate", stiffness={"rx": 5e3}),
    fs.RigidLink("arm", "seat", ("head",)), fs.Average("rests", "underside", ("feet",)),
    fs.Seam("weld", "insert", fs.Region("set", named="edge"), "wall", fs.Region("set", named="opening")),
    fs.Equation("alike", {"left.z": 1.0, "right.z": -1.0}),
    fs.PlaceOn("drop", "plate", at=((0.2, 0.1),), patch=(0.1, 0.1)),
    fs.SurfaceOn("top", "plate"),
    fs.Fill(10e3, 40.0), fs.Bays("y", (0.6,)),
    fs.AirBetween("void", "underside", "ceiling", 0.2, fill=fs.Fill(10e3, 40.0)),
    fs.Support("edges", "simple", on="plate", edge="all"),
    fs.EdgeWall(STEEL, 0.2), fs.Support("pinned", "simple", on="plate", edge="x0", walls=(fs.EdgeWall(STEEL, 0.2),)),
    fs.Support("strip", on="plate", edge="x0", stiffness={"z": 5e6}, loss_factor=0.2),
    fs.Structure("a plate", (PLATE,)),
    fs.Block("block", 10.0, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), (0.5, 0.5, 0.5), (1.0, 1.0, 1.0)),
    fs.Foundation("foam", "plate", fs.Region("whole"), 1e5),
    fs.Frame("leg", STEEL, TUBE, (((0.0, 0.0, 0.0), (0.0, 0.0, 1.0)),), 0.1, (1.0, 0.0, 0.0)),
    fs.Hangers("clips", "floor", "ceiling", 2e4, spacing=(0.6, 0.9), mass=0.03),
    fs.Inertia("disc", "hub", 2.0, (0.01, 0.01, 0.02)),
    fs.Mass("box", 2.0, at="middle"),
    fs.Shell("tray", TRAY, STEEL, thickness=2e-3),
    fs.Attachments("feet", HELD, ("supports",)),
    fs.Solid("cube", CUBE, STEEL),
    fs.Slab("l", STEEL, 0.2, ((0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0)), mesh=0.5),
    fs.Substructure("fan", FAN, 0.01, (1.0, 0.0, 0.0)),
    fs.Spring("mounts", "feet", None, (1e5, 1e5, 1e5, 0.0, 0.0, 0.0)),
    fs.ShockRequest("foot", "foot.z", 0.05, (5.0, 2000.0)), fs.PerceptionRequest("bed", "bed.z", "KB"),
    fs.SNLine(71e6, category=True), fs.FatigueRequest("weld", "portal stress", fs.SNLine(71e6)),
    fs.Spectrum(((20.0, 0.01), (500.0, 0.02))),
    fs.Vibration("shaker", "z", "base", "psd", fs.Spectrum(((20.0, 0.01), (500.0, 0.02))), 60.0),
    fs.BandSpectrum(((50.0, 4.0), (63.0, 3.0))), fs.RigidMass(2.0),
    fs.BandMobility(((50.0, 1e-4), (63.0, 1e-4))), fs.MeasuredMobility(((50.0, 1e-4, 1e-4), (63.0, 1e-4, 1e-4))),
    fs.MeasuredSource("pump", (MIDDLE,), "blocked force", (fs.BandSpectrum(((50.0, 4.0),)),), fs.RigidMass(2.0)),
    fs.Ratio(0.01), fs.LossFactor(0.02), fs.Rayleigh(0.1, 1e-6),
    fs.ModeDamping(4, 19.9, ratio=0.06),
    fs.Damping(fs.Ratio(0.01), (fs.ModeDamping(4, 19.9, ratio=0.06),)),
    fs.Linear(1e6, 1.0), fs.Stop(1e6), fs.Hertz(1e8), fs.Cubic(1e6, 1e9), fs.HuntCrossley(1e8),
    fs.Flores(1e8, 0.5, 1.0), fs.LankaraniNikravesh(1e8, 0.9, 1.0),
    fs.Tabulated([0.0, 1e-3], [0.0, 10.0]),
    fs.Body("ball", 0.05, -1.0), fs.Clock(0.1, 1e4), fs.Table([0.0, 1.0], [0.0, 1.0]),
    fs.Contact("hit", "ball", fs.GROUND, fs.Hertz(1e8)),
    fs.Link("spring", "ball", fs.GROUND, 1e3),
    fs.Load("push", "ball", PUSH),
    fs.Scene((fs.Body("ball", 0.05, -1.0),), (fs.Contact("hit", "ball", fs.GROUND, fs.Hertz(1e8)),)),
    fs.Walk(80.0, 2.0, 8, (0.4, 0.1)),
    fs.InitialMotion(((MIDDLE, 0.1),)),
    fs.PlannedContact("stop", ("middle", "damper"), fs.Linear(1e6)),
    fs.PlannedLink("hanger", ("damper", "slab"), 507.0),
    fs.PlannedLoad("kick", MIDDLE, "point", PUSH),
    fs.PlannedWalk("neighbour", ("middle",), fs.Walk(80.0, 2.0, 8, (0.4,))),
    fs.Covering({500.0: 21.0}), fs.Repeat(10, 0.1),
    fs.RigidMotion("keel", (0.0, 0.0, -3.0), (0.0, 0.0, 0.0)),
    fs.AccuracyRule(0.01, (0.0, 500.0)),
    fs.Extent(up_to_hz=3000.0),
    fs.FrfRequest("middle", MIDDLE, MIDDLE, "mobility", (1.0, 500.0), 0.25),
    fs.Limit("ground force", 600e3),
    fs.PeakRule(),
    fs.Record("middle.z", "velocity"),
    fs.RoomPlan("box", Room([4.0, 3.5, 2.4]), "ceiling", (Receiver("bed", [1.0, 1.0, 0.5]),), levels=("rating",)),
    fs.TimePlan(2.0, 48e3),
    fs.BeamModel(1.0, ("pinned", "free"), 350.0, 1.57, 20, {"middle": 0.5}),
    fs.ModesModel((12.4, 31.0), (0.01, 0.02), {"head": (0.71, -0.33)}),
    fs.OscillatorModel(2.0, 10.0, None, {"top": 1.0}),
    fs.RodModel(1.0, 210e9, 7850.0, 1e-4, 50, {"tip": 0.0}),
    fs.Case("as given", STUDY),
    fs.Plan("a fall", (fs.Case("as given", STUDY),), "as given"),
    fs.Campaign("fall.study.yaml", (fs.Listed("bodies.ball.mass", ("1 kg", "2 kg")),)),
    fs.Listed("bodies.ball.mass", ("1 kg", "2 kg"), (1.0, 2.0), "kg"),
    fs.Sampling("sobol", 8),
    fs.Scattered("bodies.ball.mass", "uniform", 1.0, 2.0, "kg"),
    fs.Goal("ball peak force"),
    fs.MeasuredFiles("force.csv", "ball on ground force", modes=("floor.csv +- 1 %",)),
    fs.Search("fall.study.yaml", "ball peak force", (fs.Scattered("bodies.ball.mass", "uniform", 1.0, 2.0, "kg"),)),
]  # fmt: skip
# made by functions, of what has been compared; or with nothing to compare; or checked by a contract of its own
MADE = {
    "Assembly",
    "AtRest",
    "Batch",
    "ComplexModes",
    "Component",
    "DofMap",
    "Finding",
    "Found",
    "Front",
    "FrfTable",
    "Identification",
    "PlacedCavity",
    "ImportedMesh",
    "MeasuredFrf",
    "MeasuredHistory",
    "MeasuredModes",
    "MeasuredPlace",
    "Measurement",
    "ModalBasis",
    "Model",
    "Placed",
    "PlateSection",
    "SectionShare",
    "Probe",
    "Reduced",
    "Response",
    "Surface",
    "Swept",
}
OTHERS = {"StudyResult", "FromMaterials", "NoStructure", "OwnLaw", "ForceSource"}

NUMBERS = st.one_of(
    st.integers(-3, 3), st.floats(), st.sampled_from([10**400, True, 1j, np.float32(0.5), np.int64(2), np.bool_(True)])
)
WORDS = st.sampled_from(["", "0", "8 mm", "x", "all", "simple", "z", b"x", "\N{SNOWMAN}", "a" * 500])
ODD = st.sampled_from([None, object(), float, len, {}, set(), {"x": "y"}, {1: 2.0}, range(3), STEEL, PLATE, BALL])
ARRAYS = st.sampled_from([np.zeros(3), np.zeros((2, 2)), np.zeros(0), np.array("x"), np.array(1.0), np.ones(2) * 1j])
LEAVES = NUMBERS | WORDS | ODD | ARRAYS
ANYTHING = st.recursive(LEAVES, lambda one: st.lists(one, max_size=4) | st.lists(one, max_size=4).map(tuple))


def test_every_noun_that_is_exported_is_here() -> None:
    nouns = {one for one in fs.__all__ if isinstance(getattr(fs, one), type) and is_dataclass(getattr(fs, one))}
    assert {type(noun).__name__ for noun in NOUNS} == nouns - MADE - OTHERS


@pytest.mark.parametrize("noun", NOUNS, ids=lambda noun: type(noun).__name__)
@settings(max_examples=60, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_a_field_of_anything(noun: Any, data: st.DataObject) -> None:
    field = data.draw(st.sampled_from([one.name for one in fields(noun)]))
    value = data.draw(ANYTHING)
    try:
        replace(noun, **{field: value})
    except FemstructError as error:
        assert isinstance(error, InputError), error
        assert error.got and error.expected


@pytest.mark.parametrize("noun", NOUNS, ids=lambda noun: type(noun).__name__)
@settings(max_examples=15, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_all_fields_of_anything(noun: Any, data: st.DataObject) -> None:
    try:
        type(noun)(**{field.name: data.draw(ANYTHING) for field in fields(noun)})
    except InputError as error:
        assert error.got and error.expected
