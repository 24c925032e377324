"""Three rigid bodies in a row (section 2.2.1): a ball hits a mass on a spring that touches a damper.

In units of the middle mass and of its frequency on its spring, the ball with speed 1.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import minimize_scalar

from femstruct.arrays import Floats
from femstruct.impact.batch import simulate_batch
from femstruct.impact.response import Response
from femstruct.impact.scene import Body, Clock, Contact, Scene
from femstruct.impact.simulate import simulate
from femstruct.laws.linear import Linear
from femstruct.modal.closed_form import oscillator

WINDOW = 40.0  # long enough for the last contact of a soft damper, omega_d = 0.1


@dataclass(frozen=True)
class Share:
    """Energies in the final state over the ball's at the start: numbers, or arrays of many collisions."""

    damper: Any
    ball: Any
    mass: Any


BASIS, _points = oscillator(1.0, stiffness=1.0, axis="z")
PLACE = _points["m"].probe("z")


def setting(rb: float, rd: float, wb: float, wd: float) -> Scene:
    """rb, rd : masses of ball and damper; wb, wd : contact frequencies."""
    return Scene(
        (Body("ball", rb, -1.0), Body("damper", rd)),
        (Contact("ball", "ball", PLACE, Linear(rb * wb**2)), Contact("damper", PLACE, "damper", Linear(rd * wd**2))),
    )


def hit(rb: float, rd: float, wb: float, wd: float, samples: int = 10, window: float = WINDOW) -> Response:
    """The collision of a `setting`."""
    return simulate(BASIS, setting(rb, rd, wb, wd), Clock(window, samples / window))


def share(rb: float, rd: float, wb: float, wd: float) -> Share:
    """Who has the energy in the end."""
    last, start = hit(rb, rd, wb, wd).ledger.end, 0.5 * rb
    return Share(last.bodies["damper"] / start, last.bodies["ball"] / start, last.structure / start)


def shares(rb: float, rd: float, wb: Floats, wd: Floats) -> Share:
    """As `share`, for many contact frequencies of one shape at once; the energies have it, too."""
    of_ball, of_damper = np.broadcast_arrays(wb, wd)
    vary = {"ball.stiffness": rb * of_ball.ravel() ** 2, "damper.stiffness": rd * of_damper.ravel() ** 2}
    last = simulate_batch(BASIS, setting(rb, rd, 1.0, 1.0), Clock(WINDOW, 10 / WINDOW), vary, 1).end
    start = 0.5 * rb
    energies = (last.bodies["damper"], last.bodies["ball"], last.structure)
    return Share(*((energy / start).reshape(of_ball.shape) for energy in energies))


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
