"""A rigid piston in the ceiling of a box of air: pressure per force, with the air pushing back and a leak or without.

The wave equation weighted by cosines of the ceiling has, for the order (i, j), p = A cosh(q z) / (q sinh(q H)) with
q^2 = (i pi / a)^2 + (j pi / b)^2 - k^2, and Euler's equation at the ceiling gives A from the flow there: its weight
times rho (s + 2 gamma). k^2 = -(s^2 + 2 gamma s) / (c^2 (1 + s tau)); with losses as the dissertation writes them
k = w (1 - j beta) / c and gamma = 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi

import numpy as np

Floats = np.ndarray


@dataclass(frozen=True)
class Oscillator:
    """The piston: mass, natural frequency [Hz] and loss: 2 x the damping ratio, or with `hysteretic` a loss factor of
    the stiffness."""

    mass: float
    hz: float
    loss: float
    hysteretic: bool = False

    def dynamic(self, s: Floats) -> Floats:
        """Force per displacement."""
        own = 2 * pi * self.hz
        lost = 1j * self.loss * own * own if self.hysteretic else self.loss * own * s
        return np.asarray(self.mass * (own * own + s * s + lost))


@dataclass(frozen=True)
class PistonBox:
    """A box and the rectangle [x, y, length, width] of its ceiling that moves."""

    size: tuple[float, float, float]
    piston: tuple[float, float, float, float]
    c: float = 343.0
    rho: float = 1.21
    gamma: float = 0.0
    tau: float = 0.0
    beta: float = 0.0
    orders: int = 80

    @property
    def area(self) -> float:
        return self.piston[2] * self.piston[3]

    def _fields(self, s: Floats, height: float) -> Floats:
        """rho (s + 2 gamma) cosh(q z) / (q sinh(q H)) [orders, orders, nf]."""
        k2 = -(s * s + 2 * self.gamma * s) / (self.c**2 * (1 + s * self.tau)) * (1 - 1j * self.beta) ** 2
        lx, ly, lz = self.size
        n = np.arange(self.orders)
        q = np.sqrt(((n * pi / lx)[:, None] ** 2 + (n * pi / ly) ** 2)[..., None] - k2)
        over = (np.exp(q * (height - lz)) + np.exp(-q * (height + lz))) / (q * (1 - np.exp(-2 * q * lz)))
        return np.asarray(self.rho * (s + 2 * self.gamma) * over)

    def _integrals(self) -> tuple[Floats, Floats]:
        """Of cosines along each side of the piston."""
        found = []
        for start, long, whole in zip(self.piston[:2], self.piston[2:], self.size[:2], strict=True):
            k = np.arange(1, self.orders) * pi / whole
            found.append(np.r_[long, (np.sin(k * (start + long)) - np.sin(k * start)) / k])
        return found[0], found[1]

    def _weights(self) -> Floats:
        """Of a flow that the piston makes with unit velocity."""
        x, y = self._integrals()
        twice = np.r_[1.0, np.full(self.orders - 1, 2.0)]
        return np.asarray(np.outer(twice * x, twice * y) / (self.size[0] * self.size[1]))

    def per_velocity(self, s: Floats, place: Sequence[float]) -> Floats:
        """Pressure at a place per velocity of the piston into the room."""
        n = np.arange(self.orders)
        level = np.outer(*(np.cos(n * pi * at / whole) for at, whole in zip(place[:2], self.size[:2], strict=True)))
        return np.asarray(((self._weights() * level)[..., None] * self._fields(s, place[2])).sum(axis=(0, 1)))

    def on_piston(self, s: Floats) -> Floats:
        """Force of the air on it per velocity into the room."""
        weights = self._weights() * np.outer(*self._integrals())
        return np.asarray((weights[..., None] * self._fields(s, self.size[2])).sum(axis=(0, 1)))

    def per_force(
        self, moved: Oscillator, s: Floats, place: Sequence[float], two_way: bool, leak: Floats | None
    ) -> Floats:
        """Pressure per upward force on the piston. leak : pressure per flow [nf] of an opening that is spread over it.

        The flow into the room is S v - U; the mean pressure on the piston is Z / S^2 times it and drives U = p / leak.
        """
        heard, air = self.per_velocity(s, place), self.on_piston(s)
        if not two_way:
            return np.asarray(-s * heard / moved.dynamic(s))
        kept = 1.0 if leak is None else leak / (leak + air / self.area**2)
        return np.asarray(-s * kept * heard / (moved.dynamic(s) + s * kept * air))


@dataclass(frozen=True)
class Tube:
    """A piston that is the whole ceiling of a box, over a floor of an impedance: plane waves.

    p = A (cosh(q z) + rho (s + 2 gamma) / (q Z) sinh(q z)), which has the velocity -p / Z at the floor.
    """

    area: float
    height: float
    c: float = 343.0
    rho: float = 1.21
    gamma: float = 0.0
    tau: float = 0.0

    def per_velocity(self, s: Floats, z: float, impedance: Floats) -> Floats:
        """Pressure per velocity of the piston into the room."""
        q = np.sqrt((s * s + 2 * self.gamma * s) / (1 + s * self.tau)) / self.c
        inert = self.rho * (s + 2 * self.gamma)
        share, H = inert / (q * impedance), self.height
        slope = q * (np.sinh(q * H) + share * np.cosh(q * H))
        return np.asarray(inert * (np.cosh(q * z) + share * np.sinh(q * z)) / slope)

    def per_force(self, moved: Oscillator, s: Floats, z: float, impedance: Floats, two_way: bool) -> Floats:
        """Pressure per upward force on the piston."""
        back = s * self.area * self.per_velocity(s, self.height, impedance) * two_way
        return np.asarray(-s * self.per_velocity(s, z, impedance) / (moved.dynamic(s) + back))
