"""Plates on their grids: what they have at their nodes, their matrices, and what points and surfaces read of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from scipy.sparse import csr_array

from femstruct.arrays import Floats, Integers, freeze, frozen
from femstruct.conventions import N_COMPONENTS, TWIST
from femstruct.elements import membrane, plate
from femstruct.errors import InputError
from femstruct.model.grid.geometry import distance_to_rectangle, from_rectangle, to_rectangle
from femstruct.model.grid.lines import divided, snapped
from femstruct.model.grid.regions import area_points, grid_points, region_box
from femstruct.model.grid.scatter import interleaved, scattered, with_diagonal
from femstruct.model.imported.facing import towards
from femstruct.model.materials.lay_up import stresses_of_resultants
from femstruct.model.materials.loss_by_frequency import Loss
from femstruct.model.meshed import Drawn, EdgePoints, LossShare, Meshed, OwnDofs, Spread
from femstruct.model.model import Model
from femstruct.model.probe import Point, StressPlaces, Surface
from femstruct.model.region import Facing, Region, Side
from femstruct.model.rows import carried, flat_rows, mean_of_cells, sparse_rows
from femstruct.model.structure import PlaceOn, Support, SurfaceOn
from femstruct.parts.of_plates.patches import patch_points, patch_turning
from femstruct.parts.of_plates.plate_edges import STEEP, edge_components, edge_gauss, edge_nodes
from femstruct.parts.of_plates.plate_motion import STRETCHING, plate_dofs, plate_rows, stretching_dofs
from femstruct.parts.of_plates.plate_stresses import face_rows
from femstruct.tags import stored_as

if TYPE_CHECKING:
    from femstruct.parts.plate import Plate

SAME_SIZE = 11  # digits to which cells agree that are of one size: the rounding of coordinates of a grid
SURFACE_ORDER = 3
"""Gauss points a direction in each cell of a surface: exact for the volume a cell displaces, and for its second moment
with a linear weight; the deflection of a cell is cubic."""
ROUND = ((0, 2), (1, 2), (1, 3), (0, 3))  # ends of a box along x and y, corner by corner


@stored_as("plate mesh/1")
@dataclass(frozen=True, eq=False)
class PlateMesh(Meshed):
    """A plate on its grid.

    first : number of its first node. axes [3, 3] : rows are its x, y and normal in global components. x [nx + 1],
    y [ny + 1] : grid lines from its origin corner [m]. stretches : in its plane; it is rigid there otherwise.
    """

    part: Plate
    first: int
    axes: Floats
    x: Floats
    y: Floats
    stretches: bool = False

    def __post_init__(self) -> None:
        freeze(
            self,
            axes=frozen(f"parts.{self.part.name} axes", self.axes, (3, 3)),
            x=frozen(f"parts.{self.part.name} grid", self.x, (None,)),
            y=frozen(f"parts.{self.part.name} grid", self.y, (None,)),
        )

    @property
    def name(self) -> str:
        return self.part.name

    @property
    def rigid_in_plane(self) -> bool:
        return not self.stretches

    @property
    def local(self) -> Floats:
        """Its nodes in its own coordinates [n, 2] [m], y fastest."""
        return np.stack(np.meshgrid(self.x, self.y, indexing="ij"), axis=-1).reshape(-1, 2)

    @property
    def places(self) -> Floats:
        return from_rectangle(self.part, self.axes, self.local)

    @property
    def grid(self) -> Integers:
        """Numbers of its nodes [nx + 1, ny + 1]."""
        return self.first + np.arange(len(self.x) * len(self.y)).reshape(len(self.x), len(self.y))

    @property
    def quads(self) -> Integers:
        """Corner nodes of the cells [nx * ny, 4], y fastest, in the order of `femstruct.elements.plate`."""
        n = self.grid
        corners = np.stack([n[:-1, :-1], n[:-1, 1:], n[1:, 1:], n[1:, :-1]], axis=-1)
        return corners.reshape(-1, 4)

    @property
    def cell_sizes(self) -> tuple[Floats, Floats]:
        """Sides a, b of the cells [nx * ny] along the plate's x and y [m]."""
        a, b = np.diff(self.x), np.diff(self.y)
        return np.repeat(a, len(b)), np.tile(b, len(a))

    @property
    def per_area(self) -> float:
        """Mass per area [kg/m^2]."""
        return self.part.section.m0

    @property
    def mass(self) -> float:
        width, height = self.part.size
        return self.per_area * width * height

    @property
    def lumps(self) -> Floats:
        a, b = self.cell_sizes
        lumps = np.zeros(len(self.x) * len(self.y))
        np.add.at(lumps, self.quads - self.first, (self.per_area * a * b / 4.0)[:, None])
        return lumps

    @property
    def loss_factor(self) -> Loss:
        return self.part.section.loss_factor

    @property
    def own_axes(self) -> Floats:
        return self.axes

    @property
    def depth(self) -> float:
        return 0.0 if self.rigid_in_plane else self.part.thickness / 2.0

    @property
    def across(self) -> Floats:
        half: Floats = self.axes[2] * self.part.thickness / 2.0
        return half

    @property
    def clamped(self) -> Floats:
        return np.concatenate([np.eye(TWIST, N_COMPONENTS), self.flat])

    @property
    def flat(self) -> Floats:
        """No twist on a rigid face, where the plate and so its edges are flat; with bfs16, whose nodes have one."""
        return np.eye(N_COMPONENTS)[TWIST:] if plate.dofs_per_node(self.part.element) > 3 else super().flat

    def along(self, line: Floats) -> Floats:
        """Slopes across a line are continuous between nodes where the rate of turning about it is: +TWIST on a plate
        with the line along its x, -TWIST along its y."""
        return self.flat if abs(self.axes[0] @ line) > abs(self.axes[1] @ line) else -self.flat

    @property
    def drilling(self) -> Floats | None:
        return None if self.rigid_in_plane else self.axes[2]

    def turning(self, nodes: Integers, reach: float, n_nodes: int) -> csr_array:
        where, places = f"parts.{self.name}", self.local[nodes - self.first]
        return patch_turning(where, places, reach, self.part.size, self.axes, self.rows, n_nodes)

    def dofs(self) -> OwnDofs:
        kind = self.part.element
        if self.rigid_in_plane:
            return plate_dofs(kind, self.axes, self.local, self.part.size)
        return stretching_dofs(kind, self.axes, len(self.local))

    def stiffness_and_mass(self) -> tuple[csr_array, csr_array]:
        """Bending of its cells, and their membrane; where it is rigid in its plane, inertia as a rigid body there."""
        part = self.part
        section = part.section
        a, b, which = self._sizes()
        bends = plate.stiffness(part.element, a, b, section.bending), plate.mass(part.element, a, b, self.per_area)
        bending = plate.dofs_per_node(part.element)
        if not self.rigid_in_plane:
            corners = membrane.rectangle(a, b)
            stretches = membrane.stiffness(corners, section.A), membrane.mass(corners, section.m0, section.m2)
            of_bending = self._of_cells(bends, which, bending)
            of_membrane = self._of_cells(stretches, which, STRETCHING)
            K, M = (interleaved(both, (bending, STRETCHING)) for both in zip(of_bending, of_membrane, strict=True))
            return K, M
        K, M = self._of_cells(bends, which, bending)
        width, height = part.size
        total = self.per_area * width * height
        inertia = np.array([total, total, total * (width**2 + height**2) / 12.0])
        return with_diagonal(K, np.zeros(3)), with_diagonal(M, inertia)

    def shares(self) -> list[LossShare]:
        """Bending about the neutral surface and stretching have no energy in common, as in its stiffness."""
        part, section, found = self.part, self.part.section, []
        a, b, which = self._sizes()
        for one in section.shares:
            bends = plate.stiffness(part.element, a, b, section.bending_of(one))
            K, _ = self._of_cells((bends, bends), which, plate.dofs_per_node(part.element))
            if self.rigid_in_plane:
                K = with_diagonal(K, np.zeros(3))
            else:
                stretches = membrane.stiffness(membrane.rectangle(a, b), section.A, share=one.A)
                of_membrane, _ = self._of_cells((stretches, stretches), which, STRETCHING)
                K = interleaved((K, of_membrane), (plate.dofs_per_node(part.element), STRETCHING))
            found.append(LossShare(one.name, one.loss_factor, K))
        return found

    def _sizes(self) -> tuple[Floats, Floats, Integers]:
        """Sides a, b of the cells of each size [m], and which of them every cell is [nx * ny]."""
        sizes = np.stack(self.cell_sizes, axis=1)
        rounded = np.round(sizes / sizes.max(), SAME_SIZE)
        _, first, which = np.unique(rounded, axis=0, return_index=True, return_inverse=True)
        a, b = sizes[first].T
        return a, b, which.ravel()

    def _of_cells(self, matrices: tuple[Floats, Floats], which: Integers, per_node: int) -> tuple[csr_array, csr_array]:
        """Stiffness and mass of all cells from those of each size of cell."""
        numbers = ((self.quads - self.first)[:, :, None] * per_node + np.arange(per_node)).reshape(len(which), -1)
        return scattered(*matrices, numbers, len(self.local) * per_node, which)

    def rows(self, local: Floats) -> tuple[Integers, Floats]:
        """Nodes [p, 4] and rows [p, 6, 4, 7] of the motion of its places [p, 2] [m], as `plate_rows`."""
        lines = (self.x, self.y)
        return plate_rows(self.part.element, self.axes, lines, self.grid, local, not self.rigid_in_plane)

    def motion_at(self, places: Floats, tolerance: float) -> tuple[Integers, Floats]:
        """Off its mid-surface, places stand on its normals."""
        local = to_rectangle(self.part, self.axes, places)
        on_lines = [snapped(local[:, i], lines, tolerance) for i, lines in enumerate((self.x, self.y))]
        nodes, rows = self.rows(np.stack(on_lines, axis=1))
        height = float(local[:, 2].mean())
        return nodes, carried(rows, height * self.axes[2]) if abs(height) > tolerance else rows

    def side_normal(self, side: Side) -> Floats:
        """Unit normal out of the named side. Above is up along global z; on a plate normal to the horizontal it is the
        side of the plate's own normal."""
        up = 1.0 if self.axes[2, 2] > 0 or abs(self.axes[2, 2]) < STEEP - 1e-12 else -1.0
        normal: Floats = self.axes[2] * (up if side == "above" else -up)
        return normal

    def _facing(self, side: Facing, where: str) -> Floats:
        """Unit normal out of a side that is named by where it faces."""
        direction = towards(side) if side not in ("above", "below") else np.array([0.0, 0.0, 1.0])
        across = float(direction @ self.axes[2])
        if abs(across) < STEEP - 1e-12:
            got = f"'{side}' of a plate at {np.degrees(np.arccos(min(abs(across), 1.0))):.0f} degrees"
            do = "name the side of an upright plate by where it faces: x, -x, y or -y"
            raise InputError(f"{where}.side", got=got, expected="at most 45 degrees", do=do)
        flip = -1.0 if side == "below" else 1.0
        return np.asarray(self.axes[2] * (flip if across > 0 else -flip))

    def point(self, name: str, place: PlaceOn, at: Floats, tolerance: float) -> Point:
        where, size = f"points.{name}", self.part.size
        if len(at) != 2:
            raise InputError(f"{where}.at", got=f"{len(at)} numbers", expected="[x, y] from the plate's corner")
        off = float(distance_to_rectangle(np.append(at, 0.0), size))
        if off > tolerance:
            raise InputError(
                f"{where}.at",
                got=f"({at[0]:g}, {at[1]:g}) m, {off:.4g} m off {self.name}",
                expected=f"a place within {size[0]:g} m x {size[1]:g} m",
            )
        local = np.clip(at, 0.0, size)
        spots, shares = local[None], np.ones(1)
        if place.patch is not None:
            spots, shares = patch_points(where, self.name, size, (self.x, self.y), local, place.patch, tolerance)
        nodes, rows = self.rows(np.clip(spots, 0.0, size))
        position = from_rectangle(self.part, self.axes, local)
        return Point(name, position, *flat_rows(nodes, rows, shares), normal=self.side_normal(place.side))

    def surface(self, item: SurfaceOn, n_nodes: int, tolerance: float) -> Surface:
        """Raises InputError for a side more than 45 degrees away from the direction that names it."""
        where = f"surfaces.{item.name}"
        if item.region.kind not in ("whole", "rectangle"):
            raise InputError(f"{where}.region", got=item.region.kind, expected="whole or a rectangle")
        normal = self._facing(item.side, where)
        box = region_box(f"{where}.region", self.name, self.part.size, item.region, tolerance)
        local, weights = area_points(self.x, self.y, box, tolerance, SURFACE_ORDER)
        nodes, rows = self.rows(local)
        along_normal = np.einsum("j,pjkc->pkc", normal, rows[:, :3])[:, None]
        return Surface(
            item.name,
            points=from_rectangle(self.part, self.axes, local),
            weights=weights,
            normals=np.tile(normal, (len(weights), 1)),
            along=self.axes[:2],
            outline=from_rectangle(self.part, self.axes, np.array([[box[i], box[j]] for i, j in ROUND])),
            rows=sparse_rows(nodes, along_normal, n_nodes),
            out=self.part.thickness / 2.0,
        )

    def stresses(self, n_nodes: int) -> StressPlaces:
        """At both faces of every node, and of every layer; the shear stress across it, largest in the middle, is left
        out. Those of layers are along the plate's axes. Raises InputError for smeared ribs, whose stresses are unknown.
        """
        part, section = self.part, self.part.section
        heights, of_resultants = stresses_of_resultants(part.material, part.thickness)
        rigidities = section.bending, None if self.rigid_in_plane else section.A
        cells = face_rows(part.element, self.axes, self.cell_sizes, self.quads, rigidities, of_resultants, n_nodes)
        count = len(heights)
        meets = (count * (self.quads.ravel() - self.first)[:, None] + np.arange(count)).ravel()
        faces = self.places[:, None] + heights[:, None] * self.axes[2]
        up = float(self.side_normal("above") @ self.axes[2]) > 0
        words = ("above", "below") if up else ("below", "above")
        layers = count // 2
        sides = words if layers == 1 else tuple(f"{word} layer {n + 1}" for n in range(layers) for word in words[::-1])
        rows = csr_array(mean_of_cells(meets, 3) @ cells)
        axes = np.tile(self.axes, (faces.size // 3, 1, 1))
        return StressPlaces(faces.reshape(-1, 3), ("xx", "yy", "xy"), rows, sides, cells, meets, axes)

    def edges(self, item: Support, tolerance: float) -> list[tuple[Integers, Floats]]:
        nodes = edge_nodes(item, self.name, self.part.size, (self.x, self.y), self.grid, tolerance)
        return [(some, edge_components(item.fix, self.axes, along, self.rigid_in_plane)) for some, along in nodes]

    def edge_points(self, item: Support, tolerance: float) -> EdgePoints:
        local, weights, axis = edge_gauss(item, self.name, self.part.size, (self.x, self.y), tolerance)
        across = np.tile(self.axes[2], (len(local), 1))
        return EdgePoints(*self.rows(local), weights, across, self.axes[axis])

    def spread(self, where: str, region: Region, tolerance: float, order: int) -> Spread:
        box = region_box(where, self.name, self.part.size, region, tolerance)
        local, weights = grid_points(self.x, self.y, region, box, tolerance, order)
        per: Literal["length", "area"] = "area" if region.kind in ("whole", "rectangle") else "length"
        return Spread(*self.rows(local), weights, per, region.kind)

    def lines_across(self, along: Floats, origin: Floats) -> Floats:
        cosines = self.axes[:2] @ along
        own = int(np.argmax(np.abs(cosines)))
        start = float((np.asarray(self.part.origin) - origin) @ along)
        lines: Floats = start + np.sign(cosines[own]) * (self.x, self.y)[own]
        return lines

    def drawn(self, divisions: int, along: int, n_nodes: int) -> Drawn:
        x, y = (divided(lines, divisions) for lines in (self.x, self.y))
        local = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
        nodes, rows = self.rows(local)
        n = np.arange(len(local)).reshape(len(x), len(y))
        cells = np.stack([n[:-1, :-1], n[1:, :-1], n[1:, 1:], n[:-1, 1:]], axis=-1).reshape(-1, 4)
        places = from_rectangle(self.part, self.axes, local)
        return Drawn(places, sparse_rows(nodes, rows[:, :3], n_nodes), cells, np.empty((0, 2), np.int64))


def plates_of(model: Model) -> list[PlateMesh]:
    """The plates of a model."""
    return [part for part in model.parts.values() if isinstance(part, PlateMesh)]


def rigid_plates(model: Model) -> dict[str, PlateMesh]:
    """Those that are rigid in their planes, by name."""
    return {part.name: part for part in plates_of(model) if part.rigid_in_plane}
