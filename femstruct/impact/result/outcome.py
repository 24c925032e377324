"""How runs ended, as a sentence: one run, or all of a batch at once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from femstruct.arrays import Floats
from femstruct.impact.result.response import Outcome
from femstruct.impact.scene.bodies import Scene

LAST = 0.125  # share of the window in which bodies that rest no longer bounce
REST_ACCELERATION = 0.1  # share of gravity that their mean acceleration may have in it

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
    which[closed & _rest(scene, endings, runs)] = kinds.index(Outcome.RESTING if scene.gravity > 0.0 else Outcome.HELD)
    untouched = Outcome.HELD if held else Outcome.NEVER_TOUCHED if scene.contacts else Outcome.NO_CONTACTS
    which[~touched] = kinds.index(untouched)
    return tuple(kinds[i] for i in which)


def _rest(scene: Scene, endings: Endings, runs: int) -> Flags:
    """Whether all contacts that are closed at the end carry a body that gravity pulls, or were closed at the start, and
    did so for a while: no event in the last part of the window, in which the body hardly gained speed. A ball in the
    middle of a bounce gains speed at many times gravity."""
    rest = np.ones(runs, dtype=bool)
    weighing = {body.name for body in scene.bodies if body.falls and scene.gravity > 0.0}
    for contact in scene.contacts:
        last, closed = endings.last[contact.name], endings.closed[contact.name]
        rest &= ~(last > (1.0 - LAST) * endings.duration)
        held = contact.preload > 0.0  # by a weight that lies on it, or by what it clamps
        bodies = [end for end in (contact.upper, contact.lower) if isinstance(end, str)]
        carried = [name for name in bodies if name in weighing or held]
        still = np.full(runs, bool(carried) or held)
        for name in carried if scene.gravity > 0.0 else ():
            still &= endings.gain[name] <= REST_ACCELERATION * scene.gravity
        rest &= still | ~closed
    return rest


def gain_of(velocity: Floats, end_velocity: float, duration: float) -> float:
    """Mean acceleration of a body over the last part of the window [m/s^2], from its samples [nt] [m/s]."""
    first = min(round((1.0 - LAST) * len(velocity)), len(velocity) - 1)
    return abs(end_velocity - float(velocity[first])) / (duration * (1.0 - first / len(velocity)))
