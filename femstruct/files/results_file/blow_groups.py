"""Blows of bodies that strike several times, in the results file."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from femstruct.files.results_file.datasets import axis, put
from femstruct.files.tables.described import write_rows
from femstruct.impact.result.response import Blow

if TYPE_CHECKING:  # slow to import, and most runs write no such file
    import h5py


def write_blows(target: h5py.Group, blows: Sequence[Blow]) -> None:
    """A table of all blows, in the order of time."""
    blow = axis(target, "blow", np.arange(1, len(blows) + 1), "1", "Blow of any body, in the order of time")
    put(target, "body", [one.body for one in blows], "1", "Which body", (blow,))
    write_rows(target, blows, blow)
