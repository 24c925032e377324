"""What Python alone would let pass and mean something else: words, flat tuples, numbers in place of nouns."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import femstruct
from femstruct.errors import FemstructError, InputError
from femstruct.impact.scene import GROUND, Body, Contact, Scene
from femstruct.laws.linear import Linear
from femstruct.model.materials import Material
from femstruct.model.structure import PlaceOn, Support, SurfaceOn
from femstruct.parts.plate import Plate

MIDDLE = femstruct.Spot("middle", "z")
STEEL = Material("steel", E=210e9, nu=0.3, rho=7850.0)


def plate(**changed: Any) -> Plate:
    usual = {"name": "p", "material": STEEL, "thickness": 3e-3, "origin": (0, 0, 0), "size": (1, 1), "mesh": 0.1}
    return Plate(**(usual | changed))  # type: ignore[arg-type]


def study(**changed: Any) -> femstruct.Study:
    usual = {
        "title": "s",
        "structure": femstruct.NoStructure(),
        "damping": femstruct.Damping(),
        "extent": femstruct.Extent(),
    }
    return femstruct.Study(**(usual | changed))


class OwnLaw:
    def force(self, indentation: float) -> float:
        return 1e5 * indentation


@pytest.mark.parametrize(
    ("make", "told"),
    [
        # an edge held by 'simpel', or by a list of directions, was clamped without a word
        (
            lambda: Support("e", "simpel", on="p", edge="all"),
            r"supports\.e\.fix: got 'simpel', expected simple, roller, clamped",
        ),
        (lambda: Support("e", 2, on="p", edge="all"), r"supports\.e\.fix: got 2, expected .*tuple of x, y"),
        (lambda: Support("e", ("w",), on="p", edge="all"), r"supports\.e\.fix: got \('w',\)"),
        (lambda: Support("e", (), on="p", edge="all"), r"supports\.e\.fix: got \(\)"),
        (lambda: Support("e", "simple", on="p", edge="left"), r"supports\.e\.edge: got 'left', expected x0 or x1"),
        (lambda: PlaceOn("c", "p", (0.2, 0.1)), r"points\.c\.at: got \(0\.2, 0\.1\), expected a tuple of places"),
        (lambda: PlaceOn("c", "p", ()), r"points\.c\.at: got \(\)"),
        (lambda: PlaceOn("c", "p", ((0.2, 0.1),), side="top"), r"points\.c\.side: got 'top', expected above or below"),
        (lambda: SurfaceOn("s", "p", side="top"), r"surfaces\.s\.side: got 'top'"),
        # a wrong shape or a text was found by numpy, later, without the name of the field
        (lambda: plate(size=(1.0,)), r"parts\.p\.size: got \(1\.0,\), expected a tuple of 2 numbers$"),
        (lambda: plate(origin="0"), r"parts\.p\.origin: got '0', expected a tuple of 3 numbers$"),
        (lambda: plate(mesh=(3.5, 2)), r"parts\.p\.mesh: got \(3\.5, 2\), expected .* 2 divisions"),
        (
            lambda: plate(thickness="8 mm"),
            r"parts\.p\.thickness: got '8 mm', expected a number; write a number in SI units: 0\.008$",
        ),
        (lambda: plate(thickness=float("nan")), r"parts\.p\.thickness: got nan, expected a number$"),
        (lambda: plate(element="bfs17"), r"parts\.p\.element: got 'bfs17', expected hermite12 or acm12 or bfs16$"),
        (
            lambda: femstruct.Spring("s", "feet", None, (1.0, 2.0, 3.0)),
            r"parts\.s\.stiffness: .* a tuple of 6 numbers$",
        ),
        (lambda: femstruct.Inertia("m", "hub", 1.0, (1.0, 1.0)), r"parts\.m\.moments: .* a tuple of 3 numbers$"),
        (lambda: femstruct.Mass(5, 1.0), r"parts\.name: got 5, expected a text$"),
        (lambda: femstruct.Extent(count=2.5), r"modes\.count: got 2\.5, expected a whole number or None$"),
        (lambda: femstruct.Repeat(alone=1), r"repeat\.alone: got 1, expected True or False$"),
        (lambda: femstruct.Record("middle.z", "velocty"), r"record\.what: got 'velocty', expected displacement or"),
        (
            lambda: femstruct.PlannedContact("c", ("a", "b"), law="hertz"),  # of a law that is imported when it is used
            r"contacts\.c\.law: got 'hertz', expected a Law$",
        ),
        (lambda: femstruct.Table("x", [0.0]), r"table\.times: got 'x', expected an array of numbers$"),
        (
            lambda: study(bodies="ball"),
            r"study\.bodies: got 'ball', expected a tuple of PlacedBody, \(PlacedBody\(\.\.\.\),\)",
        ),
        (lambda: plate(material="steel"), r"parts\.p\.material: got 'steel', expected a Material"),
        (lambda: plate(mesh=[4]), r"parts\.p\.mesh: got \[4\], expected an element side in m, or a tuple of 2"),
        # a damping of 0.02 was none at all
        (lambda: femstruct.Damping(0.02), r"damping\.base: got 0\.02, expected Ratio, LossFactor.*; Ratio\(0\.02\)\?"),
        (lambda: study(damping=femstruct.Ratio(0.01)), r"study\.damping: got Ratio\(value=0\.01\), expected a Damping"),
        (lambda: study(structure="floor.yaml"), r"study\.structure: got 'floor\.yaml', expected a Structure or an Osc"),
        (lambda: Contact("hit", "b", GROUND, OwnLaw()), r"contacts\.hit\.law: got a OwnLaw, expected .*; .*Tabulated"),
        (
            lambda: Scene(Body("b", 1.0)),
            r"scene\.bodies: got Body.*, expected a tuple of Body, ",
        ),
        (lambda: Scene((), (Body("b", 1.0),)), r"scene\.contacts: got .*expected a tuple of Contact"),
    ],
)
def test_refused(make: Callable[[], object], told: str) -> None:
    with pytest.raises(FemstructError, match=told):
        make()


def test_lists_and_arrays_are_tuples() -> None:
    made = plate(size=[1.0, 2.0], origin=np.zeros(3), mesh=[4, 5])
    assert (made.size, made.origin, made.mesh) == ((1.0, 2.0), (0.0, 0.0, 0.0), (4, 5))
    assert made == plate(size=(1.0, 2.0), origin=(0.0, 0.0, 0.0), mesh=(4, 5))
    assert Support("e", ["z"], on="p", edge="all").fix == ("z",)  # type: ignore[arg-type]
    places = PlaceOn("c", "p", np.array([[0.2, 0.1], [0.3, 0.1]]))  # type: ignore[arg-type]
    assert places.at == ((0.2, 0.1), (0.3, 0.1))


def test_what_fits_is_kept_as_it_is() -> None:
    size, law = (1.0, 2.0), Linear(1e4)
    assert plate(size=size).size is size
    assert Contact("w", "b", GROUND, law).law is law


def test_lists_of_a_scene_are_tuples() -> None:
    scene = Scene([Body("b", 1.0)], [Contact("w", "b", GROUND, Linear(1e4))])  # type: ignore[arg-type]
    assert isinstance(scene.bodies, tuple) and isinstance(scene.contacts, tuple)


def test_a_model_is_written_in_python_with_exported_names_alone() -> None:
    for name in ("Material", "Plate", "Frame", "Support", "Joint", "PlaceOn", "SurfaceOn", "Ratio", "LossFactor"):
        assert hasattr(femstruct, name)


# made by a run, or constants and errors
NOT_MADE_BY_HAND = {
    "Assembly",
    "Batch",
    "Finding",
    "GROUND",
    "Identification",
    "InputError",
    "StudyResult",
    "Swept",
    "Found",
    "Front",
}
READ_WHERE_WRITTEN = {"read_results", "read_swept", "read_found"}


@pytest.mark.parametrize("name", sorted({*femstruct.__all__} - NOT_MADE_BY_HAND - READ_WHERE_WRITTEN))
def test_what_is_exported_has_an_example(name: str) -> None:
    """Examples run with the tests of their module."""
    assert ">>>" in (getattr(femstruct, name).__doc__ or "")


@pytest.mark.parametrize(
    ("make", "told"),
    [
        # divisions by zero, negative windows and the errors of filters came later, without the name of the field
        (lambda: femstruct.TimePlan(1.0, 0.0), r"time\.sampling: got 0\.0, expected a positive number$"),
        (lambda: femstruct.TimePlan(-1.0, 1e3), r"time\.duration: got -1\.0, expected a positive number$"),
        (lambda: femstruct.TimePlan(1.0, 1e3, quiet=-1.0), r"time\.quiet: got -1\.0, expected a number >= 0$"),
        (
            lambda: femstruct.PeakRule(lowpass_hz=0.0),
            r"peaks\.lowpass_hz: got 0\.0, expected a positive number or",
        ),
        (lambda: femstruct.Repeat(count=0), r"repeat\.count: got 0, expected a whole number from 1$"),
        (lambda: femstruct.HalfSine(1.0, 0.0), r"half sine\.frequency: got 0\.0, expected a positive number$"),
        (
            lambda: femstruct.AccuracyRule(0.01, (500.0, 0.0)),
            r"accuracy\.band: got 500 to 0 Hz, expected a rising",
        ),
        (
            lambda: femstruct.FrfRequest("f", MIDDLE, MIDDLE, "mobility", (1.0, 500.0), step=0.0),
            r"frf\.f\.step: got 0\.0, expected a positive number$",
        ),
        (
            lambda: femstruct.FrfRequest("f", MIDDLE, MIDDLE, "mobility", (500.0, 1.0), step=1.0),
            r"frf\.f\.band: got 500 to 1 Hz, expected a rising band \(low, high\)$",
        ),
        (
            lambda: study(time=femstruct.TimePlan(1.0, 1e3), peaks=femstruct.PeakRule(lowpass_hz=600.0)),
            r"study\.peaks\.lowpass_hz: got 600 Hz, expected less than half the sampling, 500 Hz$",
        ),
    ],
)
def test_numbers_without_a_meaning_are_refused(make: Callable[[], object], told: str) -> None:
    with pytest.raises(InputError, match=told):
        make()


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        (
            {"limits": (femstruct.Limit("nix", 1.0),)},
            r"limits\.nix: got 'nix', expected a recorded channel or settled",
        ),
        (
            {"limits": (femstruct.Limit("nix rating", 50.0, room="nix"),)},
            r"limits\.nix rating: got 'nix', .* room$",
        ),
        (
            {"loads": (femstruct.PlannedLoad("kick", "nix", "surface", femstruct.HalfSine(1.0, 50.0)),)},
            r"loads\.kick\.on: got 'nix', expected a surface",
        ),
    ],
)
def test_names_of_nothing_are_refused_by_a_run(changed: dict[str, Any], told: str) -> None:
    spring = femstruct.OscillatorModel(1.0, 10.0, None, {"middle": 0.0})
    ball = femstruct.PlacedBody("ball", 0.1, "above", "middle", speed=1.0, law=Linear(1e5))
    usual = {"structure": spring, "bodies": (ball,), "time": femstruct.TimePlan(2e-3, 1e4)}
    plan = femstruct.Plan("p", (femstruct.Case("c", study(**(usual | changed))),), "c")
    with pytest.raises(InputError, match=told):
        femstruct.run_study(plan)
