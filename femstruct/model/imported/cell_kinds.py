"""Kinds of cells of imported meshes, and the order of their nodes, which is that of VTK."""

from __future__ import annotations

from typing import Final, NamedTuple

Edge = tuple[int, int]

_TRIANGLE: Final = ((0, 1), (1, 2), (2, 0))
_QUAD: Final = ((0, 1), (1, 2), (2, 3), (3, 0))
_TETRAHEDRON: Final = (*_TRIANGLE, (0, 3), (1, 3), (2, 3))
_HEXAHEDRON: Final = (*_QUAD, (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))
_TETRAHEDRON_FACES: Final = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2))
_HEXAHEDRON_FACES: Final = ((0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7))


class CellKind(NamedTuple):
    """A kind of cell. dimension : 1 of lines, 2 of faces, 3 of solids. corners, nodes : how many.

    edges : pairs of corners; the node in the middle of the i-th edge of a quadratic cell is its (corners + i)-th.
    faces : corners of its faces, seen from outside counterclockwise; of solids only. Nodes in the middles of faces, if
    it has any, follow those of its edges in the order of its faces, and the one in the middle of the cell comes last.
    """

    dimension: int
    corners: int
    nodes: int
    edges: tuple[Edge, ...]
    faces: tuple[tuple[int, ...], ...] = ()

    @property
    def quadratic(self) -> bool:
        """Whether its edges have nodes in the middle."""
        return self.nodes > self.corners


KINDS: Final = {
    "line2": CellKind(1, 2, 2, ((0, 1),)),
    "line3": CellKind(1, 2, 3, ((0, 1),)),
    "tri3": CellKind(2, 3, 3, _TRIANGLE),
    "tri6": CellKind(2, 3, 6, _TRIANGLE),
    "quad4": CellKind(2, 4, 4, _QUAD),
    "quad8": CellKind(2, 4, 8, _QUAD),
    "quad9": CellKind(2, 4, 9, _QUAD),
    "tet4": CellKind(3, 4, 4, _TETRAHEDRON, _TETRAHEDRON_FACES),
    "tet10": CellKind(3, 4, 10, _TETRAHEDRON, _TETRAHEDRON_FACES),
    "hex8": CellKind(3, 8, 8, _HEXAHEDRON, _HEXAHEDRON_FACES),
    "hex20": CellKind(3, 8, 20, _HEXAHEDRON, _HEXAHEDRON_FACES),
    "hex27": CellKind(3, 8, 27, _HEXAHEDRON, _HEXAHEDRON_FACES),
}
"""By name. Faces of hexahedra come in the order of VTK's nodes in their middles: -x, +x, -y, +y, -z, +z."""
