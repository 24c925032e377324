"""A rigid piston in the ceiling of a box of air: pressure per force, with the air pushing back and a leak or without.

The air by cosines of the ceiling (`box_pistons`); a tube, whose piston is all of it, by plane waves.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi

import numpy as np

from tests.independent.box_pistons import Piston, PistonsBox

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
class CeilingPiston:
    """A rectangle of the ceiling of a box of air that moves."""

    box: PistonsBox
    piston: Piston

    def per_velocity(self, s: Floats, place: Sequence[float]) -> Floats:
        """Pressure at a place per velocity of the piston into the room."""
        return np.asarray(self.box.at(s, [self.piston], place)[0])

    def on_piston(self, s: Floats) -> Floats:
        """Force of the air on it per velocity into the room."""
        return np.asarray(self.box.between(s, [self.piston])[:, 0, 0])

    def per_force(
        self, moved: Oscillator, s: Floats, place: Sequence[float], two_way: bool, leak: Floats | None
    ) -> Floats:
        """Pressure per upward force on the piston. leak : pressure per flow [nf] of an opening that is spread over it.

        The flow into the room is S v - U; the mean pressure on the piston is Z / S^2 times it and drives U = p / leak.
        """
        heard, air = self.per_velocity(s, place), self.on_piston(s)
        if not two_way:
            return np.asarray(-s * heard / moved.dynamic(s))
        kept = 1.0 if leak is None else leak / (leak + air / self.piston.area**2)
        return np.asarray(-s * kept * heard / (moved.dynamic(s) + s * kept * air))


def ceiling_piston(
    size: tuple[float, float, float], rectangle: tuple[float, float, float, float], **air: float
) -> CeilingPiston:
    """The rectangle [x, y, length, width] of the ceiling of a box; air : as of `PistonsBox`."""
    x, y, length, width = rectangle
    return CeilingPiston(PistonsBox(size, **air), Piston("ceiling", (x, y), (length, width)))


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
