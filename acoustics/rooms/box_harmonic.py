"""Pressure in the room below a surface that moves harmonically: transfer functions, line by line."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acoustics.arrays import Complexes, Floats, Integers, freeze, frozen, positive
from acoustics.errors import AcousticsError, Advice
from acoustics.receivers import Receiver, positions
from acoustics.rooms.box import (
    Box,
    band_orders,
    cosines,
    horizontal_wavenumber,
    order_grid,
    orders_not_in,
    overlaps,
    project,
    refuse_off_ceiling,
    refuse_outside,
    resolved_orders,
    transfer,
)
from acoustics.rooms.room_advice import truncation
from acoustics.source import SurfaceVelocity, SurfaceVibration

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
    refuse_outside(room, "surface.points", points)
    for receiver in receivers:
        refuse_outside(room, f"receiver {receiver.name}", receiver.position[None, :])
    weighted = surface.weights[:, None] * surface.shapes
    p = np.zeros((len(places), len(frequency_hz)), dtype=np.complex128)
    first = max(band_orders(room, float(frequency_hz.max())))
    most = np.minimum(np.array(band_orders(room, float(frequency_hz.max()))) + MOST, resolved_orders(room, points) + 1)
    done, share = np.zeros((0, 2), dtype=np.int64), 0.0
    for size in range(FIRST, int(most.max()) + BLOCK, BLOCK):
        new = orders_not_in(order_grid(*np.minimum(size, most).tolist()), done)
        part = _receiver_pressure(room, new, weighted, points, surface.rates, frequency_hz, places)
        p += part
        done = np.concatenate([done, new])
        share = _share(part, p)
        if len(done) > len(new) and share < ENOUGH and size >= min(first, int(most.max())):
            break
    return p, truncation(share, done)


def _receiver_pressure(
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
            transfers = transfer(room, np.asarray(2j * np.pi * hz[lines]), k_lm, heights)
        for height, at_height in enumerate(transfers):
            rows = plane == height
            p[rows, lines] = at_places[rows] @ (at_height * velocity[:, lines])
    if not np.isfinite(p).all():
        raise AcousticsError("frequency", got="a resonance of a room without losses", expected="losses")
    return p


def _share(part: Complexes, p: Complexes) -> float:
    """Largest ratio over the receivers of the rms of `part` to that of `p`."""
    of_part, of_all = ((np.abs(x) ** 2).sum(axis=1) for x in (part, p))
    return float(np.sqrt(np.divide(of_part, of_all, out=np.zeros_like(of_all), where=of_all > 0).max()))


# ----------------------------------------------------------------------------------------------------------------------
# Pressure on a plane of the room at single frequencies, for pictures.
# ----------------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class PressureMap:
    """Pressure on a plane of the room, for pictures.

    normal : axis the plane is normal to, ``x``, ``y`` or ``z``.
    first, second : [n1], [n2], coordinates along the two other axes, in the order x, y, z [m].
    frequency_hz : [nf].
    spectrum : [nf, n1, n2], Fourier transform of the pressure [Pa/Hz].
    """

    normal: str
    at: float
    first: Floats
    second: Floats
    frequency_hz: Floats
    spectrum: Complexes

    def __post_init__(self) -> None:
        first = frozen("map.first", self.first, (None,))
        second = frozen("map.second", self.second, (None,))
        frequency_hz = frozen("map.frequency_hz", self.frequency_hz, (None,))
        spectrum = np.array(self.spectrum, dtype=np.complex128)
        if spectrum.shape != (expected := (len(frequency_hz), len(first), len(second))):
            raise AcousticsError("map.spectrum", got=f"shape {spectrum.shape}", expected=f"shape {expected}")
        spectrum.flags.writeable = False
        freeze(self, first=first, second=second, frequency_hz=frequency_hz, spectrum=spectrum)


def pressure_map(
    surface: SurfaceVelocity,
    room: Box,
    frequencies_hz: Sequence[float] | Floats,
    *,
    normal: str = "z",
    at: float,
    divisions: tuple[int, int] = (48, 40),
    orders: int = 24,
) -> PressureMap:
    """Spectrum of the pressure at chosen frequencies on a plane of the room.

    Parameters
    ----------
    frequencies_hz : Sequence[float] | Floats
        [nf], above 0 [Hz].
    normal, at : str, float
        The plane x, y or z = `at` [m].
    divisions : tuple[int, int]
        Intervals along the two other axes.
    orders : int
        Cosines in each direction.

    Raises
    ------
    AcousticsError
        A plane outside the room, a frequency not above 0, a room without losses at resonance.

    Notes
    -----
    The Fourier transform of the velocity's record times the transfer function at that frequency: what a record long
    enough for the air to fall silent would give, the surface standing still after the record's end. It equals
    `RoomResponse.spectrum` when the record has decayed.

    Examples
    --------
    >>> from acoustics.air import Air
    >>> box = Box([0.58, 0.47, 0.1], Air(340, 1.29))
    >>> push = np.sin(np.pi * np.arange(48) / 48) ** 2
    >>> ceiling = SurfaceVelocity([[0.29, 0.235, 0.1]], [box.ceiling_area], [[1]], [push], dt=1e-3)
    >>> heard = pressure_map(ceiling, box, [20.0, 40.0], at=0.05, divisions=(4, 2), orders=1)
    >>> heard.spectrum.shape, bool(np.ptp(abs(heard.spectrum[0])) < 1e-12)
    ((2, 5, 3), True)
    """
    frequency_hz, fixed, axes = _plane(frequencies_hz, normal)
    refuse_off_ceiling(surface, room)
    first, second = (np.linspace(0, room.size[axis], n + 1) for axis, n in zip(axes, divisions, strict=True))
    corner = np.zeros((1, 3))
    corner[0, fixed] = at
    refuse_outside(room, "map.at", corner)
    s = np.asarray(2j * np.pi * frequency_hz)
    chosen = order_grid(orders, orders)
    kernel = surface.dt * np.exp(-np.outer(surface.t, s))
    velocity = project(surface, room, chosen) @ (surface.rates @ kernel)
    heights = np.array([at]) if normal == "z" else second
    with np.errstate(divide="ignore", invalid="ignore"):  # a resonance without losses is refused just below
        parts = np.stack(transfer(room, s, horizontal_wavenumber(room, chosen), heights)) * velocity
    if not np.isfinite(parts).all():
        raise AcousticsError("map.frequency", got="a resonance of a room without losses", expected="losses")
    if normal == "z":
        grid = np.stack(np.meshgrid(first, second, indexing="ij"), axis=-1).reshape(-1, 2)
        spectrum = (cosines(room, chosen, grid) @ parts[0]).T.reshape(-1, len(first), len(second))
    else:
        line = np.zeros((len(first), 2))
        line[:, fixed], line[:, 1 - fixed] = at, first
        spectrum = np.einsum("ic,zcf->fiz", cosines(room, chosen, line), parts, optimize=True)
    return PressureMap(normal, at, first, second, frequency_hz, spectrum)


def map_within(
    spectrum_at: Callable[[Floats, Floats], Complexes],
    contains: Callable[[Floats], NDArray[np.bool_]],
    extent: Floats,
    frequencies_hz: Sequence[float] | Floats,
    *,
    normal: str,
    at: float,
    divisions: tuple[int, int],
) -> PressureMap:
    """The map of a field whose spectra [nf, p] at frequencies [nf] and points [p, 3] are known one by one.

    Parameters
    ----------
    contains : Callable[[Floats], NDArray[np.bool_]]
        Which of points [p, 3] lie in it; the others are nan.
    extent : Floats [2, 3]
        Its lower and upper corner [m].

    Raises
    ------
    AcousticsError
        As `pressure_map` does.
    """
    frequency_hz, fixed, axes = _plane(frequencies_hz, normal)
    low, high = extent
    first, second = (np.linspace(low[axis], high[axis], n + 1) for axis, n in zip(axes, divisions, strict=True))
    points = np.full((len(first) * len(second), 3), at)
    points[:, axes] = np.stack(np.meshgrid(first, second, indexing="ij"), axis=-1).reshape(-1, 2)
    inner = contains(points)
    if not inner.any():
        raise AcousticsError("map.at", got=f"{at:g} m", expected=f"{low[fixed]:g} to {high[fixed]:g} m")
    spectrum = np.full((len(frequency_hz), len(points)), np.nan, dtype=np.complex128)
    spectrum[:, inner] = spectrum_at(frequency_hz, points[inner])
    return PressureMap(normal, at, first, second, frequency_hz, spectrum.reshape(-1, len(first), len(second)))


def _plane(frequencies_hz: Sequence[float] | Floats, normal: str) -> tuple[Floats, int, list[int]]:
    """The frequencies [Hz], the axis that a plane is normal to, and the two others."""
    if normal not in ("x", "y", "z"):
        raise AcousticsError("map.normal", got=repr(normal), expected="x, y or z")
    fixed = "xyz".index(normal)
    hz: Floats = np.array([positive("map.frequency", float(f), "Hz") for f in frequencies_hz])
    return hz, fixed, [axis for axis in range(3) if axis != fixed]
