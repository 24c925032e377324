"""Where a surface in a baffle sends its sound: far-field levels on half circles through its normal."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from acoustics.air import Air
from acoustics.arrays import Complexes, Floats, freeze, frozen
from acoustics.open_air.radiated_power import radiated_power
from acoustics.tags import stored_as

ANGLES_DEG: Final = np.arange(-90.0, 91.0)
FLOOR_DB: Final = -120.0


@stored_as("directivity/1")
@dataclass(frozen=True, eq=False)
class Directivity:
    """Far field of a baffled surface on two half circles, along its first and its second side.

    frequency_hz [nf]. angle_deg [n] : from the normal, positive along the side. along [2, 3] : the sides, unit vectors
    that point along the global axes rather than against them. pressure [nf, 2, n] : |p| times the
    distance [Pa m], or per whatever the rates are per. half_sphere [nf] : root of the mean of its square over the whole
    half sphere.
    """

    frequency_hz: Floats
    angle_deg: Floats
    along: Floats
    pressure: Floats
    half_sphere: Floats

    def __post_init__(self) -> None:
        frequency_hz = frozen("pattern.frequency_hz", self.frequency_hz, (None,))
        angle_deg, lines = frozen("pattern.angle_deg", self.angle_deg, (None,)), len(frequency_hz)
        freeze(
            self,
            frequency_hz=frequency_hz,
            angle_deg=angle_deg,
            along=frozen("pattern.along", self.along, (2, 3)),
            pressure=frozen("pattern.pressure", self.pressure, (lines, 2, len(angle_deg))),
            half_sphere=frozen("pattern.half_sphere", self.half_sphere, (lines,)),
        )

    @property
    def sides(self) -> tuple[str, str]:
        """Names of the sides: the global axis they lie along, or "first side" and "second side"."""
        first, second = (
            "xyz"[int(side.argmax())] if side.max() > 1 - 1e-6 else f"{word} side"
            for side, word in zip(self.along, ("first", "second"), strict=True)
        )
        return first, second

    @property
    def level_db(self) -> Floats:
        """Levels [nf, 2, n] re the loudest direction on the two half circles [dB], -120 where nothing goes."""
        loudest = self.pressure.max(axis=(1, 2), keepdims=True)
        share = np.divide(self.pressure, loudest, out=np.zeros_like(self.pressure), where=loudest > 0)
        levels: Floats = np.maximum(20 * np.log10(np.maximum(share, 1e-300)), FLOOR_DB)
        return levels

    @property
    def index_db(self) -> Floats:
        """How much louder the loudest direction is than the mean square over the half sphere [nf] [dB]: 0 for a source
        small beside the wave; nan in silence."""
        with np.errstate(divide="ignore", invalid="ignore"):
            index: Floats = 20 * np.log10(self.pressure.max(axis=(1, 2)) / self.half_sphere)
        return index

    def loudest(self, line: int) -> tuple[int, float]:
        """The half circle, 0 or 1, and the angle [deg] of the loudest direction of a frequency; the one nearest to the
        normal where several are as loud."""
        size = self.pressure[line]
        alike = size >= size.max() * (1 - 1e-6)
        off = np.where(alike, np.abs(self.angle_deg), np.inf)
        circle, place = np.unravel_index(int(off.argmin()), off.shape)
        return int(circle), float(self.angle_deg[place])


def radiation_pattern(
    points: Floats,
    weights: Floats,
    shapes: Floats,
    rates: Complexes,
    frequency_hz: Floats,
    air: Air,
    normal: Floats,
    along: Floats,
) -> Directivity:
    """Far field of a baffled flat surface that moves with exp(+j omega t).

    points [p, 3], weights [p], shapes [p, k], rates [k, nf] : as of `acoustics.radiated_power`.
    normal [3], along [2, 3] : unit vectors into the air and along the surface's two sides.

    Notes
    -----
    The exact phase of every point (Fraunhofer): r |p| = omega rho / (2 pi) |sum of w v exp(j k e . x)|.

    A source small beside the wave sends the same everywhere:

    >>> small = radiation_pattern(np.zeros((1, 3)), np.array([1e-4]), np.ones((1, 1)), np.ones((1, 1), complex),
    ...                     np.array([100.0]), Air(), np.array([0.0, 0, 1]), np.eye(3)[:2])
    >>> bool(np.abs(small.level_db).max() < 1e-9), bool(abs(small.index_db[0]) < 1e-9)
    (True, True)
    """
    frequency_hz = np.asarray(frequency_hz, dtype=np.float64)
    angle = np.radians(ANGLES_DEG)
    main = np.take_along_axis(along, np.abs(along).argmax(axis=1)[:, None], axis=1)
    along = along * np.sign(main)
    e = np.cos(angle)[:, None] * normal + np.sin(angle)[:, None] * along[:, None]  # [2, n, 3]
    way = (points - points.mean(axis=0)) @ e.reshape(-1, 3).T  # [p, 2 n]
    weighted = weights[:, None] * shapes
    pressure = np.empty((len(frequency_hz), 2, len(angle)))
    for line, f in enumerate(frequency_hz):
        k = 2 * np.pi * f / air.c
        moved = weighted @ rates[:, line]
        pressure[line] = np.abs(f * air.rho * (moved @ np.exp(1j * k * way))).reshape(2, -1)
    power = radiated_power(points, weights, shapes, rates, frequency_hz, air)
    return Directivity(frequency_hz, ANGLES_DEG, along, pressure, np.sqrt(power * air.rho * air.c / np.pi))
