"""The model file: what the structure is. Units become SI here; names are checked in `references`."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag, model_validator

from femstruct.language.reader import nearest
from femstruct.language.spec import (
    AnyRatio,
    Component,
    Count,
    Direction3,
    Factor,
    Frequency,
    Length,
    LossFactor,
    MassKg,
    Measured,
    Position2,
    Position3,
    Quantity,
    Ratio,
    Spec,
    Text,
    exactly_one,
    only,
    refuse,
)
from femstruct.units import QuantityError, quantity, shown_as

Area = Annotated[float, Quantity(("area",), above=0.0)]
SecondMoment = Annotated[float, Quantity(("second moment",), above=0.0)]
Modulus = Annotated[float, Quantity(("pressure",), above=0.0)]
Density = Annotated[float, Quantity(("density",), least=0.0)]
Spread = Annotated[Measured, Quantity(("stiffness/area", "stiffness/length"), least=0.0, which=True)]
AnyMass = Annotated[Measured, Quantity(("mass", "mass/length", "mass/area"), above=0.0, which=True)]
Stiffness = Annotated[float, Quantity(("stiffness",), least=0.0)]
RotationalStiffness = Annotated[float, Quantity(("rotational stiffness",), least=0.0)]
Dashpot = Annotated[float, Quantity(("damping",), least=0.0)]
RotationalDashpot = Annotated[float, Quantity(("rotational damping",), least=0.0)]
DIRECTIONS = ("x", "y", "z", "rx", "ry", "rz")


class MaterialSpec(Spec):
    """A linear elastic isotropic material."""

    E: Modulus
    nu: AnyRatio
    rho: Density
    loss_factor: LossFactor = 0.0


class RectangleSpec(Spec):
    """A solid rectangle: width along local y, height along local z."""

    shape: Literal["rectangle"]
    width: Length
    height: Length


class CircleSpec(Spec):
    """A solid circle."""

    shape: Literal["circle"]
    diameter: Length


class TubeSpec(Spec):
    """A round tube of an outer diameter and a wall thickness."""

    shape: Literal["tube"]
    diameter: Length
    thickness: Length


class BoxSpec(Spec):
    """A rectangular box of even wall thickness; outer sides."""

    shape: Literal["box"]
    width: Length
    height: Length
    thickness: Length


class ISpec(Spec):
    """An I: flanges along local y, web along local z; thicknesses of web and flange."""

    shape: Literal["I"]
    width: Length
    height: Length
    web: Length
    flange: Length


class ConstantsSpec(Spec):
    """A cross-section by its constants; shear coefficients 5/6 unless given."""

    A: Area
    Iy: SecondMoment
    Iz: SecondMoment
    J: SecondMoment
    ky: Factor = 5.0 / 6.0
    kz: Factor = 5.0 / 6.0


def _shape(value: Any) -> Any:
    return value.get("shape", "given") if isinstance(value, dict) else "given"


SectionSpec = Annotated[
    Annotated[RectangleSpec, Tag("rectangle")]
    | Annotated[CircleSpec, Tag("circle")]
    | Annotated[TubeSpec, Tag("tube")]
    | Annotated[BoxSpec, Tag("box")]
    | Annotated[ISpec, Tag("I")]
    | Annotated[ConstantsSpec, Tag("given")],
    Discriminator(_shape),
]


def _mesh(value: object) -> object:
    """A largest element side, or the least numbers of divisions."""
    if isinstance(value, list):
        if len(value) == 2 and all(isinstance(n, int) and not isinstance(n, bool) and 0 < n <= 2000 for n in value):
            return (value[0], value[1])
        raise refuse(shown_as(value), "two whole numbers of divisions from 1 to 2000", "write [16, 16] or 30 mm")
    return Quantity(("length",), above=0.0).read(value)


Mesh = Annotated[float | tuple[int, int], BeforeValidator(_mesh)]


class RegionSpec(Spec):
    """A region of a plate: nothing for all of it, the rim of a rectangle, a rectangle, or a line."""

    rim: tuple[Length, Length] | None = None
    rectangle: tuple[Length, Length] | None = None
    line: tuple[Position2, Position2] | None = None
    at: Position2 | None = None


def _region(value: object) -> object:
    if value == "whole":
        return {}
    if not isinstance(value, dict):
        raise refuse(shown_as(value), "whole, {rim: [..]}, {rectangle: [..]} or {line: [[..], [..]]}")
    if value.keys() <= {"rim", "rectangle", "line", "at"}:
        exactly_one(value, ("rim", "rectangle", "line"))
    return value


Region = Annotated[RegionSpec, BeforeValidator(_region)]


class PlateSpec(Spec):
    """A flat rectangular plate; origin is a corner of its mid-surface."""

    type: Literal["plate"]
    material: Text
    thickness: Length
    element: Annotated[
        Literal["hermite12", "acm12", "bfs16"], BeforeValidator(only(("hermite12", "acm12", "bfs16")))
    ] = "bfs16"
    origin: Position3
    size: tuple[Length, Length]
    mesh: Mesh
    normal: Direction3 = (0.0, 0.0, 1.0)
    x_direction: Direction3 | None = None


class OffsetsSpec(Spec):
    """Rigid arms from the ends of every line to the flexible bar, global axes."""

    start: Position3 = (0.0, 0.0, 0.0)
    end: Position3 = (0.0, 0.0, 0.0)


class FrameSpec(Spec):
    """Bars along polylines of global points."""

    type: Literal["frame"]
    material: Text
    section: Text
    lines: Annotated[list[Annotated[list[Position3], Field(min_length=2)]], Field(min_length=1)]
    mesh: Length | None = None
    orientation: Direction3 | None = None
    element: Annotated[Literal["timoshenko", "euler"], BeforeValidator(only(("timoshenko", "euler")))] = "timoshenko"
    offsets: OffsetsSpec = OffsetsSpec()


class SpreadSpec(Spec):
    """Stiffness of a foundation: per area of a whole or rectangle region, per length of a rim or line."""

    normal: Spread
    shear: Spread = Measured(0.0, None)


class FoundationSpec(Spec):
    """A Winkler foundation to the ground."""

    type: Literal["foundation"]
    on: Text
    region: Region = RegionSpec()
    stiffness: SpreadSpec
    loss_factor: LossFactor = 0.0


class SixStiffnesses(Spec):
    """Stiffness by direction, global axes."""

    x: Stiffness = 0.0
    y: Stiffness = 0.0
    z: Stiffness = 0.0
    rx: RotationalStiffness = 0.0
    ry: RotationalStiffness = 0.0
    rz: RotationalStiffness = 0.0


class SixDashpots(Spec):
    """Dashpots by direction, global axes."""

    x: Dashpot = 0.0
    y: Dashpot = 0.0
    z: Dashpot = 0.0
    rx: RotationalDashpot = 0.0
    ry: RotationalDashpot = 0.0
    rz: RotationalDashpot = 0.0


class SpringSpec(Spec):
    """A spring and dashpot between a place and another, or the ground; several places of a point: one each."""

    type: Literal["spring"]
    between: tuple[Text, Text]
    stiffness: SixStiffnesses = SixStiffnesses()
    damping: SixDashpots = SixDashpots()


class MassSpec(Spec):
    """A mass at the places of a point (kg each), or over a region of a plate (kg, kg/m, kg/m^2)."""

    type: Literal["mass"]
    mass: AnyMass
    at: Text | None = None
    on: Text | None = None
    region: Region | None = None


PartSpec = Annotated[PlateSpec | FrameSpec | FoundationSpec | SpringSpec | MassSpec, Field(discriminator="type")]


class JointSpec(Spec):
    """Where two parts touch they move together; directions with a stiffness are springs instead."""

    connect: tuple[Text, Text]
    kind: Annotated[Literal["rigid", "pinned"], BeforeValidator(only(("rigid", "pinned")))] = "rigid"
    stiffness: SixStiffnesses = SixStiffnesses()


def coordinates(value: object) -> tuple[float, ...]:
    if not isinstance(value, list) or not 1 <= len(value) <= 3:
        raise refuse(shown_as(value), "a list of coordinates", "write center, [x, y] or [[x, y], [x, y]]")
    return tuple(Quantity(("length",)).read(one) for one in value)


def _places(value: object) -> object:
    """One place or several: "center", a position along a bar, [x, y], or a list of positions."""
    if value == "center":
        return "center"
    if isinstance(value, list):
        if value and all(isinstance(one, list) for one in value):
            return tuple(coordinates(one) for one in value)
        return (coordinates(value),)
    try:
        return ((quantity(value, "length"),),)
    except QuantityError as error:
        raise refuse(error.got, "center, [x, y] or [[x, y], [x, y]]", nearest(str(value), ["center"])) from None


At = Annotated[Literal["center"] | tuple[tuple[float, ...], ...], BeforeValidator(_places)]
Side = Annotated[Literal["above", "below"], BeforeValidator(only(("above", "below")))]


class PointSpec(Spec):
    """A named place; of a rod or beam a position along it, of an oscillator nothing."""

    on: Text | None = None
    at: At | None = None
    side: Side = "above"


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


Edge = Annotated[Literal["x0", "x1", "y0", "y1", "all"], BeforeValidator(only(("x0", "x1", "y0", "y1", "all")))]


class SupportSpec(Spec):
    """Held directions of an edge or line of a plate, of a point, or of a whole part."""

    fix: Annotated[Literal["simple", "clamped"] | tuple[str, ...], BeforeValidator(_fix)]
    on: Text | None = None
    edge: Edge | None = None
    line: tuple[Position2, Position2] | None = None
    at: Text | None = None

    @model_validator(mode="before")
    @classmethod
    def _one_place(cls, value: Any) -> Any:
        if isinstance(value, dict):
            exactly_one(value, ("on", "at"))
            exactly_one(value, ("edge", "line"), or_none=True)
        return value


class RayleighSpec(Spec):
    """C = alpha M + beta K."""

    alpha: Annotated[float, Quantity(("rate",), least=0.0)] = 0.0
    beta: Annotated[float, Quantity(("time",), least=0.0)] = 0.0


class ModeDampingSpec(Spec):
    """The damping of one mode, and the frequency at which that mode is expected."""

    ratio: Ratio | None = None
    loss_factor: LossFactor | None = None
    near: Frequency

    @model_validator(mode="before")
    @classmethod
    def _one_law(cls, value: Any) -> Any:
        if isinstance(value, dict):
            exactly_one(value, ("ratio", "loss_factor"))
        return value


class DampingSpec(Spec):
    """The structure's own damping: a general law and exceptions by mode number."""

    ratio: Ratio | None = None
    loss_factor: LossFactor | None = None
    rayleigh: RayleighSpec | None = None
    source: Annotated[str | None, BeforeValidator(only(("materials",)))] = Field(default=None, alias="from")
    modes: dict[str, ModeDampingSpec] = Field(default_factory=dict)

    @model_validator(mode="before")
    @classmethod
    def _one_law(cls, value: Any) -> Any:
        if isinstance(value, dict):
            exactly_one(value, ("ratio", "loss_factor", "rayleigh", "from"), or_none=True)
        return value


class NoStructureSpec(Spec):
    """Only bodies and the ground."""

    type: Literal["none"]


class OscillatorSpec(Spec):
    """A mass on a spring, by its frequency or its stiffness."""

    type: Literal["oscillator"]
    mass: MassKg
    frequency: Frequency | None = None
    stiffness: Annotated[float, Quantity(("stiffness",), above=0.0)] | None = None

    @model_validator(mode="before")
    @classmethod
    def _one_spring(cls, value: Any) -> Any:
        if isinstance(value, dict):
            exactly_one(value, ("frequency", "stiffness"))
        return value


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


class GivenModesSpec(Spec):
    """Given modes: frequencies, damping ratios and mass-normalised shapes at points [1/sqrt(kg)]."""

    type: Literal["modes"]
    frequency: Annotated[list[Annotated[float, Quantity(("frequency",), least=0.0)]], Field(min_length=1)]
    ratio: list[Ratio] | None = None
    points: dict[str, list[Component]]


def _structure(value: object) -> object:
    return {"type": "none"} if value == "none" else value


StructureSpec = Annotated[
    Annotated[NoStructureSpec | OscillatorSpec | RodSpec | BeamSpec | GivenModesSpec, Field(discriminator="type")],
    BeforeValidator(_structure),
]


class ModelSpec(Spec):
    """A model file: parts and what joins, holds and damps them, or one closed-form structure."""

    title: Text | None = None
    materials: dict[str, MaterialSpec] = Field(default_factory=dict)
    sections: dict[str, SectionSpec] = Field(default_factory=dict)
    parts: dict[str, PartSpec] = Field(default_factory=dict)
    joints: dict[str, JointSpec] = Field(default_factory=dict)
    points: dict[str, PointSpec] = Field(default_factory=dict)
    surfaces: dict[str, SurfaceSpec] = Field(default_factory=dict)
    supports: dict[str, SupportSpec] = Field(default_factory=dict)
    damping: DampingSpec = DampingSpec()
    structure: StructureSpec | None = None
