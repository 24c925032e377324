"""The reference cells of solid elements: their nodes, shape functions and quadrature, which are scikit-fem's.

Nodes are in the order of VTK and meshio: corners, then the middles of edges, then for hex27 those of faces and of the
cell.
"""

from __future__ import annotations

from functools import cache
from typing import Any, Final, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from femstruct.arrays import Floats, Integers
from femstruct.errors import InputError

SolidElement = Literal["tet4", "tet10", "hex8", "hex20", "hex27"]
KINDS: Final = get_args(SolidElement)
_TETRAHEDRON: Final = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
_HEXAHEDRON: Final = tuple((x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1)))
_TET_EDGES: Final = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))
_AROUND: Final = ((0, 1), (1, 2), (2, 3), (3, 0))
_HEX_EDGES: Final = (*_AROUND, *((i + 4, j + 4) for i, j in _AROUND), *((i, i + 4) for i in range(4)))
_HEX_FACES: Final = ((0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (2, 3, 7, 6), (0, 1, 2, 3), (4, 5, 6, 7), range(8))
_ORDER: Final = {"tet4": 2, "tet10": 4, "hex8": 3, "hex20": 5, "hex27": 5}
"""Degree that the quadrature has exactly: that of the squared shape functions of a straight cell."""


def node_count(kind: str) -> int:
    """Nodes of a cell; InputError for an unknown kind.

    >>> node_count("hex20")
    20
    """
    return len(reference_nodes(kind))


@cache
def reference_nodes(kind: str) -> Floats:
    """Nodes [k, 3] of the reference cell, from 0 to 1 along its axes; InputError for an unknown kind.

    >>> reference_nodes("tet4").tolist()
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    """
    if kind not in KINDS:
        raise InputError("element", got=repr(kind), expected=" or ".join(KINDS))
    corners = np.array(_TETRAHEDRON if kind.startswith("tet") else _HEXAHEDRON, dtype=np.float64)
    groups = {"tet4": (), "tet10": _TET_EDGES, "hex8": (), "hex20": _HEX_EDGES, "hex27": (*_HEX_EDGES, *_HEX_FACES)}
    nodes = np.array([*corners, *(corners[list(group)].mean(axis=0) for group in groups[kind])])
    nodes.flags.writeable = False
    return nodes


def interpolate(kind: str, at: ArrayLike) -> Floats:
    """Shape functions [m, k] at places [m, 3] of the reference cell (0 to 1 along its axes).

    >>> interpolate("hex8", [[0.5, 0.5, 0.5]])
    array([[0.125, 0.125, 0.125, 0.125, 0.125, 0.125, 0.125, 0.125]])
    """
    return shapes(kind, np.atleast_2d(np.asarray(at, dtype=np.float64)))[0]


@cache
def _element(kind: str) -> tuple[Any, Integers]:
    """The element of scikit-fem, and where its shape functions stand in the order of our nodes."""
    import skfem

    makes = {
        "tet4": skfem.ElementTetP1,
        "tet10": skfem.ElementTetP2,
        "hex8": skfem.ElementHex1,
        "hex20": skfem.ElementHexS2,
        "hex27": skfem.ElementHex2,
    }
    at = reference_nodes(kind).T
    element = makes[kind]()
    values = np.stack([element.lbasis(at, i)[0] for i in range(at.shape[1])])
    return element, np.argmax(values, axis=0)


def shapes(kind: str, at: Floats) -> tuple[Floats, Floats]:
    """Shape functions [m, k] and their derivatives along the reference axes [m, 3, k]."""
    element, order = _element(kind)
    found = [element.lbasis(at.T, int(i)) for i in order]
    values = np.stack([np.broadcast_to(value, len(at)) for value, _ in found], axis=-1)
    slopes = np.stack([np.broadcast_to(slope, (3, len(at))).T for _, slope in found], axis=-1)
    return values, slopes


@cache
def quadrature(kind: str) -> tuple[Floats, Floats]:
    """Places [q, 3] and weights [q] in the reference cell."""
    from skfem.quadrature import get_quadrature

    at, weights = get_quadrature(_element(kind)[0].refdom, _ORDER[kind])
    return at.T, weights


@cache
def at_quadrature(kind: str) -> tuple[Floats, Floats, Floats]:
    """Shape functions [q, k], their derivatives [q, 3, k] and weights [q]."""
    at, weights = quadrature(kind)
    return *shapes(kind, at), weights
