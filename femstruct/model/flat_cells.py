"""The triangles and quadrilaterals that a part takes from an imported mesh: flat, linear, and turned one way."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

import numpy as np
import scipy
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import connected_components

from femstruct.arrays import Floats, Integers, freeze, frozen, frozen_integers
from femstruct.conventions import N_COMPONENTS
from femstruct.elements.quality import shapes
from femstruct.errors import Finding, InputError, list_some
from femstruct.model.imported_mesh import KINDS, ImportedMesh
from femstruct.model.regions import Region
from femstruct.tags import stored_as

# Pieces of a quadratic cell, by its nodes; -1 is the middle of a quad8, which has no node there.
_PIECES: Final = {
    "tri3": ((0, 1, 2),),
    "tri6": ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)),
    "quad4": ((0, 1, 2, 3),),
    "quad8": ((0, 4, -1, 7), (4, 1, 5, -1), (-1, 5, 2, 6), (7, -1, 6, 3)),
    "quad9": ((0, 4, 8, 7), (4, 1, 5, 8), (8, 5, 2, 6), (7, 8, 6, 3)),
}
OPPOSITE: Final = float(np.cos(np.radians(160.0)))  # of directions from an edge: cells that go on in one plane
_CENTRE: Final = np.array([-0.25] * 4 + [0.5] * 4)  # shape functions of a quad8 in its middle


@stored_as("flat cells/1")
@dataclass(frozen=True, eq=False)
class FlatCells:
    """Triangles and quadrilaterals of an imported mesh, with the nodes that they have.

    points [n, 3] : nodes [m]. rows [n] : of the points of the mesh, -1 for middles of quad8 cells. quads [q, 4],
    triangles [t, 3] : corner nodes. kinds [q + t], cells [q + t] : the kind of cell, as a place in the list of kinds of
    the mesh, and the row of the cell, that each is (a piece of), quadrilaterals first. turned [q + t] : whether its
    corners run the other way than in the file. patches [q + t] : which cells hang together by edges. two_sided : False
    where a patch has no two sides, as a Moebius strip.
    """

    points: Floats
    rows: Integers
    quads: Integers
    triangles: Integers
    kinds: Integers
    cells: Integers
    turned: Integers
    patches: Integers
    two_sided: bool

    def __post_init__(self) -> None:
        count = len(self.quads) + len(self.triangles)
        freeze(
            self,
            points=frozen("cells points", self.points, (None, 3)),
            rows=frozen_integers("cells rows", self.rows, (len(self.points),)),
            quads=frozen_integers("cells quads", self.quads, (None, 4)),
            triangles=frozen_integers("cells triangles", self.triangles, (None, 3)),
            kinds=frozen_integers("cells kinds", self.kinds, (count,)),
            cells=frozen_integers("cells cells", self.cells, (count,)),
            turned=frozen_integers("cells turned", self.turned, (count,)),
            patches=frozen_integers("cells patches", self.patches, (count,)),
        )

    @property
    def corners(self) -> Integers:
        """Corner nodes of all cells [q + t, 4], quadrilaterals first; triangles have their last one twice."""
        return np.concatenate([self.quads, self.triangles[:, [0, 1, 2, 2]]])

    @property
    def areas(self) -> Floats:
        """Of the cells [q + t] [m^2]; of warped ones, of the flat cell between."""
        return np.asarray(np.linalg.norm(area_vectors(self.points, self.corners), axis=1))

    @property
    def normals(self) -> Floats:
        """Unit normals of the cells [q + t, 3]."""
        vectors = area_vectors(self.points, self.corners)
        return np.asarray(vectors / np.linalg.norm(vectors, axis=1)[:, None])

    @property
    def longest_sides(self) -> Floats:
        """Of the cells [q + t] [m]."""
        p = self.points[self.corners]
        return np.asarray(np.linalg.norm(np.roll(p, -1, axis=1) - p, axis=2).max(axis=1))

    def free_edges(self, nodes: Integers) -> tuple[Integers, Integers]:
        """Edges of one cell alone between nodes of a group: their cells [e], and which corner each runs from [e]."""
        ends, owner, _ = _edges(self.quads, self.triangles)
        corner = np.concatenate([np.tile(np.arange(4), len(self.quads)), np.tile(np.arange(3), len(self.triangles))])
        _, place, times = np.unique(ends, axis=0, return_inverse=True, return_counts=True)
        free = (times[place.ravel()] == 1) & np.isin(ends, nodes).all(axis=1)
        return owner[free], corner[free]

    def in_set(self, mesh: ImportedMesh, name: str) -> np.ndarray:
        """Which cells [q + t] are of a set of cells. Raises InputError for a set without any."""
        in_mesh = mesh.cells_of(name, 2)
        found = np.zeros(len(self.cells), dtype=bool)
        for number, kind in enumerate(mesh.cells):
            if kind in in_mesh:
                own = self.kinds == number
                found[own] = np.isin(self.cells[own], in_mesh[kind])
        return found

    def cells_within(self, mesh: ImportedMesh, region: Region, tolerance: float) -> Integers:
        """Cells of a set, with all corners in a box, or all. Raises InputError as `in_set`."""
        if region.kind == "set":
            return np.flatnonzero(self.in_set(mesh, region.named or ""))
        nodes = self.nodes_within(mesh, region, tolerance)
        return np.flatnonzero(np.isin(self.corners, nodes).all(axis=1))

    def held_together(self) -> Integers:
        """Which cells hang together by nodes: a label for each node [n]."""
        return connected_pieces([self.corners], len(self.points))

    def nodes_within(self, mesh: ImportedMesh, region: Region, tolerance: float) -> Integers:
        """Nodes of a set or in a box; those of a set that are not of these cells are left out."""
        if region.kind == "whole":
            return np.arange(len(self.points))
        if region.box is not None:
            low, high = np.sort(np.array(region.box, dtype=np.float64), axis=0)
            inside = (self.points >= low - tolerance) & (self.points <= high + tolerance)
            return np.flatnonzero(inside.all(axis=1))
        name = region.named or ""
        nodes = mesh.nodes_of(name)
        found = np.isin(self.rows, nodes)
        if name in mesh.cell_sets:  # middles of quad8 cells have no row of their own
            faces = [kind for kind in mesh.cell_sets[name] if KINDS[kind].dimension == 2]
            if faces:
                found[np.unique(self.corners[self.in_set(mesh, name)])] = True
        return np.flatnonzero(found)


def flat_cells(mesh: ImportedMesh, named: str | None) -> FlatCells:
    """The triangles and quadrilaterals of a set of a mesh, or of all of it.

    Quadratic cells are cut into four linear ones, so that their middle nodes keep their places. Normals are made
    consistent: in each patch of cells that hang together by edges of two cells, and over edges
    where others stand on them, cells are turned to agree with the
    greater area of them, and so that a closed patch has its normals outwards.

    Raises InputError for a set that is not there, and for one without such cells.

    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0]])
    >>> mesh = ImportedMesh("a", square, range(5), {"quad4": [[0, 1, 2, 3]], "tri3": [[1, 2, 4]]},
    ...     {"quad4": [1], "tri3": [2]})
    >>> cells = flat_cells(mesh, None)
    >>> cells.triangles.tolist(), cells.turned.tolist()
    ([[1, 4, 2]], [0, 1])
    """
    chosen = mesh.cells_of(named, 2)
    places, kinds, cells = [np.asarray(mesh.points)], [], []
    pieces: dict[int, list[Integers]] = {4: [], 3: []}
    owners: dict[int, list[tuple[Integers, Integers]]] = {4: [], 3: []}
    count = len(mesh.points)
    for number, kind in enumerate(mesh.cells):
        if kind not in chosen:
            continue
        nodes = mesh.cells[kind][chosen[kind]]
        if kind == "quad8":
            places.append(np.einsum("k,mkd->md", _CENTRE, mesh.points[nodes]))
            nodes = np.column_stack([nodes, count + np.arange(len(nodes))])
            count += len(nodes)
        cut = np.array(_PIECES[kind])
        pieces[cut.shape[1]].append(nodes[:, cut].reshape(-1, cut.shape[1]))
        rows = np.repeat(chosen[kind], len(cut))
        owners[cut.shape[1]].append((np.full(len(rows), number), rows))
    quads, triangles = (np.concatenate([np.zeros((0, k), np.int64), *pieces[k]]) for k in (4, 3))
    for some in (*owners[4], *owners[3]):
        kinds.append(some[0])
        cells.append(some[1])
    used, inverse = np.unique(np.concatenate([quads.ravel(), triangles.ravel()]), return_inverse=True)
    points = np.concatenate(places)[used]
    quads = inverse[: quads.size].reshape(quads.shape)
    triangles = inverse[quads.size :].reshape(triangles.shape)
    turned, patches, two_sided = _orientation(points, quads, triangles)
    flip_quads, flip_triangles = turned[: len(quads)], turned[len(quads) :]
    return FlatCells(
        points,
        np.where(used < len(mesh.points), used, -1),
        quads=np.where(flip_quads[:, None], quads[:, [0, 3, 2, 1]], quads),
        triangles=np.where(flip_triangles[:, None], triangles[:, [0, 2, 1]], triangles),
        kinds=np.concatenate(kinds),
        cells=np.concatenate(cells),
        turned=turned,
        patches=patches,
        two_sided=two_sided,
    )


def area_vectors(points: Floats, corners: Integers) -> Floats:
    """Areas of cells [m, 4] along their normals [m, 3] [m^2]; of warped ones, of the flat one between."""
    p = points[corners]
    vectors: Floats = np.cross(p[:, 2] - p[:, 0], p[:, 3] - p[:, 1]) / 2.0
    return vectors


def _edges(quads: Integers, triangles: Integers) -> tuple[Integers, Integers, np.ndarray]:
    """Edges as ascending nodes [e, 2], the cell of each, and whether it runs upwards there."""
    of_quads = np.stack([quads, np.roll(quads, -1, axis=1)], axis=-1).reshape(-1, 2)
    of_triangles = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1).reshape(-1, 2)
    edges = np.concatenate([of_quads, of_triangles])
    owner = np.concatenate([np.repeat(np.arange(len(quads)), 4), len(quads) + np.repeat(np.arange(len(triangles)), 3)])
    return np.sort(edges, axis=1), owner, edges[:, 0] < edges[:, 1]


def _orientation(points: Floats, quads: Integers, triangles: Integers) -> tuple[np.ndarray, Integers, bool]:
    """Which cells to turn [m], the patch of each [m], and whether all patches have two sides.

    Neighbours across an edge of exactly two cells are of one patch. Where more cells meet, two that go on in one plane
    are turned alike, too, as of a floor over a wall, if no patch loses its sides by that.
    """
    edges, owner, upwards = _edges(quads, triangles)
    _, place, times = np.unique(edges, axis=0, return_inverse=True, return_counts=True)
    place = place.ravel()
    inner = np.flatnonzero(times[place] == 2)
    pairs = inner[np.argsort(place[inner], kind="stable")].reshape(-1, 2)
    corners = np.concatenate([quads, triangles[:, [0, 1, 2, 2]]])
    count, vectors, middles = len(corners), area_vectors(points, corners), points[corners].mean(axis=1)
    first, second = _two_sides(pairs, owner, upwards, count)
    patch = np.unique(np.minimum(first, second), return_inverse=True)[1].ravel()
    two_sided = not (first == second).any()
    away = middles[owner] - points[edges].mean(axis=1)
    further = _in_one_plane(np.flatnonzero(times[place] > 2), place, away)
    if len(further):
        wide = _two_sides(np.concatenate([pairs, further]), owner, upwards, count)
        first, second = wide if not (wide[0] == wide[1]).any() else (first, second)
    group = np.unique(np.minimum(first, second), return_inverse=True)[1].ravel()
    as_they_are = first <= second  # of the side of each group whose label is the lower
    sign = np.where(as_they_are, 1.0, -1.0)
    votes = np.bincount(group, sign * np.linalg.norm(vectors, axis=1))
    open_edges = np.bincount(group, np.bincount(owner, times[place] != 2, minlength=count))
    volume = np.bincount(group, sign * np.einsum("mi,mi->m", middles - points.mean(axis=0), vectors))
    votes = np.where(open_edges == 0, volume, votes)
    keep = np.where(votes[group] < 0, ~as_they_are, as_they_are)
    return (~keep).astype(np.int64), patch, two_sided


def _two_sides(pairs: Integers, owner: Integers, upwards: np.ndarray, count: int) -> tuple[Integers, Integers]:
    """Labels [m] of each cell as it is, and turned: every cell stands twice in a graph, and neighbours across pairs of
    edges [p, 2] are linked where they agree, so that what has two sides is two pieces of the graph."""
    one, other = owner[pairs[:, 0]], owner[pairs[:, 1]]
    # cells that agree run through their edge in opposite ways
    against = (upwards[pairs[:, 0]] == upwards[pairs[:, 1]]).astype(np.int64)
    first = np.concatenate([one, one + count])
    second = np.concatenate([other + count * against, other + count * (1 - against)])
    graph = coo_array((np.ones(len(first)), (first, second)), shape=(2 * count, 2 * count))
    label = connected_components(graph, directed=False)[1].astype(np.int64)
    return label[:count], label[count:]


def _in_one_plane(crowded: Integers, place: Integers, away: Floats) -> Integers:
    """Pairs [p, 2] of edges at one place, of those where more than two cells meet, whose cells lie opposite."""
    order = crowded[np.argsort(place[crowded], kind="stable")]
    directions = away[order] / np.linalg.norm(away[order], axis=1)[:, None]
    found = [np.zeros((0, 2), np.int64)]
    for step in range(1, len(order)):
        same = np.flatnonzero(place[order[:-step]] == place[order[step:]])
        if not len(same):
            break
        opposite = np.einsum("pi,pi->p", directions[same], directions[same + step]) < OPPOSITE
        found.append(np.stack([order[same], order[same + step]], axis=1)[opposite])
    return np.concatenate(found)


def connected_pieces(cells: Iterable[Integers], count: int) -> Integers:
    """Which of `count` nodes hang together by cells [m, k], of several kinds: a label for each node.

    >>> connected_pieces([np.array([[0, 1, 2, 2], [3, 4, 5, 6]]), np.array([[6, 7, 8]])], 9).tolist()
    [0, 0, 0, 1, 1, 1, 1, 1, 1]
    """
    pairs = [(np.repeat(one[:, 0], one.shape[1] - 1), one[:, 1:].ravel()) for one in cells]
    first, second = (np.concatenate(side) for side in zip(*pairs, strict=True))
    graph = coo_array((np.ones(len(first)), (first, second)), shape=(count, count))
    found: Integers = connected_components(graph, directed=False)[1].astype(np.int64)
    return found


def nodes_at_one_place(points: Floats, tolerance: float) -> Integers:
    """Pairs of nodes [m, 2] nearer to each other than a tolerance [m]: a mesh does not hang together there."""
    return np.asarray(scipy.spatial.KDTree(points).query_pairs(tolerance, output_type="ndarray"), np.int64)


# ----------------------------------------------------------------------------------------------------------------------
# Rotations of surfaces whose nodes have none: of the rigid motions that fit nodes around places best.
# ----------------------------------------------------------------------------------------------------------------------


def best_turns(places: Floats, counted: Floats) -> Floats:
    """Rows [p, 3, k, 3] of the rotation of the rigid motion that fits k places [p, k, 3] best, from their
    displacements.

    Parameters
    ----------
    counted : Floats [p, k]
        1 for those that count, 0 for others.

    Examples
    --------
    >>> square = np.array([[[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]])
    >>> turned = np.cross([0.1, 0.2, 0.3], square[0])
    >>> np.einsum("rkc,kc->r", best_turns(square, np.ones((1, 4)))[0], turned).round(9)
    array([0.1, 0.2, 0.3])
    """
    middle = np.einsum("pk,pkc->pc", counted, places) / counted.sum(axis=1)[:, None]
    off = (places - middle[:, None]) * counted[:, :, None]
    x, y, z = np.moveaxis(off, 2, 0)
    zero = np.zeros_like(x)
    cross = np.stack([np.stack([zero, -z, y], -1), np.stack([z, zero, -x], -1), np.stack([-y, x, zero], -1)], 1)
    inertia = np.einsum("pkc,pkc->p", off, off)[:, None, None] * np.eye(3) - np.einsum("pki,pkj->pij", off, off)
    found: Floats = np.einsum("pij,pjkc->pikc", np.linalg.pinv(inertia, hermitian=True), cross)
    return found


def around(corners: Integers, nodes: Integers, count: int) -> csr_array:
    """Which of `count` nodes have a facet in common with each of some nodes [m]: themselves and those around them, as
    entries of [m, count], in ascending order; none in the row of a node without a facet.

    Parameters
    ----------
    corners : Integers [f, 4]
        Of the facets; of triangles the last one is there twice.

    Examples
    --------
    >>> around(np.array([[0, 1, 2, 3], [2, 3, 4, 4]]), np.array([4, 0, 5]), 6).indices.tolist()
    [2, 3, 4, 0, 1, 2, 3]
    """
    facet = np.repeat(np.arange(len(corners)), corners.shape[1])
    has = csr_array((np.ones(corners.size), (corners.ravel(), facet)), shape=(count, len(corners)))
    found = csr_array(has[nodes] @ has.T)
    found.sort_indices()
    return found


def turns_around(places: Floats, near: csr_array) -> tuple[Integers, Floats]:
    """Rotations of the rigid motions that fit the nodes around each of some nodes best: nodes [m, k] and rows
    [m, 3, k, 7] of them, zero where there are fewer than k.

    Parameters
    ----------
    places : Floats [n, 3]
        Of all nodes [m].
    near : csr_array
        As `around` gives it, with entries in every row.
    """
    counts = np.diff(near.indptr)
    nodes = np.zeros((len(counts), int(counts.max(initial=0))), np.int64)
    rows = np.zeros((len(counts), 3, nodes.shape[1], N_COMPONENTS))
    for count in np.unique(counts):  # of one count at a time: rows are as if each were fitted alone
        own = np.flatnonzero(counts == count)
        nodes[own, :count] = near.indices[near.indptr[own][:, None] + np.arange(count)]
        rows[own, :, :count, :3] = best_turns(places[nodes[own, :count]], np.ones((len(own), count)))
    return nodes, rows


# ----------------------------------------------------------------------------------------------------------------------
# Slips of the unit of length of a mesh from a file, by its size, mass, thickness and the sides of its cells.
# ----------------------------------------------------------------------------------------------------------------------

# Typical side of a cell over the thickness: sheet metal of 0.5 mm in cells of 50 mm has 100, a wall of 200 mm in cells
# of 20 mm a tenth; a mesh in millimetres that is read as metres has a thousand times as much.
WIDEST, NARROWEST = 200.0, 0.05
LARGEST, SMALLEST = 200.0, 2e-3  # largest side of the box round a part [m]: a large building, a chip
LEAST_SHELL: Final = 0.05  # m: as a structure that is struck; a shell of less is asked for its unit, not its thickness
HEAVIEST: Final = 1e7  # kg of a solid: a block of concrete of 16 m a side, or one of steel of 11 mm read as metres
HEAVIEST_SHELL: Final = 5e3  # kg/m^2, thickness from the file: 2 m of concrete; 0.7 mm of steel read as metres has more
MM: Final = 1e-3


def shell_slips(
    name: str, mesh: ImportedMesh, cells: FlatCells, thickness: Floats, mass: float, stated: bool
) -> tuple[Finding, ...]:
    """A shell that is too large or too heavy, or whose cells do not fit its thickness.

    Parameters
    ----------
    thickness : Floats
        Of each cell [m]. mass [kg].
    stated : bool
        Whether the thickness is from the file, in its unit.
    """
    size, t = _size(cells.points), float(np.median(thickness))
    area = float(cells.areas.sum())
    if size > LARGEST or (stated and mass / area > HEAVIEST_SHELL):
        thick = f" and {t:.4g} m thick" if stated else ""
        to_mm = MM / mesh.scale
        then = f" and {1e3 * t * to_mm:.4g} mm thick" if stated else ""
        return (_too_large(name, mesh, size, mass, mass * to_mm ** (3 if stated else 2), thick, then),)
    side = float(np.median(np.sqrt(cells.areas)))
    ratio = side / t
    if NARROWEST <= ratio <= WIDEST:
        return ()
    meant = _meant_thickness(size, side, t, ratio)
    other = size * (MM if ratio > WIDEST else 1.0) / mesh.scale
    if other != size and LEAST_SHELL <= other <= LARGEST:
        meant.append("'scale: mm' for a file in millimetres" if ratio > WIDEST else "no 'scale' for a file in metres")
    advice = f"Did you mean {', or '.join(meant)}?" if meant else "Check the thickness"
    return (
        Finding(
            "mesh-in-other-units",
            f"{name}: the mesh is {size:.4g} m large. A typical cell has sides of {side:.4g} m, {ratio:.3g} times the "
            f"thickness of {t:.4g} m. {advice}",
            {"size_m": size, "side_m": side, "times_the_thickness": ratio},
        ),
    )


def _meant_thickness(size: float, side: float, t: float, ratio: float) -> list[str]:
    """A thickness in millimetres that fits cells of a mesh of a plausible size."""
    fits = ratio < NARROWEST and NARROWEST <= side / (MM * t) <= WIDEST
    return [f"a thickness of {t:.4g} mm"] if fits and size >= LEAST_SHELL else []


def solid_slips(name: str, mesh: ImportedMesh, points: Floats, mass: float) -> tuple[Finding, ...]:
    """A solid that is too large, too small or too heavy.

    Parameters
    ----------
    points : Floats [n, 3]
        Its nodes [m]. mass [kg].
    """
    size = _size(points)
    if size > LARGEST or mass > HEAVIEST:
        return (_too_large(name, mesh, size, mass, mass * (MM / mesh.scale) ** 3),)
    if size >= SMALLEST:
        return ()
    meant = "Did you mean no 'scale' for a file in metres?" if mesh.scale != 1.0 else "Check its 'scale'"
    return (Finding("mesh-in-other-units", f"{name}: the mesh is {size:.4g} m large. {meant}", {"size_m": size}),)


def in_millimetres(mesh: ImportedMesh, points: Floats) -> str:
    """What to do about a place that is not on a mesh: another unit of length where its size asks for one, else ""."""
    size = _size(points)
    if size <= LARGEST:
        return ""
    do = "write 'scale: mm' for a file in millimetres" if _fits_in_mm(mesh, size) else "check its 'scale'"
    return f"the mesh is {size:.4g} m large; {do}"


def _size(points: Floats) -> float:
    return float(np.ptp(points, axis=0).max())


def _too_large(
    name: str, mesh: ImportedMesh, size: float, mass: float, mass_in_mm: float, thick: str = "", then: str = ""
) -> Finding:
    in_mm = size * MM / mesh.scale
    return Finding(
        "mesh-in-other-units",
        f"{name}: the mesh is {size:.4g} m large{thick} as read, with {mass:.4g} kg; in millimetres it would be "
        f"{in_mm:.4g} m{then}, with {mass_in_mm:.4g} kg. {_advice(mesh, size)}",
        {"size_m": size, "size_if_in_mm_m": in_mm, "mass_kg": mass},
    )


def _advice(mesh: ImportedMesh, size: float) -> str:
    return "Did you mean 'scale: mm'?" if _fits_in_mm(mesh, size) else f"Check its 'scale', which is {mesh.scale:g} m"


def _fits_in_mm(mesh: ImportedMesh, size: float) -> bool:
    return SMALLEST <= size * MM / mesh.scale <= LARGEST and mesh.scale != MM


# ----------------------------------------------------------------------------------------------------------------------
# What is doubtful about a mesh that a shell is made of: slips of units, bad cells, cells twice, open seams.
# ----------------------------------------------------------------------------------------------------------------------

FAULTS: Final = {  # of `femstruct.elements.quality`
    "sharp": "with a sharp corner",
    "blunt": "with a blunt corner",
    "warped": "warped",
    "long": "long and narrow",
}
SEAM: Final = 1e-6  # of the size of the mesh: nodes that near are at one place
SHOWN: Final = 3  # cells that are named


def refuse_degenerate(where: str, mesh: ImportedMesh, cells: FlatCells) -> None:
    """Raise InputError for cells of which no matrices can be made, naming them."""
    bad = _faults(cells).get("impossible")
    if bad is not None:
        raise InputError(
            where,
            got=f"{len(bad)} of {len(cells.cells)} cells without area or with a corner that points inwards: "
            f"{_named(mesh, cells, bad)}",
            expected="convex triangles and quadrilaterals",
            do="mend the mesh there",
        )


def _faults(cells: FlatCells) -> dict[str, Integers]:
    """Cells with each fault, the worst first, quadrilaterals before triangles."""
    found: dict[str, Integers] = {}
    for first, nodes in ((0, cells.quads), (len(cells.quads), cells.triangles)):
        for fault, which in shapes(cells.points[nodes]).faults().items() if len(nodes) else ():
            found[fault] = np.concatenate([found.get(fault, which[:0]), first + which])
    return found


def shell_doubts(
    name: str, mesh: ImportedMesh, named: str | None, cells: FlatCells, unit: tuple[Finding, ...]
) -> tuple[Finding, ...]:
    """What is doubtful about the cells of a shell.

    Parameters
    ----------
    unit : tuple[Finding, ...]
        What is of its unit of length.
    """
    return (*unit, *_of_shapes(name, mesh, cells), *_of_file(name, mesh, 2, named))


def solid_doubts(name: str, mesh: ImportedMesh, named: str | None, unit: tuple[Finding, ...]) -> tuple[Finding, ...]:
    """What is doubtful about the cells of a solid, their shapes aside.

    Parameters
    ----------
    unit : tuple[Finding, ...]
        What is of its unit of length.
    """
    return (*unit, *_of_file(name, mesh, 3, named))


def _of_file(name: str, mesh: ImportedMesh, dimension: int, named: str | None) -> tuple[Finding, ...]:
    twice, seams = (find(name, mesh, dimension, named) for find in (_twice, _of_seams))
    return (*twice, *seams)


def _named(mesh: ImportedMesh, cells: FlatCells, which: Integers) -> str:
    """Cells by their numbers in the file, the first of them with its place."""
    kinds = list(mesh.cells)
    numbers = [int(mesh.cell_numbers[kinds[cells.kinds[one]]][cells.cells[one]]) for one in which]
    x, y, z = cells.points[cells.corners[which[0]]].mean(axis=0)
    return f"element {list_some(dict.fromkeys(numbers), SHOWN)}; the first at ({x:.4g}, {y:.4g}, {z:.4g}) m"


def _of_shapes(name: str, mesh: ImportedMesh, cells: FlatCells) -> list[Finding]:
    faults = {fault: which for fault, which in _faults(cells).items() if fault in FAULTS}
    if not faults:
        return []
    faulty = [f"{len(which)} {FAULTS[fault]} ({_named(mesh, cells, which)})" for fault, which in faults.items()]
    bad = len(np.unique(np.concatenate(list(faults.values()))))
    return [
        Finding(
            "bad-cells",
            f"{name}: {bad} of {len(cells.cells)} cells have a bad shape: {', '.join(faulty)}",
            {"cells": bad},
        )
    ]


def _twice(name: str, mesh: ImportedMesh, dimension: int, named: str | None) -> list[Finding]:
    """Cells of the file on the nodes of others."""
    again: list[tuple[int, Floats]] = []
    for kind, rows in mesh.cells_of(named, dimension).items():
        nodes = np.sort(mesh.cells[kind][rows], axis=1)
        _, first, times = np.unique(nodes, axis=0, return_index=True, return_counts=True)
        numbers, cells = mesh.cell_numbers[kind], mesh.cells[kind]
        again += [(int(numbers[one]), mesh.points[cells[one]].mean(axis=0)) for one in rows[first[times > 1]]]
    if not again:
        return []
    x, y, z = again[0][1]
    named_ones = list_some([number for number, _ in again], SHOWN)
    return [
        Finding(
            "cells-twice",
            f"{name}: {len(again)} cells have the nodes of others: element {named_ones}; the first at "
            f"({x:.4g}, {y:.4g}, {z:.4g}) m. Their stiffness and mass are counted for each",
            {"cells": len(again)},
        )
    ]


def _of_seams(name: str, mesh: ImportedMesh, dimension: int, named: str | None) -> list[Finding]:
    """Nodes of cells that are at one place and are not one node."""
    cells = mesh.cells_of(named, dimension)
    used = np.unique(np.concatenate([mesh.cells[kind][rows].ravel() for kind, rows in cells.items()]))
    pairs = used[nodes_at_one_place(mesh.points[used], SEAM * float(np.ptp(mesh.points[used], axis=0).max()))]
    if not len(pairs):
        return []
    x, y, z = mesh.points[pairs[0, 0]]
    return [
        Finding(
            "open-seam",
            f"{name}: {len(pairs)} pairs of nodes are at one place and are not one node, such as "
            f"{mesh.numbers[pairs[0, 0]]} and {mesh.numbers[pairs[0, 1]]} at ({x:.4g}, {y:.4g}, {z:.4g}) m. The cells "
            "on both sides are not joined there",
            {"pairs": len(pairs)},
        )
    ]
