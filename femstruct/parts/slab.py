"""Slabs: flat, with an outline of right angles and rectangular openings, as a shell on a grid of its own."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from femstruct.arrays import Floats, Integers
from femstruct.declared import checked
from femstruct.errors import Finding, InputError
from femstruct.model.flat_cells import flat_cells
from femstruct.model.imported_mesh import ImportedMesh
from femstruct.model.lay_ups import LayUp, materials_of, section_of
from femstruct.model.layout import Gridded, Grids, Hole, Layout, grid_cells
from femstruct.model.materials import AnyMaterial, Given, Material, given_fields
from femstruct.model.part import FilledBox
from femstruct.model.probe import Point
from femstruct.model.regions import Pair, Vector, carry_along_arms, from_rectangle, rectangle_axes, to_rectangle
from femstruct.model.structure import PlaceOn
from femstruct.parts.cells import GivenNodes
from femstruct.parts.plausibility import refuse_thicker, thickness_findings
from femstruct.parts.shell import FlatMesh, Shell
from femstruct.tags import stored_as

# ----------------------------------------------------------------------------------------------------------------------
# Which cell of a flat grid a place is in, where some cells of the grid are missing.
# ----------------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class GridCells:
    """Rectangular cells between the lines of a grid.

    x [nx + 1], y [ny + 1] : lines, ascending [m]. which [nx, ny] : numbers of the cells, -1 where there is none.

    Two cells of three that make an L:

    >>> corners = np.array([[[0, 0], [1, 0], [1, 1], [0, 1]], [[1, 0], [2, 0], [2, 1], [1, 1]],
    ...                     [[0, 1], [1, 1], [1, 3], [0, 3]]], dtype=float)
    >>> cells = GridCells.of(corners)
    >>> cells.at(np.array([[0.5, 2.0], [1.5, 0.5], [1.5, 2.0], [1.0, 2.0]]), 1e-9).tolist()
    [2, 1, -1, 2]
    """

    x: Floats
    y: Floats
    which: Integers

    @classmethod
    def of(cls, corners: Floats) -> GridCells:
        """The grid of cells with these corners [m, 4, 2], along its axes."""
        low, high = corners.min(axis=1), corners.max(axis=1)
        small = 1e-6 * float((high - low).min())
        x, y = (_apart(corners[..., axis].ravel(), small) for axis in (0, 1))
        middles = (low + high) / 2.0
        which = np.full((len(x) - 1, len(y) - 1), -1)
        which[np.searchsorted(x, middles[:, 0]) - 1, np.searchsorted(y, middles[:, 1]) - 1] = np.arange(len(corners))
        return cls(x, y, which)

    def at(self, places: Floats, tolerance: float) -> Integers:
        """Numbers of the cells that places [p, 2] are in or on, within a tolerance [m]; -1 where there is none."""
        found = np.full(len(places), -1)
        for shift in product((-tolerance, tolerance), repeat=2):  # on a line it may be in any of four
            column, row = (
                np.searchsorted(lines, places[:, axis] + shift[axis], side="right") - 1
                for axis, lines in enumerate((self.x, self.y))
            )
            inside = (column >= 0) & (column < len(self.x) - 1) & (row >= 0) & (row < len(self.y) - 1)
            seen = np.where(inside, self.which[column * inside, row * inside], -1)
            found = np.where(found < 0, seen, found)
        return found


def _apart(values: Floats, small: float) -> Floats:
    """The values in ascending order, those that are one but for rounding once."""
    ordered = np.sort(values)
    kept: Floats = ordered[np.r_[True, np.diff(ordered) > small]]
    return kept


# ----------------------------------------------------------------------------------------------------------------------
# Slabs.
# ----------------------------------------------------------------------------------------------------------------------


@stored_as("slab/1")
@dataclass(frozen=True)
@checked("parts")
class Slab(GivenNodes):
    """A flat slab of any outline with right angles; thick or thin, its elements shear.

    material : one material, or a lay-up, whose x is along the slab's. outline : corners in turn in the slab's own
    coordinates [m]. mesh : largest element side [m]. holes : rectangular openings, each its sides and its middle [m].
    through : places that get a node, where columns or walls stand [m]. origin : place of the coordinates (0, 0) of the
    mid-surface [m]; normal, x_direction : as of a plate. offset : from there to the middle of the thickness [m].

    It has the sets "rim", "side 1" (from the first corner to the second), .., "hole 1", ...

    An L-shaped slab with an opening, and its area:

    >>> concrete = Material("concrete", E=30e9, nu=0.2, rho=2400.0)
    >>> corners = ((0.0, 0.0), (8.0, 0.0), (8.0, 4.0), (4.0, 4.0), (4.0, 8.0), (0.0, 8.0))
    >>> floor = Slab("floor", concrete, 0.2, corners, mesh=0.5, holes=(((2.0, 1.0), (2.0, 6.0)),))
    >>> from femstruct import Structure, mesh_structure
    >>> round(mesh_structure(Structure("a floor", (floor,))).parts["floor"].mass / 2400.0 / 0.2, 9)
    46.0
    """

    name: str
    material: AnyMaterial | LayUp
    thickness: float
    outline: tuple[Pair, ...]
    mesh: float
    holes: tuple[Hole, ...] = ()
    through: tuple[Pair, ...] = ()
    origin: Vector = (0.0, 0.0, 0.0)
    normal: Vector = (0.0, 0.0, 1.0)
    x_direction: Vector | None = None
    offset: float = 0.0

    def __post_init__(self) -> None:
        """Raises InputError for an outline, holes, places or a thickness that cannot be."""
        self.grid()
        if not self.thickness > 0:
            raise InputError(f"parts.{self.name}.thickness", got=f"{self.thickness:g} m", expected="a positive length")
        side = float(np.ptp(self.outline, axis=0).min())
        refuse_thicker(self.name, "slab", self.material, self.thickness, side)

    def described(self) -> tuple[Given, ...]:
        keys = ("thickness", "outline", "mesh", "holes", "through", "origin", "offset")
        return given_fields(self, dict.fromkeys(keys, "m"))

    def grid(self) -> Gridded:
        """Its nodes and cells in its own coordinates."""
        return grid_cells(f"parts.{self.name}", self.outline, self.holes, self.through, self.mesh)

    @property
    def size(self) -> Pair:
        """Sides of the rectangle round its outline [m]."""
        along, across = np.ptp(np.array(self.outline), axis=0).tolist()
        return along, across

    def shell(self) -> Shell:
        """The shell that it is."""
        axes, grid = rectangle_axes(self), self.grid()
        numbers = np.arange(1, len(grid.cells) + 1)
        mesh = ImportedMesh(
            self.name,
            from_rectangle(self, axes, grid.places),
            np.arange(1, len(grid.places) + 1),
            {"quad4": grid.cells},
            {"quad4": numbers},
            grid.lines,
        )
        x = None if isinstance(self.material, Material) else tuple(axes[0].tolist())
        return Shell(self.name, mesh, self.material, self.thickness, offset=self.offset, orientation=x)

    def corners(self) -> Floats:
        return from_rectangle(self, rectangle_axes(self), self.grid().places)

    def body(self) -> FilledBox:
        """The box round its outline: layers fill what of it is slab."""
        axes, low = rectangle_axes(self), np.array(self.outline).min(axis=0)
        corner = from_rectangle(self, axes, np.array([*low, self.offset - self.thickness / 2.0]))
        return FilledBox(corner, axes, np.array([*self.size, self.thickness]), across=2)

    @property
    def cell_size(self) -> float:
        return self.mesh

    def lay_out(self, layout: Layout) -> None:
        super().lay_out(layout)
        layout.bodies[self.name] = self.body()

    def materials(self) -> tuple[AnyMaterial, ...]:
        return materials_of(self.material)

    def implausible(self, lies: bool) -> tuple[Finding, ...]:
        section = section_of(self.material, self.thickness)
        return thickness_findings(self.name, section, self.materials(), min(self.size), False)

    def middles(self) -> Floats:
        return self.shell().middles()

    def meshed(self, layout: Layout, grids: Grids, first: int) -> SlabMesh:
        shell = self.shell()
        cells = flat_cells(shell.mesh, None)
        return SlabMesh(shell, first, cells, np.full(len(cells.cells), self.thickness), rectangle_axes(self), self)


@stored_as("slab mesh/1")
@dataclass(frozen=True, eq=False)
class SlabMesh(FlatMesh):
    """A slab on its cells."""

    slab: Slab

    @property
    def _grid(self) -> GridCells:
        return GridCells.of(to_rectangle(self.slab, self.axes, self.cells.points)[:, :2][self.cells.quads])

    def covers(self, places: Floats, tolerance: float) -> NDArray[np.bool_]:
        return self._cells_under(places, tolerance) >= 0

    def motion_at(self, places: Floats, tolerance: float) -> tuple[Integers, Floats]:
        """Off its mid-surface, places stand on its normals."""
        which = self._cells_under(places, tolerance)
        first, second, _, last = np.moveaxis(self.cells.points[self.cells.corners[which]], 1, 0)
        xi, eta = (_share(places - first, side - first) for side in (last, second))
        nodes, rows = self.facet_motion(which, xi, eta)
        height = float(((places - first) @ self.axes[2]).mean())
        return nodes, carry_along_arms(rows, height * self.axes[2]) if abs(height) > tolerance else rows

    def lines_across(self, along: Floats, origin: Floats) -> Floats:
        cosines = self.axes[:2] @ along
        own = int(np.argmax(np.abs(cosines)))
        start = float((np.asarray(self.slab.origin) - origin) @ along)
        lines: Floats = start + np.sign(cosines[own]) * (self._grid.x, self._grid.y)[own]
        return lines

    def _cells_under(self, places: Floats, tolerance: float) -> Integers:
        return self._grid.at(to_rectangle(self.slab, self.axes, places)[:, :2], tolerance)

    def _along(self, normal: Floats) -> Floats:
        return self.axes[:2]

    def point(self, name: str, place: PlaceOn, at: Floats, tolerance: float) -> Point:
        """As of a shell, by two coordinates of its own."""
        if place.named is None and len(at) != 2:
            got, expected = f"{len(at)} numbers", "[x, y] in the coordinates of its outline"
            raise InputError(f"points.{name}.at", got=got, expected=expected)
        return super().point(name, place, from_rectangle(self.slab, self.axes, at), tolerance)


def _share(arms: Floats, sides: Floats) -> Floats:
    """How far along sides [p, 3] arms [p, 3] reach, 0 to 1."""
    found: Floats = np.clip((arms * sides).sum(axis=1) / (sides**2).sum(axis=1), 0.0, 1.0)
    return found
