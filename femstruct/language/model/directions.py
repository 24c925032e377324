"""Stiffnesses and dashpots by direction, as they are written."""

from __future__ import annotations

from typing import Annotated

from femstruct.language.yaml import Quantity, Spec

Stiffness = Annotated[float, Quantity(("stiffness",), least=0.0)]
RotationalStiffness = Annotated[float, Quantity(("rotational stiffness",), least=0.0)]
Dashpot = Annotated[float, Quantity(("damping",), least=0.0)]
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
