"""The kinds of one noun, such as the parts or the contact laws: a module each, which nothing else has to name."""

from __future__ import annotations

from collections.abc import Iterable
from functools import reduce
from importlib import import_module
from operator import or_
from pkgutil import iter_modules
from typing import Annotated, Any

from pydantic import Field


def kinds_in(package: str, folders: Iterable[str], base: type) -> tuple[Any, ...]:
    """The classes that a package's modules make of `base`, of those whose `type` is one word, module by module."""
    modules = [import_module(f"{package}.{one.name}") for one in iter_modules(folders)]
    classes = [(one, module) for module in modules for one in vars(module).values() if isinstance(one, type)]
    own: list[Any] = [one for one, its in classes if issubclass(one, base) and one.__module__ == its.__name__]
    return tuple(one for one in own if one.model_fields["type"].annotation is not str)


def any_of(kinds: Iterable[Any]) -> Any:
    """The annotation of a field that holds one of these kinds, told apart by their `type`."""
    return Annotated[reduce(or_, kinds), Field(discriminator="type")]
