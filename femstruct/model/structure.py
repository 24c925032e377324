"""What a structure is, before it is meshed: parts, joints, places, supports, in SI units and resolved names.

The language wing makes a `Structure` of a YAML file; a script can write one by hand. The mesher makes a `Model` of
it. The kinds of parts stand in `femstruct.parts`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, Literal

import numpy as np

from femstruct.conventions import DIRECTIONS
from femstruct.declared import NotNegative, Positive, checked
from femstruct.errors import InputError
from femstruct.model.materials import EdgeWall, Loss, check_loss
from femstruct.model.part import FilledBox, Part, Tie
from femstruct.model.regions import Facing, Pair, Region, Side
from femstruct.tags import stored_as

if TYPE_CHECKING:
    from femstruct.model.layout import Layout
    from femstruct.model.model import Model


# ----------------------------------------------------------------------------------------------------------------------
# What a kind of constraint offers: which places it is about, and the equations between them.
# ----------------------------------------------------------------------------------------------------------------------

_IN_PLANE = 1e-6  # of a unit vector: less is rounding


class Constraint(ABC):
    """Homogeneous linear equations between places of parts, by name; the base of all kinds."""

    name: str

    @abstractmethod
    def holds(self) -> Mapping[str, tuple[str, ...]]:
        """The points it is about, and in which directions."""

    def region(self) -> tuple[str, Region] | None:
        """The part whose region it is about, and the region; None where it is about points alone."""
        return None

    @abstractmethod
    def tie(self, model: Model, tolerance: float) -> Tie:
        """Its equations. The force is the one on what follows, or on the ground where the equations do not balance."""

    def needs(self, layout: Layout, points: Mapping[str, PlaceOn]) -> None:
        """Ask for the grid lines of its region, and for plates that stretch where it pulls them in their planes."""
        region = self.region()
        if region is not None:
            part, where = region
            if part not in layout.segments:
                layout.on_region(f"constraints.{self.name}.region", part, where)
            layout.pulled |= {part} & layout.rectangles.keys()
        for name, directions in self.holds().items():
            place = points.get(name) or points.get(name.rpartition(".")[0])
            if place is not None and place.on in layout.rectangles:
                normal = layout.axes_of[place.on][2]
                if any(_is_in_plane(direction, normal) for direction in directions):
                    layout.pulled.add(place.on)


def _is_in_plane(direction: str, normal: np.ndarray) -> bool:
    """Whether a plate has to stretch or shear for a direction of a point on it; its rotations in the plane bend it."""
    if direction == "n":
        return False
    axis = np.eye(3)[DIRECTIONS.index(direction) % 3]
    along = float(abs(axis @ normal))
    return along > _IN_PLANE if direction.startswith("r") else float(np.sqrt(max(0.0, 1.0 - along**2))) > _IN_PLANE


# ----------------------------------------------------------------------------------------------------------------------
# Cavities as a model has them: air between two surfaces of the structure, by name.
# ----------------------------------------------------------------------------------------------------------------------


@stored_as("fill of a cavity/1")
@dataclass(frozen=True)
@checked("cavities")
class Fill:
    """Wool in a cavity, against its second surface.

    flow_resistivity [Pa s/m^2]; density : of the bulk [kg/m^3]; thickness : [m], all of the depth if left out. frame :
    "limp", fibres that the air carries along, or "held", fibres at rest. like : the entry of the library, with its
    source.

    Raises InputError: numbers that are not positive, another frame.

    >>> Fill(flow_resistivity=10e3, density=40.0, thickness=0.1).frame
    'limp'
    """

    flow_resistivity: Positive
    density: Positive
    thickness: Positive | None = None
    frame: Literal["limp", "held"] = "limp"
    like: str = ""


@stored_as("bays of a cavity/1")
@dataclass(frozen=True)
@checked("cavities")
class Bays:
    """Joists that close a cavity: every bay between two of them is a cavity of its own.

    across : the axis of the first surface that they divide. at : where their middles are along it, from the corner of
    the cavity [m]. width : of a joist, which takes its place from the air [m].

    >>> Bays("y", at=(0.6, 1.2), width=0.045).at
    (0.6, 1.2)
    """

    across: Literal["x", "y"]
    at: tuple[float, ...]
    width: NotNegative = 0.0


@stored_as("cavity between parts/1")
@dataclass(frozen=True)
@checked("cavities")
class AirBetween:
    """Air between two parallel surfaces that face each other; its four sides are rigid.

    first, second : names of surfaces; wool lies against the second. depth [m]. c [m/s], rho [kg/m^3] : of the air.
    fill : wool; None for none. bays : where joists close it; None for one cavity. up_to : modes of the air up to it
    are coordinates of their own [Hz]; None for as many as the modes of the structure need, 400 at most.

    Raises InputError: numbers that are not positive, a surface beside itself, wool thicker than the cavity.

    The void between a floor and its ceiling, half filled:

    >>> AirBetween("void", "underside", "ceiling top", depth=0.2, fill=Fill(10e3, 40.0, thickness=0.1)).c
    343.0
    """

    name: str
    first: str
    second: str
    depth: Positive
    c: Positive = 343.0
    rho: Positive = 1.21
    fill: Fill | None = None
    bays: Bays | None = None
    up_to: Positive | None = None

    def __post_init__(self) -> None:
        where = f"cavities.{self.name}"
        if self.first == self.second:
            expected = "two surfaces that face each other"
            raise InputError(f"{where}.between", got=f"'{self.first}' twice", expected=expected)
        thickness = None if self.fill is None else self.fill.thickness
        if thickness is not None and thickness > self.depth * (1 + 1e-9):
            raise InputError(
                f"{where}.fill.thickness",
                got=f"{thickness:g} m of wool in a cavity {self.depth:g} m deep",
                expected="at most the depth",
                do="leave it out to fill the cavity",
            )


# ----------------------------------------------------------------------------------------------------------------------
# What a structure is, before it is meshed.
# ----------------------------------------------------------------------------------------------------------------------

Fix = Literal["simple", "simple soft", "simple hard", "clamped", "roller"]
SOFT: Final = "simple soft"
HARD: Final = "simple hard"
SIMPLE: Final = ("simple", SOFT, HARD)
Edge = Literal["x0", "x1", "y0", "y1", "all"]
ACROSS: Final = "z"  # of a plate: along its normal
ABOUT: Final = "about edge"
FIXED: Final = f"simple, roller, clamped, simple hard, simple soft, or a tuple of {', '.join(DIRECTIONS)}"
WHOLE = Region("whole")


@stored_as("joint/1")
@dataclass(frozen=True)
@checked("joints")
class Joint:
    """Where two parts touch they move together: rigid (all six), pinned (translations), sliding (all but along the line
    on which they touch).

    Slabs and shells that touch along lines are joined all along them, whether their nodes coincide or not, and solids
    all over the flat faces that touch; bars where they end on cells of a slab or shell. Other parts are joined where
    nodes of both are at one place.

    sets : of parts that are meshes, by name of the part: the set of it that is joined. reach : nodes of the first part
    follow the nearest of the second within this distance [m], on rigid arms, as from the edge of a web on the face of a
    flange to its middle; None joins nodes at one place only.
    stiffness : directions (x y z rx ry rz, global) that are springs instead of rigid or free, one at every pair of
    joined nodes [N/m, N m/rad], or, where `per` is "length", spread along the lines on which the parts touch [N/m^2,
    N m/rad/m]. slip : of a sliding joint, the stiffness per length that resists along the line [N/m^2]: the slip
    modulus of screws or nails over their spacing, or of glue times its width; 0 slides freely.

    A tube that stands on a plate: rigid, or free to turn with a spring of 5 kN m/rad about x:

    >>> Joint("weld", "tube", "plate").kind
    'rigid'
    >>> dict(Joint("hinge", "tube", "plate", kind="pinned", stiffness={"rx": 5e3}).stiffness)
    {'rx': 5000.0}
    """

    name: str
    a: str
    b: str
    kind: Literal["rigid", "pinned", "sliding"] = "rigid"
    stiffness: Mapping[str, float] = field(default_factory=dict)
    sets: Mapping[str, str] = field(default_factory=dict)
    reach: float | None = None
    slip: float = 0.0
    per: Literal["pair", "length"] = "pair"

    def __post_init__(self) -> None:
        where = f"joints.{self.name}"
        if not (np.isfinite(self.slip) and self.slip >= 0.0):
            raise InputError(f"{where}.slip", got=f"{self.slip:g} N/m^2", expected="a finite value >= 0")
        if self.slip and self.kind != "sliding":
            raise InputError(f"{where}.slip", got=f"a slip of a {self.kind} joint", expected="kind: sliding")
        if self.stiffness and self.kind == "sliding":
            do = "write the stiffness along the line as 'slip', per length"
            raise InputError(f"{where}.stiffness", got="springs of a sliding joint", expected="none", do=do)


@stored_as("place on a part/1")
@dataclass(frozen=True)
@checked("points", at="a tuple of places: ((x, y),) for one on a plate")
class PlaceOn:
    """A named point of a part; several positions are NAME.1, NAME.2 (and NAME means all of them).

    named : of a part that is a mesh, a set of it in place of positions; the point is the mean of its nodes.
    at : positions from the part's origin corner along its own axes [m] for a plate, from the lower corner of a block;
    global ones for a frame.
    patch : on a plate, a point that is the mean of a disc of this radius or a rectangle of these sides [m] around it;
    what pushes it is spread evenly over the patch.

    One place is a tuple of one; a model has its point as `model.points["drop"]`:

    >>> PlaceOn("drop", "floor", at=((0.2, 0.1),)).side
    'above'
    """

    name: str
    on: str
    at: tuple[tuple[float, ...], ...] = ()
    side: Side = "above"
    patch: float | Pair | None = None
    named: str | None = None

    def __post_init__(self) -> None:
        if self.named is not None and self.at:
            raise InputError(f"points.{self.name}.at", got=f"{self.at} beside a set", expected="one of them")
        if self.named is None and not self.at:
            raise InputError(f"points.{self.name}.at", got="()", expected="one place or more")


@stored_as("surface of a part/1")
@dataclass(frozen=True)
@checked("surfaces")
class SurfaceOn:
    """A named side of a region of a plate or shell, where it radiates or is pressed.

    side : "above" or "below"; of what stands upright "x", "-x", "y" or "-y", the global direction in which it faces.

    The underside of a floor, which radiates into the room below; its area is the sum of its weights:

    >>> from femstruct import Material, Plate, mesh_structure
    >>> concrete = Material("concrete", E=30e9, nu=0.2, rho=2400.0)
    >>> floor = Plate("floor", concrete, 0.18, origin=(0.0, 0.0, 0.0), size=(5.0, 4.0), mesh=0.5)
    >>> model = mesh_structure(Structure("a floor", (floor,), surfaces=(SurfaceOn("ceiling", "floor", "below"),)))
    >>> ceiling = model.surfaces["ceiling"]
    >>> round(float(ceiling.weights.sum()), 9), float(ceiling.normal[2])
    (20.0, -1.0)
    """

    name: str
    on: str
    side: Facing = "above"
    region: Region = WHOLE


@stored_as("support/1")
@dataclass(frozen=True)
@checked("supports", fix=FIXED)
class Support:
    """Held directions: of an edge or line of a plate, of a set or a box of a part that is a mesh, of a point, or of a
    whole part.

    fix : "simple", "simple soft", "simple hard", "roller", "clamped" or directions out of x y z rx ry rz. On a plate's
    edge or line, `roller` holds the deflection and the slope along the edge, `clamped` everything. `simple` holds what
    `roller` does and the plate in its own plane, but does not keep it from stretching: all simple supports of a plate
    that stretches hold only the mean shifts and rotation of their edges there and, where it stands, its weight
    (`femstruct.model.plates_and_bars`).
    At a point, a set and in a box `simple` holds x y z and `clamped` all six. Elements that shear tell two kinds of
    simple supports apart along an edge of a slab or shell: `simple soft`, which `simple` is there, leaves all rotations
    free; `simple hard` holds the tangential one, about the normal to the edge in the plane of the part, along free
    edges between nodes of the set or in the box, as thin plates and Navier's solution have it.

    stiffness : of edges on springs, per length: "z" along the normal of the part [N/m^2], "about edge" against
    rotation about the edge [N m/rad/m]. Edges are those of a plate or a line on it, of a slab or shell its free edges
    in a set or box. fix is () then, or translations that leave the motion along the normal free where "z" is given;
    `simple`, `roller` or any translations beside "about edge" alone: a pinned edge.
    loss_factor : of these springs [1]. walls : at a pinned edge, each a semi-infinite plate (`EdgeWall`), in place of a
    stiffness.

    >>> Support("walls", "simple", on="floor", edge="all").fix, Support("foot", ("z",), at="corner").fix
    ('simple', ('z',))
    >>> strip = Support("strip", on="floor", edge="x0", stiffness={"z": 5e6, "about edge": 40e3}, loss_factor=0.2)
    >>> strip.fix, strip.loss_factor
    ((), 0.2)
    """

    name: str
    fix: Fix | tuple[str, ...] = ()
    on: str | None = None
    edge: Edge | None = None
    line: tuple[Pair, Pair] | None = None
    at: str | None = None
    region: Region | None = None
    stiffness: Mapping[str, float] = field(default_factory=dict)
    loss_factor: Loss = 0.0
    walls: tuple[EdgeWall, ...] = ()

    def __post_init__(self) -> None:
        where = f"supports.{self.name}"
        springs = bool(self.stiffness) and not self.walls
        if (isinstance(self.fix, tuple) and not set(self.fix) <= set(DIRECTIONS)) or not (self.fix or springs):
            raise InputError(f"{where}.fix", got=f"{self.fix!r}", expected=FIXED)
        check_loss(f"{where}.loss_factor", self.loss_factor)
        if self.loss_factor and not self.stiffness:
            raise InputError(f"{where}.loss_factor", got="a loss factor without springs", expected="a stiffness beside")
        if not self.stiffness and not self.walls:
            return
        if self.on is None or (self.edge is None and self.line is None and self.region is None):
            raise InputError(where, got="springs or walls of no edge", expected="an edge, line, set or box of a part")
        self._check_springs(where)

    def _check_springs(self, where: str) -> None:
        """Raise InputError for springs or walls in directions that are held, or of none."""
        if self.stiffness and self.walls:
            do = "walls resist the rotation about the edge themselves"
            raise InputError(f"{where}.stiffness", got="a stiffness beside walls", expected="one of them", do=do)
        known = (ACROSS, ABOUT)
        for key, value in self.stiffness.items():
            if key not in known or not value > 0.0:
                got, expected = f"{key}: {value:g}", f"positive stiffnesses of {' or '.join(map(repr, known))}"
                raise InputError(f"{where}.stiffness", got=got, expected=expected)
        if self.fix and not pins(self.fix):
            got, expected = f"{self.fix} beside springs or walls", "simple, roller, some of x, y, z, or nothing"
            raise InputError(f"{where}.fix", got=got, expected=expected)
        if isinstance(self.fix, str) and ACROSS in self.stiffness:
            do = "remove 'fix': the springs carry the edge"
            raise InputError(
                f"{where}.stiffness.z", got=f"a stiffness beside {self.fix}", expected="one of them", do=do
            )


def pins(fix: Fix | tuple[str, ...]) -> bool:
    """Whether what is held of an edge leaves it free to turn.

    >>> pins("simple"), pins(("z",)), pins("clamped"), pins(("z", "rx"))
    (True, True, False, False)
    """
    return fix in (*SIMPLE, "roller") if isinstance(fix, str) else set(fix) <= set(DIRECTIONS[:3])


@stored_as("structure/1")
@dataclass(frozen=True)
@checked("structure")
class Structure:
    """Everything a model file says about the structure, in SI units.

    parts : of the kinds in `femstruct.parts`. joints : where they move together. points, surfaces : named places.
    supports : what is held. constraints : equations between places, of the kinds in `femstruct.model.constraints`.
    cavities : air between two of the surfaces. Names are unique over all of it; the mesher checks that they exist.

    >>> from femstruct.model.materials import Material
    >>> from femstruct.parts.plate import Plate
    >>> steel = Material("steel", E=210e9, nu=0.3, rho=7850.0)
    >>> plate = Plate("plate", steel, 0.003, origin=(0.0, 0.0, 0.0), size=(0.5, 0.4), mesh=0.05)
    >>> on_edges = Structure("a plate", (plate,), supports=(Support("edges", "simple", on="plate", edge="all"),))
    >>> [part.name for part in on_edges.parts]
    ['plate']
    """

    title: str
    parts: tuple[Part, ...]
    joints: tuple[Joint, ...] = ()
    points: tuple[PlaceOn, ...] = ()
    surfaces: tuple[SurfaceOn, ...] = ()
    supports: tuple[Support, ...] = ()
    constraints: tuple[Constraint, ...] = ()
    cavities: tuple[AirBetween, ...] = ()


def extent(structure: Structure) -> float:
    """Largest side of the box around a structure [m].

    Raises InputError for a structure without a part that has a size, and for sizes a part cannot have.
    """
    corners = np.concatenate([np.zeros((0, 3)), *(part.corners() for part in structure.parts)])
    if not len(corners):
        raise InputError("parts", got="no part with a size", expected="a plate, a frame or a block")
    return float(np.ptp(corners, axis=0).max())


def bodies_of(structure: Structure) -> dict[str, FilledBox]:
    """The boxes that parts fill, by name, of those that layers can lie against."""
    return {part.name: body for part in structure.parts if (body := part.body()) is not None}
