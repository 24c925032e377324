"""Supports as they are written."""

from __future__ import annotations

import re
from collections.abc import Mapping
from itertools import pairwise
from typing import Annotated, Any, Final, Literal, get_args

from pydantic import BeforeValidator, Field

from femstruct.conventions import DIRECTIONS
from femstruct.declared import Refers, exactly_one
from femstruct.errors import FemstructError, InputError, quote_value
from femstruct.language.materials import Area, Losses
from femstruct.language.parts import MESHED, MaterialName, PartSpec
from femstruct.language.places import AnyRegion, RegionSpec
from femstruct.modal import damping
from femstruct.model.constraints import Average, Equation, RigidLink
from femstruct.model.materials import AnyMaterial, EdgeWall, Material
from femstruct.model.regions import Facing, Region, Side
from femstruct.model.seams import Seam
from femstruct.model.structure import (
    ABOUT,
    ACROSS,
    HARD,
    SOFT,
    Constraint,
    Edge,
    Fix,
    Joint,
    PlaceOn,
    Support,
    SurfaceOn,
    pins,
)
from femstruct.quantities import (
    LENGTH,
    AnyRatio,
    Component,
    Coordinate,
    Frequency,
    Length,
    LossFactor,
    MassKg,
    Measured,
    Modulus,
    Position2,
    Position3,
    Quantity,
    Ratio,
    refuse,
)
from femstruct.study.structures import BeamEnd, BeamModel, ModesModel, NoStructure, OscillatorModel, RodModel
from femstruct.units import QuantityError, quantity
from femstruct.yaml.reader import Here, nearest
from femstruct.yaml.spec import Count, PointName, Spec, Text, only, read_by, so_many, words_of

# ----------------------------------------------------------------------------------------------------------------------
# Points as they are written.
# ----------------------------------------------------------------------------------------------------------------------

AtWord = Literal["center", "top", "bottom"]
_WRITTEN = AtWord | Coordinate | list[Coordinate] | list[list[Coordinate]]


def coordinates(value: object) -> tuple[float, ...]:
    """The coordinates of one place [m]."""
    if not isinstance(value, list) or not 1 <= len(value) <= 3:
        raise refuse(quote_value(value), "a list of coordinates", "write center, [x, y] or [[x, y], [x, y]]")
    return tuple(Quantity(("length",)).read(one) for one in value)


def places(value: object) -> tuple[tuple[float, ...], ...]:
    """The coordinates of one place or of several."""
    if isinstance(value, list) and value and all(isinstance(one, list) for one in value):
        return tuple(coordinates(one) for one in value)
    return (coordinates(value),)


def _at(value: object) -> object:
    """A word, a position along a bar, [x, y], [x, y, z], or a list of positions."""
    if isinstance(value, str) and value in get_args(AtWord):
        return value
    if isinstance(value, list):
        return places(value)
    try:
        return ((quantity(value, "length"),),)
    except QuantityError as error:
        raise refuse(error.got, "center, [x, y] or [[x, y], [x, y]]", nearest(str(value), get_args(AtWord))) from None


_PATCH_MEANT = "write it like 5 mm or [20 mm, 30 mm]"
_patch = so_many(LENGTH.read, (2,), "a radius, or two sides", _PATCH_MEANT, or_one=True)
"""The radius of a disc, or the two sides of a rectangle."""


class PointSpec(Spec):
    """A named place; of a rod or beam a position along it, of an oscillator nothing. On a plate it may be a patch. Of a
    part that is a mesh it may be the mean of a set. at: of a plate or slab in its own coordinates, from its origin; of
    a block from its lower corner, its origin; of frames, meshes and matrices in global coordinates."""

    at_most_one_of = (("at", "set"),)

    on: Annotated[Text, Refers()] | None = None
    at: Annotated[AtWord | tuple[tuple[float, ...], ...], read_by(_at, _WRITTEN)] | None = None
    side: Side = "above"
    patch: Annotated[float | tuple[float, float] | None, read_by(_patch, Length | list[Length])] = None
    set: Text | None = None

    @property
    def count(self) -> int:
        """How many places it has."""
        return len(self.at) if isinstance(self.at, tuple) else 1

    def check_on(self, here: Here, parts: Mapping[str, PartSpec]) -> None:
        """Note what is wrong with it as a point on a part."""
        for key in ("on", "at") if self.set is None else ("on",):
            here.need(getattr(self, key) is not None, "nothing", f"'{key}'", f"add '{key}: ...'", of_key=True)
        if self.on is None or not here.at("on").known(self.on, "part" if self.set is None else MESHED):
            return
        part = parts[self.on]
        if self.at is not None:
            part.check_place(here.at("at"), self.at)
        here.at("patch").need(
            self.patch is None or "plate" in part.known_as,
            f"a patch on a {part.type}",
            "a patch on a plate",
            "remove it",
        )

    def place_on(self, name: str, parts: Mapping[str, PartSpec]) -> PlaceOn:
        """The place it describes."""
        on = self.on or ""
        if self.set is not None:
            return PlaceOn(name, on, (), self.side, self.patch, self.set)
        at = self.at if isinstance(self.at, tuple) else (parts[on].named_places[self.at or ""],)
        return PlaceOn(name, on, at, self.side, self.patch)


# ----------------------------------------------------------------------------------------------------------------------
# Surfaces as they are written.
# ----------------------------------------------------------------------------------------------------------------------


class SurfaceSpec(Spec):
    """A named side of a region of a plate, or of a set or all of a shell. side: above or below; of a wall x, -x, y or
    -y, the global direction in which it faces."""

    makes = SurfaceOn
    on: Annotated[Text, Refers("plate or shell")]
    side: Facing = "above"
    region: AnyRegion = RegionSpec()

    def check(self, here: Here) -> None:
        do = "use whole or {rectangle: [2.5, 4], at: [1.25, 2]}, its sides and its centre"
        here.at("region").need(not self.region.is_line, "a rim or line", "an area", do)


# ----------------------------------------------------------------------------------------------------------------------
# Supports as they are written.
# ----------------------------------------------------------------------------------------------------------------------

THICKEST: Final = 3.0  # m: no wall of a building is thicker
MOST_WALLS: Final = 4  # two plates go on from an edge in each of two directions


def _fix(value: object) -> object:
    if isinstance(value, str) and value in get_args(Fix):
        return value
    if isinstance(value, list) and value:
        return tuple(only(DIRECTIONS)(one) for one in value)
    expected = "simple, roller, clamped, simple hard, simple soft or a list of x, y, z, rx, ry, rz"
    raise refuse(quote_value(value), expected, "write it like [z, rx]")


def _walls(value: object) -> object:
    if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= MOST_WALLS:
        raise refuse(
            quote_value(value), f"1 to {MOST_WALLS}: how many walls stand at the edge", "write 2: above and below"
        )
    return value


class EdgeStiffnessSpec(Spec):
    """Springs along an edge, per length of it: z along the normal of the part, about edge against rotation about it."""

    short = "z"
    z: Annotated[float, Quantity(("stiffness/length",), above=0.0)] | None = None
    about_edge: Annotated[float, Quantity(("rotational stiffness/length",), above=0.0)] | None = Field(
        default=None, alias=ABOUT
    )

    def given(self) -> dict[str, Any]:
        both = {ACROSS: self.z, ABOUT: self.about_edge}
        return {key: value for key, value in both.items() if value is not None}


class EdgeWallSpec(Spec):
    """What walls at an edge are made of: an isotropic material and its thickness."""

    material: MaterialName
    thickness: Annotated[
        float,
        Quantity(("length",), above=0.0, most=THICKEST, too_large="a plain number is in metres: {number:g} mm?"),
    ]


class SupportSpec(Spec):
    """Held directions of an edge or line of a plate (a line: a wall under it), of a set or a box of a part that is a
    mesh, of a point, or of a whole part. Along the rim or a side of a slab or shell simple is soft, free to turn every
    way; simple hard holds its rotation about the normal to the edge, as thin plates have it. Springs along an edge with
    their loss factor; or walls: how many stand at a pinned edge and take bending waves away, wall: of what."""

    one_of = (("on", "at"),)
    at_most_one_of = (("edge", "line", "set", "box"), ("stiffness", "walls"))
    only_with = (("loss_factor", ("stiffness",)), ("walls", ("wall",)), ("wall", ("walls",)))

    makes = Support
    only_written = ("wall", "set", "box")
    fix: (
        Annotated[Fix | tuple[str, ...], read_by(_fix, Fix | list[Literal["x", "y", "z", "rx", "ry", "rz"]])] | None
    ) = None
    stiffness: EdgeStiffnessSpec | None = None
    loss_factor: Losses | None = None
    walls: Annotated[int, BeforeValidator(_walls)] | None = None
    wall: EdgeWallSpec | None = None
    on: Annotated[Text, Refers()] | None = None
    edge: Edge | None = None
    line: tuple[Position2, Position2] | None = None
    at: PointName | None = None
    set: Text | None = None
    box: tuple[Position3, Position3] | None = None

    @classmethod
    def refuse_keys(cls, given: Mapping[str, Any]) -> None:
        springs = given.get("stiffness") is not None or given.get("walls") is not None
        if given.get("fix") is None and not springs:
            raise refuse(
                "a support without 'fix'",
                "'fix', or springs along an edge",
                "add 'fix: simple', or 'stiffness: {z: ..}'",
            )
        if springs and all(given.get(key) is None for key in ("edge", "line", "set", "box")):
            key = "a stiffness" if given.get("stiffness") is not None else "walls"
            raise refuse(f"{key} of no edge", "an edge of a plate, or a set or box of a mesh", "add 'edge: all'")

    def check(self, here: Here) -> None:
        self._check_springs(here)
        along = self.edge is not None or self.line is not None
        among = self.set is not None or self.box is not None
        if self.on is None:
            here.at("fix").need(self.fix != HARD, f"'{HARD}' of a point", "an edge of a slab or shell", "write simple")
            got = "a set or a box of a point" if among else "an edge or line of a point"
            here.need(not along and not among, got, "only a point, or 'on: PART' with an edge")
            return
        if along and self.on in here.names.known[MESHED]:
            do = "of a slab write 'set: rim' or 'set: side 1', of another mesh a set or a box of it"
            here.at("on").wrong(f"'{self.on}'", "the name of a plate", do)
            return
        hard = here.at("fix")
        hard.need(not (along and self.fix == SOFT), f"'{SOFT}' of a thin plate", "simple", "soft edges take a slab")
        hard.need(among or along or self.fix != HARD, f"'{HARD}' of a whole part", "a set or box of a slab or shell")
        here.at("on").known(self.on, "plate" if along else MESHED if among else "part")
        if self.fix is None:
            return
        here.at("fix").need(
            along or self.fix != "roller", "a roller that is no edge or line", "directions", "write [z]"
        )
        here.at("fix").need(
            along or among or isinstance(self.fix, tuple),
            f"'{self.fix}' for a whole part",
            "an edge, a line or directions",
            "add edge: all, or list the directions as in [x, y]",
        )

    def _check_springs(self, here: Here) -> None:
        """Springs are in directions that nothing holds, and walls at a pinned edge."""
        if self.stiffness is None and self.walls is None:
            return
        there = here.at("fix")
        there.need(
            self.fix is None or pins(self.fix),
            f"{quote_value(self.fix)} beside {'walls' if self.walls else 'springs'}",
            "simple, roller, directions of x, y, z, or nothing",
            "what is clamped cannot turn; hold other directions by a support of their own",
        )
        if self.stiffness is not None:
            keys = self.stiffness.given()
            here.at("stiffness").need(keys, "no stiffness", "z, about edge or both", "write {z: 5 MN/m^2}")
            here.at("stiffness", "z").need(
                not isinstance(self.fix, str) or ACROSS not in keys,  # of directions the part's normal decides
                f"a stiffness beside fix: {self.fix}, which holds z",
                "one of them",
                "remove 'fix': the springs carry the edge",
                of_key=True,
            )

    def of(self, name: str, materials: Mapping[str, AnyMaterial]) -> Support:
        """The noun, of walls of the materials. Raises InputError for walls of an orthotropic one."""
        walls: tuple[EdgeWall, ...] = ()
        if self.wall is not None and self.walls:
            material = materials[self.wall.material]
            if not isinstance(material, Material):
                where = f"supports.{name}.wall.material"
                raise InputError(
                    where, got=f"a wall of '{material.name}', orthotropic", expected="an isotropic material"
                )
            walls = (EdgeWall(material, self.wall.thickness),) * self.walls
        made = self.noun(name=name, walls=walls)
        assert isinstance(made, Support)
        return made

    def given(self) -> dict[str, Any]:
        values = super().given()
        values["fix"] = self.fix or ("simple" if self.walls else ())
        values["stiffness"], values["loss_factor"] = values["stiffness"] or {}, self.loss_factor or 0.0
        if self.set is not None or self.box is not None:
            values["region"] = Region("box" if self.set is None else "set", named=self.set, box=self.box)
        return values


# ----------------------------------------------------------------------------------------------------------------------
# Joints as they are written.
# ----------------------------------------------------------------------------------------------------------------------

Slip = Annotated[Measured, Quantity(("stiffness/length", "stiffness/area"), least=0.0, which=True)]
Sprung = Annotated[Measured, Quantity(("stiffness", "stiffness/length"), least=0.0, which=True)]
Turned = Annotated[Measured, Quantity(("rotational stiffness", "rotational stiffness/length"), least=0.0, which=True)]
PartName = Annotated[Text, Refers("part", goes_with="parts")]


class JointStiffnessSpec(Spec):
    """Stiffness by direction, global axes: of the springs at each pair of joined nodes, or per length of the lines on
    which the parts touch."""

    x: Sprung | None = None
    y: Sprung | None = None
    z: Sprung | None = None
    rx: Turned | None = None
    ry: Turned | None = None
    rz: Turned | None = None

    def written(self) -> dict[str, Measured]:
        return {axis: one for axis in DIRECTIONS if (one := getattr(self, axis)) is not None}

    @property
    def spread(self) -> dict[str, bool]:
        """Whether each is per length."""
        return {axis: (one.dimension or "").endswith("/length") for axis, one in self.written().items()}


class JointSpec(Spec):
    """Where two parts touch they move together; directions with a stiffness are springs instead, one at every
    pair of joined nodes, or spread along the lines on which the parts touch where it is per length. sets: of parts that
    are meshes, which set is joined. reach: nodes that far from each other are joined by rigid arms. slip: of a sliding
    joint, what resists along the line, per length, or per area of what touches, with its width."""

    makes = Joint
    only_written = ("connect", "width")
    connect: tuple[PartName, PartName]
    kind: Literal["rigid", "pinned", "sliding"] = "rigid"
    stiffness: JointStiffnessSpec = JointStiffnessSpec()
    sets: dict[str, Text] = Field(default_factory=dict)
    reach: Length | None = None
    slip: Slip | None = None
    width: Length | None = None

    def check(self, here: Here) -> None:
        first, second = self.connect
        for name in self.sets:
            here.at("sets", name).known(name, MESHED)
            here.at("sets", name).need(name in self.connect, f"'{name}'", f"{first} or {second}", of_key=True)
        here.at("connect").need(first != second, f"'{first}' twice", "two different parts")
        here.at("slip").need(
            self.slip is None or self.kind == "sliding", f"a slip of a {self.kind} joint", "kind: sliding"
        )
        per_area = self.slip is not None and self.slip.dimension == "stiffness/area"
        here.at("slip" if per_area else "width").need(
            per_area == (self.width is not None),
            "a slip per area and no width" if per_area else "a width and no slip per area",
            "slip in N/m^3 and width, of what touches, or slip in N/m^2",
            of_key=True,
        )
        here.at("stiffness").need(
            not self.stiffness.written() or self.kind != "sliding",
            "springs of a sliding joint",
            "no stiffness",
            "write the stiffness along the line as 'slip', per length",
        )
        do = "leave the direction out: it is rigid then; 'kind: pinned' lets the parts turn"
        spread = self.stiffness.spread
        for axis, one in sorted(self.stiffness.written().items()):
            here.at("stiffness", axis).need(one.value, "0", "a positive stiffness", do)
            here.at("stiffness", axis).need(
                spread[axis] or not any(spread.values()),
                "a stiffness of springs at pairs of nodes beside one per length",
                f"{'N*m/m' if axis.startswith('r') else 'N/m^2'}, per length, as the others",
            )

    def given(self) -> dict[str, Any]:
        a, b = self.connect
        stiffness = {axis: one.value for axis, one in self.stiffness.written().items()}
        per = "length" if any(self.stiffness.spread.values()) else "pair"
        slip = 0.0 if self.slip is None else self.slip.value * (self.width or 1.0)
        return {**super().given(), "a": a, "b": b, "stiffness": stiffness, "slip": slip, "per": per}


# ----------------------------------------------------------------------------------------------------------------------
# Constraints as they are written.
# ----------------------------------------------------------------------------------------------------------------------

_REGIONS: Final = ("rim", "rectangle", "line", "set", "box")
_MEANT: Final = "write [P, Q], or {on: PART, set: NAME}"


class OthersSpec(RegionSpec):
    """Names of points, or a region of a part."""

    one_of = (("points", "on"),)
    points: tuple[Text, ...] | None = None
    on: Annotated[Text, Refers("part")] | None = None

    def check(self, here: Here) -> None:
        for number, name in enumerate(self.points or ()):
            there = here.at(number)
            (there if there.steps in here.tree.values else here).known(name, "point")


def _others(value: object) -> object:
    """One name of a point, several, or a region of a part."""
    names = [value] if isinstance(value, str) else value
    if isinstance(names, list) and names and all(isinstance(one, str) for one in names):
        return {"points": tuple(names)}
    if not isinstance(value, dict) or "points" in value:
        raise refuse(quote_value(value), "names of points, or a region of a part", _MEANT)
    if value.keys() <= {"on", "at", *_REGIONS}:
        exactly_one(value, _REGIONS, or_none=True)
    return value


Others = Annotated[OthersSpec, read_by(_others, Text | list[Text] | OthersSpec)]


class ConstraintSpec(Spec):
    """Equations between points: `rigid`, a point that others follow on rigid arms; `average`, a point that moves as the
    rigid motion that fits others best; `equation`, a sum of displacements, each by its factor, that stays zero; `seam`,
    the finer of two meshes that meet along a line, or solids with flat faces, with different nodes, and `onto`, the
    other."""

    one_of = (("rigid", "average", "equation", "seam"),)
    only_with = (
        ("rigid", ("to",)),
        ("average", ("of",)),
        ("to", ("rigid",)),
        ("of", ("average",)),
        ("seam", ("onto",)),
        ("onto", ("seam",)),
    )
    at_most_one_of = (("directions", "equation"),)

    rigid: PointName | None = None
    to: Others | None = None
    average: PointName | None = None
    of: Others | None = None
    equation: dict[str, AnyRatio] | None = None
    seam: Others | None = None
    onto: Others | None = None
    directions: Annotated[tuple[str, ...], words_of(DIRECTIONS)] | None = None

    def check(self, here: Here) -> None:
        for spot in self.equation or ():
            here.at("equation", spot).spot(spot, of_key=True)
        for key in ("rigid", "average"):
            if (name := getattr(self, key)) is not None:
                here.at(key).place(name)
        for key in ("to", "of", "seam", "onto"):
            if (others := getattr(self, key)) is not None:
                others.check(here.at(key))
        for key in ("seam", "onto"):
            side = getattr(self, key)
            here.at(key).need(
                side is None or side.set is not None or side.box is not None,
                "no nodes of a mesh",
                "a set or a box of a part that is a mesh",
                "write {on: PART, set: NAME}",
            )
        if self.to is not None and self.to.on is not None:
            here.at("to").need(
                self.to.set is not None or self.to.box is not None,
                f"a region of {self.to.on}",
                "a set or a box of a part that is a mesh",
                "lay a rigid block on a plate: parts.NAME: {type: block, ...}, and a joint",
            )

    def noun(self, **others: Any) -> Constraint:
        """The kind of constraint that its keys say."""
        name: str = others["name"]
        if self.equation is not None:
            return Equation(name, self.equation)
        directions = self.directions or DIRECTIONS
        if self.seam is not None and self.onto is not None:
            sides = [(side.on or "", Region(**side.given())) for side in (self.seam, self.onto)]
            return Seam(name, *sides[0], *sides[1], directions)
        among = self.to if self.rigid is not None else self.of
        assert among is not None  # `only_with` has seen to it
        region = None if among.on is None else Region(**among.given())
        if self.rigid is not None:
            return RigidLink(name, self.rigid, among.points or (), among.on, region, directions)
        return Average(name, self.average or "", among.points or (), among.on, region, directions)


# ----------------------------------------------------------------------------------------------------------------------
# The damping of a structure as it is written.
# ----------------------------------------------------------------------------------------------------------------------


class RayleighSpec(Spec):
    """C = alpha M + beta K."""

    makes = damping.Rayleigh
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

    makes = damping.Damping
    short = "loss_factor"
    ratio: Ratio | None = None
    loss_factor: LossFactor | None = None
    rayleigh: RayleighSpec | None = None
    source: Literal["materials"] | None = Field(default=None, alias="from")
    modes: dict[str, ModeDampingSpec] = Field(default_factory=dict)

    @classmethod
    def meant_by(cls, value: object) -> str:
        return "{from: materials}" if value == "materials" else super().meant_by(value)

    def check(self, here: Here) -> None:
        given, do = self.rayleigh is None or self.rayleigh.model_fields_set, "write it like {beta: 1e-5 s}"
        here.at("rayleigh").need(given, "no alpha and no beta", "one or both of them", do)
        for mode in self.modes:
            here.at("modes", mode).need(
                re.fullmatch("[1-9][0-9]{0,5}", mode), f"'{mode}'", "a mode number from 1", of_key=True
            )

    def given(self) -> dict[str, Any]:
        base = self.rayleigh.noun() if self.rayleigh is not None else damping.Ratio(self.ratio or 0.0)
        if self.loss_factor is not None:
            base = damping.LossFactor(self.loss_factor)
        elif self.source is not None:
            base = damping.FromMaterials()
        modes = [damping.ModeDamping(int(n), one.near, one.ratio, one.loss_factor) for n, one in self.modes.items()]
        return {"base": base, "modes": tuple(modes)}


# ----------------------------------------------------------------------------------------------------------------------
# Structures in closed form as they are written: `structure:` in place of parts.
# ----------------------------------------------------------------------------------------------------------------------


class ClosedFormSpec(Spec):
    """A structure known in closed form."""

    type: str

    def structure(self, points: Mapping[str, PointSpec]) -> Any:
        """The noun it describes, with points along it."""
        return self.noun()

    def check_point(self, here: Here, point: PointSpec) -> None:
        """Note what is wrong with a point on it."""
        here.wrong(
            f"a point of structure '{self.type}'",
            "the structure's own 'points'" if self.type == "modes" else "no points: there is no structure",
            "move or remove it",
            of_key=True,
        )


class NoStructureSpec(ClosedFormSpec):
    """Only bodies and the ground."""

    makes = NoStructure
    type: Literal["none"]


class OscillatorSpec(ClosedFormSpec):
    """A mass on a spring, by its frequency or its stiffness."""

    one_of = (("frequency", "stiffness"),)

    type: Literal["oscillator"]
    mass: MassKg
    frequency: Frequency | None = None
    stiffness: Annotated[float, Quantity(("stiffness",), above=0.0)] | None = None

    def structure(self, points: Mapping[str, PointSpec]) -> OscillatorModel:
        return OscillatorModel(self.mass, self.frequency, self.stiffness, dict.fromkeys(points, 0.0))

    def check_point(self, here: Here, point: PointSpec) -> None:
        here.need(point.at is None and point.on is None, "a place", "{} for a point of an oscillator")


class AlongSpec(ClosedFormSpec):
    """What lies along x."""

    length: Length

    def structure(self, points: Mapping[str, PointSpec]) -> Any:
        along = {name: one.at[0][0] if isinstance(one.at, tuple) else self.length / 2 for name, one in points.items()}
        return self.noun(points=along)

    def check_point(self, here: Here, point: PointSpec) -> None:
        expected = f"a position from 0 to {self.length:g} m"
        for one in point.at if isinstance(point.at, tuple) else ():
            here.at("at").need(
                len(one) == 1 and 0 <= one[0] <= self.length,
                f"{one[0]:g} m" if len(one) == 1 else f"{len(one)} coordinates",
                f"{expected} along it",
            )
        here.at("at").need(point.at not in ("top", "bottom"), f"{point.at} of a {self.type}", expected, "write center")
        here.need(point.at is not None, "nothing", "'at'", "add 'at: 0'", of_key=True)
        here.at("on").need(point.on is None, "'on'", f"a position along the {self.type} only", "remove it", of_key=True)


class RodSpec(AlongSpec):
    """A free elastic rod along x."""

    makes = RodModel
    type: Literal["rod"]
    length: Length
    E: Modulus
    rho: Annotated[float, Quantity(("density",), above=0.0)]
    area: Area
    modes: Count = 50


class BeamSpec(AlongSpec):
    """A beam along x that deflects along z."""

    makes = BeamModel
    type: Literal["beam"]
    length: Length
    ends: tuple[BeamEnd, BeamEnd]
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


class GivenModesSpec(ClosedFormSpec):
    """Given modes: frequencies, damping ratios and mass-normalised shapes at points [1/sqrt(kg)]; a point that is above
    or below another says where, {shape: [..], at: 0.2 m}."""

    type: Literal["modes"]
    frequency: Annotated[list[Annotated[float, Quantity(("frequency",), least=0.0)]], Field(min_length=1)]
    ratio: list[Ratio] | None = None
    points: dict[str, GivenPoint]

    def structure(self, points: Mapping[str, PointSpec]) -> ModesModel:
        count = len(self.frequency)
        ratios = self.ratio if self.ratio is not None else [0.0] * count
        if len(ratios) != count:
            raise FemstructError("structure.ratio", got=f"{len(ratios)} ratios", expected=f"{count}, one a frequency")
        if any(later < former for former, later in pairwise(self.frequency)):
            frequencies = ", ".join(f"{frequency:g}" for frequency in self.frequency)
            raise FemstructError("structure.frequency", got=f"[{frequencies}] Hz", expected="frequencies that ascend")
        for name, point in self.points.items():
            if len(point.shape) != count:
                raise FemstructError(
                    f"structure.points.{name}", got=f"{len(point.shape)} values", expected=f"{count}, one a mode"
                )
        shapes = {name: tuple(point.shape) for name, point in self.points.items()}
        at = {name: point.at for name, point in self.points.items() if point.at is not None}
        return ModesModel(tuple(self.frequency), tuple(ratios), shapes, at)


def _structure(value: object) -> object:
    return {"type": "none"} if value == "none" else value


_Structures = Annotated[
    NoStructureSpec | OscillatorSpec | RodSpec | BeamSpec | GivenModesSpec, Field(discriminator="type")
]
StructureSpec = Annotated[_Structures, read_by(_structure, Literal["none"] | _Structures)]
