"""What parts of mesh files have in common as they are written: the file, the set of it, its unit of length."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

from femstruct.errors import InputError, InputErrors
from femstruct.files.inputs.mesh_files.mesh_file import read_mesh_file
from femstruct.files.inputs.opening import beside
from femstruct.language.parts.part import MESHED, Library, PartSpec
from femstruct.language.yaml import Quantity, Text, read_by, refuse
from femstruct.model.part import Part
from femstruct.units import QuantityError, quantity, shown_as

_FACTOR = Quantity(("ratio",), above=0.0)


def _scale(value: object) -> object:
    """Metres in the file's unit of length: a unit, or a number."""
    if not isinstance(value, str):
        return _FACTOR.read(value)
    try:
        return quantity(f"1 {value}", "length")
    except QuantityError:
        raise refuse(shown_as(value), "a unit of length, or metres in that of the file", "write mm or 0.001") from None


class FromMeshSpec(PartSpec):
    """A part whose shape is the mesh of a file, or a set of it. scale: the unit of length in the file, or metres in it;
    metres without it."""

    known_as: ClassVar[tuple[str, ...]] = ("part", MESHED)

    called = (("set", "named"),)

    mesh: Text
    set: Text | None = None
    scale: Annotated[float, read_by(_scale, Text | float)] = 1.0

    def build(self, name: str, of: Library) -> Part:
        try:
            mesh = read_mesh_file(beside(of.file, self.mesh), self.scale, of.sources)
        except InputErrors:
            raise
        except InputError as error:
            raise InputError(f"parts.{name}.mesh", got=error.got, expected=error.expected, do=error.do) from None
        return self.made_of(name, of, mesh=mesh)

    def given(self) -> dict[str, Any]:
        values = super().given()
        del values["scale"]  # the mesh is in metres
        return values
