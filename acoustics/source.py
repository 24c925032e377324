"""The moving ceiling: the one door into the acoustic wing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from acoustics.arrays import Floats, freeze, frozen, positive
from acoustics.errors import AcousticsError
from acoustics.rooms.box import Room, inside


@dataclass(frozen=True, eq=False)
class SurfaceVelocity:
    """Normal velocity of a surface of the room, factored: v(x, t) = sum_k shapes[:, k] rates[k, :].

    points : [p, 3], on the ceiling, from the room's lower corner [m].
    weights : [p], quadrature weights, the area each point stands for [m^2].
    shapes : [p, k], normal displacement of each mode at the points, positive INTO the room, where it raises the
        pressure.
    rates : [k, nt], velocity of each modal coordinate; shapes times rates is m/s.
    dt : sampling interval [s].

    Raises AcousticsError: shapes that do not fit, weights not positive, dt not positive.

    Notes
    -----
    What the points do not cover of the ceiling is rigid.

    >>> import numpy as np
    >>> v = SurfaceVelocity([[0.25, 0.5, 1], [0.75, 0.5, 1]], [0.5, 0.5], [[1], [1]], [np.ones(3)], dt=0.5)
    >>> v.area, v.t.tolist()
    (1.0, [0.0, 0.5, 1.0])
    """

    points: Floats
    weights: Floats
    shapes: Floats
    rates: Floats
    dt: float

    def __post_init__(self) -> None:
        points = frozen("surface.points", self.points, (None, 3))
        weights = frozen("surface.weights", self.weights, (len(points),))
        shapes = frozen("surface.shapes", self.shapes, (len(points), None))
        rates = frozen("surface.rates", self.rates, (shapes.shape[1], None))
        if (weights <= 0).any():
            raise AcousticsError("surface.weights", got=f"{weights.min():g} m^2", expected="positive areas")
        if rates.shape[1] < 2:
            raise AcousticsError("surface.rates", got=f"{rates.shape[1]} samples", expected="at least 2")
        dt = positive("surface.dt", self.dt, "s")
        freeze(self, points=points, weights=weights, shapes=shapes, rates=rates, dt=dt)

    @cached_property
    def sizes(self) -> Floats:
        """Root of the summed squares of every modal rate [k], the size of its part in the motion."""
        sizes: Floats = np.sqrt(np.einsum("kt,kt->k", self.rates, self.rates))
        return sizes

    @property
    def t(self) -> Floats:
        """Times of the samples [nt] [s], from 0."""
        return self.dt * np.arange(self.rates.shape[1], dtype=np.float64)

    @property
    def area(self) -> float:
        """Area the points stand for [m^2]."""
        return float(self.weights.sum())


def on_ceiling(surface: SurfaceVelocity, room: Room) -> None:
    """Refuse a surface whose points do not lie on the room's ceiling, or cover more than it has.

    Raises AcousticsError: a point off the plane z = Lz by more than 1e-6 of the room's size, a point outside the
    rectangle, weights that sum to more than the area of the ceiling.
    """
    off = np.abs(surface.points[:, 2] - room.size[2])
    if off.max() > 1e-6 * room.size.max():
        raise AcousticsError(
            "surface.points",
            got=f"z = {surface.points[off.argmax(), 2]:g} m",
            expected=f"the ceiling of the room, z = {room.size[2]:g} m",
            do="measure from the room's lower corner, z up",
        )
    flat = surface.points.copy()
    flat[:, 2] = room.size[2]
    inside(room, "surface.points", flat)
    if surface.area > room.ceiling_area * (1 + 1e-6):
        raise AcousticsError(
            "surface.weights",
            got=f"a sum of {surface.area:g} m^2",
            expected=f"at most the ceiling, {room.ceiling_area:g} m^2",
            do="give each point its share of the area",
        )


def alike(surfaces: Sequence[SurfaceVelocity]) -> None:
    """Refuse surfaces that are not motions of one ceiling.

    Raises AcousticsError: none, or other points, weights, shapes or sampling.
    """
    if not surfaces:
        raise AcousticsError("surfaces", got="none", expected="at least one")
    first = surfaces[0]
    for other in surfaces[1:]:
        same = all(
            np.array_equal(getattr(first, word), getattr(other, word)) for word in ("points", "weights", "shapes")
        )
        if not same or other.dt != first.dt or other.rates.shape != first.rates.shape:
            raise AcousticsError("surfaces", got="surfaces that differ", expected="the same ceiling")
