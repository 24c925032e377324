"""Blows of bodies that strike several times, in the results file."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from femstruct.files.hdf5 import axis, put
from femstruct.impact.result.response import Blow

if TYPE_CHECKING:  # slow to import, and most runs write no such file
    import h5py

_BLOWS: Final = (
    ("number", "1", "Number among the blows of its body"),
    ("t", "s", "When it is given its starting state"),
    ("interval", "s", "To the next blow of any body"),
    ("energy", "J", "What it brings less what it takes along when it is lifted off"),
    ("impulse", "N s", "Momentum it brings less what it takes along"),
    ("peak_force", "N", "Peak contact force until its next blow, between the samples"),
    ("peak_time", "s", "Time of the peak force"),
    ("closings", "1", "How often its contacts close until its next blow"),
    ("held_force", "N", "Contact force when it is lifted off for its next blow; 0 when the contact is open"),
    ("largest_energy", "J", "Largest energy of the structure in the interval"),
    ("left_energy", "J", "Energy of the structure at the end of the interval"),
    ("rest_after", "s", "From when on the structure has less than 1 % of its largest energy; nan if not in time"),
)


def write_blows(target: h5py.Group, blows: Sequence[Blow]) -> None:
    """A table of all blows, in the order of time."""
    blow = axis(target, "blow", np.arange(1, len(blows) + 1), "1", "Blow of any body, in the order of time")
    put(target, "body", [one.body for one in blows], "1", "Which body", (blow,))
    for name, unit, description in _BLOWS:
        values = [getattr(one, name) for one in blows]
        put(target, name, [np.nan if value is None else value for value in values], unit, description, (blow,))
