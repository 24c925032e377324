"""Bars on a slab or shell whose nodes are elsewhere: oblique ribs, ribs between lines of cells, posts inside of cells.

The ends of bars move with the places of the cells that they lie on; deflections between nodes are what the cells make
of the rotations, so that a rib does not follow the kinks of straight lines between nodes. What moves together is what
does so on a plate (`femstruct.model.grid.bars_on_plates`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_array, vstack
from scipy.spatial import KDTree

from femstruct.arrays import Floats, Integers
from femstruct.conventions import N_COMPONENTS
from femstruct.model.fastened import Elastic, Tie
from femstruct.model.grid.bars_on_plates import pieces_of, touching_face
from femstruct.model.grid.sliding import across_lines, refuse_lengths
from femstruct.model.meshed import Meshed
from femstruct.model.model import Model
from femstruct.model.rows import carried, node_rows, sparse_rows
from femstruct.model.structure import Joint

_SIX = 6
_SLIGHT = 1e-6  # sine of an angle: less is rounding


class _Feet(NamedTuple):
    """Nodes of bars [p], places of cells where they are [p, 3] [m], and the motion of the bars less that of the cells
    there, shifts and rotations along global axes [6 p, n_nodes * 7]."""

    nodes: Integers
    places: Floats
    rows: csr_array

    def relative(self, which: Integers, components: Floats) -> csr_array:
        """Of some of them [r] along components [r, 6]: [r, n_nodes * 7]."""
        row = np.repeat(np.arange(len(which)), _SIX)
        column = (_SIX * which[:, None] + np.arange(_SIX)).ravel()
        chosen = csr_array((components.ravel(), (row, column)), shape=(len(which), self.rows.shape[0]))
        chosen.eliminate_zeros()
        return csr_array(chosen @ self.rows)


def feet_beside_nodes(bars: Meshed, cells: Meshed, nodes: Integers, there: Integers, off: float) -> Integers:
    """Nodes of bars that are joined to cells, where ends of bars lie on cells [m] off at most, and some of them beside
    the nodes there; none where all ends that do are at nodes.

    nodes, there : those of both parts that a joint is about.
    """
    ends = np.intersect1d(bars.lines.ravel(), nodes)
    if not len(ends) or not len(there) or cells.edges_of_cells is None:
        return ends[:0]
    on = ends[cells.off_cells(bars.places[ends - bars.first]) <= off]
    apart = np.asarray(KDTree(cells.places[there - cells.first]).query(bars.places[nodes - bars.first])[0])
    at_nodes = nodes[apart <= off]
    return np.union1d(on, at_nodes) if len(np.setdiff1d(on, at_nodes)) else ends[:0]


def bars_on_cells(
    item: Joint, parts: tuple[Meshed, Meshed], nodes: Integers, springs: tuple[list[int], Floats], model: Model
) -> tuple[Tie | None, Elastic | None]:
    """Equations and springs of a joint of bars with the cells they lie on.

    parts : the bars and what has the cells. nodes [p] : of the bars, from `feet_beside_nodes`. springs : directions
    that are sprung, out of six, and their stiffnesses.
    """
    bars, cells = parts
    springy, values = springs
    cells = cells.around(np.unique(cells.motion_on_cells(model.mesh.points[nodes])[0]))
    feet = _feet(bars, cells, nodes, model)
    axes = np.eye(3) if cells.own_axes is None else cells.own_axes
    sign = 1.0 if item.a == bars.name else -1.0
    all_of = np.arange(len(nodes))
    held = np.eye(3)[[axis for axis in range(3) if axis not in springy]] if set(springy) & {0, 1, 2} else axes
    which, shifts = np.repeat(all_of, len(held)), np.tile(held, (len(nodes), 1))
    along, directions, lengths = pieces_of(bars, np.column_stack([nodes, all_of]))
    if item.kind == "sliding":
        which, shifts = across_lines(len(nodes), along[:, 1], directions, axes)
    turns = _turning(feet, (bars, cells), along, directions, springy) if item.kind != "pinned" else []
    rows = [feet.relative(which, np.hstack([shifts, np.zeros_like(shifts)])), *turns]
    count = sum(one.shape[0] for one in turns)
    tie = Tie(item.name, csr_array(sign * vstack(rows)), np.concatenate([shifts, np.zeros((count, 3))]), grounded=False)
    none = tie if tie.rows.shape[0] else None
    if item.kind == "sliding":
        slides = feet.relative(along[:, 1], np.hstack([directions, np.zeros_like(directions)]))
        stiffness = item.slip * lengths
    elif springy:
        each, shares = all_of, np.ones(len(nodes))
        if item.per == "length":
            each, shares = along[:, 1], lengths
            refuse_lengths(item, not len(each))
        free = np.tile(np.eye(_SIX)[springy], (len(each), 1))
        slides, directions = feet.relative(np.repeat(each, len(springy)), free), free[:, :3]
        stiffness = np.outer(shares, values).ravel()
    else:
        return none, None
    zero = np.zeros(len(stiffness))
    return none, Elastic(item.name, csr_array(sign * slides), stiffness, zero, directions, grounded=False)


def _feet(bars: Meshed, cells: Meshed, nodes: Integers, model: Model) -> _Feet:
    n_nodes, places = model.mesh.n_nodes, model.mesh.points[nodes]
    at = places
    if cells.drilling is not None:
        at = touching_face(nodes, places, bars, cells)
    own = np.zeros((len(nodes), _SIX, 1, N_COMPONENTS))
    own[:, :, 0, :_SIX] = np.eye(_SIX)
    there, motion = cells.motion_on_cells(places)
    rows = sparse_rows(nodes[:, None], carried(own, at - places), n_nodes)
    facing = sparse_rows(there, carried(motion, at - places), n_nodes)
    facing.data[np.abs(facing.data) < 1e-14] = 0.0  # rounding of places in cells
    facing.eliminate_zeros()
    return _Feet(nodes, places, csr_array(rows - facing))


def _turning(
    feet: _Feet, parts: tuple[Meshed, Meshed], along: Integers, directions: Floats, springy: list[int]
) -> list[csr_array]:
    """Rotations held: of ribs about their axis, of what stands on the cells all; as `bars_on_plates.turning_rows`."""
    bars, cells = parts
    free = np.eye(3)[[number - 3 for number in springy if number >= 3]]
    everywhere, normal = np.arange(len(feet.nodes)), cells.drilling
    standing = np.setdiff1d(everywhere, along[:, 1]) if normal is not None else everywhere
    wanted = [] if normal is None else [(along[:, 1], directions)]
    axes = np.eye(3) if cells.own_axes is None else cells.own_axes
    wanted += [(standing, np.tile(axis, (len(standing), 1))) for axis in axes[: 3 if normal is None else 2]]
    found = []
    for which, about in wanted:
        turn = about - about @ free.T @ free
        kept = np.flatnonzero(np.linalg.norm(turn, axis=1) > _SLIGHT)
        found.append(feet.relative(which[kept], np.hstack([np.zeros((len(kept), 3)), turn[kept]])))
    if normal is not None and len(standing) and not (np.abs(free @ normal) > _SLIGHT).any():
        n_nodes = feet.rows.shape[1] // N_COMPONENTS
        turn = np.zeros((len(standing), N_COMPONENTS))
        turn[:, 3:_SIX] = normal
        patches = cells.turning_at(feet.places[standing], bars.girth, n_nodes)
        found.append(csr_array(node_rows(feet.nodes[standing], turn, n_nodes) - patches))
    return found
