"""Seams: two meshes with different nodes that meet along a line or, solids, in a plane."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.sparse import csr_array, kron

from femstruct.arrays import Floats, Integers
from femstruct.conventions import DIRECTIONS, N_COMPONENTS
from femstruct.declared import checked
from femstruct.errors import InputError, some_of
from femstruct.model.anchors import listed, some_listed
from femstruct.model.equations.constraint import Constraint
from femstruct.model.equations.face_mortar import Faces, across_faces
from femstruct.model.fastened import Tie
from femstruct.model.imported.cell_kinds import KINDS
from femstruct.model.meshed import Meshed
from femstruct.model.model import Model
from femstruct.model.region import Region
from femstruct.tags import stored_as

_FORCES = np.concatenate([np.eye(3), np.zeros((3, 3))])
_GAUSS: Final = 0.5 + np.array([-0.5, 0.5]) / np.sqrt(3.0)  # exact for the product of two linear functions
_ONE: Final = 1e-9  # of the length of a seam: nodes closer than this are at one place
APART: Final = 1e-3  # of the length of a seam: nodes farther off its line are not on it


@stored_as("seam/1")
@dataclass(frozen=True)
@checked("constraints")
class Seam(Constraint):
    """Two meshes that have different nodes where they meet: shells or solids along a straight line, or flat faces of
    solids.

    on, of : the part with the finer mesh there, and the set or box of it with the nodes or faces. onto, there : those
    of the other. directions : out of x y z rx ry rz, global, that go across; rotations where both parts have
    them. The force recorded is the one on the second part.

    A fine mesh beside a hole, welded into a coarse one:

    >>> weld = Seam("weld", "insert", Region("set", named="edge"), "wall", Region("set", named="opening"))
    >>> weld.directions[:3]
    ('x', 'y', 'z')

    Notes
    -----
    Mortar method: the difference of the two motions, linear between nodes, vanishes in the mean over the line with the
    dual functions of the finer side, whose integrals with its shape functions are diagonal. So each of its nodes
    follows the nodes of the other by factors that add to one. Motions that are linear along the line, and so rigid
    ones, constant strains, bending across it and twist, go across exactly, and forces balance; bending along the line
    goes across as well as shape functions of degree one can. Flat faces of solids: `across_faces`; a constant pressure
    goes across exactly.

    Source: B. I. Wohlmuth, A mortar finite element method using dual spaces for the Lagrange multiplier, SIAM J. Numer.
    Anal. 38 (2000) 989-1012, doi:10.1137/S0036142999350929.
    """

    name: str
    on: str
    of: Region
    onto: str
    there: Region
    directions: tuple[str, ...] = DIRECTIONS

    def __post_init__(self) -> None:
        where = f"constraints.{self.name}"
        some_listed(f"{where}.directions", self.directions)
        if (self.on, self.of) == (self.onto, self.there):
            raise InputError(f"{where}.onto", got="the same nodes twice", expected="those of another part or set")

    def holds(self) -> Mapping[str, tuple[str, ...]]:
        return {}

    def tie(self, model: Model, tolerance: float) -> Tie:
        where = f"constraints.{self.name}"
        fine, first = _nodes(f"{where}.seam", self.on, self.of, model, tolerance)
        coarse, second = _nodes(f"{where}.onto", self.onto, self.there, model, tolerance)
        held = listed(f"{where}.directions", self.directions)
        if not (fine.has_rotations and coarse.has_rotations):
            held = [number for number in held if number < 3]
        if not held:
            got = f"rotations of {self.on} and {self.onto}, one of which has none"
            raise InputError(f"{where}.directions", got=got, expected="x, y or z")
        if _off_line(model.mesh.points[first]) > APART:
            sides = [
                part.faces_at(f"{where}.{key}", region, tolerance)
                for key, part, region in (("seam", fine, self.of), ("onto", coarse, self.there))
            ]
            first, second, factors = _in_plane(where, sides[0], sides[1], model.mesh.points)
        else:
            first, second, s, t = _along(where, first, second, model.mesh.points)
            factors = csr_array(mortar(s, t))
        shape = (len(first), model.mesh.n_nodes)
        own = csr_array((np.ones(len(first)), (np.arange(len(first)), first)), shape=shape)
        at = factors.tocoo()
        following = csr_array((at.data, (at.row, second[at.col])), shape=shape)
        rows = csr_array(kron(csr_array(own - following), np.eye(N_COMPONENTS)[held]))
        return Tie(self.name, rows, np.tile(_FORCES[held], (len(first), 1)), grounded=False)


def mortar(s: Floats, t: Floats) -> Floats:
    """Motion of nodes at places s [m] of a line from that of nodes at t [k], both ascending: factors [m, k].

    >>> mortar(np.array([0.0, 0.5, 1.0]), np.array([0.0, 1.0])).round(12)
    array([[1. , 0. ],
           [0.5, 0.5],
           [0. , 1. ]])
    """
    inside = t[(t > s[0]) & (t < s[-1])]
    cuts = np.unique(np.concatenate([s, inside]))
    lengths = np.diff(cuts)
    at = (cuts[:-1, None] + lengths[:, None] * _GAUSS).ravel()
    weights = np.repeat(lengths / 2.0, 2)
    one, other = _shapes(s, at), _shapes(t, at)
    own = weights @ one  # of each node: the length that belongs to it
    piece = np.clip(np.searchsorted(s, at, side="right") - 1, 0, len(s) - 2)
    rows = np.arange(len(at))
    dual = 2.0 * one
    dual[rows, piece] -= one[rows, piece + 1]
    dual[rows, piece + 1] -= one[rows, piece]
    found: Floats = (dual * weights[:, None]).T @ other / own[:, None]
    found[np.abs(found) < 1e-14] = 0.0
    return found


def _shapes(nodes: Floats, at: Floats) -> Floats:
    """Linear shape functions of nodes [n] on a line at places [p]: [p, n]."""
    piece = np.clip(np.searchsorted(nodes, at, side="right") - 1, 0, len(nodes) - 2)
    share = np.clip((at - nodes[piece]) / (nodes[piece + 1] - nodes[piece]), 0.0, 1.0)
    found = np.zeros((len(at), len(nodes)))
    found[np.arange(len(at)), piece] = 1.0 - share
    found[np.arange(len(at)), piece + 1] = share
    return found


def _nodes(where: str, name: str, region: Region, model: Model, tolerance: float) -> tuple[Meshed, Integers]:
    part = model.parts.get(name)
    if part is None:
        raise InputError(f"{where}.on", got=f"'{name}'", expected=f"a part: {some_of(model.parts)}")
    return part, part.within(where, region, tolerance)


def _off_line(places: Floats) -> float:
    """How far places [n, 3] are off the straight line through them, over their extent along it [1]."""
    sizes = np.linalg.svd(places - places.mean(axis=0), compute_uv=False)
    return float(sizes[1] / sizes[0]) if len(places) > 1 and sizes[0] > 0.0 else 0.0


def _in_plane(
    where: str, first: Mapping[str, Integers], second: Mapping[str, Integers], points: Floats
) -> tuple[Integers, Integers, csr_array]:
    """The nodes of the faces of both sides, and the factors by which those of the first follow."""
    for key, faces in (("seam", first), ("onto", second)):
        if not faces:
            got, expected = (
                "nodes that are on no line and on no face of a solid",
                "nodes on one line, or faces of a solid",
            )
            raise InputError(f"{where}.{key}", got=got, expected=expected, do="write a seam for each straight piece")
        for kind, nodes in faces.items():
            cell = KINDS[kind]
            for number, edge in enumerate(cell.edges if cell.quadratic else ()):
                ends = points[nodes[:, list(edge)]]
                off = np.linalg.norm(points[nodes[:, cell.corners + number]] - ends.mean(axis=1), axis=1)
                if (off > APART * np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)).any():
                    got = f"curved sides of faces, up to {off.max():.4g} m off their middle"
                    raise InputError(f"{where}.{key}", got=got, expected="faces with straight sides")
    used = [np.unique(np.concatenate([nodes.ravel() for nodes in faces.values()])) for faces in (first, second)]
    places = points[np.concatenate(used)]
    middle, size = places.mean(axis=0), float(np.linalg.norm(np.ptp(places, axis=0)))
    axes = np.linalg.svd(places - middle, full_matrices=False)[2]
    off = float(np.abs((places - middle) @ axes[2]).max())
    if off > APART * size:
        got = f"faces up to {off:.4g} m off one plane"
        raise InputError(where, got=got, expected="faces of both parts in one plane", do="write a seam for each plane")
    sides = [
        Faces({kind: np.searchsorted(own, nodes) for kind, nodes in faces.items()}, (points[own] - middle) @ axes[:2].T)
        for own, faces in zip(used, (first, second), strict=True)
    ]
    found = across_faces(*sides)
    if found.covered < 1.0 - APART:
        got = f"faces of which {100.0 * (1.0 - found.covered):.3g} % have none of the second part against them"
        raise InputError(f"{where}.seam", got=got, expected="faces within those of the second part", do="swap the two")
    return used[0], used[1], found.factors


def _along(where: str, first: Integers, second: Integers, points: Floats) -> tuple[Integers, Integers, Floats, Floats]:
    """The nodes of both sides in their order along the line, and where on it they are [m]."""
    for key, nodes in (("seam", first), ("onto", second)):
        if len(nodes) < 2:
            raise InputError(f"{where}.{key}", got="one node", expected="two or more along a line")
    places = points[np.concatenate([first, second])]
    middle = places.mean(axis=0)
    direction = np.linalg.svd(places - middle, full_matrices=False)[2][0]
    along = (places - middle) @ direction
    off = np.linalg.norm(places - middle - along[:, None] * direction, axis=1)
    length = float(np.ptp(along))
    if off.max() > APART * length:
        got = f"nodes {off.max():.4g} m off the straight line through all of them"
        raise InputError(where, got=got, expected="nodes on one line", do="write a seam for each straight piece")
    s, t = along[: len(first)], along[len(first) :]
    beyond = max(t.min() - s.min(), s.max() - t.max())
    if beyond > APART * length:
        got = f"nodes that reach {beyond:.4g} m beyond those of the second part"
        raise InputError(f"{where}.seam", got=got, expected="a line within that of the second part", do="swap the two")
    order, other = np.argsort(s), np.argsort(t)
    for key, at in (("seam", s[order]), ("onto", t[other])):
        if np.diff(at).min() < _ONE * length:
            raise InputError(
                f"{where}.{key}", got="two nodes at one place", expected="one", do="merge the mesh's nodes"
            )
    return first[order], second[other], s[order], t[other]
