"""What a kind of part offers to the rest of the program. The kinds stand in `femstruct.parts`, one file each.

A `Part` is described, a `Meshed` part has nodes. Whoever adds a kind overrides what it
has; what it has not is nothing. The way of a part, in order::

    corners, body              how large it is, what it fills                  before there is a mesh
    lay_out, needs             grid lines of its own, nodes it needs of others  femstruct.model.layout
    meshed -> Meshed           its nodes, and what they can do
    fastened -> Elastic, Inert, Tie    what it adds to nodes, its own or others'  once all parts are meshed

A kind may have nodes, be fastened to those of others, or both: then what is fastened may have the part's own name.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from femstruct.arrays import Floats, Integers, freeze, frozen
from femstruct.conventions import COMPONENTS, DIRECTIONS, N_COMPONENTS
from femstruct.errors import FemstructError, Finding, InputError
from femstruct.model.imported_mesh import Makes
from femstruct.model.materials import AnyMaterial, Given, Loss, given_fields
from femstruct.model.probe import Point, StressPlaces, Surface
from femstruct.model.regions import Region
from femstruct.tags import stored_as

if TYPE_CHECKING:
    from femstruct.model.attached import Attached, Users
    from femstruct.model.imported_mesh import ImportedMesh
    from femstruct.model.layout import Grids, Layout
    from femstruct.model.model import Model
    from femstruct.model.structure import PlaceOn, Support, SurfaceOn


# ----------------------------------------------------------------------------------------------------------------------
# What is fastened to nodes, as rows on their components: springs, masses, ties.
# ----------------------------------------------------------------------------------------------------------------------


@stored_as("elastic connection/1")
@dataclass(frozen=True, eq=False)
class Elastic:
    """Springs and dashpots that act on generalised displacements: lumped, spread over a region, or in a joint.

    rows [m, n_nodes * 7] : the displacements. stiffness, damping [m] : of each, area and length included [N/m].
    directions [m, 3] : global direction of the force each makes, zero for rotations. grounded : whether the force goes
    to the ground or to a second part. places [q, 3] : where they act [m], for pictures; none where nodes show it.
    grows_from : frequency [Hz] at which it has this stiffness, where it grows with the square root of frequency, as
    that of the edge of a semi-infinite plate does; None for a stiffness of all frequencies.
    """

    name: str
    rows: csr_array
    stiffness: Floats
    damping: Floats
    directions: Floats
    grounded: bool
    loss_factor: Loss = 0.0
    places: Floats = field(default_factory=lambda: np.zeros((0, 3)))
    grows_from: float | None = None

    def __post_init__(self) -> None:
        m = self.rows.shape[0]
        freeze(
            self,
            stiffness=frozen(f"{self.name} stiffness", self.stiffness, (m,)),
            damping=frozen(f"{self.name} damping", self.damping, (m,)),
            directions=frozen(f"{self.name} directions", self.directions, (m, 3)),
            places=frozen(f"{self.name} places", self.places, (None, 3)),
        )


@stored_as("attached inertia/1")
@dataclass(frozen=True, eq=False)
class Inert:
    """Mass without elasticity on generalised displacements.

    rows [m, n_nodes * 7] : global x, y, z displacements of its places, one place after the other, then rotations.
    mass [m] : of each place, three times [kg], then moments of inertia [kg m^2]. n_places : how many there are.
    """

    name: str
    rows: csr_array
    mass: Floats
    n_places: int

    @property
    def total(self) -> float:
        """What moves with a translation [kg]."""
        return float(self.mass[: 3 * self.n_places : 3].sum())

    def __post_init__(self) -> None:
        freeze(self, mass=frozen(f"{self.name} mass", self.mass, (self.rows.shape[0],)))


@stored_as("tie/1")
@dataclass(frozen=True, eq=False)
class Tie:
    """Displacements that are held at zero: a support, or the relative motion of the two sides of a joint.

    rows [m, n_nodes * 7]; directions [m, 3] : global direction of the force of each, zero for rotations.
    """

    name: str
    rows: csr_array
    directions: Floats
    grounded: bool

    def __post_init__(self) -> None:
        freeze(self, directions=frozen(f"{self.name} directions", self.directions, (self.rows.shape[0], 3)))


# ----------------------------------------------------------------------------------------------------------------------
# What a kind of part offers once it has nodes: its degrees of freedom, matrices, places, surfaces, drawing.
# ----------------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class OwnDofs:
    """Degrees of freedom of one part before ties, and the nodal components they make.

    labels : of the DOFs at a node, by name. extra : labels of those that belong to the part as a whole; they come after
    all nodes. rows, columns, values [m] : nodal components from the DOFs, both counted within the part from 0 on: row
    7 i + c is component c of the i-th of its places.
    translations [n, 3] : DOFs of unit translations along x, y, z.
    """

    labels: tuple[str, ...]
    extra: tuple[str, ...]
    rows: Integers
    columns: Integers
    values: Floats
    translations: Floats

    @property
    def count(self) -> int:
        """How many there are."""
        return len(self.translations)


class Drawn(NamedTuple):
    """A part for pictures: points [p, 3] [m], rows [3 p, n_nodes * 7] of their displacements, faces [q, 4] and lines
    [l, 2] between them."""

    points: Floats
    rows: csr_array
    quads: Integers
    lines: Integers


@stored_as("share of the losses/1")
class LossShare(NamedTuple):
    """What some materials of a part have of its stiffness: their names, loss factor and the matrix [n, n] on its
    degrees of freedom, the part of the energy of any motion that is theirs."""

    name: str
    loss_factor: Loss
    stiffness: csr_array


class RegionSpread(NamedTuple):
    """Points over a region of a part: nodes [p, k], rows [p, 6, k, 7] of their motion, global axes, weights [p] [m or
    m^2]; what a thing spread over it is counted by beside the total, and the word for the region."""

    nodes: Integers
    rows: Floats
    weights: Floats
    per: Literal["length", "area"]
    over: str


class EdgePoints(NamedTuple):
    """Points along edges of a part: nodes [p, k], rows [p, 6, k, 7] of their motion, global axes, weights [p] [m], and
    unit vectors across the part and along the edge [p, 3]."""

    nodes: Integers
    rows: Floats
    weights: Floats
    across: Floats
    along: Floats


class Meshed(ABC):
    """A part with nodes of its own, numbered from `first` on in the whole structure; the base of kinds that have some.

    What is abstract every kind has; the rest is for those that have it. Node numbers are those of the whole structure
    everywhere but in `dofs`.
    """

    first: int
    rigid: ClassVar[bool] = False  # one node with six degrees of freedom, as a block has: it can lean, and be counted
    has_surface: ClassVar[bool] = False  # where its nodes do not turn, its surface does (`turned`)

    @property
    @abstractmethod
    def name(self) -> str:
        """Name of the part."""

    @property
    @abstractmethod
    def places(self) -> Floats:
        """Of its nodes [n, 3] [m]."""

    @property
    def nodes(self) -> Integers:
        """Numbers of its nodes [n]."""
        return np.arange(self.first, self.first + len(self.places))

    @property
    def of_file(self) -> tuple[ImportedMesh, Integers] | None:
        """The mesh of a file that it is of, and the row there of each of its nodes [n], -1 for those that the file has
        not; None where it is of none."""
        return None

    @property
    def joinable(self) -> Integers:
        """Numbers of the nodes that joints may tie: all, unless the motion of some only follows from others."""
        return self.nodes

    @property
    def has_rotations(self) -> bool:
        """Whether its nodes turn: they can be joined rigidly."""
        return True

    @property
    def quads(self) -> Integers:
        """Corner nodes of its cells [q, 4], for files and pictures."""
        return np.empty((0, 4), np.int64)

    @property
    def edges_of_cells(self) -> Integers | None:
        """End nodes of the edges of its cells [e, 2], once each, of a part whose cells others can be joined to between
        their nodes; None of others."""
        return None

    @property
    def has_cells(self) -> bool:
        """Whether it can say how far places are off its cells."""
        return False

    def off_cells(self, places: Floats) -> Floats:
        """How far places [p, 3] are off its cells [p] [m]."""
        raise FemstructError(f"parts.{self.name}", got="no cells", expected="a part with edges of cells")

    def motion_on_cells(self, places: Floats) -> tuple[Integers, Floats]:
        """Motion of places [p, 3] on its cells, those off them on rigid arms: nodes [p, k], rows [p, 6, k, 7],
        global axes."""
        raise FemstructError(f"parts.{self.name}", got="no cells", expected="a part with edges of cells")

    @property
    def lines(self) -> Integers:
        """End nodes of its bars [b, 2], for files and pictures."""
        return np.empty((0, 2), np.int64)

    @property
    @abstractmethod
    def mass(self) -> float:
        """Its mass [kg]."""

    @property
    def rigid_in_plane(self) -> bool:
        """Whether it bends, but neither stretches nor shears in its plane."""
        return False

    @property
    def loss_factor(self) -> Loss:
        """Of its material [1]."""
        return 0.0

    @property
    @abstractmethod
    def lumps(self) -> Floats:
        """Its mass as particles at its nodes [n] [kg], to see what carries its weight."""

    @property
    def held_together(self) -> list[Integers]:
        """Groups of its nodes that its cells hold together; all of them, unless the kind says otherwise."""
        return [self.nodes]

    @property
    def own_axes(self) -> Floats | None:
        """Axes [3, 3] as rows along which equations on its nodes couple fewest unknowns; None for the global ones."""
        return None

    @property
    def box(self) -> Floats | None:
        """Lower and upper corner [2, 3] of a rigid box that takes along what lies in it [m]."""
        return None

    @property
    def across(self) -> Floats:
        """From its nodes to its face [3] [m]: a box that the face reaches into takes the node along."""
        return np.zeros(3)

    @property
    def depth(self) -> float:
        """Half the thickness of a plate or shell that stretches [m], beside which bars lie; 0 of others."""
        return 0.0

    @property
    def girth(self) -> float:
        """Radius of gyration of the section of its bars about their axis [m]: how far around it they take hold."""
        return 0.0

    def beside(self, nodes: Integers) -> Floats:
        """From nodes of it to the axis of its bars there [m, 3] [m]."""
        return np.zeros((len(nodes), 3))

    def around(self, nodes: Integers) -> Meshed:
        """It as it is around some of its nodes, for what is joined to them: a folded shell may be flat there."""
        return self

    @property
    def drilling(self) -> Floats | None:
        """Direction [3] about which nodes of it resist a torque the less the finer it is meshed: the normal of a plate
        that stretches; None where there is none."""
        return None

    def turning(self, nodes: Integers, reach: float, n_nodes: int) -> csr_array:
        """Rows [m, n_nodes * 7] of the rotation about `drilling` of patches that reach so far [m] around nodes
        of it [m]: what a torque of a bar that stands on it is spread over."""
        raise FemstructError(f"parts.{self.name}", got="no patch that can turn", expected="a part with a drilling")

    def turning_at(self, places: Floats, reach: float, n_nodes: int) -> csr_array:
        """As `turning`, of patches around places of it [m, 3]."""
        raise FemstructError(f"parts.{self.name}", got="no patch that can turn", expected="a part with a drilling")

    def turned(self, nodes: Integers, n_nodes: int) -> csr_array:
        """Rows [3 m, n_nodes * 7] of the rotation of its surface at nodes [m], of a part whose nodes do not turn."""
        raise FemstructError(f"parts.{self.name}", got="no rotation at its nodes", expected="a part with a surface")

    # What its nodes have beside the six components of their motion is a matter of its kind:

    @property
    def clamped(self) -> Floats:
        """What is held of nodes that are clamped, as components [m, 7]."""
        return np.eye(len(DIRECTIONS), N_COMPONENTS)

    @property
    def flat(self) -> Floats:
        """What vanishes, beside the six, at nodes of it that lie on a rigid face, as components [m, 7]."""
        return np.zeros((0, N_COMPONENTS))

    def along(self, line: Floats) -> Floats:
        """What two parts have in common, beside the six, at nodes joined along a line [3], as components [m, 7]."""
        return np.zeros((0, N_COMPONENTS))

    def edges(self, item: Support, tolerance: float) -> list[tuple[Integers, Floats]]:
        """Nodes of each edge or line a support names, in their order, and the components [m, 7] that simple, roller or
        clamped holds of each; what else it holds in the plane of a part that stretches is in `grid.in_plane`."""
        raise InputError(f"supports.{item.name}.on", got=f"'{self.name}'", expected="a plate")

    def edge_points(self, item: Support, tolerance: float) -> EdgePoints:
        """Gauss points along the edges or the line that a support names, for springs spread along them."""
        got, expected = f"an edge of '{self.name}'", "one of a plate, slab or shell"
        raise InputError(f"supports.{item.name}.on", got=got, expected=expected)

    def hard_edges(self, item: Support, tolerance: float) -> tuple[Integers, Floats]:
        """Nodes [m] along free edges that a support names, and the rotation at each about the normal to its edge in the
        plane of the part, as components [m, 7]: what a hard simple support holds beside the translations."""
        got, expected = f"'simple hard' of '{self.name}'", "a slab or shell: its elements shear"
        raise InputError(f"supports.{item.name}.fix", got=got, expected=expected, do="write simple")

    def within(self, where: str, region: Region, tolerance: float) -> Integers:
        """Its nodes in a region; sets and boxes are for parts that are meshes."""
        raise InputError(where, got=f"a {region.kind} of {self.name}", expected="a part that is a mesh of a file")

    @property
    def bounds(self) -> Floats:
        """Places [m, 3] it reaches to beyond its nodes [m]."""
        return np.zeros((0, 3))

    @abstractmethod
    def dofs(self) -> OwnDofs:
        """Its degrees of freedom."""

    @abstractmethod
    def stiffness_and_mass(self) -> tuple[csr_array | None, csr_array]:
        """Matrices [n, n] on its degrees of freedom; no stiffness where nothing of it deforms."""

    def shares(self) -> list[LossShare]:
        """Its stiffness by the loss factors of its layers, whose matrices add up to it; none where it has one."""
        return []

    @property
    def unweighed(self) -> tuple[str, ...]:
        """Axes along which accelerations of all of it push it as is not known, of matrices that hold a part of
        themselves: it has no weight along them, and its base cannot move."""
        return ()

    @property
    def beside_mass(self) -> Floats | None:
        """What unit accelerations of all of it along x, y, z push its degrees of freedom with beside its mass matrix
        [n, 3] [kg]: of matrices that hold a part of themselves. None for nothing."""
        return None

    def dashpots(self) -> csr_array | None:
        """Dashpots [n, n] on its degrees of freedom; None where it has none."""
        return None

    @abstractmethod
    def point(self, name: str, place: PlaceOn, at: Floats, tolerance: float) -> Point:
        """A named place of it. Raises InputError for a place off the part, saying by how much."""

    def surface(self, item: SurfaceOn, n_nodes: int, tolerance: float) -> Surface:
        """A named side of it that radiates or is pressed."""
        raise InputError(f"surfaces.{item.name}.on", got=f"'{item.on}'", expected="a plate")

    def motion_at(self, places: Floats, tolerance: float) -> tuple[Integers, Floats]:
        """Motion of places [p, 3] [m] that move with it, for layers against its faces: nodes [p, k], rows
        [p, 6, k, 7], global axes."""
        raise InputError(
            f"parts.{self.name}", got="no face that a layer can lie against", expected="a plate, slab or block"
        )

    def covers(self, places: Floats, tolerance: float) -> NDArray[np.bool_]:
        """Whether it is there, of places [p, 3] [m] over its box: a slab has openings."""
        return np.ones(len(places), dtype=bool)

    def spread(self, where: str, region: Region, tolerance: float, order: int) -> RegionSpread | None:
        """Gauss points over a region of it, to spread something evenly; None where nothing can be spread over it."""
        return None

    def faces_at(self, where: str, region: Region, tolerance: float) -> Mapping[str, Integers]:
        """Faces of solid cells that lie wholly in a region of it: their nodes [m, k] by kind; none of other parts."""
        return {}

    def stresses(self, n_nodes: int) -> StressPlaces:
        """Where its stresses are largest, and what they are of its nodes. Raises InputError for a part without."""
        raise InputError(f"parts.{self.name}", got="a part without stresses", expected="a plate or a frame")

    def moved(self, displacement: Floats, weight: float) -> Floats:
        """Displacements [p, 3] of places that tell how far it moves, of those of all nodes [n_nodes, 7] [m].

        Parameters
        ----------
        weight : float
            The gravity that it is under beside [m/s^2], 0 for none.
        """
        return displacement[self.nodes, :3]

    def lines_across(self, along: Floats, origin: Floats) -> Floats:
        """Places of the lines between its cells along a direction [3] in its face, from an origin [3] on [m]."""
        return np.zeros(0)

    @abstractmethod
    def drawn(self, divisions: int, along: int, n_nodes: int) -> Drawn:
        """It for pictures.

        Parameters
        ----------
        divisions : int
            Pieces of a cell's side, along : of a bar.
        """


def nodal_dofs(count: int, each: int) -> OwnDofs:
    """Degrees of freedom of a part whose nodes have global components: three translations each, or rotations, too."""
    numbers = np.arange(each * count).reshape(count, each)
    rows = np.arange(count)[:, None] * N_COMPONENTS + np.arange(each)
    translations = np.zeros((each * count, 3))
    translations[numbers[:, :3]] = np.eye(3)
    return OwnDofs(COMPONENTS[:each], (), rows.ravel(), numbers.ravel(), np.ones(each * count), translations)


def refuse_patch(name: str, place: PlaceOn) -> None:
    """Raise InputError for a point that stands for a patch, on a part that is no plate."""
    if place.patch is not None:
        raise InputError(f"points.{name}.patch", got=f"a patch on {place.on}", expected="one on a plate")


def refuse_not_global(name: str, at: Floats) -> None:
    """Raise InputError for a place of a point that is not x, y and z."""
    if len(at) != 3:
        raise InputError(f"points.{name}.at", got=f"{len(at)} numbers", expected="[x, y, z], global")


class FilledBox(NamedTuple):
    """The box that a part fills: a corner [3], axes [3, 3] as rows, sides [3] along them [m].

    across : the one of its axes that its sides face along; None for a box, whose sides face along all.
    """

    corner: Floats
    axes: Floats
    size: Floats
    across: int | None


# ----------------------------------------------------------------------------------------------------------------------
# What a kind of part offers to the rest of the program.
# ----------------------------------------------------------------------------------------------------------------------


class Part:
    """A part as it is described, by name; the base of all kinds."""

    name: str

    def described(self) -> tuple[Given, ...]:
        """What is given of it, for tables of inputs and for comparing cases: its fields; a kind adds units."""
        return given_fields(self, {})

    def corners(self) -> Floats:
        """Places [n, 3] that bound it [m]; none for what acts between others. Raises InputError for sizes it cannot
        have."""
        return np.zeros((0, 3))

    def body(self) -> FilledBox | None:
        """The box it fills, where layers can lie against it."""
        return None

    def middles(self) -> Floats:
        """Middles of its cells [n, 3] [m], of parts that are meshes, to see what is in one place twice."""
        return np.zeros((0, 3))

    def taken(self) -> tuple[tuple[ImportedMesh, Mapping[str, Integers]], ...]:
        """Meshes of files that it is made of, with the rows of their cells that it takes, by kind."""
        return ()

    def stands_for(self) -> frozenset[Makes]:
        """What it states itself of what a file may state of its cells, or what it is in place of cards of a file."""
        return frozenset()

    def takes(self) -> frozenset[Makes]:
        """What it takes of what a file states of its cells and readers count among what is left out."""
        return frozenset()

    def written_thickness(self) -> tuple[float, ...]:
        """Thicknesses [m] that the model states for cells of a mesh from a file; none where those of the file hold."""
        return ()

    def attaches(self, users: Users) -> Attached | None:
        """What it takes of what a mesh file states beside its cells.

        Parameters
        ----------
        users : Users
            The cells that parts take of their files.
        """
        return None

    @property
    def cell_size(self) -> float:
        """Largest side of its cells where bars can lie on them beside its nodes [m]; infinite of others."""
        return np.inf

    def lay_out(self, layout: Layout) -> None:
        """Give the layout its grid lines, and the geometry that joints meet."""

    def needs(self, layout: Layout) -> None:
        """Ask for nodes of other parts where this one acts on them."""

    def carriers(self) -> tuple[str | None, ...]:
        """Names of the points it is fastened to: asked for here, each gets a node."""
        return ()

    def identity(self, places: Mapping[str, object]) -> tuple[object, ...] | None:
        """What it is called and all that makes it what it is but its name; two parts of one identity are one, given
        twice. None for what is judged by the space it fills.

        Parameters
        ----------
        places : Mapping[str, object]
            What to put for the name of a point.
        """
        return None

    def materials(self) -> tuple[AnyMaterial, ...]:
        """What it is made of."""
        return ()

    def bears(self) -> tuple[str, ...]:
        """Names of the parts that lie on it or under it all over, and so do not sag by themselves."""
        return ()

    def implausible(self, lies: bool) -> tuple[Finding, ...]:
        """Numbers of its own that are surely not meant, materials aside.

        Parameters
        ----------
        lies : bool
            Whether another part bears it.
        """
        return ()

    def meshed(self, layout: Layout, grids: Grids, first: int) -> Meshed | None:
        """The part with nodes, numbered from `first`; None for what has none of its own."""
        return None

    def fastened(self, model: Model, tolerance: float) -> tuple[Elastic | Inert | Tie, ...]:
        """What it adds to nodes: springs, masses, equations."""
        return ()
