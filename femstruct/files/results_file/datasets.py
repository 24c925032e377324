"""Datasets that explain themselves: unit, description, checksum and named axes on every one."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, TypeGuard

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:  # slow to import, and most runs write no such file
    import h5py

CHUNK_BYTES = 2**20
SMALL: Final = 4096  # bytes: in chunks of its own, which have an index, such an array would be larger than as it is
PACKED: Final = MappingProxyType({"shuffle": True, "compression": "gzip", "compression_opts": 4, "fletcher32": True})

_WRITTEN: Final[ContextVar[dict[str, NDArray[Any]] | None]] = ContextVar("_WRITTEN", default=None)


@contextmanager
def remembered() -> Iterator[Mapping[str, NDArray[Any]]]:
    """The large arrays that are put to a file meanwhile, by the names of their datasets: nobody need read them again.

    >>> with remembered() as written:
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

    values : numbers (complex ones are stored as compounds {r, i}) or strings. Large arrays are compressed without loss
    and have a Fletcher-32 checksum; of small ones, and of strings, which filters do not reach, the SHA-256 is an
    attribute. axes : one scale for each dimension, or none for a scale or a file of another's layout.
    whole : an axis that chunks are cut along last, along which numbers are most alike.
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
