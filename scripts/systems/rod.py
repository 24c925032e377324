"""A free elastic rod between two masses (section 2.3), in units of its first elastic frequency."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from femstruct.impact.response import Response
from femstruct.impact.scene import Body, Clock, Contact, Scene
from femstruct.impact.simulate import simulate
from femstruct.laws.linear import Linear
from femstruct.modal.closed_form import rod

SPEED_OF_SOUND = 5042.0  # [m/s], pi c / L = 7.92e3 rad/s for 2 m (Table 2.3)
DENSITY = 7850.0


@dataclass(frozen=True)
class RodCase:
    """Masses [kg], length [m], number of modes with the rigid one, contact frequencies over the first elastic one.

    residual : put the flexibility of the modes left out in series with each contact.
    """

    wb: float
    wd: float
    modes: int = 50
    residual: bool = False
    length: float = 2.0
    mass: float = 5.0
    ball: float = 1.0
    damper: float = 1.0

    @property
    def first(self) -> float:
        """First elastic frequency [rad/s]."""
        return np.pi * SPEED_OF_SOUND / self.length

    def stiffness(self, mass: float, ratio: float) -> float:
        """Contact stiffness [N/m] of a mass and a frequency ratio, softened if the rod is to make up for its modes."""
        k = mass * (ratio * self.first) ** 2
        return k / (1.0 + k * self.flexibility) if self.residual else k

    @property
    def flexibility(self) -> float:
        """Static flexibility of a rod's end that the elastic modes used leave out: 2 / m sum of 1 / omega_r^2 [m/N]."""
        r = np.arange(1, self.modes)
        return 2.0 / self.mass * (np.pi**2 / 6.0 - float((1.0 / r**2).sum())) / self.first**2


def hit(case: RodCase, duration: float = 5e-3, sampling: float = 4e3) -> Response:
    """The ball hits the left end with 1 m/s, the damper touches the right end."""
    area = case.mass / (DENSITY * case.length)
    basis, points = rod(
        case.length,
        DENSITY * SPEED_OF_SOUND**2,
        DENSITY,
        area,
        case.modes,
        {"left": 0.0, "right": case.length},
    )
    contacts = (
        Contact("ball", points["left"].probe("x"), "ball", Linear(case.stiffness(case.ball, case.wb))),
        Contact("damper", "damper", points["right"].probe("x"), Linear(case.stiffness(case.damper, case.wd))),
    )
    bodies = (Body("ball", case.ball, 1.0), Body("damper", case.damper))
    return simulate(basis, Scene(bodies, contacts), Clock(duration, sampling))


def energies(case: RodCase) -> tuple[float, float, float]:
    """Energies of damper, ball and rod in the final state, over the ball's at the start."""
    last = hit(case).ledger.end
    start = 0.5 * case.ball
    return last.bodies["damper"] / start, last.bodies["ball"] / start, last.structure / start


def ball_speed(case: RodCase) -> float:
    """Velocity of the ball in the end over that before."""
    return float(hit(case).bodies["ball"].velocity[-1])
