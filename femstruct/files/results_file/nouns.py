"""Any frozen value as plain tables, its large arrays beside them, and whole back again.

What a study found is a tree of frozen dataclasses: whoever adds a field to one of them finds it in the results file and
in what is read from it, without a line here.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from enum import Enum
from functools import cache, partial
from math import isfinite
from types import MappingProxyType
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from femstruct.errors import FemstructError
from femstruct.files.results_file.tagged.format_4 import tag_of_format_4
from femstruct.files.results_file.tagged.kinds_by_tag import NEWER, is_noun, kind_of, tag_of
from femstruct.files.results_file.unread import NotKept

Array = NDArray[Any]
Keep = Callable[[Array], object]  # puts an array somewhere, tells where
Fetch = Callable[[Any], Array]  # finds it there again

INLINE: Final = 128  # numbers of an array that stands in the tables themselves
_CLASS: Final = "is"  # no field of a dataclass can have this name


class Stored(NamedTuple):
    """A value in tables: every noun once, after those that it is made of, and the value in terms of them."""

    nouns: list[dict[str, Any]]
    value: Any


def stored(value: object, keep: Keep) -> Stored:
    """A value made of dataclasses, named tuples, mappings, sequences, numbers, texts and arrays, ready for JSON.

    keep : is given each array of more than a few numbers.

    A noun that occurs twice is written once, and is one noun again when it is read. Of a function that
    is not of this project only the name is kept, as of a contact law of somebody's own.

    >>> from femstruct.errors import Finding
    >>> tables = stored([Finding("mechanism", "It moves.", {"share": float("nan")})], keep=lambda array: None)
    >>> restored(tables, fetch=lambda place: None)
    [Finding(code='mechanism', message='It moves.', values={'share': nan}, severe=False)]
    """
    nouns: list[dict[str, Any]] = []
    known: dict[int, int] = {}

    def table(one: Any) -> Any:
        if one is None or (isinstance(one, bool | int | str) and not isinstance(one, Enum)):
            return one
        if isinstance(one, float | np.floating):
            return float(one) if isfinite(one) else {"float": str(float(one))}
        if isinstance(one, np.generic):
            return table(one.item())
        if isinstance(one, np.ndarray):
            if one.size > INLINE:
                return {"array": keep(one)}
            return {"small": [str(one.dtype), one.shape, [table(number) for number in one.ravel().tolist()]]}
        if isinstance(one, NotKept):
            return {"not kept": one.what}
        if dataclasses.is_dataclass(one) or hasattr(one, "_fields"):
            return {"noun": noun(one)}
        return other(one)

    def other(one: Any) -> Any:
        if isinstance(one, Mapping):
            kind = "view" if isinstance(one, MappingProxyType) else "map"
            return {kind: [[table(key), table(item)] for key, item in one.items()]}
        if isinstance(one, tuple):
            return [table(item) for item in one]
        if isinstance(one, list | set | frozenset):
            return {type(one).__name__: [table(item) for item in one]}
        if isinstance(one, csr_array):
            return {"rows": [table(part) for part in (one.data, one.indices, one.indptr, one.shape)]}
        if isinstance(one, Enum):
            return {"enum": [tag_of(type(one)), one.name]}
        if isinstance(one, complex):
            return {"complex": [table(one.real), table(one.imag)]}
        if callable(one):
            return {"function": tag_of(one if hasattr(one, "__qualname__") else type(one))}
        raise FemstructError("results", got=f"a {type(one).__qualname__}", expected="nouns, numbers, texts, arrays")

    def noun(one: Any) -> int:
        if id(one) not in known:
            names = getattr(one, "_fields", None) or [field.name for field in dataclasses.fields(one)]
            nouns.append({_CLASS: tag_of(type(one))} | {name: table(getattr(one, name)) for name in names})
            known[id(one)] = len(nouns) - 1
        return known[id(one)]

    told = table(value)
    return Stored(nouns, told)


def restored(tables: Stored, fetch: Fetch) -> Any:
    """The value that was stored; arrays are read-only.

    Raises FemstructError for a class that is neither of this project nor of a package that adds to it.
    """
    nouns: list[Any] = []

    def value(told: Any) -> Any:
        if isinstance(told, list):
            return tuple(value(item) for item in told)
        if not isinstance(told, dict):
            return told
        ((kind, inside),) = told.items()
        return _READ[kind](inside, value) if kind in _READ else nouns[inside] if kind == "noun" else fetch(inside)

    for told in tables.nouns:
        fields: Mapping[str, Any] = {name: value(item) for name, item in told.items() if name != _CLASS}
        tag = tag_of_format_4(told[_CLASS]) or told[_CLASS]
        while tag in NEWER:
            tag, fields = NEWER[tag].tag, NEWER[tag].fields(fields)
        nouns.append(_made(tag, fields))
    return value(tables.value)


def _made(tag: str, fields: Mapping[str, Any]) -> Any:
    """A noun as it was: what its making checks and derives has been checked and derived.

    Fields that the file does not have are their defaults; those that the noun has no more are passed over.
    """
    kind = _class(tag)
    names, defaults = _fields(kind)
    told = {name: make() for name, make in defaults if name not in fields}
    told |= {name: item for name, item in fields.items() if name in names}
    if lacking := names - set(told):
        raise FemstructError("results", got=f"a '{tag}' without {', '.join(sorted(lacking))}", expected="all fields")
    if hasattr(kind, "_fields"):
        return kind(**told)
    made: object = object.__new__(kind)
    for name, item in told.items():
        object.__setattr__(made, name, item)
    return made


@cache
def _fields(kind: Any) -> tuple[frozenset[str], tuple[tuple[str, Callable[[], Any]], ...]]:
    """The names of all fields, and what makes those that need not be given."""
    if hasattr(kind, "_fields"):
        plain = kind._field_defaults
        return frozenset(kind._fields), tuple((name, partial(_same, plain[name])) for name in plain)
    made = []
    for field in dataclasses.fields(kind):
        if field.default_factory is not dataclasses.MISSING:
            made.append((field.name, field.default_factory))
        elif field.default is not dataclasses.MISSING:
            made.append((field.name, partial(_same, field.default)))
    return frozenset(field.name for field in dataclasses.fields(kind)), tuple(made)


def _same(value: Any) -> Any:
    return value


def _class(tag: str) -> Any:
    """A class of nouns by its tag.

    >>> _class("finding/1").__name__
    'Finding'
    """
    found = kind_of(tag)
    if not is_noun(found):
        raise FemstructError("results", got=f"'{tag}'", expected="a noun")
    return found


def _small(told: Any, value: Callable[[Any], Any]) -> Array:
    kind, shape, numbers = told
    made = np.array([value(number) for number in numbers], dtype=kind).reshape(shape)
    made.flags.writeable = False
    return made


def _rows(told: Any, value: Callable[[Any], Any]) -> csr_array:
    data, indices, starts, shape = (value(part) for part in told)
    return csr_array((data, indices, starts), shape=shape)


def _function(name: str, value: Callable[[Any], Any]) -> Callable[..., Any]:
    """A function with a tag; of any other what says that it is not in the file."""
    if "/" in name or tag_of_format_4(name):
        found: Callable[..., Any] = kind_of(name)
        return found

    def function(*_: object) -> Any:
        raise FemstructError(
            name,
            got="a function of which a results file has only the name",
            expected="itself",
            do="run the study again",
        )

    function.__module__, _, function.__qualname__ = name.partition(":")
    return function


def _member(told: Any, value: Callable[[Any], Any]) -> Enum:
    kind, name = told
    member: Enum = _class(kind)[name]
    return member


_READ: Final[Mapping[str, Callable[[Any, Callable[[Any], Any]], Any]]] = MappingProxyType(
    {
        "float": lambda told, value: float(told),
        "small": _small,
        "map": lambda told, value: {value(key): value(item) for key, item in told},
        "view": lambda told, value: MappingProxyType({value(key): value(item) for key, item in told}),
        "list": lambda told, value: [value(item) for item in told],
        "set": lambda told, value: {value(item) for item in told},
        "frozenset": lambda told, value: frozenset(value(item) for item in told),
        "rows": _rows,
        "enum": _member,
        "complex": lambda told, value: complex(*map(value, told)),
        "function": _function,
        "not kept": lambda told, value: NotKept(told),
    }
)
