"""Finer samples of a run: between samples that are coarse beside what vibrates, and the means that filters need."""

from __future__ import annotations

from dataclasses import fields, replace
from math import acos, ceil, inf, pi, sqrt
from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.impact.response import Response
from femstruct.impact.scene import HalfSine, Scene, Table
from femstruct.impact.simulate import simulate
from femstruct.modal.basis import ModalBasis
from femstruct.tags import stored_as

# ----------------------------------------------------------------------------------------------------------------------
# Between the samples: the same run on a finer grid, where the samples of a run are coarse beside what vibrates in it.
#
# The largest of some samples is not the peak. A run that is asked for few samples is simulated once more for its peaks
# alone: that costs about as much as the run, and what is kept of the run stays as it was asked for.
# ----------------------------------------------------------------------------------------------------------------------

ENOUGH = 16.0  # samples a period from which their largest is the peak: (pi / 16)^2 / 2 = 1.9 % of a sine are missed
FOLDED = 2.0  # samples a period below which a vibration shows at a lower frequency
SAMPLES_OF_A_PERIOD = 32.0  # samples a period of the finer grid: 0.5 %
FAINT = 0.01  # of the largest peak force: a weaker contact is not followed
MOST_STATES = 5e8  # numbers of samples times coordinates: room for 4 GB, of which a run touches a part
MOST_SAMPLES = 2e7


def last_mode_hz(basis: ModalBasis) -> float:
    """Highest natural frequency of a basis [Hz], without its residual vectors; 0 without modes."""
    true = np.array([kind != "residual" for kind in basis.kind], dtype=bool)
    return float(basis.frequency_hz[true].max(initial=0.0))


def factor_for(highest_hz: float, coordinates: int, n_samples: int, sampling: float, wished_hz: float = 0.0) -> int:
    """By which a sampling is multiplied so that samples show the peaks of what vibrates up to a frequency [Hz]: 1
    where they do, 0 where what is dense enough does not fit into memory.

    Parameters
    ----------
    coordinates : int
        Modes and bodies.
    wished_hz : float
        Of pulses, which are followed as far as memory allows. Of a window of 1 s in which 2 kHz are sampled at 1 kHz;
        at 48 kHz; and of an hour:

    Examples
    --------
    >>> factor_for(2e3, 30, 1000, 1e3), factor_for(2e3, 30, 48_000, 48e3), factor_for(2e3, 30, 3_600_000, 1e3)
    (64, 1, 0)
    """
    fastest = max(highest_hz, wished_hz)
    if sampling >= ENOUGH * fastest:
        return 1
    room = min(MOST_STATES / max(coordinates, 1), MOST_SAMPLES) / n_samples
    factor = min(ceil(SAMPLES_OF_A_PERIOD * fastest / sampling), max(int(room), 1))
    return factor if factor * sampling >= ENOUGH * highest_hz else 0


def factor_of(response: Response) -> int:
    """The same for a run: by its modes, its loads, bodies on links, and its contacts at their peaks."""
    basis, scene = response.basis, response.scene
    loads = [one.history.frequency for one in scene.loads if isinstance(one.history, HalfSine)]
    return factor_for(
        max(last_mode_hz(basis), *_of_links(scene), *loads, 0.0),
        len(basis.omega) + len(scene.bodies),
        len(response.t),
        response.clock.sampling,
        max([*pulses_hz(response).values(), *_of_tables(scene)], default=0.0),
    )


def samples_of_a_pulse(response: Response) -> float:
    """Samples in a period of the fastest pulse on the grid on which peaks are found, infinite without one: fewer than
    ENOUGH where memory does not let it be followed. What begins with it, a velocity too, may then be larger."""
    fastest = max([*pulses_hz(response).values(), *_of_tables(response.scene)], default=0.0)
    return factor_of(response) * response.clock.sampling / fastest if fastest > 0.0 else inf


def resample(response: Response) -> Response | None:
    """A run whose largest samples are its peaks: itself where its samples are dense enough, else the same scene once
    more on a finer grid, which has its samples too; None where that grid does not fit into memory.

    A ball of 1 kg hands its speed of 1 m/s over to a mass on a spring, which then vibrates at 100 Hz. Of its
    displacement 1 / (2 pi 100) m, two samples a period see next to nothing.

    >>> from femstruct.impact.scene import Body, Clock, Contact, Scene
    >>> from femstruct.laws.linear import Linear
    >>> from femstruct.modal.closed_form import oscillator
    >>> basis, points = oscillator(1.0, frequency_hz=100.0, axis="z")
    >>> mass = points["m"].probe("z")
    >>> hit = Contact("hit", upper="ball", lower=mass, law=Linear(1e10))
    >>> coarse = simulate(basis, Scene((Body("ball", 1.0, -1.0),), (hit,)), Clock(0.02, 200.0))
    >>> row = mass.of(basis.shapes)
    >>> [round(200 * np.pi * float(np.abs(one.displacement(row)).max()), 2) for one in (coarse, resample(coarse))]
    [0.01, 1.0]
    """
    factor = factor_of(response)
    if factor == 1:
        return response
    if factor == 0:
        return None
    clock = response.clock
    window = len(response.t) / clock.sampling  # so that every sample of the run is one of the finer grid
    return simulate(response.basis, response.scene, replace(clock, duration=window, sampling=factor * clock.sampling))


def pulses_hz(response: Response) -> dict[str, float]:
    """How fast the force of every contact that struck rises and falls at its peak, as the frequency of a sine [Hz];
    without those of less than 1 % of the largest peak force, whose touches may be as short as they like.

    Notes
    -----
    A closing of the duration T counts as 1 / 2T; and where the largest sample is less than the peak force, as the sine
    of which two samples beside its top show as little.
    """
    found = {}
    largest = max((contact.peak_force for contact in response.contacts.values()), default=0.0)
    for name, contact in response.contacts.items():
        if contact.peak_force <= FAINT * largest:
            continue
        mine = [event for event in response.events if event.contact == name]
        began = max(
            (event.t for event in mine if event.what == "closes" and event.t <= contact.peak_time), default=None
        )
        over = min((event.t for event in mine if event.what == "opens" and event.t >= contact.peak_time), default=None)
        seen = float(np.abs(contact.force).max(initial=0.0))
        missed = acos(seen / contact.peak_force) / pi * response.clock.sampling if seen < contact.peak_force else 0.0
        pulse = 0.5 / (over - began) if began is not None and over is not None and over > began else 0.0
        if missed or pulse:
            found[name] = max(missed, pulse)
    return found


def _of_tables(scene: Scene) -> list[float]:
    """Of every load by straight lines the inverse of its width at half its height [Hz]: of 16 samples over that of
    a triangle the largest is at most 3 % low."""
    found = []
    for history in (one.history for one in scene.loads if isinstance(one.history, Table)):
        size = np.abs(history.values)
        top, half = int(size.argmax()), 0.5 * float(size.max())
        before, after = np.flatnonzero(size[:top] < half), top + np.flatnonzero(size[top:] < half)
        begins, ends = history.times[0], history.times[-1]
        if before.size:
            at = int(before[-1])
            begins = np.interp(half, size[at : at + 2], history.times[at : at + 2])
        if after.size:
            at = int(after[0])
            ends = np.interp(half, size[[at, at - 1]], history.times[[at, at - 1]])
        if half > 0.0:
            found.append(float(1.0 / (ends - begins)))
    return found


def _of_links(scene: Scene) -> list[float]:
    """Of every link the frequency of its bodies on it [Hz], what else it joins held still."""
    masses = {body.name: body.mass for body in scene.bodies}
    found = []
    for link in scene.links:
        mobility = sum(1.0 / masses[end] for end in (link.upper, link.lower) if isinstance(end, str))
        found.append(sqrt(link.stiffness * mobility) / (2.0 * pi))
    return found


# ----------------------------------------------------------------------------------------------------------------------
# Velocities and accelerations as filters need them: means about each sample, which miss no jump between two of them.
#
# Where a contact force jumps, residual vectors let a place jump along: its acceleration is two blows against each other
# between two samples, and rings on faster than samples show. No filter finds that in samples of the acceleration.
# Displacements have all of it.
# ----------------------------------------------------------------------------------------------------------------------

ROUNDING: Final = 16.0 * float(np.finfo(np.float64).eps)  # of a displacement: less of a second difference is no motion
_CORRECTIONS: Final = {1: (-1.0 / 6.0, 1.0 / 30.0, -1.0 / 140.0), 2: (-1.0 / 12.0, 1.0 / 90.0, -1.0 / 560.0)}
"""Of derivatives, in powers of the second difference D2: d2 = D2 (1 - D2 / 12 + D2^2 / 90 - ..)."""


def mean_velocity(displacement: Floats, sampling: float, speed: float = 0.0) -> Floats:
    """The velocity [nt] [m/s] of a displacement [nt] [m].

    Its sum over samples is the displacement: a jump between two of them is in it.

    Parameters
    ----------
    speed : float [m/s]
        What it starts with, and had before.
    """
    x = _continued(displacement, sampling, speed)
    return _corrected(0.5 * sampling * (x[2:] - x[:-2]), 1)


def mean_acceleration(displacement: Floats, sampling: float, speed: float = 0.0) -> Floats:
    """The acceleration [nt] [m/s^2] of a displacement [nt] [m].

    Its sum over samples is the change of velocity, whatever happens between two of them.

    Parameters
    ----------
    speed : float [m/s]
        What it starts with, and had before.

    Examples
    --------
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


def average_motion(response: Response) -> Averaged:
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
