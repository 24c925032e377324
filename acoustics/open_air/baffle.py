"""The plane that the half space lies in front of, and its receivers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from acoustics.air import Air
from acoustics.arrays import Floats, freeze, frozen
from acoustics.errors import AcousticsError
from acoustics.receivers import Receiver, positions


@dataclass(frozen=True, eq=False)
class Baffle:
    """An infinite plane, rigid except for what moves in it, and the air in front of it.

    normal : [3], unit vector into the air. The plane goes through the origin; so do receivers' coordinates.

    >>> Baffle(normal=[0, 0, -1]).normal.tolist()
    [0.0, 0.0, -1.0]
    """

    air: Air = field(default_factory=Air)
    normal: Floats = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))

    def __post_init__(self) -> None:
        normal = frozen("field.normal", self.normal, (3,))
        if abs(np.linalg.norm(normal) - 1) > 1e-9:
            raise AcousticsError("field.normal", got=f"{normal.tolist()}", expected="a unit vector")
        freeze(self, normal=normal)


def in_front(space: Baffle, receivers: Sequence[Receiver]) -> Floats:
    """Where the receivers are [n, 3] [m].

    Raises AcousticsError: none, or one that is not in front of the plane.
    """
    places = positions(receivers)
    for receiver, height in zip(receivers, places @ space.normal, strict=True):
        if not height > 0:
            raise AcousticsError(
                f"receiver {receiver.name}",
                got=f"{receiver.position.tolist()} m, {-height:g} m behind the surface",
                expected="a point in front of it",
            )
    return places


def on_plane(space: Baffle, points: Floats) -> None:
    off = np.abs(points @ space.normal)
    extent = float(np.ptp(points, axis=0).max())
    if off.max() > 1e-6 * extent:
        raise AcousticsError(
            "surface.points",
            got=f"a point {off.max():g} m off the plane of the baffle",
            expected="a flat surface through the origin",
        )
