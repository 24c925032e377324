"""Layers and smeared ribs of plates and shells as they are written."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import radians
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Discriminator, Field, Tag

from femstruct.errors import shown_as
from femstruct.language.model.like import entry_for, told_of
from femstruct.language.model.material import PlateLosses
from femstruct.language.parts.part import Library, MaterialName, PartSpec
from femstruct.language.yaml import Here, Length, Quantity, Spec, Text, read_by, refuse
from femstruct.language.yaml.discovery import union_of
from femstruct.model.library.all_entries import library
from femstruct.model.library.library_entry import Use
from femstruct.model.materials.lay_up import Laminate, Layer, LayUp, Smeared
from femstruct.model.materials.orthotropic import AnyMaterial
from femstruct.model.part import Part

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


def _some(value: object) -> object:
    """One layer or more."""
    if not isinstance(value, list) or not value:
        got = "no layer" if value == [] else shown_as(value)
        raise refuse(got, "layers [material, thickness, angle], or a lay-up", "write [[spruce, 40 mm], ..]")
    return value


class LaidSpec(Spec):
    """The layers of a lay-up of the library, of one material whose grain runs along x in the lowest."""

    like: Annotated[Text, entry_for(Use.LAY_UP, "a lay-up of the library", "CLT")]
    of: MaterialName


if TYPE_CHECKING:
    _Listed = list[Written]
else:
    _Listed = Annotated[
        list[Annotated[Written, read_by(_layer, list[Any])]], read_by(_some, list[Any]), Field(min_length=1)
    ]


class BoardsSpec(Spec):
    """Boards on each other, from the lowest: bond 0 % where they slip, each bending alone (two equal ones: 2 D), 100 %
    where they are glued (8 D); screwed ones lie between."""

    boards: _Listed
    bond: Annotated[float, Quantity(("ratio",), least=0.0, most=1.0)]


def _laid(value: Any) -> str:
    if isinstance(value, LaidSpec | BoardsSpec):
        return type(value).__name__
    if isinstance(value, dict):
        return (BoardsSpec if {"boards", "bond"} & value.keys() else LaidSpec).__name__
    return "list"


if TYPE_CHECKING:
    Layers = list[Written] | LaidSpec | BoardsSpec
else:
    _Kinds = (LaidSpec, BoardsSpec)
    _Tagged = (Annotated[_Listed, Tag("list")], *(Annotated[kind, Tag(kind.__name__)] for kind in _Kinds))
    Layers = Annotated[union_of(_Tagged), Discriminator(_laid)]
    """[material, thickness, angle] of every layer, from the lower face up, a lay-up of the library, or boards with
    their bond; angle: from the part's x to the material's."""


class SmearedSpec(Spec):
    """Ribs, hollows or corrugations by the rigidities of the deck per width along x and y: D: [Dx, Dy, D12, D66] of
    bending, S: [Sx, Sy] of transverse shear, A: [Ax, Ay, A12, A66] of the membrane, mass per area."""

    makes = Smeared
    D: tuple[Bending, Bending, Bending, Bending]
    S: tuple[Rigidity, Rigidity]
    mass: Annotated[float, Quantity(("mass/area",), above=0.0)]
    A: tuple[Rigidity, Rigidity, Rigidity, Rigidity] | None = None
    loss_factor: PlateLosses = 0.0


def laid_up(
    layers: Sequence[tuple[str, float, float]] | LaidSpec | BoardsSpec, materials: Mapping[str, AnyMaterial]
) -> Laminate:
    """The noun of the layers that are written."""
    if isinstance(layers, LaidSpec):
        entry = library()[layers.like]
        laid = tuple(Layer(materials[layers.of], each, radians(angle)) for each, angle in entry.layers)
        return Laminate(laid, told_of(layers.like))
    written, bond = (layers.boards, layers.bond) if isinstance(layers, BoardsSpec) else (layers, 1.0)
    return Laminate(tuple(Layer(materials[name], each, angle) for name, each, angle in written), bond=bond)


class DeckSpec(PartSpec):
    """A plate or slab of one material, of layers from below, or of smeared ribs."""

    one_of = (("material", "layers", "smeared"),)
    at_most_one_of = (("layers", "thickness"),)
    only_written = ("material", "layers", "smeared", "thickness")

    material: MaterialName | None = None
    layers: Layers | None = None
    smeared: SmearedSpec | None = None
    thickness: Length | None = None

    def check(self, here: Here) -> None:
        there = here.at("thickness")
        there.need(self.layers or self.thickness, "nothing", "'thickness'", "add 'thickness: ...'", of_key=True)

    def made_of(self, name: str, of: Library, **more: Any) -> Part:
        if self.material is not None:
            return super().made_of(name, of, thickness=self.thickness, **more)
        smeared: LayUp | None = self.smeared.noun(thickness=self.thickness) if self.smeared is not None else None
        deck = smeared or laid_up(self.layers or (), of.materials)
        return super().made_of(name, of, material=deck, thickness=deck.thickness, **more)
