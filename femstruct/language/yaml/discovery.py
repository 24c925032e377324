"""The kinds of one noun, such as the parts or the contact laws: a module each, which nothing else has to name, and what
other packages add."""

from __future__ import annotations

from collections.abc import Iterable
from functools import reduce
from importlib import import_module
from operator import or_
from pkgutil import iter_modules
from types import ModuleType
from typing import Annotated, Any, get_args

from pydantic import BaseModel, Field

from femstruct.errors import FemstructError
from femstruct.plugins import MEND, added_kinds


def kinds_of(package: ModuleType, base: type[BaseModel]) -> tuple[Any, ...]:
    """The classes that a package's modules make of `base`, of those with a `type` or `signs` of their own, module by
    module; then those that other packages add to the group of entry points of its name.

    Raises FemstructError for one of another package that has no word, or one that is taken.
    """
    modules = [import_module(f"{package.__name__}.{one.name}") for one in iter_modules(package.__path__)]
    classes = [(one, module) for module in modules for one in vars(module).values() if isinstance(one, type)]
    own = [one for one, its in classes if issubclass(one, base) and one.__module__ == its.__name__]
    taken = {word: one for one in own for word in _words(one)}
    for kind, source in added_kinds(package.__name__, base):
        words = _words(kind)
        if not words or words[0] in taken:
            raise FemstructError(
                source,
                got=(f"type: {', '.join(words)}, taken by {taken[words[0]].__module__}" if words else "no type"),
                expected='a word of its own, type: Literal["word"]',
                do=MEND,
            )
        taken |= dict.fromkeys(words, kind)
    return tuple(dict.fromkeys(taken.values()))


def _words(kind: type[BaseModel]) -> tuple[str, ...]:
    """What tells a kind: the word of its `type`, or keys that no other kind has."""
    field = kind.model_fields.get("type")
    return get_args(field.annotation) if field is not None else getattr(kind, "signs", ())


def union_of(kinds: Iterable[Any]) -> Any:
    """The annotation of what is one of these kinds."""
    return reduce(or_, kinds)


def any_of(kinds: Iterable[Any]) -> Any:
    """The annotation of a field that holds one of these kinds, told apart by their `type`."""
    return Annotated[union_of(kinds), Field(discriminator="type")]
