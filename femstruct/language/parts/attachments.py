"""Attachments as they are written."""

from __future__ import annotations

from typing import Annotated, Literal

from femstruct.language.model.from_mesh import OfMeshSpec, unit_of_file
from femstruct.language.yaml import Text, read_by, words_of
from femstruct.model.imported.attached import TAKEN
from femstruct.parts.attachments import Attachments

_unit = unit_of_file("mass", "mass", "a unit of mass, or kilograms in that of the file", "write t or 1000")


class AttachmentsSpec(OfMeshSpec):
    """Supports, rigid links and masses that a mesh file states beside its cells, taken as they are. take: which of
    them. supports: the sets of supports that hold, by their names in the file; those that the file puts to use without
    it. mass_unit: the unit of mass of the file; without it kg of a file in metres and t of one in millimetres."""

    makes = Attachments
    type: Literal["attachments"]
    take: Annotated[tuple[str, ...], words_of(TAKEN)]
    supports: tuple[Text, ...] = ()
    mass_unit: Annotated[float | None, read_by(_unit, Text | float)] = None
