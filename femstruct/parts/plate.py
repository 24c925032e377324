"""Plates: flat, rectangular, bending by Kirchhoff's theory, and stretching in their own plane or rigid there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import isclose
from typing import Literal, get_args

import numpy as np
from scipy.sparse import csr_array

from femstruct.arrays import Floats, Integers, freeze, frozen
from femstruct.conventions import N_COMPONENTS, TWIST
from femstruct.declared import checked
from femstruct.elements import membrane, plate
from femstruct.elements.polynomials import gauss_interval
from femstruct.errors import Finding, InputError
from femstruct.model.imported_mesh import towards
from femstruct.model.lay_ups import LayUp, PlateSection, materials_of, section_of, stresses_of_resultants
from femstruct.model.layout import Grids, Layout, cell_sides
from femstruct.model.materials import AnyMaterial, Given, Loss, Material, given_fields
from femstruct.model.model import Model
from femstruct.model.part import Drawn, EdgePoints, FilledBox, LossShare, Meshed, OwnDofs, Part, RegionSpread
from femstruct.model.probe import Point, StressPlaces, Surface
from femstruct.model.regions import (
    Facing,
    Pair,
    Region,
    Side,
    Vector,
    area_points,
    carry_along_arms,
    distance_to_rectangle,
    divide_grid,
    flat_rows,
    from_rectangle,
    grid_points,
    interval_of,
    line_points,
    mean_of_cells,
    rectangle_axes,
    region_box,
    region_lines,
    snap_to_grid,
    sparse_rows,
    to_rectangle,
)
from femstruct.model.scatter import interleave, scatter, with_diagonal
from femstruct.model.structure import SIMPLE, PlaceOn, Support, SurfaceOn
from femstruct.parts.plausibility import refuse_thicker, thickness_findings
from femstruct.tags import stored_as

# ----------------------------------------------------------------------------------------------------------------------
# Patches of a plate: a point that stands for the mean over a small disc or rectangle around it.
# ----------------------------------------------------------------------------------------------------------------------

ORDER = 3  # Gauss points across each piece of a cell: its deflection is cubic
ORDER_ROUND = 12  # along the arc, where the length of a chord is a cosine


def patch_points(
    where: str,
    name: str,
    size: Pair,
    grid: tuple[Floats, Floats],
    center: Floats,
    patch: float | Pair,
    tolerance: float,
) -> tuple[Floats, Floats]:
    """Places [p, 2] and shares [p] whose mean motion is that of a patch, in a plate's coordinates [m].

    By virtual work a force on this mean is spread evenly over the patch: it keeps the force and its moment about any
    point. Rotations are means as well.

    Parameters
    ----------
    name, size, grid : str, Pair, tuple[Floats, Floats]
        Of the plate, its grid lines along x and y. center [2].
    patch : float | Pair
        Radius of a disc, or the sides of a rectangle [m].

    Raises
    ------
    InputError
        For a patch that reaches beyond its plate.
    """
    reach = np.array([patch, patch] if isinstance(patch, float) else patch) * (1.0 if isinstance(patch, float) else 0.5)
    beyond = float(max((reach - center).max(), (center + reach - size).max()))
    if beyond > tolerance:
        raise InputError(
            f"{where}.patch",
            got=f"a patch that reaches {beyond:.4g} m beyond {name}",
            expected=f"a patch inside {size[0]:g} m x {size[1]:g} m",
            do="make it smaller, or move the point",
        )
    return _disc(*grid, center, patch) if isinstance(patch, float) else _rectangle(*grid, center, reach)


def patch_turning(
    where: str,
    centers: Floats,
    reach: float,
    size: Pair,
    axes: Floats,
    motion: Callable[[Floats], tuple[Integers, Floats]],
    n_nodes: int,
) -> csr_array:
    """Rows [m, n_nodes * 7] of the rotation about the normal of crosses that reach so far [m] around places of a
    plate.

    Parameters
    ----------
    centers : Floats [m, 2]
        In its coordinates [m].
    size, axes : Pair, Floats
        Of the plate.
    motion : Callable[[Floats], tuple[Integers, Floats]]
        Nodes [p, k] and rows [p, 6, k, 7] of places of it. The ends of a cross, as far as they lie on the plate, and
        its middle move as the plate does; the rotation is that of the rigid motion that fits them best. By virtual work
        a torque on it is forces at the ends.

    Raises
    ------
    InputError
        Of `where`, for a cross of which no end lies on the plate.
    """
    arms = reach * np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    places = (centers[:, None] + arms).reshape(-1, 2)
    inside = ((places >= 0.0) & (places <= size)).all(axis=1)
    owner = np.repeat(np.arange(len(centers)), len(arms))[inside]
    places = places[inside]
    count = np.bincount(owner, minlength=len(centers))[:, None]
    middle = np.zeros((len(centers), 2))
    np.add.at(middle, owner, places)
    off = places - (middle / count)[owner]
    square = np.bincount(owner, weights=(off**2).sum(axis=1), minlength=len(centers))
    if not square.all():
        got = (
            f"a joint with a bar whose section reaches {reach:.3g} m, beyond {size[0]:g} m x {size[1]:g} m on all sides"
        )
        raise InputError(where, got=got, expected="a section that lies on it", do="correct the section of the bar")
    pulls = (off[:, :1] * axes[1] - off[:, 1:] * axes[0]) / square[owner, None]
    nodes, rows = motion(places)
    each = sparse_rows(nodes, np.einsum("pi,pikc->pkc", pulls, rows[:, :3])[:, None], n_nodes)
    gathered = csr_array((np.ones(len(owner)), (owner, np.arange(len(owner)))), shape=(len(centers), len(owner)))
    return csr_array(gathered @ each)


def _rectangle(x: Floats, y: Floats, center: Floats, reach: Floats) -> tuple[Floats, Floats]:
    """Gauss points [p, 2] and shares [p] of a rectangle, piece by piece of the cells it covers."""
    across, along = (
        _pieces(lines, at - half, at + half, ORDER) for lines, at, half in zip((x, y), center, reach, strict=True)
    )
    places = np.stack(np.meshgrid(across[0], along[0], indexing="ij"), axis=-1).reshape(-1, 2)
    shares = np.outer(across[1], along[1]).ravel()
    return places, shares / shares.sum()


def _disc(x: Floats, y: Floats, center: Floats, radius: float) -> tuple[Floats, Floats]:
    """Gauss points [p, 2] and shares [p] of a disc: chords at x = r sin(angle), cut where grid lines cross the rim."""
    columns = (x - center[0]) / radius
    rows = (y - center[1]) / radius
    crossings = np.arccos(np.abs(rows[np.abs(rows) < 1.0]))
    cuts = np.concatenate((np.arcsin(columns[np.abs(columns) < 1.0]), crossings, -crossings))
    angles, widths = _pieces(cuts, -0.5 * np.pi, 0.5 * np.pi, ORDER_ROUND)
    places, shares = [], []
    for angle, width in zip(angles, widths, strict=True):
        half = radius * np.cos(angle)
        along, lengths = _pieces(y, center[1] - half, center[1] + half, ORDER)
        places.append(np.stack([np.full_like(along, center[0] + radius * np.sin(angle)), along], axis=1))
        shares.append(width * half * lengths)  # dx = r cos(angle) d(angle)
    weights = np.concatenate(shares)
    return np.concatenate(places), weights / weights.sum()


def _pieces(lines: Floats, low: float, high: float, order: int) -> tuple[Floats, Floats]:
    """Gauss points and weights on low to high, in pieces between the lines."""
    ends = np.concatenate(([low], np.sort(lines[(lines > low) & (lines < high)]), [high]))
    steps = np.diff(ends)
    points, weights = gauss_interval(order)
    return (ends[:-1, None] + steps[:, None] * points).ravel(), (steps[:, None] * weights).ravel()


# ----------------------------------------------------------------------------------------------------------------------
# Edges of plates: the nodes that a support of one names, and what it holds of them.
# ----------------------------------------------------------------------------------------------------------------------

STEEP = float(np.cos(np.radians(45.0)))  # of the normal to the vertical: from there on a plate stands
EDGE_ORDER = 4  # Gauss points a side of a cell
Axis = Literal[0, 1]


def edge_nodes(
    item: Support, plate: str, size: Pair, lines: tuple[Floats, Floats], grid: Integers, tolerance: float
) -> list[tuple[Integers, Axis]]:
    """Nodes of each edge or line that a support names, in their order, and which of the plate's axes it is along.

    Parameters
    ----------
    plate : str
        Name of the plate.
    size : Pair
        Its sides [m].
    lines : tuple[Floats, Floats]
        Its grid along x and y [m].
    grid : Integers [nx + 1, ny + 1]
        Numbers of its nodes.

    Raises
    ------
    InputError
        For a line that is not on the plate.
    """
    if item.line is not None:
        region = Region("line", line=item.line)
        x0, x1, y0, y1 = region_box(f"supports.{item.name}.line", plate, size, region, tolerance)
        in_x = np.flatnonzero((lines[0] >= x0 - tolerance) & (lines[0] <= x1 + tolerance))
        in_y = np.flatnonzero((lines[1] >= y0 - tolerance) & (lines[1] <= y1 + tolerance))
        return [(grid[np.ix_(in_x, in_y)].ravel(), 0 if len(in_x) > 1 else 1)]
    sides: dict[str, tuple[Integers, Axis]] = {
        "x0": (grid[0], 1),
        "x1": (grid[-1], 1),
        "y0": (grid[:, 0], 0),
        "y1": (grid[:, -1], 0),
    }
    return list(sides.values()) if item.edge == "all" else [sides[str(item.edge)]]


def edge_gauss(
    item: Support, plate: str, size: Pair, lines: tuple[Floats, Floats], tolerance: float
) -> tuple[Floats, Floats, Integers]:
    """Gauss points along the edges or the line that a support names: places [p, 2] [m], weights [p] [m], and which of
    the plate's axes each of them is along [p]. Exact for products of two cubic deflections."""
    x, y = size
    sides = {
        "x0": ((0.0, 0.0), (0.0, y)),
        "x1": ((x, 0.0), (x, y)),
        "y0": ((0.0, 0.0), (x, 0.0)),
        "y1": ((0.0, y), (x, y)),
    }
    if item.line is not None:
        region = Region("line", line=item.line)
        ends = region_lines(region, region_box(f"supports.{item.name}.line", plate, size, region, tolerance))
    else:
        ends = list(sides.values()) if item.edge == "all" else [sides[str(item.edge)]]
    found = [line_points(*lines, one, tolerance, EDGE_ORDER) for one in ends]
    axis = [0 if abs(b[0] - a[0]) > abs(b[1] - a[1]) else 1 for a, b in ends]
    places, weights = (np.concatenate(part) for part in zip(*found, strict=True))
    return places, weights, np.repeat(axis, [len(one[1]) for one in found])


def edge_components(fix: object, axes: Floats, along: Axis, rigid_in_plane: bool) -> Floats:
    """Components [m, 7] that simple (hard, as thin plates are), roller or clamped holds of the nodes of an edge along
    an axis of a plate.

    All but `clamped` hold the deflection and the slope along the edge: w_x = -RY where it is parallel to x, w_y = RX
    where to y. `simple` carries, in addition, a plate that stands; one that is rigid in its plane it holds.

    Parameters
    ----------
    axes : Floats [3, 3]
        Rows are the plate's x, y and normal.
    """
    clamped = np.zeros((7, N_COMPONENTS))
    clamped[:3, :3] = clamped[3:6, 3:6] = axes
    clamped[6, TWIST] = 1.0
    if fix == "clamped":
        return clamped
    in_plane = clamped[:0]
    if fix in SIMPLE:
        in_plane = clamped[:2] if rigid_in_plane else _carried(axes)
    return np.concatenate([in_plane, clamped[[2, 4 if along == 0 else 3]]])


def _carried(axes: Floats) -> Floats:
    """The direction in its plane nearest to the vertical, of a plate that stands, as components [1, 7]; none of one
    that lies."""
    up = np.eye(3)[2] - axes[2, 2] * axes[2]
    rows = np.zeros((int(abs(axes[2, 2]) < STEEP - 1e-12), N_COMPONENTS))
    rows[:, :3] = up / (np.linalg.norm(up) or 1.0)
    return rows


# ----------------------------------------------------------------------------------------------------------------------
# How a plate moves: its degrees of freedom, and the motion between its nodes.
#
# It bends. In its plane it either is rigid, with three degrees of freedom for all its nodes together, or stretches,
# with three at every node: the shifts along its axes and the rotation about its normal, the drilling rotation.
# ----------------------------------------------------------------------------------------------------------------------

OUT_OF_PLANE = ("deflection", "rotation about x", "rotation about y", "twist")
MEMBRANE = ("shift along x", "shift along y", "rotation about the normal")
STRETCHING = len(MEMBRANE)  # degrees of freedom of a node
IN_PLANE = tuple(f"{what}, in its plane" for what in MEMBRANE)
_U, _V, _TURN = 0, 1, 5


def plate_dofs(kind: plate.PlateElement, axes: Floats, local: Floats, size: Pair) -> OwnDofs:
    """w, the two rotations about its own axes and, for bfs16, the twist of every node; in its plane it is rigid:
    u, v and the rotation about the normal of its centroid belong to the whole plate.

    Parameters
    ----------
    axes : Floats [3, 3]
        Rows are its x, y and normal.
    local : Floats [n, 2]
        Its nodes in its own coordinates [m].
    """
    labels = OUT_OF_PLANE[: plate.dofs_per_node(kind)]
    count, per_node = len(local), len(labels)
    base = np.arange(count) * N_COMPONENTS
    numbers = np.arange(count * per_node).reshape(count, per_node)
    u, v, turn = count * per_node + np.arange(3)
    x, y = (local - np.asarray(size) / 2.0).T
    move = base[:, None] + np.arange(3)
    rows: list[Integers] = []
    columns: list[Integers] = []
    values: list[Floats] = []

    def add(row: Integers, column: Integers | np.int64, value: Floats) -> None:
        shape = np.broadcast_shapes(row.shape, np.shape(column), value.shape)
        rows.append(np.broadcast_to(row, shape).ravel())
        columns.append(np.broadcast_to(column, shape).ravel())
        values.append(np.broadcast_to(value, shape).ravel())

    add(move, numbers[:, :1], axes[2])
    add(move, u, axes[0])
    add(move, v, axes[1])
    add(move, turn, np.outer(x, axes[1]) - np.outer(y, axes[0]))
    add(move + 3, numbers[:, 1:2], axes[0])
    add(move + 3, numbers[:, 2:3], axes[1])
    add(move + 3, turn, axes[2])
    if per_node > 3:
        add(base + TWIST, numbers[:, 3], np.ones(count))
    translations = np.zeros((count * per_node + 3, 3))
    translations[numbers[:, 0]] = axes[2]
    translations[[u, v]] = axes[:2]
    at = np.concatenate(rows), np.concatenate(columns)
    return OwnDofs(labels, IN_PLANE, *at, np.concatenate(values), translations)


def stretching_dofs(kind: plate.PlateElement, axes: Floats, count: int) -> OwnDofs:
    """Those of bending and, after them, three of every node in the plane.

    Parameters
    ----------
    count : int
        Of nodes, axes as `plate_dofs`.
    """
    labels = (*OUT_OF_PLANE[: plate.dofs_per_node(kind)], *MEMBRANE)
    bending, per_node = len(labels) - len(MEMBRANE), len(labels)
    motion = np.zeros((N_COMPONENTS, per_node))
    motion[:3, 0] = motion[3:6, per_node - 1] = axes[2]
    motion[:3, bending : bending + 2] = motion[3:6, 1:3] = axes[:2].T
    if bending > 3:
        motion[TWIST, 3] = 1.0
    component, dof = np.nonzero(motion)
    node = np.arange(count)[:, None]
    rows, columns = node * N_COMPONENTS + component, node * per_node + dof
    values = np.tile(motion[component, dof], count)
    return OwnDofs(labels, (), rows.ravel(), columns.ravel(), values, np.tile(motion[:3].T, (count, 1)))


def plate_rows(
    kind: plate.PlateElement,
    axes: Floats,
    lines: tuple[Floats, Floats],
    grid: Integers,
    local: Floats,
    stretches: bool,
) -> tuple[Integers, Floats]:
    """Motion of places of a plate from the components of the corner nodes of their cells.

    Parameters
    ----------
    axes : Floats [3, 3]
        Rows are its x, y and normal.
    lines : tuple[Floats, Floats]
        Of its grid, along x and y [m].
    grid : Integers [nx + 1, ny + 1]
        Numbers of its nodes.
    local : Floats [p, 2]
        In the plate's coordinates [m], inside it.
    stretches : bool
        Whether it does in its plane.

    Returns
    -------
    tuple[Integers, Floats]
        Nodes [p, 4] and rows [p, 6, 4, 7]: three displacements and three rotations, global axes. The deflection follows
        the element's shape functions, motion in the plane those of the membrane; bilinear, which is exact, where the
        plate is rigid there.
    """
    column, xi, a = interval_of(lines[0], local[:, 0])
    row, eta, b = interval_of(lines[1], local[:, 1])
    shapes = plate.interpolate(kind, a, b, xi, eta).reshape(len(local), 4, 4, plate.dofs_per_node(kind))
    own = np.zeros((len(local), 6, 4, N_COMPONENTS))
    if stretches:
        flat = membrane.interpolate(membrane.rectangle(a, b), xi, eta).reshape(len(local), 3, 4, 3)
        own[np.ix_(range(len(local)), (_U, _V, _TURN), range(4), (_U, _V, _TURN))] = flat
    else:
        linear = np.stack([(1 - xi) * (1 - eta), (1 - xi) * eta, xi * eta, xi * (1 - eta)], axis=1)
        for component in (_U, _V, _TURN):
            own[:, component, :, component] = linear
    own[:, 2:5, :, 2:5] = shapes[:, :3, :, :3]
    if plate.dofs_per_node(kind) > 3:
        own[:, 2:5, :, TWIST] = shapes[:, :3, :, 3]
    rows = np.empty_like(own)
    rows[..., :3], rows[..., 3:6], rows[..., TWIST] = (
        own[..., :3] @ axes,
        own[..., 3:6] @ axes,
        own[..., 6],
    )
    turned = np.einsum("ji,pgjnc->pginc", axes, rows.reshape(len(local), 2, 3, 4, N_COMPONENTS))
    corners = np.stack(
        [
            grid[column, row],
            grid[column, row + 1],
            grid[column + 1, row + 1],
            grid[column + 1, row],
        ],
        axis=1,
    )
    return corners, turned.reshape(rows.shape)


# ----------------------------------------------------------------------------------------------------------------------
# Stresses of a plate at its faces and those of its layers, node by node.
# ----------------------------------------------------------------------------------------------------------------------

SQRT3 = float(np.sqrt(3.0))


def face_rows(
    kind: plate.PlateElement,
    axes: Floats,
    sizes: tuple[Floats, Floats],
    quads: Integers,
    rigidities: tuple[Floats, Floats | None],
    of_resultants: Floats,
    n_nodes: int,
) -> csr_array:
    """Rows [q * 4 * s * 3, n_nodes * 7] of the stresses xx yy xy [Pa] at the corners of cells, at each on s faces,
    from the components of all nodes of a structure.

    Parameters
    ----------
    axes : Floats [3, 3]
        Rows are the plate's x, y and normal.
    sizes : tuple[Floats, Floats] [q]
        Sides of the cells along x and y [m].
    quads : Integers [q, 4]
        Their corners.
    rigidities : tuple[Floats, Floats | None]
        D [3, 3] of bending [N m], and A [3, 3] in the plane [N/m], None where the plate is rigid there.
    of_resultants : Floats [s, 3, 6]
        Stresses of membrane forces and moments per length [1/m, 1/m^2].
    """
    D, A = rigidities
    xi, eta = np.tile(np.array(plate.CORNERS, dtype=np.float64), (len(quads), 1)).T
    a, b = (np.repeat(size, 4) for size in sizes)
    moments = plate.moments(kind, a, b, xi, eta, D).reshape(len(xi), 3, 4, -1)
    rows = np.zeros((len(xi), 6, 4, N_COMPONENTS))
    rows[:, 3:, :, :3] = moments[..., :1] * axes[2]
    rows[:, 3:, :, 3:6] = moments[..., 1:2] * axes[0] + moments[..., 2:3] * axes[1]
    rows[:, 3:, :, TWIST] = moments[..., 3] if moments.shape[-1] > 3 else 0.0
    if A is not None:
        rows[:, :3] = _membrane_rows(axes, sizes, A).reshape(-1, 3, 4, N_COMPONENTS)
    stresses = np.einsum("fsr,prkc->pfskc", of_resultants, rows)
    return sparse_rows(np.repeat(quads, 4, axis=0), stresses.reshape(len(xi), -1, 4, N_COMPONENTS), n_nodes)


def _membrane_rows(axes: Floats, sizes: tuple[Floats, Floats], A: Floats) -> Floats:
    """Rows [q, 4, 3, 4, 7] of the membrane forces [N/m] at the corners of cells, from the components of their corners:
    continued bilinearly from the 2 x 2 Gauss points, where they are one order better than at the corners."""
    a, b = sizes
    unit = np.array(plate.CORNERS, dtype=np.float64)
    xi, eta = np.tile(0.5 + (unit - 0.5) / SQRT3, (len(a), 1)).T
    corners = np.repeat(membrane.rectangle(a, b), 4, axis=0)
    forces = membrane.resultants(corners, xi, eta, A).reshape(len(a), 4, 3, 4, 3)
    x, y = (0.5 + (unit - 0.5) * SQRT3).T  # of the corners, in the square of the Gauss points
    shares = np.stack([(x if i else 1.0 - x) * (y if j else 1.0 - y) for i, j in plate.CORNERS], axis=1)
    forces = np.einsum("cg,qgrnk->qcrnk", shares, forces)
    rows = np.zeros((*forces.shape[:4], N_COMPONENTS))
    rows[..., :3] = forces[..., :1] * axes[0] + forces[..., 1:2] * axes[1]
    rows[..., 3:6] = forces[..., 2:] * axes[2]
    return rows


# ----------------------------------------------------------------------------------------------------------------------
# Plates on their grids: what they have at their nodes, their matrices, and what points and surfaces read of them.
# ----------------------------------------------------------------------------------------------------------------------

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
            K, M = (interleave(both, (bending, STRETCHING)) for both in zip(of_bending, of_membrane, strict=True))
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
                K = interleave((K, of_membrane), (plate.dofs_per_node(part.element), STRETCHING))
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
        return scatter(*matrices, numbers, len(self.local) * per_node, which)

    def rows(self, local: Floats) -> tuple[Integers, Floats]:
        """Nodes [p, 4] and rows [p, 6, 4, 7] of the motion of its places [p, 2] [m], as `plate_rows`."""
        lines = (self.x, self.y)
        return plate_rows(self.part.element, self.axes, lines, self.grid, local, not self.rigid_in_plane)

    def motion_at(self, places: Floats, tolerance: float) -> tuple[Integers, Floats]:
        """Off its mid-surface, places stand on its normals."""
        local = to_rectangle(self.part, self.axes, places)
        on_lines = [snap_to_grid(local[:, i], lines, tolerance) for i, lines in enumerate((self.x, self.y))]
        nodes, rows = self.rows(np.stack(on_lines, axis=1))
        height = float(local[:, 2].mean())
        return nodes, carry_along_arms(rows, height * self.axes[2]) if abs(height) > tolerance else rows

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

    def spread(self, where: str, region: Region, tolerance: float, order: int) -> RegionSpread:
        box = region_box(where, self.name, self.part.size, region, tolerance)
        local, weights = grid_points(self.x, self.y, region, box, tolerance, order)
        per: Literal["length", "area"] = "area" if region.kind in ("whole", "rectangle") else "length"
        return RegionSpread(*self.rows(local), weights, per, region.kind)

    def lines_across(self, along: Floats, origin: Floats) -> Floats:
        cosines = self.axes[:2] @ along
        own = int(np.argmax(np.abs(cosines)))
        start = float((np.asarray(self.part.origin) - origin) @ along)
        lines: Floats = start + np.sign(cosines[own]) * (self.x, self.y)[own]
        return lines

    def drawn(self, divisions: int, along: int, n_nodes: int) -> Drawn:
        x, y = (divide_grid(lines, divisions) for lines in (self.x, self.y))
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


# ----------------------------------------------------------------------------------------------------------------------
# Plates.
# ----------------------------------------------------------------------------------------------------------------------

InPlane = Literal["elastic", "rigid"]


@stored_as("plate/1")
@dataclass(frozen=True)
@checked("parts", mesh="an element side in m, or a tuple of 2 divisions (nx, ny)")
class Plate(Part):
    """A flat rectangular plate; `origin` is a corner of its mid-surface, `size` runs along x_direction and normal x it.

    material : one material, or a lay-up, whose thickness `thickness` then is. Its x is along the plate's, its layers
    are counted along the normal.
    mesh : largest element side [m], or the least number of divisions (nx, ny).
    in_plane : elastic, it stretches and shears in its plane, with a drilling rotation at every node; rigid, it does
    not, and ribs and folds are too stiff. Where nothing is said, it is elastic if anything is joined to it that could
    stretch it: whatever does not lie in its plane. hermite12, the element of the source, is always rigid there.

    >>> steel = Material("steel", E=210e9, nu=0.3, rho=7850.0)
    >>> Plate("floor", steel, thickness=5e-3, origin=(0.0, 0.0, 0.0), size=(0.4, 0.3), mesh=0.05).element
    'bfs16'
    """

    name: str
    material: AnyMaterial | LayUp
    thickness: float
    origin: Vector
    size: Pair
    mesh: float | tuple[int, int]
    element: plate.PlateElement = "bfs16"
    normal: Vector = (0.0, 0.0, 1.0)
    x_direction: Vector | None = None
    in_plane: InPlane | None = None

    def __post_init__(self) -> None:
        if isinstance(self.material, LayUp) and not isclose(self.thickness, self.material.thickness, rel_tol=1e-9):
            raise InputError(
                f"parts.{self.name}.thickness",
                got=f"{self.thickness:g} m",
                expected=f"{self.material.thickness:g} m, that of its layers",
            )
        if self.element == "hermite12" and not isinstance(self.material, Material):
            raise InputError(
                f"parts.{self.name}.element",
                got="hermite12 with an orthotropic material or layers",
                expected="bfs16 or acm12",
                do="leave 'element' out",
            )
        self._check_in_plane()
        refuse_thicker(self.name, "plate", self.material, self.thickness, min(self.size))

    def _check_in_plane(self) -> None:
        where = f"parts.{self.name}.in_plane"
        if self.in_plane not in (None, *get_args(InPlane)):
            raise InputError(where, got=f"{self.in_plane!r}", expected=" or ".join(get_args(InPlane)))
        if self.in_plane == "elastic" and self.element == "hermite12":
            raise InputError(
                where,
                got="elastic with the element hermite12, which is that of the source and rigid in its plane",
                expected="rigid",
                do="use the element bfs16",
            )

    def described(self) -> tuple[Given, ...]:
        return given_fields(
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

    def body(self) -> FilledBox:
        axes = rectangle_axes(self)
        corner = np.asarray(self.origin, dtype=np.float64) - self.thickness / 2.0 * axes[2]
        return FilledBox(corner, axes, np.array([*self.size, self.thickness]), across=2)

    @property
    def section(self) -> PlateSection:
        """Rigidities and masses per area about its mid-surface."""
        return section_of(self.material, self.thickness)

    def materials(self) -> tuple[AnyMaterial, ...]:
        return materials_of(self.material)

    def implausible(self, lies: bool) -> tuple[Finding, ...]:
        flat = abs(float(rectangle_axes(self)[2, 2])) > np.sqrt(0.5)
        return thickness_findings(self.name, self.section, self.materials(), min(self.size), flat and not lies)

    def lay_out(self, layout: Layout) -> None:
        layout.add_rectangle(self, cell_sides(f"parts.{self.name}.mesh", self.size, self.mesh))
        layout.bodies[self.name] = self.body()

    def meshed(self, layout: Layout, grids: Grids, first: int) -> PlateMesh:
        stretches = self.in_plane == "elastic" or (
            self.in_plane is None and self.element != "hermite12" and self.name in layout.stretched
        )
        grid = grids[self.name, 0], grids[self.name, 1]
        return PlateMesh(self, first, layout.axes_of[self.name], *grid, stretches)
