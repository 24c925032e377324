"""M, C, K of another program, or those that `femstruct export` and `femstruct reduce` wrote, from files."""

from __future__ import annotations

import csv
import hashlib
import io
import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Final, NamedTuple
from zipfile import BadZipFile

import numpy as np
from scipy.io import mmread
from scipy.sparse import csc_array, csr_array, diags_array

from femstruct.arrays import Floats, Integers
from femstruct.assembly.given_matrices import given_matrices, mapped_matrices
from femstruct.assembly.matrices import Assembly, DofMap
from femstruct.conventions import DIRECTIONS, N_COMPONENTS
from femstruct.errors import InputError, list_some, quote_value
from femstruct.files.op4 import read_op4
from femstruct.files.text_tables import content, floats, lines_of, wrong_line
from femstruct.model.component import Component
from femstruct.model.part import LossShare

# ----------------------------------------------------------------------------------------------------------------------
# Which node and direction each degree of freedom of foreign matrices is: a table of commas, a row for each.
# ----------------------------------------------------------------------------------------------------------------------

LARGEST_TABLE: Final = 2**28  # bytes
_HEAD: Final = ("node", "x", "y", "z", "direction")
_OF_EXPORT: Final = {"dof", "component", "momentum_x_kg"}  # columns of NAME.dofs.csv
_DOF_TABLE: Final = f"a table of commas with the columns {', '.join(_HEAD)}, a row for each degree of freedom"
_NEAR: Final = 1e-6  # of the size of all: places of one node, written with few digits, differ by less


class DofTable(NamedTuple):
    """Of each degree of freedom its node, counted from 0 on in their order, and its direction out of 0 to 5 [n]; points
    [n_nodes, 3] : where the nodes are, in the unit of length of the file."""

    nodes: Integers
    components: Integers
    points: Floats


def read_dof_table(path: Path) -> DofTable:
    """The table of a file. Nodes are called as one likes; directions are x y z rx ry rz, or 1 to 6.

    Raises InputError, with the line.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     table = Path(folder, "a.csv")
    ...     _ = table.write_text("node,x,y,z,direction\\n7,0,0,0,z\\n9,1,0,0,z\\n9,1,0,0,rx\\n", encoding="utf-8")
    ...     found = read_dof_table(table)
    >>> found.nodes.tolist(), found.components.tolist(), found.points.tolist()
    ([0, 1, 1], [2, 2, 3], [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    """
    lines = lines_of(path, content(path, LARGEST_TABLE, _DOF_TABLE))
    rows = [
        (number, [word.strip() for word in words])
        for number, words in enumerate(csv.reader(io.StringIO("\n".join(lines))), 1)
        if any(word.strip() for word in words)
    ]
    head = [word.lower() for word in rows[0][1]] if rows else []
    if set(head) >= _OF_EXPORT:
        name = path.name.removesuffix(".dofs.csv")
        do = f"write 'file: {name}.json' without 'nodes': it names all files of the export"
        raise wrong_line(path, rows[0][0], "the table of an export of femstruct", _DOF_TABLE, do)
    if sorted(head) != sorted(_HEAD):
        raise wrong_line(path, rows[0][0] if rows else 1, quote_value(", ".join(head)), _DOF_TABLE)
    short = next((number for number, words in rows[1:] if len(words) != len(head)), None)
    if short is not None or len(rows) < 2:
        raise wrong_line(path, short or 1, "a row of another length" if short else "no rows", _DOF_TABLE)
    node, direction = head.index("node"), head.index("direction")
    axes = [head.index(axis) for axis in "xyz"]
    places = floats(path, ((number, [words[axis] for axis in axes]) for number, words in rows[1:])).reshape(-1, 3)
    numbers: dict[str, int] = {}
    nodes, components, points = [], [], []
    near = _NEAR * float(np.ptp(places, axis=0).max())
    for (number, words), place in zip(rows[1:], places, strict=True):
        name = words[node]
        if name not in numbers:
            numbers[name] = len(numbers)
            points.append(place)
        elif np.abs(points[numbers[name]] - place).max() > near:
            raise wrong_line(path, number, f"a second place of node {name}", "one place of each node")
        nodes.append(numbers[name])
        components.append(_direction(path, number, words[direction]))
    twice = np.array(nodes) * len(DIRECTIONS) + np.array(components)
    _, first, times = np.unique(twice, return_index=True, return_counts=True)
    if (times > 1).any():
        again = int(np.flatnonzero(twice == twice[first[times > 1][0]])[1])
        raise wrong_line(path, rows[1 + again][0], "a direction of a node that is above", "each one once")
    return DofTable(np.array(nodes), np.array(components), np.array(points))


def _direction(path: Path, number: int, word: str) -> int:
    if word.lower() in DIRECTIONS:
        return DIRECTIONS.index(word.lower())
    if word in ("1", "2", "3", "4", "5", "6"):
        return int(word) - 1
    raise wrong_line(path, number, f"the direction {quote_value(word)}", "x, y, z, rx, ry, rz or 1 to 6")


def refuse_size(path: Path, table: DofTable, count: int, what: str) -> None:
    """Raise InputError where matrices have another number of degrees of freedom than a table has rows."""
    if len(table.nodes) != count:
        raise InputError(
            "", got=f"{len(table.nodes)} rows in '{path.name}'", expected=f"{count}, one for each row of {what}"
        )


# ----------------------------------------------------------------------------------------------------------------------
# Matrices of another program in HDF5: dense, or sparse by rows or columns as scipy, anndata and others keep them.
# ----------------------------------------------------------------------------------------------------------------------

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


# ----------------------------------------------------------------------------------------------------------------------
# M, C, K of another program: in a .npz, HDF5, OUTPUT4 of Nastran, or a file of Matrix Market for each of them.
# ----------------------------------------------------------------------------------------------------------------------

LARGEST_FOREIGN: Final = 4 * 2**30  # bytes of a file
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

    Parameters
    ----------
    files : Mapping[str, Path]
        One under "" that has all of them, or one of Matrix Market under each of M, K, C.
    table : Path | None
        Says which node and direction each degree of freedom is (`read_dof_table`); None where the file does.
    names : Mapping[str, str]
        Of M, K, C in an OP4 file, where they are not the usual ones.
    scale : float
        Metres in the unit of length; forces are in newtons, times in seconds.

    Raises
    ------
    InputError
        And what `given_matrices` raises.
    """
    one = files.get("")
    found = _of_one(one, names) if one is not None else {key: _market(path) for key, path in files.items()}
    subject = "the files" if one is None else f"'{one.name}'"
    missing = [name for name in WANTED[:2] if name not in found]
    if missing:
        raise InputError("", got=f"{subject} without {' and '.join(missing)}", expected=EXPECTED)
    count = found["M"].shape[0]
    if table is not None:
        if known := [name for name in _MAP if name in found]:
            got = f"a table of nodes beside {subject}, which has {', '.join(known)}"
            raise InputError("", got=got, expected="one of them", do="leave the table out")
        read = read_dof_table(table)
        refuse_size(table, read, count, "M")
    else:
        lacking = [name for name in _MAP if name not in found]
        if lacking:
            raise InputError(
                "",
                got=f"{subject} without {', '.join(lacking)}",
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
    data = content(path, LARGEST_FOREIGN, EXPECTED)
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
    read: dict[str, Any] = _read(path, lambda: _foreign_npz(data))
    return read


def _chosen(path: Path, found: Mapping[str, csc_array], names: Mapping[str, str]) -> dict[str, Any]:
    """Matrices of an OP4 file by the names that are given or usual."""
    chosen: dict[str, Any] = {}
    for key in WANTED:
        if key in names:
            if names[key].upper() not in found:
                got = f"'{names[key]}', no matrix of {path.name}"
                raise InputError("", got=got, expected=list_some(found))
            chosen[key] = found[names[key].upper()]
            continue
        usual = [name for name in USUAL[key] if name in found]
        if len(usual) > 1:
            got = f"{' and '.join(usual)} in '{path.name}'"
            raise InputError("", got=got, expected=f"which of them is {key}", do=f"write names: {{{key}: {usual[0]}}}")
        if usual:
            chosen[key] = found[usual[0]]
        elif key != "C":
            got = f"{list_some(found)} in '{path.name}'"
            raise InputError("", got=got, expected=f"which of them is {key}", do=f"write names: {{{key}: NAME}}")
    return chosen


def _foreign_npz(data: bytes) -> dict[str, Any]:
    with np.load(io.BytesIO(data), allow_pickle=False) as file:
        return {name: file[name] for name in (*WANTED, *_MAP) if name in file}


def _market(path: Path) -> csc_array:
    data = content(path, LARGEST_FOREIGN, "a matrix of Matrix Market (.mtx)")
    if not data.startswith(_MARKET):
        raise InputError("", got=f"'{path.name}', which does not begin with %%MatrixMarket", expected="a .mtx file")
    return csc_array(_read(path, lambda: mmread(io.BytesIO(data))))


def _read(path: Path, reader: Callable[[], Any]) -> Any:
    try:
        return reader()
    except (ValueError, TypeError, BadZipFile, EOFError, OSError, KeyError, OverflowError, MemoryError,
            NotImplementedError) as error:  # fmt: skip
        raise InputError("", got=f"'{path.name}', which cannot be read ({error})", expected=EXPECTED) from None


# ----------------------------------------------------------------------------------------------------------------------
# M, C, K of another program, or those that `femstruct export` and `femstruct reduce` wrote, from files.
# ----------------------------------------------------------------------------------------------------------------------

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

    Its shapes are those of all nodes of the model, joined and held ones, too. Forces of supports and the loss factors
    of single parts are not in such a file.

    Parameters
    ----------
    path : str | Path | Mapping[str, str | Path]
        Of another program a .npz of M, K and where there are dashpots C [n, n], nodes and components [n], points
        [n_nodes, 3], as `given_matrices` takes them; HDF5 with the same names, where a matrix may be a group of data,
        indices, indptr and shape; OUTPUT4 of Nastran (.op4, binary or text); or a file of Matrix Market under each of
        "M", "K", "C".
    nodes : str | Path | None
        A table of commas with the columns node, x, y, z, direction and a row for each degree of freedom, where the file
        has no map.
    names : Mapping[str, str] | None
        Of M, K, C in an OP4 file, where they are not the usual ones.
    scale : float
        Metres in the unit of length of another program; forces are in newtons, so masses are in t where lengths are in
        mm.

    Raises
    ------
    InputError
        For a file that is not there or is no such file, FemstructError for matrices that do not fit.

    Examples
    --------
    >>> from pathlib import Path
    >>> import tempfile
    >>> from femstruct import given_matrices, modal_basis
    >>> from femstruct.files.matrices_file import write_npz
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
        reason = f"without {error}" if isinstance(error, KeyError) else f"which cannot be read ({error})"
        raise InputError(str(path), got=f"'{path.name}', {reason}", expected=_WHAT) from None
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

    Parameters
    ----------
    sources : dict[str, str] | None
        Is given a digest of each file under its name.

    Raises
    ------
    InputError
        And what `read_matrices` raises.
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
    return Component(
        paths[0].name,
        M,
        C=C,
        K=K,
        motion=assembly.dofs.T,
        points=assembly.points,
        mass=assembly.total_mass,
        labels=labels,
        **more,
    )
