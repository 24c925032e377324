"""What a structure is, before it is meshed: parts, joints, places, supports, in SI units and resolved names.

The language wing makes a `Structure` of a YAML file; a script can write one by hand. The mesher makes a `Model` of it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, get_args

import numpy as np

from femstruct.conventions import DIRECTIONS
from femstruct.errors import InputError
from femstruct.model.material import Material
from femstruct.model.section import Section

Vector = tuple[float, float, float]
Pair = tuple[float, float]
Side = Literal["above", "below"]
Fix = Literal["simple", "clamped"]
Edge = Literal["x0", "x1", "y0", "y1", "all"]
Six = tuple[float, float, float, float, float, float]  # x y z rx ry rz, global axes
NO_STIFFNESS: Six = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Region:
    """A region of a plate: all of it, a rectangle, the rim of a rectangle, or a line.

    size : sides of the rectangle or rim [m]. at : its centre from the part's origin corner along the part's own axes
    [m], None for the centre of the part. line : the two ends of a line, part coordinates [m].
    """

    kind: Literal["whole", "rectangle", "rim", "line"]
    size: Pair | None = None
    at: Pair | None = None
    line: tuple[Pair, Pair] | None = None


@dataclass(frozen=True)
class Plate:
    """A flat rectangular plate; `origin` is a corner of its mid-surface, `size` runs along x_direction and normal x it.

    mesh : largest element side [m], or the least number of divisions (nx, ny).

    >>> steel = Material("steel", E=210e9, nu=0.3, rho=7850.0)
    >>> Plate("floor", steel, thickness=5e-3, origin=(0.0, 0.0, 0.0), size=(0.4, 0.3), mesh=0.05).element
    'bfs16'
    """

    name: str
    material: Material
    thickness: float
    origin: Vector
    size: Pair
    mesh: float | tuple[int, int]
    element: Literal["hermite12", "acm12", "bfs16"] = "bfs16"
    normal: Vector = (0.0, 0.0, 1.0)
    x_direction: Vector | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.material, Material):
            raise InputError(f"parts.{self.name}.material", got=f"{self.material!r}", expected="a Material")
        if not isinstance(self.mesh, tuple | float | int):
            raise InputError(f"parts.{self.name}.mesh", got=f"{self.mesh!r}", expected="a size or a tuple (nx, ny)")
        side = min(self.size)
        if self.thickness > side > 0:
            meant = f"plain numbers are metres: {self.thickness:g} mm?"
            raise InputError(
                f"parts.{self.name}.thickness",
                got=f"{self.thickness:g} m",
                expected=f"at most the plate's shorter side, {side:g} m",
                do=meant if self.thickness > 1.0 else "what is thicker than wide is a frame or a block",
            )


@dataclass(frozen=True)
class Frame:
    """Bars along polylines of global points; coincident ends of its own lines are joined.

    mesh : largest element length [m], None for one element a segment; a line that lies in a plate it is joined to takes
    the plate's nodes instead. orientation : a vector the section's local z
    (its height) points along as nearly as it can.
    element : timoshenko18, a bar of three nodes whose frequencies converge with the fourth power of its length;
    timoshenko, of two, with the second where shear matters; euler, without shear and rotary inertia.
    start_offset, end_offset : rigid arms from the first and last point of every line to the ends of the flexible bar,
    global axes [m]. Where both are the same the whole line is eccentric: its nodes stay on the line, joined there to
    what it touches, and every bar hangs beside it on arms at both ends, as a rib under a plate does. Two different
    ones go over into each other along the line; one at an end alone leaves the other points of the line where they
    are. What differs along the line itself only shortens or lengthens the bar.
    """

    name: str
    material: Material
    section: Section
    lines: tuple[tuple[Vector, ...], ...]
    mesh: float | None = None
    orientation: Vector | None = None
    element: Literal["timoshenko18", "timoshenko", "euler"] = "timoshenko18"
    start_offset: Vector = (0.0, 0.0, 0.0)
    end_offset: Vector = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Block:
    """A rigid body: a box along the global axes; `origin` is its lower corner (least x, y and z).

    mass [kg]; size : along x, y, z [m]. center : the centre of mass from the lower corner [m], None for the middle.
    inertia : moments about the centre of mass along x, y, z, which are its principal axes [kg m^2]; None for those of
    a uniform box of this mass and size.
    """

    name: str
    mass: float
    origin: Vector
    size: Vector
    center: Vector | None = None
    inertia: Vector | None = None

    @property
    def middle(self) -> Vector:
        """Middle of the box from its lower corner [m]."""
        a, b, c = self.size
        return a / 2.0, b / 2.0, c / 2.0

    @property
    def moments(self) -> Vector:
        """Moments of inertia about the centre of mass along x, y, z [kg m^2]; m (b^2 + c^2) / 12 for the box."""
        if self.inertia is not None:
            return self.inertia
        x, y, z = (self.mass * side**2 / 12.0 for side in self.size)
        return y + z, z + x, x + y


@dataclass(frozen=True)
class Foundation:
    """A Winkler foundation under a region of a plate or a block, to the ground or to another plate or block.

    to : the other part, None for the ground. Between two parts it fills the gap between their facing sides, which are
    parallel; its shear acts in the middle of the gap, through arms of the thickness of both, so that a rigid motion of
    both strains nothing. To the ground it acts on the mid-surface of a plate, on the lower face of a block.
    region : of `on`; the whole is all that faces the other part.
    normal, shear : stiffness per area [N/m^3] of a whole or rectangle region, per length [N/m^2] of a rim or line.
    """

    name: str
    on: str
    region: Region
    normal: float
    shear: float = 0.0
    loss_factor: float = 0.0
    to: str | None = None


@dataclass(frozen=True)
class Spring:
    """A spring and dashpot between two places, or a place and the ground; several places of a point: one each.

    Two places apart from each other are joined in the middle between them, through rigid arms.

    stiffness, damping : x y z rx ry rz along global axes [N/m, N m/rad] and [N s/m, N m s/rad].
    """

    name: str
    a: str
    b: str | None
    stiffness: Six = NO_STIFFNESS
    damping: Six = NO_STIFFNESS


@dataclass(frozen=True)
class Mass:
    """A mass without elasticity: at the places of a point (kg each), over a region of a plate, or along a frame.

    per : what `mass` is counted by: "total" [kg], "length" [kg/m] along a rim, a line or all bars of a frame, "area"
    [kg/m^2].
    """

    name: str
    mass: float
    at: str | None = None
    on: str | None = None
    region: Region | None = None
    per: Literal["total", "length", "area"] = "total"


@dataclass(frozen=True)
class Joint:
    """Where two parts touch they move together: rigid (all six), pinned (translations).

    stiffness : directions (x y z rx ry rz, global) that are springs instead of rigid or free [N/m, N m/rad], one at
    every pair of joined nodes.
    """

    name: str
    a: str
    b: str
    kind: Literal["rigid", "pinned"] = "rigid"
    stiffness: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class PlaceOn:
    """A named point of a part; several positions are NAME.1, NAME.2 (and NAME means all of them).

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
    at: tuple[tuple[float, ...], ...]
    side: Side = "above"
    patch: float | Pair | None = None

    def __post_init__(self) -> None:
        _refuse_unless_one_of(f"points.{self.name}.side", self.side, get_args(Side))
        if not len(self.at) or any(np.ndim(place) != 1 for place in self.at):
            expected = "a tuple of places: ((x, y),) for one on a plate"
            raise InputError(f"points.{self.name}.at", got=f"{self.at}", expected=expected)


@dataclass(frozen=True)
class SurfaceOn:
    """A named side of a region of a plate, where it radiates or is pressed."""

    name: str
    on: str
    side: Side = "above"
    region: Region = Region("whole")

    def __post_init__(self) -> None:
        _refuse_unless_one_of(f"surfaces.{self.name}.side", self.side, get_args(Side))


@dataclass(frozen=True)
class Support:
    """Held directions: of an edge or line of a plate, of a point, or of a whole part.

    fix : "simple", "clamped" or directions out of x y z rx ry rz. On a plate's edge or line, `simple` holds the
    deflection and the slope along the edge and the plate in its own plane, `clamped` also the slope across and the
    twist; at a point `simple` holds x y z and `clamped` all six.

    >>> Support("walls", "simple", on="floor", edge="all").fix, Support("foot", ("z",), at="corner").fix
    ('simple', ('z',))
    """

    name: str
    fix: Fix | tuple[str, ...]
    on: str | None = None
    edge: Edge | None = None
    line: tuple[Pair, Pair] | None = None
    at: str | None = None

    def __post_init__(self) -> None:
        where = f"supports.{self.name}"
        if self.edge is not None:
            _refuse_unless_one_of(f"{where}.edge", self.edge, get_args(Edge))
        if self.fix in get_args(Fix):
            return
        if not isinstance(self.fix, tuple) or not self.fix or not set(self.fix) <= set(DIRECTIONS):
            expected = f"simple, clamped, or a tuple of {', '.join(DIRECTIONS)}"
            raise InputError(f"{where}.fix", got=f"{self.fix!r}", expected=expected)


Part = Plate | Frame | Block | Foundation | Spring | Mass


@dataclass(frozen=True)
class Structure:
    """Everything a model file says about the structure, in SI units.

    parts : plates, frames, blocks, foundations, springs and masses. joints : where they move together. points,
    surfaces : named places. supports : what is held. Names are unique over all of it; the mesher checks that they
    exist.

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


def _refuse_unless_one_of(where: str, word: str, known: tuple[str, ...]) -> None:
    if word not in known:
        raise InputError(where, got=f"{word!r}", expected=" or ".join(known))
