"""M, C, K of an assembly in files of NumPy (.npz) or of Matrix Market (.mtx).

The map from nodes and components to degrees of freedom is beside them, names and units, too. Supports and joints
are taken out of the matrices; T says how the nodes follow what is left.
"""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Final, Literal

import numpy as np
from scipy.io import mmwrite
from scipy.sparse import csc_array, csr_array

from femstruct.arrays import Integers
from femstruct.assembly.matrices import Assembly, DofMap
from femstruct.conventions import COMPONENTS, N_COMPONENTS
from femstruct.files.matrices_input import FORMAT, MATRICES
from femstruct.files.writing import replacing, short

SYMMETRIC: Final = ("M", "C", "K")
_ABOUT: Final = {
    "format": FORMAT,
    "equation": "M u'' + C u' + K u = T^T f; nodal components = T u",
    "units": "m, N, kg, s, rad: K [N/m, N, N m], C [N s/m, N s, N m s], M [kg, kg m, kg m^2]",
    "M": "mass",
    "C": "dashpots of springs and supports alone; the damping of the structure itself is under 'damping'",
    "K": "stiffness",
    "T": f"row {N_COMPONENTS} i + j: component j ({', '.join(COMPONENTS)}) of node i, from 0",
    "nodes, components": "of each degree of freedom; -1 where it moves no component alone, as of a rigid body",
    "momentum": "3 rows: of the structure when each degree of freedom moves at unit rate, along x, y, z, with the mass "
    "that couples it to held nodes, which is not in M: weight and motion of a base push by it",
}


def write_npz(
    assembly: Assembly, folder: Path, name: str, about: Mapping[str, Any], more: Mapping[str, Any] | None = None
) -> list[Path]:
    """One file NAME.npz: M, C, K, T as data, indices, indptr of compressed columns, the map, `about`; returns it.

    Parameters
    ----------
    about : Mapping[str, Any]
        What else there is to say, as JSON: where the matrices come from, and how the structure is damped.
    more : Mapping[str, Any] | None
        Further arrays.
    """
    path = folder / f"{short(name)}.npz"
    arrays: dict[str, Any] = dict(more or {})
    for letter, matrix in _matrices(assembly).items():
        columns = csc_array(matrix)
        arrays |= {f"{letter}_{part}": getattr(columns, part) for part in ("data", "indices", "indptr")}
    nodes, components = nodal(assembly.dofs)
    with replacing(path) as temporary:
        np.savez_compressed(
            temporary,
            **arrays,
            nodes=nodes,
            components=components,
            points=assembly.points,
            labels=np.array(list(assembly.dofs.labels), dtype=np.str_),
            momentum=assembly.momentum,
            about=np.array(json.dumps(_described(assembly, about))),
        )
    return [path]


def write_mtx(assembly: Assembly, folder: Path, name: str, about: Mapping[str, Any]) -> list[Path]:
    """NAME.M.mtx, NAME.C.mtx, NAME.K.mtx (the lower halves), NAME.T.mtx, the tables NAME.dofs.csv and NAME.nodes.csv,
    and NAME.json with what there is to say; returns the files. All digits are written."""
    stem = short(name)
    paths = {letter: folder / f"{stem}.{letter}.mtx" for letter in MATRICES}
    for letter, matrix in _matrices(assembly).items():
        with replacing(paths[letter]) as temporary, temporary.open("wb") as file:
            kind: Literal["symmetric", "general"] = "symmetric" if letter in SYMMETRIC else "general"
            mmwrite(file, matrix, comment=f" {letter} of {name}: see {stem}.json", precision=17, symmetry=kind)
    nodes, components = nodal(assembly.dofs)
    named = [COMPONENTS[one] if one >= 0 else "" for one in components.tolist()]
    rows = zip(range(len(nodes)), nodes.tolist(), named, *assembly.momentum.tolist(), assembly.dofs.labels, strict=True)
    head = ("dof", "node", "component", "momentum_x_kg", "momentum_y_kg", "momentum_z_kg", "name")
    paths["dofs"] = _write_table(folder / f"{stem}.dofs.csv", head, rows)
    places = ((node, *place) for node, place in enumerate(assembly.points.tolist()))
    paths["nodes"] = _write_table(folder / f"{stem}.nodes.csv", ("node", "x_m", "y_m", "z_m"), places)
    with replacing(folder / f"{stem}.json") as temporary:
        files = {"files": {key: path.name for key, path in paths.items()}}
        temporary.write_text(json.dumps(_described(assembly, about) | files, indent=1), encoding="utf-8")
    return [*paths.values(), folder / f"{stem}.json"]


def nodal(dofs: DofMap) -> tuple[Integers, Integers]:
    """Node and component [n], [n] that each degree of freedom is; -1 where none is it alone.

    The first one counts where several follow it, as at joined nodes.

    >>> nodal(DofMap(csr_array(([1.0, 1.0, 0.5], ([2, 9, 4], [0, 0, 1])), shape=(14, 2)), ("a", "b")))
    (array([ 0, -1]), array([ 2, -1]))
    """
    T = csr_array(dofs.T)
    T.eliminate_zeros()
    alone = np.flatnonzero(np.diff(T.indptr) == 1)
    alone = alone[T.data[T.indptr[alone]] == 1.0]
    found, first = np.unique(T.indices[T.indptr[alone]], return_index=True)
    places = np.full(T.shape[1], -1, dtype=np.int64)
    places[found] = alone[first]
    held = places >= 0
    return np.where(held, places // N_COMPONENTS, -1), np.where(held, places % N_COMPONENTS, -1)


def _matrices(assembly: Assembly) -> dict[str, Any]:
    return {"M": assembly.M, "C": assembly.C, "K": assembly.K, "T": assembly.dofs.T}


def _described(assembly: Assembly, about: Mapping[str, Any]) -> dict[str, Any]:
    counts = {"nodes": len(assembly.points), "degrees_of_freedom": assembly.K.shape[0], "mass_kg": assembly.total_mass}
    return {**_ABOUT, **counts, **about}


def _write_table(path: Path, head: tuple[str, ...], rows: Iterator[tuple[Any, ...]]) -> Path:
    with replacing(path) as temporary, temporary.open("w", encoding="utf-8-sig", newline="") as file:
        csv.writer(file).writerows([head, *rows])
    return path
