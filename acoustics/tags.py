"""Names under which values are stored in files: words of the field and a version, which outlive modules and classes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final, TypeVar

T = TypeVar("T")
KINDS: Final[dict[str, Any]] = {}  # by tag: what has been imported so far
TAGS: Final[dict[Any, str]] = {}


def stored_as(tag: str) -> Callable[[T], T]:
    """Decorator of a noun, above ``@dataclass``, or of a function that nouns hold: the name it has in files of
    results.

    Parameters
    ----------
    tag : str
        Words of the field and a version, "sound levels/1". It stays when the class or its module gets another name. A
        field that is added needs a default; a field with another meaning makes a new version.

    Examples
    --------
    >>> from acoustics.receivers import Receiver
    >>> TAGS[Receiver]
    'receiver/1'
    """

    def decorate(kind: T) -> T:
        KINDS[tag] = kind
        TAGS[kind] = tag
        return kind

    return decorate
