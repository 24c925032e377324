"""The tetrahedra and hexahedra that a part takes from an imported mesh, and the faces that bound them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.sparse import csr_array

from femstruct.arrays import Floats, Integers, freeze, frozen, frozen_integers
from femstruct.conventions import N_COMPONENTS
from femstruct.elements import solid
from femstruct.errors import InputError, list_some
from femstruct.model.flat_cells import FlatCells, best_turns, connected_pieces, flat_cells
from femstruct.model.imported_mesh import KINDS, ImportedMesh
from femstruct.model.regions import Region
from femstruct.model.scatter import scatter
from femstruct.tags import stored_as

# Linear pieces of a face by its nodes: corners, then middles of its sides, then its own middle.
_PIECES: Final = {
    3: ((0, 1, 2),),
    6: ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)),
    4: ((0, 1, 2, 3),),
    8: ((0, 4, 7), (4, 1, 5), (5, 2, 6), (7, 6, 3), (4, 5, 6, 7)),
    9: ((0, 4, 8, 7), (4, 1, 5, 8), (8, 5, 2, 6), (7, 8, 6, 3)),
}
_FACES: Final = {3: "tri3", 6: "tri6", 4: "quad4", 8: "quad8", 9: "quad9"}
SHOWN: Final = 3  # cells that are named


@stored_as("solid cells/1")
@dataclass(frozen=True, eq=False)
class SolidCells:
    """Tetrahedra and hexahedra of an imported mesh, with the nodes that they have.

    points [n, 3] : nodes [m]; rows [n] : of the points of the mesh. cells : nodes [m, k] by kind, counted from 0 on.
    facets : the faces that only one cell has, cut into triangles and quadrilaterals, normals outwards. onto [f] : the
    node that each node of the facets is.
    """

    points: Floats
    rows: Integers
    cells: Mapping[str, Integers]
    facets: FlatCells
    onto: Integers
    outside: ImportedMesh

    def __post_init__(self) -> None:
        count = len(self.points)
        freeze(
            self,
            points=frozen("cells points", self.points, (None, 3)),
            rows=frozen_integers("cells rows", self.rows, (count,)),
            cells={
                kind: frozen_integers(f"cells {kind}", one, (None, KINDS[kind].nodes))
                for kind, one in self.cells.items()
            },
            onto=frozen_integers("cells onto", self.onto, (len(self.facets.points),)),
        )

    @property
    def volumes(self) -> dict[str, Floats]:
        """Volumes of the cells [m] by kind [m^3]."""
        return {kind: solid.volumes(kind, self.points[one]) for kind, one in self.cells.items()}

    @property
    def corners(self) -> Integers:
        """Corner nodes of the facets [q + t, 4]; triangles have their last one twice."""
        return self.onto[self.facets.corners]

    def facets_within(self, region: Region, tolerance: float) -> Integers:
        """Facets of a set of faces, with all corners among the nodes of a set or in a box, or all."""
        if region.kind == "whole":
            return np.arange(len(self.facets.cells))
        name = region.named or ""
        if region.kind == "set" and self.outside.cell_sets.get(name):
            return np.flatnonzero(self.facets.in_set(self.outside, name))
        nodes = self.facets.nodes_within(self.outside, region, tolerance)
        return np.flatnonzero(np.isin(self.facets.corners, nodes).all(axis=1))

    def whole_faces(self, chosen: Integers) -> dict[str, Integers]:
        """Faces of cells all of whose facets are among some [c]: their nodes [m, k] by kind of face."""
        among = np.zeros(len(self.points), dtype=bool)
        among[self.onto[self.facets.corners[chosen]]] = True
        faces = [one[:, list(face)] for kind, one in self.cells.items() for face in _faces_of(kind)]
        corners = [_keys(one[:, : KINDS[_FACES[one.shape[1]]].corners]) for one in faces]
        _, number, count = np.unique(np.concatenate(corners), axis=0, return_inverse=True, return_counts=True)
        lone = np.split(count[number.ravel()] == 1, np.cumsum([len(one) for one in faces])[:-1])
        found: dict[str, list[Integers]] = {}
        for one, outer in zip(faces, lone, strict=True):
            if (kept := outer & among[one].all(axis=1)).any():
                found.setdefault(_FACES[one.shape[1]], []).append(one[kept])
        return {kind: np.concatenate(some) for kind, some in found.items()}

    def nodes_within(self, mesh: ImportedMesh, region: Region, tolerance: float) -> Integers:
        """Nodes of a set or in a box; those of a set that are not of these cells are left out."""
        if region.kind == "whole":
            return np.arange(len(self.points))
        if region.box is not None:
            low, high = np.sort(np.array(region.box, dtype=np.float64), axis=0)
            inside = (self.points >= low - tolerance) & (self.points <= high + tolerance)
            return np.flatnonzero(inside.all(axis=1))
        return np.flatnonzero(np.isin(self.rows, mesh.nodes_of(region.named or "")))

    def held_together(self) -> Integers:
        """Which cells hang together by nodes: a label for each node [n]."""
        return connected_pieces(self.cells.values(), len(self.points))


def solid_cells(mesh: ImportedMesh, named: str | None) -> SolidCells:
    """The tetrahedra and hexahedra of a set of a mesh, or of all of it.

    Raises InputError for a set that is not there, and for one without such cells.

    >>> from femstruct.elements.solid import reference_nodes
    >>> corners = reference_nodes("hex8")
    >>> mesh = ImportedMesh("a", corners, range(8), {"hex8": [range(8)]}, {"hex8": [1]})
    >>> cells = solid_cells(mesh, None)
    >>> len(cells.facets.quads), cells.facets.normals.sum(axis=0).tolist(), cells.volumes["hex8"].round(9).tolist()
    (6, [0.0, 0.0, 0.0], [1.0])
    """
    chosen = mesh.cells_of(named, 3)
    taken = {kind: mesh.cells[kind][rows] for kind, rows in chosen.items()}
    rows = np.unique(np.concatenate([one.ravel() for one in taken.values()]))
    outside = _outside(mesh, taken)
    facets = flat_cells(outside, None)
    return SolidCells(
        np.asarray(mesh.points)[rows],
        rows,
        {kind: np.searchsorted(rows, one) for kind, one in taken.items()},
        facets,
        np.searchsorted(rows, facets.rows),
        outside,
    )


def refuse_inverted(where: str, mesh: ImportedMesh, named: str | None) -> None:
    """Raise InputError for cells that are turned inside out or folded, naming them as the file does."""
    for kind, rows in mesh.cells_of(named, 3).items():
        nodes = np.asarray(mesh.points)[mesh.cells[kind][rows]]
        bad = np.flatnonzero(~(solid.least_sizes(kind, nodes) > 0.0))
        if len(bad):
            numbers = list_some([str(mesh.cell_numbers[kind][rows[i]]) for i in bad], SHOWN)
            raise InputError(
                where,
                got=f"{len(bad)} of {len(rows)} {kind} cells turned inside out or folded: {numbers}",
                expected="cells with a volume above zero at every point",
                do="mesh again, or turn the order of their nodes",
            )


def matrices(cells: SolidCells, C: Floats, rho: float) -> tuple[csr_array, csr_array]:
    """Stiffness and mass [3 n, 3 n] of all cells.

    Parameters
    ----------
    C : Floats [6, 6]
        Elasticity along global axes [Pa], rho [kg/m^3].
    """
    count = 3 * len(cells.points)
    found = []
    for kind, one in cells.cells.items():
        nodes = cells.points[one]
        numbers = (3 * one[:, :, None] + np.arange(3)).reshape(len(one), -1)
        found.append(scatter(solid.stiffness(kind, nodes, C), solid.mass(kind, nodes, rho), numbers, count))
    K, M = found[0]
    for more in found[1:]:
        K, M = csr_array(K + more[0]), csr_array(M + more[1])
    return K, M


def facet_rows(cells: SolidCells, which: Integers, xi: Floats, eta: Floats) -> tuple[Integers, Floats]:
    """Motion at places of facets [p]: nodes [p, 4] and rows [p, 6, 4, 7], global axes. Displacements are bilinear;
    rotations are those of the rigid motion that fits the corners of the facet best."""
    four = which < len(cells.facets.quads)
    of_four = np.stack([(1 - xi) * (1 - eta), (1 - xi) * eta, xi * eta, xi * (1 - eta)], axis=1)
    of_three = np.stack([1.0 - xi - eta, xi, eta, np.zeros_like(xi)], axis=1)
    shares = np.where(four[:, None], of_four, of_three)
    nodes = cells.corners[which]
    counted = np.where(four[:, None], 1.0, [1.0, 1.0, 1.0, 0.0])
    rows = np.zeros((len(which), 6, 4, N_COMPONENTS))
    rows[:, :3, :, :3] = shares[:, None, :, None] * np.eye(3)[:, None]
    rows[:, 3:, :, :3] = best_turns(cells.points[nodes], counted)
    return nodes, rows


def _outside(mesh: ImportedMesh, taken: Mapping[str, Integers]) -> ImportedMesh:
    """The faces that only one cell has as a mesh of triangles and quadrilaterals, with the sets of faces and nodes."""
    faces: dict[int, list[Integers]] = {}
    for kind, cells in taken.items():
        for face in _faces_of(kind):
            faces.setdefault(len(face), []).append(cells[:, face])
    by_count = {count: np.concatenate(some) for count, some in faces.items()}
    sets = {
        name: [mesh.cells[kind][rows][:, : KINDS[kind].corners] for kind, rows in of.items() if _is_face(kind)]
        for name, of in mesh.cell_sets.items()
    }
    sets = {name: some for name, some in sets.items() if some}
    groups = [_keys(one[:, : 3 if count in (3, 6) else 4]) for count, one in by_count.items()]
    own = sum(len(one) for one in groups)
    groups += [_keys(one) for some in sets.values() for one in some]
    number = np.unique(np.concatenate(groups), axis=0, return_inverse=True)[1].ravel()
    lone = np.bincount(number[:own], minlength=number.max() + 1)[number[:own]] == 1
    cells2: dict[str, list[Integers]] = {"tri3": [], "quad4": []}
    of_faces: dict[str, list[Integers]] = {"tri3": [], "quad4": []}
    start = 0
    for count, one in by_count.items():
        kept = lone[start : start + len(one)]
        for piece in _PIECES[count]:
            word = "tri3" if len(piece) == 3 else "quad4"
            cells2[word].append(one[kept][:, piece])
            of_faces[word].append(number[start : start + len(one)][kept])
        start += len(one)
    found = {word: np.concatenate(some) for word, some in cells2.items() if sum(map(len, some))}
    owners = {word: np.concatenate(of_faces[word]) for word in found}
    cell_sets: dict[str, dict[str, Integers]] = {}
    for name, some in sets.items():
        count = sum(map(len, some))
        chosen, own = number[own : own + count], own + count
        rows = {word: np.flatnonzero(np.isin(one, chosen)) for word, one in owners.items()}
        rows = {word: those for word, those in rows.items() if len(those)}
        if rows:
            cell_sets[name] = rows
    node_sets = {name: mesh.nodes_of(name) for name in mesh.set_names}
    numbers = {word: np.arange(len(one)) for word, one in found.items()}
    return ImportedMesh(mesh.source, mesh.points, mesh.numbers, found, numbers, node_sets, cell_sets, scale=mesh.scale)


def _is_face(kind: str) -> bool:
    return KINDS[kind].dimension == 2


def _faces_of(kind: str) -> list[tuple[int, ...]]:
    """Nodes of each face of a kind of cell: corners, middles of its sides, its own middle."""
    known = KINDS[kind]
    middles = {frozenset(edge): known.corners + i for i, edge in enumerate(known.edges)} if known.quadratic else {}
    found = []
    for number, face in enumerate(known.faces):
        sides = [frozenset((face[i], face[(i + 1) % len(face)])) for i in range(len(face))]
        own = (known.corners + len(known.edges) + number,) if kind == "hex27" else ()
        found.append((*face, *(middles[side] for side in sides if middles), *own))
    return found


def _keys(corners: Integers) -> Integers:
    """What tells faces [m, 4]: their corners in ascending order, -1 first for triangles."""
    padded = np.full((len(corners), 4), -1)
    padded[:, 4 - corners.shape[1] :] = np.sort(corners, axis=1)
    return padded
