"""M, C, K of another program, or those that `femstruct export` and `femstruct reduce` wrote, from files."""

from __future__ import annotations

import csv
import hashlib
import io
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final
from zipfile import BadZipFile

import numpy as np
from scipy.io import mmread
from scipy.sparse import csc_array, csr_array

from femstruct.assembly.given_matrices import mapped_matrices
from femstruct.assembly.matrices import Assembly, DofMap
from femstruct.conventions import N_COMPONENTS
from femstruct.errors import InputError
from femstruct.files.inputs.foreign_matrices import foreign_assembly, is_foreign
from femstruct.files.inputs.opening import content
from femstruct.model.imported.component import Component
from femstruct.model.meshed import LossShare

FORMAT: Final = "femstruct matrices 1"
LARGEST: Final = 4 * 2**30  # bytes of a file
MATRICES: Final = ("M", "C", "K", "T")
_OF_REDUCTIONS: Final = (
    "interface",
    "quads",
    "lines",
    "axes",
    "girth",
    "depth",
    "beside",
    "loss_factor",
    "reduced_to_hz",
)
_WHAT: Final = (
    "matrices that femstruct export wrote, NAME.npz or NAME.json beside NAME.M.mtx, or of another program: a .npz or "
    ".h5 of M, K, nodes, components, points, a .op4, or {M: M.mtx, K: K.mtx}"
)


def read_matrices(
    path: str | Path | Mapping[str, str | Path],
    nodes: str | Path | None = None,
    names: Mapping[str, str] | None = None,
    scale: float = 1.0,
) -> Assembly:
    """The assembly of matrices in a file: that `femstruct export MODEL --to npz` or `--to mtx` wrote, NAME.npz or
    NAME.json, or of another program.

    path : of another program a .npz of M, K and where there are dashpots C [n, n], nodes and components [n], points
    [n_nodes, 3], as `given_matrices` takes them; HDF5 with the same names, where a matrix may be a group of data,
    indices, indptr and shape; OUTPUT4 of Nastran (.op4, binary or text); or a file of Matrix Market under each of "M",
    "K", "C". nodes : a table of commas with the columns node, x, y, z, direction and a row for each degree of freedom,
    where the file has no map. names : of M, K, C in an OP4 file, where they are not the usual ones. scale : metres in
    the unit of length of another program; forces are in newtons, so masses are in t where lengths are in mm.

    Its shapes are those of all nodes of the model, joined and held ones, too. Forces of supports and the loss factors
    of single parts are not in such a file.

    Raises InputError for a file that is not there or is no such file, FemstructError for matrices that do not fit.

    >>> from pathlib import Path
    >>> import tempfile
    >>> from femstruct import given_matrices, modal_basis
    >>> from femstruct.files.exchange.matrices_file import write_npz
    >>> assembly = given_matrices(M=[[2.0]], K=[[200.0]], nodes=[0], components=[2], points=[[0.0, 0.0, 0.0]])
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     (path,) = write_npz(assembly, Path(folder), "mass", {"title": "a mass on a spring"})
    ...     again = read_matrices(path)
    >>> modal_basis(again, count=1).omega.round(12).tolist(), again.dofs.labels
    ([10.0], ('node 0 UZ',))
    """
    table, named = None if nodes is None else Path(nodes), names or {}
    if isinstance(path, Mapping):
        return foreign_assembly({key: Path(one) for key, one in path.items()}, table, named, scale)
    path = Path(path)
    data = content(path, LARGEST, _WHAT)
    if is_foreign(path, data):
        return foreign_assembly({"": path}, table, named, scale)
    if table is not None or named or scale != 1.0:
        got = f"a table of nodes, names or a scale for '{path.name}'"
        raise InputError("", got=got, expected="none: it has its map, in metres", do="leave them out")
    try:
        read = _npz(data) if data[:2] == b"PK" else _mtx(path, data)
    except (KeyError, TypeError, ValueError, BadZipFile, EOFError, StopIteration) as error:
        told = f"without {error}" if isinstance(error, KeyError) else f"which cannot be read ({error})"
        raise InputError(str(path), got=f"'{path.name}', {told}", expected=_WHAT) from None
    matrices, points, labels, momentum, total_mass = read
    dofs = DofMap(csr_array(matrices["T"]), tuple(labels))
    return mapped_matrices(matrices["M"], matrices["K"], dofs, points, momentum, total_mass, matrices["C"])


Read = tuple[dict[str, Any], Any, list[str], Any, float]


def _npz(data: bytes) -> Read:
    with np.load(io.BytesIO(data), allow_pickle=False) as file:
        about = _checked(json.loads(str(file["about"])))
        n, rows = about["degrees_of_freedom"], about["nodes"] * N_COMPONENTS
        matrices = {
            letter: csc_array(
                tuple(file[f"{letter}_{part}"] for part in ("data", "indices", "indptr")),
                shape=(rows if letter == "T" else n, n),
            )
            for letter in MATRICES
        }
        return matrices, file["points"], file["labels"].tolist(), file["momentum"], float(about["mass_kg"])


def _mtx(path: Path, data: bytes) -> Read:
    about = _checked(json.loads(data.decode("utf-8")))
    files = {key: content(path.parent / Path(name).name, LARGEST, _WHAT) for key, name in about["files"].items()}
    matrices = {letter: csc_array(mmread(io.BytesIO(files[letter]))) for letter in MATRICES}
    tables = {key: list(csv.DictReader(io.StringIO(files[key].decode("utf-8-sig")))) for key in ("dofs", "nodes")}
    momentum = [[float(row[f"momentum_{axis}_kg"]) for row in tables["dofs"]] for axis in "xyz"]
    points = np.array([[float(row[f"{axis}_m"]) for axis in "xyz"] for row in tables["nodes"]]).reshape(-1, 3)
    return matrices, points, [row["name"] for row in tables["dofs"]], momentum, float(about["mass_kg"])


def _checked(about: Any) -> dict[str, Any]:
    if not isinstance(about, dict) or about.get("format") != FORMAT:
        raise ValueError(f"its format is not '{FORMAT}'")
    return about


def _shares(file: Mapping[str, Any]) -> tuple[LossShare, ...]:
    """Of the stiffness of a reduced part by the loss factors of its layers; none in files of before."""
    if "share_K" not in file:
        return ()
    each = zip(file["share_names"].tolist(), file["share_losses"].tolist(), file["share_K"], strict=True)
    return tuple(LossShare(name, loss, csr_array(K)) for name, loss, K in each)


def read_component(
    path: str | Path | Mapping[str, str | Path],
    sources: dict[str, str] | None = None,
    nodes: str | Path | None = None,
    names: Mapping[str, str] | None = None,
    scale: float = 1.0,
) -> Component:
    """The matrices of a file as a part of a model takes them: what `read_matrices` reads, or a reduction.

    sources : is given a digest of each file under its name. Raises InputError, and what `read_matrices` raises.
    """
    assembly = read_matrices(path, nodes, names, scale)
    paths = [Path(one) for one in path.values()] if isinstance(path, Mapping) else [Path(path)]
    data = content(paths[0], LARGEST, _WHAT)
    more: dict[str, Any] = {"interface": np.arange(len(assembly.points))}
    if not isinstance(path, Mapping) and not is_foreign(paths[0], data):
        more["momentum"] = assembly.momentum
    if data[:2] == b"PK":
        with np.load(io.BytesIO(data), allow_pickle=False) as file:
            more |= {name: file[name] for name in _OF_REDUCTIONS if name in file}
            more["shares"] = _shares(file)
            named = json.loads(str(file["about"])).get("sets", {}) if "about" in file else {}
        more["sets"] = {name: np.asarray(one, np.int64) for name, one in named.items()}
    more |= {name: float(more[name]) for name in ("girth", "depth", "loss_factor", "reduced_to_hz") if name in more}
    M, C, K = (csr_array(one) for one in (assembly.M, assembly.C, assembly.K))
    labels = tuple(assembly.dofs.labels)
    if sources is not None:
        for one in (*paths, *([] if nodes is None else [Path(nodes)])):
            digest = hashlib.sha256(content(one, LARGEST, _WHAT)).hexdigest()
            sources[str(one)] = f"sha256 {digest}, {len(labels)} degrees of freedom, {len(assembly.points)} nodes\n"
    return Component(paths[0].name, M, C, K, assembly.dofs.T, assembly.points, assembly.total_mass, labels, **more)
