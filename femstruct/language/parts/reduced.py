"""Reduced parts as they are written."""

from __future__ import annotations

from typing import Literal

from femstruct.errors import InputError
from femstruct.language.parts.matrices import FromMatricesSpec
from femstruct.language.parts.part import Library
from femstruct.language.yaml import Text
from femstruct.model.part import Part
from femstruct.parts.substructure import Substructure


class ReducedSpec(FromMatricesSpec):
    """A part that `femstruct reduce` has reduced to its interface and its modes with the interface held."""

    type: Literal["reduced"]
    file: Text

    def build(self, name: str, of: Library) -> Part:
        part = super().build(name, of)
        if isinstance(part, Substructure) and not part.component.reduced:
            got = f"'{part.component.source}', which is not reduced"
            expected = "a file that femstruct reduce wrote"
            raise InputError(f"parts.{name}.file", got=got, expected=expected, do="write type: matrices")
        return part
