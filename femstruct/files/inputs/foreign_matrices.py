"""M, C, K of another program: in a .npz, HDF5, OUTPUT4 of Nastran, or a file of Matrix Market for each of them."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Final
from zipfile import BadZipFile

import numpy as np
from scipy.io import mmread
from scipy.sparse import csc_array, diags_array

from femstruct.assembly.given_matrices import given_matrices
from femstruct.assembly.matrices import Assembly
from femstruct.errors import InputError, some_of
from femstruct.files.inputs.dof_table import DofTable, read_dof_table, refuse_size
from femstruct.files.inputs.hdf5_matrices import read_hdf5_matrices
from femstruct.files.inputs.op4 import read_op4
from femstruct.files.inputs.opening import content

LARGEST: Final = 4 * 2**30  # bytes of a file
WANTED: Final = ("M", "K", "C")
USUAL: Final[Mapping[str, tuple[str, ...]]] = {  # names that Nastran gives them, of the analysis set first
    "M": ("M", "MAA", "MXX", "MLL", "MGG", "MASS"),
    "K": ("K", "KAA", "KXX", "KLL", "KGG", "STIFF"),
    "C": ("C", "BAA", "BXX", "BLL", "BGG", "B", "DAMP"),
}
_MAP: Final = ("nodes", "components", "points")
_TURNS: Final = 3  # the first of the components that are rotations; those before are shifts
_HDF5: Final = b"\x89HDF"
_ZIP: Final = b"PK"
_MARKET: Final = b"%%MatrixMarket"
EXPECTED: Final = "M and K, and where there are dashpots C"


def is_foreign(path: Path, data: bytes) -> bool:
    """Whether a file is one of another program: .op4, HDF5, or a .npz with M and K as they are."""
    if path.suffix.lower() == ".op4" or data.startswith((_HDF5, _MARKET)):
        return True
    if not data.startswith(_ZIP):
        return False
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as file:
            return "about" not in file and {"M", "K"} <= set(file.files)
    except (ValueError, BadZipFile, EOFError, OSError, KeyError, NotImplementedError):
        return True  # which the reader says


def foreign_assembly(files: Mapping[str, Path], table: Path | None, names: Mapping[str, str], scale: float) -> Assembly:
    """The assembly of matrices of another program.

    files : one under "" that has all of them, or one of Matrix Market under each of M, K, C. table : says which node
    and direction each degree of freedom is (`read_dof_table`); None where the file does. names : of M, K, C in an OP4
    file, where they are not the usual ones. scale : metres in the unit of length; forces are in newtons, times in
    seconds. Raises InputError, and what `given_matrices` raises.
    """
    one = files.get("")
    found = _of_one(one, names) if one is not None else {key: _market(path) for key, path in files.items()}
    told = "the files" if one is None else f"'{one.name}'"
    missing = [name for name in WANTED[:2] if name not in found]
    if missing:
        raise InputError("", got=f"{told} without {' and '.join(missing)}", expected=EXPECTED)
    count = found["M"].shape[0]
    if table is not None:
        if known := [name for name in _MAP if name in found]:
            got = f"a table of nodes beside {told}, which has {', '.join(known)}"
            raise InputError("", got=got, expected="one of them", do="leave the table out")
        read = read_dof_table(table)
        refuse_size(table, read, count, "M")
    else:
        lacking = [name for name in _MAP if name not in found]
        if lacking:
            raise InputError(
                "",
                got=f"{told} without {', '.join(lacking)}",
                expected="a node and a component of each degree of freedom, and the points",
                do="or a table of them: nodes: TABLE.csv with the columns node, x, y, z, direction",
            )
        read = DofTable(*(np.asarray(found[name]) for name in _MAP))
    matrices: dict[str, Any] = {name: found[name] for name in WANTED if name in found}
    if scale != 1.0:
        matrices = {name: _in_metres(one, read, scale) for name, one in matrices.items()}
    return given_matrices(**matrices, nodes=read.nodes, components=read.components, points=read.points * scale)


def _in_metres(matrix: Any, read: DofTable, scale: float) -> csc_array:
    """u' K u is an energy, in newtons times the unit of length, of shifts in that unit and of rotations."""
    factor = diags_array(np.where(np.asarray(read.components) < _TURNS, 1.0 / scale, 1.0))
    return csc_array(scale * (factor @ (csc_array(matrix) @ factor)))


def _of_one(path: Path, names: Mapping[str, str]) -> dict[str, Any]:
    """What one file has of the matrices and of the map."""
    data = content(path, LARGEST, EXPECTED)
    if path.suffix.lower() == ".op4":
        return _chosen(path, read_op4(path, data), names)
    if names:
        got = f"names of matrices in '{path.name}'"
        raise InputError("", got=got, expected="M, K and C as they are called", do="names are for .op4 files")
    if data.startswith(_HDF5):
        return read_hdf5_matrices(path, data)
    if data.startswith(_MARKET):
        got = f"'{path.name}', a file of one matrix"
        raise InputError("", got=got, expected="one for each", do="write file: {M: M.mtx, K: K.mtx}")
    read: dict[str, Any] = _read(path, lambda: _npz(data))
    return read


def _chosen(path: Path, found: Mapping[str, csc_array], names: Mapping[str, str]) -> dict[str, Any]:
    """Matrices of an OP4 file by the names that are given or usual."""
    chosen: dict[str, Any] = {}
    for key in WANTED:
        if key in names:
            if names[key].upper() not in found:
                got = f"'{names[key]}', no matrix of {path.name}"
                raise InputError("", got=got, expected=some_of(found))
            chosen[key] = found[names[key].upper()]
            continue
        usual = [name for name in USUAL[key] if name in found]
        if len(usual) > 1:
            got = f"{' and '.join(usual)} in '{path.name}'"
            raise InputError("", got=got, expected=f"which of them is {key}", do=f"write names: {{{key}: {usual[0]}}}")
        if usual:
            chosen[key] = found[usual[0]]
        elif key != "C":
            got = f"{some_of(found)} in '{path.name}'"
            raise InputError("", got=got, expected=f"which of them is {key}", do=f"write names: {{{key}: NAME}}")
    return chosen


def _npz(data: bytes) -> dict[str, Any]:
    with np.load(io.BytesIO(data), allow_pickle=False) as file:
        return {name: file[name] for name in (*WANTED, *_MAP) if name in file}


def _market(path: Path) -> csc_array:
    data = content(path, LARGEST, "a matrix of Matrix Market (.mtx)")
    if not data.startswith(_MARKET):
        raise InputError("", got=f"'{path.name}', which does not begin with %%MatrixMarket", expected="a .mtx file")
    return csc_array(_read(path, lambda: mmread(io.BytesIO(data))))


def _read(path: Path, reader: Callable[[], Any]) -> Any:
    try:
        return reader()
    except (ValueError, TypeError, BadZipFile, EOFError, OSError, KeyError, OverflowError, MemoryError,
            NotImplementedError) as error:  # fmt: skip
        raise InputError("", got=f"'{path.name}', which cannot be read ({error})", expected=EXPECTED) from None
