"""Active power that every surface of a rectangular room gives its air: total pressure times its own velocity."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from acoustics.arrays import Complexes, Floats
from acoustics.errors import AcousticsError
from acoustics.rooms.box import Box, room_modes
from acoustics.rooms.box_transfer import wavenumber_squared
from acoustics.rooms.by_wall.box_walls import by_wall
from acoustics.rooms.by_wall.walls_two_way import displacements, finest_of, left_out_mass
from acoustics.source import SurfaceVibration, apart, side_by_side

BEYOND: Final = 3.0  # of the highest frequency: modes of the room above it answer as at rest
MOST: Final = 4000  # modes of the room
_AT_ONCE: Final = 1 << 21  # complex numbers


def wall_powers(room: Box, surfaces: Sequence[SurfaceVibration], up_to_hz: float | None = None) -> Floats:
    """Mean power [n_surfaces, nf] [W] that each of several surfaces gives the air of a room.

    surfaces : on any walls, of the same frequencies. up_to_hz : modes of the room above it, and beyond 4000 of them,
        answer as at rest; three times the highest frequency if left out.

    Returns 1/2 Re of the integral over each surface of the pressure that all make together, times the conjugate of its
    own velocity. A surface that the others push takes power out of the air: its power is negative. The powers sum to
    what the room takes up.

    Raises AcousticsError: surfaces of other frequencies, points on no wall, a room without losses at a resonance.

    Notes
    -----
    Mode n is driven by L_n v, L_n the integrals of its shape over what moves, and answers rho d(s) L_n v / (V (k_n^2 -
    k^2)), as in `acoustics.rooms.box_transfer`; those left out as the added mass of `coupled_walls`, d(s) M.

    A piston that moves the air of a box of 10 cm, a third of whose mass is dragged at the rate 2 gamma:

    >>> from acoustics.air import Air
    >>> from acoustics.losses import losses_from_t60
    >>> box = Box([0.58, 0.47, 0.1], Air(340, 1.29), losses_from_t60(0.5))
    >>> x, y = (along.ravel() for along in np.meshgrid(*2 * [(np.arange(8) + 0.5) / 8]))
    >>> points, weights = np.stack([0.58 * x, 0.47 * y, 0.1 + 0 * x], axis=1), np.full(64, box.ceiling_area / 64)
    >>> piston = SurfaceVibration(points, weights, np.ones((64, 1)), [[1]], [20.0])
    >>> round(float(wall_powers(box, [piston])[0, 0] / box.ceiling_area), 4), round(13.8155 * 1.29 * 0.1 / 3, 4)
    (0.5941, 0.5941)
    """
    hz = surfaces[0].frequency_hz
    shapes, rates, columns = apart(surfaces)
    parts = by_wall(room, side_by_side(shapes))
    reach = BEYOND * float(hz.max()) if up_to_hz is None else up_to_hz
    indices = room_modes(room, reach)[1]
    indices = indices[(indices <= finest_of(room, parts)).all(axis=1)][:MOST]  # others the points do not tell
    integrals, mass = displacements(room, parts, indices), left_out_mass(room, parts, indices)
    squared = np.append(0.0, ((indices / room.size) ** 2).sum(axis=1) * np.pi**2)[:, None]
    s = np.asarray(2j * np.pi * hz)
    power = np.zeros((len(surfaces), len(hz)))
    width = max(1, _AT_ONCE // max(1, len(integrals)))
    for start in range(0, len(hz), width):
        band = slice(start, start + width)
        driving = s[band] + 2 * room.losses.decay_rate
        with np.errstate(divide="ignore", invalid="ignore"):  # a resonance without losses is refused just below
            below = squared - wavenumber_squared(room.losses, room.air, s[band])
            answers = room.air.rho * driving / (room.volume * below)
        pushed = answers * (integrals @ rates[:, band])
        rest = driving * (mass @ rates[:, band])
        for number, own in enumerate(columns):
            given = integrals[:, own] @ rates[own, band]
            power[number, band] = 0.5 * (_flow(given, pushed) + _flow(rates[own, band], rest[own]))
    if not np.isfinite(power).all():
        raise AcousticsError("frequency", got="a resonance of a room without losses", expected="losses")
    return power


def _flow(velocity: Complexes, pressure: Complexes) -> Floats:
    """Real part of conj(velocity) pressure, summed over the rows [nf]."""
    return np.asarray((velocity.conj() * pressure).real.sum(axis=0))
