"""Parts as they are written: a class for each kind, found by its `type`, and what other packages add."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import radians
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Final, Literal

from pydantic import Discriminator, Field, Tag

from femstruct.decks.mesh_file import read_mesh_file
from femstruct.declared import Refers
from femstruct.elements.frame import FrameElement
from femstruct.elements.plate import PlateElement
from femstruct.errors import FemstructError, InputError, InputErrors, quote_value
from femstruct.files.matrices_input import read_component
from femstruct.files.text_tables import beside
from femstruct.language.materials import Losses, PlateLosses, entry_for, entry_source, need_losses
from femstruct.language.not_computed import FALLING_PARTS, instead_of
from femstruct.language.places import AnyRegion, RegionSpec, SixDashpots, SixStiffnesses
from femstruct.model import regions
from femstruct.model.attached import TAKEN
from femstruct.model.lay_ups import Laminate, Layer, LayUp, Smeared
from femstruct.model.library import LibraryEntry, Use
from femstruct.model.library_entries import library
from femstruct.model.materials import AnyMaterial
from femstruct.model.part import Part
from femstruct.model.regions import Touched
from femstruct.model.sections import Section
from femstruct.parts.attachments import Attachments
from femstruct.parts.block import Block
from femstruct.parts.foundation import Foundation
from femstruct.parts.frame import Frame
from femstruct.parts.hangers import Hangers
from femstruct.parts.inertia import Inertia
from femstruct.parts.mass import Mass
from femstruct.parts.plate import InPlane, Plate
from femstruct.parts.shell import Shell
from femstruct.parts.slab import Slab
from femstruct.parts.solid import Solid
from femstruct.parts.spring import Spring
from femstruct.parts.substructure import Substructure
from femstruct.quantities import (
    CELL,
    LENGTH,
    Coordinate,
    Direction3,
    Length,
    MassKg,
    Measured,
    Position2,
    Position3,
    Quantity,
    SideLength,
    refuse,
)
from femstruct.units import QuantityError, quantity
from femstruct.yaml.reader import Here
from femstruct.yaml.spec import (
    CellSide,
    Count,
    MaterialLossFactor,
    PointName,
    Spec,
    Text,
    read_by,
    several,
    so_many,
    union_of,
    words_of,
)

# ----------------------------------------------------------------------------------------------------------------------
# What a part of a model file is to the language; its kinds follow.
# ----------------------------------------------------------------------------------------------------------------------

COORDINATE_ROUNDING = 1e-9  # of a side: what a coordinate written in decimals may be off the edge
Places = str | tuple[tuple[float, ...], ...]
"""Where a point is, as it is written: center, top, bottom, or coordinates [m]."""
STRESSED: Final = "part with stresses"
MaterialName = Annotated[Text, Refers("material")]
MESHED: Final = "part that is a mesh"  # of a file: it has sets
FLOOR, CEILING = "plate, slab, block or frame", "plate or slab"  # what hangers are between
SectionName = Annotated[Text, Refers("section")]


@dataclass(frozen=True)
class Library:
    """What parts are made of, by name, and the model file, from whose folder they name others. sources : is given the
    digests of those."""

    materials: Mapping[str, AnyMaterial]
    sections: Mapping[str, Section]
    file: str = ""
    sources: dict[str, str] = field(default_factory=dict)


class PartSpec(Spec):
    """A part: a kind says what its keys are and which noun it `makes` of them.

    known_as : as what other names in the file find it: a part has nodes to join, hold and point at; on the edges and
    areas of a plate supports can be; surfaces are on a plate or shell; layers lie against a plate, slab or block;
    hangers are between a plate, slab, block or frame and a plate or slab; masses are spread along or over a plate or
    frame; a part that is a mesh has named sets; stresses can be recorded of a part with stresses.
    """

    known_as: ClassVar[tuple[str, ...]] = ()
    instead = instead_of(FALLING_PARTS, "drop_height", "falls", "gravity", "speed", "velocity")
    type: str

    def build(self, name: str, of: Library) -> Part:
        """The noun it describes."""
        return self.made_of(name, of)

    def made_of(self, name: str, of: Library, **more: Any) -> Part:
        """The noun, of what its keys name in the library.

        Parameters
        ----------
        more : Any
            What the keys do not say themselves.

        Raises
        ------
        FemstructError
            Where it `makes` no part.
        """
        found: dict[str, Any] = {"material": of.materials, "section": of.sections}
        named = {key: found[key][getattr(self, key)] for key in found if getattr(self, key, None) is not None}
        part = self.noun(name=name, **named, **more)
        if not isinstance(part, Part):
            kind = f"{type(self).__module__}.{type(self).__name__}"
            raise FemstructError(f"parts.{name}", got=f"a {type(part).__name__}", expected=f"a Part that {kind} makes")
        return part

    def check_place(self, here: Here, places: Places) -> None:
        """Note what is wrong with a point on it."""
        if isinstance(places, str):
            here.wrong(f"{places} of a {self.type}", "global coordinates", "write [x, y, z]")
        elif any(len(place) != 3 for place in places):
            here.wrong(f"{len(places[0])} coordinates", f"3 on a {self.type}", "global axes")

    def check_losses(self, here: Here) -> None:
        """Note a loss factor that damping from materials takes and neither the file nor the library gives."""

    @property
    def named_places(self) -> Mapping[str, tuple[float, ...]]:
        """Coordinates of those of center, top and bottom that it has."""
        return {}


def check_coordinates(
    here: Here, places: tuple[tuple[float, ...], ...], kind: str, size: tuple[float, ...], hint: str
) -> None:
    """Note coordinates of another number than the sides of a part, and places that are not on it."""
    if any(len(place) != len(size) for place in places):
        here.wrong(f"{len(places[0])} coordinates", f"{len(size)} on a {kind}", hint)
        return
    expected = f"a place on the {kind}, {' x '.join(f'{side:g} m' for side in size)}"
    do = f"measure from the {kind}'s own corner, along its own axes"
    for place in places:
        here.need(
            all(
                -COORDINATE_ROUNDING * side <= x <= side * (1 + COORDINATE_ROUNDING)
                for x, side in zip(place, size, strict=True)
            ),
            f"{list(place)} m",
            expected,
            do,
        )


# ----------------------------------------------------------------------------------------------------------------------
# What parts of mesh files have in common as they are written: the file, the set of it, its unit of length.
# ----------------------------------------------------------------------------------------------------------------------


def unit_of_file(dimension: str, factor: str, expected: str, do: str) -> Callable[[object], object]:
    """Reader of a unit of a file in SI units: the unit, or a number of the dimension `factor`."""
    number = Quantity((factor,), above=0.0)

    def read(value: object) -> object:
        if not isinstance(value, str):
            return number.read(value)
        try:
            return quantity(f"1 {value}", dimension)
        except QuantityError:
            raise refuse(quote_value(value), expected, do) from None

    return read


_scale = unit_of_file("length", "ratio", "a unit of length, or metres in that of the file", "write mm or 0.001")


FILE_SCALE = Annotated[float, read_by(_scale, Text | float)]
"""Metres in the unit of length of a file."""


class OfMeshSpec(PartSpec):
    """A part of a mesh file. scale: the unit of length in the file, or metres in it; metres without it."""

    known_as: ClassVar[tuple[str, ...]] = ("part",)

    only_written: ClassVar[tuple[str, ...]] = ("scale",)  # the mesh is in metres

    mesh: Text = Field(description="a mesh file: .msh, .inp, .bdf, .unv or .vtu")
    scale: FILE_SCALE = 1.0

    def build(self, name: str, of: Library) -> Part:
        try:
            mesh = read_mesh_file(beside(of.file, self.mesh), self.scale, of.sources)
        except InputErrors:
            raise
        except InputError as error:
            raise InputError(f"parts.{name}.mesh", got=error.got, expected=error.expected, do=error.do) from None
        return self.made_of(name, of, mesh=mesh)


class FromMeshSpec(OfMeshSpec):
    """A part whose shape is the mesh of a file, or a set of it."""

    known_as: ClassVar[tuple[str, ...]] = ("part", MESHED)

    called = (("set", "named"),)

    set: Text | None = None


# ----------------------------------------------------------------------------------------------------------------------
# Layers and smeared ribs of plates and shells as they are written.
# ----------------------------------------------------------------------------------------------------------------------

_ANGLE = Quantity(("angle",))
Bending = Annotated[float, Quantity(("moment",), least=0.0)]
Rigidity = Annotated[float, Quantity(("stiffness",), least=0.0)]


def _angle(value: object) -> object:
    """An angle with its unit: 90 without one is far more likely in degrees than in radians."""
    if isinstance(value, int | float) and not isinstance(value, bool) and value != 0:
        raise refuse(quote_value(value), "an angle with its unit", f"write {value:g} deg")
    return _ANGLE.read(value)


def _layer(value: object) -> object:
    """A layer with its angle, which may be left out."""
    if not (isinstance(value, list) and len(value) in (2, 3)):
        got = f"{len(value)} value{'s' if len(value) != 1 else ''}" if isinstance(value, list) else quote_value(value)
        raise refuse(got, "[material, thickness, angle]", "the angle may be left out: [spruce, 40 mm]")
    return value if len(value) == 3 else [*value, 0]


Written = tuple[MaterialName, Length, Annotated[float, read_by(_angle, Annotated[float, _ANGLE])]]


def _some(value: object) -> object:
    """One layer or more."""
    if not isinstance(value, list) or not value:
        got = "no layer" if value == [] else quote_value(value)
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


def lay_up_of(
    layers: Sequence[tuple[str, float, float]] | LaidSpec | BoardsSpec, materials: Mapping[str, AnyMaterial]
) -> Laminate:
    """The noun of the layers that are written."""
    if isinstance(layers, LaidSpec):
        entry = library()[layers.like]
        laid = tuple(Layer(materials[layers.of], each, radians(angle)) for each, angle in entry.layers)
        return Laminate(laid, entry_source(layers.like))
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
        deck = smeared or lay_up_of(self.layers or (), of.materials)
        return super().made_of(name, of, material=deck, thickness=deck.thickness, **more)


# ----------------------------------------------------------------------------------------------------------------------
# Attachments as they are written.
# ----------------------------------------------------------------------------------------------------------------------

_unit = unit_of_file("mass", "mass", "a unit of mass, or kilograms in that of the file", "write t or 1000")


class AttachmentsSpec(OfMeshSpec):
    """Supports, rigid links and masses that a mesh file states beside its cells, taken as they are. take: which of
    them. supports: the sets of supports that hold, by their names in the file; those that the file puts to use without
    it. mass_unit: the unit of mass of the file; without it kg of a file in metres and t of one in millimetres."""

    makes = Attachments
    type: Literal["attachments"]
    take: Annotated[tuple[str, ...], words_of(TAKEN)]
    supports: tuple[Text, ...] = ()
    mass_unit: Annotated[float | None, read_by(_unit, Text | float)] = None


# ----------------------------------------------------------------------------------------------------------------------
# Rigid blocks as they are written.
# ----------------------------------------------------------------------------------------------------------------------

BlockInertia = Annotated[float, Quantity(("inertia",), above=0.0)]


class BlockSpec(PartSpec):
    """A rigid body: a box along the global axes from its lower corner; center and inertia where it is not uniform."""

    makes = Block
    known_as = ("part", "plate, slab or block", FLOOR)
    type: Literal["block"]
    mass: MassKg
    origin: Position3
    size: tuple[Length, Length, Length]
    center: Position3 | None = None
    inertia: tuple[BlockInertia, BlockInertia, BlockInertia] | None = None

    def check_place(self, here: Here, places: Places) -> None:
        if isinstance(places, tuple):
            check_coordinates(here, places, "block", self.size, "from its lower corner")

    @property
    def named_places(self) -> Mapping[str, tuple[float, ...]]:
        a, b, c = self.size
        return {word: (a / 2, b / 2, z) for word, z in (("bottom", 0.0), ("center", c / 2), ("top", c))}


# ----------------------------------------------------------------------------------------------------------------------
# Winkler foundations as they are written.
# ----------------------------------------------------------------------------------------------------------------------

Spread = Annotated[Measured, Quantity(("stiffness/area", "stiffness/length"), least=0.0, which=True)]
BelowLayer = Annotated[Text, Refers("plate, slab or block")]


class SpreadSpec(Spec):
    """Stiffness of a foundation: per area of a whole or rectangle region, per length of a rim or line."""

    short = "normal"
    normal: Spread
    shear: Spread = Measured(0.0, None)


class FoundationSpec(PartSpec):
    """A Winkler foundation: of a plate, slab or block to the ground, or between the facing sides of two of them. like:
    a resilient layer of the library, by its stiffness per area.

    It acts on the faces that it touches, its shear with the arms of them. On the ground that is the lower face, along
    lines and rims, too; side: above for that of a plate or slab, x, -x, y or -y for the side of a wall that faces
    there, middle for the mid-surface, where its shear has no arm."""

    one_of = (("on", "between"), ("stiffness", "like"))

    makes = Foundation
    type: Literal["foundation"]
    on: BelowLayer | None = None
    between: tuple[BelowLayer, BelowLayer] | None = Field(
        default=None, description="two parts whose facing sides it joins"
    )
    side: Touched = "below"
    region: AnyRegion = RegionSpec()
    stiffness: SpreadSpec | None = None
    like: Annotated[Text | None, entry_for(Use.LAYER, "a resilient layer of the library", "layer")] = None
    loss_factor: Losses = 0.0

    def check(self, here: Here) -> None:
        on, to = self.between or (self.on, None)
        here.at("between").need(on != to, f"'{on}' twice", "two different parts")
        between = self.between is not None and "side" in self.model_fields_set
        here.at("side").need(not between, "a side beside 'between'", "none: it joins the sides that face each other")
        along, there = self.region.is_line, here.at("stiffness")
        if self.stiffness is None:
            got = f"{self.like}, whose stiffness is per area, on a rim or a line"
            here.at("like").need(not along, got, "a whole or rectangle region", "write 'stiffness', per length")
            return
        right, unit = ("stiffness/area", "N/m^3 (per area)")
        if along:
            right, unit = ("stiffness/length", "N/m^2 (per length of a rim or line)")
        for key, one in self.stiffness.given().items():
            there.at(key).need(
                one.dimension in (None, right),
                f"a stiffness in {'N/m^3' if along else 'N/m^2'}",
                unit,
                "match the unit to the region",
            )
        there.need(
            any(one.value for one in self.stiffness.given().values()),
            "no stiffness at all",
            "a positive normal or shear stiffness",
        )

    def check_losses(self, here: Here) -> None:
        need_losses(here, self.like, "loss_factor" in self.model_fields_set)

    def given(self) -> dict[str, Any]:
        values = super().given()
        on, to = values.pop("between") or (values["on"], None)
        written = values.pop("stiffness")
        spread = {"normal": library()[values["like"]].number("stiffness_per_area")} if values["like"] else {}
        spread |= {key: one.value for key, one in (written or {}).items()}
        return {**values, **spread, "on": on, "to": to, "like": entry_source(values["like"])}


# ----------------------------------------------------------------------------------------------------------------------
# Frames as they are written.
# ----------------------------------------------------------------------------------------------------------------------


class OffsetsSpec(Spec):
    """Rigid arms from the ends of every line to the flexible bar, global axes."""

    start: Position3 = (0.0, 0.0, 0.0)
    end: Position3 = (0.0, 0.0, 0.0)


class FrameSpec(PartSpec):
    """Bars along polylines of global points; element: timoshenko18, bars of three nodes, or the bars of two nodes
    timoshenko, which needs more of them where shear matters, and euler, which has neither shear nor rotary inertia."""

    makes = Frame
    known_as = ("part", "plate or frame", STRESSED, FLOOR)
    type: Literal["frame"]
    material: MaterialName
    section: SectionName
    lines: Annotated[list[Annotated[list[Position3], Field(min_length=2)]], Field(min_length=1)]
    mesh: CellSide | None = Field(
        default=None, description="largest side of an element [m]; without it one element a segment"
    )
    orientation: Direction3 | None = None
    element: FrameElement = "timoshenko18"
    offsets: OffsetsSpec = OffsetsSpec()

    def given(self) -> dict[str, Any]:
        values = super().given()
        arms = values.pop("offsets")
        lines = tuple(tuple(line) for line in self.lines)
        return {**values, "lines": lines, "start_offset": arms["start"], "end_offset": arms["end"]}


# ----------------------------------------------------------------------------------------------------------------------
# Hangers and channels of ceilings as they are written.
# ----------------------------------------------------------------------------------------------------------------------

HangerStiffness = Annotated[Measured, Quantity(("stiffness", "stiffness/length"), least=0.0, which=True)]
OwnMass = Annotated[Measured, Quantity(("mass", "mass/length"), least=0.0, which=True)]
Spacing = Annotated[
    tuple[float, ...],
    read_by(several(LENGTH.read), Length | Annotated[list[Length], Field(min_length=1, max_length=2)]),
]


class HungSpec(Spec):
    """Stiffness of hangers: along the normal of the ceiling and both ways along it, of each or per length."""

    short = "normal"
    normal: HangerStiffness
    shear: HangerStiffness = Measured(0.0, None)


class HangersSpec(PartSpec):
    """Hangers, clips or channels between a floor, or its joists, and a ceiling: springs at places in a regular spacing
    (N/m each) or along lines (N/m^2); like: one of the library."""

    one_of = (("stiffness", "like"),)
    at_most_one_of = (("spacing", "at"), ("along", "at"))

    makes = Hangers
    type: Literal["hangers"]
    between: tuple[Annotated[Text, Refers(FLOOR)], Annotated[Text, Refers(CEILING)]] = Field(
        description="what carries, a floor or its joists, and the ceiling that hangs from it"
    )
    stiffness: HungSpec | None = None
    like: Annotated[Text | None, entry_for(Use.HANGERS, "hangers or channels of the library", "hangers")] = None
    spacing: Spacing = ()
    along: Literal["x", "y"] | None = None
    at: Annotated[list[Position2] | None, Field(min_length=1)] = None
    loss_factor: Losses = 0.0
    mass: OwnMass = Measured(0.0, None)

    @property
    def entry(self) -> LibraryEntry | None:
        """Of the library, that it is like."""
        return library()[self.like] if self.like else None

    @property
    def per(self) -> Literal["piece", "length"]:
        """What its stiffness is of."""
        if self.entry is not None:
            return "piece" if self.entry.fact("stiffness") else "length"
        written = self.stiffness.given().values() if self.stiffness else ()
        return "length" if any(one.dimension == "stiffness/length" for one in written) else "piece"

    def check(self, here: Here) -> None:
        first, second = self.between
        here.at("between").need(first != second, f"'{first}' twice", "two different parts")
        lines = self.per == "length"
        written = self.stiffness.given() if self.stiffness else {}
        kinds = {one.dimension == "stiffness/length" for one in written.values() if one.value}
        there = here.at("stiffness")
        if not there.need(len(kinds) < 2, "one stiffness per length, one of each", "both of one kind"):
            return
        something = self.stiffness is None or any(one.value for one in written.values())
        there.need(something, "no stiffness at all", "a positive normal or shear stiffness")
        here.at("mass").need(
            self.mass.value == 0.0 or (self.mass.dimension == "mass/length") == lines,
            "a mass of each" if lines else "a mass per length",
            "kg/m, as the stiffness is per length" if lines else "kg, as the stiffness is of each",
        )
        known = here.names.known
        if first in known["plate or frame"] and first not in known["plate or shell"]:
            self._check_bars(here, lines)
        else:
            self._check_below(here, lines)

    def _check_bars(self, here: Here, lines: bool) -> None:
        for key in ("at", "along"):
            got = f"'{key}' below a frame"
            here.at(key).need(getattr(self, key) is None, got, "places along its bars", f"remove '{key}'", of_key=True)
        if lines:
            here.at("spacing").need(not self.spacing, "a spacing", "lines along all bars", "remove it", of_key=True)
        else:
            got = f"{len(self.spacing)} numbers" if self.spacing else "nothing"
            here.at("spacing").need(
                len(self.spacing) == 1, got, "the spacing along the bars", "add 'spacing: 500 mm'", of_key=True
            )

    def _check_below(self, here: Here, lines: bool) -> None:
        there = here.at("spacing")
        if not lines:
            here.at("along").need(
                self.along is None, "a direction of springs one by one", "none", "remove 'along'", of_key=True
            )
            there.need(
                bool(self.spacing or self.at),
                "nothing",
                "'spacing' or 'at'",
                "add 'spacing: [600 mm, 900 mm]'",
                of_key=True,
            )
            return
        here.at("at").need(self.at is None, "places of lines", "lines in a 'spacing'", "remove 'at'", of_key=True)
        got = f"{len(self.spacing)} numbers" if self.spacing else "nothing"
        there.need(len(self.spacing) == 1, got, "one, across the lines", "add 'spacing: 500 mm'", of_key=True)
        here.at("along").need(
            self.along is not None,
            "nothing",
            "the axis of the ceiling that lines run along",
            "add 'along: x'",
            of_key=True,
        )

    def check_losses(self, here: Here) -> None:
        need_losses(here, self.like, "loss_factor" in self.model_fields_set)

    def given(self) -> dict[str, Any]:
        values, entry = super().given(), self.entry
        (on, to), written = values.pop("between"), values.pop("stiffness")
        spread = {key: one.value for key, one in (written or {}).items()}
        if entry is not None:
            spread["normal"] = entry.number("stiffness" if self.per == "piece" else "stiffness_per_length")
            if "loss_factor" not in self.model_fields_set:
                values["loss_factor"] = entry.number("loss_factor") or 0.0
        at = tuple(self.at or ())
        made = {"on": on, "to": to, "per": self.per, "at": at, "mass": self.mass.value, "like": entry_source(self.like)}
        return {**values, **spread, **made}


# ----------------------------------------------------------------------------------------------------------------------
# Concentrated bodies as they are written.
# ----------------------------------------------------------------------------------------------------------------------

INERTIA = Quantity(("inertia",))
_SIX = "[Ixx, Iyy, Izz] or [Ixx, Iyy, Izz, Ixy, Iyz, Izx]"
_moments = so_many(INERTIA.read, (3, 6), _SIX, "write it like [2 kg*m^2, 2 kg*m^2, 3 kg*m^2]")

_WRITTEN = Annotated[list[Annotated[float, INERTIA]], Field(min_length=3, max_length=6)]


class InertiaSpec(PartSpec):
    """A small rigid body at the places of a point (kg each: four places have four of them): mass, moments and products
    of inertia about its centre of mass, and how far that is from the point (offset, global axes)."""

    makes = Inertia
    type: Literal["inertia"]
    at: PointName
    mass: MassKg
    inertia: Annotated[tuple[float, ...], read_by(_moments, _WRITTEN)] = (0.0, 0.0, 0.0)
    offset: Position3 = (0.0, 0.0, 0.0)

    def given(self) -> dict[str, Any]:
        values = super().given()
        six = (*values.pop("inertia"), 0.0, 0.0, 0.0)
        return {**values, "moments": six[:3], "products": six[3:6]}


# ----------------------------------------------------------------------------------------------------------------------
# Masses as they are written.
# ----------------------------------------------------------------------------------------------------------------------

AnyMass = Annotated[Measured, Quantity(("mass", "mass/length", "mass/area"), above=0.0, which=True)]
PER: Final = {"mass/length": "length", "mass/area": "area"}
UNITS: Final = {"mass": "kg", "mass/length": "kg/m", "mass/area": "kg/m^2"}


class MassSpec(PartSpec):
    """A mass at the places of a point (kg each), over a region of a plate or shell (kg, kg/m, kg/m^2), or along a
    frame."""

    makes = Mass
    type: Literal["mass"]
    mass: AnyMass
    at: PointName | None = None
    on: Annotated[Text, Refers("plate or frame")] | None = None
    region: AnyRegion | None = None

    def check(self, here: Here) -> None:
        if not here.need(
            (self.at is None) != (self.on is None),
            "both 'at' and 'on'" if self.at else "no place",
            "one of at: POINT and on: PART",
            of_key=True,
        ):
            return
        known = here.names.known
        frame = self.on in known["plate or frame"] and self.on not in known["plate or shell"]
        where, allowed = "over an area", ["mass", "mass/area"]
        if self.at is not None:
            where, allowed = "at a point", ["mass"]
        elif frame or (self.region is not None and self.region.is_line):
            where, allowed = "along a frame" if frame else "along a rim or line", ["mass", "mass/length"]
        unit = UNITS[self.mass.dimension or "mass"]
        here.at("mass").need(
            self.mass.dimension in (None, *allowed),
            f"a mass in {unit} {where}",
            " or ".join(UNITS[one] for one in allowed),
        )
        there, whole = here.at("region"), self.region is None
        there.need(whole or self.at is None, "a region at a point", "a region on a part", "use on: PART", of_key=True)
        there.need(whole or not frame, "a region of a frame", "all of the frame", "remove 'region'", of_key=True)

    def given(self) -> dict[str, Any]:
        values, (mass, dimension) = super().given(), self.mass
        if self.at is not None:
            return {"mass": mass, "at": self.at}
        area = values["region"] or regions.Region("whole")
        return {**values, "mass": mass, "region": area, "per": PER.get(dimension or "mass", "total")}


# ----------------------------------------------------------------------------------------------------------------------
# Parts of matrices from files as they are written.
# ----------------------------------------------------------------------------------------------------------------------


class FromMatricesSpec(PartSpec):
    """A part whose matrices stand in a file. origin: how far it is shifted from where the file has it."""

    known_as: ClassVar[tuple[str, ...]] = ("part", "plate or shell", MESHED)

    makes = Substructure
    only_written: ClassVar[tuple[str, ...]] = ("file",)  # it becomes a component
    file: Any
    loss_factor: MaterialLossFactor | None = None
    origin: Position3 = (0.0, 0.0, 0.0)

    def build(self, name: str, of: Library) -> Part:
        try:
            component = read_component(self.files(of), of.sources, **self.reading(of))
        except InputErrors:
            raise
        except InputError as error:
            raise InputError(f"parts.{name}.file", got=error.got, expected=error.expected, do=error.do) from None
        return self.made_of(name, of, component=component)

    def files(self, of: Library) -> Path | dict[str, Path]:
        """The file, or several by what they have."""
        return beside(of.file, self.file)

    def reading(self, of: Library) -> dict[str, Any]:
        """How to read what another program wrote."""
        return {}


class MatrixNamesSpec(Spec):
    """Of each matrix its name or its file: mass, stiffness, and dashpots where there are any."""

    M: Text
    K: Text
    C: Text | None = None

    def by_letter(self) -> dict[str, str]:
        """Those that are given."""
        return {"M": self.M, "K": self.K} | ({} if self.C is None else {"C": self.C})


class MatricesSpec(FromMatricesSpec):
    """A part given by M, C, K of another program, in a .npz, HDF5, OUTPUT4 of Nastran (.op4) or a .mtx for each, or by
    what `femstruct export --to npz` or `mtx` wrote. nodes: a table of commas with the columns node, x, y, z, direction
    and a row for each degree of freedom, where the file does not say it. names: of the matrices in a .op4, where they
    are not the usual ones (MAA, KAA, BAA). scale: the unit of length of another program, or metres in it; forces are in
    newtons, so that masses are in t where lengths are in mm."""

    only_written = ("file", "nodes", "names", "scale")
    type: Literal["matrices"]
    file: Text | MatrixNamesSpec
    nodes: Text | None = None
    names: MatrixNamesSpec | None = None
    scale: FILE_SCALE = 1.0

    def files(self, of: Library) -> Path | dict[str, Path]:
        if isinstance(self.file, str):
            return beside(of.file, self.file)
        return {letter: beside(of.file, one) for letter, one in self.file.by_letter().items()}

    def reading(self, of: Library) -> dict[str, Any]:
        return {
            "nodes": None if self.nodes is None else beside(of.file, self.nodes),
            "names": {} if self.names is None else self.names.by_letter(),
            "scale": self.scale,
        }


# ----------------------------------------------------------------------------------------------------------------------
# Plates as they are written.
# ----------------------------------------------------------------------------------------------------------------------


def _mesh(value: object) -> object:
    """A largest element side, or the least numbers of divisions."""
    if isinstance(value, list):
        if len(value) == 2 and all(isinstance(n, int) and not isinstance(n, bool) and 0 < n <= 2000 for n in value):
            return (value[0], value[1])
        raise refuse(quote_value(value), "two whole numbers of divisions from 1 to 2000", "write [16, 16] or 30 mm")
    return CELL.read(value)


class PlateSpec(DeckSpec):
    """A flat rectangular plate of one material, of layers from below, or of smeared ribs; origin is a corner of its
    mid-surface."""

    makes = Plate
    known_as = ("part", "plate", "plate, slab or block", "plate or frame", "plate or shell", STRESSED, FLOOR, CEILING)
    type: Literal["plate"]
    element: PlateElement = "bfs16"
    origin: Position3
    size: tuple[SideLength, SideLength]
    mesh: Annotated[
        float | tuple[int, int],
        read_by(_mesh, CellSide | tuple[Count, Count]),
        Field(description="largest side of an element [m], or the least numbers of them along x and y"),
    ]
    normal: Direction3 = (0.0, 0.0, 1.0)
    x_direction: Direction3 | None = None
    in_plane: InPlane | None = None

    def check_place(self, here: Here, places: Places) -> None:
        if isinstance(places, tuple):
            check_coordinates(here, places, "plate", self.size, "")
        else:
            here.need(places == "center", f"{places} of a plate", "center or [x, y]", "write center")

    @property
    def named_places(self) -> Mapping[str, tuple[float, ...]]:
        return {"center": (self.size[0] / 2, self.size[1] / 2)}


# ----------------------------------------------------------------------------------------------------------------------
# Reduced parts as they are written.
# ----------------------------------------------------------------------------------------------------------------------


class ReducedSpec(FromMatricesSpec):
    """A part that `femstruct reduce` has reduced to its interface and its modes with the interface held."""

    type: Literal["reduced"]
    file: Text

    def build(self, name: str, of: Library) -> Part:
        part = super().build(name, of)
        if isinstance(part, Substructure) and not part.component.reduced:
            got = f"'{part.component.source}', which is not reduced"
            expected = "a file that femstruct reduce wrote"
            raise InputError(f"parts.{name}.file", got=got, expected=expected, do="write type: matrices")
        return part


# ----------------------------------------------------------------------------------------------------------------------
# Shells as they are written.
# ----------------------------------------------------------------------------------------------------------------------


def _thickness(value: object) -> object:
    """One for all cells, or one for each set."""
    return (
        {str(name): LENGTH.read(one) for name, one in value.items()} if isinstance(value, dict) else LENGTH.read(value)
    )


class ShellSpec(FromMeshSpec):
    """A shell on triangles and quadrilaterals of a mesh file. thickness: of all cells, or by set; without it that which
    the file states. layers: in place of both, counted along the normals. offset: from the mesh to the middle of the
    thickness, along the normals. orientation: direction of the x of a material that has directions, laid into each
    cell. nonstructural: mass per area on it that does not stiffen it (NSM); without it that which the file states."""

    makes = Shell
    one_of = (("material", "layers"),)
    only_written = ("layers", "scale")
    at_most_one_of = (("layers", "thickness"),)
    known_as = ("part", "plate or shell", "plate or frame", MESHED, STRESSED)
    type: Literal["shell"]
    material: MaterialName | None = None
    layers: Layers | None = None
    thickness: Annotated[float | dict[str, float] | None, read_by(_thickness, Length | dict[str, Length])] = None
    offset: Coordinate | None = None
    orientation: Direction3 | None = None
    nonstructural: Annotated[float, Quantity(("mass/area",), least=0.0)] | None = None

    def made_of(self, name: str, of: Library, **more: Any) -> Part:
        made = {} if self.layers is None else {"material": lay_up_of(self.layers, of.materials)}
        return super().made_of(name, of, **made, **more)


# ----------------------------------------------------------------------------------------------------------------------
# Slabs as they are written.
# ----------------------------------------------------------------------------------------------------------------------


class HoleSpec(Spec):
    """A rectangular opening: its sides, and its middle in the coordinates of the outline."""

    rectangle: tuple[Length, Length]
    at: Position2


def _cells(value: object) -> object:
    if isinstance(value, list):
        raise refuse(quote_value(value), "a largest side of its elements", "write it like 200 mm")
    return CELL.read(value)


class SlabSpec(DeckSpec):
    """A flat slab. outline: corners in turn, sides along x or y; holes: rectangular openings; mesh: largest element
    side; through: places that get a node. It has the sets rim, side 1, .., hole 1, ..."""

    makes = Slab
    known_as = ("part", "plate or shell", "plate or frame", "plate, slab or block", MESHED, STRESSED, FLOOR, CEILING)
    instead = (
        *DeckSpec.instead,
        ("size", "outline", "for a rectangle of 5 m by 4 m write outline: [[0, 0], [5, 0], [5, 4], [0, 4]]"),
    )
    type: Literal["slab"]
    outline: Annotated[list[Position2], Field(min_length=4)]
    mesh: Annotated[float, read_by(_cells, CellSide), Field(description="largest side of an element [m]")]
    holes: list[HoleSpec] = Field(default_factory=list)
    through: list[Position2] = Field(default_factory=list)
    origin: Position3 = (0.0, 0.0, 0.0)
    normal: Direction3 = (0.0, 0.0, 1.0)
    x_direction: Direction3 | None = None
    offset: Coordinate = 0.0

    def check_place(self, here: Here, places: Places) -> None:
        if isinstance(places, str):
            middle = [(min(along) + max(along)) / 2 for along in zip(*self.outline, strict=True)]
            do = f"use the coordinates of its outline, whose middle is [{middle[0]:g}, {middle[1]:g}]"
            here.wrong(f"{places} of a slab", "[x, y]", do)
        elif any(len(place) != 2 for place in places):
            here.wrong(f"{len(places[0])} coordinates", "2 on a slab", "use the coordinates of its outline")

    def given(self) -> dict[str, Any]:
        holes = tuple((one.rectangle, one.at) for one in self.holes)
        return {**super().given(), "holes": holes, "outline": tuple(self.outline), "through": tuple(self.through)}


# ----------------------------------------------------------------------------------------------------------------------
# Solids as they are written.
# ----------------------------------------------------------------------------------------------------------------------


class SolidSpec(FromMeshSpec):
    """A solid on tetrahedra and hexahedra of a mesh file. orientation, normal: directions of the x and of the z of a
    material that has directions."""

    makes = Solid
    known_as = ("part", "plate or shell", MESHED, STRESSED)
    type: Literal["solid"]
    material: MaterialName
    orientation: Direction3 | None = None
    normal: Direction3 = (0.0, 0.0, 1.0)


# ----------------------------------------------------------------------------------------------------------------------
# Springs as they are written.
# ----------------------------------------------------------------------------------------------------------------------

End = Annotated[Text, Refers()]


class SpringSpec(PartSpec):
    """A spring and dashpot between a place and another, or the ground; several places of a point: one each."""

    makes = Spring
    type: Literal["spring"]
    between: tuple[End, End] = Field(description="a point, and another or ground")
    stiffness: SixStiffnesses = SixStiffnesses()
    damping: SixDashpots = SixDashpots()

    def check(self, here: Here) -> None:
        first, second = self.between
        there = here.at("between", 0)
        if there.need(first != "ground", "'ground'", "a point first", f"write [{second}, ground]"):
            there.known(first, "point")
        here.at("between", 1).known(second, "point", ["ground"])
        here.at("between").need(first != second, f"'{first}' twice", "two different places")
        here.need(
            any((*self.stiffness.noun(), *self.damping.noun())),
            "no stiffness and no damping",
            "one of them",
            "add stiffness: {z: ...}",
            of_key=True,
        )

    def given(self) -> dict[str, Any]:
        values = super().given()
        first, second = values.pop("between")
        return {**values, "a": first, "b": None if second == "ground" else second}
