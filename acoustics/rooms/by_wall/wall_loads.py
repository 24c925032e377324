"""What a point source in a rectangular room does to surfaces on its walls that are held still."""

from __future__ import annotations

from typing import Final

import numpy as np

from acoustics.arrays import Complexes, Floats, Integers
from acoustics.errors import AcousticsError, Advice
from acoustics.rooms.box import Box, inside
from acoustics.rooms.box_transfer import cosines, horizontal_wavenumber, overlaps, vertical_wavenumber
from acoustics.rooms.by_wall.box_walls import by_wall
from acoustics.rooms.cosine_orders import band_orders, not_in, resolved_orders, square
from acoustics.rooms.room_advice import truncation
from acoustics.source import SurfaceShapes

BLOCK: Final = 4  # orders more in the next block
ENOUGH: Final = 1e-10  # share of the last block in the loads at which no more are added: they fall exponentially
_AT_ONCE: Final = 1 << 20  # complex numbers


def wall_loads(
    room: Box, surface: SurfaceShapes, place: Floats, frequency_hz: Floats
) -> tuple[Complexes, tuple[Advice, ...]]:
    """Integrals [k, nf] over surfaces that are held, of the pressure that a point source makes per volume velocity,
    times their shapes; and advice on it.

    surface : on any walls. place [3] : of the source, in the room [m]. frequency_hz [nf] : above 0 [Hz].

    Raises AcousticsError: a source outside the room, points on no wall, a room without losses at a resonance.

    Notes
    -----
    The source is a flow that enters the air, as that of a wall does: its pressure solves the room's wave equation with
    rho d(s) on its place. Cosine (l, m) along a wall has of it the share eps cos cos / S there, which sends the wave
    rho d(s) exp(-j mu z) / (2 j mu) to both sides; mirrored at the wall and at the one opposite,

        p = rho d(s) / (j mu) (E(h) + E(2 L - h)) / (1 - E(2 L)),      E(x) = exp(-j mu x),

    on the wall, h from the source; d(s), mu and E are those of `acoustics.rooms.box_transfer`. Cosines are added until
    the last ones make less than 1e-10, or the points resolve no more.

    Far below its first mode a room is compressed as a whole, by rho c^2 / (s V):

    >>> box = Box([0.58, 0.47, 0.1])
    >>> piston = SurfaceShapes([[0.29, 0.235, 0.1]], [box.ceiling_area], [[1]])
    >>> loads, _ = wall_loads(box, piston, np.array([0.1, 0.2, 0.02]), np.array([1.0]))
    >>> print(f"{loads[0, 0].imag:.1f} {-box.air.bulk_modulus * box.ceiling_area / box.volume / (2 * np.pi):.1f}")
    -226565.6 -226565.5
    """
    inside(room, "source", place[None, :])
    found = np.zeros((surface.shapes.shape[1], len(frequency_hz)), dtype=np.complex128)
    advice: tuple[Advice, ...] = ()
    for turn, part in by_wall(room, surface).items():
        there, source = turn.surface(room, part), turn.points(room, place[None, :])
        loads, told = _ceiling_loads(turn.box(room), there, source, frequency_hz)
        found += loads
        advice = advice or told
    return found, advice


def _ceiling_loads(
    room: Box, surface: SurfaceShapes, source: Floats, frequency_hz: Floats
) -> tuple[Complexes, tuple[Advice, ...]]:
    """Of surfaces on the ceiling; source [1, 3]."""
    weighted = surface.weights[:, None] * surface.shapes
    found = np.zeros((weighted.shape[1], len(frequency_hz)), dtype=np.complex128)
    most = resolved_orders(room, surface.points) + 1
    least = max(band_orders(room, float(frequency_hz.max())))
    done, share = np.zeros((0, 2), dtype=np.int64), 0.0
    for size in range(BLOCK, int(most.max()) + BLOCK, BLOCK):
        new = not_in(square(*np.minimum(size, most).tolist()), done)
        part = _of_orders(room, new, surface.points, weighted, source, frequency_hz)
        found += part
        done = np.concatenate([done, new])
        share = float(np.linalg.norm(part) / (np.linalg.norm(found) or 1.0))
        if share < ENOUGH and size >= least:
            break
    return found, truncation(share, done)


def _of_orders(
    room: Box, orders: Integers, points: Floats, weighted: Floats, source: Floats, frequency_hz: Floats
) -> Complexes:
    """Loads [k, nf] of the cosines `orders` [n, 2]."""
    height, z = float(room.size[2]), float(source[0, 2])
    strength = np.where(orders > 0, 2.0, 1.0).prod(axis=1) / room.ceiling_area * cosines(room, orders, source)[0]
    felt = overlaps(room, orders, points, weighted).T * strength
    k_lm = horizontal_wavenumber(room, orders)
    found = np.empty((len(felt), len(frequency_hz)), dtype=np.complex128)
    step = max(1, _AT_ONCE // len(orders))
    for start in range(0, len(frequency_hz), step):
        lines = slice(start, start + step)
        s = np.asarray(2j * np.pi * frequency_hz[lines])
        j_mu = 1j * vertical_wavenumber(room, s, k_lm)
        with np.errstate(divide="ignore", invalid="ignore"):  # a resonance without losses is refused just below
            waves = (np.exp(-j_mu * (height - z)) + np.exp(-j_mu * (height + z))) / (1 - np.exp(-2 * j_mu * height))
            found[:, lines] = felt @ (room.air.rho * (s + 2 * room.losses.decay_rate) / j_mu * waves)
    if not np.isfinite(found).all():
        raise AcousticsError("frequency", got="a resonance of a room without losses", expected="losses")
    return found
