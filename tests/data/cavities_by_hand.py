"""Pistons and plates on a cavity, as their own coordinates have them: matrices for tests, and exact solutions."""

from __future__ import annotations

import numpy as np

from acoustics.air import Air
from acoustics.rooms.cavities import STILL_HZ, Cavity, CavityAir, Wool, cavity_air
from acoustics.source import SurfaceShapes

P0, RHO = 101325.0, 1.204
AIR = Air((1.4 * P0 / RHO) ** 0.5, RHO)
MASSES = 345.0, 20.0


def matrices(air: CavityAir, stiffness: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """M, C, K of mass-normalised coordinates of the surfaces with these stiffnesses, and of the air."""
    n, k = len(air.mass), len(stiffness)
    added = len(air.viscous) - n
    M, K = np.eye(n + added), np.zeros((n + added, n + added))
    M[:n, :n] = air.mass
    M[:k, :k] += np.eye(k)
    K[:n, :n] = air.compression.T @ air.compression
    K[:k, :k] += np.diag(stiffness)
    still = np.repeat([0.0, 2 * np.pi * STILL_HZ], [air.frames, added - air.frames])
    K[np.arange(n, n + added), np.arange(n, n + added)] = still**2
    return M, air.viscous, K


def poles(M: np.ndarray, C: np.ndarray, K: np.ndarray) -> np.ndarray:
    """All roots of lambda^2 M + lambda C + K [1/s]."""
    n = len(M)
    inverse = np.linalg.inv(M)
    state = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ K, -inverse @ C]])
    return np.asarray(np.linalg.eigvals(state))


def pistons(cavity: Cavity, up_to_hz: float, masses: tuple[float, float] = MASSES) -> CavityAir:
    """The air between two pistons of these masses per area over all of it."""
    area = float(cavity.size[0] * cavity.size[1])
    rows = np.diag(1.0 / np.sqrt(np.array(masses) * area))
    first, second = (SurfaceShapes([[*(cavity.size[:2] / 2), 0.0]], [area], [row]) for row in rows)
    return cavity_air(cavity, first, second, up_to_hz)


def driven(air: CavityAir, hz: float, masses: tuple[float, float] = MASSES) -> tuple[complex, complex]:
    """Velocities [m/s] of two free pistons of 1 m^2, 1 Pa on the first, both counted along the push."""
    M, C, K = matrices(air, np.zeros(2))
    s = 2j * np.pi * hz
    push = np.zeros(len(M))
    push[0] = masses[0] ** -0.5
    v = s * np.linalg.solve(s**2 * M + s * C + K, push)
    return complex(v[0]) * masses[0] ** -0.5, -complex(v[1]) * masses[1] ** -0.5


def exact(
    layers: list[tuple[float, Wool | None]], hz: float, masses: tuple[float, float] = MASSES
) -> tuple[complex, complex]:
    """The same by transfer matrices of pressure and velocity through layers from the first piston to the second."""
    s = np.array([2j * np.pi * hz])
    chain = np.eye(2, dtype=complex)
    for thickness, wool in layers:
        density = RHO if wool is None else wool.density_at(s, AIR)[0]
        modulus = AIR.bulk_modulus if wool is None else wool.modulus_at(s, AIR)[0]
        k = s[0] / 1j * np.sqrt(density / modulus + 0j)
        z, kd = np.sqrt(density * modulus + 0j), k * thickness
        chain = chain @ np.array([[np.cos(kd), 1j * z * np.sin(kd)], [1j * np.sin(kd) / z, np.cos(kd)]])
    # p1 = a p2 + b v2, v1 = c p2 + d v2; p2 = s m2 v2, 1 - p1 = s m1 v1
    (a, b), (c, d) = chain
    load = s[0] * masses[1]
    ratio = c * load + d
    v2 = 1.0 / (a * load + b + s[0] * masses[0] * ratio)
    return complex(ratio * v2), complex(v2)
