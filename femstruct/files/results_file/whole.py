"""What a study found as one value in the results file, and back: nouns as a text, arrays where they stand already."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from hashlib import sha256
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from femstruct.files.results_file.datasets import group, put, put_text
from femstruct.files.results_file.nouns import Stored, restored, stored

if TYPE_CHECKING:  # slow to import, and most runs write no such file
    import h5py

Array = NDArray[Any]
Place = tuple[str, int | None]  # a dataset, and the row of it that is meant, None for all of it
NOUNS: Final = "nouns"
NO_VARIABLE: Final = "This is a netCDF dimension but not a netCDF variable."  # says netCDF-4 of a bare length
SAMPLED: Final = 64  # numbers that arrays are told apart by at first sight
LEAST: Final = 4096  # bytes of a row of a table that may be an array of a noun


def write_whole(file: h5py.File, result: object, written: Mapping[str, Array]) -> None:
    """Add the nouns of what was found to its file; of their arrays only those that no table has yet, each once.

    written : the large arrays of its tables, by the names of their datasets.
    """
    tables = json.dumps(stored(result, _shelf(file, written)), allow_nan=False)
    put_text(file, NOUNS, tables, "The results as nouns (JSON)")


def read_whole(file: h5py.File) -> Any:
    """The nouns of what was found, as they were written."""
    read: dict[str, Array] = {}

    def fetch(place: Place) -> Array:
        name, row = place
        if name not in read:
            read[name] = file[name][()]
            read[name].flags.writeable = False
        return read[name] if row is None else read[name][row]

    return restored(Stored(*json.loads(file[NOUNS].asstr()[()])), fetch)


def _shelf(file: h5py.File, written: Mapping[str, Array]) -> Callable[[Array], Place]:
    """What finds an array among those of a file, or puts it there, and tells where."""
    known: dict[tuple[object, ...], list[tuple[Place, Array]]] = {}
    shelf = group(file, "arrays", "Arrays of the nouns that are in no table")

    def keep(array: Array) -> Place:
        array = np.ascontiguousarray(array)
        alike = known.setdefault(_print(array), [])
        for place, other in alike:
            if np.array_equal(_bytes(other), _bytes(array)):
                return place
        name = f"{len(shelf):06d}"
        axes = [_of_length(shelf, length) for length in array.shape]
        put(shelf, name, array, "as the noun's", "Array of a noun", axes)
        alike.append(((f"{shelf.name}/{name}", None), array))
        return alike[-1][0]

    for name, whole in written.items():
        known.setdefault(_print(whole), []).append(((name, None), whole))
        if whole.ndim > 1 and whole[0].nbytes >= LEAST:
            for number, row in enumerate(whole):
                known.setdefault(_print(row), []).append(((name, number), row))
    return keep


def _of_length(shelf: h5py.Group, length: int) -> str:
    """An axis without a meaning of its own."""
    name = f"of {length}"
    if name not in shelf:
        shelf.create_dataset(name, (length,), "i1").make_scale(NO_VARIABLE)  # takes no room: nothing is written to it
        shelf[name].attrs.update(unit="1", description="A length", sha256=sha256(bytes(length)).hexdigest())
    return name


def _bytes(array: Array) -> Array:
    """Its bytes: zeros of either sign, and nans, are told apart."""
    return np.ascontiguousarray(array).reshape(-1).view(np.uint8)


def _print(array: Array) -> tuple[object, ...]:
    """What alike arrays have in common, and others hardly: a few of their numbers, from end to end."""
    flat = array.reshape(-1)
    return array.dtype, array.shape, flat[:: max(1, flat.size // SAMPLED)].tobytes()
