"""How runs ended, as a sentence: one run, or all of a batch at once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf, isfinite, sqrt

import numpy as np
from numpy.typing import NDArray

from femstruct.arrays import Floats
from femstruct.impact.laws.linear import Linear
from femstruct.impact.result.response import Outcome
from femstruct.impact.scene.bodies import Contact, Scene

LAST = 0.125  # share of the window in which bodies that rest no longer bounce
REST_ACCELERATION = 0.1  # share of gravity that their mean acceleration may have in it
SETTLED = 10.0  # time constants after which e^-10 is left
ROUNDING = 1e-9  # of critical damping, as a law made from a restitution of 0 has it

Flags = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Endings:
    """What the outcomes of runs are told from, each [runs].

    duration [s] : of the window. last [s] : when each contact closed or opened for the last time, nan if never; closed
    : whether it was closed then. gain [m/s^2] : mean acceleration of each body over the last part of the window, either
    way.
    """

    duration: float
    last: Mapping[str, Floats]
    closed: Mapping[str, Flags]
    gain: Mapping[str, Floats]


def outcomes_of(scene: Scene, endings: Endings, runs: int) -> tuple[Outcome, ...]:
    """The outcome of every run of a scene; gravity and contacts are the same in all."""
    touched = np.zeros(runs, dtype=bool)
    closed = np.zeros(runs, dtype=bool)
    for name in endings.closed:
        touched |= ~np.isnan(endings.last[name])
        closed |= endings.closed[name]
    held = any(contact.preload > 0.0 for contact in scene.contacts)
    kinds = (*Outcome,)
    which = np.full(runs, kinds.index(Outcome.SEPARATED))
    which[closed] = kinds.index(Outcome.CLOSED_AT_END)
    which[closed & _rest(scene, endings, runs)] = kinds.index(_at_rest(scene))
    untouched = Outcome.HELD if held else Outcome.NEVER_TOUCHED if scene.contacts else Outcome.NO_CONTACTS
    which[~touched] = kinds.index(untouched)
    return tuple(kinds[i] for i in which)


def _at_rest(scene: Scene) -> Outcome:
    """How a run is called all of whose closed contacts are at rest."""
    if scene.gravity > 0.0:
        return Outcome.RESTING
    together = any(isfinite(_holds_after(scene, contact)) for contact in scene.contacts)
    return Outcome.TOGETHER if together else Outcome.HELD


def _holds_after(scene: Scene, contact: Contact) -> float:
    """How long after its closing [s] a contact that never lets its ends part has brought them to rest together:
    one with a dashpot that pulls, at or beyond critical damping z. Infinite for all others.

    Notes: what is left falls as exp(-w (z - sqrt(z^2 - 1)) t).
    """
    masses = [body.mass for body in scene.bodies if body.name in (contact.upper, contact.lower)]
    law = contact.law
    if not masses or not law.tensile or not isinstance(law, Linear):
        return inf
    w = sqrt(law.stiffness * sum(1.0 / mass for mass in masses))
    z = 0.5 * law.damping * w / law.stiffness
    return inf if z < 1.0 - ROUNDING else SETTLED / (w * (z - sqrt(max(z * z - 1.0, 0.0))))


def _rest(scene: Scene, endings: Endings, runs: int) -> Flags:
    """Whether all contacts that are closed at the end carry a body that gravity pulls, were closed at the start or hold
    their ends together, and did so for a while: no event in the last part of the window, in which the body hardly
    gained speed. A ball in the middle of a bounce gains speed at many times gravity."""
    rest = np.ones(runs, dtype=bool)
    weighing = {body.name for body in scene.bodies if body.falls and scene.gravity > 0.0}
    for contact in scene.contacts:
        last, closed = endings.last[contact.name], endings.closed[contact.name]
        rest &= ~(last > (1.0 - LAST) * endings.duration)
        held = contact.preload > 0.0  # by a weight that lies on it, or by what it clamps
        bodies = [end for end in (contact.upper, contact.lower) if isinstance(end, str)]
        carried = [name for name in bodies if name in weighing or held]
        over = endings.duration - last > _holds_after(scene, contact)
        still = np.full(runs, bool(carried) or held) | over
        for name in carried if scene.gravity > 0.0 else ():
            still &= endings.gain[name] <= REST_ACCELERATION * scene.gravity
        rest &= still | ~closed
    return rest


def gain_of(velocity: Floats, end_velocity: float, duration: float) -> float:
    """Mean acceleration of a body over the last part of the window [m/s^2], from its samples [nt] [m/s]."""
    first = min(round((1.0 - LAST) * len(velocity)), len(velocity) - 1)
    return abs(end_velocity - float(velocity[first])) / (duration * (1.0 - first / len(velocity)))
