"""Struts as they are written."""

from typing import Literal

from femstruct.language.materials import Area
from femstruct.language.parts import MaterialName, PartSpec
from femstruct.quantities import Position3
from femstruct_guest.strut import Strut


class StrutSpec(PartSpec):
    """A bar that only stretches, from a start to an end."""

    makes = Strut
    known_as = ("part",)
    type: Literal["strut"]
    material: MaterialName
    area: Area
    start: Position3
    end: Position3
