"""Infinite layered floors in closed form: waves in slab, fill, wool and boards; tapping machine, field in a room."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import log10, pi, radians

import numpy as np
from numpy.typing import NDArray
from scipy.special import j1

from acoustics.levels.standards import CURVE_THIRDS
from femstruct.arrays import Floats

Complexes = NDArray[np.complex128]
C, RHO = 343.0, 1.21  # of air
HAMMER, SPEED, BLOWS = 0.5, 0.886, 10.0  # kg, m/s, a second
PATCH = 0.015  # m, radius of a hammer
INCIDENCE = 78.0  # degrees, up to which a field in a room arrives: custom
# ISO 717-1: reference curve 100 to 3150 Hz, spectra of C and C_tr
AIRBORNE = (33, 36, 39, 42, 45, 48, 51, 52, 53, 54, 55, 56, 56, 56, 56, 56)
PINK = (-29, -26, -23, -21, -19, -17, -15, -13, -12, -11, -10, -9, -9, -9, -9, -9)
TRAFFIC = (-20, -20, -18, -16, -15, -14, -13, -12, -11, -9, -8, -9, -10, -11, -13, -15)


@dataclass(frozen=True)
class Slab:
    """A plate that bends and shears: D, S along x and y [N m, N/m], torsion [N m], mass [kg/m^2], loss factor."""

    D: tuple[float, float]
    S: tuple[float, float]
    D66: float
    mass: float
    loss: float = 0.03

    @classmethod
    def of_layers(cls, *mm: float, rho: float = 470.0, G_rolling: float = 70e6) -> Slab:
        """CLT of C24, outer layers along x; D about the middle, S by the energy of the shear stresses."""
        h, found = 1e-3 * sum(mm), []
        for crosswise in (0, 1):
            z, shear, energy, D = -0.5 * h, 0.0, 0.0, 0.0
            for number, t in enumerate(mm):
                stiff = number % 2 == crosswise
                E, G = (11e9, 690e6) if stiff else (370e6, G_rolling)
                along = np.linspace(z, z + 1e-3 * t, 401)
                force = shear - 0.5 * E * (along**2 - z**2)
                energy += float(np.trapezoid(force**2, along)) / G
                z, shear, D = along[-1], force[-1], D + E * (along[-1] ** 3 - z**3) / 3
            found.append((D, D * D / energy))
        return cls((found[0][0], found[1][0]), (found[0][1], found[1][1]), 690e6 * h**3 / 12, rho * h)

    def stiffness(self, k: Floats, angle: Floats, omega: float) -> Complexes:
        """Force per area and deflection of a wave [Pa/m]."""
        x, y = np.cos(angle) ** 2, np.sin(angle) ** 2
        D = self.D[0] * x**2 + 4 * self.D66 * x * y + self.D[1] * y**2
        S = self.S[0] * x + self.S[1] * y
        found: Complexes = D * k**4 / (1 + D * k**2 / S) * (1 + 1j * self.loss) - self.mass * omega**2
        return found


@dataclass(frozen=True)
class Floor:
    """An infinite floor: slab, fill as a mass [kg/m^2] or with a wave speed [m/s], wool [Pa/m], boards on it."""

    slab: Slab
    fill: float = 0.0
    fill_speed: float = 0.0
    fill_loss: float = 0.0
    fill_thickness: float = 0.06
    wool: float = 0.0
    wool_loss: float = 0.2
    boards: tuple[float, float, float] = (0.0, 0.0, 0.0)  # kg/m^2, N m, loss factor

    def chain(self, k: Floats, angle: Floats, omega: float, air: Complexes | float) -> tuple[Complexes, Complexes]:
        """Stiffness where it is struck [Pa/m], and deflection of the slab for one there.

        air : what the air below puts against the slab [Pa/m].
        """
        at, moved = self.slab.stiffness(k, angle, omega) + air, np.ones_like(k + angle, dtype=complex)
        if self.fill and self.fill_speed:  # a line of compressional waves through its thickness
            modulus = self.fill / self.fill_thickness * self.fill_speed**2 * (1 + 1j * self.fill_loss)
            q = omega * np.sqrt(self.fill / self.fill_thickness / modulus)
            cos, sin, below = np.cos(q * self.fill_thickness), np.sin(q * self.fill_thickness), at / (modulus * q)
            top = cos + below * sin
            at, moved = modulus * q * (below * cos - sin) / top, moved / top
        else:
            at = at - self.fill * omega**2
        if self.wool:
            spring = self.wool * (1 + 1j * self.wool_loss)
            both = at * spring / (at + spring)
            moved = moved * both / at
            mass, D, loss = self.boards
            at = D * (1 + 1j * loss) * k**4 - mass * omega**2 + both
        return at, moved


LINES = 2 ** (np.arange(-4, 5, 2) / 30.0)  # of a third octave


def _angles(count: int = 12) -> Floats:
    found: Floats = (np.arange(count) + 0.5) / count * 0.5 * pi
    return found


def driven(floor: Floor, f: float, waves: int = 1500) -> tuple[complex, float, float]:
    """Point mobility [s/kg], power radiated below [W/N^2] and integral of the slab's v^2 [m^4/(s N)^2] per force."""
    omega, k0 = 2 * pi * f, 2 * pi * f / C
    at = (np.arange(200) + 0.5) / 200 * 0.5 * pi
    near = np.geomspace(k0 * (1 + 1e-6), max(400.0, 4 * k0), waves)
    k = np.concatenate([k0 * np.sin(at), near])[:, None]
    width = np.concatenate([k0 * np.cos(at) * (at[1] - at[0]), np.gradient(near)])
    vertical = np.where(k < k0, np.sqrt(np.abs(k0**2 - k**2)), -1j * np.sqrt(np.abs(k0**2 - k**2)))
    stiffness, slab = floor.chain(k, _angles()[None, :], omega, 1j * omega * RHO * omega / vertical)
    spread = 2 * j1(k * PATCH) / (k * PATCH)
    v = 1j * omega * spread / stiffness
    squared = (np.abs(v * slab) ** 2).mean(axis=1) * k[:, 0] * width / (2 * pi)
    mobility = complex((v.mean(axis=1) * k[:, 0] * width).sum() / (2 * pi))
    inside = k[:, 0] < k0
    power = float((squared[inside] * RHO * omega / vertical[inside, 0].real).sum())
    return mobility, power, float(squared.sum())


def impact_levels(floor: Floor, bands: Sequence[float] = CURVE_THIRDS) -> dict[float, float]:
    """L_n [dB] of the tapping machine: hammers that are rigid and do not rebound, on the mobility of the floor."""
    found = {}
    for band in bands:
        p2 = []
        for f in (band * LINES).tolist():
            mobility, power, _ = driven(floor, f)
            omega = 2 * pi * f
            force = abs(SPEED / (1j * omega) / (1 / (1j * omega * HAMMER) + mobility))  # spectrum of a blow [N s]
            mean_square = 2 * BLOWS * force**2 * band * (2 ** (1 / 6) - 2 ** (-1 / 6))
            p2.append(4 * RHO * C * power * mean_square / 10.0)
        found[band] = 10 * log10(float(np.mean(p2)) / 4e-10)
    return found


def sound_reduction(floor: Floor) -> dict[float, float]:
    """R [dB] of a field that arrives up to `INCIDENCE`."""
    at = (np.arange(60) + 0.5) / 60 * radians(INCIDENCE)
    weights = np.sin(at) * np.cos(at)
    found = {}
    for band in CURVE_THIRDS:
        tau = []
        for f in (band * LINES).tolist():
            omega = 2 * pi * f
            k, load = (omega / C * np.sin(at))[:, None], (1j * omega * RHO * C / np.cos(at))[:, None]
            stiffness, slab = floor.chain(k, _angles()[None, :], omega, load)
            through = np.abs(2 * load * slab / (stiffness + load)) ** 2
            tau.append(float((through.mean(axis=1) * weights).sum() / weights.sum()))
        found[band] = -10 * log10(float(np.mean(tau)))
    return found


def weighted_reduction(R: dict[float, float]) -> tuple[int, int, int]:
    """R_w, C, C_tr [dB] of ISO 717-1."""
    levels = np.round(list(R.values()), 1)
    shift = next(s for s in range(60, -60, -1) if np.clip(np.array(AIRBORNE) + s - levels, 0, None).sum() <= 32.0)
    number = 52 + shift
    adapted = (-10 * log10(float((10 ** ((np.array(one) - levels) / 10)).sum())) for one in (PINK, TRAFFIC))
    pink, traffic = (round(one) - number for one in adapted)
    return number, pink, traffic
