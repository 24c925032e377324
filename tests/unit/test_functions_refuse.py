"""Functions that get the noun before or after the one they need, words for numbers, or arrays that mean nothing: what
was got, what was expected and what makes one, in place of an error from deep below."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import femstruct as fs
from acoustics.errors import AcousticsError
from acoustics.fields.rectangular import Room
from femstruct.conventions import UZ
from femstruct.errors import FemstructError, InputError

STEEL = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0)
PLATE = fs.Plate("p", STEEL, 3e-3, (0, 0, 0), size=(0.5, 0.4), mesh=0.1)
STRUCTURE = fs.Structure("s", (PLATE,), points=(fs.PlaceOn("m", "p", at=((0.2, 0.2),)),))
MODEL = fs.mesh_structure(STRUCTURE)
ASSEMBLY = fs.assemble(MODEL)
BASIS, POINTS = fs.oscillator(1.0, frequency_hz=10.0, axis="z")
CAMPAIGN = fs.Campaign("hit.study.yaml", (fs.Listed("bodies.ball.mass", ("1 kg", "2 kg")),))
HERE = POINTS["m"].probe("z")
CLOCK = fs.Clock(0.01, 1e4)
ANY: Any = fs  # of wrong arguments on purpose


def given(**changed: Any) -> fs.Assembly:
    usual = {"M": np.eye(2), "K": np.eye(2), "nodes": [0, 1], "components": [UZ, UZ], "points": np.eye(2, 3)}
    return fs.given_matrices(**(usual | changed))


def spring_of(force: int, energy: int) -> fs.OwnLaw:
    """A linear law whose functions read these of its one parameter."""
    return fs.OwnLaw(lambda d, _, p: p[force] * d, lambda d, p: p[energy] * d * d / 2.0, [1e4], 0.01, 1.0)


@pytest.mark.parametrize(
    ("call", "told"),
    [
        (lambda: ANY.mesh_structure(PLATE), r"mesh_structure: got Plate.*expected a Structure; Structure\("),
        (lambda: ANY.assemble(STRUCTURE), r"assemble: got Structure.*expected a Model; mesh_structure makes one"),
        (lambda: ANY.modal_basis(MODEL, count=3), r"modal_basis: got Model.*expected an Assembly; assemble makes one"),
        (
            lambda: ANY.modal_basis(ASSEMBLY, up_to="100 Hz"),
            r"modes up_to: got '100 Hz', expected a number or None; write a number in SI units: 100$",
        ),
        (lambda: ANY.modal_basis(ASSEMBLY, count=2.5), r"modes count: got 2\.5, expected a whole number or None$"),
        (lambda: ANY.modal_basis(ASSEMBLY, count=3, probes=["m.z"]), r"modes probes: .*model\.points\[.*\]\.probe"),
        (lambda: ANY.modal_basis(ASSEMBLY, count=3, probes=HERE), r"modes probes: .*\(Probe\(\.\.\.\),\) for one"),
        (lambda: ANY.modal_basis(ASSEMBLY, count=3, base="w"), r"modes base: got 'w', expected axes of x, y, z$"),
        (lambda: ANY.with_damping(ASSEMBLY, fs.Damping()), r"with_damping basis: .*expected a ModalBasis; modal_basis"),
        (lambda: ANY.with_damping(BASIS, 0.02), r"with_damping damping: got 0\.02.*Damping\(Ratio\(0\.02\)\)"),
        (lambda: ANY.complex_modes(MODEL, fs.Damping(), 9.0), r"complex_modes: .*expected an Assembly"),
        (lambda: ANY.complex_modes(ASSEMBLY, fs.Ratio(0.02), 9.0), r"complex_modes damping: .*expected a Damping"),
        (lambda: ANY.complex_modes(ASSEMBLY, fs.Damping(), "9 Hz"), r"complex_modes up_to: got '9 Hz'.*units: 9$"),
        # a point, or its name, was "receptance of a force"
        (lambda: ANY.frf(BASIS, "m.z", "m.z", [1.0]), r"frf drive: got 'm\.z', expected a Probe; model\.points"),
        (lambda: ANY.frf(BASIS, HERE, POINTS["m"], [1.0]), r"frf response: got Point.*a Probe or a ForceRow"),
        (lambda: ANY.frf(ASSEMBLY, HERE, HERE, [1.0]), r"frf basis: .*expected a ModalBasis"),
        (lambda: ANY.frf(BASIS, HERE, HERE, ["1 Hz"]), r"frf frequency: got .*1 Hz.*expected real numbers"),
        (lambda: ANY.frf(BASIS, HERE, HERE, [1j]), r"frf frequency: got .*expected real numbers"),
        (lambda: ANY.frf_table(BASIS, [HERE], {"m": HERE}, [1.0]), r"frf drives: .*a mapping of Probe by text"),
        (lambda: ANY.frf_table(BASIS, {"m": HERE}, {"m": "m.z"}, [1.0]), r"frf responses: .*mapping of Probe or Force"),
        (lambda: ANY.frf_table(BASIS, {"m": HERE}, {"m": HERE}, ["1 Hz"]), r"frf frequency: .*expected real numbers"),
        (lambda: ANY.simulate(ASSEMBLY, fs.Scene(), CLOCK), r"simulate basis: .*expected a ModalBasis; modal_basis"),
        (lambda: ANY.simulate(BASIS, None, CLOCK), r"simulate scene: got None, expected a Scene; Scene\("),
        (lambda: ANY.simulate(BASIS, fs.Scene(), (0.01, 1e4)), r"simulate clock: got \(.*expected a Clock; Clock\("),
        (lambda: ANY.run_study("hit.study.yaml"), r"run_study: got 'hit.*expected a Plan; .*read_study\(PATH\)"),
        (lambda: ANY.sweep("hit.study.yaml"), r"sweep: got 'hit.*expected a Campaign; read_campaign\(PATH\)"),
        (lambda: ANY.optimise("hit.study.yaml"), r"optimise: got 'hit.*expected a Search; read_search\(PATH\)"),
        (lambda: ANY.pareto_front("hit.study.yaml"), r"pareto_front: got 'hit.*expected a Search; read_search"),
        (lambda: ANY.placed("room", None), r"rooms\.room: got 'room', expected a SoundField; acoustics\.Room"),
        (lambda: ANY.placed(Room([4, 3, 2]), "ceiling"), r"rooms\.room surface: got 'ceiling'.*model\.surfaces"),
        (lambda: ANY.surface_velocity(None, None), r"surface_velocity response: got None.*simulate makes one"),
        (
            lambda: ANY.oscillator("1 kg", stiffness=1.0),
            r"oscillator\.mass: got '1 kg', expected a number; .*units: 1$",
        ),
        (lambda: ANY.oscillator(1.0, frequency_hz="9 Hz"), r"oscillator\.frequency: got '9 Hz'.*units: 9$"),
        (lambda: ANY.oscillator(1.0, stiffness=1.0, axis="w"), r"oscillator\.axis: got 'w', expected x or y or z$"),
        (lambda: ANY.rod("2 m", 1.0, 1.0, 1.0, modes=3), r"got '2 m', expected a number; .*units: 2$"),
        # imaginary parts, halves of node numbers and a loss factor of nan were dropped or kept without a word
        (lambda: given(M=np.eye(2) * (1 + 1j)), r"given matrices M: got entries of type complex128.*real numbers"),
        (lambda: given(K=[["a"]]), r"given matrices K: got .*expected a matrix of real numbers"),
        (lambda: given(C="x"), r"given matrices C: got .*expected a matrix of real numbers"),
        (lambda: given(nodes=[0.5, 1]), r"given matrices nodes: got \[0\.5, 1\], expected whole numbers$"),
        (lambda: given(loss_factor=np.nan), r"given matrices loss_factor: got nan, expected a number$"),
        (lambda: given(loss_factor=-0.1), r"given matrices loss_factor: got -0\.1, expected a value >= 0$"),
        (lambda: ANY.sweep(CAMPAIGN, workers="2"), r"sweep workers: got '2', expected a whole number from 1 or None"),
        (lambda: ANY.sweep(CAMPAIGN, workers=-1), r"sweep workers: got -1, expected a whole number from 1 or None$"),
        # each letter of one text was taken for a range
        (
            lambda: ANY.read_campaign("s.yaml", vary="a.b=1,2"),
            r"read_campaign vary: got 'a\.b=1,2', expected a tuple of",
        ),
        (lambda: ANY.read_search("s.yaml", limits="a=1"), r"read_search limits: got 'a=1', expected a tuple of texts$"),
        (lambda: ANY.identify("s.yaml", "v.csv", "c", "a=1"), r"identify parameters: got 'a=1', expected a tuple of"),
        (lambda: ANY.write_results("r.h5", None), r"write_results: got None, expected a StudyResult; run_study makes"),
        # the memory behind the parameters was read
        (
            lambda: fs.OwnLaw(lambda d, r, p: p[3] * d, lambda d, p: p[0] * d * d / 2, [1e4], 0.01, 1.0),
            r"own law force: got a parameter beyond the last, expected p\[0\] to p\[0\]",
        ),
        (
            lambda: fs.OwnLaw(lambda d, r, p: p[0] * d, lambda d, p: p[1] * d * d / 2, [1e4], 0.01, 1.0),
            r"own law energy: got a parameter beyond the last",
        ),
        (lambda: fs.Scene(velocity=[np.nan]), r"scene\.velocity: got nan or infinity, expected finite numbers$"),  # type: ignore[arg-type]
    ],
)
def test_a_wrong_argument_is_refused_where_it_is_given(call: Callable[[], object], told: str) -> None:
    with pytest.raises(InputError, match=told):
        call()


def test_a_contact_with_the_name_of_a_place() -> None:
    hit = fs.Contact("hit", "ball", "m.z", fs.Linear(1e5))
    with pytest.raises(FemstructError, match=r"contacts\.hit: got 'm\.z', expected a body: ball; a place .* a Probe"):
        fs.simulate(BASIS, fs.Scene((fs.Body("ball", 1.0, -1.0),), (hit,)), CLOCK)


def test_a_probe_of_another_structure() -> None:
    with pytest.raises(FemstructError, match=r"probe: got node 9, expected nodes 0 to 0; take a probe of"):
        fs.frf(BASIS, fs.Probe([9], [UZ], [1.0]), HERE, [1.0])


def test_words_for_the_size_of_a_room() -> None:
    with pytest.raises(AcousticsError, match=r"room\.size: got \['4 m', 3, 2\], expected real numbers"):
        Room(["4 m", 3, 2])  # type: ignore[list-item]


def test_sizes_that_are_complex() -> None:
    with pytest.raises(AcousticsError, match=r"room\.size: got array\(.*expected real numbers"):
        Room(np.array([4.0, 3.0, 2.0 + 1j]))


def test_initial_velocities_of_a_scene_do_not_follow_the_array_they_came_from() -> None:
    velocity = np.array([1.0])
    scene = fs.Scene(velocity=velocity)
    velocity[:] = 8.0
    assert scene.velocity is not None and scene.velocity.tolist() == [1.0]


def test_lists_of_probes_and_whole_numbers_as_floats_are_taken() -> None:
    middle = MODEL.points["m"].probe("z")
    basis = fs.modal_basis(ASSEMBLY, up_to=np.float64(20.0), probes=[middle])
    assert "residual" in basis.kind
    assert given(nodes=[0.0, 1.0]).dofs.labels == ("node 0 UZ", "node 1 UZ")
