"""The kinds of contact laws a study file can have: every module here that has a `LawSpec` with a `type` is one, and
what other packages add as entry points of the group `femstruct.language.laws`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from femstruct.language import laws
from femstruct.language.laws.law import LawSpec
from femstruct.language.yaml.discovery import any_of, kinds_of

KINDS: tuple[type[LawSpec], ...] = kinds_of(laws, LawSpec)

if TYPE_CHECKING:
    AnyLaw = LawSpec
else:
    AnyLaw = any_of(KINDS)
