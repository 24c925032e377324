"""Meshes in VTK's XML files of unstructured grids, .vtu, read by meshio."""

from __future__ import annotations

import contextlib
import io
import re
from pathlib import Path
from typing import Any, Final

import numpy as np

from femstruct.arrays import Integers
from femstruct.errors import InputError, shorten
from femstruct.model.imported_mesh import CellBlock, Gathered

_KINDS: Final = {
    "line": "line2", "line3": "line3", "triangle": "tri3", "triangle6": "tri6", "quad": "quad4", "quad8": "quad8",
    "quad9": "quad9", "tetra": "tet4", "tetra10": "tet10", "hexahedron": "hex8", "hexahedron20": "hex20",
    "hexahedron27": "hex27",
}  # fmt: skip
MOST_SETS: Final = 200  # different values of an array beyond which it names no sets


def read_vtu(path: Path, data: bytes) -> Gathered:
    """What an unstructured grid has. Sets are the values of its arrays of whole numbers, as "region=3".

    Raises InputError for what meshio cannot read, and for cells that it leaves out (voxels, polyhedra).
    """
    import meshio  # type: ignore[import-untyped]

    output = io.StringIO()
    try:
        with contextlib.redirect_stdout(output), contextlib.redirect_stderr(output):
            mesh = meshio.read(path, file_format="vtu")
        blocks = [(block.type, np.asarray(block.data)) for block in mesh.cells]
        points = np.asarray(mesh.points, dtype=np.float64)
    except (Exception, SystemExit) as error:  # meshio says in all these ways that it cannot read a file
        if b"UnstructuredGrid" not in data:
            raise InputError("", got=f"'{path.name}', which is no unstructured grid", expected="a .vtu file") from None
        kind = "" if isinstance(error, SystemExit | AssertionError) else type(error).__name__
        words = (
            " ".join(str(error).split()) if not isinstance(error, SystemExit) else " ".join(output.getvalue().split())
        )
        why = ": ".join(one for one in (kind, shorten(words, 120)) if one) or "no reason given"
        raise InputError(
            "",
            got=f"'{path.name}', an unstructured grid that meshio cannot read ({why})",
            expected="lines, triangles, quadrilaterals, ..., hexahedra, as PyVista or ParaView write them",
        ) from None
    found = sum(len(some) for _, some in blocks)
    stated = [int(number) for number in re.findall(rb'NumberOfCells="\s*(\d+)"', data)]
    if stated and sum(stated) != found:
        raise InputError(
            "",
            got=f"'{path.name}' with {sum(stated)} cells, of which {found} could be read",
            expected="lines, triangles, quadrilaterals, tetrahedra and hexahedra",
            do="write voxels and pixels as hexahedra and quadrilaterals",
        )
    if unknown := [kind for kind, _ in blocks if kind not in (*_KINDS, "vertex")]:
        raise InputError(
            "",
            got=f"'{path.name}' with cells '{unknown[0]}'",
            expected="lines, triangles, quadrilaterals, ..., hexahedra",
        )
    first, made = 1, []
    for kind, some in blocks:
        if kind != "vertex":
            made.append(CellBlock(_KINDS[kind], np.arange(first, first + len(some)), some.astype(np.int64) + 1))
        first += len(some)
    cell_sets = _sets({name: np.concatenate(some) for name, some in mesh.cell_data.items()}, first - 1)
    lone = np.concatenate([np.arange(0), *(b.numbers for b in made)])
    cell_sets = {name: own[np.isin(own, lone)] for name, own in cell_sets.items()}
    nodes = np.arange(1, len(points) + 1)
    if points.shape[1] == 2:
        points = np.column_stack([points, np.zeros(len(points))])
    return Gathered(nodes, points, made, _sets(dict(mesh.point_data), len(points)), cell_sets)


def _sets(arrays: dict[str, Any], count: int) -> dict[str, Integers]:
    """Numbers, from 1, of what has each value of the arrays of whole numbers."""
    sets: dict[str, Integers] = {}
    for name, values in arrays.items():
        one = np.asarray(values)
        if one.ndim != 1 or one.dtype.kind not in "iub" or len(one) != count:
            continue
        different = np.unique(one)
        if len(different) <= MOST_SETS:
            sets |= {f"{name}={value}": np.flatnonzero(one == value) + 1 for value in different.tolist()}
    return sets
