"""Mass on the cells of a shell that does not stiffen them: that of the model, or what the file states (NSM)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.model.imported.cell_kinds import KINDS
from femstruct.model.imported.flat_cells import FlatCells, area_vectors
from femstruct.model.imported.imported_mesh import ImportedMesh, StatedSpread
from femstruct.model.imported.stated.left_out import Makes

if TYPE_CHECKING:
    from femstruct.parts.shell import Shell


def spread_mass(shell: Shell, cells: FlatCells, thickness: Floats) -> Floats:
    """Mass per area [q + t] [kg/m^2] on each cell of a shell. thickness [q + t] : of the cells [m]."""
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
