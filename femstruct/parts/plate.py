"""Plates: flat, rectangular, bending by Kirchhoff's theory, rigid in their own plane."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
from scipy.sparse import csr_array

from femstruct.arrays import Floats, Integers, freeze, frozen
from femstruct.conventions import N_COMPONENTS, TWIST
from femstruct.elements import plate
from femstruct.errors import Finding, InputError
from femstruct.model.given import Given, given
from femstruct.model.grid.cell_sides import cell_sides
from femstruct.model.grid.geometry import distance_to_rectangle, from_rectangle, rectangle_axes, to_rectangle
from femstruct.model.grid.layout import Grids, Layout
from femstruct.model.grid.lines import divided, snapped
from femstruct.model.grid.regions import area_points, grid_points, region_box
from femstruct.model.grid.scatter import scattered
from femstruct.model.material import Material
from femstruct.model.model import Model
from femstruct.model.part import Body, Drawn, Meshed, OwnDofs, Part, Spread
from femstruct.model.probe import Point, Surface
from femstruct.model.region import Pair, Region, Side, Vector
from femstruct.model.rows import carried, flat_rows, sparse_rows
from femstruct.model.structure import PlaceOn, Support, SurfaceOn
from femstruct.parts.patches import patch_points
from femstruct.parts.plate_motion import plate_dofs, plate_rows
from femstruct.parts.plausibility import thickness_findings

STEEP = float(np.cos(np.radians(45.0)))  # from there on neither side is above or below
SURFACE_ORDER = 3
"""Gauss points a direction in each cell of a surface: exact for the volume a cell displaces, and for its second moment
with a linear weight; the deflection of a cell is cubic."""
ROUND = ((0, 2), (1, 2), (1, 3), (0, 3))  # ends of a box along x and y, corner by corner


@dataclass(frozen=True)
class Plate(Part):
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
    element: plate.PlateElement = "bfs16"
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

    def described(self) -> tuple[Given, ...]:
        return given(
            self,
            {
                "thickness": "m",
                "size": "m",
                "origin": "m",
                "mesh": "divisions" if isinstance(self.mesh, tuple) else "m",
            },
        )

    def corners(self) -> Floats:
        for key, value in (("thickness", self.thickness), ("size", min(self.size))):
            if not value > 0:
                raise InputError(f"parts.{self.name}.{key}", got=f"{value:g} m", expected="a positive length")
        local = np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]]) * self.size
        return from_rectangle(self, rectangle_axes(self), local)

    def body(self) -> Body:
        axes = rectangle_axes(self)
        corner = np.asarray(self.origin, dtype=np.float64) - self.thickness / 2.0 * axes[2]
        return Body(corner, axes, np.array([*self.size, self.thickness]), across=2)

    def materials(self) -> tuple[Material, ...]:
        return (self.material,)

    def implausible(self, lies: bool) -> tuple[Finding, ...]:
        flat = abs(float(rectangle_axes(self)[2, 2])) > np.sqrt(0.5)
        return thickness_findings(self.name, self.material, self.thickness, min(self.size), flat and not lies)

    def lay_out(self, layout: Layout) -> None:
        layout.add_rectangle(self, cell_sides(f"parts.{self.name}.mesh", self.size, self.mesh))
        layout.bodies[self.name] = self.body()

    def meshed(self, layout: Layout, grids: Grids, first: int) -> PlateMesh:
        return PlateMesh(self, first, layout.axes_of[self.name], grids[self.name, 0], grids[self.name, 1])


@dataclass(frozen=True, eq=False)
class PlateMesh(Meshed):
    """A plate on its grid.

    first : number of its first node. axes [3, 3] : rows are its x, y and normal in global components. x [nx + 1],
    y [ny + 1] : grid lines from its origin corner [m].
    """

    part: Plate
    first: int
    axes: Floats
    x: Floats
    y: Floats
    rigid_in_plane: ClassVar[bool] = True

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
        return self.part.material.rho * self.part.thickness

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
    def loss_factor(self) -> float:
        return self.part.material.loss_factor

    @property
    def own_axes(self) -> Floats:
        return self.axes

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

    def dofs(self) -> OwnDofs:
        return plate_dofs(self.part.element, self.axes, self.local, self.part.size)

    def stiffness_and_mass(self) -> tuple[csr_array, csr_array]:
        """Bending of its cells, inertia as a rigid body in its plane."""
        part, material = self.part, self.part.material
        a, b = self.cell_sizes
        per_node = plate.dofs_per_node(part.element)
        count = len(self.x) * len(self.y) * per_node + 3
        of_cells = ((self.quads - self.first)[:, :, None] * per_node + np.arange(per_node)).reshape(len(a), -1)
        rigidity = plate.rigidity(material.E, material.nu, part.thickness)
        cells = plate.stiffness(part.element, a, b, rigidity), plate.mass(part.element, a, b, self.per_area)
        K, M = scattered(*cells, of_cells, count)
        width, height = part.size
        total = self.per_area * width * height
        inertia = np.array([total, total, total * (width**2 + height**2) / 12.0])
        in_plane = count - 3 + np.arange(3)
        return K, csr_array(M + csr_array((inertia, (in_plane, in_plane)), shape=M.shape))

    def rows(self, local: Floats) -> tuple[Integers, Floats]:
        """Nodes [p, 4] and rows [p, 6, 4, 7] of the motion of its places [p, 2] [m], as `plate_rows`."""
        return plate_rows(self.part.element, self.axes, (self.x, self.y), self.grid, local)

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
        """Raises InputError for a side steeper than 45 degrees, which is neither above nor below."""
        where = f"surfaces.{item.name}"
        if item.region.kind not in ("whole", "rectangle"):
            raise InputError(f"{where}.region", got=item.region.kind, expected="whole or a rectangle")
        if abs(self.axes[2, 2]) < STEEP - 1e-12:
            angle = np.degrees(np.arccos(abs(self.axes[2, 2])))
            got = f"'{item.side}' of a plate at {angle:.0f} degrees"
            raise InputError(f"{where}.side", got=got, expected="at most 45 degrees")
        normal = self.side_normal(item.side)
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
        )

    def edges(self, item: Support, tolerance: float) -> list[tuple[Integers, Floats, Floats]]:
        """`simple` holds the slope along an edge: w_x = -RY where it is parallel to x, w_y = RX where to y."""
        clamped = np.zeros((7, N_COMPONENTS))
        clamped[:3, :3] = clamped[3:6, 3:6] = self.axes
        clamped[6, TWIST] = 1.0
        grid = self.grid
        if item.line is not None:
            where = f"supports.{item.name}.line"
            box = region_box(where, self.name, self.part.size, Region("line", line=item.line), tolerance)
            in_x = np.flatnonzero((self.x >= box[0] - tolerance) & (self.x <= box[1] + tolerance))
            in_y = np.flatnonzero((self.y >= box[2] - tolerance) & (self.y <= box[3] + tolerance))
            found = [(grid[np.ix_(in_x, in_y)].ravel(), 0 if len(in_x) > 1 else 1)]
        else:
            sides = {"x0": (grid[0], 1), "x1": (grid[-1], 1), "y0": (grid[:, 0], 0), "y1": (grid[:, -1], 0)}
            found = list(sides.values()) if item.edge == "all" else [sides[str(item.edge)]]
        return [(nodes, clamped, clamped[[0, 1, 2, 4 if along == 0 else 3]]) for nodes, along in found]

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
