"""What is doubtful about a mesh that a shell is made of: slips of units, bad cells, cells twice, open seams."""

from __future__ import annotations

from typing import Final

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.elements.quality import shapes
from femstruct.errors import Finding, InputError, some_of
from femstruct.model.imported.flat_cells import FlatCells, nodes_at_one_place
from femstruct.model.imported.imported_mesh import ImportedMesh

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
    """What is doubtful about the cells of a shell. unit : what is of its unit of length."""
    return (*unit, *_of_shapes(name, mesh, cells), *_of_file(name, mesh, 2, named))


def solid_doubts(name: str, mesh: ImportedMesh, named: str | None, unit: tuple[Finding, ...]) -> tuple[Finding, ...]:
    """What is doubtful about the cells of a solid, their shapes aside. unit : what is of its unit of length."""
    return (*unit, *_of_file(name, mesh, 3, named))


def _of_file(name: str, mesh: ImportedMesh, dimension: int, named: str | None) -> tuple[Finding, ...]:
    twice, seams = (find(name, mesh, dimension, named) for find in (_twice, _of_seams))
    return (*twice, *seams)


def _named(mesh: ImportedMesh, cells: FlatCells, which: Integers) -> str:
    """Cells by their numbers in the file, the first of them with its place."""
    kinds = list(mesh.cells)
    numbers = [int(mesh.cell_numbers[kinds[cells.kinds[one]]][cells.cells[one]]) for one in which]
    x, y, z = cells.points[cells.corners[which[0]]].mean(axis=0)
    return f"element {some_of(dict.fromkeys(numbers), SHOWN)}; the first at ({x:.4g}, {y:.4g}, {z:.4g}) m"


def _of_shapes(name: str, mesh: ImportedMesh, cells: FlatCells) -> list[Finding]:
    faults = {fault: which for fault, which in _faults(cells).items() if fault in FAULTS}
    if not faults:
        return []
    told = [f"{len(which)} {FAULTS[fault]} ({_named(mesh, cells, which)})" for fault, which in faults.items()]
    bad = len(np.unique(np.concatenate(list(faults.values()))))
    return [
        Finding(
            "bad-cells",
            f"{name}: {bad} of {len(cells.cells)} cells have a bad shape: {', '.join(told)}",
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
    named_ones = some_of([number for number, _ in again], SHOWN)
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
