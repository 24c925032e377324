"""All entries of the library: every module of `families` has some."""

from __future__ import annotations

import pkgutil
from collections.abc import Iterable, Iterator
from difflib import get_close_matches
from functools import cache
from importlib import import_module
from types import MappingProxyType

from femstruct.errors import FemstructError, InputError
from femstruct.model.library import families
from femstruct.model.library.library_entry import Entry, Use


@cache
def library() -> MappingProxyType[str, Entry]:
    """The entries by name, family after family.

    Raises FemstructError for two of one name.

    >>> library()["concrete C30/37"].number("E")
    33000000000.0
    """
    found: dict[str, Entry] = {}
    for entry in _all():
        if entry.name in found:
            raise FemstructError(f"library {entry.name}", got="two entries", expected="one")
        found[entry.name] = entry
    return MappingProxyType(found)


def _all() -> Iterator[Entry]:
    for module in pkgutil.iter_modules(families.__path__, f"{families.__name__}."):
        yield from import_module(module.name).ENTRIES


def names_for(*uses: Use) -> tuple[str, ...]:
    """Names of the entries that a model can take so.

    >>> names_for(Use.HANGERS)[0]
    'hanger ARH-1-20'
    """
    return tuple(entry.name for entry in library().values() if entry.use in uses)


def matching(words: Iterable[str]) -> tuple[Entry, ...]:
    """Entries whose name, family or description has all of these words, in any case.

    >>> [one.name for one in matching(["osb/3"])]
    ['OSB/3']
    """
    wanted = [word.lower() for word in words]
    return tuple(
        entry
        for entry in library().values()
        if all(word in f"{entry.name} {entry.family} {entry.what}".lower() for word in wanted)
    )


def looked_up(words: Iterable[str]) -> tuple[Entry, ...]:
    """`matching`. Raises InputError where there is none, with the name that is nearest."""
    asked = list(words)
    found = matching(asked)
    if not found:
        text = " ".join(asked)
        near = get_close_matches(text.lower(), [name.lower() for name in library()], n=1)
        name = next((one for one in library() if near and one.lower() == near[0]), "")
        do = f"did you mean '{name}'?" if name else "without a word, all entries are listed"
        raise InputError("WORD", got=f"'{text}'", expected="part of the name of an entry of the library", do=do)
    return found
