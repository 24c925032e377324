"""Datasets that explain themselves, the checksum of a file, and mode shapes as ParaView reads them."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from io import BytesIO
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, TypeGuard

import numpy as np
from numpy.typing import ArrayLike, NDArray

from femstruct.arrays import Integers
from femstruct.conventions import N_COMPONENTS
from femstruct.errors import InputError
from femstruct.files.writing import replacing
from femstruct.modal.basis import ModalBasis
from femstruct.model.model import Model, Refined, refine_model
from femstruct.model.regions import node_rows

if TYPE_CHECKING:
    import h5py


# ----------------------------------------------------------------------------------------------------------------------
# A checksum behind the last byte of a results file, compared before any library opens the file.
# ----------------------------------------------------------------------------------------------------------------------

LIBVER: Final = ("earliest", "v110")  # what the HDF5 of ParaView, VTK and older viewers can read
_MARK: Final = b"\nfemstruct sha256 "
LENGTH: Final = len(_MARK) + 64 + 1
_AT_ONCE: Final = 2**20


def seal(image: memoryview) -> bytes:
    r"""What is written behind the bytes of a file; HDF5 reads nothing behind its own end.

    >>> seal(memoryview(b"abc"))[:26]
    b'\nfemstruct sha256 ba7816bf'
    """
    return _MARK + hashlib.sha256(image).hexdigest().encode() + b"\n"


def write_sealed(path: str | Path, write: Callable[[h5py.File], None]) -> None:
    """Write an HDF5 file that is, at every instant, complete or not there.

    Parameters
    ----------
    write : Callable[[h5py.File], None]
        Fills it.

    Raises
    ------
    FemstructError
        When the disk is full or refuses; the file that was there before is then untouched.

    Notes
    -----
    Made in memory, `complete = True` last: a disk that fills up while HDF5 itself writes leaves its library in a state
    that crashes the process; the price is the size of the file in memory.
    """
    import h5py

    image = BytesIO()
    with h5py.File(image, "w", libver=LIBVER) as file:
        write(file)
        file.flush()
        file.attrs["complete"] = True
    with replacing(path) as temporary, temporary.open("wb") as written:
        written.write(image.getbuffer())
        written.write(seal(image.getbuffer()))


def refuse_broken_seal(path: Path) -> None:
    """Raise InputError unless a file is, to the last byte, what was written.

    Notes
    -----
    HDF5 follows the addresses that a file holds, round and round where a damaged sector makes them a circle: it must
    not see a file that is not whole.
    """
    whole = hashlib.sha256()
    left = path.stat().st_size - LENGTH
    with path.open("rb") as file:
        while left > 0 and (block := file.read(min(left, _AT_ONCE))):
            whole.update(block)
            left -= len(block)
        found = file.read(LENGTH + 1)
    if not (found.startswith(_MARK) and len(found) == LENGTH):
        raise InputError(
            str(path),
            got="a file without its checksum at the end: cut short, changed, or of an older version",
            expected="a complete results file",
            do="run the study again",
        )
    if found[len(_MARK) : -1].decode("ascii", "replace") != whole.hexdigest():
        raise InputError(
            str(path),
            got="a damaged file: its bytes do not have the checksum at its end",
            expected="a complete results file",
            do="run the study again",
        )


# ----------------------------------------------------------------------------------------------------------------------
# Datasets that explain themselves: unit, description, checksum and named axes on every one.
# ----------------------------------------------------------------------------------------------------------------------

CHUNK_BYTES = 2**20
SMALL: Final = 4096  # bytes: in chunks of its own, which have an index, such an array would be larger than as it is
PACKED: Final = MappingProxyType({"shuffle": True, "compression": "gzip", "compression_opts": 4, "fletcher32": True})

_WRITTEN: Final[ContextVar[dict[str, NDArray[Any]] | None]] = ContextVar("_WRITTEN", default=None)


@contextmanager
def remember_arrays() -> Iterator[Mapping[str, NDArray[Any]]]:
    """The large arrays that are put to a file meanwhile, by the names of their datasets: nobody need read them again.

    >>> with remember_arrays() as written:
    ...     dict(written)
    {}
    """
    written: dict[str, NDArray[Any]] = {}
    before = _WRITTEN.set(written)
    try:
        yield written
    finally:
        _WRITTEN.reset(before)


def key(name: str) -> str:
    """A name as a name in the file, where a slash would open a group.

    >>> key("floor/slab") == "floor\\N{DIVISION SLASH}slab"
    True
    """
    return name.replace("/", "\N{DIVISION SLASH}")


def group(parent: h5py.Group, name: str, description: str, **attributes: object) -> h5py.Group:
    """A new group with a description and attributes; None is left out."""
    made = parent.create_group(key(name))
    made.attrs["description"] = description
    for attribute, value in attributes.items():
        if value is not None:
            made.attrs[attribute] = value
    return made


def axis(parent: h5py.Group, name: str, values: ArrayLike | Sequence[str], unit: str, description: str) -> str:
    """A dimension scale: a dataset whose values are the coordinates along an axis. Returns its name."""
    made = put(parent, name, values, unit, description, ())
    made.make_scale(name)
    return name


def put(
    parent: h5py.Group,
    name: str,
    values: ArrayLike | Sequence[str],
    unit: str,
    description: str,
    axes: Sequence[str],
    attributes: Mapping[str, object] | None = None,
    whole: int = -1,
) -> Any:
    """A dataset with unit, description and checksum, its axes attached to scales of the same group.

    Parameters
    ----------
    values : ArrayLike | Sequence[str]
        Numbers (complex ones are stored as compounds {r, i}) or strings. Large arrays are compressed without loss and
        have a Fletcher-32 checksum; of small ones, and of strings, which filters do not reach, the SHA-256 is an
        attribute.
    axes : Sequence[str]
        One scale for each dimension, or none for a scale or a file of another's layout.
    whole : int
        An axis that chunks are cut along last, along which numbers are most alike.
    """
    if _is_text(values):
        import h5py

        made = parent.create_dataset(key(name), data=values, dtype=h5py.string_dtype("utf-8"))
        made.attrs["sha256"] = digest("\n".join(values))
    else:
        array = np.asarray(values)
        filters = {**PACKED, "chunks": _chunks(array, whole)} if array.nbytes > SMALL else {}
        made = parent.create_dataset(key(name), data=array, **filters)
        if filters and (written := _WRITTEN.get()) is not None:
            written[made.name] = array
        if array.size and not filters:
            made.attrs["sha256"] = hashlib.sha256(array.tobytes()).hexdigest()
    made.attrs["unit"] = made.attrs["units"] = unit
    made.attrs["description"] = made.attrs["long_name"] = description
    for attribute, value in (attributes or {}).items():
        if value is not None:
            made.attrs[attribute] = value
    for dimension, scale in enumerate(axes):
        made.dims[dimension].attach_scale(parent[scale])
    return made


def put_text(parent: h5py.Group, name: str, text: str, description: str, **attributes: object) -> None:
    """A text of any length, with its SHA-256 as the checksum."""
    import h5py

    made = parent.create_dataset(key(name), data=text, dtype=h5py.string_dtype("utf-8"))
    made.attrs.update(unit="1", description=description, sha256=digest(text), **attributes)


def digest(text: str) -> str:
    """SHA-256 of a text, hexadecimal."""
    return hashlib.sha256(text.encode()).hexdigest()


def _is_text(values: object) -> TypeGuard[Sequence[str]]:
    return isinstance(values, list | tuple) and bool(values) and all(isinstance(value, str) for value in values)


def _chunks(array: NDArray[Any], whole: int) -> tuple[int, ...]:
    """Chunks of at most CHUNK_BYTES, cut along the longest axes; beside a `whole` one, along the shortest first."""
    shape = list(array.shape)
    while np.prod(shape) * array.dtype.itemsize > CHUNK_BYTES:
        others = [axis for axis, length in enumerate(shape) if length > 1 and axis != whole]
        cut = int(np.argmax(shape)) if whole < 0 else min(others, key=shape.__getitem__, default=whole)
        shape[cut] = -(-shape[cut] // 2)
    return tuple(shape)


# ----------------------------------------------------------------------------------------------------------------------
# Mode shapes as a VTKHDF group, which ParaView and VTK open.
# ----------------------------------------------------------------------------------------------------------------------

VERSION: Final = (2, 2)
VTK_VERTEX, VTK_LINE, VTK_QUAD = 1, 3, 9
DIVISIONS: Final = 3


def mode_name(basis: ModalBasis, mode: int) -> str:
    """Name of a mode, counted from 0, by its number counted from 1 and its frequency.

    It sorts in the order of the modes.
    """
    return f"mode {mode + 1:02d} {basis.frequency_hz[mode]:.2f} Hz"


def write_vtkhdf(file: h5py.File, basis: ModalBasis, model: Model | None, *, count: int = 40) -> None:
    """Add the group /VTKHDF: the structure as an unstructured grid, its first `count` modes as vectors at its points.

    Plates are subdivided with their own shape functions and bars with theirs, so a warped mode is smooth; a basis in
    closed form (model None) is its points. The vectors are mass-normalised displacements [1/sqrt(kg)], single
    precision.

    References: VTK File Formats, "VTKHDF File Format", version 2.2, UnstructuredGrid.
    """
    shown = nodes_alone(basis) if model is None else refine_model(model, DIVISIONS)
    target = file.create_group("VTKHDF")
    target.attrs["Version"] = np.array(VERSION, dtype=np.int64)
    kind = b"UnstructuredGrid"
    import h5py

    target.attrs.create("Type", kind, dtype=h5py.string_dtype("ascii", len(kind)))
    target.attrs["description"] = "Mode shapes of the baseline on its subdivided elements"
    _write_cells(target, shown)
    put(target, "NumberOfPoints", np.array([len(shown.points)]), "1", "Number of points", ())
    put(target, "Points", shown.points, "m", "Points at rest", ())
    data = target.create_group("PointData")
    modes = range(min(count, basis.modes.stop))
    moved = shown.displacement(basis.shapes[:, :, : len(modes)])
    for mode in modes:
        values = np.ascontiguousarray(moved[:, :, mode], dtype=np.float32)
        put(data, mode_name(basis, mode), values, "kg^-0.5", "Mass-normalised displacement", ())
    fields = target.create_group("FieldData")
    put(fields, "frequency_hz", basis.frequency_hz[: len(modes)], "Hz", "Natural frequencies of the shown modes", ())
    put(fields, "damping_ratio", basis.damping_ratio[: len(modes)], "1", "Damping ratios of the shown modes", ())


def nodes_alone(basis: ModalBasis) -> Refined:
    """The nodes alone, for a basis in closed form, which has no elements."""
    count = len(basis.points)
    translations = np.tile(np.eye(3, N_COMPONENTS), (count, 1))
    return Refined(
        basis.points,
        np.empty((0, 4), dtype=np.int64),
        np.empty((0, 2), dtype=np.int64),
        node_rows(np.repeat(np.arange(count), 3), translations, count),
        ("structure",),
        np.zeros(count, dtype=np.int64),
    )


def _write_cells(target: h5py.Group, shown: Refined) -> None:
    drawn = np.concatenate([shown.quads.ravel(), shown.lines.ravel()])
    lone: Integers = np.setdiff1d(np.arange(len(shown.points)), drawn)
    connectivity = np.concatenate([drawn, lone])
    counts = (len(shown.quads), len(shown.lines), len(lone))
    sizes, types = np.repeat([4, 2, 1], counts), np.repeat([VTK_QUAD, VTK_LINE, VTK_VERTEX], counts)
    offsets = np.concatenate([[0], np.cumsum(sizes)])
    put(target, "Connectivity", connectivity, "1", "Points of the cells", ())
    put(target, "Offsets", offsets, "1", "Where each cell starts", ())
    put(target, "Types", types.astype(np.uint8), "1", "Kinds of cells, VTK's numbers", ())
    put(target, "NumberOfCells", np.array([len(types)]), "1", "Number of cells", ())
    put(target, "NumberOfConnectivityIds", np.array([len(connectivity)]), "1", "Length of Connectivity", ())
    cells = target.create_group("CellData")
    part = shown.part_of_point[connectivity[offsets[:-1]]]
    put(cells, "part", part, "1", f"Part, by number: {', '.join(shown.parts)}", ())
