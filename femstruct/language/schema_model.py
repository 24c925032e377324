"""The model file: what the structure is. Units become SI here; names are checked in `references`."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from femstruct.conventions import DIRECTIONS
from femstruct.language.directions import SixStiffnesses
from femstruct.language.materials import MaterialSpec, Modulus
from femstruct.language.parts import AnyPart
from femstruct.language.regions import Region, RegionSpec
from femstruct.language.sections import Area, SectionSpec
from femstruct.language.yaml.reader import nearest
from femstruct.language.yaml.spec import (
    Component,
    Coordinate,
    Count,
    Frequency,
    Length,
    LossFactor,
    MassKg,
    Position2,
    Quantity,
    Ratio,
    Spec,
    Text,
    only,
    read_by,
    refuse,
)
from femstruct.model.structure import Edge
from femstruct.units import QuantityError, quantity, shown_as


class JointSpec(Spec):
    """Where two parts touch they move together; directions with a stiffness are springs instead."""

    connect: tuple[Text, Text]
    kind: Literal["rigid", "pinned"] = "rigid"
    stiffness: SixStiffnesses = SixStiffnesses()


def coordinates(value: object) -> tuple[float, ...]:
    if not isinstance(value, list) or not 1 <= len(value) <= 3:
        raise refuse(shown_as(value), "a list of coordinates", "write center, [x, y] or [[x, y], [x, y]]")
    return tuple(Quantity(("length",)).read(one) for one in value)


_AT_WORDS = ("center", "top", "bottom")


def _places(value: object) -> object:
    """One place or several: a word, a position along a bar, [x, y], [x, y, z], or a list of positions."""
    if value in _AT_WORDS:
        return value
    if isinstance(value, list):
        if value and all(isinstance(one, list) for one in value):
            return tuple(coordinates(one) for one in value)
        return (coordinates(value),)
    try:
        return ((quantity(value, "length"),),)
    except QuantityError as error:
        raise refuse(error.got, "center, [x, y] or [[x, y], [x, y]]", nearest(str(value), _AT_WORDS)) from None


AtWord = Literal["center", "top", "bottom"]
_WrittenAt = AtWord | Coordinate | list[Coordinate] | list[list[Coordinate]]
At = Annotated[
    AtWord | tuple[tuple[float, ...], ...],
    read_by(_places, _WrittenAt),
]
Side = Literal["above", "below"]


def _patch(value: object) -> object:
    """The radius of a disc, or the two sides of a rectangle."""
    size = Quantity(("length",), above=0.0)
    if isinstance(value, list):
        if len(value) != 2:
            raise refuse(shown_as(value), "a radius, or two sides", "write it like 5 mm or [20 mm, 30 mm]")
        return tuple(size.read(one) for one in value)
    return size.read(value)


class PointSpec(Spec):
    """A named place; of a rod or beam a position along it, of an oscillator nothing. On a plate it may be a patch."""

    on: Text | None = None
    at: At | None = None
    side: Side = "above"
    patch: Annotated[float | tuple[float, float] | None, read_by(_patch, Length | list[Length])] = None


class SurfaceSpec(Spec):
    """A named side of a region of a plate."""

    on: Text
    side: Side = "above"
    region: Region = RegionSpec()


def _fix(value: object) -> object:
    if value in ("simple", "clamped"):
        return value
    if isinstance(value, list) and value:
        for one in value:
            only(DIRECTIONS)(one)
        return tuple(value)
    raise refuse(shown_as(value), "simple, clamped or a list of x, y, z, rx, ry, rz", "write it like [z, rx]")


_Directions = list[Literal["x", "y", "z", "rx", "ry", "rz"]]


class SupportSpec(Spec):
    """Held directions of an edge or line of a plate (a line: a wall under it), of a point, or of a whole part."""

    one_of = (("on", "at"),)
    at_most_one_of = (("edge", "line"),)

    fix: Annotated[
        Literal["simple", "clamped"] | tuple[str, ...],
        read_by(_fix, Literal["simple", "clamped"] | _Directions),
    ]
    on: Text | None = None
    edge: Edge | None = None
    line: tuple[Position2, Position2] | None = None
    at: Text | None = None


class RayleighSpec(Spec):
    """C = alpha M + beta K."""

    alpha: Annotated[float, Quantity(("rate",), least=0.0)] = 0.0
    beta: Annotated[float, Quantity(("time",), least=0.0)] = 0.0


class ModeDampingSpec(Spec):
    """The damping of one mode, and the frequency at which that mode is expected."""

    one_of = (("ratio", "loss_factor"),)

    ratio: Ratio | None = None
    loss_factor: LossFactor | None = None
    near: Frequency


class DampingSpec(Spec):
    """The structure's own damping: a general law and exceptions by mode number."""

    at_most_one_of = (("ratio", "loss_factor", "rayleigh", "from"),)

    ratio: Ratio | None = None
    loss_factor: LossFactor | None = None
    rayleigh: RayleighSpec | None = None
    source: Literal["materials"] | None = Field(default=None, alias="from")
    modes: dict[str, ModeDampingSpec] = Field(default_factory=dict)


class NoStructureSpec(Spec):
    """Only bodies and the ground."""

    type: Literal["none"]


class OscillatorSpec(Spec):
    """A mass on a spring, by its frequency or its stiffness."""

    one_of = (("frequency", "stiffness"),)

    type: Literal["oscillator"]
    mass: MassKg
    frequency: Frequency | None = None
    stiffness: Annotated[float, Quantity(("stiffness",), above=0.0)] | None = None


class RodSpec(Spec):
    """A free elastic rod along x."""

    type: Literal["rod"]
    length: Length
    E: Modulus
    rho: Annotated[float, Quantity(("density",), above=0.0)]
    area: Area
    modes: Count = 50


End = Literal["pinned", "free", "clamped"]


class BeamSpec(Spec):
    """A beam along x that deflects along z."""

    type: Literal["beam"]
    length: Length
    ends: tuple[End, End]
    EI: Annotated[float, Quantity(("bending stiffness",), above=0.0)]
    mass_per_length: Annotated[float, Quantity(("mass/length",), above=0.0)]
    modes: Count = 6


class GivenPointSpec(Spec):
    """A point of given modes: mass-normalised shapes [1/sqrt(kg)], and where it is along the axis they move along."""

    shape: list[Component]
    at: Coordinate | None = None


def _given_point(value: object) -> object:
    """The shapes alone, or with a position."""
    return {"shape": value} if isinstance(value, list) else value


GivenPoint = Annotated[GivenPointSpec, read_by(_given_point, list[Component] | GivenPointSpec)]


class GivenModesSpec(Spec):
    """Given modes: frequencies, damping ratios and mass-normalised shapes at points [1/sqrt(kg)]; a point that is above
    or below another says where, {shape: [..], at: 0.2 m}."""

    type: Literal["modes"]
    frequency: Annotated[list[Annotated[float, Quantity(("frequency",), least=0.0)]], Field(min_length=1)]
    ratio: list[Ratio] | None = None
    points: dict[str, GivenPoint]


def _structure(value: object) -> object:
    return {"type": "none"} if value == "none" else value


_Structures = Annotated[
    NoStructureSpec | OscillatorSpec | RodSpec | BeamSpec | GivenModesSpec, Field(discriminator="type")
]
StructureSpec = Annotated[_Structures, read_by(_structure, Literal["none"] | _Structures)]


class ModelSpec(Spec):
    """A model file: parts and what joins, holds and damps them, or one closed-form structure."""

    title: Text | None = None
    materials: dict[str, MaterialSpec] = Field(default_factory=dict)
    sections: dict[str, SectionSpec] = Field(default_factory=dict)
    parts: dict[str, AnyPart] = Field(default_factory=dict)
    joints: dict[str, JointSpec] = Field(default_factory=dict)
    points: dict[str, PointSpec] = Field(default_factory=dict)
    surfaces: dict[str, SurfaceSpec] = Field(default_factory=dict)
    supports: dict[str, SupportSpec] = Field(default_factory=dict)
    damping: DampingSpec = DampingSpec()
    structure: StructureSpec | None = None
