"""Concentrated bodies as they are written."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from femstruct.language.parts.part import PartSpec
from femstruct.language.yaml import MassKg, PointName, Position3, Quantity, read_by, so_many
from femstruct.parts.inertia import Inertia

INERTIA = Quantity(("inertia",))
_SIX = "[Ixx, Iyy, Izz] or [Ixx, Iyy, Izz, Ixy, Iyz, Izx]"
_moments = so_many(INERTIA.read, (3, 6), _SIX, "write it like [2 kg*m^2, 2 kg*m^2, 3 kg*m^2]")

_WRITTEN = Annotated[list[Annotated[float, INERTIA]], Field(min_length=3, max_length=6)]


class InertiaSpec(PartSpec):
    """A small rigid body at the places of a point (kg each: four places have four of them): mass, moments and products
    of inertia about its centre of mass, and how far that is from the point (offset, global axes)."""

    makes = Inertia
    type: Literal["inertia"]
    at: PointName
    mass: MassKg
    inertia: Annotated[tuple[float, ...], read_by(_moments, _WRITTEN)] = (0.0, 0.0, 0.0)
    offset: Position3 = (0.0, 0.0, 0.0)

    def given(self) -> dict[str, Any]:
        values = super().given()
        six = (*values.pop("inertia"), 0.0, 0.0, 0.0)
        return {**values, "moments": six[:3], "products": six[3:6]}
