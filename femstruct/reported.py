"""What a number of a noun is, said once, where it is computed: tables, files and pages read it from there."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache, cached_property
from types import MappingProxyType
from typing import Annotated, Any, NamedTuple, get_args, get_origin, get_type_hints


class Reported(NamedTuple):
    """Of a field or property `x: Annotated[float, Reported("N", "Peak force")]`: unit and description.

    key : its name in JSON, its own if left out. axis : of a mapping, what its keys are (name, unit, description).
    along : of an array, the names of its axes. symbol : the head of its row or column in tables that are read; "" where
    it is in none.
    """

    unit: str
    long_name: str
    key: str = ""
    axis: tuple[str, str, str] | None = None
    along: tuple[str, ...] = ()
    symbol: str = ""


@cache
def reported(kind: type) -> Mapping[str, Reported]:
    """What the fields and properties of a noun report, by name, in their order; those of `acoustics` say it alike.

    >>> class Hit(NamedTuple):
    ...     peak: Annotated[float, Reported("N", "Peak force", key="peak_n")]
    ...     name: str
    >>> [(name, one.unit, one.key) for name, one in reported(Hit).items()]
    [('peak', 'N', 'peak_n')]
    """
    hints: dict[str, Any] = get_type_hints(kind, include_extras=True)
    for name, item in vars(kind).items():
        read = item.fget if isinstance(item, property) else item.func if isinstance(item, cached_property) else None
        if read is not None:
            hints[name] = get_type_hints(read, include_extras=True)["return"]
    found = {
        name: Reported(*told)
        for name, hint in hints.items()
        if get_origin(hint) is Annotated
        for told in get_args(hint)[1:]
        if getattr(told, "_fields", ()) == Reported._fields
    }
    return MappingProxyType(found)
