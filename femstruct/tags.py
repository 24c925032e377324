"""Names under which values are stored in files: words of the field and a version, which outlive modules and classes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final, TypeVar

T = TypeVar("T")
KINDS: Final[dict[str, Any]] = {}  # by tag: what has been imported so far
TAGS: Final[dict[Any, str]] = {}
OURS: Final = "femstruct"


def stored_as(tag: str) -> Callable[[T], T]:
    """Decorator of a noun, above ``@dataclass``, or of a function that nouns hold: the name it has in results files.

    Parameters
    ----------
    tag : str
        Words of the field and a version, "contact history/1". It stays when the class or its module gets another name.
        A field that is added needs a default, and files without it are read; a field that is left out is passed over; a
        field with another meaning makes a new version. Another package begins with its name: "my_package: strut/1".

    Raises
    ------
    ValueError
        A tag that is no such words, or that another class has.

    Examples
    --------
    >>> from femstruct.errors import Finding
    >>> TAGS[Finding]
    'finding/1'
    """

    def decorate(kind: T) -> T:
        _refuse(tag, kind)
        KINDS[tag] = kind
        TAGS[kind] = tag
        return kind

    return decorate


def _refuse(tag: str, kind: Any) -> None:
    package = kind.__module__.partition(".")[0]
    owner, _, own = tag.rpartition(": ")
    words, _, version = own.rpartition("/")
    if owner != ("" if package == OURS else package):
        expected = "no package in it" if package == OURS else f"the name of its package before it, '{package}: {own}'"
        raise ValueError(f"the tag '{tag}': expected {expected}")
    if not (words.strip() == words != "" and version.isdigit()) or set(words) & set(":/\"'"):
        raise ValueError(f"the tag '{tag}': expected words of the field and a version, as 'contact history/1'")
    other = KINDS.get(tag)
    if other is not None and (other.__module__, other.__qualname__) != (kind.__module__, kind.__qualname__):
        raise ValueError(f"the tag '{tag}': {other.__module__}:{other.__qualname__} has it; give this one another")
