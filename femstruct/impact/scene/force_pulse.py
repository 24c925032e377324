"""What a measured force pulse of one blow says in closed form: start values for its stiffness and damping."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import beta

from femstruct.arrays import Floats, frozen
from femstruct.errors import FemstructError
from femstruct.impact.laws.hertz import Hertz
from femstruct.impact.laws.linear import Linear
from femstruct.impact.scene.restitution import refuse_restitution

FLOOR = 0.1  # of the peak: where a rising and a falling flank are looked for; noise is below
# Contact time of a Hertz spring over d_max / v, 2 int_0^1 dx / sqrt(1 - x^2.5), and what c d^0.5 d' loses on its path,
# in and out, over c v d_max^1.5: 2 int_0^1 x^0.5 sqrt(1 - x^2.5) dx
LASTS, LOSES = 0.8 * float(beta(0.4, 0.5)), 0.8 * float(beta(0.6, 1.5))


@dataclass(frozen=True)
class Pulse:
    """A force pulse: start and duration [s], peak [N], impulse [N s]."""

    start: float
    duration: float
    peak: float
    impulse: float

    def restitution(self, mass: float, speed: float) -> float:
        """Of a free mass [kg] that came with a speed [m/s]: impulse / (mass speed) - 1.

        Raises FemstructError where that is not in (0, 1]: the force, the mass or the speed is another.
        """
        found = self.impulse / (mass * speed) - 1.0
        try:
            refuse_restitution(found)
        except FemstructError as error:
            raise FemstructError(
                "pulse",
                got=f"an impulse of {self.impulse:.4g} N s for {mass * speed:.4g} kg m/s: restitution {found:.3g}",
                expected="1 to 2 times mass times speed",
                do="check the gain of the sensor, the mass and the speed",
            ) from error
        return found

    def linear(self, mass: float, speed: float) -> Linear:
        """The linear law with this duration and impulse; k = m (pi / T)^2 where nothing is lost."""
        return Linear.returning(self.restitution(mass, speed), mass, duration=self.duration)

    def hertz(self, mass: float, speed: float) -> Hertz:
        """The Hertz law with this duration, and the dashpot that loses the energy lost: for weak damping.

        Without loss T = 2.943 d_max / v and m v^2 / 2 = 2/5 k d_max^2.5 (Johnson, Contact Mechanics, 11.24).
        """
        e = self.restitution(mass, speed)
        mean = 0.5 * (1.0 + e) * speed  # what goes in and what comes out take their time
        depth = mean * self.duration / LASTS
        stiffness = 1.25 * mass * mean**2 / depth**2.5
        return Hertz(stiffness, 0.5 * mass * speed**2 * (1.0 - e**2) / (LOSES * mean * depth**1.5))


def pulse_of(t: ArrayLike, force: ArrayLike) -> Pulse:
    """The largest pulse of a force history: t [n] [s], force [n] [N].

    Its ends are as far beyond the crossings of a tenth of the peak as those of a half sine are: 3.4 % of its duration.

    Raises FemstructError for a history whose pulse is not whole, or that never pushes.

    >>> t = np.linspace(-0.2, 1.5, 171)
    >>> found = pulse_of(t, 3.0 * np.sin(np.pi * t) * ((t > 0) & (t < 1)))
    >>> round(found.start, 2), round(found.duration, 2), round(found.impulse * np.pi / 6, 2)
    (0.0, 1.0, 1.0)
    """
    times = frozen("pulse times", t, (None,))
    values = frozen("pulse force", force, times.shape)
    top = int(np.argmax(values))
    peak = float(values[top])
    below = np.flatnonzero(values < FLOOR * peak)
    before, after = below[below < top], below[below > top]
    if not peak > 0.0 or not len(after):
        raise FemstructError("pulse", got="a force that does not return to zero", expected="one whole pulse")
    first, last = int(before[-1]) if len(before) else 0, int(after[0])
    rises = _crossing(times, values, first, FLOOR * peak) if len(before) else float(times[0])
    falls = _crossing(times, values, last - 1, FLOOR * peak)
    hidden = np.arcsin(FLOOR) / np.pi
    duration = float((falls - rises) / (1.0 - 2.0 * hidden))
    start = float(rises - hidden * duration)
    inside = (times >= start - 0.5 * hidden * duration) & (times <= start + (1.0 + hidden) * duration)
    return Pulse(start, duration, peak, float(np.trapezoid(values[inside], times[inside])))


def _crossing(times: Floats, values: Floats, i: int, level: float) -> float:
    """Where the straight line from sample i to the next has a level."""
    share = (level - values[i]) / (values[i + 1] - values[i])
    return float(times[i] + share * (times[i + 1] - times[i]))
