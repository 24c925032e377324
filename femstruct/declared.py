"""Nouns whose fields are what they are declared to be: a wrong type or shape is refused where a noun is made."""

from __future__ import annotations

import builtins
import collections.abc
import math
import sys
import types
from collections.abc import Callable, Mapping
from dataclasses import fields
from functools import cache
from inspect import get_annotations
from typing import Annotated, Any, Final, Literal, NamedTuple, TypeVar, Union, get_args, get_origin

import numpy as np

from femstruct.errors import InputError, cut
from femstruct.units import DIMENSIONS, QuantityError, quantity_of

T = TypeVar("T")


class Bound(NamedTuple):
    """Annotation of a number within limits, in words."""

    words: str
    holds: Callable[[Any], bool]


Positive = Annotated[float, Bound("a positive number", lambda value: value > 0)]
NotNegative = Annotated[float, Bound("a number >= 0", lambda value: value >= 0)]
Count = Annotated[int, Bound("a whole number from 1", lambda value: value >= 1)]
_WRONG: Final = object()
_SHOWN: Final = 80  # characters of a value


class _Kind(NamedTuple):
    """What a field may hold, as words for one and for many; kept : the value as the noun keeps it, or _WRONG."""

    one: str
    many: str
    kept: Callable[[Any], Any]


def checked(group: str, **expected: str) -> Callable[[type[T]], type[T]]:
    """Decorator of a frozen dataclass, below ``@dataclass``: before its own ``__post_init__`` every field is compared
    with its annotation.

    A list or an array where a tuple is declared becomes one; numbers are finite. group : of the noun's name in
    messages. expected : of fields whose annotation does not say all; {value} in it is what was got.

    Raises InputError, as do all nouns: the field, what was got, what was expected.

    >>> from dataclasses import dataclass
    >>> @dataclass(frozen=True)
    ... @checked("parts")
    ... class Slab:
    ...     name: str
    ...     size: tuple[float, float]
    >>> Slab("floor", [5.0, 4.0]).size
    (5.0, 4.0)
    >>> Slab("floor", (5.0,))
    Traceback (most recent call last):
    ...
    femstruct.errors.InputError: parts.floor.size: got (5.0,), expected a tuple of 2 numbers
    """

    def decorate(kind: type[T]) -> type[T]:
        further: Callable[[Any], None] | None = vars(kind).get("__post_init__")

        def compared(self: Any) -> None:
            _compare(self, group, expected)
            if further is not None:
                further(self)

        kind.__post_init__ = compared  # type: ignore[attr-defined]  # dataclass calls it
        return kind

    return decorate


def expect(where: str, value: Any, kind: Any, do: str = "") -> Any:
    """An argument of a function, compared with its annotation as `checked` compares fields; a list becomes a tuple.

    do : what to write instead. Raises InputError: where, what was got, what was expected.

    >>> expect("modes count", 3, int | None)
    3
    >>> expect("modes count", 2.5, int | None)
    Traceback (most recent call last):
    ...
    femstruct.errors.InputError: modes count: got 2.5, expected a whole number or None
    """
    declared = _argument(kind)
    kept = declared.kept(value)
    if kept is _WRONG:
        raise InputError(where, got=_shown(value), expected=declared.one, do=do or _plain(value, declared))
    return kept


def _compare(noun: Any, group: str, expected: Mapping[str, str]) -> None:
    for name, kind in _kinds(noun.__class__).items():
        value = getattr(noun, name)
        kept = kind.kept(value)
        if kept is _WRONG:
            called = getattr(noun, "name", None)
            where = ".".join(one for one in (group, called, name) if isinstance(one, str))
            words = expected.get(name, kind.one).format(value=_shown(value))
            raise InputError(where, got=_shown(value), expected=words, do=_plain(value, kind))
        if kept is not value:
            object.__setattr__(noun, name, kept)


def _shown(value: object) -> str:
    words = f"a {type(value).__name__}" if type(value).__repr__ is object.__repr__ else repr(value)
    return cut(" ".join(words.split()), _SHOWN)


def _plain(value: object, kind: _Kind) -> str:
    """What to write instead of a quantity with a unit."""
    if not isinstance(value, str) or kind.kept(1.0) is _WRONG:
        return ""
    try:
        return f"write a number in SI units: {quantity_of(value, tuple(DIMENSIONS))[0]:g}"
    except QuantityError:
        return ""


@cache
def _kinds(noun: Any) -> dict[str, _Kind]:
    """What the fields of a noun may hold, by name."""
    declared: dict[str, Any] = {}
    for one in reversed(noun.__mro__):
        declared |= get_annotations(one, eval_str=True, locals=_Names(vars(sys.modules[one.__module__])))
    return {field.name: _kind(declared[field.name]) for field in fields(noun) if field.init}


@cache
def _argument(annotation: Any) -> _Kind:
    return _kind(annotation)


class _Later:
    """Stands for a class that is imported for type checkers alone: compared by its name."""


class _Names(dict[str, Any]):
    def __missing__(self, name: str) -> Any:
        return getattr(builtins, name, None) or type(name, (_Later,), {})


def _kind(annotation: Any) -> _Kind:
    origin, inside = get_origin(annotation), get_args(annotation)
    if annotation in _PLAIN:
        return _PLAIN[annotation]
    if origin is Annotated:
        bound = next((one for one in inside[1:] if isinstance(one, Bound)), None)
        return _kind(inside[0]) if bound is None else _bounded(_kind(inside[0]), bound)
    if origin is Literal:
        words = " or ".join(map(str, inside))
        return _Kind(words, words, lambda value: value if _is_one_of(value, inside) else _WRONG)
    if origin in (Union, types.UnionType):
        return _either([_kind(one) for one in inside])
    if origin is tuple:
        return _several(inside[0]) if inside[-1] is Ellipsis else _fixed([_kind(one) for one in inside])
    if origin is np.ndarray:
        return _Kind("an array of numbers", "arrays of numbers", _array)
    if origin is collections.abc.Callable:
        return _Kind("a function", "functions", lambda value: value if callable(value) else _WRONG)
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return _mapping(_kind(inside[0]), _kind(inside[1]))
    kind = origin or annotation
    if isinstance(kind, type) and issubclass(kind, _Later):
        return _named(kind, lambda value: kind.__name__ in [one.__name__ for one in type(value).__mro__])
    if isinstance(kind, type) and not getattr(kind, "_is_protocol", False):
        return _named(kind, lambda value: isinstance(value, kind))
    return _Kind("anything", "anything", lambda value: value)


def _named(kind: type, fits: Callable[[Any], bool]) -> _Kind:
    article = "an" if kind.__name__[0] in "AEIO" else "a"
    return _Kind(f"{article} {kind.__name__}", kind.__name__, lambda value: value if fits(value) else _WRONG)


def _bounded(kind: _Kind, bound: Bound) -> _Kind:
    def kept(value: Any) -> Any:
        read = kind.kept(value)
        return read if read is not _WRONG and bound.holds(read) else _WRONG

    return _Kind(bound.words, kind.many, kept)


def _is_one_of(value: object, words: tuple[object, ...]) -> bool:
    return isinstance(value, str | int) and value in words


def _either(kinds: list[_Kind]) -> _Kind:
    def kept(value: Any) -> Any:
        return next((read for kind in kinds if (read := kind.kept(value)) is not _WRONG), _WRONG)

    return _Kind(" or ".join(kind.one for kind in kinds), " or ".join(kind.many for kind in kinds), kept)


def _several(annotation: Any) -> _Kind:
    kind = _kind(annotation)
    noun = isinstance(annotation, type) and annotation not in _PLAIN
    example = f", ({kind.many}(...),) for one" if noun else ""

    def kept(value: Any) -> Any:
        rows = _rows(value)
        return rows if rows is _WRONG else _all(rows, [kind] * len(rows))

    return _Kind(f"a tuple of {kind.many}{example}", f"tuples of {kind.many}", kept)


def _fixed(kinds: list[_Kind]) -> _Kind:
    def kept(value: Any) -> Any:
        rows = _rows(value)
        return _WRONG if rows is _WRONG or len(rows) != len(kinds) else _all(rows, kinds)

    words = f"{len(kinds)} {kinds[0].many}"
    if len(set(kinds)) > 1:
        words = f"{len(kinds)} values: {', '.join(kind.one for kind in kinds)}"
    return _Kind(f"a tuple of {words}", f"tuples of {words}", kept)


def _rows(value: Any) -> Any:
    rows = value.tolist() if isinstance(value, np.ndarray) else value
    return rows if isinstance(rows, tuple) else tuple(rows) if isinstance(rows, list) else _WRONG


def _all(rows: tuple[Any, ...], kinds: list[_Kind]) -> Any:
    read = tuple(kind.kept(one) for kind, one in zip(kinds, rows, strict=True))
    same = all(new is old for new, old in zip(read, rows, strict=True))
    return _WRONG if any(one is _WRONG for one in read) else rows if same else read


def _mapping(key: _Kind, item: _Kind) -> _Kind:
    def kept(value: Any) -> Any:
        if not isinstance(value, Mapping):
            return _WRONG
        read = {key.kept(name): item.kept(one) for name, one in value.items()}
        if any(name is _WRONG or one is _WRONG for name, one in read.items()):
            return _WRONG
        return value if all(read.get(name) is one for name, one in value.items()) else read

    words = f"of {item.many} by {key.one.removeprefix('a ')}"
    return _Kind(f"a mapping {words}", f"mappings {words}", kept)


def _number(value: Any) -> Any:
    if not isinstance(value, int | float | np.integer | np.floating) or isinstance(value, bool):
        return _WRONG
    try:
        return value if math.isfinite(value) else _WRONG
    except OverflowError:
        return _WRONG


def _whole(value: Any) -> Any:
    return value if isinstance(value, int | np.integer) and not isinstance(value, bool) else _WRONG


def _array(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value if value.dtype.kind in "biuf" else _WRONG
    try:
        return value if isinstance(value, list | tuple) and np.array(value).dtype.kind in "biuf" else _WRONG
    except ValueError:  # rows of unequal length
        return _WRONG


_PLAIN: Final[dict[Any, _Kind]] = {
    float: _Kind("a number", "numbers", _number),
    int: _Kind("a whole number", "whole numbers", _whole),
    bool: _Kind("True or False", "of True or False", lambda value: value if isinstance(value, bool) else _WRONG),
    str: _Kind("a text", "texts", lambda value: value if isinstance(value, str) else _WRONG),
    type(None): _Kind("None", "None", lambda value: value if value is None else _WRONG),
    Any: _Kind("anything", "anything", lambda value: value),
}
