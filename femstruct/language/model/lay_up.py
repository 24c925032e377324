"""Layers and smeared ribs of plates and shells as they are written."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any

from pydantic import Field

from femstruct.errors import shown_as
from femstruct.language.model.material import PlateLosses
from femstruct.language.parts.part import MaterialName
from femstruct.language.yaml import Length, Quantity, Spec, read_by, refuse
from femstruct.model.materials.lay_up import Laminate, Layer, LayUp, Smeared
from femstruct.model.materials.orthotropic import AnyMaterial

_ANGLE = Quantity(("angle",))
Bending = Annotated[float, Quantity(("moment",), least=0.0)]
Rigidity = Annotated[float, Quantity(("stiffness",), least=0.0)]


def _angle(value: object) -> object:
    """An angle with its unit: 90 without one is far more likely in degrees than in radians."""
    if isinstance(value, int | float) and not isinstance(value, bool) and value != 0:
        raise refuse(shown_as(value), "an angle with its unit", f"write {value:g} deg")
    return _ANGLE.read(value)


def _layer(value: object) -> object:
    """A layer with its angle, which may be left out."""
    if not (isinstance(value, list) and len(value) in (2, 3)):
        got = f"{len(value)} value{'s' if len(value) != 1 else ''}" if isinstance(value, list) else shown_as(value)
        raise refuse(got, "[material, thickness, angle]", "the angle may be left out: [spruce, 40 mm]")
    return value if len(value) == 3 else [*value, 0]


Written = tuple[MaterialName, Length, Annotated[float, read_by(_angle, Annotated[float, _ANGLE])]]
Layers = Annotated[list[Annotated[Written, read_by(_layer, list[Any])]], Field(min_length=1)]
"""[material, thickness, angle] of every layer, from the lower face up; angle: from the part's x to the material's."""


class SmearedSpec(Spec):
    """Ribs, hollows or corrugations by the rigidities of the deck per width along x and y: D: [Dx, Dy, D12, D66] of
    bending, S: [Sx, Sy] of transverse shear, A: [Ax, Ay, A12, A66] of the membrane, mass per area."""

    makes = Smeared
    D: tuple[Bending, Bending, Bending, Bending]
    S: tuple[Rigidity, Rigidity]
    mass: Annotated[float, Quantity(("mass/area",), above=0.0)]
    A: tuple[Rigidity, Rigidity, Rigidity, Rigidity] | None = None
    loss_factor: PlateLosses = 0.0


def lay_up(
    layers: Sequence[tuple[str, float, float]] | None,
    smeared: SmearedSpec | None,
    thickness: float | None,
    materials: Mapping[str, AnyMaterial],
) -> LayUp:
    """The noun of what is written: of layers, or of smeared ribs with the thickness from face to face [m]."""
    if smeared is not None:
        deck = smeared.noun(thickness=thickness)
        assert isinstance(deck, Smeared)
        return deck
    return Laminate(tuple(Layer(materials[name], each, angle) for name, each, angle in layers or ()))
