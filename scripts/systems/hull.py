"""The small foam hull of section 5.3.2 as a flat bottom with walls, found from two frequencies, and its wave."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.optimize import brentq

from femstruct.assembly.matrices import assemble
from femstruct.impact.scene import Body, Clock, Contact, HalfSine, Load, Scene
from femstruct.impact.simulate import simulate
from femstruct.language.models import read_model
from femstruct.laws.linear import Linear
from femstruct.modal.basis import ModalBasis
from femstruct.modal.reduction import modal_basis
from femstruct.model.model import Model
from systems import boat

MODEL = Path(__file__).parents[2] / "models" / "foam_hull.yaml"
BENDING, TORSION = 293.0, 388.0  # Fig. 5.22 [Hz]
WAVE = BENDING / 10.0  # not printed [Hz]
START = 100e6  # E while the thickness is looked for [Pa]


@dataclass(frozen=True, eq=False)
class Hull:
    """A hull with walls of a height [m] that has both frequencies: thickness of its bottom [m], E [Pa], mass [kg]."""

    height: float
    thickness: float
    E: float
    model: Model
    basis: ModalBasis

    @property
    def mass(self) -> float:
        """All of it [kg]."""
        return self.basis.total_mass


def frequencies(basis: ModalBasis, model: Model) -> tuple[float, float]:
    """The first bending and torsion [Hz]: the front end moves in the middle, or at its corner only."""
    middle, corner = (np.abs(model.points[name].probe("z").of(basis.shapes)) for name in ("A", "corner"))
    elastic = basis.omega > 1.0
    bends, twists = elastic & (middle > 0.5 * corner), elastic & (middle < 1e-3 * corner)
    return float(basis.frequency_hz[np.argmax(bends)]), float(basis.frequency_hz[np.argmax(twists)])


def solved(height: float, thickness: float, E: float, count: int = 12) -> tuple[Model, ModalBasis]:
    """The hull of the file with other walls, bottom and foam."""
    arm = f"[0, 0, {height / 2!r}]"
    offsets = (f"parts.{part}.offsets.{end}={arm}" for part in ("sides", "ends") for end in ("start", "end"))
    changes = (f"sections.wall.height={height!r}", f"parts.bottom.thickness={thickness!r}", f"materials.foam.E={E!r}")
    model = read_model(MODEL, (*offsets, *changes))
    return model, modal_basis(assemble(model), count=count)


def identified(height: float = 0.05) -> Hull:
    """The thickness from the ratio of the two frequencies, which E does not change; then E from one of them."""

    def miss(thickness: float) -> float:
        model, basis = solved(height, thickness, START)
        bending, torsion = frequencies(basis, model)
        return torsion / bending - TORSION / BENDING

    thickness = float(brentq(miss, 0.02, 0.055, xtol=1e-6))
    model, basis = solved(height, thickness, START)
    E = START * (BENDING / frequencies(basis, model)[0]) ** 2
    return Hull(height, thickness, E, *solved(height, thickness, E, count=20))


def ratio(hull: Hull, mu: float, gamma: float, wave: float = WAVE) -> float:
    """Largest upward acceleration of the front end during the wave, over that without a damper.

    mu : damper mass over the hull's; gamma : omega_d / omega_w; wave : frequency of the half sine [Hz].
    """
    return _peak(hull, mu, gamma, wave) / _peak(hull, 0.0, gamma, wave)


def _peak(hull: Hull, mu: float, gamma: float, wave: float) -> float:
    """Under an even pressure of 1 Pa, up to 0.95 of its duration as for two masses [m/s^2]."""
    bodies, contacts = (), ()
    if mu:
        m = mu * hull.mass
        place = hull.model.points["B"].probe("z")
        bodies = (Body("damper", m),)
        contacts = (Contact("damper", "damper", place, Linear(m * (gamma * 2.0 * np.pi * wave) ** 2)),)
    push = Load("wave", hull.model.surfaces["wet"].pressure(), HalfSine(1.0, wave))
    clock = Clock(0.95 * 0.5 / wave, boat.SAMPLES * 2.0 * wave)
    response = simulate(hull.basis, Scene(bodies, contacts, loads=(push,)), clock)
    return boat.peak(response.acceleration(hull.model.points["A"].probe("z").of(hull.basis.shapes)))
