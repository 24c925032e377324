"""Parts of matrices from files as they are written."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

from femstruct.errors import InputError
from femstruct.files.inputs.matrices_input import read_component
from femstruct.files.inputs.opening import beside
from femstruct.language.parts.part import MESHED, Library, PartSpec
from femstruct.language.yaml import MaterialLossFactor, Position3, Text
from femstruct.model.part import Part
from femstruct.parts.substructure import Substructure


class FromMatricesSpec(PartSpec):
    """A part whose matrices stand in a file. origin: how far it is shifted from where the file has it."""

    known_as: ClassVar[tuple[str, ...]] = ("part", MESHED)

    makes = Substructure
    file: Text
    loss_factor: MaterialLossFactor | None = None
    origin: Position3 = (0.0, 0.0, 0.0)

    def build(self, name: str, of: Library) -> Part:
        try:
            component = read_component(beside(of.file, self.file), of.sources)
        except InputError as error:
            raise InputError(f"parts.{name}.file", got=error.got, expected=error.expected, do=error.do) from None
        return self.made_of(name, of, component=component)

    def given(self) -> dict[str, Any]:
        values = super().given()
        del values["file"]  # it has become a component
        return values


class MatricesSpec(FromMatricesSpec):
    """A part given by M, C, K of another program, in a .npz, or by what `femstruct export --to npz` or `mtx` wrote."""

    type: Literal["matrices"]
