"""A boat as two masses under a half-sine wave (section 5.2), and with the bending of its hull (section 5.3.2).

In units of the boat's mass, the wave's frequency and amplitude: the free boat without a damper has acceleration 1.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from scipy.optimize import minimize_scalar

from femstruct.impact.response import Response
from femstruct.impact.scene import Body, Clock, Contact, HalfSine, Load, Scene
from femstruct.impact.simulate import simulate
from femstruct.laws.linear import Linear
from femstruct.modal.basis import ModalBasis
from femstruct.modal.closed_form import beam, given_modes, oscillator
from femstruct.model.probe import Point

SAMPLES = 400  # a pulse; peaks are refined by parabolas, whose error is then of the order of 1e-8
WAVE_HZ = 1.0 / (2.0 * np.pi)


def optimum(mu: float, beta: float = 0.0) -> float:
    """omega_d / omega_w by 5.43, with beta = omega / omega_w; 5.45 for beta = 0."""
    return float(np.sqrt(9.0 * (9.0 - beta**2) / (9.0 * (1.0 + mu) - beta**2)))


def ratio_at_optimum(mu: float) -> float:
    """a / a0 at the point of 5.45, in closed form: (2 sqrt(2) / 9) sqrt((1 + mu) / mu)."""
    return float(2.0 * np.sqrt(2.0) / 9.0 * np.sqrt((1.0 + mu) / mu))


def wave(mu: float, gamma: float, beta: float = 0.0, pulses: float = 0.95) -> Response:
    """The boat under the wave, with a damper of mass mu and contact frequency gamma; mu = 0 for none."""
    basis, points = oscillator(1.0, stiffness=beta**2, axis="z")
    return _pushed(basis, points["m"], points["m"], mu, gamma, pulses)


def _pushed(basis: ModalBasis, pushed: Point, touched: Point, mu: float, gamma: float, pulses: float) -> Response:
    load = Load("wave", pushed.probe("z"), HalfSine(1.0, WAVE_HZ))
    if mu == 0.0:
        return simulate(basis, Scene(loads=(load,)), Clock(pulses * np.pi, SAMPLES / np.pi, tolerance=1e-7))
    contact = Contact("damper", "damper", touched.probe("z"), Linear(mu * gamma**2))
    scene = Scene((Body("damper", mu),), (contact,), loads=(load,))
    return simulate(basis, scene, Clock(pulses * np.pi, SAMPLES / np.pi, tolerance=1e-7))


def peak(values: np.ndarray) -> float:
    """Largest value, by the parabola through the largest sample and its neighbours."""
    i = int(np.argmax(values))
    if i in (0, len(values) - 1):
        return float(values[i])
    a, b, c = values[i - 1 : i + 2]
    return float(b - 0.125 * (c - a) ** 2 / (a - 2.0 * b + c))


def acceleration(response: Response) -> np.ndarray:
    """Of the boat, whose modal shape is 1."""
    return response.acceleration(np.ones(1))


@cache
def ratio(mu: float, gamma: float, beta: float = 0.0) -> float:
    """a / a0: largest accelerations during the wave with and without the damper."""
    return peak(acceleration(wave(mu, gamma, beta))) / _alone(beta)


@cache
def _alone(beta: float) -> float:
    """Largest acceleration without a damper."""
    return peak(acceleration(wave(0.0, 0.0, beta)))


def best(mu: float, beta: float = 0.0, low: float = 1.2, high: float = 3.8) -> tuple[float, float]:
    """omega_d / omega_w at the smallest a / a0, and that ratio: scanned, then narrowed to 1e-5."""
    grid = np.linspace(low, high, 14)
    i = int(np.argmin([ratio(mu, float(g), beta) for g in grid]))
    bounds = (grid[max(i - 1, 0)], grid[min(i + 1, len(grid) - 1)])
    found = minimize_scalar(
        lambda g: ratio(mu, float(g), beta), bounds=bounds, method="bounded", options={"xatol": 1e-5}
    )
    return float(found.x), float(found.fun)


def hull(elastic: float, modes: int = 6) -> tuple[ModalBasis, dict[str, Point]]:
    """A uniform free-free beam of unit mass whose first bending frequency is `elastic` times the wave's.

    Points: "front" (an end), "middle", and "water": an even pressure, which pushes the rigid translation alone,
    because all other modes of a uniform beam have no mean.
    """
    shapes, points = beam(1.0, 1.0, 1.0, ("free", "free"), modes, {"front": 1.0, "middle": 0.5})
    bending = shapes.omega[2:] / shapes.omega[2] * elastic
    at = {name: points[name].probe("z").of(shapes.shapes) for name in points}
    even = np.zeros(modes)
    even[0] = at["middle"][0]  # the translation, 1 / sqrt(m)
    frequencies = np.concatenate([np.zeros(2), bending]) * WAVE_HZ
    return given_modes(
        list(frequencies), [0.0] * modes, {name: list(row) for name, row in (at | {"water": even}).items()}
    )


def hull_ratio(mu: float, gamma: float, elastic: float, pulses: float = 0.95) -> float:
    """a / a0 at the front end of the hull, the damper in the middle."""
    basis, points = hull(elastic)
    front = points["front"].probe("z").of(basis.shapes)
    with_damper, without = (
        _pushed(basis, points["water"], points["middle"], mass, gamma, pulses).acceleration(front) for mass in (mu, 0.0)
    )
    return peak(with_damper) / peak(without)
