"""Datasets that explain themselves: unit, description, checksum and named axes on every one."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeGuard

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:  # slow to import, and most runs write no such file
    import h5py

CHUNK_BYTES = 2**20


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
) -> Any:
    """A dataset with unit, description and Fletcher-32 checksum, its axes attached to scales of the same group.

    values : numbers (complex ones are stored as compounds {r, i}) or strings (filters do not reach those: their SHA-256
    is the checksum). axes : one scale for each dimension, or none for a scale or a file of another's layout.
    """
    if _is_text(values):
        import h5py

        made = parent.create_dataset(key(name), data=values, dtype=h5py.string_dtype("utf-8"))
        made.attrs["sha256"] = digest("\n".join(values))
    else:
        array = np.asarray(values)
        filters = {"fletcher32": True, "chunks": _chunks(array)} if array.size else {}
        made = parent.create_dataset(key(name), data=array, **filters)
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


def _chunks(array: NDArray[Any]) -> tuple[int, ...]:
    """Chunks of at most CHUNK_BYTES, cut along the longest axes."""
    shape = list(array.shape)
    while np.prod(shape) * array.dtype.itemsize > CHUNK_BYTES:
        longest = int(np.argmax(shape))
        shape[longest] = -(-shape[longest] // 2)
    return tuple(shape)
