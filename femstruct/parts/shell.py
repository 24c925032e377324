"""Shells: triangles and quadrilaterals of a mesh from a file, flat or curved by facets, thin to thick."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import connected_components

from femstruct.arrays import Floats, Integers, freeze, frozen
from femstruct.conventions import N_COMPONENTS
from femstruct.declared import checked
from femstruct.errors import Finding, InputError
from femstruct.model.given import Given, given
from femstruct.model.grid.layout import Grids, Layout
from femstruct.model.imported.doubts import refuse_degenerate, shell_doubts
from femstruct.model.imported.facing import frame_across, outer_line, outwards, rectangle_round, upwards
from femstruct.model.imported.flat_cells import FlatCells, flat_cells
from femstruct.model.imported.imported_mesh import ImportedMesh, put_where
from femstruct.model.imported.shell_cells import (
    Sections,
    cell_matrices,
    cell_points,
    cell_sections,
    cross_turning,
    nearest_place,
    rows_at,
)
from femstruct.model.imported.shell_stresses import face_stresses
from femstruct.model.imported.unit_slips import in_millimetres, shell_slips
from femstruct.model.material import Material
from femstruct.model.materials.lay_up import LayUp, section_of, stresses_of_resultants
from femstruct.model.materials.loss_by_frequency import Loss
from femstruct.model.materials.orthotropic import AnyMaterial
from femstruct.model.part import Drawn, Meshed, OwnDofs, Part, Spread, nodal_dofs, refuse_patch
from femstruct.model.probe import Point, StressPlaces, Surface
from femstruct.model.region import Region, Side, Vector
from femstruct.model.rows import carried, flat_rows, sparse_rows
from femstruct.model.structure import PlaceOn, SurfaceOn
from femstruct.parts.plausibility import refuse_thicker

FLAT = 1e-9  # largest difference of the normals of the cells of a flat shell
THICK = 1.0  # m: of less than that the unit of the mesh may be mistaken as well, which a finding says
CLOSED = 1e-3  # of its area: a surface whose normals add to less has no side
ORDER = 2  # Gauss points a direction in each cell of a surface: the deflection of a cell is bilinear


@dataclass(frozen=True)
@checked("parts")
class Shell(Part):
    """A shell on the triangles and quadrilaterals of a mesh, or of a set of it.

    mesh : as `read_mesh_file` gives it. named : the set; None for all of them. thickness : of all, or by names of sets
    of cells [m]; None for that of a lay-up, or for what the file states. offset : from the mesh to the middle of the
    thickness, along the normal of each cell [m]. orientation : direction of the x of an orthotropic material or a
    lay-up, laid into each cell.

    Quadrilaterals are the better elements; quadratic cells are cut into four linear ones. Normals are made consistent
    over each patch of cells.

    A tray of steel, 2 mm thick, of four cells:

    >>> steel = Material("steel", E=210e9, nu=0.3, rho=7850.0)
    >>> corners = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0], [0, 0, 1], [1, 0, 1], [2, 0, 1]]
    >>> cells = [[0, 1, 4, 3], [1, 2, 5, 4], [0, 1, 7, 6], [1, 2, 8, 7]]
    >>> mesh = ImportedMesh("tray", corners, range(1, 10), {"quad4": cells}, {"quad4": [1, 2, 3, 4]})
    >>> tray = Shell("tray", mesh, steel, thickness=2e-3)
    >>> from femstruct import Structure, mesh_structure
    >>> round(mesh_structure(Structure("a tray", (tray,))).parts["tray"].mass, 6)
    62.8
    """

    name: str
    mesh: ImportedMesh
    material: AnyMaterial | LayUp
    thickness: float | Mapping[str, float] | None = None
    named: str | None = None
    offset: float = 0.0
    orientation: Vector | None = None

    def __post_init__(self) -> None:
        """Raises InputError for a set that is not there or has no such cells, and for directions that are missing."""
        key = "mesh" if self.named is None else "set"
        put_where(f"parts.{self.name}.{key}", lambda: self.mesh.cells_of(self.named, 2))
        where, plain = f"parts.{self.name}.orientation", isinstance(self.material, Material)
        if plain and self.orientation is not None:
            raise InputError(where, got="one of an isotropic material", expected="none")
        if not plain and (self.orientation is None or not np.linalg.norm(self.orientation) > 0):
            raise InputError(
                where,
                got="none" if self.orientation is None else f"{self.orientation}",
                expected="'orientation', the direction of the material's x",
                do="write orientation: [1, 0, 0]",
            )

    def described(self) -> tuple[Given, ...]:
        kept = tuple(one for one in given(self, {"thickness": "m", "offset": "m"}) if one.what != "mesh")
        cells = ", ".join(f"{len(some)} {kind}" for kind, some in self.mesh.cells.items())
        return (Given("mesh", f"{self.mesh.source} ({cells}, {len(self.mesh.points)} nodes)"), *kept)

    def corners(self) -> Floats:
        cells = self.mesh.cells_of(self.named, 2)
        used = np.unique(np.concatenate([self.mesh.cells[kind][rows].ravel() for kind, rows in cells.items()]))
        return np.asarray(self.mesh.points[used])

    def materials(self) -> tuple[AnyMaterial, ...]:
        return self.material.materials if isinstance(self.material, LayUp) else (self.material,)

    def middles(self) -> Floats:
        return self.mesh.middles_of(self.named, 2)

    def taken(self) -> tuple[tuple[ImportedMesh, Mapping[str, Integers]], ...]:
        return ((self.mesh, self.mesh.cells_of(self.named, 2)),)

    def lay_out(self, layout: Layout) -> None:
        layout.given.add(self.name)

    def meshed(self, layout: Layout, grids: Grids, first: int) -> ShellMesh:
        cells = flat_cells(self.mesh, self.named)
        refuse_degenerate(f"parts.{self.name}.mesh", self.mesh, cells)
        return ShellMesh(self, first, cells, self._thickness_of(cells))

    def _thickness_of(self, cells: FlatCells) -> Floats:
        """Thickness of each cell [m]."""
        where = f"parts.{self.name}.thickness"
        by_set: dict[str | None, float]
        if isinstance(self.material, LayUp):
            if self.thickness not in (None, self.material.thickness):
                expected = f"{self.material.thickness:g} m, that of its layers"
                raise InputError(where, got=f"{self.thickness} m", expected=expected, do="leave it out")
            by_set = {None: self.material.thickness}
        elif isinstance(self.thickness, Mapping):
            by_set = dict(self.thickness.items())
        elif self.thickness is not None:
            by_set = {None: self.thickness}
        else:
            stated = {one.cells: one.thickness for one in self.mesh.stated.properties if one.thickness is not None}
            by_set = {name: value for name, value in stated.items() if self._has(name, cells)}
            if not by_set:
                got = f"none, and none in {self.mesh.source}"
                raise InputError(where, got=got, expected="a thickness", do="write 'thickness: 2 mm', or one by set")
        side = float(np.sort(np.ptp(cells.points[np.unique(cells.corners)], axis=0))[1])  # of a flat one the shorter
        found = np.zeros(len(cells.cells))
        for name, value in by_set.items():
            if not value > 0:
                raise InputError(where, got=f"{value:g} m", expected="a positive length")
            if value > THICK:
                refuse_thicker(self.name, "shell", self.material, value, side)
            own = np.ones(len(found), dtype=bool) if name is None else self._of_set(where, name, cells)
            if (found[own] > 0).any() and (found[own][found[own] > 0] != value).any():
                raise InputError(where, got=f"a second thickness of cells of set '{name}'", expected="one of each cell")
            found[own] = value
        if not (found > 0).all():
            got = f"{int((found == 0).sum())} of {len(found)} cells without one"
            raise InputError(where, got=got, expected="a set with a thickness for each cell")
        return found

    def _of_set(self, where: str, name: str, cells: FlatCells) -> np.ndarray:
        return put_where(where, lambda: cells.in_set(self.mesh, name))

    def _has(self, name: str, cells: FlatCells) -> bool:
        kinds = self.mesh.cell_sets.get(name, {})
        return any(kind.startswith(("tri", "quad")) for kind in kinds) and bool(cells.in_set(self.mesh, name).any())

    def implausible(self, lies: bool) -> tuple[Finding, ...]:
        cells = flat_cells(self.mesh, self.named)
        thickness = self._thickness_of(cells)
        mass = ShellMesh(self, 0, cells, thickness).mass
        stated = self.thickness is None and not isinstance(self.material, LayUp)
        unit = shell_slips(self.name, self.mesh, cells, thickness, mass, stated)
        return shell_doubts(self.name, self.mesh, self.named, cells, unit)


@dataclass(frozen=True, eq=False)
class ShellMesh(Meshed):
    """A shell on its cells.

    first : number of its first node. cells : with nodes counted from 0 on. thickness [q + t] : of the cells [m].
    """

    part: Shell
    first: int
    cells: FlatCells
    thickness: Floats

    def __post_init__(self) -> None:
        freeze(self, thickness=frozen(f"parts.{self.part.name} thickness", self.thickness, (len(self.cells.cells),)))

    @property
    def sections(self) -> Sections:
        """Rigidities and masses per area of its cells, about the middle of their thickness."""
        different, which = np.unique(self.thickness, return_inverse=True)
        made = [section_of(self.part.material, float(t)) for t in different]
        x = None if self.part.orientation is None else np.asarray(self.part.orientation, dtype=np.float64)
        return cell_sections(self.cells, made, which.ravel(), x)

    @property
    def name(self) -> str:
        return self.part.name

    @property
    def places(self) -> Floats:
        return self.cells.points

    @property
    def of_file(self) -> tuple[ImportedMesh, Integers]:
        return self.part.mesh, self.cells.rows

    @property
    def quads(self) -> Integers:
        return self.first + self.cells.corners

    @property
    def per_area(self) -> Floats:
        """Mass per area of the cells [q + t] [kg/m^2]."""
        return self.sections.m0

    @property
    def mass(self) -> float:
        return float(self.per_area @ self.cells.areas)

    @property
    def lumps(self) -> Floats:
        lumps = np.zeros(len(self.places))
        masses = self.per_area * self.cells.areas
        quads, triangles = self.cells.quads, self.cells.triangles
        np.add.at(lumps, quads, masses[: len(quads), None] / 4.0)
        np.add.at(lumps, triangles, masses[len(quads) :, None] / 3.0)
        return lumps

    @property
    def loss_factor(self) -> Loss:
        return section_of(self.part.material, float(self.thickness[0])).loss_factor

    @property
    def held_together(self) -> list[Integers]:
        corners, count = self.cells.corners, len(self.places)
        links = (np.ones(3 * len(corners)), (np.repeat(corners[:, 0], 3), corners[:, 1:].ravel()))
        label = connected_components(coo_array(links, shape=(count, count)), directed=False)[1]
        order = np.argsort(label, kind="stable")
        return list(np.split(self.first + order, np.flatnonzero(np.diff(label[order])) + 1))

    @property
    def own_axes(self) -> Floats | None:
        """Two directions in it and its normal where it is flat."""
        normals = self.cells.normals
        if np.abs(normals - normals[0]).max() > FLAT:
            return None
        return np.concatenate([frame_across(normals[0], self.places)[0], normals[:1]])

    def around(self, nodes: Integers) -> Meshed:
        """Flat, with axes, where all cells that meet at the nodes are in parallel planes."""
        touching = np.isin(self.cells.corners, nodes - self.first).any(axis=1)
        normals = self.cells.normals[touching]
        if self.own_axes is not None or np.abs(normals - normals[0]).max() > FLAT:
            return self
        axes = np.concatenate([frame_across(normals[0], self.places)[0], normals[:1]])
        return FlatMesh(self.part, self.first, self.cells, self.thickness, axes)

    @property
    def across(self) -> Floats:
        """Half its thickness along its normal, of a flat one."""
        axes = self.own_axes
        return np.zeros(3) if axes is None else axes[2] * float(self.thickness.max()) / 2.0

    @property
    def drilling(self) -> Floats | None:
        axes = self.own_axes
        return None if axes is None else axes[2]

    def turning(self, nodes: Integers, reach: float, n_nodes: int) -> csr_array:
        """As of a plate: the rigid turn of the ends of a cross around each node, as far as they lie on it."""
        axes = self.own_axes
        if axes is None:
            return super().turning(nodes, reach, n_nodes)
        corners, rows = cross_turning(self.cells, self.places[nodes - self.first], reach, axes)
        return sparse_rows(self.first + corners, rows, n_nodes)

    def dofs(self) -> OwnDofs:
        return nodal_dofs(len(self.places), 6)

    def stiffness_and_mass(self) -> tuple[csr_array, csr_array]:
        return put_where(f"parts.{self.name}", lambda: cell_matrices(self.cells, self.sections, self.part.offset))

    def within(self, where: str, region: Region, tolerance: float) -> Integers:
        found = put_where(where, lambda: self.cells.nodes_within(self.part.mesh, region, tolerance))
        if not len(found):
            raise InputError(where, got=f"a {region} without a node of {self.name}", expected="one with nodes")
        return self.first + found

    def point(self, name: str, place: PlaceOn, at: Floats, tolerance: float) -> Point:
        """The nearest place of it, on a rigid arm where it is off by half the thickness; or the mean of a set."""
        where = f"points.{name}"
        refuse_patch(name, place)
        if place.named is not None:
            nodes = self.within(f"{where}.set", Region("set", named=place.named), tolerance)
            rows = np.zeros((len(nodes), 6, 1, N_COMPONENTS))
            rows[:, :, 0, :6] = np.eye(6)
            normal = self._normal_at(nodes - self.first, place.side)
            position = self.places[nodes - self.first].mean(axis=0)
            spots = flat_rows(nodes[:, None], rows, np.full(len(nodes), 1.0 / len(nodes)))
            return Point(name, position, *spots, normal=normal)
        if len(at) != 3:
            raise InputError(f"{where}.at", got=f"{len(at)} numbers", expected="[x, y, z], global")
        found = nearest_place(self.cells, at)
        reach = float(self.thickness[found.cell]) / 2.0 + abs(self.part.offset) + tolerance
        off = float(np.linalg.norm(at - found.position))
        if off > reach:
            x, y, z = found.position
            raise InputError(
                f"{where}.at",
                got=f"({at[0]:g}, {at[1]:g}, {at[2]:g}) m, {off:.4g} m off {self.name}",
                expected=f"a place on it; the nearest is ({x:.6g}, {y:.6g}, {z:.6g}) m",
                do=in_millimetres(self.part.mesh, self.places),
            )
        nodes, rows = rows_at(self.cells, np.array([found.cell]), found.xi, found.eta)
        if off > tolerance:
            rows = carried(rows, at - found.position)
        spots = flat_rows(self.first + nodes, rows, np.ones(1))
        return Point(name, at, *spots, normal=outwards(self.cells.normals[found.cell], place.side))

    def _normal_at(self, nodes: Integers, side: Side) -> Floats:
        touching = np.isin(self.cells.corners, nodes).any(axis=1)
        return outwards((self.cells.normals * self.cells.areas[:, None])[touching].sum(axis=0), side)

    def surface(self, item: SurfaceOn, n_nodes: int, tolerance: float) -> Surface:
        """Above and below are told as for a plate; where neither side is up, above is that of the cells' own normals.

        Raises InputError for a closed surface, whose normals add to nothing.
        """
        where = f"surfaces.{item.name}.region"
        chosen = self._cells_of(where, item.region, tolerance)
        points = cell_points(self.cells, chosen, ORDER)
        signs = self._signs(where, chosen, item.side)
        if not self.cells.two_sided:
            raise InputError(
                where, got=f"a side of {self.name}, which has only one, as a Moebius strip", expected="two"
            )
        normals = signs[points.cells, None] * self.cells.normals[points.cells]
        normal = points.weights @ normals / float(np.linalg.norm(points.weights @ normals))
        nodes, rows = rows_at(self.cells, points.cells, points.xi, points.eta)
        along_normal = np.einsum("pj,pjkc->pkc", normals, rows[:, :3])[:, None]
        along, corners = self._along(normal), self.places[np.unique(self.cells.corners[chosen])]
        outline = outer_line(self.places, self.cells.corners[chosen])
        return Surface(
            item.name,
            points=points.places,
            weights=points.weights,
            normals=normals,
            along=along,
            outline=rectangle_round(along, corners) if outline is None else outline,
            rows=sparse_rows(self.first + nodes, along_normal, n_nodes),
        )

    def _signs(self, where: str, chosen: Integers, side: Side) -> Floats:
        """1 or -1 for each cell [q + t], its normal out of the named side or into it; patch by patch, since where three
        cells meet at an edge no patch says how the next one is turned. Raises InputError for a closed patch."""
        vectors, areas = self.cells.normals * self.cells.areas[:, None], self.cells.areas
        signs = np.zeros(len(areas))
        for patch in np.unique(self.cells.patches[chosen]):
            own = chosen[self.cells.patches[chosen] == patch]
            whole = vectors[own].sum(axis=0)
            if np.linalg.norm(whole) < CLOSED * areas[own].sum():
                got = f"all of {self.name}, which is closed"
                raise InputError(where, got=got, expected="a side of it", do="name a set")
            signs[own] = np.sign(outwards(whole, side) @ whole)
        return signs

    def _along(self, normal: Floats) -> Floats:
        """Directions [2, 3] along which what lies against a surface is measured."""
        return frame_across(upwards(normal), self.places)[0]

    def _cells_of(self, where: str, region: Region, tolerance: float) -> Integers:
        """Cells of a region: of a set, with all corners in a box, or all."""
        if region.kind == "set":
            return np.flatnonzero(self.part._of_set(where, region.named or "", self.cells))
        if region.kind not in ("whole", "box"):
            raise InputError(where, got=f"a {region.kind} of a shell", expected="whole, a set or a box")
        nodes = self.cells.nodes_within(self.part.mesh, region, tolerance)
        found = np.flatnonzero(np.isin(self.cells.corners, nodes).all(axis=1))
        if not len(found):
            raise InputError(where, got=f"a {region} without a cell of {self.name}", expected="one with cells")
        return found

    def spread(self, where: str, region: Region, tolerance: float, order: int) -> Spread:
        points = cell_points(self.cells, self._cells_of(where, region, tolerance), order)
        nodes, rows = rows_at(self.cells, points.cells, points.xi, points.eta)
        return Spread(self.first + nodes, rows, points.weights, "area", region.kind)

    def stresses(self, n_nodes: int) -> StressPlaces:
        """At both faces of every node, and of every layer, the front being that of the normals; the shear stress across
        the thickness is left out. Along the directions of the material, or of a cell at each place. Raises InputError
        for smeared ribs, whose stresses are unknown."""
        different, which = np.unique(self.thickness, return_inverse=True)
        each = [stresses_of_resultants(self.part.material, float(t)) for t in different]
        kinds, of_faces = which.ravel(), np.stack([faces for _, faces in each])
        x = None if self.part.orientation is None else np.asarray(self.part.orientation, dtype=np.float64)
        numbers, offset = (self.first, n_nodes), self.part.offset
        found = face_stresses(self.cells, self.sections, (kinds, of_faces), offset, x, numbers)
        heights = np.stack([heights for heights, _ in each])[kinds[found.cells]] + offset
        count = heights.shape[1]
        meets = (count * found.places[:, None] + np.arange(count)).ravel()
        places = self.places[found.nodes][:, None] + heights[..., None] * found.normals[:, None]
        words = tuple(f"{side} layer {n + 1}" for n in range(count // 2) for side in ("back", "front"))
        sides = ("front", "back") if count == 2 and not isinstance(self.part.material, LayUp) else words
        return StressPlaces(places.reshape(-1, 3), ("xx", "yy", "xy"), found.rows, sides, found.of_cells, meets)

    def drawn(self, divisions: int, along: int, n_nodes: int) -> Drawn:
        """Its cells as they are: they are as fine as its motion."""
        rows = np.zeros((len(self.places), 3, 1, N_COMPONENTS))
        rows[:, :, 0, :3] = np.eye(3)
        nodes = self.first + np.arange(len(self.places))[:, None]
        return Drawn(self.places, sparse_rows(nodes, rows, n_nodes), self.cells.corners, np.empty((0, 2), np.int64))


@dataclass(frozen=True, eq=False)
class FlatMesh(ShellMesh):
    """A shell that is flat, at least where something is joined to it. axes [3, 3] : rows are its x, y and normal."""

    axes: Floats

    @property
    def own_axes(self) -> Floats:
        return self.axes
