"""How runs ended, as a sentence: one run, or all of a batch at once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from femstruct.arrays import Floats
from femstruct.impact.result.response import Outcome
from femstruct.impact.scene.bodies import Contact, Scene

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


def outcomes_of(
    scene: Scene, endings: Endings, runs: int, columns: Mapping[str, Floats] = MappingProxyType({})
) -> tuple[Outcome, ...]:
    """The outcome of every run of a scene; gravity and kinds of contacts are the same in all. columns : what differs
    [runs], by BODY.mass, CONTACT.stiffness, CONTACT.damping."""
    touched, closed, together = (np.zeros(runs, dtype=bool) for _ in range(3))
    still = {}
    for contact in scene.contacts:
        last, shut = endings.last[contact.name], endings.closed[contact.name]
        touched |= ~np.isnan(last)
        closed |= shut
        still[contact.name] = shut & (endings.duration - last > _settling(scene, contact, columns))
        together |= still[contact.name]
    held = any(contact.preload > 0.0 for contact in scene.contacts)
    kinds = (*Outcome,)
    which = np.full(runs, kinds.index(Outcome.SEPARATED))
    which[closed] = kinds.index(Outcome.CLOSED_AT_END)
    rest = closed & _rest(scene, endings, still)
    which[rest] = kinds.index(Outcome.RESTING if scene.gravity > 0.0 else Outcome.HELD)
    if not scene.gravity > 0.0:
        which[rest & together] = kinds.index(Outcome.TOGETHER)
    untouched = Outcome.HELD if held else Outcome.NEVER_TOUCHED if scene.contacts else Outcome.NO_CONTACTS
    which[~touched] = kinds.index(untouched)
    return tuple(kinds[i] for i in which)


def _settling(scene: Scene, contact: Contact, columns: Mapping[str, Floats]) -> Floats:
    """How long after its closing [s] a contact that never lets its bodies part has brought them to rest together
    [runs] or [1]; infinite for all others."""
    bodies = [body for body in scene.bodies if body.name in (contact.upper, contact.lower)]
    if not bodies:
        return np.array([inf])
    mass = 1.0 / sum(1.0 / columns.get(f"{body.name}.mass", np.array([body.mass])) for body in bodies)
    prefix = f"{contact.name}."
    own = {name.removeprefix(prefix): one for name, one in columns.items() if name.startswith(prefix)}
    found = contact.law.settling_time(np.asarray(mass), own)
    return np.array([inf]) if found is None else found


def _rest(scene: Scene, endings: Endings, still: Mapping[str, Flags]) -> Flags:
    """Whether all contacts that are closed at the end carry a body that gravity pulls, were closed at the start or hold
    their bodies together, and did so for a while: no event in the last part of the window, in which the body hardly
    gained speed. A ball in the middle of a bounce gains speed at many times gravity. still : of the contacts that hold
    bodies together, whether these are at rest on each other."""
    rest = np.ones(len(next(iter(still.values()), np.ones(1))), dtype=bool)
    weighing = {body.name for body in scene.bodies if body.falls and scene.gravity > 0.0}
    for contact in scene.contacts:
        last, closed = endings.last[contact.name], endings.closed[contact.name]
        rest &= ~(last > (1.0 - LAST) * endings.duration)
        held = contact.preload > 0.0  # by a weight that lies on it, or by what it clamps
        bodies = [end for end in (contact.upper, contact.lower) if isinstance(end, str)]
        carried = [name for name in bodies if name in weighing or held]
        quiet = still[contact.name] | bool(carried) | held
        for name in carried if scene.gravity > 0.0 else ():
            quiet = quiet & (endings.gain[name] <= REST_ACCELERATION * scene.gravity)
        rest &= quiet | ~closed
    return rest


def gain_of(velocity: Floats, end_velocity: float, duration: float) -> float:
    """Mean acceleration of a body over the last part of the window [m/s^2], from its samples [nt] [m/s]."""
    first = min(round((1.0 - LAST) * len(velocity)), len(velocity) - 1)
    return abs(end_velocity - float(velocity[first])) / (duration * (1.0 - first / len(velocity)))
