"""The tag of a noun that is stored, and the noun of a tag that is read."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import is_dataclass
from enum import Enum
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from types import MappingProxyType
from typing import Any, Final, NamedTuple

from acoustics import tags as of_acoustics
from femstruct import tags
from femstruct.errors import FemstructError
from femstruct.files.results_file.tagged.format_4 import tag_of_format_4
from femstruct.files.results_file.tagged.tagged_modules import MODULES

Fields = Mapping[str, Any]
_OURS: Final = ("femstruct", "acoustics")
_GROUPS: Final = (  # of packages that add nouns
    "femstruct.evaluations",
    "femstruct.laws",
    "femstruct.language.evaluations",
    "femstruct.language.laws",
    "femstruct.language.parts",
    "femstruct.language.rooms",
)


class Newer(NamedTuple):
    """What became of a tag that no noun has any more: the tag of today, and what makes its fields of those of then."""

    tag: str
    fields: Callable[[Fields], Fields]


NEWER: Final[Mapping[str, Newer]] = MappingProxyType({})  # a noun that gets another meaning has an entry here


def tag_of(kind: Any) -> str:
    """The tag of a class or of a function; of somebody's own without one, where it stands.

    Raises FemstructError for one of this project, or of an installed package that adds to it, that has no tag.

    >>> from femstruct.errors import Finding
    >>> tag_of(Finding), tag_of(print)
    ('finding/1', 'builtins:print')
    """
    found = tags.TAGS.get(kind) or of_acoustics.TAGS.get(kind)
    if found is not None:
        return found
    name = f"{kind.__module__}:{kind.__qualname__}"
    package = _package(name)
    added = isinstance(kind, type) and package in {_package(point.module) for point in _added()}
    if "<" not in name and (package in _OURS or added):  # what is made inside a function, nobody finds again
        prefix = "" if package in _OURS else f"{package}: "
        raise FemstructError(
            "results",
            got=f"{name}, which has no tag",
            expected="nouns with tags",
            do=f"write @stored_as('{prefix}WORDS OF THE FIELD/1') above it, from femstruct.tags or acoustics.tags",
        )
    return name


def kind_of(tag: str) -> Any:
    """The class or function that has a tag, or what a file of format 4, or of somebody's own, names by its module.

    Raises FemstructError for what this version does not know, and for packages that are not installed.

    >>> kind_of("finding/1").__name__, kind_of("femstruct.errors:Finding").__name__
    ('Finding', 'Finding')
    """
    tag = tag_of_format_4(tag) or tag
    owner, _, own = tag.rpartition(": ")
    if "/" not in own:
        return _by_module(tag)
    found = _known(tag)
    if found is None and owner:
        for point in _points_of(owner, tag):
            import_module(point.module)
        found = _known(tag)
    elif found is None and tag in MODULES:
        import_module(MODULES[tag])
        found = _known(tag)
    if found is None:
        who = f"the version of {owner or 'femstruct'} that wrote it"
        raise FemstructError("results", got=f"'{tag}'", expected="a noun that this version knows", do=f"use {who}")
    return found


def _known(tag: str) -> Any:
    return tags.KINDS.get(tag) or of_acoustics.KINDS.get(tag)


def is_noun(kind: Any) -> bool:
    """Whether it is a class of nouns: nothing else is made of what a file says."""
    return isinstance(kind, type) and (is_dataclass(kind) or hasattr(kind, "_fields") or issubclass(kind, Enum))


def _by_module(name: str) -> Any:
    """What another package has under a name: only of packages that add parts or laws anything is imported."""
    module, _, word = name.partition(":")
    if _package(name) in _OURS:
        raise FemstructError("results", got=f"'{name}'", expected="a noun of femstruct")
    _points_of(_package(name), name)
    found: Any = import_module(module)
    for part in word.split("."):
        found = getattr(found, part)
    return found


def _points_of(package: str, name: str) -> list[EntryPoint]:
    found = [point for point in _added() if _package(point.module) == package]
    if not found:
        got, do = f"'{name}'", f"install the package '{package}'"
        raise FemstructError("results", got=got, expected="nouns of femstruct", do=do)
    return found


def _added() -> list[EntryPoint]:
    return [point for group in _GROUPS for point in entry_points(group=group)]


def _package(name: str) -> str:
    return name.partition(":")[0].partition(".")[0]
