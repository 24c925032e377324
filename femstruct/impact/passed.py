"""What passes through a structure without moving it: forces on nodes that are held."""

from __future__ import annotations

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import FemstructError
from femstruct.impact.bodies import End
from femstruct.impact.laws import Stop
from femstruct.impact.response import Response
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

    rows: list[Floats] = []
    for contact in response.scene.contacts:
        approach = seen(contact.lower) - seen(contact.upper)
        rows += [approach, -approach] if isinstance(contact.law, Stop) else [approach]
    rows += [seen(link.lower) - seen(link.upper) for link in response.scene.links]
    rows += [seen(load.on) for load in response.scene.loads]
    known = np.array(rows).reshape(-1, shapes.shape[2] + 1)
    if not np.array_equal(known[:, :-1], response.pushed[: len(known)]) or response.pushed[len(known) :].any():
        raise FemstructError("passed_on", got="pushes in another order than the scene's")
    passed: Floats = known[:, -1] @ response.pushes[: len(known)]
    return passed
