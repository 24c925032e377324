"""A beam pinned at one end that falls on a wave mass, with a damper on it (section 5.3.1)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from femstruct import GROUND, Body, Clock, Contact, Linear, Link, Response, Scene, simulate
from femstruct.modal.analytic import beam

LENGTH, EI, MASS = 0.4, 5.9, 0.12  # [m], [N m^2], [kg], Table 5.1
WAVE_MASS, WAVE_SPRING, SPIN = 0.022, 3100.0, 0.70  # [kg], [N/m], [rad/s]


@dataclass(frozen=True)
class Separation:
    """Energies over that of beam and damper before, at the first instant with both contacts open; t [s].

    modes : of the beam, the rigid one first; wave, spring : of the wave mass and its spring; damper.
    """

    t: float
    modes: np.ndarray
    wave: float
    spring: float
    damper: float

    @property
    def beam(self) -> float:
        """What 5.61 calls the energy of the beam: all but that of wave mass and damper."""
        return 1.0 - self.wave - self.damper

    @property
    def shares(self) -> np.ndarray:
        """Modal energies over the energy of the beam itself."""
        return self.modes / self.modes.sum()


def frequencies(modes: int = 6) -> np.ndarray:
    """Natural frequencies [Hz], the rigid one first."""
    return beam(LENGTH, EI, MASS / LENGTH, ("pinned", "free"), modes)[0].frequency_hz


def fall(
    wave: float, mu: float = 0.0, damper: float = 0.0, modes: int = 6, duration: float = 3e-3, sampling: float = 4e5
) -> Response:
    """wave, damper : contact frequencies over that of the first elastic mode; mu : damper mass over the beam's."""
    basis, points = beam(
        LENGTH, EI, MASS / LENGTH, ("pinned", "free"), modes, {"middle": LENGTH / 2, "free end": LENGTH}
    )
    first, middle = basis.omega[1], points["middle"].probe("z")
    contacts = [Contact("wave", middle, "wave", Linear(WAVE_MASS * (wave * first) ** 2))]
    bodies = [Body("wave", WAVE_MASS)]
    if mu:
        m = mu * MASS
        bodies.append(Body("damper", m, -SPIN * LENGTH / 2))
        contacts.append(Contact("damper", "damper", middle, Linear(m * (damper * first) ** 2)))
    links = (Link("water", "wave", GROUND, stiffness=WAVE_SPRING),)
    velocity = np.zeros(modes)
    velocity[0] = -SPIN * LENGTH / points["free end"].probe("z").of(basis.shapes)[0]
    scene = Scene(tuple(bodies), tuple(contacts), links, velocity=velocity)
    return simulate(basis, scene, Clock(duration, sampling))


def modal_energies(response: Response) -> np.ndarray:
    """Energy of every mode at every sample [k, nt] [J]."""
    return 0.5 * (response.qd**2 + (response.basis.omega[:, None] * response.q) ** 2)


def separation(response: Response) -> Separation:
    """Energies at the first instant with all contacts open; undamped modes keep theirs until the next contact."""
    stock, start = response.ledger.at_separation, response.ledger.start.total
    assert stock is not None
    after = int(np.ceil(stock.t * response.clock.sampling))
    modes = modal_energies(response)[:, after]
    assert abs(modes.sum() - stock.structure) < 1e-6 * start  # no contact has closed before that sample
    return Separation(
        stock.t,
        modes / start,
        stock.bodies["wave"] / start,
        stock.links["water"] / start,
        stock.bodies.get("damper", 0.0) / start,
    )
