"""Meshes of rooms from files that meshio reads."""

from __future__ import annotations

import contextlib
import hashlib
import io
from pathlib import Path
from typing import Any, Final

import numpy as np

from acoustics.arrays import Integers
from acoustics.errors import AcousticsError
from acoustics.meshed.cavity_mesh import CavityMesh
from femstruct.errors import InputError
from femstruct.files.text_tables import content

LARGEST: Final = 50_000_000  # bytes
_NAMELESS: Final = (".med", ".h5m", ".hmf", ".cgns", ".xdmf", ".xmf", ".e", ".ex2", ".exo")
_EXPECTED: Final = "a mesh of one kind that meshio reads, as of Gmsh"
_CELLS: Final = {"tetra": 4, "tetra10": 4, "hexahedron": 8, "hexahedron20": 8, "hexahedron27": 8}
_FACETS: Final = {"triangle": 3, "triangle6": 3, "quad": 4, "quad8": 4, "quad9": 4}


def read_mesh(path: Path, sources: dict[str, str]) -> CavityMesh:
    """The tetrahedra or hexahedra of a mesh file [m] and its named surfaces.

    Corners only: nodes on edges and faces are left out, and sides are straight. Names are the physical groups of Gmsh
    or the sets of cells of other formats.

    Parameters
    ----------
    sources : dict[str, str]
        Is given a digest of the file under its name.

    Raises
    ------
    InputError
    """
    if path.suffix.lower() in _NAMELESS:  # HDF5 may hang on a damaged one, and XDMF names files of its own
        raise InputError(
            "",
            got=f"'{path.name}', of which meshio reads no named surfaces",
            expected="a mesh with named surfaces, as of Gmsh",
        )
    digest = hashlib.sha256(content(path, LARGEST, "a mesh file, named from the study's folder")).hexdigest()
    try:
        mesh = _read(path)
        cells, points = _cells(mesh), np.asarray(mesh.points, dtype=np.float64)
    except InputError as error:
        raise InputError("", got=f"'{path.name}', which is no mesh ({error.got})", expected=error.expected) from None
    except (Exception, SystemExit):  # meshio tells of files it cannot read in all these ways, and quotes them
        raise InputError("", got=f"'{path.name}', which is no mesh", expected=_EXPECTED) from None
    used: Integers = np.unique(cells)
    number = np.full(len(points), -1)
    number[used] = np.arange(len(used))
    walls = {name: number[facets] for name, facets in _walls(mesh).items()}
    try:
        found = CavityMesh(points[used], number[cells], walls)
    except AcousticsError as error:
        raise InputError(
            "", got=f"'{path.name}', {error.where}: {error.got}", expected=error.expected, do=error.do
        ) from None
    sources[str(path)] = f"sha256 {digest}, {len(cells)} cells, {len(used)} points, walls {', '.join(walls)}\n"
    return found


def _read(path: Path) -> Any:
    import meshio  # type: ignore[import-untyped]

    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        return meshio.read(path)


def _cells(mesh: Any) -> Integers:
    """Corners of the cells of the one kind there is [m, 4 or 8]."""
    kinds = {_CELLS[block.type] for block in mesh.cells if block.type in _CELLS}
    if len(kinds) != 1:
        raise InputError(
            "", got=("tetrahedra and hexahedra" if kinds else "neither tetrahedra nor hexahedra"), expected=_EXPECTED
        )
    (corners,) = kinds
    blocks = [block.data[:, :corners] for block in mesh.cells if block.type in _CELLS]
    return np.concatenate(blocks).astype(np.int64)


def _walls(mesh: Any) -> dict[str, Integers]:
    """Corners of the facets of every named surface."""
    walls: dict[str, Integers] = {}
    for name, rows in _named(mesh).items():
        parts = [
            block.data[np.asarray(own, dtype=np.int64)][:, : _FACETS[block.type]]
            for block, own in zip(mesh.cells, rows, strict=True)
            if block.type in _FACETS and own is not None and len(own)
        ]
        if parts and len({part.shape[1] for part in parts}) == 1:
            walls[name] = np.concatenate(parts).astype(np.int64)
    return walls


def _named(mesh: Any) -> dict[str, list[Any]]:
    """Sets of cells by name, numbers in every block: physical groups of Gmsh, or what the format calls sets."""
    tags = mesh.cell_data.get("gmsh:physical", [])
    tagged = list(zip(mesh.cells, tags, strict=True)) if tags else []
    groups = {
        name: [np.flatnonzero((block.dim == dimension) & (own == tag)) for block, own in tagged]
        for name, (tag, dimension) in mesh.field_data.items()
        if tagged
    }
    return groups | {name: rows for name, rows in mesh.cell_sets.items() if not name.startswith("gmsh:")}
