"""Shells: triangles and quadrilaterals of a mesh from a file, flat or curved by facets, thin to thick."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Final

import numpy as np
from scipy.sparse import csr_array

from femstruct.arrays import Floats, Integers, freeze, frozen
from femstruct.conventions import N_COMPONENTS
from femstruct.declared import checked
from femstruct.errors import Finding, InputError
from femstruct.model.flat_cells import FlatCells, area_vectors, flat_cells, refuse_degenerate, shell_doubts, shell_slips
from femstruct.model.imported_mesh import (
    KINDS,
    ImportedMesh,
    Makes,
    StatedProperty,
    StatedSpread,
    frame_across,
    outwards,
    with_where,
)
from femstruct.model.lay_ups import LayUp, PlateSection, section_of, stresses_of_resultants
from femstruct.model.layout import Grids, Layout
from femstruct.model.materials import AnyMaterial, Loss, Material
from femstruct.model.part import EdgePoints, LossShare, Meshed, OwnDofs, nodal_dofs
from femstruct.model.probe import Point, StressPlaces, Surface
from femstruct.model.regions import Region, Side, Vector, flat_rows, sparse_rows
from femstruct.model.shell_cells import (
    Sections,
    cell_matrices,
    cell_sections,
    cell_shares,
    cross_turning,
    edge_gauss,
    face_stresses,
    rows_at,
    share_matrices,
)
from femstruct.model.structure import Support, SurfaceOn
from femstruct.parts.cells import CellsMesh, MeshPart, Words, mean_normal, side_surface
from femstruct.parts.plausibility import refuse_thicker
from femstruct.tags import stored_as

# ----------------------------------------------------------------------------------------------------------------------
# What the cells of a shell have: their thickness (of all, by sets, as the file states it, or that of layers), and mass
# on them that does not stiffen them (of the model, or what the file states, NSM).
# ----------------------------------------------------------------------------------------------------------------------

MOST: Final = 6  # layers that a message names
THICK: Final = 1.0  # m: of less than that the unit of the mesh may be mistaken as well, which a finding says


def cell_thickness(shell: Shell, cells: FlatCells) -> Floats:
    """Thickness of each cell of a shell [q + t] [m].

    Raises InputError for cells without one or with two, and for one that is not positive, is thicker than the shell is
    large, or is not that of its layers.
    """
    where = f"parts.{shell.name}.thickness"
    side = float(np.sort(np.ptp(cells.points[np.unique(cells.corners)], axis=0))[1])  # of a flat one the shorter
    found = np.zeros(len(cells.cells))
    for name, value in _by_set(where, shell, cells).items():
        if not value > 0:
            raise InputError(where, got=f"{value:g} m", expected="a positive length")
        if value > THICK:
            refuse_thicker(shell.name, "shell", shell.material, value, side)
        own = np.ones(len(found), dtype=bool) if name is None else _of_set(where, shell, name, cells)
        if (found[own] > 0).any() and (found[own][found[own] > 0] != value).any():
            raise InputError(where, got=f"a second thickness of cells of set '{name}'", expected="one of each cell")
        found[own] = value
    if not (found > 0).all():
        got = f"{int((found == 0).sum())} of {len(found)} cells without one"
        raise InputError(where, got=got, expected="a set with a thickness for each cell")
    return found


def _by_set(where: str, shell: Shell, cells: FlatCells) -> Mapping[str | None, float]:
    """What is given of the thickness [m] by names of sets; None for all cells."""
    if isinstance(shell.material, LayUp):
        if shell.thickness not in (None, shell.material.thickness):
            expected = f"{shell.material.thickness:g} m, that of its layers"
            raise InputError(where, got=f"{shell.thickness} m", expected=expected, do="leave it out")
        return {None: shell.material.thickness}
    if isinstance(shell.thickness, Mapping):
        return dict(shell.thickness.items())
    if shell.thickness is not None:
        return {None: shell.thickness}
    stated = {one.cells: one.thickness for one in shell.mesh.stated.properties if one.thickness is not None}
    found = {name: value for name, value in stated.items() if _has(shell, name, cells)}
    if not found:
        got = f"none, and none in {shell.mesh.source}"
        if (layered := _layers_of(shell, cells)) is not None:
            got = f"none, and layers of '{layered.cells}' in {shell.mesh.source}"
            raise InputError(
                where, got=got, expected="'layers' in place of 'material'", do=f"write {_written(layered)}"
            )
        raise InputError(where, got=got, expected="a thickness", do="write 'thickness: 2 mm', or one by set")
    return dict(found.items())


def _of_set(where: str, shell: Shell, name: str, cells: FlatCells) -> np.ndarray:
    return with_where(where, lambda: cells.in_set(shell.mesh, name))


def _has(shell: Shell, name: str, cells: FlatCells) -> bool:
    kinds = shell.mesh.cell_sets.get(name, {})
    return any(kind.startswith(("tri", "quad")) for kind in kinds) and bool(cells.in_set(shell.mesh, name).any())


def _layers_of(shell: Shell, cells: FlatCells) -> StatedProperty | None:
    """The lay-up that the file states for cells of the shell."""
    return next((one for one in shell.mesh.stated.properties if one.layers and _has(shell, one.cells, cells)), None)


def _written(layered: StatedProperty) -> str:
    """A lay-up as a model states it, with the materials of the file by their names there."""
    rows = []
    for one in layered.layers[:MOST]:
        turned = f", {one.angle:g} deg" if isinstance(one.angle, float) and one.angle else ""
        rows.append(
            f"[{one.material}, {1e3 * one.thickness:.4g} mm{turned or (f', {one.angle}' if one.angle else '')}]"
        )
    more = len(layered.layers) - MOST
    return f"layers: [{', '.join(rows)}{f', and {more} more' if more > 0 else ''}]"


def spread_mass(shell: Shell, cells: FlatCells, thickness: Floats) -> Floats:
    """Mass per area [q + t] [kg/m^2] on each cell of a shell.

    Parameters
    ----------
    thickness : Floats [q + t]
        Of the cells [m].
    """
    found = np.full(len(cells.cells), shell.nonstructural or 0.0)
    if Makes.SPREAD not in shell.takes() or not shell.mesh.stated.spread:
        return found
    numbers = _numbers(shell.mesh, cells)
    for one in shell.mesh.stated.spread:
        own = np.isin(numbers, one.cells)
        found[own] += shell.mesh.unit_of_mass * _per_area(shell.mesh, one, thickness[own])
    return found


def _numbers(mesh: ImportedMesh, cells: FlatCells) -> Integers:
    """What the file calls the cell that each is, or is cut from."""
    found = np.zeros(len(cells.cells), dtype=np.int64)
    for number, kind in enumerate(mesh.cells):
        own = cells.kinds == number
        found[own] = mesh.cell_numbers[kind][cells.cells[own]]
    return found


def _per_area(mesh: ImportedMesh, one: StatedSpread, thickness: Floats) -> Floats:
    """Of cells of a thickness each; a total is spread evenly over the area of all of its cells, whichever part has
    them."""
    if one.per == "volume":
        return one.amount * thickness
    area = 1.0 if one.per == "area" else _area(mesh, one.cells)
    return np.full(len(thickness), one.amount / area)


def _area(mesh: ImportedMesh, numbers: Integers) -> float:
    """Of the triangles and quadrilaterals among elements [m^2]."""
    total = 0.0
    for kind, rows in mesh.cells.items():
        if KINDS[kind].dimension == 2:
            corners = rows[np.isin(mesh.cell_numbers[kind], numbers)][:, : KINDS[kind].corners]
            four = corners[:, [0, 1, 2, -1]]  # of a triangle the last one twice
            total += float(np.linalg.norm(area_vectors(mesh.points, four), axis=1).sum())
    return total


# ----------------------------------------------------------------------------------------------------------------------
# Where the stresses of a shell are largest: at its faces and those of its layers, node by node.
# ----------------------------------------------------------------------------------------------------------------------


def stresses_on_faces(
    shell: Shell, cells: FlatCells, thickness: Floats, sections: Sections, numbers: tuple[int, int]
) -> StressPlaces:
    """At both faces of every node, and of every layer, the front being that of the normals; the shear stress across
    the thickness is left out. Along the directions of the material, or of a cell at each place.

    Parameters
    ----------
    thickness : Floats [q + t]
        Of the cells [m].
    sections : Sections
        Their rigidities.
    numbers : tuple[int, int]
        Of the first node, and of all nodes.

    Raises
    ------
    InputError
        For smeared ribs, whose stresses are unknown.
    """
    different, which = np.unique(thickness, return_inverse=True)
    each = [stresses_of_resultants(shell.material, float(t)) for t in different]
    kinds, of_faces = which.ravel(), np.stack([faces for _, faces in each])
    found = face_stresses(cells, sections, (kinds, of_faces), shell.shift, shell.x_direction, numbers)
    heights = np.stack([heights for heights, _ in each])[kinds[found.cells]] + shell.shift
    count = heights.shape[1]
    meets = (count * found.places[:, None] + np.arange(count)).ravel()
    places = cells.points[found.nodes][:, None] + heights[..., None] * found.axes[:, None, 2]
    words = tuple(f"{side} layer {n + 1}" for n in range(count // 2) for side in ("back", "front"))
    sides = ("front", "back") if count == 2 and not isinstance(shell.material, LayUp) else words
    axes = np.repeat(found.axes, count, axis=0)
    return StressPlaces(places.reshape(-1, 3), ("xx", "yy", "xy"), found.rows, sides, found.of_cells, meets, axes)


# ----------------------------------------------------------------------------------------------------------------------
# Shells on their cells: what they have at their nodes, their matrices, and what points and surfaces read of them.
# ----------------------------------------------------------------------------------------------------------------------

BENT: Final = 0.7  # cosine of 45 degrees, about: edges that meet at less are one line
FLAT: Final = 1e-9  # largest difference of the normals of the cells of a flat shell


@stored_as("shell mesh/1")
@dataclass(frozen=True, eq=False)
class ShellMesh(CellsMesh):
    """A shell on its cells.

    first : number of its first node. cells : with nodes counted from 0 on. thickness [q + t] : of the cells [m].
    """

    part: Shell
    first: int
    cells: FlatCells
    thickness: Floats
    words: ClassVar[Words] = Words("shell", "cell", "", "it")

    def __post_init__(self) -> None:
        freeze(self, thickness=frozen(f"parts.{self.part.name} thickness", self.thickness, (len(self.cells.cells),)))

    @property
    def sections(self) -> Sections:
        """Rigidities and masses per area of its cells, about the middle of their thickness."""
        found = cell_sections(self.cells, *self._made(), self.part.x_direction)
        return found._replace(m0=found.m0 + spread_mass(self.part, self.cells, self.thickness))

    def _made(self) -> tuple[list[PlateSection], Integers]:
        """Different sections, and the number of that of each cell [q + t]."""
        different, which = np.unique(self.thickness, return_inverse=True)
        return [section_of(self.part.material, float(t)) for t in different], which.ravel()

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
        mean = self.thickness @ self.cells.areas / self.cells.areas.sum()
        return section_of(self.part.material, float(mean)).loss_factor

    @property
    def own_axes(self) -> Floats | None:
        """Two directions in it and its normal where it is flat."""
        normals = self.cells.normals
        return None if np.abs(normals - normals[0]).max() > FLAT else self._axes_along(normals[0])

    def _axes_along(self, normal: Floats) -> Floats:
        return np.concatenate([frame_across(normal, self.places)[0], normal[None]])

    def around(self, nodes: Integers) -> Meshed:
        """Flat, with axes, where all cells that meet at the nodes are in parallel planes."""
        touching = np.isin(self.cells.corners, nodes - self.first).any(axis=1)
        normals = self.cells.normals[touching]
        if self.own_axes is not None or np.abs(normals - normals[0]).max() > FLAT:
            return self
        return FlatMesh(self.part, self.first, self.cells, self.thickness, self._axes_along(normals[0]))

    @property
    def depth(self) -> float:
        return float(self.thickness.max()) / 2.0

    @property
    def across(self) -> Floats:
        """Half its thickness along its normal, of a flat one."""
        axes = self.own_axes
        return np.zeros(3) if axes is None else axes[2] * self.depth

    @property
    def drilling(self) -> Floats | None:
        axes = self.own_axes
        return None if axes is None else axes[2]

    def turning(self, nodes: Integers, reach: float, n_nodes: int) -> csr_array:
        """As of a plate: the rigid turn of the ends of a cross around each node, as far as they lie on it."""
        return self.turning_at(self.places[nodes - self.first], reach, n_nodes)

    def turning_at(self, places: Floats, reach: float, n_nodes: int) -> csr_array:
        axes = self.own_axes
        if axes is None:
            return super().turning_at(places, reach, n_nodes)
        corners, rows = cross_turning(self.cells, places, reach, axes)
        return sparse_rows(self.first + corners, rows, n_nodes)

    def dofs(self) -> OwnDofs:
        return nodal_dofs(len(self.places), 6)

    def stiffness_and_mass(self) -> tuple[csr_array, csr_array]:
        return with_where(f"parts.{self.name}", lambda: cell_matrices(self.cells, self.sections, self.part.shift))

    def shares(self) -> list[LossShare]:
        made, which = self._made()
        if not made[0].shares:
            return []
        each = cell_shares(self.cells, made, which, self.part.x_direction)
        matrices = share_matrices(self.cells, self.sections, each, self.part.shift)
        return [LossShare(one.name, one.loss_factor, K) for one, K in zip(made[0].shares, matrices, strict=True)]

    @property
    def facets(self) -> FlatCells:
        return self.cells

    def facet_motion(self, which: Integers, xi: Floats, eta: Floats) -> tuple[Integers, Floats]:
        nodes, rows = rows_at(self.cells, which, xi, eta)
        return self.first + nodes, rows

    @property
    def edges_of_cells(self) -> Integers:
        sides = np.stack([self.quads, np.roll(self.quads, -1, axis=1)], axis=2).reshape(-1, 2)
        return np.unique(np.sort(sides[sides[:, 0] != sides[:, 1]], axis=1), axis=0)

    def facet_reach(self, facet: int, tolerance: float) -> float:
        """Half its thickness, on whose face a place is."""
        return float(self.thickness[facet]) / 2.0 + abs(self.part.shift) + tolerance

    def facet_normal(self, facet: int, side: Side) -> Floats:
        return outwards(self.cells.normals[facet], side)

    def facets_within(self, region: Region, tolerance: float) -> Integers:
        return self.cells.cells_within(self.part.mesh, region, tolerance)

    def mean_of(self, name: str, nodes: Integers, side: Side) -> Point:
        rows = np.zeros((len(nodes), 6, 1, N_COMPONENTS))
        rows[:, :, 0, :6] = np.eye(6)
        own = nodes - self.first
        spots = flat_rows(nodes[:, None], rows, np.full(len(nodes), 1.0 / len(nodes)))
        return Point(name, self.places[own].mean(axis=0), *spots, normal=mean_normal(self.cells, own, side))

    def surface(self, item: SurfaceOn, n_nodes: int, tolerance: float) -> Surface:
        chosen = self.chosen(f"surfaces.{item.name}.region", item.region, tolerance)
        lies = self.thickness / 2.0, self.part.shift
        return side_surface(item, self.name, self.cells, chosen, self.facet_motion, n_nodes, lies)

    def edge_points(self, item: Support, tolerance: float) -> EdgePoints:
        """Of its free edges between nodes of the named set or in the box."""
        which, xi, eta, weights, along = edge_gauss(self.cells, *self._free_edges(item, tolerance))
        return EdgePoints(*self.facet_motion(which, xi, eta), weights, self.cells.normals[which], along)

    def _free_edges(self, item: Support, tolerance: float) -> tuple[Integers, Integers]:
        if item.region is None:
            got = f"an edge or line of '{self.name}', a part that is a mesh"
            raise InputError(f"supports.{item.name}", got=got, expected="a set or a box of it")
        where = f"supports.{item.name}.{item.region.kind}"
        cells, corner = self.cells.free_edges(self.within(where, item.region, tolerance) - self.first)
        if not len(cells):
            raise InputError(where, got=f"a {item.region} without a free edge of {self.name}", expected="an edge of it")
        return cells, corner

    def hard_edges(self, item: Support, tolerance: float) -> tuple[Integers, Floats]:
        """Where edges of a node bend by less than `BENT`, as of a polygon for a curve, it has their mean direction:
        held about both it would be clamped. At a corner it is."""
        cells, corner = self._free_edges(item, tolerance)
        nodes = self.cells.corners[cells]
        count = np.where(cells < len(self.cells.quads), 4, 3)
        ends = np.stack([nodes[np.arange(len(cells)), at] for at in (corner, (corner + 1) % count)], axis=1)
        along = self.cells.points[ends[:, 1]] - self.cells.points[ends[:, 0]]
        across = np.cross(along, self.cells.normals[cells])
        across /= np.linalg.norm(across, axis=1)[:, None]
        node, about = ends.ravel(), np.repeat(across, 2, axis=0)
        order = np.argsort(node, kind="stable")
        node, about = node[order], about[order]
        double = np.flatnonzero(node[1:] == node[:-1])  # a free edge of cells has two edges at a node inside of it
        cosine = (about[double] * about[double + 1]).sum(axis=1)
        straight = double[np.abs(cosine) > BENT]
        about[straight] += np.sign(cosine[np.abs(cosine) > BENT])[:, None] * about[straight + 1]
        about[straight] /= np.linalg.norm(about[straight], axis=1)[:, None]
        kept = np.ones(len(node), dtype=bool)
        kept[straight + 1] = False
        components = np.zeros((int(kept.sum()), N_COMPONENTS))
        components[:, 3:6] = about[kept]
        return self.first + node[kept], components

    def stresses(self, n_nodes: int) -> StressPlaces:
        """As `stresses_on_faces`. Raises InputError for smeared ribs, whose stresses are unknown."""
        return stresses_on_faces(self.part, self.cells, self.thickness, self.sections, (self.first, n_nodes))


@stored_as("flat mesh/1")
@dataclass(frozen=True, eq=False)
class FlatMesh(ShellMesh):
    """A shell that is flat, at least where something is joined to it. axes [3, 3] : rows are its x, y and normal."""

    axes: Floats

    @property
    def own_axes(self) -> Floats:
        return self.axes


# ----------------------------------------------------------------------------------------------------------------------
# Shells.
# ----------------------------------------------------------------------------------------------------------------------


@stored_as("shell/1")
@dataclass(frozen=True)
@checked("parts")
class Shell(MeshPart):
    """A shell on the triangles and quadrilaterals of a mesh, or of a set of it.

    mesh : as `read_mesh_file` gives it. named : the set; None for all of them. thickness : of all, or by names of sets
    of cells [m]; None for that of a lay-up, or for what the file states. offset : from the mesh to the middle of the
    thickness, along the normal of each cell [m]; None is 0 where the file states none. orientation : direction of the
    x of an orthotropic material or a lay-up, laid into each cell. nonstructural : mass per area on it that does not
    stiffen it, NSM [kg/m^2]; None is what the file states, if its unit of mass is known: kg beside metres, t beside mm.

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
    offset: float | None = None
    orientation: Vector | None = None
    nonstructural: float | None = None
    dimension: ClassVar[int] = 2
    units: ClassVar[Mapping[str, str]] = {"thickness": "m", "offset": "m", "nonstructural": "kg/m^2"}

    def __post_init__(self) -> None:
        """Raises InputError for a set that is not there or has no such cells, and for directions that are missing."""
        super().__post_init__()
        if self.nonstructural is not None and not self.nonstructural >= 0.0:
            where, got = f"parts.{self.name}.nonstructural", f"{self.nonstructural:g} kg/m^2"
            raise InputError(where, got=got, expected="a mass per area, or 0")
        if isinstance(self.material, Material):
            return
        if self.orientation is None or not np.linalg.norm(self.orientation) > 0:
            raise InputError(
                f"parts.{self.name}.orientation",
                got="none" if self.orientation is None else f"{self.orientation}",
                expected="'orientation', the direction of the material's x",
                do="write orientation: [1, 0, 0]",
            )

    @property
    def shift(self) -> float:
        """From the mesh to the middle of the thickness [m]."""
        return self.offset or 0.0

    def stands_for(self) -> frozenset[Makes]:
        """Offset, thickness and mass on it too, where they are written: `offset: 0 mm` says that there is none."""
        written = {Makes.OFFSET: self.offset, Makes.THICKNESS: self.thickness, Makes.SPREAD: self.nonstructural}
        return super().stands_for() | {makes for makes, value in written.items() if value is not None}

    def takes(self) -> frozenset[Makes]:
        taken = self.nonstructural is None and self.mesh.unit_of_mass > 0.0
        return frozenset({Makes.SPREAD}) if taken else frozenset()

    def written_thickness(self) -> tuple[float, ...]:
        if isinstance(self.material, LayUp):
            return (self.material.thickness,)
        return (
            tuple(self.thickness.values())
            if isinstance(self.thickness, Mapping)
            else ()
            if self.thickness is None
            else (self.thickness,)
        )

    @property
    def x_direction(self) -> Floats | None:
        """Direction [3] of the material's x; None where it has none."""
        return None if self.orientation is None else np.asarray(self.orientation, dtype=np.float64)

    def meshed(self, layout: Layout, grids: Grids, first: int) -> ShellMesh:
        cells = flat_cells(self.mesh, self.named)
        refuse_degenerate(f"parts.{self.name}.mesh", self.mesh, cells)
        return ShellMesh(self, first, cells, cell_thickness(self, cells))

    def implausible(self, lies: bool) -> tuple[Finding, ...]:
        cells = flat_cells(self.mesh, self.named)
        thickness = cell_thickness(self, cells)
        mass = ShellMesh(self, 0, cells, thickness).mass
        stated = self.thickness is None and not isinstance(self.material, LayUp)
        unit = shell_slips(self.name, self.mesh, cells, thickness, mass, stated)
        return shell_doubts(self.name, self.mesh, self.named, cells, unit)
