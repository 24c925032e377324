"""What a number of a noun is, said once, where it is computed: tables, files and pages read it from there."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache, cached_property
from types import MappingProxyType
from typing import Annotated, Any, Final, NamedTuple, get_args, get_origin, get_type_hints

OWN_UNIT: Final = "see unit"


class Reported(NamedTuple):
    """Of a field or property `x: Annotated[float, Reported("N", "Peak force")]`: unit and description.

    unit : `OWN_UNIT` where the noun has it as its `unit`. key : its name in JSON, its own if left out. axis : of a
    mapping, what its keys are (name, unit, description). along : of an array, the names of its axes. symbol : the head
    of its row or column in tables that are read; "" where it is in none.
    """

    unit: str
    long_name: str
    key: str = ""
    axis: tuple[str, str, str] | None = None
    along: tuple[str, ...] = ()
    symbol: str = ""


class Held(NamedTuple):
    """Of a field or property that holds nouns which report numbers of their own, by name or one alone:
    `x: Annotated[Mapping[str, ShockSpectrum], Held("Shock response spectra", "One spectrum")]`.

    long_name : what its table is of. each : the same of one that goes by a name. key : its name in JSON and its group
    in the results file, its own if left out. rows : of nouns by name that are one table with a row for each, what the
    names are (axis, unit, description). kinds : the field has nouns of several kinds, by the word of their kind and
    then by name, and the noun of a kind says its own: `table: ClassVar = Held(..)`.
    """

    long_name: str
    each: str = ""
    key: str = ""
    rows: tuple[str, str, str] | None = None
    kinds: bool = False


@cache
def reported(kind: type) -> Mapping[str, Reported]:
    """What the fields and properties of a noun report, by name, in their order; those of `acoustics` say it alike.

    >>> class Hit(NamedTuple):
    ...     peak: Annotated[float, Reported("N", "Peak force", key="peak_n")]
    ...     name: str
    >>> [(name, one.unit, one.key) for name, one in reported(Hit).items()]
    [('peak', 'N', 'peak_n')]
    """
    annotations = ((name, one) for name, one in _annotations(kind) if getattr(one, "_fields", ()) == Reported._fields)
    return MappingProxyType({name: Reported(*one) for name, one in annotations})


@cache
def held(kind: type) -> Mapping[str, Held]:
    """The nouns that a noun holds and that report numbers of their own, by the names of its fields and properties.

    >>> class Hits(NamedTuple):
    ...     hits: Annotated[Mapping[str, Reported], Held("Hits by body", "One hit")]
    >>> [(name, one.long_name) for name, one in held(Hits).items()]
    [('hits', 'Hits by body')]
    """
    return MappingProxyType({name: holding for name, holding in _annotations(kind) if isinstance(holding, Held)})


def holdings(noun: Any) -> Iterator[tuple[str, Held, Any]]:
    """What a noun holds: the field, or the word of a kind, what is said of it, and the value."""
    kind: object = type(noun)
    for name, holding in held(kind).items():
        value = getattr(noun, name)
        if holding.kinds:
            yield from ((word, next((one.table for one in own.values()), holding), own) for word, own in value.items())
        else:
            yield holding.key or name, holding, value


def _annotations(kind: type) -> Iterator[tuple[str, Any]]:
    """All that is said of the fields and properties of a noun, by name, in their order."""
    hints: dict[str, Any] = get_type_hints(kind, include_extras=True)
    for name, item in vars(kind).items():
        read = item.fget if isinstance(item, property) else item.func if isinstance(item, cached_property) else None
        if read is not None:
            hints[name] = get_type_hints(read, include_extras=True)["return"]
    for name, hint in hints.items():
        if get_origin(hint) is Annotated:
            yield from ((name, annotation) for annotation in get_args(hint)[1:])
