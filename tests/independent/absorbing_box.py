"""A box whose walls absorb or yield: its cosines in closed form, coupled by what the walls take up.

Mode n of a box, of unit mean square, has (k_n^2 + (s^2 + 2 gamma s) / (c^2 (1 + s tau))) P_n + (s + 2 gamma) / c sum_m
A_nm P_m = rho (s + 2 gamma) / V times its integral over what moves. A_nm is the integral of psi_n psi_m over a wall and
its volume, times the root of the wall's admittances at both modes. Along a wall cosines are orthogonal, and at it they
are +1 or -1: A_nm is known without an integral.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import pi

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

from tests.independent.box_pistons import AXES, Piston, mean_cosine

Floats = np.ndarray


def paris(admittance: float) -> float:
    """Absorption of sound from all directions by a real admittance: the mean of 1 - |R|^2 over sin 2 theta."""
    r = 1 / admittance
    return float(quad(lambda cosine: 8 * r * cosine**2 / (1 + r * cosine) ** 2, 0, 1)[0])


def admittance_of(absorption: float) -> float:
    """The stiff one of the two that absorb so."""
    return float(brentq(lambda y: paris(y) - absorption, 1e-9, 0.6)) if absorption else 0.0


def at_frequencies(by_band: Mapping[float, float], hz: Floats) -> Floats:
    """Admittances between those of bands, along the logarithm of frequency; of the last ones beyond."""
    bands = sorted(by_band)
    known = [admittance_of(by_band[band]) for band in bands]
    return np.interp(np.log(np.maximum(hz, bands[0])), np.log(bands), known)


@dataclass(frozen=True)
class AbsorbingBox:
    """walls : absorption by frequency, of those that absorb. up_to : modes up to it [Hz]."""

    size: tuple[float, float, float]
    walls: Mapping[str, Mapping[float, float]]
    up_to: float
    c: float = 343.0
    rho: float = 1.21
    gamma: float = 0.0
    tau: float = 0.0

    def modes(self) -> tuple[Floats, Floats]:
        """Frequencies [n], ascending, the uniform one first, and orders [n, 3]."""
        most = [int(2 * self.up_to * side / self.c) + 1 for side in self.size]
        orders = np.stack(np.meshgrid(*(np.arange(n) for n in most), indexing="ij"), axis=-1).reshape(-1, 3)
        hz = self.c / 2 * np.sqrt(((orders / np.array(self.size)) ** 2).sum(axis=1))
        order = np.argsort(hz, kind="stable")
        order = order[hz[order] <= self.up_to]
        return hz[order], orders[order]

    def absorbed(self) -> Floats:
        """A [n, n] [1/m]."""
        hz, orders = self.modes()
        whole = np.zeros((len(hz), len(hz)))
        for wall, absorption in self.walls.items():
            axis = AXES[wall]
            beside = np.delete(orders, axis, axis=1)
            alike = (beside[:, None] == beside).all(axis=2)
            end = np.sqrt(np.where(orders[:, axis] > 0, 2.0, 1.0))
            if wall in ("x1", "y1", "ceiling"):
                end = end * (-1.0) ** orders[:, axis]
            root = end * np.sqrt(at_frequencies(absorption, hz))
            whole += alike * np.outer(root, root) / self.size[axis]
        return whole

    def at(self, place: Sequence[float]) -> Floats:
        """Values of the modes [n]."""
        orders = self.modes()[1]
        values = np.cos(pi * orders * np.array(place) / np.array(self.size)).prod(axis=1)
        return np.asarray(np.sqrt(2.0 ** (orders > 0).sum(axis=1)) * values)

    def over(self, piston: Piston) -> Floats:
        """Integrals of the modes [n] over a piston."""
        orders = self.modes()[1]
        low, high = piston.corners(self.size)
        means = [mean_cosine(orders[:, axis] * pi / self.size[axis], low[axis], high[axis]) for axis in range(3)]
        return np.asarray(piston.area * np.sqrt(2.0 ** (orders > 0).sum(axis=1)) * np.prod(means, axis=0))

    def per_velocity(self, s: Floats, piston: Piston, place: Sequence[float], rigid: bool = False) -> Floats:
        """Pressure [nf] at a place per velocity of a piston into the room. rigid : as if no wall absorbed."""
        hz, absorbed = self.modes()[0], self.absorbed()
        squared, driven, heard = (2 * pi * hz / self.c) ** 2, self.over(piston), self.at(place)
        volume, found = float(np.prod(self.size)), []
        for one in s:
            lossy = one + 2 * self.gamma
            own = squared + one * lossy / (self.c**2 * (1 + one * self.tau))
            answer = driven / own if rigid else np.linalg.solve(np.diag(own) + lossy / self.c * absorbed, driven)
            found.append(self.rho * lossy / volume * (heard @ answer))
        return np.array(found)
