"""What the cells of a shell have: their thickness (of all, by sets, as the file states it, or that of layers), and mass
on them that does not stiffen them (of the model, or what the file states, NSM)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.errors import InputError
from femstruct.model.imported.cell_kinds import KINDS
from femstruct.model.imported.flat_cells import FlatCells, area_vectors
from femstruct.model.imported.imported_mesh import ImportedMesh, StatedProperty, StatedSpread, put_where
from femstruct.model.imported.stated.left_out import Makes
from femstruct.model.materials.lay_up import LayUp
from femstruct.parts.plausibility import refuse_thicker

if TYPE_CHECKING:
    from femstruct.parts.shell import Shell

MOST: Final = 6  # layers that a message names
THICK: Final = 1.0  # m: of less than that the unit of the mesh may be mistaken as well, which a finding says


def cell_thickness(shell: Shell, cells: FlatCells) -> Floats:
    """Thickness of each cell of a shell [q + t] [m].

    Raises InputError for cells without one or with two, and for one that is not positive, is thicker than the shell is
    large, or is not that of its layers.
    """
    where = f"parts.{shell.name}.thickness"
    side = float(np.sort(np.ptp(cells.points[np.unique(cells.corners)], axis=0))[1])  # of a flat one the shorter
    found = np.zeros(len(cells.cells))
    for name, value in _by_set(where, shell, cells).items():
        if not value > 0:
            raise InputError(where, got=f"{value:g} m", expected="a positive length")
        if value > THICK:
            refuse_thicker(shell.name, "shell", shell.material, value, side)
        own = np.ones(len(found), dtype=bool) if name is None else _of_set(where, shell, name, cells)
        if (found[own] > 0).any() and (found[own][found[own] > 0] != value).any():
            raise InputError(where, got=f"a second thickness of cells of set '{name}'", expected="one of each cell")
        found[own] = value
    if not (found > 0).all():
        got = f"{int((found == 0).sum())} of {len(found)} cells without one"
        raise InputError(where, got=got, expected="a set with a thickness for each cell")
    return found


def _by_set(where: str, shell: Shell, cells: FlatCells) -> Mapping[str | None, float]:
    """What is given of the thickness [m] by names of sets; None for all cells."""
    if isinstance(shell.material, LayUp):
        if shell.thickness not in (None, shell.material.thickness):
            expected = f"{shell.material.thickness:g} m, that of its layers"
            raise InputError(where, got=f"{shell.thickness} m", expected=expected, do="leave it out")
        return {None: shell.material.thickness}
    if isinstance(shell.thickness, Mapping):
        return dict(shell.thickness.items())
    if shell.thickness is not None:
        return {None: shell.thickness}
    stated = {one.cells: one.thickness for one in shell.mesh.stated.properties if one.thickness is not None}
    found = {name: value for name, value in stated.items() if _has(shell, name, cells)}
    if not found:
        got = f"none, and none in {shell.mesh.source}"
        if (layered := _layers_of(shell, cells)) is not None:
            got = f"none, and layers of '{layered.cells}' in {shell.mesh.source}"
            raise InputError(
                where, got=got, expected="'layers' in place of 'material'", do=f"write {_written(layered)}"
            )
        raise InputError(where, got=got, expected="a thickness", do="write 'thickness: 2 mm', or one by set")
    return dict(found.items())


def _of_set(where: str, shell: Shell, name: str, cells: FlatCells) -> np.ndarray:
    return put_where(where, lambda: cells.in_set(shell.mesh, name))


def _has(shell: Shell, name: str, cells: FlatCells) -> bool:
    kinds = shell.mesh.cell_sets.get(name, {})
    return any(kind.startswith(("tri", "quad")) for kind in kinds) and bool(cells.in_set(shell.mesh, name).any())


def _layers_of(shell: Shell, cells: FlatCells) -> StatedProperty | None:
    """The lay-up that the file states for cells of the shell."""
    return next((one for one in shell.mesh.stated.properties if one.layers and _has(shell, one.cells, cells)), None)


def _written(layered: StatedProperty) -> str:
    """A lay-up as a model states it, with the materials of the file by their names there."""
    rows = []
    for one in layered.layers[:MOST]:
        turned = f", {one.angle:g} deg" if isinstance(one.angle, float) and one.angle else ""
        rows.append(
            f"[{one.material}, {1e3 * one.thickness:.4g} mm{turned or (f', {one.angle}' if one.angle else '')}]"
        )
    more = len(layered.layers) - MOST
    return f"layers: [{', '.join(rows)}{f', and {more} more' if more > 0 else ''}]"


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
