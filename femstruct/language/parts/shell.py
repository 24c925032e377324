"""Shells as they are written."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from femstruct.language.model.from_mesh import FromMeshSpec
from femstruct.language.model.lay_up import Layers, laid_up
from femstruct.language.parts.part import MESHED, STRESSED, Library, MaterialName
from femstruct.language.yaml import LENGTH, Coordinate, Direction3, Length, Quantity, read_by
from femstruct.model.part import Part
from femstruct.parts.shell import Shell


def _thickness(value: object) -> object:
    """One for all cells, or one for each set."""
    return (
        {str(name): LENGTH.read(one) for name, one in value.items()} if isinstance(value, dict) else LENGTH.read(value)
    )


class ShellSpec(FromMeshSpec):
    """A shell on triangles and quadrilaterals of a mesh file. thickness: of all cells, or by set; without it that which
    the file states. layers: in place of both, counted along the normals. offset: from the mesh to the middle of the
    thickness, along the normals. orientation: direction of the x of a material that has directions, laid into each
    cell. nonstructural: mass per area on it that does not stiffen it (NSM); without it that which the file states."""

    makes = Shell
    one_of = (("material", "layers"),)
    only_written = ("layers", "scale")
    at_most_one_of = (("layers", "thickness"),)
    known_as = ("part", "plate or shell", "plate or frame", MESHED, STRESSED)
    type: Literal["shell"]
    material: MaterialName | None = None
    layers: Layers | None = None
    thickness: Annotated[float | dict[str, float] | None, read_by(_thickness, Length | dict[str, Length])] = None
    offset: Coordinate | None = None
    orientation: Direction3 | None = None
    nonstructural: Annotated[float, Quantity(("mass/area",), least=0.0)] | None = None

    def made_of(self, name: str, of: Library, **more: Any) -> Part:
        made = {} if self.layers is None else {"material": laid_up(self.layers, of.materials)}
        return super().made_of(name, of, **made, **more)
