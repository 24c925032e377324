"""A box that is cut into cells: what a rectangular room with walls of its own is meshed with."""

from __future__ import annotations

from typing import Final

import numpy as np

from acoustics.air import Air
from acoustics.arrays import Floats, positive
from acoustics.errors import AcousticsError
from acoustics.meshed.cavity_mesh import CavityMesh, box_mesh
from acoustics.meshed.finite_elements import CELLS_PER_WAVE

MOST_CELLS: Final = 5000  # of a box that is cut for somebody: its modes take a minute then


def cut_box(size: Floats, up_to_hz: float, air: Air) -> CavityMesh:
    """A box [0, size] cut into cells, six to a wave at a frequency; its walls are x0, x1, y0, y1, floor and ceiling.

    Raises AcousticsError: more than 5000 cells.

    >>> cut_box(np.array([4.0, 3.0, 2.5]), 100.0, Air()).cells.shape
    (210, 8)
    """
    cells = [int(n) for n in np.ceil(size * CELLS_PER_WAVE * positive("up_to_hz", up_to_hz, "Hz") / air.c - 1e-9)]
    if np.prod(cells) > MOST_CELLS:
        share = (MOST_CELLS / np.prod(cells)) ** (1 / 3)
        raise AcousticsError(
            "up_to_hz",
            got=f"{up_to_hz:g} Hz, for which the room is cut into {np.prod(cells)} cells",
            expected=f"about {0.95 * share * up_to_hz:.0f} Hz or less, for {MOST_CELLS} cells at most",
        )
    mesh = box_mesh([float(side) for side in size], cells)
    names = {"z0": "floor", "z1": "ceiling"}
    return CavityMesh(mesh.points, mesh.cells, {names.get(wall, wall): at for wall, at in mesh.walls.items()})
