"""Surfaces over cells: where they lie, which way they face, and how they move along their normals."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.model.imported.facing import frame_across, outer_line, rectangle_round, upwards
from femstruct.model.imported.flat_cells import FlatCells
from femstruct.model.imported.shell_cells import Places, cell_points
from femstruct.model.probe import Surface
from femstruct.model.rows import sparse_rows
from femstruct.model.structure import SurfaceOn
from femstruct.parts.of_meshes.cells_mesh import ORDER
from femstruct.parts.of_meshes.shell_sides import signs_of_side

Motion = Callable[[Integers, Floats, Floats], tuple[Integers, Floats]]
"""From cells [p] and places xi, eta [p] in them to nodes [p, 4] of the structure and rows [p, 6, 4, 7], global axes."""


def side_surface(
    item: SurfaceOn,
    name: str,
    cells: FlatCells,
    chosen: Integers,
    motion: Motion,
    n_nodes: int,
    lies: tuple[Floats | float, float],
) -> Surface:
    """A side of some cells of a part. lies : half the thickness, of each cell or all, and how far the middle of it is
    from the cells along their normals [m].

    Above and below are told as for a plate; where neither side is up, above is that of the cells' own normals.

    Raises InputError for a closed surface, whose normals add to nothing.
    """
    points = cell_points(cells, chosen, ORDER)
    signs = signs_of_side(f"surfaces.{item.name}.region", name, cells, chosen, item.side)
    normals = signs[points.cells, None] * cells.normals[points.cells]
    whole = points.weights @ normals
    along = frame_across(upwards(whole / float(np.linalg.norm(whole))), cells.points)[0]
    outline = outer_line(cells.points, cells.corners[chosen])
    if outline is None:
        outline = rectangle_round(along, cells.points[np.unique(cells.corners[chosen])])
    reached = np.broadcast_to(lies[0], len(signs))[points.cells] + signs[points.cells] * lies[1]
    out = float(points.weights @ reached / points.weights.sum())
    return replace(surface_at(item.name, points, normals, (along, outline), motion, n_nodes), out=out)


def surface_at(
    name: str, points: Places, normals: Floats, lies: tuple[Floats, Floats], motion: Motion, n_nodes: int
) -> Surface:
    """The surface at points of cells with normals [p, 3] outwards. lies : directions [2, 3] along it, and its outline
    [.., 3] [m]."""
    nodes, rows = motion(points.cells, points.xi, points.eta)
    along_normal = np.einsum("pj,pjkc->pkc", normals, rows[:, :3])[:, None]
    return Surface(
        name,
        points=points.places,
        weights=points.weights,
        normals=normals,
        along=lies[0],
        outline=lies[1],
        rows=sparse_rows(nodes, along_normal, n_nodes),
    )
