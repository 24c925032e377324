"""Specs of materials, sections, regions and parts: the solid half of a model file."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag

from femstruct.language.spec import (
    AnyRatio,
    Count,
    Direction3,
    Factor,
    Length,
    MassKg,
    MaterialLossFactor,
    Measured,
    Position2,
    Position3,
    Quantity,
    Spec,
    Text,
    exactly_one,
    only,
    read_by,
    refuse,
)
from femstruct.units import shown_as

Area = Annotated[float, Quantity(("area",), above=0.0)]
SecondMoment = Annotated[float, Quantity(("second moment",), above=0.0)]
Modulus = Annotated[float, Quantity(("pressure",), above=0.0)]
Density = Annotated[float, Quantity(("density",), least=0.0)]
Spread = Annotated[Measured, Quantity(("stiffness/area", "stiffness/length"), least=0.0, which=True)]
AnyMass = Annotated[Measured, Quantity(("mass", "mass/length", "mass/area"), above=0.0, which=True)]
Stiffness = Annotated[float, Quantity(("stiffness",), least=0.0)]
RotationalStiffness = Annotated[float, Quantity(("rotational stiffness",), least=0.0)]
Dashpot = Annotated[float, Quantity(("damping",), least=0.0)]
Inertia = Annotated[float, Quantity(("inertia",), above=0.0)]
RotationalDashpot = Annotated[float, Quantity(("rotational damping",), least=0.0)]


class MaterialSpec(Spec):
    """A linear elastic isotropic material."""

    E: Modulus
    nu: AnyRatio
    rho: Density
    loss_factor: MaterialLossFactor = 0.0


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
    outer: Length
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


Mesh = Annotated[float | tuple[int, int], read_by(_mesh, Length | tuple[Count, Count])]


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


Region = Annotated[RegionSpec, read_by(_region, Literal["whole"] | RegionSpec)]


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
    """Bars along polylines of global points; element: timoshenko18, bars of three nodes, or the bars of two nodes
    timoshenko, which needs more of them where shear matters, and euler, which has neither shear nor rotary inertia."""

    type: Literal["frame"]
    material: Text
    section: Text
    lines: Annotated[list[Annotated[list[Position3], Field(min_length=2)]], Field(min_length=1)]
    mesh: Length | None = None
    orientation: Direction3 | None = None
    element: Annotated[
        Literal["timoshenko18", "timoshenko", "euler"], BeforeValidator(only(("timoshenko18", "timoshenko", "euler")))
    ] = "timoshenko18"
    offsets: OffsetsSpec = OffsetsSpec()


class SpreadSpec(Spec):
    """Stiffness of a foundation: per area of a whole or rectangle region, per length of a rim or line."""

    normal: Spread
    shear: Spread = Measured(0.0, None)


class BlockSpec(Spec):
    """A rigid body: a box along the global axes from its lower corner; center and inertia where it is not uniform."""

    type: Literal["block"]
    mass: MassKg
    origin: Position3
    size: tuple[Length, Length, Length]
    center: Position3 | None = None
    inertia: tuple[Inertia, Inertia, Inertia] | None = None


class FoundationSpec(Spec):
    """A Winkler foundation: of a plate or block to the ground, or between the facing sides of two of them."""

    one_of = (("on", "between"),)

    type: Literal["foundation"]
    on: Text | None = None
    between: tuple[Text, Text] | None = None
    region: Region = RegionSpec()
    stiffness: SpreadSpec
    loss_factor: MaterialLossFactor = 0.0


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
    """A mass at the places of a point (kg each), over a region of a plate (kg, kg/m, kg/m^2), or along a frame."""

    type: Literal["mass"]
    mass: AnyMass
    at: Text | None = None
    on: Text | None = None
    region: Region | None = None


PartSpec = Annotated[
    PlateSpec | FrameSpec | BlockSpec | FoundationSpec | SpringSpec | MassSpec, Field(discriminator="type")
]
