"""What reaches supports and the ground without moving the structure: forces on held nodes, and on the ground itself."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import FemstructError
from femstruct.impact.result.response import Response
from femstruct.impact.scene.bodies import End, Ground
from femstruct.model.probe import Probe


def passed_on(response: Response, direct: Probe) -> Floats:
    """The share [nt] [N] of all that pushes the structure which reaches a support or joint without any motion.

    direct : of a `ForceRow`. Raises FemstructError when the pushes of the response are not those of its scene.
    """
    if not len(direct.weights):
        return np.zeros(len(response.t))
    shapes = response.basis.shapes

    def seen(end: End) -> Floats:
        """Modal displacements of an end, and what a unit force there passes on."""
        if isinstance(end, Probe):
            return np.append(end.of(shapes), direct.meets(end))
        return np.zeros(shapes.shape[2] + 1)

    known = _each_push(response, seen)
    if not len(known) and not response.pushed.any():  # it was only started
        return np.zeros(len(response.t))
    if not np.array_equal(known[:, :-1], response.pushed[: len(known)]) or response.pushed[len(known) :].any():
        raise FemstructError("passed_on", got="pushes in another order than the scene's")
    passed: Floats = known[:, -1] @ response.pushes[: len(known)]
    return passed


def on_the_ground(response: Response) -> Floats | None:
    """Force [nt] [N] of contacts and links on the ground itself, along the axis of the bodies; None where none ends
    there. It is measured from rest: what a preload or a body's weight presses with is left out."""
    share = _each_push(response, lambda end: np.array([float(isinstance(end, Ground))])).ravel()
    if not share.any():
        return None
    force: Floats = share @ response.pushes[: len(share)]
    return force


def _each_push(response: Response, seen: Callable[[End], Floats]) -> Floats:
    """What every push of a scene works on, a row each in the order of `Response.pushes`; seen : of one of its ends."""
    rows: list[Floats] = []
    for contact in response.scene.contacts:
        approach = seen(contact.lower) - seen(contact.upper)
        rows += [side * approach for side in contact.law.sides]
    rows += [seen(link.lower) - seen(link.upper) for link in response.scene.links]
    rows += [seen(load.on) for load in response.scene.loads]
    return np.array(rows).reshape(len(rows), -1) if rows else np.zeros((0, 1))
