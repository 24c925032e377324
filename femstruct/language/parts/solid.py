"""Solids as they are written."""

from __future__ import annotations

from typing import Literal

from femstruct.language.model.from_mesh import FromMeshSpec
from femstruct.language.parts.part import MESHED, STRESSED, MaterialName
from femstruct.language.yaml import Direction3
from femstruct.parts.solid import Solid


class SolidSpec(FromMeshSpec):
    """A solid on tetrahedra and hexahedra of a mesh file. orientation, normal: directions of the x and of the z of a
    material that has directions."""

    makes = Solid
    known_as = ("part", "plate or shell", MESHED, STRESSED)
    type: Literal["solid"]
    material: MaterialName
    orientation: Direction3 | None = None
    normal: Direction3 = (0.0, 0.0, 1.0)
