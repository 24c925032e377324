"""Pressure on a plane of the room at single frequencies, for pictures."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from acoustics.arrays import Complexes, Floats, freeze, frozen, positive
from acoustics.errors import AcousticsError
from acoustics.rooms.box import Box, inside, on_ceiling
from acoustics.rooms.box_transfer import cosines, horizontal_wavenumber, project, transfer
from acoustics.rooms.cosine_orders import square
from acoustics.source import SurfaceVelocity


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

    frequencies_hz : [nf], above 0 [Hz].
    normal, at : the plane x, y or z = `at` [m].
    divisions : intervals along the two other axes. orders : cosines in each direction.

    Raises AcousticsError: a plane outside the room, a frequency not above 0, a room without losses at resonance.

    Notes
    -----
    The Fourier transform of the velocity's record times the transfer function at that frequency: what a record long
    enough for the air to fall silent would give, the surface standing still after the record's end. It equals
    `RoomResponse.spectrum` when the record has decayed.

    >>> from acoustics.air import Air
    >>> box = Box([0.58, 0.47, 0.1], Air(340, 1.29))
    >>> push = np.sin(np.pi * np.arange(48) / 48) ** 2
    >>> ceiling = SurfaceVelocity([[0.29, 0.235, 0.1]], [box.ceiling_area], [[1]], [push], dt=1e-3)
    >>> heard = pressure_map(ceiling, box, [20.0, 40.0], at=0.05, divisions=(4, 2), orders=1)
    >>> heard.spectrum.shape, bool(np.ptp(abs(heard.spectrum[0])) < 1e-12)
    ((2, 5, 3), True)
    """
    frequency_hz, fixed, axes = _plane(frequencies_hz, normal)
    on_ceiling(surface, room)
    first, second = (np.linspace(0, room.size[axis], n + 1) for axis, n in zip(axes, divisions, strict=True))
    corner = np.zeros((1, 3))
    corner[0, fixed] = at
    inside(room, "map.at", corner)
    s = np.asarray(2j * np.pi * frequency_hz)
    chosen = square(orders, orders)
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

    contains : which of points [p, 3] lie in it; the others are nan. extent [2, 3] : its lower and upper corner [m].

    Raises AcousticsError as `pressure_map` does.
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
