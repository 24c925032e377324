"""The kinds of parts a model file can have: every module here that has a `PartSpec` with a `type` is one."""

from __future__ import annotations

from typing import TYPE_CHECKING

from femstruct.language.parts.base import PartSpec
from femstruct.language.yaml.discovery import any_of, kinds_in

KINDS: tuple[type[PartSpec], ...] = kinds_in(__name__, __path__, PartSpec)

if TYPE_CHECKING:
    AnyPart = PartSpec
else:
    AnyPart = any_of(KINDS)
