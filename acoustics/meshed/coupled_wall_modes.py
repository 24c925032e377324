"""Modes of a room that its walls couple: the complex modes of its pressures, its flows and the walls that yield."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.linalg import eig

from acoustics.air import Air
from acoustics.arrays import Complexes, Floats
from acoustics.losses import Losses
from acoustics.meshed.finite_elements import CavityModes
from acoustics.meshed.yielding_walls import WallMotion

Answer = tuple[Floats | Complexes, Floats | Complexes, Callable[[Complexes], Complexes]]


def complex_modes(modes: CavityModes, air: Air, losses: Losses, absorbed: Floats, motion: WallMotion) -> Answer:
    """(left, right, term): pressures of the modes are left @ (term(s) * (right @ integrals of psi_n v)); the rest as
    `resonances`."""
    poles, left, right = resonances(modes, air, losses, absorbed, motion)

    def term(s: Complexes) -> Complexes:
        ratio: Complexes = (1 + losses.relaxation_time * s) / (s - poles[:, None])
        return ratio

    return left, right, term


def resonances(
    modes: CavityModes, air: Air, losses: Losses, absorbed: Floats, motion: WallMotion
) -> tuple[Complexes, Complexes, Complexes]:
    """Poles [m] [1/s] of a room and its walls, what of the pressures of its modes is in each [n, m], and how these
    drive it [m, n].

    absorbed [n, n] : A, of `acoustics.meshed.absorbing_walls.absorbed` [1/m].

    Notes
    -----
    With tau the relaxation time, gamma the decay rate, w the displacement of the walls out of the room, L its integrals
    with the modes, kappa = rho c^2 / V, x_n = omega_n P_n / (s + 2 gamma) and the elastic part Q of the pressure,

        s Q = kappa (v - L s w) - c A P - omega x,        P = (1 + tau s) Q,
        m s^2 w + r s w + k w = L^T P.

    A wall without mass has a displacement, but no velocity, among the states. Without a resistance either, of its own
    or of the air that it compresses, it follows the pressure, and its compliance joins that of the air.
    """
    n, tau, kappa = len(absorbed), losses.relaxation_time, air.bulk_modulus / modes.mesh.volume
    heavy = motion.mass > 0
    still = ~heavy & (motion.resistance == 0) & (tau == 0)
    slow = ~heavy & ~still
    L = modes.shapes.T @ motion.loads
    along = np.vstack([np.zeros(n - 1), np.diag(air.c * modes.wavenumber[1:])])  # the uniform mode has no flow
    sizes = [n, n - 1, int(slow.sum()), int(heavy.sum()), int(heavy.sum()), n]
    parts = np.split(np.eye(sum(sizes)), np.cumsum(sizes)[:-1])  # rows over the states and, last, the motion
    elastic, flow, yielded, moved, moving, driven = parts
    give = np.linalg.inv(np.eye(n) + tau * air.c * absorbed)
    taken = kappa * (driven - L[:, heavy] @ moving) - along @ flow
    pressure = give @ (elastic + tau * taken)  # of walls without mass at rest
    resistance = np.diag(motion.resistance[slow]) + tau * kappa * L[:, slow].T @ give @ L[:, slow]
    yielding = np.linalg.solve(resistance, L[:, slow].T @ pressure - motion.stiffness[slow, None] * yielded)
    pressure = pressure - tau * kappa * give @ L[:, slow] @ yielding
    compliance = np.eye(n) + kappa * (L[:, still] / motion.stiffness[still]) @ L[:, still].T
    held = motion.resistance[heavy, None] * moving + motion.stiffness[heavy, None] * moved
    rates = np.vstack(
        [
            np.linalg.solve(compliance, taken - kappa * L[:, slow] @ yielding - air.c * absorbed @ pressure),
            along.T @ pressure - 2 * losses.decay_rate * flow,
            yielding,
            moving,
            (L[:, heavy].T @ pressure - held) / motion.mass[heavy, None],
        ]
    )
    poles, vectors = eig(rates[:, :-n])
    right = np.linalg.solve(vectors, rates[:, -n:].astype(np.complex128))
    return poles, vectors[:n], right
