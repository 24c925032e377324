"""Parts of matrices from files as they are written."""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar, Literal

from femstruct.errors import InputError, InputErrors
from femstruct.files.inputs.matrices_input import read_component
from femstruct.files.inputs.opening import beside
from femstruct.language.model.from_mesh import FILE_SCALE
from femstruct.language.parts.part import MESHED, Library, PartSpec
from femstruct.language.yaml import MaterialLossFactor, Position3, Spec, Text
from femstruct.model.part import Part
from femstruct.parts.substructure import Substructure


class FromMatricesSpec(PartSpec):
    """A part whose matrices stand in a file. origin: how far it is shifted from where the file has it."""

    known_as: ClassVar[tuple[str, ...]] = ("part", "plate or shell", MESHED)

    makes = Substructure
    only_written: ClassVar[tuple[str, ...]] = ("file",)  # it becomes a component
    file: Any
    loss_factor: MaterialLossFactor | None = None
    origin: Position3 = (0.0, 0.0, 0.0)

    def build(self, name: str, of: Library) -> Part:
        try:
            component = read_component(self.files(of), of.sources, **self.reading(of))
        except InputErrors:
            raise
        except InputError as error:
            raise InputError(f"parts.{name}.file", got=error.got, expected=error.expected, do=error.do) from None
        return self.made_of(name, of, component=component)

    def files(self, of: Library) -> Path | dict[str, Path]:
        """The file, or several by what they have."""
        return beside(of.file, self.file)

    def reading(self, of: Library) -> dict[str, Any]:
        """How to read what another program wrote."""
        return {}


class MatrixNamesSpec(Spec):
    """Of each matrix its name or its file: mass, stiffness, and dashpots where there are any."""

    M: Text
    K: Text
    C: Text | None = None

    def by_letter(self) -> dict[str, str]:
        """Those that are given."""
        return {"M": self.M, "K": self.K} | ({} if self.C is None else {"C": self.C})


class MatricesSpec(FromMatricesSpec):
    """A part given by M, C, K of another program, in a .npz, HDF5, OUTPUT4 of Nastran (.op4) or a .mtx for each, or by
    what `femstruct export --to npz` or `mtx` wrote. nodes: a table of commas with the columns node, x, y, z, direction
    and a row for each degree of freedom, where the file does not say it. names: of the matrices in a .op4, where they
    are not the usual ones (MAA, KAA, BAA). scale: the unit of length of another program, or metres in it; forces are in
    newtons, so that masses are in t where lengths are in mm."""

    only_written = ("file", "nodes", "names", "scale")
    type: Literal["matrices"]
    file: Text | MatrixNamesSpec
    nodes: Text | None = None
    names: MatrixNamesSpec | None = None
    scale: FILE_SCALE = 1.0

    def files(self, of: Library) -> Path | dict[str, Path]:
        if isinstance(self.file, str):
            return beside(of.file, self.file)
        return {letter: beside(of.file, one) for letter, one in self.file.by_letter().items()}

    def reading(self, of: Library) -> dict[str, Any]:
        return {
            "nodes": None if self.nodes is None else beside(of.file, self.nodes),
            "names": {} if self.names is None else self.names.by_letter(),
            "scale": self.scale,
        }
