"""Kinds that other installed packages add: parts and laws, named by their entry points."""

from __future__ import annotations

from importlib.metadata import EntryPoint, entry_points
from inspect import isabstract
from typing import Any, Final, NamedTuple

from femstruct.errors import FemstructError

MEND: Final = "mend that package or uninstall it"


class Added(NamedTuple):
    """A class that another package adds, and the words for where it comes from."""

    kind: Any
    source: str


def added_kinds(group: str, base: type) -> tuple[Added, ...]:
    """The classes that installed packages add to a group of entry points, by name.

    Raises FemstructError, with the name of the package, for one that cannot be loaded or is no complete `base`.

    >>> added_kinds("femstruct.nothing", int)
    ()
    """
    return tuple(_loaded(entry, base) for entry in sorted(entry_points(group=group), key=lambda one: one.name))


def _loaded(entry: EntryPoint, base: type) -> Added:
    package = f"{entry.dist.name} {entry.dist.version}" if entry.dist is not None else "unknown"
    source = f"package {package}, entry point {entry.name} = {entry.value}"
    try:
        kind = entry.load()
    except Exception as error:
        got = f"{type(error).__name__}: {error}".splitlines()[0]
    else:
        if isinstance(kind, type) and issubclass(kind, base) and not isabstract(kind):
            return Added(kind, source)
        missing = ", ".join(sorted(getattr(kind, "__abstractmethods__", ())))
        got = f"a class without {missing}" if missing else f"{kind!r}"
    raise FemstructError(source, got=got, expected=f"a class that extends {base.__module__}.{base.__name__}", do=MEND)
