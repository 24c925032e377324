"""Kinds that other installed packages add: parts and laws, named by their entry points."""

from __future__ import annotations

from importlib.metadata import EntryPoint, distributions
from inspect import isabstract
from typing import Any, Final, NamedTuple

from femstruct.errors import FemstructError

MEND: Final = "repair or uninstall that package"


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
    # importlib.metadata.entry_points parses the files of all packages, which takes ten times as long.
    packages = [one for one in distributions() if f"[{group}]" in (one.read_text("entry_points.txt") or "")]
    first_on_path = {package.name: package for package in reversed(packages)}
    found = [
        (entry, f"{package.name} {package.version}")
        for package in first_on_path.values()
        for entry in package.entry_points.select(group=group)
    ]
    return tuple(_loaded(entry, package, base) for entry, package in sorted(found, key=lambda one: one[0].name))


def _loaded(entry: EntryPoint, package: str, base: type) -> Added:
    source = f"package {package}, entry point {entry.name} = {entry.value}"
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
