"""Probe: one noun for where a structure is driven and where it is observed."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from femstruct.arrays import Floats, Integers, freeze, frozen, frozen_integers
from femstruct.conventions import DIRECTIONS, N_COMPONENTS
from femstruct.errors import FemstructError
from femstruct.tags import stored_as


@stored_as("probe/1")
@dataclass(frozen=True, eq=False)
class Probe:
    """A generalised displacement: a weighted sum of nodal components, and the force that works on it.

    A point between nodes, in any direction, is a probe through the shape functions of its element; so are the
    average over a patch and a pressure on a surface. By virtual work the same weights spread a force.

    nodes [m], components [m] : where; components are those of `femstruct.conventions`.
    weights [m] : factors, [1] for a displacement, [1/m] or [m] where rotations enter.

    >>> Probe([0, 1], [2, 2], [0.5, 0.5]).of(np.ones((2, 7, 3)))
    array([1., 1., 1.])
    """

    nodes: Integers
    components: Integers
    weights: Floats

    def __post_init__(self) -> None:
        weights = frozen("probe weights", self.weights, (None,))
        nodes = frozen_integers("probe nodes", self.nodes, weights.shape)
        components = frozen_integers("probe components", self.components, weights.shape)
        if components.size and not (components.min() >= 0 and components.max() < N_COMPONENTS):
            raise FemstructError("probe components", got=f"{components.tolist()}", expected=f"0..{N_COMPONENTS - 1}")
        freeze(self, nodes=nodes, components=components, weights=weights)

    def of(self, shapes: Floats) -> Floats:
        """Value of this probe in each of the shapes [node, 7, k] -> [k].

        Raises FemstructError for shapes of fewer nodes: those of another structure.
        """
        if (last := int(self.nodes.max(initial=-1))) >= len(shapes):
            expected = f"nodes 0 to {len(shapes) - 1}"
            raise FemstructError("probe", got=f"node {last}", expected=expected, do="take a probe of this structure")
        values: Floats = self.weights @ shapes[self.nodes, self.components]
        return values

    def meets(self, other: Probe) -> float:
        """What this probe reads of a unit force at another one: the sum of their products, node by node.

        >>> Probe([3, 4], [2, 2], [0.5, 0.5]).meets(Probe([4, 4], [2, 0], [3.0, 7.0]))
        1.5
        """
        last = int(max(self.nodes.max(initial=-1), other.nodes.max(initial=-1)))
        return float((self.row(last + 1) @ other.row(last + 1).T).sum())

    def row(self, n_nodes: int) -> csr_array:
        """Sparse row [1, n_nodes * 7] over all nodal components."""
        columns = self.nodes * N_COMPONENTS + self.components
        return csr_array((self.weights, (np.zeros_like(columns), columns)), shape=(1, n_nodes * N_COMPONENTS))


@stored_as("point/1")
@dataclass(frozen=True, eq=False)
class Point:
    """A named place of the structure, interpolated by the shape functions of the element it lies in.

    position [3] : global coordinates [m].
    nodes [m], components [m] : nodal components that move it.
    weights [6, m] : its three displacements and three rotations, global axes, in terms of them.
    normal [3] : outward unit normal of the named side of a plate; for a frame or a lone point, the global z axis.
    """

    name: str
    position: Floats
    nodes: Integers
    components: Integers
    weights: Floats
    normal: Floats

    def __post_init__(self) -> None:
        weights = frozen(f"points.{self.name} weights", self.weights, (6, None))
        length = weights.shape[1]
        freeze(
            self,
            weights=weights,
            position=frozen(f"points.{self.name} position", self.position, (3,)),
            nodes=frozen_integers(f"points.{self.name} nodes", self.nodes, (length,)),
            components=frozen_integers(f"points.{self.name} components", self.components, (length,)),
            normal=frozen(f"points.{self.name} normal", self.normal, (3,)),
        )

    def probe(self, direction: str) -> Probe:
        """Displacement along x, y, z or the normal n, or rotation about x, y, z (rx, ry, rz).

        Raises FemstructError for any other direction.
        """
        if direction == "n":
            row = self.normal @ self.weights[:3]
        elif direction in DIRECTIONS:
            row = self.weights[DIRECTIONS.index(direction)]
        else:
            raise FemstructError(
                f"points.{self.name}.{direction}",
                got=f"direction '{direction}'",
                expected="x, y, z, rx, ry, rz or n",
            )
        used = row != 0.0
        return Probe(self.nodes[used], self.components[used], row[used])


@stored_as("surface/1")
@dataclass(frozen=True, eq=False)
class Surface:
    """A radiating surface of any form: quadrature points and the normal displacement there.

    points [p, 3] : quadrature points, global coordinates [m].
    weights [p] : quadrature weights [m^2], the area each point stands for.
    normals [p, 3] : unit normals pointing out of the structure, into the room.
    along [2, 3] : unit vectors of its first and second direction, in which a room beside it is measured.
    outline [n, 3] : corners round it [m].
    rows [p, n_nodes * 7] : displacement along the normal at the points, from the nodal components.
    out : from the points to the face of the part, along the normals, in the mean: half a thickness of plates and
    shells, whose points are on their mid-surfaces [m].

    The underside of a rigid square of 2 m, of one node that moves along z; the room is below:

    >>> from scipy.sparse import csr_array
    >>> corners = [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]]
    >>> down = csr_array([[0, 0, -1.0, 0, 0, 0, 0]])
    >>> below = Surface("below", [[1, 1, 0]], [4.0], [[0, 0, -1]], [[1, 0, 0], [0, 1, 0]], corners, down)
    >>> float(below.weights.sum()), below.centre.tolist()
    (4.0, [1.0, 1.0, 0.0])
    """

    name: str
    points: Floats
    weights: Floats
    normals: Floats
    along: Floats
    outline: Floats
    rows: csr_array
    out: float = 0.0

    def __post_init__(self) -> None:
        points = frozen(f"surfaces.{self.name} points", self.points, (None, 3))
        freeze(
            self,
            points=points,
            weights=frozen(f"surfaces.{self.name} weights", self.weights, (len(points),)),
            normals=frozen(f"surfaces.{self.name} normals", self.normals, (len(points), 3)),
            along=frozen(f"surfaces.{self.name} along", self.along, (2, 3)),
            outline=frozen(f"surfaces.{self.name} outline", self.outline, (None, 3)),
        )
        if self.rows.shape[0] != len(points):
            raise FemstructError(f"surfaces.{self.name}", got=f"{self.rows.shape[0]} rows", expected=f"{len(points)}")

    @property
    def normal(self) -> Floats:
        """Its mean direction, unit vector [3]."""
        mean = self.weights @ self.normals
        return np.asarray(mean / np.linalg.norm(mean))

    @property
    def centre(self) -> Floats:
        """Middle of the rectangle round its outline, sides along its two directions [3] [m]."""
        mean = self.outline.mean(axis=0)
        flat = (self.outline - mean) @ self.along.T
        return np.asarray(mean + (flat.min(axis=0) + flat.max(axis=0)) / 2.0 @ self.along)

    def shapes(self, nodal: Floats) -> Floats:
        """Normal displacement at the points in each of the nodal shapes [node, 7, k] -> [p, k]."""
        values: NDArray[np.float64] = self.rows @ nodal.reshape(-1, nodal.shape[2])
        return values

    def pressure(self) -> Probe:
        """The probe of a uniform pressure pushing against the surface, in [m^2]: the volume it displaces inwards."""
        row = (-self.weights) @ self.rows
        (columns,) = np.nonzero(row)
        return Probe(columns // N_COMPONENTS, columns % N_COMPONENTS, row[columns])


@dataclass(frozen=True, eq=False)
class StressPlaces:
    """Places of a part, and the stresses there from the components of its nodes.

    places [p, 3] : global coordinates [m]. components : those of `femstruct.elements.stresses` that
    are not zero there, along local axes.
    rows [p * c, n_nodes * 7] : stresses [Pa], the components of a place one after the other. sides : what tells places
    of one position, such as the two faces of a plate, by turns: place i is on `sides[i % len(sides)]`.
    cells [m * c, n_nodes * 7], meets [m] : the same of every cell that meets at a place, and which place, where `rows`
    are their mean; none where they are not. axes [p, 3, 3] : the local axes of every place, its rows; None for global.
    carried [p, c, 3] : of bars, what is to be added per acceleration of all of it along x, y, z [m/s^2], or as much
    weight against them [Pa s^2/m]: their section forces are in equilibrium at their ends then, and need no finer mesh.
    None for others.

    >>> field = StressPlaces(np.zeros((1, 3)), ("xx", "xy"), csr_array(np.eye(2, 7)), ("above",))
    >>> field.of(np.array([3e6, 2e6, 0, 0, 0, 0, 0]).reshape(1, 7, 1))[:, :, 0]
    array([[3000000., 2000000.]])
    """

    places: Floats
    components: tuple[str, ...]
    rows: csr_array
    sides: tuple[str, ...]
    cells: csr_array | None = None
    meets: Integers = field(default_factory=lambda: np.zeros(0, np.int64))
    axes: Floats | None = None
    carried: Floats | None = None

    def __post_init__(self) -> None:
        freeze(self, places=frozen("stresses places", self.places, (None, 3)))
        expected = len(self.places) * len(self.components)
        if self.rows.shape[0] != expected or self.rows.shape[1] % N_COMPONENTS:
            raise FemstructError("stresses", got=f"rows {self.rows.shape}", expected=f"[{expected}, n_nodes * 7]")

    def of(self, shapes: Floats) -> Floats:
        """Stresses [p, c, k] in each of the shapes [node, 7, k] [Pa per unit of the shape]."""
        values: Floats = self.rows @ shapes.reshape(-1, shapes.shape[2])
        return values.reshape(len(self.places), len(self.components), -1)

    def at(self, place: int) -> StressPlaces:
        """One of the places, on its side."""
        alone = self.some(np.array([place]))
        return replace(alone, sides=(self.sides[place % len(self.sides)],))

    def some(self, numbers: Integers) -> StressPlaces:
        """Some of the places, all sides of a position together."""
        c = len(self.components)
        rows = csr_array(self.rows[(numbers[:, None] * c + np.arange(c)).ravel()])
        axes = None if self.axes is None else self.axes[numbers]
        carried = None if self.carried is None else self.carried[numbers]
        return StressPlaces(self.places[numbers], self.components, rows, self.sides, axes=axes, carried=carried)

    def around(self, place: int) -> StressPlaces | None:
        """The same place in each of the cells that meet there, one after the other; None where there is one value."""
        if self.cells is None:
            return None
        touching = np.flatnonzero(self.meets == place)
        c = len(self.components)
        rows = csr_array(self.cells[(touching[:, None] * c + np.arange(c)).ravel()])
        return StressPlaces(np.tile(self.places[place], (len(touching), 1)), self.components, rows, self.sides)
