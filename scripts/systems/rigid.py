"""Three rigid bodies in a row (section 2.2.1): a ball hits a mass on a spring that touches a damper.

In units of the middle mass and of its frequency on its spring, the ball with speed 1.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

from femstruct import Body, Clock, Contact, Linear, Response, Scene, simulate
from femstruct.modal.analytic import oscillator

WINDOW = 40.0  # long enough for the last contact of a soft damper, omega_d = 0.1


@dataclass(frozen=True)
class Share:
    """Energies in the final state over the ball's at the start."""

    damper: float
    ball: float
    mass: float


def hit(rb: float, rd: float, wb: float, wd: float, samples: int = 10, window: float = WINDOW) -> Response:
    """rb, rd : masses of ball and damper; wb, wd : contact frequencies."""
    basis, points = oscillator(1.0, stiffness=1.0, axis="z")
    place = points["m"].probe("z")
    scene = Scene(
        (Body("ball", rb, -1.0), Body("damper", rd)),
        (Contact("ball", "ball", place, Linear(rb * wb**2)), Contact("damper", place, "damper", Linear(rd * wd**2))),
    )
    return simulate(basis, scene, Clock(window, samples / window))


def share(rb: float, rd: float, wb: float, wd: float) -> Share:
    """Who has the energy in the end."""
    last, start = hit(rb, rd, wb, wd).ledger.end, 0.5 * rb
    return Share(last.bodies["damper"] / start, last.bodies["ball"] / start, last.structure / start)


def best_damper(rb: float, rd: float, wb: float) -> tuple[float, float]:
    """omega_d / omega_b at the largest energy of the damper, and that energy."""
    grid = wb * np.geomspace(0.05, 4.0, 25)
    values = [share(rb, rd, wb, wd).damper for wd in grid]
    i = int(np.clip(np.argmax(values), 1, len(grid) - 2))
    found = minimize_scalar(
        lambda log: -share(rb, rd, wb, float(np.exp(log))).damper,
        bounds=(np.log(grid[i - 1]), np.log(grid[i + 1])),
        method="bounded",
        options={"xatol": 1e-4},
    )
    return float(np.exp(found.x)) / wb, -float(found.fun)
