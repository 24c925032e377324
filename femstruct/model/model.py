"""Model: a structure with its mesh, its properties, and everything spread or lumped as rows on nodal components."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from scipy.sparse import csr_array

from femstruct.arrays import Floats, Integers, freeze, frozen, frozen_integers
from femstruct.conventions import N_COMPONENTS
from femstruct.elements.frame import nodes_per_bar
from femstruct.errors import FemstructError
from femstruct.model.mesh import Mesh
from femstruct.model.parts import Block, Frame, Plate, Structure
from femstruct.model.probe import Point, Surface


@dataclass(frozen=True, eq=False)
class PlateMesh:
    """A plate on its grid.

    axes [3, 3] : rows are its x, y and normal in global components. x [nx + 1], y [ny + 1] : grid lines from its origin
    corner [m]. nodes [nx + 1, ny + 1] : their node numbers.
    """

    part: Plate
    axes: Floats
    x: Floats
    y: Floats
    nodes: Integers

    def __post_init__(self) -> None:
        x, y = (frozen(f"parts.{self.part.name} grid", lines, (None,)) for lines in (self.x, self.y))
        freeze(
            self,
            axes=frozen(f"parts.{self.part.name} axes", self.axes, (3, 3)),
            x=x,
            y=y,
            nodes=frozen_integers(f"parts.{self.part.name} nodes", self.nodes, (len(x), len(y))),
        )

    @property
    def cells(self) -> Integers:
        """Corner nodes of the cells [nx * ny, 4], y fastest, in the order of `femstruct.elements.plate`."""
        n = self.nodes
        corners = np.stack([n[:-1, :-1], n[:-1, 1:], n[1:, 1:], n[1:, :-1]], axis=-1)
        return corners.reshape(-1, 4)

    @property
    def cell_sizes(self) -> tuple[Floats, Floats]:
        """Sides a, b of the cells [nx * ny] along the plate's x and y [m]."""
        a, b = np.diff(self.x), np.diff(self.y)
        return np.repeat(a, len(b)), np.tile(b, len(a))

    @property
    def centroid(self) -> tuple[float, float]:
        """Middle of the plate in its own coordinates [m]."""
        return self.part.size[0] / 2.0, self.part.size[1] / 2.0


@dataclass(frozen=True, eq=False)
class FrameMesh:
    """A frame as bars.

    bars [b, k] : the two end nodes, then the middle one of bars of three. start, end [b, 3] : ends of the flexible
    bars, at the tips of the rigid arms [m]. arms [b, k, 3] : from the nodes to the flexible bar, global axes [m].
    axes [b, 3, 3] : rows are local x, y, z.
    """

    part: Frame
    bars: Integers
    start: Floats
    end: Floats
    arms: Floats
    axes: Floats

    def __post_init__(self) -> None:
        where = f"parts.{self.part.name}"
        k = nodes_per_bar(self.part.element)
        bars = frozen_integers(f"{where} bars", self.bars, (None, k))
        n = len(bars)
        freeze(
            self,
            bars=bars,
            start=frozen(f"{where} start", self.start, (n, 3)),
            end=frozen(f"{where} end", self.end, (n, 3)),
            arms=frozen(f"{where} arms", self.arms, (n, k, 3)),
            axes=frozen(f"{where} axes", self.axes, (n, 3, 3)),
        )

    @property
    def lengths(self) -> Floats:
        """Lengths of the flexible bars [b] [m]."""
        lengths: Floats = np.linalg.norm(self.end - self.start, axis=1)
        return lengths


@dataclass(frozen=True, eq=False)
class BlockMesh:
    """A rigid block: one node at its centre of mass, center [3] : where that is, global [m]."""

    part: Block
    node: int
    center: Floats

    def __post_init__(self) -> None:
        freeze(self, center=frozen(f"parts.{self.part.name} center", self.center, (3,)))

    @property
    def corners(self) -> Floats:
        """Lower and upper corner [2, 3] [m]."""
        low = np.asarray(self.part.origin, dtype=np.float64)
        return np.stack([low, low + np.asarray(self.part.size)])


@dataclass(frozen=True, eq=False)
class Elastic:
    """Springs and dashpots that act on generalised displacements: lumped, spread over a region, or in a joint.

    rows [m, n_nodes * 7] : the displacements. stiffness, damping [m] : of each, area and length included [N/m].
    directions [m, 3] : global direction of the force each makes, zero for rotations. grounded : whether the force goes
    to the ground or to a second part. places [q, 3] : where they act [m], for pictures; none where nodes show it.
    """

    name: str
    rows: csr_array
    stiffness: Floats
    damping: Floats
    directions: Floats
    grounded: bool
    loss_factor: float = 0.0
    places: Floats = field(default_factory=lambda: np.zeros((0, 3)))

    def __post_init__(self) -> None:
        m = self.rows.shape[0]
        freeze(
            self,
            stiffness=frozen(f"{self.name} stiffness", self.stiffness, (m,)),
            damping=frozen(f"{self.name} damping", self.damping, (m,)),
            directions=frozen(f"{self.name} directions", self.directions, (m, 3)),
            places=frozen(f"{self.name} places", self.places, (None, 3)),
        )


@dataclass(frozen=True, eq=False)
class Inert:
    """Mass without elasticity: rows [3 m, n_nodes * 7] are the global x, y, z displacements of m points.

    mass [3 m] : of each point, three times [kg].
    """

    name: str
    rows: csr_array
    mass: Floats

    def __post_init__(self) -> None:
        freeze(self, mass=frozen(f"{self.name} mass", self.mass, (self.rows.shape[0],)))


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


@dataclass(frozen=True, eq=False)
class Model:
    """A structure ready to be assembled.

    points, surfaces : by name; several places of a point are NAME.1, NAME.2. plates, frames, blocks : by part.
    elastics : springs, foundations and joints with stiffness. inerts : masses. ties : supports and joints.

    Raises FemstructError: rows that do not fit the mesh.
    """

    structure: Structure
    mesh: Mesh
    plates: Mapping[str, PlateMesh]
    frames: Mapping[str, FrameMesh]
    elastics: tuple[Elastic, ...]
    inerts: tuple[Inert, ...]
    ties: tuple[Tie, ...]
    points: Mapping[str, Point]
    surfaces: Mapping[str, Surface]
    blocks: Mapping[str, BlockMesh] = field(default_factory=dict)

    def __post_init__(self) -> None:
        fastened: tuple[Elastic | Inert | Tie, ...] = (*self.elastics, *self.inerts, *self.ties)
        for item in fastened:
            if item.rows.shape[1] != self.mesh.n_nodes * N_COMPONENTS:
                raise FemstructError(
                    item.name,
                    got=f"{item.rows.shape[1]} columns",
                    expected=f"{self.mesh.n_nodes} nodes x {N_COMPONENTS}",
                )

    def places(self, name: str) -> tuple[Point, ...]:
        """All places of a point: one, or NAME.1, NAME.2 and so on."""
        if name in self.points:
            return (self.points[name],)
        several: list[Point] = []
        while (key := f"{name}.{len(several) + 1}") in self.points:
            several.append(self.points[key])
        if not several:
            raise FemstructError("points", got=f"'{name}'", expected=" or ".join(sorted(self.points)) or "a point")
        return tuple(several)
