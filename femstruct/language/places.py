"""Regions, and stiffnesses and dashpots by direction, as they are written."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from femstruct.declared import exactly_one
from femstruct.errors import quote_value
from femstruct.model import regions
from femstruct.quantities import Dashpot, Length, Position2, Position3, Quantity, Stiffness, refuse
from femstruct.yaml.spec import Spec, Text, read_by

# ----------------------------------------------------------------------------------------------------------------------
# Stiffnesses and dashpots by direction, as they are written.
# ----------------------------------------------------------------------------------------------------------------------

RotationalStiffness = Annotated[float, Quantity(("rotational stiffness",), least=0.0)]
RotationalDashpot = Annotated[float, Quantity(("rotational damping",), least=0.0)]


def _six(**by_direction: float) -> tuple[float, ...]:
    return tuple(by_direction.values())


class SixStiffnesses(Spec):
    """Stiffness by direction, global axes."""

    makes = _six
    x: Stiffness = 0.0
    y: Stiffness = 0.0
    z: Stiffness = 0.0
    rx: RotationalStiffness = 0.0
    ry: RotationalStiffness = 0.0
    rz: RotationalStiffness = 0.0


class SixDashpots(SixStiffnesses):
    """Dashpots by direction, global axes."""

    x: Dashpot = 0.0
    y: Dashpot = 0.0
    z: Dashpot = 0.0
    rx: RotationalDashpot = 0.0
    ry: RotationalDashpot = 0.0
    rz: RotationalDashpot = 0.0


# ----------------------------------------------------------------------------------------------------------------------
# Regions of a plate as they are written.
# ----------------------------------------------------------------------------------------------------------------------


class RegionSpec(Spec):
    """A region of a part: nothing for all of it; the rim of a rectangle, a rectangle or a line of a plate; a named set
    or a box (lower and upper corner, global axes) of a part that is a mesh."""

    makes = regions.Region
    rim: tuple[Length, Length] | None = None
    rectangle: tuple[Length, Length] | None = None
    line: tuple[Position2, Position2] | None = None
    at: Position2 | None = None
    set: Text | None = None
    box: tuple[Position3, Position3] | None = None

    @property
    def is_line(self) -> bool:
        """Whether it is a line or a rim, not an area."""
        return self.rim is not None or self.line is not None

    def given(self) -> dict[str, Any]:
        kind = next(
            (key for key in ("line", "rim", "rectangle", "set", "box") if getattr(self, key) is not None), "whole"
        )
        size = self.rim or self.rectangle
        at = self.at if size else None
        return {"kind": kind, "size": size, "at": at, "line": self.line, "named": self.set, "box": self.box}


def _region(value: object) -> object:
    if value == "whole":
        return {}
    if not isinstance(value, dict):
        raise refuse(
            quote_value(value),
            "whole, {rectangle: [2.5, 4], at: [1.25, 2]} (sides and centre), {rim: [..]}, {line: [[..], [..]]} or "
            "{set: NAME}",
        )
    if value.keys() <= {"rim", "rectangle", "line", "at", "set", "box"}:
        exactly_one(value, ("rim", "rectangle", "line", "set", "box"))
    return value


AnyRegion = Annotated[
    RegionSpec,
    read_by(_region, Literal["whole"] | RegionSpec),
    Field(
        description="whole; {rectangle: [2.5, 4], at: [1.25, 2]} (sides and centre in the part's coordinates, without "
        "'at' in its middle); {rim: [..]}, {line: [[..], [..]]} or {set: NAME}"
    ),
]
