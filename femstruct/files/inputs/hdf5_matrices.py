"""Matrices of another program in HDF5: dense, or sparse by rows or columns as scipy, anndata and others keep them."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import numpy as np
from scipy.sparse import csc_array, csr_array

from femstruct.errors import InputError

LAYOUT: Final = (
    "datasets or groups M, K and where there are dashpots C: a dataset [n, n], or a group of data, indices, indptr and "
    "shape; beside them nodes and components [n], points [n_nodes, 3], unless a table gives them"
)
_PARTS: Final = ("data", "indices", "indptr", "shape")


def read_hdf5_matrices(path: Path, data: bytes) -> dict[str, Any]:
    """What a file has of M, K, C, nodes, components and points, by name. Raises InputError for what is none of it."""
    import h5py

    try:
        with h5py.File(io.BytesIO(data), "r") as file:
            found = {name: _matrix(path, file[name]) for name in ("M", "K", "C") if name in file}
            found |= {name: np.asarray(file[name][()]) for name in ("nodes", "components", "points") if name in file}
    except InputError:
        raise
    except (OSError, ValueError, TypeError, KeyError, RuntimeError, AttributeError, MemoryError) as error:
        raise InputError("", got=f"'{path.name}', which cannot be read ({error})", expected=LAYOUT) from None
    return found


def _matrix(path: Path, item: Any) -> Any:
    """A matrix that a dataset or a group holds."""
    if hasattr(item, "dtype"):
        return np.asarray(item[()], dtype=np.float64)
    parts = {name: item[name][()] if name in item else item.attrs.get(name) for name in _PARTS}
    missing = [name for name, one in parts.items() if one is None]
    if missing:
        got = f"'{path.name}', whose group {item.name} has no {', '.join(missing)}"
        raise InputError("", got=got, expected=LAYOUT)
    word = item.attrs.get("format", item["format"][()] if "format" in item else "csr")
    kind = {"csr": csr_array, "csc": csc_array}.get(word.decode() if isinstance(word, bytes) else str(word))
    if kind is None:
        raise InputError("", got=f"'{path.name}' with a matrix in the format {word}", expected="csr or csc")
    made: Callable[..., Any] = kind
    matrix = made(tuple(parts[name] for name in _PARTS[:3]), shape=tuple(int(one) for one in parts["shape"]))
    matrix.check_format(full_check=True)
    return matrix
