"""All contact laws: those of the modules of this package, those that other packages add, and their codes by number."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import import_module
from inspect import isabstract
from pkgutil import iter_modules
from typing import Final

from femstruct.impact.laws import __name__ as package
from femstruct.impact.laws import __path__ as places
from femstruct.impact.laws.law import Code, Law
from femstruct.plugins import added_kinds


def _laws() -> Iterator[type[Law]]:
    for name in sorted(module.name for module in iter_modules(places)):
        if name not in ("registry", "dispatch"):
            module = import_module(f"{package}.{name}")
            mine = [one for one in vars(module).values() if isinstance(one, type) and issubclass(one, Law)]
            yield from (one for one in mine if one.__module__ == module.__name__ and not isabstract(one))


LAWS: Final[tuple[type[Law], ...]] = (*_laws(), *(one.kind for one in added_kinds("femstruct.laws", Law)))
CODES: Final[tuple[Code, ...]] = tuple(dict.fromkeys(law.code for law in LAWS))
DOUBTS: Final = {code: severe for law in LAWS for code, severe in law.doubts.items()}
