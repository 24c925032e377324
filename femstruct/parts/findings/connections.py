"""What holds together and what is held: the pieces of a structure that nothing joins, and how each can still move."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import gcd

import numpy as np
import scipy
from scipy.sparse import coo_array, csr_array, vstack
from scipy.sparse.csgraph import connected_components

from femstruct.arrays import Floats, Integers, freeze, frozen, frozen_integers
from femstruct.conventions import N_COMPONENTS
from femstruct.model.grid.geometry import distance_to_rectangle, to_rectangle
from femstruct.model.model import Model
from femstruct.parts.foundation import Foundation
from femstruct.parts.of_plates.plate_mesh import plates_of

FREE = 1e-6  # of what the supports resist most: a rigid motion they resist by less is free
TOUCHING = 1e-6  # of the structure's size
MOST_ROWS = 1000


@dataclass(frozen=True, eq=False)
class Piece:
    """A part of a structure, or several, that joints, layers or springs hold together.

    parts : their names, in order. nodes [n] : of the mesh. mass [kg].
    free [f, 6] : its rigid motions that no support resists, in terms of six: shifts along x, y, z, and rotations about
    the middle of the structure, scaled to move what is as far away as it is large by one. weight [6] : mass times rise
    in each of the six [kg].
    """

    parts: tuple[str, ...]
    nodes: Integers
    mass: float
    free: Floats
    weight: Floats

    def __post_init__(self) -> None:
        freeze(
            self,
            nodes=frozen_integers("Piece nodes", self.nodes, (None,)),
            free=frozen("Piece free", self.free, (None, 6)),
            weight=frozen("Piece weight", self.weight, (6,)),
        )

    @property
    def falls(self) -> bool:
        """Whether its own weight sets it in motion, since the supports cannot balance it."""
        return bool(np.linalg.norm(self.free @ self.weight) > FREE * np.linalg.norm(self.weight))


def pieces(model: Model, joined: Iterable[tuple[str, str]] = ()) -> tuple[Piece, ...]:
    """The pieces of a model, the heaviest first.

    joined : pairs of points by name that something else holds together, as contacts and links of a study do.

    >>> from femstruct.model.material import Material
    >>> from femstruct.model.mesher import mesh_structure
    >>> from femstruct.model.structure import Structure, Support
    >>> from femstruct.parts.plate import Plate
    >>> steel = Material("steel", E=210e9, nu=0.3, rho=8000.0)
    >>> one = Plate("one", steel, 0.003, origin=(0.0, 0.0, 0.0), size=(0.5, 0.4), mesh=(2, 2))
    >>> two = Plate("two", steel, 0.002, origin=(0.0, 0.0, 0.3), size=(0.5, 0.4), mesh=(2, 2))
    >>> held = Support("edge", "clamped", on="one", edge="x0")
    >>> model = mesh_structure(Structure("two", (one, two), supports=(held,)))
    >>> [(piece.parts, len(piece.free)) for piece in pieces(model)]
    [(('one',), 0), (('two',), 6)]
    """
    n_nodes = model.mesh.n_nodes
    labels = _labels(model, joined)
    motion = _rigid_motions(model)
    resisted = [tie.rows for tie in model.ties if tie.grounded]
    resisted += [
        _some(spring.rows[np.flatnonzero(spring.stiffness > 0)]) for spring in model.elastics if spring.grounded
    ]
    held = csr_array(vstack([csr_array((0, n_nodes * N_COMPONENTS)), *resisted]))
    held.eliminate_zeros()
    held = held[np.flatnonzero(np.diff(held.indptr))]
    owner = labels[held.indices[held.indptr[:-1]] // N_COMPONENTS]
    directions = held @ motion
    weights = _weights(model, motion)
    found = []
    for label in range(int(labels.max()) + 1):
        nodes = np.flatnonzero(labels == label)
        parts = tuple(name for name, numbers in model.mesh.nodes.items() if (labels[numbers] == label).any())
        weight = np.array(weights[nodes].sum(axis=0))
        found.append(Piece(parts, nodes, float(weight[2]), _null(directions[owner == label]), weight))
    return tuple(sorted(found, key=lambda piece: -piece.mass))


def place_of_touch(model: Model, one: Piece, other: Piece) -> Floats | None:
    """A place [3] where nodes of one of two pieces lie on the other; None where none do."""
    within = TOUCHING * _size(model)
    for here, there in ((one, other), (other, one)):
        places = model.mesh.points[here.nodes]
        distances = np.asarray(scipy.spatial.KDTree(model.mesh.points[there.nodes]).query(places)[0])
        for plate in (plate for plate in plates_of(model) if plate.name in there.parts):
            local = to_rectangle(plate.part, plate.axes, places)
            distances = np.minimum(distances, distance_to_rectangle(local, plate.part.size))
        if distances.min() <= within:
            nearest: Floats = places[int(np.argmin(distances))]
            return nearest
    return None


def held_directions(model: Model) -> Floats:
    """Sum of d d^T over the unit directions d in which supports hold each node [n_nodes, 3, 3]."""
    found = np.zeros((model.mesh.n_nodes, 3, 3))
    for tie in model.ties:
        if not tie.grounded:
            continue
        rows = _nonzero(tie.rows)
        node, component = np.divmod(rows.col, N_COMPONENTS)
        turning = np.zeros(tie.rows.shape[0], dtype=bool)
        turning[rows.row[component >= 3]] = True
        first = np.full(tie.rows.shape[0], -1)
        first[rows.row] = node
        several = np.zeros(tie.rows.shape[0], dtype=bool)
        several[rows.row[first[rows.row] != node]] = True
        kept = ~(turning | several) & (first >= 0)
        directions = np.zeros((tie.rows.shape[0], 3))
        straight = component < 3
        directions[rows.row[straight], component[straight]] = rows.data[straight]
        directions = directions[kept]
        np.add.at(found, first[kept], directions[:, :, None] * directions[:, None, :])
    return found


def held_with_joined(model: Model) -> Floats:
    """Directions in which supports hold each node [n_nodes, 3, 3]; nodes in one place, as joined ones, share them."""
    held = held_directions(model)
    size = float(np.ptp(model.mesh.points, axis=0).max())
    pairs = scipy.spatial.KDTree(model.mesh.points).query_pairs(TOUCHING * size, output_type="ndarray")
    shared = held.copy()
    for first, second in (pairs.T, pairs.T[::-1]):
        np.add.at(shared, first, held[second])
    return shared


def _labels(model: Model, joined: Iterable[tuple[str, str]]) -> Integers:
    """The piece of every node [n_nodes], from a graph of the nodes and of all that has a part in several of them."""
    n_nodes = model.mesh.n_nodes
    groups = [group for part in model.parts.values() for group in part.held_together]
    groups += [np.concatenate([place.nodes for name in pair for place in model.places(name)]) for pair in joined]
    layers = {part.name: part for part in model.structure.parts if isinstance(part, Foundation)}
    groups += [
        np.concatenate([model.mesh.nodes[name][:1] for name in (layer.on, layer.to) if name is not None])
        for layer in layers.values()
    ]
    numbers = np.repeat(np.arange(len(groups)), [len(group) for group in groups])
    nodes = np.concatenate([np.zeros(0, np.int64), *groups])
    springs = [elastic.rows for elastic in model.elastics if elastic.name not in layers]
    for rows in (*(tie.rows for tie in model.ties), *springs):
        entries = _nonzero(rows)
        first = int(numbers[-1]) + 1 if len(numbers) else 0
        numbers = np.concatenate([numbers, first + entries.row])
        nodes = np.concatenate([nodes, entries.col // N_COMPONENTS])
    size = n_nodes + (int(numbers.max()) + 1 if len(numbers) else 0)
    graph = coo_array((np.ones(len(nodes), dtype=np.int8), (nodes, n_nodes + numbers)), shape=(size, size))
    labels = connected_components(graph, directed=False)[1][:n_nodes]
    _, found = np.unique(labels, return_inverse=True)
    return found.astype(np.int64)


def _some(rows: csr_array) -> csr_array:
    """A thousand or so of the rows of a layer, spread over all of it: they resist the same rigid motions."""
    step = max(1, rows.shape[0] // MOST_ROWS)
    while gcd(step, 6) > 1:  # a place has one to three rows, of different directions: all of them have their turn
        step += 1
    return csr_array(rows[::step])


def _nonzero(rows: csr_array) -> coo_array:
    """The entries of a matrix that are not zero; zeros may be stored in it."""
    entries = coo_array(rows)
    used = entries.data != 0.0
    return coo_array((entries.data[used], (entries.row[used], entries.col[used])), shape=rows.shape)


def _size(model: Model) -> float:
    corners = [model.mesh.points, *(part.bounds for part in model.parts.values())]
    return float(np.ptp(np.concatenate(corners), axis=0).max())


def _rigid_motions(model: Model) -> Floats:
    """Six rigid motions of all nodal components [n_nodes * 7, 6]; a rotation moves what is a size away by one."""
    points, size = model.mesh.points, _size(model) or 1.0
    arms = (points - (points.min(axis=0) + points.max(axis=0)) / 2.0) / size
    motion = np.zeros((len(points), N_COMPONENTS, 6))
    for axis, unit in enumerate(np.eye(3)):
        motion[:, axis, axis] = 1.0
        motion[:, :3, 3 + axis] = np.cross(unit, arms)
        motion[:, 3 + axis, 3 + axis] = 1.0 / size
    return motion.reshape(-1, 6)


def _weights(model: Model, motion: Floats) -> Floats:
    """Mass times the rise of every rigid motion, at the nodes [n_nodes, 6] [kg]."""
    lumps = np.zeros(model.mesh.n_nodes)
    for part in model.parts.values():
        lumps[part.nodes] = part.lumps
    weights = lumps[:, None] * motion.reshape(-1, N_COMPONENTS, 6)[:, 2]
    for inert in model.inerts:
        rises = slice(2, 3 * inert.n_places, 3)
        upwards = csr_array(inert.rows[rises])
        upwards.eliminate_zeros()
        some = np.flatnonzero(np.diff(upwards.indptr))
        at = upwards.indices[upwards.indptr[some]] // N_COMPONENTS
        np.add.at(weights, at, inert.mass[rises][some, None] * (upwards @ motion)[some])
    return weights


def _null(directions: Floats) -> Floats:
    """Orthonormal motions [f, 6] that the rows [m, 6] do not feel."""
    sizes = np.linalg.norm(directions, axis=1)
    rows = directions[sizes > 0.0]
    if not len(rows):
        return np.eye(6)
    _, values, vectors = np.linalg.svd(rows, full_matrices=True)
    rank = int((values > FREE * values[0]).sum())
    return vectors[rank:]
