"""All kinds of evaluations: those of the modules of this package, and those that other packages add."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from importlib import import_module
from inspect import isabstract
from pkgutil import iter_modules
from types import MappingProxyType
from typing import Final

from femstruct.evaluations import __name__ as package
from femstruct.evaluations import __path__ as places
from femstruct.evaluations.evaluation import Evaluation
from femstruct.plugins import added_kinds, with_added


def _own() -> Iterator[type[Evaluation]]:
    for name in sorted(module.name for module in iter_modules(places) if module.name != "known_evaluations"):
        module = import_module(f"{package}.{name}")
        mine = (one for one in vars(module).values() if isinstance(one, type) and issubclass(one, Evaluation))
        yield from (one for one in mine if one.__module__ == module.__name__ and not isabstract(one))


_ADDED: Final = added_kinds("femstruct.evaluations", Evaluation, "femstruct.language.evaluations")
EVALUATIONS: Final[Mapping[str, type[Evaluation]]] = MappingProxyType(
    {kind.key(): kind for kind in with_added(tuple(_own()), _ADDED, lambda kind: (kind.key(),))}
)
