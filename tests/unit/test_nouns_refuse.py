"""What Python alone would let pass and mean something else: words, flat tuples, numbers in place of nouns."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

import femstruct
from femstruct.errors import FemstructError
from femstruct.impact.laws.linear import Linear
from femstruct.impact.scene.bodies import GROUND, Body, Contact, Scene
from femstruct.model.material import Material
from femstruct.model.structure import PlaceOn, Support, SurfaceOn
from femstruct.parts.plate import Plate

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
            r"supports\.e\.fix: got 'simpel', expected simple, clamped",
        ),
        (lambda: Support("e", ["z"], on="p", edge="all"), r"supports\.e\.fix: got \['z'\], expected .*tuple of x, y"),
        (lambda: Support("e", ("w",), on="p", edge="all"), r"supports\.e\.fix: got \('w',\)"),
        (lambda: Support("e", (), on="p", edge="all"), r"supports\.e\.fix: got \(\)"),
        (lambda: Support("e", "simple", on="p", edge="left"), r"supports\.e\.edge: got 'left', expected x0 or x1"),
        (lambda: PlaceOn("c", "p", (0.2, 0.1)), r"points\.c\.at: got \(0\.2, 0\.1\), expected a tuple of places"),
        (lambda: PlaceOn("c", "p", ()), r"points\.c\.at: got \(\)"),
        (lambda: PlaceOn("c", "p", ((0.2, 0.1),), side="top"), r"points\.c\.side: got 'top', expected above or below"),
        (lambda: SurfaceOn("s", "p", side="top"), r"surfaces\.s\.side: got 'top'"),
        (lambda: plate(material="steel"), r"parts\.p\.material: got 'steel', expected a Material"),
        (lambda: plate(mesh=[4, 4]), r"parts\.p\.mesh: got \[4, 4\], expected a size or a tuple"),
        # a damping of 0.02 was none at all
        (lambda: femstruct.Damping(0.02), r"damping: got 0\.02, expected Ratio, LossFactor.*; Ratio\(0\.02\)\?"),
        (lambda: study(damping=femstruct.Ratio(0.01)), r"study\.damping: got Ratio\(value=0\.01\), expected Damping"),
        (lambda: study(structure="floor.yaml"), r"study\.structure: got 'floor\.yaml', expected Structure or Osc"),
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


def test_lists_of_a_scene_are_tuples() -> None:
    scene = Scene([Body("b", 1.0)], [Contact("w", "b", GROUND, Linear(1e4))])  # type: ignore[arg-type]
    assert isinstance(scene.bodies, tuple) and isinstance(scene.contacts, tuple)


def test_a_model_is_written_in_python_with_exported_names_alone() -> None:
    for name in ("Material", "Plate", "Frame", "Support", "Joint", "PlaceOn", "SurfaceOn", "Ratio", "LossFactor"):
        assert hasattr(femstruct, name)


# made by a run, or constants and errors
NOT_MADE_BY_HAND = {"Assembly", "Batch", "Finding", "GROUND", "Identification", "InputError", "StudyResult"}


@pytest.mark.parametrize("name", sorted({*femstruct.__all__} - NOT_MADE_BY_HAND - {"read_results"}))
def test_what_is_exported_has_an_example(name: str) -> None:
    """Examples run with the tests of their module."""
    assert ">>>" in (getattr(femstruct, name).__doc__ or "")
