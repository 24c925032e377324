"""The force of one blow on an infinite plate: the source's own mass and law before the plate's resistance."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from math import sqrt
from typing import Final

import numpy as np

from acoustics.levels.bands import third_octave_bands
from acoustics.statistical.energies import band_exposures
from acoustics.statistical.infinite_plate import InfinitePlate
from femstruct.arrays import Floats
from femstruct.impact.laws.law import Law
from femstruct.impact.result.response import Response
from femstruct.impact.scene.bodies import Body, Clock, Contact, Scene
from femstruct.impact.simulate import simulate
from femstruct.modal.analytic import oscillator
from femstruct.study.acting import PlacedBody

SAMPLES: Final = 4000  # of a blow
FIRST_S: Final = 5e-3  # how long it is looked at first, ...
LONGER: Final = 4.0  # ... and how many times longer as long as the contact is closed
LONGEST_S: Final = 2.0
GONE: Final = 1e-6  # of the peak: less of a force that dies away and never ends, as of a stiff hammer, is over
NO_MASS_S: Final = 1e-7  # mass of what is struck over its resistance: gone before any blow has begun
_MOST_HZ: Final = 1e6


def blow_exposures(bodies: Iterable[PlacedBody], plate: InfinitePlate, bands_hz: Sequence[float]) -> dict[float, float]:
    """Force exposures {nominal third octave [Hz]: [N^2 s]} of one blow on an infinite plate, the mean over bodies.

    bodies : each with a speed and a law of its own.

    Notes
    -----
    The plate resists with 1 / Re Y at the middle of the bands: exact for a thin isotropic plate, for others close
    enough, since a blow is decided by its own mass and spring on all floors that are much heavier.
    """
    resistance = 1.0 / float(plate.mobility(np.array([sqrt(bands_hz[0] * bands_hz[-1])]))[0])
    every = third_octave_bands(_MOST_HZ)
    centres = {band: every[band] for band in bands_hz}
    alike: dict[tuple[float, float, Law], int] = {}
    for body in bodies:
        assert body.law is not None, "a body without a law strikes nothing"
        alike[body.mass, body.speed, body.law] = alike.get((body.mass, body.speed, body.law), 0) + 1
    found: list[Mapping[float, float]] = []
    for mass, speed, law in alike:
        found.append(band_exposures(*blow(mass, speed, law, resistance), centres))
    counts = np.array(list(alike.values()))
    return {band: float(np.average([one[band] for one in found], weights=counts)) for band in bands_hz}


def blow(mass: float, speed: float, law: Law, resistance: float) -> tuple[Floats, float]:
    """Force [nt] [N] and its step [s] of a mass [kg] with a speed [m/s] on a resistance [N s/m].

    A hammer on a spring and a rigid floor hands over 2 m v:

    >>> from femstruct.impact.laws.linear import Linear
    >>> force, dt = blow(0.5, 0.886, Linear(1e6), 1e9)
    >>> round(float(force.sum() * dt), 4)
    0.886
    """
    duration = FIRST_S
    while True:
        history = on_resistance(mass, speed, law, resistance, duration).contacts["blow"]
        if history.force[-1] <= GONE * history.peak_force or duration >= LONGEST_S:
            return np.array([*history.force, 0.0]), duration / SAMPLES
        duration *= LONGER


def on_resistance(mass: float, speed: float, law: Law, resistance: float, duration: float) -> Response:
    """The contact "blow" of a "body" of a mass [kg] with a speed [m/s] on a resistance [N s/m]; duration [s]."""
    basis, points = oscillator(resistance * NO_MASS_S, stiffness=0.0, axis="z")
    rate = np.array([[1.0 / NO_MASS_S]])
    basis = replace(basis, viscous=rate, dashpots=rate)
    struck = Contact("blow", "body", points["m"].probe("z"), law)
    return simulate(basis, Scene((Body("body", mass, -speed),), (struck,)), Clock(duration, SAMPLES / duration))
