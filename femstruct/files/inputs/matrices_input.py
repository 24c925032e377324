"""M, C, K of another program, or those that `femstruct export` and `femstruct reduce` wrote, from files."""

from __future__ import annotations

import csv
import hashlib
import io
import json
from pathlib import Path
from typing import Any, Final
from zipfile import BadZipFile

import numpy as np
from scipy.io import mmread
from scipy.sparse import csc_array, csr_array

from femstruct.assembly.given_matrices import given_matrices, mapped_matrices
from femstruct.assembly.matrices import Assembly, DofMap
from femstruct.conventions import N_COMPONENTS
from femstruct.errors import InputError
from femstruct.files.inputs.opening import content
from femstruct.model.imported.component import Component

FORMAT: Final = "femstruct matrices 1"
LARGEST: Final = 4 * 2**30  # bytes of a file
MATRICES: Final = ("M", "C", "K", "T")
_OF_REDUCTIONS: Final = ("interface", "quads", "lines", "axes", "loss_factor", "reduced_to_hz")
_WHAT: Final = (
    "matrices that femstruct export wrote, NAME.npz or NAME.json beside NAME.M.mtx, or a .npz of M, K, nodes, "
    "components, points"
)


def read_matrices(path: str | Path) -> Assembly:
    """The assembly of matrices in a file: that `femstruct export MODEL --to npz` or `--to mtx` wrote, NAME.npz or
    NAME.json, or of another program in a .npz of dense M, K and where there are dashpots C [n, n], nodes and components
    [n], points [n_nodes, 3], as `given_matrices` takes them.

    Its shapes are those of all nodes of the model, joined and held ones, too. Forces of supports and the loss factors
    of single parts are not in such a file.

    Raises InputError for a file that is not there or is no such file, FemstructError for matrices that do not fit.

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
    path = Path(path)
    data = content(path, LARGEST, _WHAT)
    if data[:2] == b"PK" and (foreign := _foreign(path, data)) is not None:
        return foreign
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


def read_component(path: str | Path, sources: dict[str, str] | None = None) -> Component:
    """The matrices of a file as a part of a model takes them: what `read_matrices` reads, or a reduction.

    sources : is given a digest of the file under its name. Raises InputError, and what `read_matrices` raises.
    """
    path = Path(path)
    data = content(path, LARGEST, _WHAT)
    assembly = read_matrices(path)
    more: dict[str, Any] = {"interface": np.arange(len(assembly.points))}
    if data[:2] == b"PK":
        with np.load(io.BytesIO(data), allow_pickle=False) as file:
            more |= {name: file[name] for name in _OF_REDUCTIONS if name in file}
    more |= {name: float(more[name]) for name in ("loss_factor", "reduced_to_hz") if name in more}
    M, C, K = (csr_array(one) for one in (assembly.M, assembly.C, assembly.K))
    labels = tuple(assembly.dofs.labels)
    if sources is not None:
        digest = hashlib.sha256(data).hexdigest()
        sources[str(path)] = f"sha256 {digest}, {len(labels)} degrees of freedom, {len(assembly.points)} nodes\n"
    return Component(path.name, M, C, K, assembly.dofs.T, assembly.points, assembly.total_mass, labels, **more)


def _foreign(path: Path, data: bytes) -> Assembly | None:
    """The assembly of the dense matrices of another program; None for a file of ours, or of none."""
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as file:
            if "about" in file or not {"M", "K"} <= set(file.files):
                return None
            missing = [name for name in ("nodes", "components", "points") if name not in file]
            found = {name: file[name] for name in ("M", "K", "C", "nodes", "components", "points") if name in file}
    except (ValueError, BadZipFile, EOFError, OSError) as error:
        raise InputError(str(path), got=f"'{path.name}', which cannot be read ({error})", expected=_WHAT) from None
    if missing:
        got = f"'{path.name}' without {', '.join(missing)}"
        raise InputError(
            str(path), got=got, expected="a node and a component of each degree of freedom, and the points"
        )
    return given_matrices(**found)
