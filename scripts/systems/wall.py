"""A mass that hits a rigid wall: force records like those of sections 2.4.2 and 3.3, which are not printed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from femstruct.impact.collisions import pulse_of
from femstruct.impact.scene import GROUND, Body, Clock, Contact, Scene
from femstruct.impact.simulate import simulate
from femstruct.laws.hertz import Hertz
from femstruct.laws.hunt_crossley import HuntCrossley
from femstruct.laws.linear import Linear
from femstruct.modal.closed_form import given_modes
from femstruct.workflow.fit import Fit, fit

NOISE = 0.01  # of the peak
GRAVITY = 9.81  # [m/s^2]
HEIGHTS = (0.15, 0.2, 0.25)  # of Table 3.1 [m]
TENNIS, ACRYLIC = (0.054, (2.1e5, 3.1e5, 4.1e5), 160.0), (0.045, (3.3e7,) * 3, 500.0)  # [kg], k_cb, c_cb by height
TABLE_2_6 = {"steel": 1.5e8, "brass": 8e7, "aluminium": 6e7, "plastic": 6e6}  # [N/m]
WINDOWS = {TENNIS[0]: 8e-3, ACRYLIC[0]: 1.2e-3}  # [s]
EMPTY = given_modes([], [], {})[0]
WallLaw = Hertz | HuntCrossley | Linear


@dataclass(frozen=True)
class Record:
    """A force of a mass [kg] that meets the wall with a speed [m/s], at t [s]."""

    mass: float
    speed: float
    t: np.ndarray
    force: np.ndarray


def force(law: WallLaw, mass: float, speed: float, t: np.ndarray) -> np.ndarray:
    """Force [N] at evenly spaced t from 0."""
    scene = Scene((Body("mass", mass, -speed),), (Contact("hit", "mass", GROUND, law),))
    return simulate(EMPTY, scene, Clock(len(t) * t[1], 1.0 / t[1])).contacts["hit"].force


def drops(ball: tuple[float, tuple[float, ...], float]) -> list[Record]:
    """Records of a ball of Table 3.1 from its three heights."""
    mass, stiffnesses, damping = ball
    return [
        record(Hertz(k, damping), mass, float(np.sqrt(2.0 * GRAVITY * height)), WINDOWS[mass], seed)
        for seed, (height, k) in enumerate(zip(HEIGHTS, stiffnesses, strict=True))
    ]


def collisions() -> dict[str, Record]:
    """Records of 1 kg at 1 m/s on the contacts of Table 2.6."""
    return {
        name: record(Linear(k), 1.0, 1.0, float(1.3 * np.pi / np.sqrt(k)), seed)
        for seed, (name, k) in enumerate(TABLE_2_6.items())
    }


def record(law: WallLaw, mass: float, speed: float, duration: float, seed: int, samples: int = 300) -> Record:
    """The force with noise of 1 % of its peak."""
    t = duration / samples * np.arange(samples)
    clean = force(law, mass, speed, t)
    noise = NOISE * clean.max() * np.random.default_rng(seed).standard_normal(samples)
    return Record(mass, speed, t, clean + noise)


def found_hertz(measured: Record) -> Fit:
    """Stiffness and damping of the Hertz law, started from the closed form of the pulse."""
    start = pulse_of(measured.t, measured.force).hertz(measured.mass, measured.speed)

    def history(values: Mapping[str, float]) -> np.ndarray:
        law = Hertz(values["stiffness"], values["damping"])
        return force(law, measured.mass, measured.speed, measured.t)

    return fit(history, measured.force, {"stiffness": start.stiffness, "damping": start.damping})


def found_linear(measured: Record) -> Fit:
    """Stiffness of the spring alone, started from the duration of the pulse."""
    start = measured.mass * (np.pi / pulse_of(measured.t, measured.force).duration) ** 2

    def history(values: Mapping[str, float]) -> np.ndarray:
        return force(Linear(values["stiffness"]), measured.mass, measured.speed, measured.t)

    return fit(history, measured.force, {"stiffness": float(start)})


def found_together(records: list[Record]) -> Fit:
    """One law k d^n (1 + chi d') for several records, every second sample of each."""
    halved = [replace(one, t=one.t[::2], force=one.force[::2]) for one in records]

    def history(values: Mapping[str, float]) -> np.ndarray:
        law = HuntCrossley(values["stiffness"], values["exponent"], values["dissipation"])
        return np.concatenate([force(law, one.mass, one.speed, one.t) for one in halved])

    start = {"stiffness": 3e5, "dissipation": 0.2, "exponent": 1.7}
    return fit(history, np.concatenate([one.force for one in halved]), start)
