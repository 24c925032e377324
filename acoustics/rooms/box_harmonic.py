"""Pressure in the room below a surface that moves harmonically: transfer functions, line by line."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from acoustics.arrays import Complexes, Floats, Integers
from acoustics.errors import AcousticsError, Advice
from acoustics.receivers import Receiver, positions
from acoustics.rooms.box import Box, inside
from acoustics.rooms.box_transfer import cosines, horizontal_wavenumber, overlaps, transfer
from acoustics.rooms.cosine_orders import band_orders, not_in, resolved_orders, square
from acoustics.rooms.room_advice import truncation
from acoustics.source import SurfaceVibration

FIRST: Final = 4  # orders to begin with
BLOCK: Final = 4  # orders more in the next block
MOST: Final = 40  # orders beyond those of the band
ENOUGH: Final = 1e-5  # share (rms over the lines, worst receiver) of the last block at which no more are added
_AT_ONCE: Final = 1 << 20  # complex numbers


def harmonic_pressure(
    surface: SurfaceVibration, room: Box, receivers: Sequence[Receiver]
) -> tuple[Complexes, tuple[Advice, ...]]:
    """Complex pressure [n_receivers, nf] [Pa] of a ceiling that moves with exp(+j omega t), and advice on it.

    Raises AcousticsError: points or a receiver outside the room, no receiver, a room without losses at a resonance.

    Notes
    -----
    Exact for a given motion, the same transfer functions as `pressure`; cosines are added until the last ones make
    less than 1e-5 of the pressure, or 40 beyond those of
    the band are in, or the points resolve no more.

    A piston of 1 m/s at 20 Hz over a box compresses it by 1/omega metres of 100 mm:

    >>> from acoustics.air import Air
    >>> box = Box([0.58, 0.47, 0.1], Air(340, 1.29))
    >>> x, y = (along.ravel() for along in np.meshgrid(*2 * [(np.arange(64) + 0.5) / 64]))
    >>> points, weights = np.stack([0.58 * x, 0.47 * y, 0.1 + 0 * x], axis=1), np.full(64**2, box.ceiling_area / 64**2)
    >>> piston = SurfaceVibration(points, weights, np.ones((64**2, 1)), [[1]], [20.0])
    >>> heard, _ = harmonic_pressure(piston, box, [Receiver("mic", [0.29, 0.235, 0.1 / 3**0.5])])
    >>> print(f"{heard[0, 0].imag:.1f} {-box.air.bulk_modulus / 0.1 / (2 * np.pi * 20):.1f}")
    -11866.9 -11866.9
    """
    places, points, frequency_hz = positions(receivers), surface.points, surface.frequency_hz
    inside(room, "surface.points", points)
    for receiver in receivers:
        inside(room, f"receiver {receiver.name}", receiver.position[None, :])
    weighted = surface.weights[:, None] * surface.shapes
    p = np.zeros((len(places), len(frequency_hz)), dtype=np.complex128)
    first = max(band_orders(room, float(frequency_hz.max())))
    most = np.minimum(np.array(band_orders(room, float(frequency_hz.max()))) + MOST, resolved_orders(room, points) + 1)
    done, share = np.zeros((0, 2), dtype=np.int64), 0.0
    for size in range(FIRST, int(most.max()) + BLOCK, BLOCK):
        new = not_in(square(*np.minimum(size, most).tolist()), done)
        part = _heard(room, new, weighted, points, surface.rates, frequency_hz, places)
        p += part
        done = np.concatenate([done, new])
        share = _share(part, p)
        if len(done) > len(new) and share < ENOUGH and size >= min(first, int(most.max())):
            break
    return p, truncation(share, done)


def _heard(
    room: Box, orders: Integers, weighted: Floats, points: Floats, rates: Complexes, hz: Floats, places: Floats
) -> Complexes:
    """Pressure [n_places, nf] of some cosines of the ceiling velocity."""
    factor = np.where(orders > 0, 2.0, 1.0).prod(axis=1) / room.ceiling_area
    velocity = (factor[:, None] * overlaps(room, orders, points, weighted)) @ rates
    k_lm = horizontal_wavenumber(room, orders)
    heights, plane = np.unique(places[:, 2], return_inverse=True)
    at_places = cosines(room, orders, places)
    p = np.zeros((len(places), len(hz)), dtype=np.complex128)
    step = max(1, _AT_ONCE // (len(orders) * len(heights)))
    for start in range(0, len(hz), step):
        lines = slice(start, start + step)
        with np.errstate(divide="ignore", invalid="ignore"):  # a resonance without losses is refused just below
            ways = transfer(room, np.asarray(2j * np.pi * hz[lines]), k_lm, heights)
        for height, way in enumerate(ways):
            rows = plane == height
            p[rows, lines] = at_places[rows] @ (way * velocity[:, lines])
    if not np.isfinite(p).all():
        raise AcousticsError("frequency", got="a resonance of a room without losses", expected="losses")
    return p


def _share(part: Complexes, p: Complexes) -> float:
    """Largest ratio over the receivers of the rms of `part` to that of `p`."""
    of_part, of_all = ((np.abs(x) ** 2).sum(axis=1) for x in (part, p))
    return float(np.sqrt(np.divide(of_part, of_all, out=np.zeros_like(of_all), where=of_all > 0).max()))
