"""All kinds of sound fields: the classes that the modules of this package hold."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import import_module
from pkgutil import iter_modules
from typing import Final

from acoustics.fields import __name__ as package
from acoustics.fields import __path__ as places
from acoustics.fields.sound_field import SoundField


def _kinds() -> Iterator[type[SoundField]]:
    for name in sorted(module.name for module in iter_modules(places)):
        if name not in ("known_fields", "sound_field"):
            module = import_module(f"{package}.{name}")
            mine = [one for one in vars(module).values() if isinstance(one, type) and issubclass(one, SoundField)]
            yield from (one for one in mine if one.__module__ == module.__name__)


KINDS: Final[tuple[type[SoundField], ...]] = tuple(_kinds())
