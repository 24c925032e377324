"""What moves of a room's boundary: the only way into the package acoustics."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Final, TypeVar

import numpy as np

from acoustics.arrays import Complexes, Floats, freeze, frozen, frozen_complex, positive
from acoustics.errors import AcousticsError


@dataclass(frozen=True, eq=False)
class SurfaceShapes:
    """A surface of a room and the shapes in which it moves; of any form, flat or not.

    points : [p, 3], on the boundary, in the room's coordinates (of a box from its lower corner) [m].
    weights : [p], quadrature weights, the area each point stands for [m^2].
    shapes : [p, k], normal displacement of each mode at the points, positive INTO the room, where it raises the
        pressure.

    Raises AcousticsError: shapes that do not fit, weights not positive.

    Notes
    -----
    What no surface covers of the boundary is rigid.
    """

    points: Floats
    weights: Floats
    shapes: Floats

    def __post_init__(self) -> None:
        points = frozen("surface.points", self.points, (None, 3))
        weights = frozen("surface.weights", self.weights, (len(points),))
        shapes = frozen("surface.shapes", self.shapes, (len(points), None))
        if (weights <= 0).any():
            raise AcousticsError("surface.weights", got=f"{weights.min():g} m^2", expected="positive areas")
        freeze(self, points=points, weights=weights, shapes=shapes)

    @property
    def area(self) -> float:
        """Area the points stand for [m^2]."""
        return float(self.weights.sum())


@dataclass(frozen=True, eq=False)
class SurfaceVelocity(SurfaceShapes):
    """Normal velocity of a surface of the room, factored: v(x, t) = sum_k shapes[:, k] rates[k, :].

    points [p, 3], weights [p], shapes [p, k] : as of `SurfaceShapes`.
    rates : [k, nt], velocity of each modal coordinate; shapes times rates is m/s.
    dt : sampling interval [s].

    Raises AcousticsError: rates that do not fit, dt not positive, and as `SurfaceShapes` does.

    >>> import numpy as np
    >>> v = SurfaceVelocity([[0.25, 0.5, 1], [0.75, 0.5, 1]], [0.5, 0.5], [[1], [1]], [np.ones(3)], dt=0.5)
    >>> v.area, v.t.tolist()
    (1.0, [0.0, 0.5, 1.0])
    """

    rates: Floats
    dt: float

    def __post_init__(self) -> None:
        super().__post_init__()
        rates = frozen("surface.rates", self.rates, (self.shapes.shape[1], None))
        if rates.shape[1] < 2:
            raise AcousticsError("surface.rates", got=f"{rates.shape[1]} samples", expected="at least 2")
        freeze(self, rates=rates, dt=positive("surface.dt", self.dt, "s"))

    def at(self, frequency_hz: Floats) -> SurfaceVibration:
        """Fourier transform of the record at some frequencies [nf]; rates in m/s/Hz per unit of the shapes."""
        kernel = self.dt * np.exp(-2j * np.pi * np.outer(self.t, frequency_hz))
        return SurfaceVibration(self.points, self.weights, self.shapes, self.rates @ kernel, frequency_hz)

    @property
    def axis(self) -> tuple[float, ...]:
        """What records must share to be summed: interval and number of samples."""
        return self.dt, self.rates.shape[1]

    @cached_property
    def sizes(self) -> Floats:
        """Root of the summed squares of every modal rate [k], the size of its part in the motion."""
        sizes: Floats = np.sqrt(np.einsum("kt,kt->k", self.rates, self.rates))
        return sizes

    def speed(self, samples: int) -> Floats:
        """Root of the integral of v^2 over the area [m^2/s] at about so many of the times, evenly spaced from 0.

        >>> v = SurfaceVelocity([[0, 0, 1], [1, 0, 1]], [2, 2], [[1, 1], [1, 1]], [[3, 1], [-3, 1]], dt=0.5)
        >>> v.speed(2).round(9).tolist()
        [0.0, 4.0]
        """
        seen = self.rates[:, :: max(1, self.rates.shape[1] // samples)]
        # a product with the Gram matrix would be below 0 by rounding where modes cancel or the surface does not move
        root = np.linalg.qr(np.sqrt(self.weights)[:, None] * self.shapes, mode="r")
        size: Floats = np.linalg.norm(root @ seen, axis=0)
        return size

    @property
    def t(self) -> Floats:
        """Times of the samples [nt] [s], from 0."""
        return self.dt * np.arange(self.rates.shape[1], dtype=np.float64)


@dataclass(frozen=True, eq=False)
class SurfaceVibration(SurfaceShapes):
    """Normal velocity of a surface that moves harmonically: the real part of shapes times rates times exp(+j omega t).

    points [p, 3], weights [p], shapes [p, k] : as of `SurfaceShapes`.
    rates : [k, nf], complex velocity of each modal coordinate; shapes times rates is m/s.
    frequency_hz : [nf], above 0 [Hz].

    Raises AcousticsError: rates that do not fit, a frequency not above 0, and as `SurfaceShapes` does.

    >>> SurfaceVibration([[0.5, 0.5, 1]], [1.0], [[1]], [[1j, 1]], [20.0, 40.0]).rates.shape
    (1, 2)
    """

    rates: Complexes
    frequency_hz: Floats

    def __post_init__(self) -> None:
        super().__post_init__()
        frequency_hz = frozen("frequency", self.frequency_hz, (None,))
        if not (frequency_hz > 0).all():
            raise AcousticsError("frequency", got=f"{frequency_hz.min():g} Hz", expected="frequencies above 0")
        rates = frozen_complex("surface.rates", self.rates, (self.shapes.shape[1], len(frequency_hz)))
        freeze(self, rates=rates, frequency_hz=frequency_hz)

    @property
    def axis(self) -> tuple[float, ...]:
        """What vibrations must share to be summed: their frequencies."""
        return tuple(self.frequency_hz.tolist())


Moving = TypeVar("Moving", SurfaceVelocity, SurfaceVibration)
_SHAPED: Final = ("points", "weights", "shapes")


def side_by_side(surfaces: Sequence[SurfaceShapes]) -> SurfaceShapes:
    """Several surfaces as one that moves in the same coordinates: a room's source term is a sum over its surfaces.

    Raises AcousticsError: none, or shapes of other coordinates.
    """
    _some(surfaces)
    if len(surfaces) == 1:
        return surfaces[0]
    counts = {one.shapes.shape[1] for one in surfaces}
    if len(counts) > 1:
        raise AcousticsError("surfaces", got=f"shapes of {sorted(counts)} coordinates", expected="the same number")
    points, weights, shapes = (np.concatenate([getattr(one, word) for one in surfaces]) for word in _SHAPED)
    return SurfaceShapes(points, weights, shapes)


def combine_surfaces(surfaces: Sequence[Moving]) -> Moving:
    """Several moving surfaces of one room as one: a room's source term is a sum over its surfaces.

    Surfaces of one structure share their rates; any other surface brings its own.

    Raises AcousticsError: none, or records that differ in sampling, length or frequencies.

    >>> left, right = (SurfaceVelocity([[x, 0.5, 1]], [0.5], [[1]], [[0, x]], dt=0.1) for x in (0.25, 0.75))
    >>> both = combine_surfaces([left, right])
    >>> both.area, (both.shapes @ both.rates).tolist()
    (1.0, [[0.0, 0.25], [0.0, 0.75]])
    """
    _some(surfaces)
    first, *others = surfaces
    if not others:
        return first
    if any(one.axis != first.axis for one in others):
        raise AcousticsError("surfaces", got="records that differ", expected="the same samples or frequencies of all")
    points, weights = (np.concatenate([getattr(one, word) for one in surfaces]) for word in _SHAPED[:2])
    if all(np.array_equal(one.rates, first.rates) for one in others):
        return replace(first, points=points, weights=weights, shapes=np.concatenate([one.shapes for one in surfaces]))
    shapes = np.zeros((len(points), sum(one.shapes.shape[1] for one in surfaces)))
    row = column = 0
    for one in surfaces:
        p, k = one.shapes.shape
        shapes[row : row + p, column : column + k] = one.shapes
        row, column = row + p, column + k
    rates = np.concatenate([one.rates for one in surfaces])
    return replace(first, points=points, weights=weights, shapes=shapes, rates=rates)


def with_own_coordinates(surfaces: Sequence[SurfaceVibration]) -> tuple[list[SurfaceShapes], Complexes, list[slice]]:
    """Vibrating surfaces with coordinates of their own, the same number for all; the rates of all [k, nf]; and which
    of them are whose.

    Raises AcousticsError: none, or vibrations of other frequencies.
    """
    _some(surfaces)
    if any(one.axis != surfaces[0].axis for one in surfaces):
        raise AcousticsError("surfaces", got="vibrations that differ", expected="the same frequencies of all")
    ends = np.cumsum([0, *(one.shapes.shape[1] for one in surfaces)])
    columns = [slice(int(a), int(b)) for a, b in pairwise(ends)]
    alone = []
    for one, own in zip(surfaces, columns, strict=True):
        shapes = np.zeros((len(one.weights), int(ends[-1])))
        shapes[:, own] = one.shapes
        alone.append(SurfaceShapes(one.points, one.weights, shapes))
    return alone, np.concatenate([one.rates for one in surfaces]), columns


def _some(surfaces: Sequence[SurfaceShapes]) -> None:
    if not surfaces:
        raise AcousticsError("surfaces", got="none", expected="at least one")


def refuse_unlike(surfaces: Sequence[SurfaceVelocity]) -> None:
    """Refuse surfaces that are not motions of one surface.

    Raises AcousticsError: none, or other points, weights, shapes or sampling.
    """
    _some(surfaces)
    first = surfaces[0]
    for other in surfaces[1:]:
        same = all(np.array_equal(getattr(first, word), getattr(other, word)) for word in _SHAPED)
        if not same or other.axis != first.axis:
            raise AcousticsError("surfaces", got="surfaces that differ", expected="motions of one surface")
