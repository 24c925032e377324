"""Any frozen value as plain tables, its large arrays beside them, and whole back again.

What a study found is a tree of frozen dataclasses: whoever adds a field to one of them finds it in the results file and
in what is read from it, without a line here.
"""

from __future__ import annotations

import dataclasses
import importlib
from collections.abc import Callable, Mapping
from enum import Enum
from functools import cache
from importlib.metadata import entry_points
from math import isfinite
from types import MappingProxyType
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from femstruct.errors import FemstructError

Array = NDArray[Any]
Keep = Callable[[Array], object]  # puts an array somewhere, tells where
Fetch = Callable[[Any], Array]  # finds it there again

INLINE: Final = 128  # numbers of an array that stands in the tables themselves
_CLASS: Final = "is"  # no field of a dataclass can have this name
_OURS: Final = ("femstruct", "acoustics")
_GROUPS: Final = (  # of packages that add nouns
    "femstruct.evaluations",
    "femstruct.laws",
    "femstruct.language.evaluations",
    "femstruct.language.laws",
    "femstruct.language.parts",
    "femstruct.language.rooms",
)


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
            return {"enum": [_name(type(one)), one.name]}
        if isinstance(one, complex):
            return {"complex": [table(one.real), table(one.imag)]}
        if callable(one):
            return {"function": _name(one) if hasattr(one, "__qualname__") else _name(type(one))}
        raise FemstructError("results", got=f"a {type(one).__qualname__}", expected="nouns, numbers, texts, arrays")

    def noun(one: Any) -> int:
        if id(one) not in known:
            names = getattr(one, "_fields", None) or [field.name for field in dataclasses.fields(one)]
            nouns.append({_CLASS: _name(type(one))} | {name: table(getattr(one, name)) for name in names})
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
        fields = {name: value(item) for name, item in told.items() if name != _CLASS}
        nouns.append(_made(_class(told[_CLASS]), fields))
    return value(tables.value)


def _made(kind: type, fields: Mapping[str, Any]) -> Any:
    """A noun as it was: what its making checks and derives has been checked and derived."""
    if hasattr(kind, "_fields"):
        return kind(**fields)
    made: object = object.__new__(kind)
    for name, item in (_left_out(kind) | dict(fields)).items():
        object.__setattr__(made, name, item)
    return made


@cache
def _defaults(kind: Any) -> tuple[tuple[str, Callable[[], Any]], ...]:
    made = ((field.name, field.default_factory) for field in dataclasses.fields(kind))
    return tuple((name, factory) for name, factory in made if factory is not dataclasses.MISSING)


def _left_out(kind: type) -> dict[str, Any]:
    """What fields are when a file that is older than they are says nothing of them; plain defaults are the class's."""
    return {name: factory() for name, factory in _defaults(kind)}


def _name(kind: Any) -> str:
    return f"{kind.__module__}:{kind.__qualname__}"


def _class(name: str) -> type:
    """A class of a noun by its name.

    >>> _class("femstruct.errors:Finding").__name__
    'Finding'
    """
    found = _found(name)
    nouns = isinstance(found, type) and (
        dataclasses.is_dataclass(found) or hasattr(found, "_fields") or issubclass(found, Enum)
    )
    if not nouns:
        raise FemstructError("results", got=f"'{name}'", expected="a noun")
    kind: type = found
    return kind


def _found(name: str) -> Any:
    """What has a name in this project, or in a package that adds parts or laws to it: nothing else is imported."""
    module, _, word = name.partition(":")
    package = module.partition(".")[0]
    if package not in _OURS and package not in _added():
        raise FemstructError(
            "results", got=f"'{name}'", expected="nouns of femstruct", do=f"install the package '{package}'"
        )
    found: Any = importlib.import_module(module)
    for part in word.split("."):
        found = getattr(found, part)
    return found


def _added() -> set[str]:
    points = [point for group in _GROUPS for point in entry_points(group=group)]
    return {point.module.partition(".")[0] for point in points}


def _small(told: Any, value: Callable[[Any], Any]) -> Array:
    kind, shape, numbers = told
    made = np.array([value(number) for number in numbers], dtype=kind).reshape(shape)
    made.flags.writeable = False
    return made


def _rows(told: Any, value: Callable[[Any], Any]) -> csr_array:
    data, indices, starts, shape = (value(part) for part in told)
    return csr_array((data, indices, starts), shape=shape)


def _function(name: str, value: Callable[[Any], Any]) -> Callable[..., Any]:
    """A function of this project; of anybody else's, what says that it is not in the file."""
    if name.partition(".")[0] in _OURS and "<" not in name:
        found: Callable[..., Any] = _found(name)
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
        "enum": lambda told, value: _class(told[0])[told[1]],  # type: ignore[index]
        "complex": lambda told, value: complex(*map(value, told)),
        "function": _function,
    }
)
