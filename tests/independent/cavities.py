"""Two rigid plates with air or wool between them: waves across the depth, by every cosine that a tilt displaces.

A plate has three motions: along z, and x and y about its middle times a turn. Of a cosine of wavenumber k along the
plates, p = A cosh(q z) + B sinh(q z) with q^2 = k^2 + s^2 rho / K, and Euler's equation at both faces of a layer gives
forces per displacement, rho s^2 / q times coth(q d) and -1 / sinh(q d). Layers share the motion of the face between
them. Exact at any depth.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import pi

import numpy as np
from scipy.linalg import eigh

Floats = np.ndarray
Spot = tuple[int, float, float]  # plate, 0 for the lower, and a place on it
P0_SHARE = 1 / 1.4  # isothermal over adiabatic modulus of air
_PRANDTL = 0.71


@dataclass(frozen=True)
class Fluid:
    """Air, or wool in it: sigma its flow resistivity, bulk its density, which the air carries along if `limp`.

    Of wool: density rho + sigma / s, limp the drag in series with the bulk; modulus between isothermal and adiabatic
    with a thermal length of twice the viscous one (Allard, Atalla, 2009, chapter 5).
    """

    c: float
    rho: float
    sigma: float = 0.0
    bulk: float = 0.0
    limp: bool = False

    def at(self, s: complex) -> tuple[complex, complex]:
        """Density and modulus."""
        stiff = self.rho * self.c**2
        if not self.sigma:
            return self.rho, stiff
        drag = self.sigma / s
        if self.limp:
            drag = 1 / (1 / drag + 1 / self.bulk)
        w = self.sigma / (4 * self.rho * _PRANDTL)
        return self.rho + drag, stiff * (s + w) / (s + w / P0_SHARE)


@dataclass(frozen=True)
class Pair:
    """size : of the plates; masses : per area, of the lower and the upper; layers : depth and fluid, from the lower;
    springs : to the ground, at spots; bays : along x, each with air of its own: from the middle of a joist to that of
    the next, and how much of that joists leave clear, over which the motion is spread."""

    size: tuple[float, float]
    masses: tuple[float, float]
    layers: Sequence[tuple[float, Fluid]]
    springs: Mapping[Spot, float]
    bays: Sequence[tuple[float, float, float]] = ()
    orders: int = 40

    def _row(self, spot: Spot) -> Floats:
        plate, x, y = spot
        row = np.zeros(6)
        row[3 * plate : 3 * plate + 3] = 1.0, x - self.size[0] / 2, y - self.size[1] / 2
        return row

    def solid(self) -> tuple[Floats, Floats]:
        """Mass and stiffness of plates and springs."""
        (a, b), K = self.size, np.zeros((6, 6))
        M = np.kron(np.diag(self.masses), np.diag([1, a * a / 12, b * b / 12])) * a * b
        for spot, size in self.springs.items():
            K += size * np.outer(self._row(spot), self._row(spot))
        return M, K

    def air(self, s: complex) -> Floats:
        """Forces per displacement, upwards."""
        whole = np.zeros((6, 6), complex)
        for low, high, clear in self.bays or [(0.0, self.size[0], self.size[0])]:
            sides, middle = (clear, self.size[1]), (low + high - self.size[0]) / 2
            local = np.zeros((6, 6), complex)
            for axis in (None, 0, 1):
                pairs = np.zeros((2, 2), complex)
                for m in [0] if axis is None else range(1, self.orders, 2):
                    weight, k = sides[0] * sides[1], 0.0
                    if axis is not None:
                        weight *= 8 * sides[axis] ** 2 / (m * pi) ** 4
                        k = m * pi / sides[axis]
                    pairs = pairs + weight * self._faces(s, k)
                at = 0 if axis is None else axis + 1
                local[np.ix_([at, 3 + at], [at, 3 + at])] = pairs
            shift = np.eye(6)  # a turn lifts the middle of a bay
            shift[0, 1] = shift[3, 4] = middle
            shift[1, 1] = shift[4, 4] = (high - low) / clear
            whole += shift.T @ local @ shift
        return whole

    def _faces(self, s: complex, k: float) -> Floats:
        """Forces per displacement of the two outer faces, per area."""
        count = len(self.layers) + 1
        D = np.zeros((count, count), complex)
        for at, (depth, fluid) in enumerate(self.layers):
            rho, modulus = fluid.at(s)
            q = np.sqrt(k * k + s * s * rho / modulus + 0j)
            fall = np.exp(-q * depth)
            own, other = (1 + fall**2) / (1 - fall**2), -2 * fall / (1 - fall**2)
            D[at : at + 2, at : at + 2] += rho * s * s / q * np.array([[own, other], [other, own]])
        inner = np.arange(1, count - 1)
        ends = np.array([0, count - 1])
        across = D[np.ix_(inner, ends)]
        return np.asarray(D[np.ix_(ends, ends)] - across.T @ np.linalg.solve(D[np.ix_(inner, inner)], across))

    def receptance(self, hz: Floats, drive: Spot, response: Spot, ratio: float = 0.0, loss: float = 0.0) -> Floats:
        """Displacement per force; ratio : of every mode without air; loss : of the springs."""
        M, K = self.solid()
        squares, shapes = eigh(K, M)
        C = M @ shapes @ np.diag(2 * ratio * np.sqrt(squares)) @ shapes.T @ M
        found = []
        for f in hz:
            s = 2j * pi * f
            D = M * s * s + C * s + K * (1 + 1j * loss) + self.air(s)
            found.append(self._row(response) @ np.linalg.solve(D, self._row(drive)))
        return np.array(found)
