"""The kinds of parts a model file can have: every module here that has a `PartSpec` with a `type` is one, and what
other packages add as entry points of the group `femstruct.language.parts`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from femstruct.language import parts
from femstruct.language.parts.part import PartSpec
from femstruct.language.yaml.discovery import any_of, kinds_of

KINDS: tuple[type[PartSpec], ...] = kinds_of(parts, PartSpec)

if TYPE_CHECKING:
    AnyPart = PartSpec
else:
    AnyPart = any_of(KINDS)
