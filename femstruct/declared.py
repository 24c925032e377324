"""Nouns whose fields are what they are declared to be: a wrong type or shape is refused where a noun is made.

A field that is annotated with a quantity takes a number in SI units or a text with a unit, within its limits. The same
declaration makes the keys of study and model files (`femstruct.yaml.spec.spec_of`).
"""

from __future__ import annotations

import builtins
import collections.abc
import math
import sys
import types
from collections.abc import Callable, Mapping, Sequence
from dataclasses import MISSING, InitVar
from functools import cache, wraps
from inspect import get_annotations, unwrap
from typing import Annotated, Any, ClassVar, Final, Literal, NamedTuple, TypeVar, Union, get_args, get_origin

import numpy as np

from femstruct.errors import InputError, shorten
from femstruct.quantities import PowerStiffness, Quantity, refuse
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
    """What a field may hold, as words for one and for many; kept : the value as the noun keeps it, or _WRONG, or a
    QuantityError is raised."""

    one: str
    many: str
    kept: Callable[[Any], Any]


class Key(NamedTuple):
    """Annotation of a field whose key in files is not itself. name : of the key, None where files have none.
    default : where a file leaves it out, of a field that Python must give."""

    name: str | None = ""
    default: Any = MISSING


class Refers(NamedTuple):
    """Annotation of a text that is the name of something else in the files.

    kind : the words for it in messages; "" where the noun itself checks the name, since it depends on more.
    goes_with : the group of names with which what uses one is removed.
    """

    kind: str = ""
    goes_with: str = ""


class Declared(NamedTuple):
    """What a noun is given: `default` is MISSING where it must be, `stays` where it is a field."""

    annotation: Any
    default: Any
    stays: bool
    kind: _Kind
    quantity: Quantity | PowerStiffness | None
    key: Key


NOT_GIVEN: Final[Any] = None
"""Default of what follows from other fields, or what a file states elsewhere: where neither does, it is refused."""


def checked(group: str, **expected: str) -> Callable[[type[T]], type[T]]:
    """Decorator of a frozen dataclass, below ``@dataclass``: before its own ``__post_init__`` every field is compared
    with its annotation.

    A list or an array where a tuple is declared becomes one; numbers are finite; a text becomes the quantity that its
    field is annotated with. Fields of which only one or all together mean something stand in `one_of`,
    `at_most_one_of` and `only_with` of the class, as the keys of a mapping do (`femstruct.yaml.spec.Spec`).

    Parameters
    ----------
    group : str
        Of the noun's name in messages; "{word} law" is followed by the field alone.
    expected : str
        Of fields whose annotation does not say all; {value} in it is what was got.

    Raises
    ------
    InputError
        As do all nouns: the field, what was got, what was expected.

    Examples
    --------
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
        found: Any = getattr(kind, "__post_init__", _nothing_further)
        further = unwrap(found)  # that of a base which is compared as well, without its comparison

        @wraps(further)
        def compared(self: Any, *beside: Any) -> None:
            further(self, *_compare(self, group, expected, beside))

        kind.__post_init__ = compared  # type: ignore[attr-defined]  # dataclass calls it
        return kind

    return decorate


def _nothing_further(self: object, *beside: object) -> None:
    """What is done after the comparison of a noun that has no more to do."""


def expect(where: str, value: Any, kind: Any, do: str = "") -> Any:
    """An argument of a function, compared with its annotation as `checked` compares fields; a list becomes a tuple.

    Parameters
    ----------
    do : str
        What to write instead.

    Raises
    ------
    InputError
        Where, what was got, what was expected.

    Examples
    --------
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


def _compare(noun: Any, group: str, expected: Mapping[str, str], beside: tuple[Any, ...]) -> list[Any]:
    """Compare all that a noun was given.

    Parameters
    ----------
    beside : tuple[Any, ...]
        What it was given and has no field for (`InitVar`), which is returned as it is kept.
    """
    found = declared(noun.__class__)
    extra = dict(zip((name for name, one in found.items() if not one.stays), beside, strict=True))
    for name, one in found.items():
        value = getattr(noun, name) if one.stays else extra[name]
        if value is one.default:
            continue
        power = one.quantity if isinstance(one.quantity, PowerStiffness) else None
        try:
            kept = one.kind.kept(value if power is None else (value, getattr(noun, power.exponent)))
        except QuantityError as error:
            raise InputError(_where(noun, group, name), got=error.got, expected=error.expected, do=error.do) from None
        if kept is _WRONG:
            words = expected.get(name, one.kind.one).format(value=_shown(value))
            where, do = _where(noun, group, name), _plain(value, one.kind)
            raise InputError(where, got=_shown(value), expected=words, do=do)
        if not one.stays:
            extra[name] = kept
        elif kept is not value:
            object.__setattr__(noun, name, kept)
    if names := _related(noun.__class__):
        given = {name: extra[name] if name in extra else getattr(noun, name) for name in names}
        try:
            refuse_together(
                noun, {name: None if _same(one, found[name].default) else one for name, one in given.items()}
            )
        except QuantityError as error:
            raise InputError(_where(noun, group), got=error.got, expected=error.expected, do=error.do) from None
    return list(extra.values())


def _where(noun: Any, group: str, *names: str) -> str:
    if "{" in group:
        return " ".join((group.format(word=noun.word), *names))
    return ".".join(one for one in (group, getattr(noun, "name", None), *names) if isinstance(one, str))


def _same(value: object, default: object) -> bool:
    return value is default or (isinstance(value, int | float | str) and value == default)


@cache
def _related(noun: Any) -> tuple[str, ...]:
    """The fields that mean something together or alone only."""
    alone = [name for word in ("one_of", "at_most_one_of") for names in getattr(noun, word, ()) for name in names]
    needed = [name for key, others in getattr(noun, "only_with", ()) for name in (key, *others)]
    return tuple(dict.fromkeys(alone + needed))


def refuse_together(noun: Any, given: Mapping[str, object]) -> None:
    """Raise QuantityError for keys that exclude or need each other by `one_of`, `at_most_one_of`, `only_with`."""
    for names in getattr(noun, "one_of", ()):
        exactly_one(given, names)
    for names in getattr(noun, "at_most_one_of", ()):
        exactly_one(given, names, or_none=True)
    for key, others in getattr(noun, "only_with", ()):
        missing = [other for other in others if given.get(key) is not None and given.get(other) is None]
        if missing:
            raise refuse(
                f"{key} without {missing[0]}",
                f"'{missing[0]}' beside '{key}'",
                f"add '{missing[0]}: ...', or remove '{key}'",
            )


def exactly_one(given: Mapping[str, object], names: Sequence[str], or_none: bool = False) -> None:
    """Refuse a mapping with several of these keys, or with none of them; a key without a value is not given."""
    present = [name for name in names if given.get(name) is not None]
    if len(present) > 1 or not (present or or_none):
        raise refuse(
            f"both {' and '.join(present)}" if present else f"none of {', '.join(names)}",
            f"exactly one of {', '.join(names)}",
            "remove all but one" if present else "add one",
        )


def _shown(value: object) -> str:
    words = f"a {type(value).__name__}" if type(value).__repr__ is object.__repr__ else repr(value)
    return shorten(" ".join(words.split()), _SHOWN)


def _plain(value: object, kind: _Kind) -> str:
    """What to write instead of a quantity with a unit."""
    if not isinstance(value, str) or kind.kept(1.0) is _WRONG:
        return ""
    try:
        return f"write a number in SI units: {quantity_of(value, tuple(DIMENSIONS))[0]:g}"
    except QuantityError:
        return ""


@cache
def declared(noun: Any) -> dict[str, Declared]:
    """What a frozen dataclass is given, by name, what depends on others behind them."""
    annotated: dict[str, Any] = {}
    for one in reversed(noun.__mro__):
        annotated |= get_annotations(one, eval_str=True, locals=_Names(vars(sys.modules[one.__module__])))
    found = {}
    for name, field in noun.__dataclass_fields__.items():
        beside = isinstance(annotated[name], InitVar)
        if field.init and ClassVar not in (annotated[name], get_origin(annotated[name])):
            found[name] = _declared(annotated[name].type if beside else annotated[name], field.default, not beside)
    return dict(sorted(found.items(), key=lambda item: isinstance(item[1].quantity, PowerStiffness)))


def _declared(annotation: Any, default: Any, stays: bool) -> Declared:
    metadata = get_args(annotation)[1:] if get_origin(annotation) is Annotated else ()
    key = next((one for one in metadata if isinstance(one, Key)), Key())
    quantity = next((one for one in metadata if isinstance(one, Quantity | PowerStiffness)), None)
    return Declared(annotation, default, stays, _kind(annotation), quantity, key)


def units_of(noun: Any) -> dict[str, str]:
    """The units of the fields of a noun in tables, of those that are quantities with one."""
    found = {}
    for name, one in declared(noun.__class__).items():
        if isinstance(one.quantity, PowerStiffness):
            found[name] = one.quantity.unit_of(getattr(noun, one.quantity.exponent))
        elif one.quantity is not None:
            found[name] = one.quantity.unit
    return found


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
        for one in inside[1:]:
            if isinstance(one, Bound):
                return _bounded(_kind(inside[0]), one)
            if isinstance(one, PowerStiffness):
                return _power(one)
            if isinstance(one, Quantity) and inside[0] is float:
                return _quantity(one)
        return _kind(inside[0])
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


def _quantity(quantity: Quantity) -> _Kind:
    """A number in SI units, or a text with a unit."""

    def kept(value: Any) -> Any:
        if isinstance(value, str):
            return quantity.read(value)
        if _number(value) is _WRONG:
            return _WRONG
        quantity.refuse_beyond(float(value), value, DIMENSIONS[quantity.dimensions[0]])
        return value

    return _Kind(quantity.description, f"values, each {quantity.description}", kept)


def _power(stiffness: PowerStiffness) -> _Kind:
    """The same of a stiffness of a power; what is kept is made of it and the exponent."""

    def kept(pair: Any) -> Any:
        value, exponent = pair
        if isinstance(value, str):
            return stiffness.read(value, exponent)
        if _number(value) is _WRONG:
            return _WRONG
        stiffness.read(float(value), exponent)
        return value

    return _Kind("a stiffness", "stiffnesses", kept)


def _is_one_of(value: object, words: tuple[object, ...]) -> bool:
    return isinstance(value, str | int) and value in words


def _either(kinds: list[_Kind]) -> _Kind:
    def kept(value: Any) -> Any:
        refusal = None
        for kind in kinds:
            try:
                read = kind.kept(value)
            except QuantityError as error:
                refusal = error
            else:
                if read is not _WRONG:
                    return read
        if refusal is not None:
            raise refusal
        return _WRONG

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
