"""All contact laws of a study file: the specs that the modules of this package hold, told apart by their type."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import import_module
from pkgutil import iter_modules
from typing import TYPE_CHECKING, Annotated, Final, Union

from pydantic import Field

from femstruct.language.laws import __name__ as package
from femstruct.language.laws import __path__ as places
from femstruct.language.laws.law import LawSpec


def _specs() -> Iterator[type[LawSpec]]:
    for name in sorted(module.name for module in iter_modules(places)):
        if name not in ("law", "registry"):
            module = import_module(f"{package}.{name}")
            mine = [one for one in vars(module).values() if isinstance(one, type) and issubclass(one, LawSpec)]
            yield from (one for one in mine if one.__module__ == module.__name__)


SPECS: Final = tuple(_specs())

if TYPE_CHECKING:
    AnyLaw = LawSpec
else:
    AnyLaw = Annotated[Union[SPECS], Field(discriminator="type")]  # noqa: UP007
