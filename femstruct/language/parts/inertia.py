"""Concentrated bodies as they are written."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from femstruct.language.parts.base import Library, PartSpec, Surroundings
from femstruct.language.yaml.reader import Steps
from femstruct.language.yaml.spec import MassKg, Position3, Quantity, Text, read_by, refuse
from femstruct.parts.inertia import Inertia
from femstruct.units import shown_as

Moment = Annotated[float, Quantity(("inertia",))]


def _moments(value: object) -> object:
    """Three moments, or three and three products."""
    if not isinstance(value, list) or len(value) not in (3, 6):
        expected = "[Ixx, Iyy, Izz] or [Ixx, Iyy, Izz, Ixy, Iyz, Izx]"
        raise refuse(shown_as(value), expected, "write it like [2 kg*m^2, 2 kg*m^2, 3 kg*m^2]")
    return tuple(Quantity(("inertia",)).read(one) for one in value)


class InertiaSpec(PartSpec):
    """A small rigid body at the places of a point: mass, moments and products of inertia about its centre of mass, and
    how far that is from the point (offset, global axes)."""

    type: Literal["inertia"]
    at: Text
    mass: MassKg
    inertia: Annotated[
        tuple[float, ...], read_by(_moments, Annotated[list[Moment], Field(min_length=3, max_length=6)])
    ] = (0.0, 0.0, 0.0)
    offset: Position3 = (0.0, 0.0, 0.0)

    def check(self, steps: Steps, around: Surroundings) -> None:
        around.check.known((*steps, "at"), self.at, "point", around.points)

    def build(self, name: str, of: Library) -> Inertia:
        xx, yy, zz, xy, yz, zx = (*self.inertia, 0.0, 0.0, 0.0)[:6]
        return Inertia(name, self.at, self.mass, (xx, yy, zz), (xy, yz, zx), self.offset)
