"""What parts of mesh files have in common as they are written: the file, the set of it, its unit of length."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, ClassVar

from pydantic import Field

from femstruct.errors import InputError, InputErrors, shown_as
from femstruct.files.inputs.mesh_files.mesh_file import read_mesh_file
from femstruct.files.inputs.opening import beside
from femstruct.language.parts.part import MESHED, Library, PartSpec
from femstruct.language.yaml import Quantity, Text, read_by, refuse
from femstruct.model.part import Part
from femstruct.units import QuantityError, quantity


def unit_of_file(dimension: str, factor: str, expected: str, do: str) -> Callable[[object], object]:
    """Reader of a unit of a file in SI units: the unit, or a number of the dimension `factor`."""
    number = Quantity((factor,), above=0.0)

    def read(value: object) -> object:
        if not isinstance(value, str):
            return number.read(value)
        try:
            return quantity(f"1 {value}", dimension)
        except QuantityError:
            raise refuse(shown_as(value), expected, do) from None

    return read


_scale = unit_of_file("length", "ratio", "a unit of length, or metres in that of the file", "write mm or 0.001")


FILE_SCALE = Annotated[float, read_by(_scale, Text | float)]
"""Metres in the unit of length of a file."""


class OfMeshSpec(PartSpec):
    """A part of a mesh file. scale: the unit of length in the file, or metres in it; metres without it."""

    known_as: ClassVar[tuple[str, ...]] = ("part",)

    only_written: ClassVar[tuple[str, ...]] = ("scale",)  # the mesh is in metres

    mesh: Text = Field(description="a mesh file: .msh, .inp, .bdf, .unv or .vtu")
    scale: FILE_SCALE = 1.0

    def build(self, name: str, of: Library) -> Part:
        try:
            mesh = read_mesh_file(beside(of.file, self.mesh), self.scale, of.sources)
        except InputErrors:
            raise
        except InputError as error:
            raise InputError(f"parts.{name}.mesh", got=error.got, expected=error.expected, do=error.do) from None
        return self.made_of(name, of, mesh=mesh)


class FromMeshSpec(OfMeshSpec):
    """A part whose shape is the mesh of a file, or a set of it."""

    known_as: ClassVar[tuple[str, ...]] = ("part", MESHED)

    called = (("set", "named"),)

    set: Text | None = None
