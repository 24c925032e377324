"""Nouns as tables of what they report: for JSON, for HDF5, for spreadsheets. Nothing here knows any of them."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from femstruct.files.datasets import axis, group, put
from femstruct.files.tables import finding_table, label, number
from femstruct.reported import OWN_UNIT, Reported, holdings, reported

if TYPE_CHECKING:
    import h5py


ByHand = Mapping[str, Callable[["h5py.Group", Any], None]]  # keys whose group has a layout of its own
_NONE_BY_HAND: Final[ByHand] = MappingProxyType({})


class DescribedEntry(NamedTuple):
    """One of the things that a noun reports."""

    name: str
    report: Reported
    value: Any

    @property
    def key(self) -> str:
        """Its name in JSON."""
        return self.report.key or self.name


def entries(noun: Any) -> Iterator[DescribedEntry]:
    """All that a noun reports, in the order of its fields and properties."""
    kind: object = type(noun)
    for name, entry in reported(kind).items():
        unit = getattr(noun, "unit", entry.unit) if entry.unit == OWN_UNIT else entry.unit
        yield DescribedEntry(name, entry._replace(unit=unit), getattr(noun, name))


def describe(noun: Any) -> dict[str, Any]:
    """What a noun reports as a table for JSON, with the nouns that it holds; histories and spectra are left to the
    results file.

    >>> from femstruct.impact.numerical_error import Resolved
    >>> describe(Resolved(2.0, 0.5, 10.0))
    {'value': 2.0, 'error': 0.5, 'scale': 10.0, 'relative': 0.05}
    """
    table: dict[str, Any] = {}
    for one in entries(noun):
        if isinstance(one.value, Mapping) and one.report.axis is None:
            table |= _plain(one.value)  # what is reported has names of its own
        elif not isinstance(one.value, np.ndarray):
            table[one.key] = _plain(one.value)
    return table | {key: _held(value) for key, _, value in holdings(noun)}


def _held(value: Any) -> dict[str, Any] | None:
    if isinstance(value, Mapping):
        return {name: describe(one) for name, one in value.items()}
    return None if value is None else describe(value)


def columns(nouns: Sequence[Any]) -> dict[str, list[Any]]:
    """The same of several nouns of one kind: a list for each number."""
    rows = [describe(noun) for noun in nouns]
    return {key: [row[key] for row in rows] for key in (rows[0] if rows else {})}


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key if isinstance(key, str) else label(key): _plain(item) for key, item in value.items()}
    if isinstance(value, tuple | list):
        return [_plain(item) for item in value]
    return value if isinstance(value, bool | int | str) else number(value)


def write_described(target: h5py.Group, noun: Any, by_hand: ByHand = _NONE_BY_HAND) -> None:
    """What a noun reports in a group: numbers and findings as attributes, mappings and arrays as datasets with their
    axes, the nouns that it holds as groups.

    Parameters
    ----------
    by_hand : ByHand
        By the key of what it holds, what fills its group instead. Axes of arrays that are not in the group are numbered
        from 1.
    """
    for name, entry, value in entries(noun):
        if isinstance(value, Mapping):
            assert entry.axis is not None, "a mapping in a group of its own has an axis"
            if entry.axis[0] not in target:
                axis(target, entry.axis[0], list(value), *entry.axis[1:])
            put(target, name, list(value.values()), entry.unit, entry.long_name, entry.axis[:1])
        elif isinstance(value, np.ndarray):
            if entry.along == (name,):
                axis(target, name, value, entry.unit, entry.long_name)
                continue
            for along, length in zip(entry.along, value.shape, strict=True):
                if along not in target:
                    axis(target, along, np.arange(1, length + 1), "1", "Number")
            put(target, name, value, entry.unit, entry.long_name, entry.along)
        elif value is not None:
            target.attrs[name] = list(value) if isinstance(value, tuple) else value
    if (findings := getattr(noun, "findings", None)) is not None:
        target.attrs["findings"] = json.dumps([finding_table(one) for one in findings], allow_nan=False)
    write_held(target, noun, by_hand)


def write_held(target: h5py.Group, noun: Any, by_hand: ByHand = _NONE_BY_HAND) -> None:
    """The nouns that a noun holds, a group for each key that has any.

    Parameters
    ----------
    by_hand : ByHand
        As of `write_described`.
    """
    for key, holding, value in holdings(noun):
        if not value:
            continue
        place = group(target, key, holding.long_name)
        if key in by_hand:
            by_hand[key](place, value)
        elif not isinstance(value, Mapping):
            write_described(place, value, by_hand)
        elif holding.rows is not None:
            write_rows(place, list(value.values()), axis(place, holding.rows[0], list(value), *holding.rows[1:]))
        else:
            for name, one in value.items():
                write_described(group(place, name, holding.each), one, by_hand)


def write_rows(target: h5py.Group, nouns: Sequence[Any], row: str) -> None:
    """What several nouns of one kind report, a dataset for each number: a row a noun, named by the axis `row`.

    Axes of their histories are those of the same name in the group.
    """
    kind: object = type(nouns[0])
    for name, entry in reported(kind).items():
        values = [getattr(noun, name) for noun in nouns]
        if isinstance(values[0], np.ndarray):
            put(target, name, np.array(values), entry.unit, entry.long_name, (row, *entry.along))
        elif isinstance(values[0], Mapping):
            for part in dict.fromkeys(part for value in values for part in value):
                column = [value.get(part) for value in values]
                put(target, part, _column(column), entry.unit, entry.long_name, (row,))
        else:
            put(target, name, _column(values), entry.unit, entry.long_name, (row,))


def _column(values: list[Any]) -> list[Any]:
    """Numbers that do not exist are nan, texts "" ."""
    texts = any(isinstance(value, str) for value in values)
    return [("" if texts else np.nan) if value is None else value for value in values]
