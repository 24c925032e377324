"""Kinds that other installed packages add: parts and laws, named by their entry points."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from importlib.metadata import EntryPoint, distributions
from inspect import isabstract
from typing import Any, Final, NamedTuple

from femstruct.errors import FemstructError

MEND: Final = "repair or uninstall that package"


class Added(NamedTuple):
    """A class that another package adds, and the words for where it comes from."""

    kind: Any
    source: str


def added_kinds(group: str, base: type, former: str = "") -> tuple[Added, ...]:
    """The classes that installed packages add to a group of entry points, by name.

    Parameters
    ----------
    former : str
        A group that this one has replaced: what was declared there, the classes themselves declare now.

    Raises
    ------
    FemstructError
        With the name of the package, for one that cannot be loaded or is no complete `base`, and for what is in the
        former group.

    Examples
    --------
    >>> added_kinds("femstruct.nothing", int)
    ()
    """
    # importlib.metadata.entry_points parses the files of all packages, which takes ten times as long.
    heads = [f"[{one}]" for one in (group, former) if one]
    texts = [(one, one.read_text("entry_points.txt") or "") for one in distributions()]
    packages = [one for one, text in texts if any(head in text for head in heads)]
    first_on_path = {package.name: package for package in reversed(packages)}
    found = [
        (entry, f"package {package.name} {package.version}, entry point {entry.name} = {entry.value}")
        for package in first_on_path.values()
        for entry in package.entry_points
        if entry.group in (group, former)
    ]
    for entry, source in found:
        if former and entry.group == former:
            do = f"annotate its fields with their quantities, and leave '{entry.name}' out of {former}"
            raise FemstructError(source, got=f"the group {former}", expected=f"one class, in the group {group}", do=do)
    return tuple(_loaded(entry, source, base) for entry, source in sorted(found, key=lambda one: one[0].name))


def with_added(own: Sequence[Any], added: Iterable[Added], words: Callable[[Any], tuple[str, ...]]) -> tuple[Any, ...]:
    """Kinds of our own, then those that other packages add.

    Parameters
    ----------
    words : Callable[[Any], tuple[str, ...]]
        What tells a kind in files.

    Raises
    ------
    FemstructError
        For one of another package that has no word, or one that is taken.
    """
    taken = {word: one for one in own for word in words(one)}
    for kind, source in added:
        own_words = words(kind)
        if not own_words or own_words[0] in taken:
            raise FemstructError(
                source,
                got=(
                    f"type: {', '.join(own_words)}, taken by {taken[own_words[0]].__module__}"
                    if own_words
                    else "no type"
                ),
                expected='a word of its own, type: Literal["word"]',
                do=MEND,
            )
        taken |= dict.fromkeys(own_words, kind)
    return tuple(dict.fromkeys((*own, *taken.values())))


def _loaded(entry: EntryPoint, source: str, base: type) -> Added:
    try:
        kind = entry.load()
    except Exception as error:  # the code of another package, which may raise anything while it is imported
        got = f"{type(error).__name__}: {error}".splitlines()[0]
    else:
        if isinstance(kind, type) and issubclass(kind, base) and not isabstract(kind):
            return Added(kind, source)
        missing = ", ".join(sorted(getattr(kind, "__abstractmethods__", ())))
        got = f"a class without {missing}" if missing else f"{kind!r}"
    raise FemstructError(source, got=got, expected=f"a class that extends {base.__module__}.{base.__name__}", do=MEND)
