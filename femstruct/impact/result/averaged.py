"""Velocities and accelerations as filters need them: means about each sample, which miss no jump between two of them.

Where a contact force jumps, residual vectors let a place jump along: its acceleration is two blows against each other
between two samples, and rings on faster than samples show. No filter finds that in samples of the acceleration.
Displacements have all of it.
"""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.impact.result.response import Response
from femstruct.tags import stored_as

ROUNDING: Final = 16.0 * float(np.finfo(np.float64).eps)  # of a displacement: less of a second difference is no motion
_CORRECTIONS: Final = {1: (-1.0 / 6.0, 1.0 / 30.0, -1.0 / 140.0), 2: (-1.0 / 12.0, 1.0 / 90.0, -1.0 / 560.0)}
"""Of derivatives, in powers of the second difference D2: d2 = D2 (1 - D2 / 12 + D2^2 / 90 - ..)."""


def mean_velocity(displacement: Floats, sampling: float, speed: float = 0.0) -> Floats:
    """The velocity [nt] [m/s] of a displacement [nt] [m]; speed [m/s] : what it starts with, and had before.

    Its sum over samples is the displacement: a jump between two of them is in it.
    """
    x = _continued(displacement, sampling, speed)
    return _corrected(0.5 * sampling * (x[2:] - x[:-2]), 1)


def mean_acceleration(displacement: Floats, sampling: float, speed: float = 0.0) -> Floats:
    """The acceleration [nt] [m/s^2] of a displacement [nt] [m]; speed [m/s] : what it starts with, and had before.

    Its sum over samples is the change of velocity, whatever happens between two of them.

    An acceleration of 8 m/s^2 from the start on, half a sample of which lies before the first:

    >>> found = mean_acceleration(0.5 * 8.0 * (np.arange(6) / 1000.0) ** 2, 1000.0)
    >>> found.round(1), round(float(found.sum()), 9)
    (array([3.5, 8.5, 7.9, 8. , 8. , 8. ]), 44.0)
    """
    x = _continued(displacement, sampling, speed)
    found = _corrected(sampling**2 * np.diff(x, 2), 2)
    rounding = ROUNDING * float(np.abs(displacement).max(initial=0.0)) * sampling**2
    return found if float(np.abs(found).max(initial=0.0)) > rounding else np.zeros_like(found)


def _continued(x: Floats, sampling: float, speed: float) -> Floats:
    """With a sample before, to which it came as fast as it starts, and one after that does not change its pace."""
    after = 3.0 * x[-1] - 3.0 * x[-2] + x[-3] if len(x) > 2 else 2.0 * x[-1] - x[max(len(x) - 2, 0)]
    return np.concatenate(([x[0] - speed / sampling], x, [after]))


def _corrected(values: Floats, order: int) -> Floats:
    """Differences as derivatives, to the eighth power of the interval; sums stay as they are, at the ends too."""
    out, moved = values.copy(), values
    for factor in _CORRECTIONS[order]:
        moved = np.diff(np.pad(moved, 1, mode="edge"), 2)
        out += factor * moved
    return out


@stored_as("averaged response/1")
class Averaged(Response):
    """A response whose velocities and accelerations of points and accelerations of bodies are these means; all else is
    that of the response."""

    def velocity(self, row: Floats) -> Floats:
        """Weighted sum of the modal velocities [nt], row [k]: the mean about each sample."""
        return mean_velocity(self.displacement(row), self.clock.sampling, self._start(row))

    def acceleration(self, row: Floats) -> Floats:
        """Weighted sum of the modal accelerations [nt], row [k]: the mean about each sample."""
        return mean_acceleration(self.displacement(row), self.clock.sampling, self._start(row))

    def _start(self, row: Floats) -> float:
        started = self.scene.velocity
        return 0.0 if started is None else float(row @ started)


def averaged(response: Response) -> Averaged:
    """The same response as filters need it."""
    kept = {one.name: getattr(response, one.name) for one in fields(response)}
    scene, rate = response.scene, response.clock.sampling
    lifted = {one.body for one in scene.blows if one.count > 1 or one.first > 0.0}  # where velocities jump
    falls = {one.name: -scene.gravity * one.falls for one in scene.bodies}
    kept["bodies"] = {
        name: one if name in lifted else replace(one, acceleration=mean_velocity(one.velocity, rate, falls[name]))
        for name, one in response.bodies.items()
    }
    return Averaged(**kept)
