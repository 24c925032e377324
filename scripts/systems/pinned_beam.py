"""A beam pinned at one end that falls on a wave mass, with a damper on it (section 5.3.1)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

from femstruct.impact.batch import simulate_batch
from femstruct.impact.response import Response
from femstruct.impact.scene import GROUND, Body, Clock, Contact, Link, Scene
from femstruct.impact.simulate import simulate
from femstruct.laws.linear import Linear
from femstruct.modal.basis import ModalBasis
from femstruct.modal.closed_form import beam, given_modes
from femstruct.model.probe import Point

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


def falling(
    wave: float, mu: float = 0.0, damper: float = 0.0, modes: int = 6, added: float = 0.0
) -> tuple[ModalBasis, Mapping[str, Point], Scene]:
    """wave, damper : contact frequencies over that of the first elastic mode; mu : damper mass over the beam's; added :
    a mass fixed to the middle, over the beam's."""
    basis, points = beam(
        LENGTH, EI, MASS / LENGTH, ("pinned", "free"), modes, {"middle": LENGTH / 2, "free end": LENGTH}
    )
    first = basis.omega[1]
    if added:
        basis, points = _loaded(basis, points, added * MASS)
    middle = points["middle"].probe("z")
    contacts = [Contact("wave", middle, "wave", Linear(WAVE_MASS * (wave * first) ** 2))]
    bodies = [Body("wave", WAVE_MASS)]
    if mu:
        m = mu * MASS
        bodies.append(Body("damper", m, -SPIN * LENGTH / 2))
        contacts.append(Contact("damper", "damper", middle, Linear(m * (damper * first) ** 2)))
    links = (Link("water", "wave", GROUND, stiffness=WAVE_SPRING),)
    velocity = np.zeros(modes)
    velocity[0] = -SPIN * LENGTH / points["free end"].probe("z").of(basis.shapes)[0]
    return basis, points, Scene(tuple(bodies), tuple(contacts), links, velocity=velocity)


def _loaded(basis: ModalBasis, points: Mapping[str, Point], mass: float) -> tuple[ModalBasis, Mapping[str, Point]]:
    """As many modes with a mass [kg] fixed to the middle: those of I + m phi phi^T."""
    shapes = {name: point.probe("z").of(basis.shapes) for name, point in points.items()}
    middle = shapes["middle"]
    squares, vectors = eigh(np.diag(basis.omega**2), np.eye(len(middle)) + mass * np.outer(middle, middle))
    hertz = np.sqrt(np.maximum(squares, 0.0)) / (2.0 * np.pi)
    return given_modes(hertz, np.zeros(len(hertz)), {name: row @ vectors for name, row in shapes.items()})


def fall(
    wave: float, mu: float = 0.0, damper: float = 0.0, modes: int = 6, duration: float = 3e-3, sampling: float = 4e5
) -> Response:
    """The fall in time; see `falling`."""
    basis, _, scene = falling(wave, mu, damper, modes)
    return simulate(basis, scene, Clock(duration, sampling))


def accelerations(
    stiffness: float, mu: float = 0.0, ratio: float = 0.0, modes: int = 6, added: float = 0.0, place: str = "free end"
) -> tuple[np.ndarray, np.ndarray]:
    """t [s] up to 1.5 ms and the acceleration of a place [m/s^2]; stiffness : of the wave contact [N/m]; ratio :
    omega_d over omega_w."""
    wave = float(np.sqrt(stiffness / WAVE_MASS)) / (2.0 * np.pi * float(frequencies()[1]))
    basis, points, scene = falling(wave, mu, ratio * wave, modes, added)
    response = simulate(basis, scene, Clock(1.5e-3, 1e6))
    return response.t, response.acceleration(points[place].probe("z").of(basis.shapes))


def beam_energies(wave: float, mu: float, damper: np.ndarray) -> np.ndarray:
    """Energy of the beam (5.61) at the first separation over all before, of many dampers [n]; see `falling`."""
    basis, _, scene = falling(wave, mu, 1.0)
    m = mu * MASS
    varied = {"damper.stiffness": m * (damper * basis.omega[1]) ** 2}
    parted = simulate_batch(basis, scene, Clock(3e-3, 1e6), varied, 1).at_separation
    start = 0.5 * (MASS * LENGTH**2 / 3.0 + m * (LENGTH / 2.0) ** 2) * SPIN**2
    energies: np.ndarray = 1.0 - (parted.bodies["wave"] + parted.bodies["damper"]) / start
    return energies


def minima(wave: float, mu: float, ratios: np.ndarray) -> list[tuple[float, float]]:
    """omega_d / omega_w and energy of the beam at its lowest places between the ends of the ratios."""
    energies = beam_energies(wave, mu, ratios * wave)
    inner = np.flatnonzero((energies[1:-1] < energies[:-2]) & (energies[1:-1] < energies[2:])) + 1
    return [(float(ratios[i]), float(energies[i])) for i in inner]


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
