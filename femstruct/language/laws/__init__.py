"""The kinds of contact laws a study file can have: every module here that has a `LawSpec` with a `type` is one."""

from __future__ import annotations

from typing import TYPE_CHECKING

from femstruct.language.laws.law import LawSpec
from femstruct.language.yaml.discovery import any_of, kinds_in

KINDS: tuple[type[LawSpec], ...] = kinds_in(__name__, __path__, LawSpec)

if TYPE_CHECKING:
    AnyLaw = LawSpec
else:
    AnyLaw = any_of(KINDS)
