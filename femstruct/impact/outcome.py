"""How a run ended, as a sentence."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import inf

from femstruct.arrays import Floats
from femstruct.impact.bodies import Clock, Scene
from femstruct.impact.response import Event, Outcome

LAST = 0.1  # share of the window in which bodies that rest no longer bounce
STILL = 0.1  # share of gravity that their mean acceleration may have in it


def outcome_of(
    scene: Scene, clock: Clock, log: Sequence[Event], all_open: bool, velocity: Mapping[str, Floats]
) -> Outcome:
    """The outcome of a run with these events; all_open : whether all contacts are open after the last one.

    velocity : of the bodies at the samples [m/s].
    """
    if not scene.contacts:
        return Outcome.NO_CONTACTS
    if not log:
        return Outcome.NEVER_TOUCHED
    if all_open:
        return Outcome.SEPARATED
    return Outcome.RESTING if _rests(scene, clock, log, velocity) else Outcome.CLOSED_AT_END


def _rests(scene: Scene, clock: Clock, log: Sequence[Event], velocity: Mapping[str, Floats]) -> bool:
    """Whether all contacts that are closed at the end carry a body that gravity pulls, and did so for a while: no
    event in the last part of the window, in which the body hardly gained speed. A ball in the middle of a bounce
    gains speed at many times gravity."""
    last = {event.contact: event for event in log}
    closed = [c for c in scene.contacts if c.name in last and last[c.name].what == "closes"]
    if not scene.gravity or any(event.t > (1.0 - LAST) * clock.duration for event in last.values()):
        return False
    weighing = {body.name for body in scene.bodies if body.falls}
    for contact in closed:
        carried = [end for end in (contact.upper, contact.lower) if isinstance(end, str) and end in weighing]
        if not carried or any(_gain(velocity[name], clock) > STILL * scene.gravity for name in carried):
            return False
    return True


def _gain(velocity: Floats, clock: Clock) -> float:
    """Mean acceleration over the last part of the window [m/s^2], infinite where it has no two samples."""
    first = min(round((1.0 - LAST) * len(velocity)), len(velocity) - 2)
    if first < 0:
        return inf
    return float(abs(velocity[-1] - velocity[first])) * clock.sampling / (len(velocity) - 1 - first)
