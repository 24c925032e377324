"""Rigid pistons in any walls of a box of air: their pressures at places and on each other, by cosines of each wall.

The flow of a piston, in cosines of its wall, makes p = A cosh(q z) / (q sinh(q H)) with q^2 = (l pi / a)^2 +
(m pi / b)^2 - k^2, z from the wall opposite and H between both; A is rho (s + 2 gamma) times the flow's weight. Means
over a place, a rectangle of the same wall, of that opposite or of one beside it are integrals of cosines and of cosh.
k^2 = -(s^2 + 2 gamma s) / (c^2 (1 + s tau)); with losses as the dissertation writes them k = w (1 - j beta) / c.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi

import numpy as np

Floats = np.ndarray
AXES = {"x0": 0, "x1": 0, "y0": 1, "y1": 1, "floor": 2, "ceiling": 2}


@dataclass(frozen=True)
class Piston:
    """A rectangle of a wall: from its lowest corner, sides along the wall's two axes, in the order x, y, z."""

    wall: str
    low: tuple[float, float]
    sides: tuple[float, float]

    @property
    def axis(self) -> int:
        return AXES[self.wall]

    @property
    def inward(self) -> float:
        """Sign of the way into the room along its axis."""
        return -1.0 if self.wall in ("x1", "y1", "ceiling") else 1.0

    @property
    def along(self) -> list[int]:
        return [axis for axis in range(3) if axis != self.axis]

    @property
    def area(self) -> float:
        return self.sides[0] * self.sides[1]

    def corners(self, size: Sequence[float]) -> tuple[Floats, Floats]:
        """Lowest and highest corner [3] in a box."""
        low = np.full(3, 0.0 if self.inward > 0 else size[self.axis])
        high = low.copy()
        low[self.along] = self.low
        high[self.along] = np.add(self.low, self.sides)
        return low, high


def mean_cosine(k: Floats, low: float, high: float) -> Floats:
    """Means of cos(k x) from low to high; the values there where these are one."""
    if high == low:
        return np.cos(k * low)
    safe = np.where(k > 0, k, 1.0)
    return np.where(k > 0, (np.sin(safe * high) - np.sin(safe * low)) / (safe * (high - low)), 1.0)


@dataclass(frozen=True)
class PistonsBox:
    """The air. orders : cosines along each side of a wall."""

    size: tuple[float, float, float]
    c: float = 343.0
    rho: float = 1.21
    gamma: float = 0.0
    tau: float = 0.0
    beta: float = 0.0
    orders: int = 80

    def per_velocity(self, s: Floats, moved: Piston, low: Floats, high: Floats) -> Floats:
        """Mean pressure [nf] over a region, from its lowest to its highest corner, per velocity of a piston into the
        room."""
        k2 = -(s * s + 2 * self.gamma * s) / (self.c**2 * (1 + s * self.tau)) * (1 - 1j * self.beta) ** 2
        H, n, shares, horizontal = self.size[moved.axis], np.arange(self.orders), [], []
        for axis, start, side in zip(moved.along, moved.low, moved.sides, strict=True):
            k = n * pi / self.size[axis]
            weight = np.where(n > 0, 2.0, 1.0) * mean_cosine(k, start, start + side) * side / self.size[axis]
            shares.append(weight * mean_cosine(k, low[axis], high[axis]))
            horizontal.append(k)
        q = np.sqrt((horizontal[0][:, None] ** 2 + horizontal[1] ** 2)[..., None] - k2)
        from_far = np.array([low[moved.axis], high[moved.axis]])
        a, b = sorted(H - from_far) if moved.inward > 0 else from_far
        whole = q * (1 - np.exp(-2 * q * H))
        if a == b:
            over = (np.exp(q * (a - H)) + np.exp(-q * (a + H))) / whole
        else:
            ends = [np.exp(q * (z - H)) - np.exp(-q * (z + H)) for z in (a, b)]
            over = (ends[1] - ends[0]) / (q * (b - a)) / whole
        found = np.einsum("l,m,lmf->f", *shares, over)
        return np.asarray(self.rho * (s + 2 * self.gamma) * found)

    def at(self, s: Floats, pistons: Sequence[Piston], place: Sequence[float]) -> Floats:
        """Pressures [n, nf] at a place per velocity of each piston into the room."""
        where = np.array(place)
        return np.array([self.per_velocity(s, one, where, where) for one in pistons])

    def between(self, s: Floats, pistons: Sequence[Piston]) -> Floats:
        """Forces [nf, n, n] of the air on each piston, out of the room, per velocity of each into it."""
        rows = [one.area * self.over(s, pistons, one) for one in pistons]
        return np.moveaxis(np.array(rows), -1, 0)

    def over(self, s: Floats, pistons: Sequence[Piston], heard: Piston) -> Floats:
        """Mean pressures [n, nf] on one of them per velocity of each."""
        return np.array([self.per_velocity(s, one, *heard.corners(self.size)) for one in pistons])
