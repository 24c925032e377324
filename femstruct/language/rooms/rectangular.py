"""Rectangular rooms as they are written."""

from __future__ import annotations

from typing import Any

import numpy as np

from acoustics.fields.rectangular import Room
from femstruct.language.rooms.closed import ClosedSpec, Size
from femstruct.language.yaml import Here


class BoxRoomSpec(ClosedSpec):
    """A rectangular room under a surface, and its receivers.

    at: centre of the surface in the ceiling, from the room's corner; by default the middle.
    surfaces: further surfaces of the structure, by the wall of the room that they move: here its ceiling alone.
    coupling: one-way (the air does not react on the structure) or two-way.
    animate: a frequency, `pulse`, or a list of these: a moving picture of each.
    levels: standards for the levels of a standard source: ISO 16283-2 and ISO 717-2, or JIS A 1419-2 and KS F 2863-2.
    ensemble: rooms with sides within 5 %, places of source and microphones drawn anew, over which low rated bands have
        a mean and an interval; 0 for none.
    beyond_modes: what rated bands have that the modes do not reach: statistical (the default), levels of statistical
        energies, which a single bare plate has, or blank.
    """

    size: Size

    def room(self, here: Here, receivers: Any, sources: Any, shaped: Any) -> Room:
        return Room(np.array(self.size), self.air.noun(), self.losses_of())
