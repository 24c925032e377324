"""From the rates of a ceiling's modes to the pressure at places of the room, at any complex frequencies."""

from __future__ import annotations

from math import inf, log
from typing import Final

import numpy as np

from acoustics.arrays import Complexes, Floats
from acoustics.rooms.box import Box
from acoustics.rooms.box_transfer import cosines, horizontal_wavenumber, overlaps, transfer, wavenumber_squared
from acoustics.rooms.cosine_orders import square
from acoustics.source import SurfaceShapes

LINES: Final = 64  # handled at once
MOST: Final = 4.0  # of the fastest wave's wavenumber, where places are at the ceiling
LEAST: Final = 1e-2  # of an evanescent wave's pressure at the ceiling that reaches the highest place


def room_ways(room: Box, surface: SurfaceShapes, places: Floats, s: Complexes) -> Complexes:
    """Pressure over modal rate [r, k, nf] at places [r, 3] of modes of the ceiling, at complex frequencies s [nf].

    Notes
    -----
    Cosines that propagate at a frequency, or whose wave falls to no less than 1/100 on its way down to the highest
    place: levels of third octaves are right to 0.05 dB. `acoustics.rooms.box_pressure` looks for all.
    """
    heights, plane = np.unique(places[:, 2], return_inverse=True)
    nearest = float(room.size[2] - heights.max())
    wave = np.sqrt(np.abs(wavenumber_squared(room.losses, room.air, s)))
    reach = np.minimum(np.hypot(wave, -log(LEAST) / nearest if nearest > 0 else inf), MOST * wave.max())
    orders = square(*(int(reach.max() * length / np.pi) + 1 for length in room.size[:2].tolist()))
    k_lm = horizontal_wavenumber(room, orders)
    order = np.argsort(k_lm, kind="stable")
    orders, k_lm = orders[order], k_lm[order]
    factor = np.where(orders > 0, 2.0, 1.0).prod(axis=1) / room.ceiling_area
    coefficients = factor[:, None] * overlaps(room, orders, surface.points, surface.weights[:, None] * surface.shapes)
    mix = cosines(room, orders, places)
    found = np.zeros((len(places), surface.shapes.shape[1], len(s)), dtype=np.complex128)
    for start in range(0, len(s), LINES):
        lines = slice(start, start + LINES)
        near = int(np.searchsorted(k_lm, reach[lines].max(), side="right"))
        ways = transfer(room, s[lines], k_lm[:near], heights)
        for row, height in enumerate(plane):
            shares = (coefficients[:near] * mix[row, :near, None]).T
            found[row, :, lines] = (shares @ ways[height].view(np.float64)).view(np.complex128)
    return found
