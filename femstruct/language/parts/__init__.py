"""The kinds of parts a model file can have: every module here that defines a SPEC is one."""

from __future__ import annotations

from functools import reduce
from importlib import import_module
from operator import or_
from pkgutil import iter_modules
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field

from femstruct.language.parts.base import PartSpec

_MODULES = [import_module(f"{__name__}.{one.name}") for one in iter_modules(__path__)]
KINDS: tuple[type[PartSpec], ...] = tuple(module.SPEC for module in _MODULES if hasattr(module, "SPEC"))
"""In alphabetical order of their modules."""

if TYPE_CHECKING:
    AnyPartSpec = PartSpec
else:
    _all: Any = reduce(or_, KINDS)
    AnyPartSpec = Annotated[_all, Field(discriminator="type")]
